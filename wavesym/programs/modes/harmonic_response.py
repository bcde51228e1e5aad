"""What loads and outputs are of a chain with dashpots where all is slow: power series in s.

A port is what a load acts on, or what an output reads. Under a load on it points move by T(s), a power series, and it
reads H(s) of this itself. Dashpots are what take energy: each resists a sum of velocities.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from flint import arb, arb_series, ctx, fmpq

from wavesym.errors import UnservedError
from wavesym.exact.modes.response import HarmonicResponse
from wavesym.exact.modes.stiffness import Quantity, Stiffness
from wavesym.mechanics.network import Network
from wavesym.programs.modes.projection import Driver, ModalOutput

TERMS = 10
"""Of a power series."""

Series = arb_series


@contextmanager
def series() -> Iterator[None]:
    """Power series of so many terms."""
    before, ctx.cap = ctx.cap, TERMS
    try:
        yield
    finally:
        ctx.cap = before


@dataclass(frozen=True)
class Dashpot:
    """It resists `size` times the sum of weights times the velocities of points."""

    size: fmpq
    points: Mapping[int, fmpq]


def dashpots(network: Network) -> list[Dashpot]:
    """Those that take energy from a network."""
    free = {number for number, point in enumerate(network.points) if point.motion is None}
    found = [Dashpot(network.points[n].damping, {n: fmpq(1)}) for n in sorted(free) if network.points[n].damping != 0]
    return found + [
        Dashpot(link.damping, {link.right: fmpq(1), link.left: -link.ratio})
        for link in network.links
        if link.damping != 0 and free & {link.left, link.right}
    ]


@dataclass(frozen=True)
class SlowPort:
    """How points move under a load, what it reads of it; `order` is 2 where it is an acceleration, twice integrated.

    `least` is the power of 1/s from which on what it starts has a finite energy; `impulse_energy` is that in 1/s^0.
    """

    point_motions: Sequence[Series]
    reads: Series
    order: int
    least: int
    impulse_energy: arb


def read(response: HarmonicResponse, output: ModalOutput, moved: Sequence[Quantity]) -> Quantity:
    """An output of how far points move, but for its derivatives."""
    if output.slope:
        weight, end = output.slope
        return response.slope(moved, end) * response.number(weight)
    parts = (moved[point] * response.number(weight) for point, weight in output.points.items())
    return sum(parts, response.s * 0)


class LowFrequency:
    """A network under loads that change slowly. UnservedError where dashpots alone, or nothing, hold it."""

    def __init__(self, stiffness: Stiffness) -> None:
        self._network = stiffness.network
        self._bars = {bar.delay: _bar_series(bar.delay) for bar in self._network.bars}
        self.response = HarmonicResponse(stiffness, arb, arb_series([0, 1]), self._bars)
        for pivot in self.response.eliminated[0]:
            if not pivot[0] > 0:
                raise UnservedError(
                    "system: dashpots alone, or nothing, hold the chain, which modes with dashpots do not "
                    "support (write an end or a spring that holds it, or take pieces or march)"
                )

    def output(self, output: ModalOutput) -> SlowPort:
        """The port that an output is."""
        network, zero, one = self._network, arb(0), arb_series([1])
        if output.slope:
            weight, end = output.slope
            bar = network.bars[end.bar]
            pulled, shared = self._bars[bar.delay]
            here, there = (bar.left, bar.right)[:: -1 if end.side else 1]
            sign = arb(-weight if end.side else weight)
            forces = {there: shared * (sign * arb(bar.ratios[1 - end.side]))}
            forces[here] = forces.get(here, arb_series([0])) - pulled * (sign * arb(bar.ratios[end.side]))
            moved = self.response.move(forces)
            reads = read(self.response, output, moved) - pulled * (arb(weight * weight) / arb(bar.impedance))
            return SlowPort(moved, reads, 0, 2, zero)
        free = {point: weight for point, weight in output.points.items() if network.points[point].motion is None}
        moved = self.response.move({point: one * arb(weight) for point, weight in free.items()})
        reads = sum((moved[point] * arb(weight) for point, weight in free.items()), arb_series([0]))
        return SlowPort(moved, reads, 0, *self._impulse_energy(free))

    def driver(self, driver: Driver) -> SlowPort:
        """The port that a load is."""
        network, gain, one = self._network, arb(driver.gain), arb_series([1])
        if network.points[driver.point].motion is None:
            moved = self.response.move({driver.point: one * gain})
            return SlowPort(moved, moved[driver.point] * gain, 0, *self._impulse_energy({driver.point: driver.gain}))
        return SlowPort(*self.response.prescribe(driver.point, gain), 2, 0, arb(0))

    def _impulse_energy(self, weights: Mapping[int, fmpq]) -> tuple[int, arb]:
        """Of a force the first power whose energy is finite, and that of its impulse: where there are masses, both."""
        masses = {point: self._network.points[point].mass for point in weights}
        if not all(mass > 0 for mass in masses.values()):
            return 1, arb(0)
        return 0, arb(sum((weight * weight / masses[point] for point, weight in weights.items()), fmpq(0)))


def _bar_series(delay: fmpq) -> tuple[Series, Series]:
    """s coth(s T) and s/sinh(s T) of a delay."""
    term, sinh, cosh = fmpq(1), list[fmpq](), list[fmpq]()
    for k in range(TERMS):
        (sinh if k % 2 else cosh).append(term)  # of sinh(s T)/s the powers of s are one lower
        (cosh if k % 2 else sinh).append(fmpq(0))
        term = term * delay / (k + 1)
    over = 1 / arb_series([*sinh[1:], term if TERMS % 2 else fmpq(0)])
    return arb_series(cosh) * over, over
