"""The projection of loads and outputs on modes, and their sums over all modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import fsum

import numpy as np
from flint import arb, ctx, fmpq

from wavesym.errors import UnservedError
from wavesym.exact.modes.cuts import Cut
from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.statics import Shape, Statics
from wavesym.exact.modes.stiffness import Quantity
from wavesym.mechanics.gauge import motion_readings
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End, Network, Point
from wavesym.mechanics.probe import Probe
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest


@dataclass(frozen=True)
class ModalOutput:
    """What is differentiated in time `order` times: sums of weights times how far points move, or times a slope.

    It is `massive` where all these points have mass.
    """

    order: int
    points: Mapping[int, fmpq]
    slope: tuple[fmpq, End] | None = None
    massive: bool = True

    def value(self, shape: Mode | Shape) -> Quantity:
        """What it is of a shape."""
        if self.slope:
            weight, end = self.slope
            return shape.slope(end) * weight
        return sum(shape.points[point] * weight for point, weight in self.points.items())

    @property
    def power(self) -> int:
        """In how high a power of 1/w^2 its squares are summed up over all modes by `total`."""
        return 2 if self.slope else 0 if self.order == 2 and self.massive else 1

    def total(self, statics: Statics) -> Quantity:
        """The sum over all modes with strain of its square over w^(2 power)."""
        if self.slope:
            weight, end = self.slope
            return statics.break_mass(end) * weight * weight
        if self.order == 2 and self.massive:
            network, free = statics.stiffness.network, statics.free
            total = sum(arb(b * b / network.points[point].mass) for point, b in self.points.items())
            part = sum(free[point] * b for point, b in self.points.items()) if free else 0
            return total - part * part
        return arb(self.value(statics.loaded_shape(self.points)))


@dataclass(frozen=True)
class Driver:
    """A load: `gain` times a force on a point, or times the acceleration of one whose motion is prescribed."""

    point: int
    gain: fmpq
    step: str
    ramp: str


def drivers_of(network: Network) -> list[Driver]:
    """All loads that a network can have: pairs of a step and a ramp. UnservedError for a prescribed velocity."""
    found: list[Driver] = []
    for number, point in enumerate(network.points):
        if point.motion == "fixed":
            continue
        for unit in point.loads:
            first, second, *_ = *_load_powers(point, unit.coefficients), fmpq(0), fmpq(0)
            if first != 0:
                found.append(Driver(number, first, unit.source, ""))
            elif found and found[-1].point == number and not found[-1].ramp and found[-1].gain == second:
                found[-1] = Driver(number, second, found[-1].step, unit.source)
            else:
                found.append(Driver(number, second, "", unit.source))
    return found


def _load_powers(point: Point, coefficients: Sequence[fmpq]) -> list[fmpq]:
    """A unit load as powers of tau: as a force, or as an acceleration."""
    if point.motion != "velocity":
        return [fmpq(c) for c in coefficients]
    if coefficients[0] != 0:
        raise UnservedError(
            f"system.parts: the motion at {point.label} prescribes a velocity, which modes do not "
            "support (write one of acceleration, or take pieces or march)"
        )
    return [k * fmpq(c) for k, c in enumerate(coefficients)][1:]


def places(model: Model) -> tuple[tuple[int, fmpq], ...]:
    """Where bars are to be cut so that all outputs are at points. UnservedError where that makes a ring."""
    for probe in model.probes:
        if 0 < probe.place < 1 and probe.rod - 1 in model.network.parallel_bars:
            raise UnservedError(
                f"output: {probe.name} is inside a rod with a spring or dashpot beside it, which modes do not "
                "support (write a place at its ends, or take pieces or march)"
            )
    return tuple((probe.rod - 1, probe.place) for probe in model.probes if probe.rod)


def modal_output(network: Network, pieces: Cut, probe: Probe) -> ModalOutput:
    """What an output is, its factor included, on the network that is cut in pieces."""
    order, points = 0, dict[int, fmpq]()
    for weight, reading in motion_readings(network, probe):
        order, point = reading.order + 1, reading.point
        if point is None:
            end = pieces.end(reading.rod - 1, reading.place)
            if reading.quantity == "strain":
                return ModalOutput(0, {}, (weight / network.bars[reading.rod - 1].speed, end))
            point, weight = pieces.network.point_at(end), weight * pieces.network.bars[end.bar].ratios[end.side]
        points[point] = points.get(point, fmpq(0)) + weight
    points = {point: weight for point, weight in points.items() if weight != 0}
    massive = all(pieces.network.points[point].mass != 0 for point in points)
    return ModalOutput(order, points, massive=massive)


_BITS = 256
_ULPS = 16 * 2.0**-53  # of a sum of squares, each of which is rounded a few times


@dataclass(frozen=True)
class Projection:
    """Modes by columns: `w`, what outputs are of them (`outputs`), their shares in loads; and sums over all modes.

    `imposed_shape` and `static`, (outputs, loads): what an output is of the shape that a load imposes, and under it
    when it does not change. `powers` of outputs and loads: sums of squares are over w^(2 power), `totals` over all
    modes.
    """

    w: Array
    outputs: Array
    shares: Array
    imposed_shape: Array
    static: Array
    powers: tuple[Array, Array]
    totals: tuple[Array, Array]

    @cached_property
    def spare(self) -> tuple[Array, Array]:
        """Of each output, and each load, the sum of squares over all modes but the first k: (rows, modes + 1)."""
        outputs, shares = (
            _spare(self.w, *each) for each in zip((self.outputs, self.shares), self.powers, self.totals, strict=True)
        )
        return outputs, shares

    def rest(self, count: int) -> Array:
        """What the modes after the first `count` do to the outputs under loads that do not change: (outputs, loads)."""
        w = np.where(self.w > 0, self.w, np.inf)[:count]
        made = np.empty_like(self.static)
        for j, share in enumerate(self.shares):
            terms = self.outputs[:, :count] * (share[:count] / w / w)
            made[:, j] = [fsum([whole, *(-row).tolist()]) for whole, row in zip(self.static[:, j], terms, strict=True)]
        return made


def _spare(w: Array, rows: Array, powers: Array, totals: Array) -> Array:
    strained = np.where(w > 0, w, np.inf)
    made = np.zeros((len(rows), len(w) + 1))
    for row, power, total, out in zip(rows, powers, totals, made, strict=True):
        squares = np.where(w > 0, row, 0.0) ** 2 / (strained ** (2 * power) if power else 1.0)
        left = max(fsum([total, *(-squares).tolist()]), 0.0) + _ULPS * total
        out[-1], out[:-1] = left, left + np.cumsum(squares[::-1])[::-1] * (1 + _ULPS * len(w))
    return made


@dataclass(frozen=True)
class ExactProjection:
    """The same in balls, of the modes of a network that is cut, with the precision that is set where each is used."""

    modes: Sequence[Mode]
    outputs: Sequence[ModalOutput]
    drivers: Sequence[Driver]

    @cached_property
    def _statics(self) -> Statics:
        return Statics(self.modes[0].stiffness)

    @cached_property
    def _shapes(self) -> list[tuple[Shape | None, Shape]]:
        """What each load imposes, None for a force, and the shape under it when it does not change, but for gains."""
        made: list[tuple[Shape | None, Shape]] = []
        for driver in self.drivers:
            if self._statics.stiffness.network.points[driver.point].motion is None:
                made.append((None, self._statics.loaded_shape({driver.point: fmpq(1)})))
            else:
                imposed = self._statics.imposed_shape(driver.point)
                made.append((imposed, self._statics.lagging_shape(imposed)))
        return made

    @cached_property
    def values(self) -> list[list[arb]]:
        """What outputs are of modes."""
        return [[output.value(mode) for mode in self.modes] for output in self.outputs]

    @cached_property
    def shares(self) -> list[list[arb]]:
        """Those of modes in loads."""
        return [[share(driver, mode) for mode in self.modes] for driver in self.drivers]

    @cached_property
    def imposed_shape(self) -> list[list[arb]]:
        """What outputs are of the shape that a load imposes."""
        gains = [driver.gain for driver in self.drivers]
        pairs = [(imposed, gain) for (imposed, _), gain in zip(self._shapes, gains, strict=True)]
        return [[arb(0) if s is None else each.value(s) * gain for s, gain in pairs] for each in self.outputs]

    @cached_property
    def static(self) -> list[list[arb]]:
        """What outputs are under a load that does not change."""
        pairs = [(static, driver.gain) for (_, static), driver in zip(self._shapes, self.drivers, strict=True)]
        return [[each.value(s) * gain for s, gain in pairs] for each in self.outputs]

    @property
    def powers(self) -> tuple[list[int], list[int]]:
        """Of outputs and loads."""
        return [each.power for each in self.outputs], [1 if imposed is None else 0 for imposed, _ in self._shapes]

    @cached_property
    def totals(self) -> tuple[list[arb], list[arb]]:
        """The sums of squares over all modes, of outputs and loads."""
        return [each.total(self._statics) for each in self.outputs], [
            (static.points[driver.point] if imposed is None else self._statics.mass(imposed.points)) * driver.gain**2
            for driver, (imposed, static) in zip(self.drivers, self._shapes, strict=True)
        ]

    def to_doubles(self) -> Projection:
        """In doubles."""
        count = len(self.modes)
        with ctx.workprec(_BITS):
            powers, totals = self.powers, self.totals
            return Projection(
                w=np.array([float(mode.frequency) for mode in self.modes]),
                outputs=np.array([_column(each, self.modes) for each in self.outputs]).reshape(-1, count),
                shares=_array(self.shares, count),
                imposed_shape=_array(self.imposed_shape, len(self.drivers)),
                static=_array(self.static, len(self.drivers)),
                powers=(np.array(powers[0]), np.array(powers[1])),
                totals=(_round_up(totals[0]), _round_up(totals[1])),
            )


def _column(output: ModalOutput, found: Sequence[Mode]) -> list[float]:
    if len(output.points) == 1:  # so are most, of many modes
        ((point, weight),) = output.points.items()
        factor = nearest(weight)
        return [factor * float(mode.points[point]) for mode in found]
    return [float(output.value(mode)) for mode in found]


def share(driver: Driver, mode: Mode) -> Quantity:
    """The share of a mode of mass 1 in a load."""
    if mode.stiffness.network.points[driver.point].motion is None:
        return mode.points[driver.point] * driver.gain
    # what holds the end in the mode, over w^2, is the mass that both move together, the mode and what the end imposes
    return -mode.pull(driver.point) * driver.gain / (mode.frequency * mode.frequency)


def _array(rows: list[list[arb]], columns: int) -> Array:
    return np.array([[float(value) for value in row] for row in rows]).reshape(len(rows), columns)


def _round_up(values: Sequence[arb]) -> Array:
    """Doubles that are not below."""
    return np.asarray(np.nextafter([float(value.upper()) for value in values], np.inf), np.float64)
