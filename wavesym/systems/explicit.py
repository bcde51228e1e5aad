"""Any chain: parts from left to right, as one would draw them, and branches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, cast

from flint import fmpq
from pydantic import (
    Field,
    PlainValidator,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    model_serializer,
    model_validator,
)

from wavesym.errors import MeasureError
from wavesym.fields.damping import ModalDamping, without_damping
from wavesym.fields.loads import Load, LoadKinds
from wavesym.fields.numbers import Exact
from wavesym.fields.table import SceneTable, read_choice, refusal, show
from wavesym.mechanics.dead_loads import BalanceError, with_dead_loads
from wavesym.mechanics.length import LengthUnit
from wavesym.mechanics.network import Network
from wavesym.mechanics.node import UnitLoad
from wavesym.mechanics.travel_times import adjust_speeds
from wavesym.numbers.doubles import rational
from wavesym.systems.chain_places import node, place
from wavesym.systems.drawing import Drawing, draw_parts
from wavesym.systems.node_loads import NODE_LOADS, OnNode
from wavesym.systems.parts import Branch, Parts, describe_parts
from wavesym.systems.place import MisplacedError, Place, Position, position_of
from wavesym.systems.speed_adjustment import SpeedAdjustment, adjustment_choice, percent_text
from wavesym.systems.station import Lines

_OPTIONAL = ("speed_adjustment", "gravity", "initial")
"""Keys that are left out where they say nothing: so scenes keep the hash that they have had."""


class ExplicitChain(SceneTable):
    """A chain that is written out, part by part."""

    load_kinds: ClassVar[LoadKinds] = NODE_LOADS
    no_loads: ClassVar[str] = ""

    type: Literal["chain"] = Field(description='"chain"')
    parts: Parts = Field(description="a list of parts")
    branch: tuple[Branch, ...] = ()
    damping: ModalDamping = None
    speed_adjustment: SpeedAdjustment = Fraction(0)
    gravity: Exact = Field(Fraction(0), description="an acceleration along x")
    initial: Annotated[Literal["static"] | None, PlainValidator(read_choice("is not a start", "static"))] = Field(
        None, description='"static": what is at rest is in balance at first'
    )

    @model_validator(mode="after")
    def _check_network(self, info: ValidationInfo) -> ExplicitChain:
        # which is refused where it cannot be drawn; a scene with units says what its places are told in
        self._check_branches()
        try:
            network = self.network((), info.context if isinstance(info.context, LengthUnit) else None)
        except BalanceError as error:
            raise refusal(str(error), "initial") from None
        if self.damping and (other := _damper(network)):
            instead = "write one of them, or in place of a ratio a dashpot in each rod"
            raise refusal(f"stands beside {other}; {instead}", "damping")
        return self

    def _check_branches(self) -> None:
        """Weight acts along x, on what moves along it."""
        key = "gravity" if self.gravity else "initial"
        if (self.gravity or self.initial) and any(branch.ratio != 1 for branch in self.branch):
            raise refusal("of a chain with a branch that does not move as fast as its node, not served", key)

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        found = without_damping(handler(self))
        return {key: value for key, value in found.items() if key not in _OPTIONAL or getattr(self, key)}

    @cached_property
    def drawing(self) -> Drawing:
        """Its points, bars and links, and where they are; waves are as fast as `speed_adjustment` makes them."""
        drawn = self.drawing_as_written
        if not self.speed_adjustment:
            return drawn
        try:
            return replace(drawn, bars=adjust_speeds(drawn.bars, rational(self.speed_adjustment)))
        except MeasureError as error:
            raise refusal(f"{percent_text(self.speed_adjustment)} is {error}", "speed_adjustment") from None

    @property
    def unadjusted(self) -> ExplicitChain:
        """The same chain with the speeds that were written."""
        if not self.speed_adjustment:
            return self
        return ExplicitChain.model_construct(**{**dict(self), "speed_adjustment": Fraction(0)})

    @cached_property
    def drawing_as_written(self) -> Drawing:
        """The same with the speeds that were written."""
        return draw_parts(self.parts, self.branch)

    @property
    def lines(self) -> Lines:
        """Its main line and its branches."""
        return self.drawing.lines

    @property
    def choices(self) -> Mapping[str, str]:
        """What it is made of, line by line."""
        branches = {
            f"branch {each.name}": f"from {each.from_}, ratio {each.ratio}: {describe_parts(each.parts)}"
            for each in self.branch
        }
        damping = {"damping": self.damping.description} if self.damping else {}
        adjusted = adjustment_choice(self.speed_adjustment)
        dead = {"gravity": str(self.gravity)} if self.gravity else {}
        static = {"initial": self.initial} if self.initial else {}
        return {"parts": describe_parts(self.parts), **branches, **damping, **adjusted, **dead, **static}

    def locate(self, position: Position, quantity: str, loads: Sequence[Load]) -> Place:
        """The place of an output. MisplacedError."""
        return place(self.drawing, position, quantity, {self._point(load) for load in loads})

    def load_fault(self, load: Load) -> tuple[str, str] | None:
        """What is wrong with a load, and under which key; None where nothing is."""
        try:
            point = self._point(load)
        except MisplacedError as error:
            return str(error), "at"
        if self.drawing.points[point].motion == "fixed":
            place = show(position_of(_load_place(load)).text)
            return f'{place} is a "fixed" end, which cannot move; write a node that can', "at"
        return None

    def named_chain(self, loads: Sequence[Load]) -> None:
        """None: the paper has none of these chains."""

    def network(self, loads: Sequence[Load], length: LengthUnit | None = None) -> Network:
        """The network with the loads on its points; its places are in the unit of `length`."""
        units: dict[int, dict[str, UnitLoad]] = {}
        for load in loads:
            for kind, coefficients in (("step", (fmpq(1),)), ("ramp", (fmpq(0), fmpq(1)))):
                unit = UnitLoad(f"{_load_place(load)}:{kind}", None, coefficients)
                units.setdefault(self._point(load), {})[unit.source] = unit
        drawn = self.drawing.network({point: tuple(each.values()) for point, each in units.items()}, length)
        return self.with_dead_loads(drawn)

    def with_dead_loads(self, network: Network) -> Network:
        """A network of its parts with their weight and the forces that springs have at tau = 0. BalanceError."""
        return with_dead_loads(network, rational(self.gravity), static=self.initial is not None)

    def _point(self, load: Load) -> int:
        return node(self.drawing, _load_place(load))


def _damper(network: Network) -> str:
    """What takes energy out of a chain, or opens and closes: empty where nothing does."""
    for point in network.points:
        if point.damping != 0:
            return f"a dashpot or an absorbing end at {point.label}"
    for link in network.links:
        if link.has_corner:
            return {"contact": "a contact", "spring": "a spring with a corner"}.get(link.law, link.law)
        if link.damping != 0:
            return "a dashpot"
    return ""


def _load_place(load: Load) -> str:
    return cast(OnNode, load).at
