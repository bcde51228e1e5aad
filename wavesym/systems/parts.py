"""The parts that an explicit chain is drawn with, as tables of a scene."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, PlainSerializer, PlainValidator, model_validator

from wavesym.errors import did_you_mean
from wavesym.fields.damping import damping_ratio
from wavesym.fields.numbers import Exact, Positive, exact
from wavesym.fields.table import Faults, SceneTable, as_list, read_choice, refusal, show

_NAMES = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,62}")
_MOST_TOLD = 40
MARKS = ("free", "fixed", "absorbing", "joint", "contact")


def _name(value: object) -> str:
    if not isinstance(value, str) or not _NAMES.fullmatch(value):
        raise refusal(f"{show(value)} is not a name; write letters, digits and _, no digit first")
    return value


def _not_negative(value: object) -> Fraction:
    number = exact(value)
    if number < 0:
        raise refusal(f"{show(value)} is negative; write a number of 0 or more")
    return number


def _true(value: object) -> bool:
    if value is not True:
        raise refusal(f"{show(value)} is not true; write true, or leave it out")
    return True


def _gap(value: object) -> Fraction | tuple[Fraction, Fraction]:
    if not isinstance(value, list | tuple):
        return _not_negative(value)
    first, last = _two(value)
    if first > last:
        raise refusal(f"{show(value)} is not in order; write the smaller number first")
    return first, last


def _yield(value: object) -> tuple[Fraction, Fraction]:
    if not isinstance(value, list | tuple):
        return (_not_negative(value),) * 2
    first, last = _two(value)
    if min(first, last) < 0:
        raise refusal(f"{show(value)} has a negative number; write the largest pull and push, both 0 or more")
    return first, last


def _numbers(value: Fraction | tuple[Fraction, ...]) -> str | list[str]:
    """As they are written."""
    return [str(number) for number in value] if isinstance(value, tuple) else str(value)


def _two(value: list[object] | tuple[object, ...]) -> tuple[Fraction, Fraction]:
    if len(value) != 2:
        raise refusal(f"{show(value)} {'is 1 number' if len(value) == 1 else f'are {len(value)} numbers'}; write two")
    return exact(value[0]), exact(value[1])


PartName = Annotated[str, PlainValidator(_name)]
NotNegative = Annotated[Fraction, PlainValidator(_not_negative), PlainSerializer(str, return_type=str)]


Table = Mapping[str, object]
"""A part as it is written."""


class ChainPart(SceneTable):
    """Something between the ends of a chain."""

    key: ClassVar[str]


class SpringLaw(SceneTable):
    """A spring, a dashpot and friction, and what the spring does beyond being linear: it acts on one side, or yields.

    A dashpot beside one that yields acts all the time, with all its force; beside one that acts on one side, or has a
    gap, only while the spring acts.
    """

    spring: NotNegative = Fraction(0)
    dashpot: NotNegative = Fraction(0)
    friction: NotNegative = Field(Fraction(0), description="what holds it, at most, and acts against its sliding")
    breakaway: NotNegative = Field(Fraction(0), description="what holds it at rest, where that is more than friction")
    only: Annotated[Any, PlainValidator(read_choice("is not a side", "push", "pull"))] = Field(
        None, description='"push" or "pull": the spring does nothing else'
    )
    gap: Annotated[Any, PlainValidator(_gap), PlainSerializer(_numbers)] = Field(
        None, description="how far it gets shorter or longer before it acts; [A, B] for both sides: at A, and at B"
    )
    yields: Annotated[Any, PlainValidator(_yield), PlainSerializer(_numbers)] = Field(
        None, alias="yield", description="the largest pull and push, or [pull, push]"
    )
    preload: Exact = Field(Fraction(0), description="what the spring pulls at tau = 0; what it pushes is negative")

    @model_validator(mode="after")
    def _check_breakaway(self) -> SpringLaw:
        if self.breakaway and not self.friction:
            raise refusal("a limit of friction at rest, and there is none; write friction = R too", "breakaway")
        if 0 < self.breakaway < self.friction:
            raise refusal("less than friction, which would hold nothing back; write as much or more", "breakaway")
        return self

    @model_validator(mode="after")
    def _check_law(self) -> SpringLaw:
        keys = {"only": self.only, "gap": self.gap, "yield": self.yields}
        written = [key for key, value in keys.items() if value is not None] + ["preload"] * (self.preload != 0)
        if not written:
            return self
        if self.spring == 0:
            raise refusal("a law of a spring, and there is none; write spring = K too", written[0])
        self._check_preload()
        if self.yields is not None and (self.only is not None or self.gap is not None):
            raise refusal(f"not together with {written[0]}; leave one of them out", "yield")
        if self.gap is not None and self.only is None and not isinstance(self.gap, tuple):
            raise refusal('of one side alone; write only = "push" or "pull" too, or gap = [A, B]', "gap")
        if self.only is not None and isinstance(self.gap, tuple):
            raise refusal("two numbers are for both sides; write one, or leave out only", "gap")
        return self

    def _check_preload(self) -> None:
        """It must be a force that the spring can have, where no gap says it."""
        if self.preload == 0:
            return
        if self.gap is not None:
            raise refusal("the gap says whether it is strained at tau = 0; leave one of them out", "preload")
        pull, push = self.yields or (abs(self.preload),) * 2
        if self.only is not None:
            pull, push = (pull, Fraction(0)) if self.only == "pull" else (Fraction(0), push)
        if not -push <= self.preload <= pull:
            raise refusal(f"{self.preload} is beyond what the spring can pull, or push; write less of it", "preload")

    @property
    def larger_at_rest(self) -> Fraction:
        """What friction bears at rest, where that is more than when it slides; else 0."""
        return self.breakaway if self.breakaway > self.friction else Fraction(0)

    @property
    def has_law(self) -> bool:
        """Whether it is more than linear, and strained at tau = 0 as its points are displaced."""
        return self.yields is not None or bool(self.sides) or self.preload != 0

    @property
    def sides(self) -> tuple[tuple[int, Fraction], ...]:
        """The sides on which it acts, 1 where it pulls and -1 where it pushes, each with its gap, unless linear."""
        if isinstance(self.gap, tuple):
            return (-1, -self.gap[0]), (1, self.gap[1])
        if self.only is None:
            return ()
        return ((1 if self.only == "pull" else -1, self.gap or -abs(self.preload / self.spring)),)


_SMITH = dict.fromkeys(
    ("J", "damping"), "write dashpot = c; Smith's damping J v R is a product and no such law, c = J R stands for it"
)


class RodPart(ChainPart, SpringLaw):
    """An elastic rod; a spring, a dashpot and friction in parallel to it go from end to end."""

    key: ClassVar[str] = "rod"

    rod: Positive = Field(description="a length")
    impedance: Positive = Fraction(1)
    speed: Positive = Fraction(1)
    velocity: Exact = Fraction(0)
    strain: Exact = Fraction(0)
    loss: Annotated[Fraction, PlainValidator(damping_ratio), PlainSerializer(str, return_type=str)] = Fraction(0)
    name: PartName | None = None


class PointPart(ChainPart, SpringLaw):
    """What moves as one: a rigid mass or a massless joint, with a dashpot, a spring and friction to the ground."""

    instead: ClassVar[Mapping[str, str]] = _SMITH

    velocity: Exact | None = None
    name: PartName | None = None
    ground: Any = Field(None, exclude=True, description="its spring, dashpot, friction and their laws, in a table")

    @property
    def inertia(self) -> Fraction:
        """Its mass."""
        return Fraction(0)


class MassPart(PointPart):
    """A rigid mass."""

    key: ClassVar[str] = "mass"

    mass: Positive = Field(description="a mass")

    @property
    def inertia(self) -> Fraction:
        """Its mass."""
        return self.mass


class JointPart(PointPart):
    """A joint without mass."""

    key: ClassVar[str] = "joint"

    joint: Annotated[bool, PlainValidator(_true)] = Field(description="true")


class MotionPart(ChainPart):
    """An end that moves as its load says."""

    key: ClassVar[str] = "motion"

    motion: Annotated[
        Literal["velocity", "acceleration"],
        PlainValidator(read_choice("is not a motion", "velocity", "acceleration")),
    ] = Field(description='"velocity" or "acceleration"')
    velocity: Exact = Fraction(0)
    name: PartName | None = None


class LinkPart(ChainPart, SpringLaw):
    """A spring, a dashpot and friction between the parts on its two sides."""

    key: ClassVar[str] = "spring"
    instead: ClassVar[Mapping[str, str]] = _SMITH

    @model_validator(mode="after")
    def _require_force(self) -> LinkPart:
        if self.spring == self.dashpot == self.friction == 0:
            raise refusal("0 holds nothing; write a spring, a dashpot or friction above 0")
        return self


class ContactPart(ChainPart):
    """A contact between the parts on its two sides, which at tau = 0 are so far apart."""

    key: ClassVar[str] = "contact"
    instead: ClassVar[Mapping[str, str]] = {
        "restitution": "leave it out: it is no law of waves, how fast a rod rebounds follows from what travels in it"
    }

    contact: NotNegative = Field(description="a gap")


KINDS: tuple[type[ChainPart], ...] = (RodPart, MassPart, JointPart, MotionPart, ContactPart)
BETWEEN = RodPart | LinkPart | ContactPart
"""What stands between two nodes."""


_LAWS = frozenset(field.alias or name for name, field in SpringLaw.model_fields.items())


def unfold_ground(part: Mapping[str, object]) -> Mapping[str, object]:
    """A mass or joint as it is written, with the keys of its table `ground` as its own, which mean the same."""
    if "ground" not in part or not part.keys() & {MassPart.key, JointPart.key}:
        return part
    ground = part["ground"]
    if not isinstance(ground, Mapping):
        raise refusal(f"{show(ground)} is not a table; write {{ spring = K }}, with its law", "ground")
    for key in ground:
        if key not in _LAWS:
            raise refusal(f"unknown key; write {', '.join(sorted(_LAWS))}", "ground", str(key))
        if key in part:
            raise refusal("stands beside ground, too; leave one of them out", "ground", str(key))
    return {**{key: value for key, value in part.items() if key != "ground"}, **ground}


def _part(value: object) -> ChainPart | str:
    if isinstance(value, ChainPart):
        return value
    if isinstance(value, str):
        if value not in MARKS:
            meant = did_you_mean(value, MARKS)
            raise refusal(f"{show(value)} is not a part; write {', '.join(MARKS)} or a table{meant and f'. {meant}'}")
        return value
    if not isinstance(value, Mapping):
        raise refusal(f"{show(value)} is not a part; write a table, or one of {', '.join(MARKS)}")
    kind: type[ChainPart] = next((kind for kind in KINDS if kind.key in value), LinkPart)
    if kind is LinkPart and not value.keys() & {"spring", "dashpot", "friction"}:
        known = "rod, mass, joint, motion, contact, spring, dashpot and friction"
        meant = next(filter(None, (did_you_mean(str(key), re.findall(r"\w{3,}", known)) for key in value)), "")
        raise refusal(f"not a part; write one of {known}{meant and f'. {meant}'}")
    return kind.model_validate(unfold_ground(value))


def read_parts(value: object) -> tuple[ChainPart | str, ...]:
    """Parts as they are written. Raises the error of `table.refusal`, for all that are wrong at once."""
    faults = Faults()
    found = []
    for k, part in enumerate(as_list(value)):
        with faults.gather(k):
            found.append(_part(part))
    faults.refuse()
    return tuple(found)


def _serialise(parts: tuple[ChainPart | str, ...]) -> list[Any]:
    return [part if isinstance(part, str) else part.model_dump(exclude_defaults=True, by_alias=True) for part in parts]


def describe_parts(parts: tuple[ChainPart | str, ...]) -> str:
    """Parts in a line; of a long one the first."""
    words = [part if isinstance(part, str) else _describe_part(part) for part in parts[:_MOST_TOLD]]
    more = [f"... and {len(parts) - _MOST_TOLD} more"] if len(parts) > _MOST_TOLD else []
    return " | ".join([*words, *more])


def _describe_part(part: ChainPart) -> str:
    given = part.model_dump(exclude_defaults=True, by_alias=True)
    keys = sorted(given, key=lambda key: (key == "name", key != part.key))
    return ", ".join(key if given[key] is True else f"{key} {given[key]}" for key in keys)


Parts = Annotated[tuple[Any, ...], PlainValidator(read_parts), PlainSerializer(_serialise, return_type=list[Any])]


class Branch(SceneTable):
    """Parts that start at a named node, read outwards; they move `ratio` times as fast as the node."""

    from_: PartName = Field(alias="from", description="the name of a node")
    name: PartName = Field(description="a name")
    ratio: Exact = Fraction(1)
    parts: Parts = Field(description="a list of parts")
