"""What the systems have in common as tables of a scene: how many elements, and lists of numbers for what is between.

Nothing of size m is built before as many numbers are seen to be given.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from typing import ClassVar

from pydantic import Field, ValidationInfo, field_validator

from wavesym.errors import UnservedError
from wavesym.fields.loads import Load, LoadKinds
from wavesym.fields.numbers import Integer
from wavesym.fields.table import SceneTable, WrittenDecimal, refusal, show
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.length import LengthUnit
from wavesym.mechanics.network import Network, network_of
from wavesym.mechanics.node import Parameters, System
from wavesym.numbers.doubles import rational
from wavesym.systems.parts import ChainPart, read_parts
from wavesym.systems.place import MisplacedError, Place, Position
from wavesym.systems.station import Lines, straight


class Preset(SceneTable):
    """m elastic elements of a system, with numbers for its parameters.

    `variants` are what `derive` prints of it; their m and their indices say how many numbers a list has, `counts` the
    formula as users know it. `companions` are systems that it becomes under loads that the paper does not have; they
    are proved as the variants are. `fewest` is the smallest m, where it is less than that of the general statement of
    which `variants` are families. `load_kinds` are the tables that its loads may be, `no_loads` why there are none.
    """

    variants: ClassVar[tuple[System, ...]]
    companions: ClassVar[tuple[System, ...]] = ()
    counts: ClassVar[Mapping[str, str]]
    fewest: ClassVar[int | None] = None
    load_kinds: ClassVar[LoadKinds] = ()
    no_loads: ClassVar[str] = ""

    type: str
    m: Integer = Field(description="the number of elastic elements")

    @field_validator("m")
    @classmethod
    def _check_size(cls, m: int) -> int:
        system = cls.variants[0]
        fewest = cls.fewest or system.smallest
        if m < fewest or m % system.step:
            kind = "an even integer" if system.step == 2 else "an integer"
            raise refusal(f"{show(m)} is not {kind} of {fewest} or more; write one")
        return m

    @field_validator("*")
    @classmethod
    def _check_count(cls, value: object, info: ValidationInfo) -> object:
        m = info.data.get("m")  # None where it was refused, which is then what the user reads
        name = str(info.field_name)
        if name in cls.counts and m is not None and isinstance(value, tuple):
            indices = cls.variants[0].indices(m)[name]
            count = max(0, -((indices.start - indices.stop) // indices.step))  # len() has a limit
            if len(value) != count:
                raise refusal(f"{len(value)} numbers; write {show(count)} ({cls.counts[name]})")
        return value

    @property
    def system(self) -> System:
        """Which of the variants it is."""
        return self.variants[0]

    @property
    def choices(self) -> Mapping[str, str]:
        """What was chosen besides numbers, by key."""
        return {}

    @property
    def tables(self) -> list[object]:
        """Its parts from left to right, as a chain has them. UnservedError where it has none."""
        raise UnservedError(f"system.type: {self.type} has no parts; write collision, drive or building")

    @property
    def parts(self) -> tuple[ChainPart | str, ...]:
        """The same, read."""
        return read_parts(self.tables)

    @cached_property
    def chain(self) -> Chain:
        """Its nodes and rods, with these numbers."""
        indices = self.system.indices(self.m)
        numbers = {
            name: dict(zip(indices[name], map(rational, getattr(self, name)), strict=True)) for name in self.counts
        }
        return Chain(self.system, self.m, Parameters(**numbers))

    def locate(self, position: Position, quantity: str, loads: Sequence[Load]) -> Place:
        """The place of an output. MisplacedError."""
        x, text = position.x, show(WrittenDecimal(position.text))
        if x is None or not 0 <= x <= self.m:
            raise MisplacedError(f"{text} is not on the chain; write {self.places_text}")
        divided = quantity in ("strain", "force") and self._has_sides_at(x, quantity)
        if divided and not position.side:
            raise MisplacedError(f'{text} has two sides, of the body there; write "{text}-" or "{text}+"')
        side = position.side if divided else 0
        # at a node the rod is the one on its left, where no side is asked for
        after = -(-x.numerator // x.denominator)
        rod = min(max(1, after + 1 if side > 0 else after), self.m)
        return Place(x, side, "", rod, x - (rod - 1))

    def _has_sides_at(self, x: Fraction, quantity: str) -> bool:
        """Whether strain, or force, has two sides at x (in rod lengths), inside the chain: mostly at bodies."""
        if not (0 < x < self.m and x.denominator == 1):
            return False
        node = self.chain.nodes[int(x)]
        held = bool(node.inertia or node.damping or node.loads)
        return held or (quantity == "strain" and node.alpha != node.beta)

    @property
    def places_text(self) -> str:
        """Which places there are, for people."""
        return f"a position from 0 to {self.m}"

    def load_fault(self, load: Load) -> tuple[str, str] | None:
        """What is wrong with a load, and under which key; None where nothing is."""
        return load.fault(self.m)

    def named_chain(self, loads: Sequence[Load]) -> Chain | None:
        """The chain as the paper has it under these loads, None where the paper has none."""
        return self.chain

    def network(self, loads: Sequence[Load], length: LengthUnit | None = None) -> Network:
        """The same as a network; its places count rods."""
        return network_of(self.named_chain(loads) or self.chain)

    @property
    def lines(self) -> Lines:
        """Its rods, in a line."""
        return straight(self.network(()))
