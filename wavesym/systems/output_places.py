"""Where outputs are that more than one place has a part in: the masses, rods and foundations that they are of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Protocol

from wavesym.fields.loads import Load
from wavesym.fields.table import WrittenDecimal, show
from wavesym.mechanics.network import Network
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.systems.place import MisplacedError, Place, Position
from wavesym.systems.station import Lines

EVERY = "all"
"""In place of a list of drifts: those of all rods of the main line."""


class PlacedSystem(Protocol):
    """A system that knows its places."""

    @property
    def type(self) -> str: ...

    @property
    def lines(self) -> Lines: ...

    def locate(self, position: Position, quantity: str, loads: Sequence[Load]) -> Place: ...

    def network(self, loads: Sequence[Load]) -> Network: ...


@dataclass(frozen=True)
class OutputPlaces:
    """The places of a system's outputs, under its loads."""

    system: PlacedSystem
    loads: Sequence[Load]

    def place(self, position: Position, quantity: str) -> Place:
        """Where an output is. MisplacedError."""
        text = show(WrittenDecimal(position.text))
        if quantity == "drift":
            return self._rod(position, text)
        place = self.system.locate(position, QUANTITIES[quantity].place_quantity, self.loads)
        if quantity == "relative":
            self._refuse_groundless(text)
        return place

    @cached_property
    def _network(self) -> Network:
        return self.system.network(self.loads)

    @cached_property
    def _rods(self) -> dict[str, list[int]]:
        return {
            name: [station.right for station in stations if station.right is not None]
            for name, stations in self.system.lines.items()
        }

    def _rod(self, position: Position, text: str) -> Place:
        """The k-th rod of a line."""
        rods, k = self._rods.get(position.name), position.x
        if rods is None or k is None:
            raise MisplacedError(
                f"{text} is not a rod; write the number of one, on a branch after its name and a colon"
            )
        if position.side or k.denominator != 1 or not 1 <= k <= len(rods):
            what = "storey" if self.system.type == "building" else "rod"
            there = f"1 to {len(rods)}" if len(rods) > 1 else "1"
            every = "" if position.name else f', or drift = "{EVERY}" for every {what} there is'
            raise MisplacedError(f"{text} is not the number of a {what}; write {there}{every}")
        return Place(k, 0, position.name, rods[int(k) - 1] + 1, Fraction(1))

    def _refuse_groundless(self, text: str) -> None:
        if self.system.type == "building":
            return
        if self.system.type != "chain":
            raise MisplacedError(
                f"{text}, but a {self.system.type} has no foundation; write it for a building or a chain"
            )
        count = sum(point.motion in ("velocity", "acceleration") for point in self._network.points)
        if count != 1:
            raise MisplacedError(
                f"{text} is relative to the one end that moves, and there are {count}; write a chain with 1 motion end"
            )
