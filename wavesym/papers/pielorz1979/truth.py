"""What formulas of this paper are compared with: named functions of the derived laws on a chain, nothing read off them.

The exact tables (exact_tables.py) are the derived laws run; a `Driven` chain is their response to loads with several
steps, at rational instants, in numbers that are equal only if they are the same (exponentials.py).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property

from flint import fmpq

from wavesym.exact.increments import Increment, combined, integrated
from wavesym.exact.table import Function
from wavesym.model.node import System
from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.exact_tables import Exact, collision, drive, uneven_building
from wavesym.papers.exponentials import Exponentials
from wavesym.systems.building import BUILDING_FORCE
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE


@dataclass(frozen=True)
class Example:
    """An example: its name, its derivation, its tables, and the m that they are tried with."""

    name: str
    system: System
    tables: Callable[[int], Exact]
    sizes: range


EXAMPLES: Mapping[str, Example] = {
    "I": Example("I", COLLISION, collision, range(4, 11, 2)),
    "II": Example("II", DRIVE, drive, range(1, 6)),
    "III": Example("III", BUILDING_FORCE, uneven_building, range(2, 7)),
}


@dataclass(frozen=True)
class Step:
    """A piece of a load: when it begins, and how much of its unit it is."""

    time: fmpq
    weight: fmpq


Loads = Mapping[str, Sequence[Step]]
"""The pieces of every source of a chain, number k of each from 0 on."""


@dataclass(frozen=True)
class Driven:
    """A chain under loads: the motion that the derived laws give it."""

    exact: Exact
    loads: Loads

    @cached_property
    def _known(self) -> dict[tuple[str, int, int, int, int], Exponentials]:
        return {}

    def wave(self, letter: str, rod: int, z: fmpq, order: int = 1) -> Exponentials:
        """f or g of a rod at z, just after any jump there: itself (order 0), its derivative (1), the next (2).

        MeaninglessError where there is no such rod or derivative, or z is beyond the tables.
        """
        z = fmpq(z)
        key = letter, rod, int(z.p), int(z.q), order  # which are hashed faster than z
        if key not in self._known:
            self._known[key] = self._computed(letter, rod, z, order)
        return self._known[key]

    def _computed(self, letter: str, rod: int, z: fmpq, order: int) -> Exponentials:
        if not 1 <= rod <= self.exact.m:
            raise MeaninglessError(f"there is no rod {rod}")
        if order > 2:
            raise MeaninglessError(f"there is no derivative of order {order} here")
        terms = []
        step = self.exact.interval
        for source, pieces in self.loads.items():
            increments = self.exact.responses[source][Function(letter, rod)]
            for piece in pieces:
                since = z - piece.time
                if since >= step * len(increments):
                    raise MeaninglessError(f"z = {z} is beyond the tables")
                for number in range(int(since / step) + 1 if since >= 0 else 0):
                    w = since - step * number
                    for rate, powers in _ordered(source, self.exact, letter, rod, number, order).items():
                        value = fmpq(0)
                        for power in reversed(powers):
                            value = value * w + power
                        terms.append((-rate * w, piece.weight * value))
        return Exponentials.total(terms)

    def waves_at(self, rod: int, x: int, tau: fmpq, order: int = 1) -> tuple[Exponentials, Exponentials]:
        """f and g of a rod at x, where (4.2) has them: g - f is the strain, f + g and v the velocity.

        MeaninglessError where there is no such rod.
        """
        if not 1 <= rod <= self.exact.m:
            raise MeaninglessError(f"there is no rod {rod}")
        clock = self.exact.chain.rod(rod)
        late = clock.tau0 + x - clock.x0, clock.tau0 - x + clock.x0
        return self.wave("f", rod, tau - late[0], order), self.wave("g", rod, tau - late[1], order)

    def gain(self, letter: str, rod: int, interval: int, source: str, piece: int | None = None) -> Increment:
        """What a unit of a source, or a piece of a load, gives to f or g in interval 1, 2, ...; "ab" is a with b.

        MeaninglessError where there is no such source, piece or rod, or the interval is beyond the tables.
        """
        key = letter, rod, interval, source, piece
        if key not in self._gains:
            sources = ["a", "b"] if source == "ab" else [source]
            if not 1 <= rod <= self.exact.m or not {*sources} <= self.exact.responses.keys():
                raise MeaninglessError(f"there is no rod {rod}, or no {source}")
            weights = [fmpq(1) if piece is None else self.piece(name, piece).weight for name in sources]
            try:
                parts = [self.exact.increment(name, letter, rod, interval) for name in sources]
            except IndexError:
                raise MeaninglessError(f"interval {interval} is beyond the tables") from None
            self._gains[key] = combined(zip(weights, parts, strict=True))
        return self._gains[key]

    @cached_property
    def _gains(self) -> dict[tuple[str, int, int, str, int | None], Increment]:
        return {}

    def piece(self, source: str, number: int) -> Step:
        """A piece of a load; MeaninglessError where there is none."""
        pieces = self.loads.get(source, ())
        if not 0 <= number < len(pieces):
            raise MeaninglessError(f"{source} has no piece {number}")
        return pieces[number]

    def load(self, source: str, z: fmpq, power: int = 0) -> fmpq:
        """The sum of the source's pieces that have begun, each times the time since then to a power."""
        return sum((p.weight * (z - p.time) ** power for p in self.loads.get(source, ()) if z >= p.time), fmpq(0))

    def increment(self, source: str, letter: str, rod: int, number: int, w: fmpq) -> Exponentials:
        """What f' or g' of a rod gains in interval 1, 2, ... for a unit of a source, w after its start; nothing before.

        MeaninglessError where there is no such rod, or the interval is beyond the tables.
        """
        key = source, letter, rod, number, fmpq(w)
        if key not in self._gained:
            self._gained[key] = self._increment(*key)
        return self._gained[key]

    @cached_property
    def _gained(self) -> dict[tuple[str, str, int, int, fmpq], Exponentials]:
        return {}

    def _increment(self, source: str, letter: str, rod: int, number: int, w: fmpq) -> Exponentials:
        try:
            increment = self.exact.increment(source, letter, rod, number)
        except (KeyError, IndexError):
            raise MeaninglessError(f"there is no interval {number} of {letter}_{rod}") from None
        parts: dict[fmpq, fmpq] = {}
        for rate, powers in increment.items():
            value = sum((power * w**k for k, power in enumerate(powers)), fmpq(0))
            parts[-rate * w] = parts.get(-rate * w, fmpq(0)) + value
        return Exponentials(parts)


def _ordered(source: str, exact: Exact, letter: str, rod: int, number: int, order: int) -> Increment:
    return _derived(exact.responses[source][Function(letter, rod)], number, order)


def _derived(increments: list[Increment], number: int, order: int) -> Increment:
    increment = increments[number]
    if order == 1:
        return increment
    if order == 0:
        return integrated(increment)
    return {
        rate: [
            (k + 1) * above - rate * this
            for k, (this, above) in enumerate(zip(powers, [*powers[1:], fmpq(0)], strict=True))
        ]
        for rate, powers in increment.items()
    }


@cache
def driven(example: str, m: int) -> Driven:
    """An example under loads in which nothing coincides: every source has pieces of its own, at times of its own."""
    exact = EXAMPLES[example].tables(m)
    return Driven(exact, loads(exact))


def loads(exact: Exact) -> Loads:
    """Pieces for every source of a chain: moment s has 1 + (s + 1) mod 4; an impact is one, at 0."""
    if exact.chain.sources == ("impact",):
        return {source: (Step(fmpq(0), fmpq(1)),) for source in exact.responses}
    if exact.chain.system is DRIVE:
        return {
            f"M{s}": tuple(
                Step(fmpq(k * (s + 2), 3), fmpq(2 * s + 1, k + 2) * (-1) ** k) for k in range(1 + (s + 1) % 4)
            )
            for s in range(1, exact.m + 2)
        }
    times = (fmpq(0), fmpq(3, 4), fmpq(7, 3))
    a, b = (fmpq(1), fmpq(-2, 3), fmpq(5, 7)), (fmpq(1, 3), fmpq(-3, 5), fmpq(2, 9))
    return {
        "a": tuple(map(Step, times, a)),
        "b": tuple(map(Step, times, b)),
    }


def instants(
    until: fmpq | int, start: fmpq | int = 0, between: Sequence[fmpq] = (fmpq(2, 7), fmpq(5, 6))
) -> tuple[fmpq, ...]:
    """Rational instants at which formulas are compared: starts of intervals, and some `between`."""
    found = []
    z = fmpq(start)
    while z < until:
        found += [z, *(z + part for part in between)]
        z += 1
    return tuple(t for t in found if t < until)


def positions(exact: Exact) -> Sequence[fmpq]:
    """Places inside every rod."""
    return [fmpq(i) - fmpq(p, q) for i in range(1, exact.m + 1) for p, q in ((1, 2), (1, 7))]
