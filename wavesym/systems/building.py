"""System III: a building of m storeys under base acceleration; (4.5), and with a base that moves with the ground.

The paper's base ("force") balances the foundation's inertia M_0 a against the columns. It is not a foundation that
moves with the ground ("ground"), whose velocity is the integral of the acceleration.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from typing import Any, ClassVar, Literal

from pydantic import Field, SerializerFunctionWrapHandler, field_validator, model_serializer

from wavesym.fields.damping import ModalDamping, without_damping
from wavesym.fields.loads import Load, LoadKinds, SampledLoad, TimedLoad
from wavesym.fields.numbers import Numbers, Positives
from wavesym.fields.shapes import ShapedLoad
from wavesym.fields.table import shown, wrong
from wavesym.mechanics.node import Family, Node, Parameters, Quantity, Rod, System, UnitLoad, single
from wavesym.records.load import RecordedLoad
from wavesym.systems.preset import Preset


def _force(storey: Rod, p: Parameters) -> Node:
    loads = (UnitLoad("a", None, (-1 / p.kappa[0],)), UnitLoad("b", None, (0, -1 / p.kappa[0])))
    return Node(None, storey, inertia=0, alpha=0, beta=2, loads=loads)


def _ground(storey: Rod, p: Parameters) -> Node:
    loads = (UnitLoad("a", None, (0, 1)), UnitLoad("b", None, (0, 0, Fraction(1, 2))))
    return Node(None, storey, inertia=0, alpha=0, beta=0, damping=1, loads=loads)


def _families(base: Callable[[Rod, Parameters], Node], m: Quantity, p: Parameters) -> tuple[Family, ...]:
    def storey(i: Quantity) -> Rod:
        return Rod(tau0=i - 1, x0=i - 1)

    def floor(i: Quantity) -> Node:
        return Node(storey(i), storey(i + 1), inertia=1, alpha=2 * p.kappa[i], beta=2 * p.kappa[i])

    return (
        single(0, lambda: base(storey(1), p)),
        Family(1, m - 1, 1, floor),
        single(m, lambda: Node(storey(m), None, inertia=1, alpha=2 * p.kappa[m], beta=0)),
    )


def _indices(m: int) -> Mapping[str, range]:
    return {"kappa": range(m + 1)}


BUILDING_FORCE = System("building-force", partial(_families, _force), _indices, smallest=2)
BUILDING_GROUND = System("building-ground", partial(_families, _ground), _indices, smallest=2)


class OfBase(Load):
    """The base acceleration of a building."""

    @property
    def sources(self) -> tuple[str, str]:
        """A step and a ramp of it."""
        return "a", "b"

    @property
    def label(self) -> str:
        """What it is, for people."""
        return "acceleration of the base"


class Acceleration(OfBase, TimedLoad):
    """(3.2): sum_k (a_k + b_k (tau - times_k)) H(tau - times_k)."""

    lists: ClassVar[tuple[str, str]] = ("a", "b")

    a: Numbers = ()
    b: Numbers = ()


class SampledAcceleration(OfBase, SampledLoad):
    """A base acceleration that is linear between its samples."""


class RecordedAcceleration(OfBase, RecordedLoad):
    """A base acceleration that is a record."""


class ShapedAcceleration(OfBase, ShapedLoad):
    """A base acceleration of one shape."""


def known_base(base: object) -> str:
    """Which of the two bases. Raises the error of `table.wrong`."""
    if base in ("force", "ground"):
        return str(base)
    raise wrong(f'{shown(base)} is not a base; write "force" or "ground"')


class Building(Preset):
    """m storeys between the foundation at x = 0, floors, and the roof at x = m."""

    variants: ClassVar[tuple[System, ...]] = (BUILDING_FORCE, BUILDING_GROUND)
    counts: ClassVar[Mapping[str, str]] = {"kappa": "m + 1"}
    fewest: ClassVar[int | None] = 1  # no floor, but a roof
    load_kinds: ClassVar[LoadKinds] = (Acceleration, SampledAcceleration, RecordedAcceleration, ShapedAcceleration)

    type: Literal["building"] = Field(description='"building"')
    kappa: Positives = Field(description="a list of m + 1 positive numbers")
    base: Literal["force", "ground"] = Field(description='"force" or "ground"')
    damping: ModalDamping = None

    @model_serializer(mode="wrap")
    def _said(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return without_damping(handler(self))

    @field_validator("base", mode="before")
    @classmethod
    def _known(cls, base: object) -> object:
        return known_base(base)

    @property
    def system(self) -> System:
        """The one of the two variants."""
        return BUILDING_FORCE if self.base == "force" else BUILDING_GROUND

    @property
    def choices(self) -> Mapping[str, str]:
        """Which base, and how its modes are damped."""
        return {"base": self.base, **({"damping": self.damping.told} if self.damping else {})}
