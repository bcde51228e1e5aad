"""The three systems of the paper: how many elements, and the dimensionless ratios of their masses.

Nothing of size m is built before as many numbers are seen to be given.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated, ClassVar, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from wavesym.scene.numbers import Integer, Numbers, Positives
from wavesym.scene.table import Table, shown, wrong


class _System(Table):
    """m elastic elements, and lists of numbers for what is between them.

    `smallest` and `step` say which m there are; `counts` how many numbers a list has: `(m + more) // per`, and the
    formula as users know it.
    """

    smallest: ClassVar[int] = 1
    step: ClassVar[int] = 1
    counts: ClassVar[Mapping[str, tuple[int, int, str]]]

    type: str
    m: Integer = Field(description="the number of elastic elements")

    @field_validator("m")
    @classmethod
    def _possible(cls, m: int) -> int:
        if m < cls.smallest or m % cls.step:
            kind = "an even integer" if cls.step == 2 else "an integer"
            raise wrong(f"{shown(m)} given, {kind} of at least {cls.smallest} expected")
        return m

    @field_validator("*")
    @classmethod
    def _counted(cls, value: object, info: ValidationInfo) -> object:
        m = info.data.get("m")  # None where it was refused, which is then what the user reads
        if (count_of := cls.counts.get(str(info.field_name))) and m is not None and isinstance(value, tuple):
            more, per, formula = count_of
            if len(value) != (count := (m + more) // per):
                raise wrong(f"{len(value)} numbers given, {shown(count)} expected ({formula})")
        return value

    def divided_at(self, x: Fraction) -> bool:
        """Whether a rigid body lies at x (in rod lengths), strictly inside the chain."""
        return 0 < x < self.m and x.denominator == 1


class Collision(_System):
    """m rods with m/2 rigid bodies at x = 1, 3, ... m - 1 that collide at tau = 0."""

    smallest = 4
    step = 2
    counts: ClassVar[Mapping[str, tuple[int, int, str]]] = {"kappa": (0, 2, "m/2"), "velocity": (0, 2, "m/2")}

    type: Literal["collision"] = Field(description='"collision"')
    kappa: Positives = Field(description="a list of m/2 positive numbers")
    velocity: Numbers = Field(description="a list of m/2 numbers")

    @field_validator("velocity")
    @classmethod
    def _closing(cls, velocity: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
        for k in range(1, len(velocity)):
            if velocity[k] > velocity[k - 1]:
                left = shown(velocity[k - 1])
                raise wrong(
                    f"{shown(velocity[k])} given, at most {left} expected, as on its left (or the bodies part)", k
                )
        return velocity

    def divided_at(self, x: Fraction) -> bool:
        """Whether a rigid body lies at x (in rod lengths); at an even x two rods are in contact."""
        return super().divided_at(x) and x % 2 == 1


class Drive(_System):
    """m shafts between m + 1 rigid discs at x = 0, 1, ... m."""

    counts: ClassVar[Mapping[str, tuple[int, int, str]]] = {"kappa": (0, 1, "m"), "inertia": (1, 1, "m + 1")}

    type: Literal["drive"] = Field(description='"drive"')
    kappa: Positives = Field(description="a list of m positive numbers")
    inertia: Positives = Field(description="a list of m + 1 positive numbers")


class Building(_System):
    """m storeys between the foundation at x = 0, floors, and the roof at x = m."""

    smallest = 2
    counts: ClassVar[Mapping[str, tuple[int, int, str]]] = {"kappa": (1, 1, "m + 1")}

    type: Literal["building"] = Field(description='"building"')
    kappa: Positives = Field(description="a list of m + 1 positive numbers")
    base: Literal["force", "ground"] = Field(description='"force" or "ground"')

    @field_validator("base", mode="before")
    @classmethod
    def _known(cls, base: object) -> object:
        if base not in ("force", "ground"):
            raise wrong(f'{shown(base)} given, "force" or "ground" expected')
        return base


def _typed(value: object) -> object:
    expected = '"collision", "drive" or "building" expected'
    if not isinstance(value, Mapping):
        raise wrong(f"{shown(value)} given, a table expected")
    if "type" not in value:
        raise wrong(f"missing, {expected}", "type")
    if value["type"] not in ("collision", "drive", "building"):
        raise wrong(f"{shown(value['type'])} given, {expected}", "type")
    return value


System = Annotated[Collision | Drive | Building, Field(discriminator="type"), BeforeValidator(_typed)]
