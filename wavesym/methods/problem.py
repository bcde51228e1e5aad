"""A network in doubles, with its loads and outputs: where every other method starts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.errors import UnservedError
from wavesym.mechanics.damping import Damping
from wavesym.mechanics.gauge import Gauge, Sum, Weighted
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import fraction, nearest

Array = NDArray[np.float64]
Evaluate = Callable[[Array], Array]
"""Ascending tau in [0, until], shape (n,), to outputs, shape (outputs, n)."""

LOAD_TERMS = 3
"""Loads are polynomials in tau of at most this many terms: a ramp of acceleration is a parabola of ground velocity."""

# a grid of steps that all delays are multiples of has at most so many in the longest
_MOST_STEPS = 200


@dataclass(frozen=True)
class LoadEvent:
    """From `time` on, the load on a point has sum_k coefficients[k] (tau - time)**k more."""

    time: Fraction
    point: int
    coefficients: tuple[float, float, float]


@dataclass(frozen=True)
class OutputSums:
    """What outputs are the sums of: `weights` (outputs, readings), and loads.

    `loads` are an output, a time, and the polynomial (highest power first) that is added to the output from then on.
    """

    weights: Array
    loads: tuple[tuple[int, float, Array], ...]

    @cached_property
    def is_trivial(self) -> bool:
        """Whether outputs are the readings themselves."""
        return not self.loads and np.array_equal(self.weights, np.eye(len(self.weights)))


@dataclass(frozen=True)
class Problem:
    """Bars in which waves travel, between points; a bar's end moves `ratio` times as fast as its point,

        mass u'' + damping u' + stiffness u = sum over ends of ratio * force of the bar + loads.

    At tau = 0 nothing is displaced: what a bar is strained then is counted besides. Everything is dimensionless.
    `velocity` and `mass` have shape (points,), `damping` and `stiffness` (points, points). The velocity of a point
    whose motion is `prescribed` is its load, at tau = 0, too. `ends` has the points of each bar's left and right end,
    `ratios` their ratios, both (bars, 2); `speed`, `impedance`, `start_velocity` and `start_strain` have shape (bars,).
    `readings` are what the outputs are sums of; `modal` is how modes are damped besides.
    """

    mass: Array
    damping: Array
    stiffness: Array
    velocity: Array
    prescribed: tuple[int, ...]
    ends: NDArray[np.int_]
    ratios: Array
    delays: tuple[Fraction, ...]
    speed: Array
    impedance: Array
    start_velocity: Array
    start_strain: Array
    events: tuple[LoadEvent, ...]
    readings: tuple[Gauge, ...]
    sums: OutputSums
    until: float
    modal: Damping | None = None

    @property
    def points(self) -> int:
        """The number of points."""
        return len(self.mass)

    @cached_property
    def delay(self) -> Array:
        """How long a wave takes through each bar, in doubles: (bars,)."""
        return np.array([float(delay) for delay in self.delays])

    @cached_property
    def measure(self) -> Fraction:
        """The largest time that all delays are multiples of."""
        common = lcm(*(delay.denominator for delay in self.delays))
        return Fraction(gcd(*(int(delay * common) for delay in self.delays)), common)

    @cached_property
    def start_waves(self) -> Array:
        """The waves in each bar at tau = 0 that were sent from its left and its right end: (bars, 2)."""
        turned = self.speed * self.start_strain
        return np.stack([self.start_velocity - turned, self.start_velocity + turned], axis=1) / 2

    @cached_property
    def onto(self) -> Array:
        """What a force of 1 at each end of a bar is at the points: (points, 2 * bars), left and right ends by turns."""
        matrix = np.zeros((self.points, self.ends.size))
        matrix[self.ends.ravel(), np.arange(self.ends.size)] = self.ratios.ravel()
        return matrix

    def each_end(self) -> Iterator[tuple[int, int, int, float, float]]:
        """Each end of a bar: bar, side (0 left, 1 right), point, ratio, impedance."""
        for bar, (ends, ratios) in enumerate(zip(self.ends.tolist(), self.ratios.tolist(), strict=True)):
            for side in (0, 1):
                yield bar, side, ends[side], ratios[side], float(self.impedance[bar])

    def load_means(self, low: Array, high: Array) -> Array:
        """The means of the loads over intervals [low, high], each (n,): shape (n, points)."""
        total = np.zeros((len(low), self.points))
        for event in self.events:
            start = float(event.time)
            first, last = np.maximum(low - start, 0.0), np.maximum(high - start, 0.0)
            for k, c in enumerate(event.coefficients):
                total[:, event.point] += c / (k + 1) * (last ** (k + 1) - first ** (k + 1)) / (high - low)
        return total

    def strain_at_start(self, reading: Gauge) -> float:
        """What a reading has of the strain at tau = 0."""
        return float(self.start_strain[reading.rod - 1]) if reading.quantity == "strain" else 0.0

    def outputs(self, values: Array, taus: Array) -> Array:
        """The outputs, (outputs, n), from the values (readings, n) of the readings at `taus` (n,)."""
        if self.sums.is_trivial:
            return values
        total = self.sums.weights @ values
        for output, time, powers in self.sums.loads:
            since = taus - time
            total[output] += np.where(since >= 0, np.polyval(powers, since), 0.0)
        return np.asarray(total)


@dataclass(frozen=True)
class Method:
    """Another method. `solve` takes a problem and a resolution, and does what a new set of parameters needs.

    It returns what evaluates the problem's readings. `state` makes a problem of a model: UnservedError for one that the
    method does not take. `resolutions`, from coarse to fine, are what accuracy is bought with; `unit` says of what.
    """

    name: str
    language: str
    unit: str
    resolutions: tuple[float, ...]
    state: Callable[[Model], Problem]
    solve: Callable[[Problem, float], Evaluate]

    def prepare(self, problem: Problem, resolution: float) -> Evaluate:
        """Solve a problem.

        Args:
            problem: what `state` gives.
            resolution: one of `resolutions`, or any other number of `unit`.

        Returns:
            A function from ascending tau in [0, until], shape (n,), to the outputs, shape (outputs, n).
        """
        evaluate = self.solve(problem, resolution)
        return lambda taus: problem.outputs(evaluate(taus), taus)


def problem_of(model: Model) -> Problem:
    """State the problem of a model, modal damping included.

    Raises:
        UnservedError: contacts open and close.
    """
    network = model.network
    if network.contacts:
        raise UnservedError("system: a contact that opens and closes given, none expected")
    points, bars = network.points, network.bars
    damping, stiffness = (np.diag(_numbers(points, name)) for name in ("damping", "stiffness"))
    for link in network.links:
        pair = np.zeros(len(points))
        pair[link.left], pair[link.right] = nearest(link.ratio), -1.0
        damping = damping + nearest(link.damping) * np.outer(pair, pair)
        stiffness = stiffness + nearest(link.stiffness) * np.outer(pair, pair)
    events = tuple(_load_events(model))
    velocity = np.array([nearest(_start_velocity(network, number)) for number in range(len(points))])
    prescribed = tuple(number for number, point in enumerate(points) if point.motion)
    for number in prescribed:
        velocity[number] = sum(event.coefficients[0] for event in events if event.point == number and event.time == 0)
    readings, sums = _output_sums(model)
    return Problem(
        mass=_numbers(points, "mass"),
        damping=damping,
        stiffness=stiffness,
        velocity=velocity,
        prescribed=prescribed,
        ends=np.array([(bar.left, bar.right) for bar in bars], dtype=int).reshape(-1, 2),
        ratios=np.array([[nearest(ratio) for ratio in bar.ratios] for bar in bars]).reshape(-1, 2),
        delays=tuple(fraction(bar.delay) for bar in bars),
        speed=_numbers(bars, "speed"),
        impedance=_numbers(bars, "impedance"),
        start_velocity=_numbers(bars, "velocity"),
        start_strain=_numbers(bars, "strain"),
        events=events,
        readings=readings,
        sums=sums,
        until=nearest(model.until),
        modal=model.damping,
    )


def undamped_problem(model: Model) -> Problem:
    """State the problem of a model for methods that know no modes.

    Raises:
        UnservedError: contacts open and close, or modes are damped.
    """
    model.refuse_damping()
    return problem_of(model)


def gridded_problem(model: Model) -> Problem:
    """State the problem of a model for methods whose steps divide all delays.

    Raises:
        UnservedError: as `undamped_problem`, and where the delays have no common measure that is long enough.
    """
    problem = undamped_problem(model)
    if (steps := max(problem.delays) / problem.measure) > _MOST_STEPS:
        raise UnservedError(
            f"system: rods given whose delays have a common measure of 1/{float(steps):.3g} of the longest, "
            f"1/{_MOST_STEPS} at least expected"
        )
    return problem


def _start_velocity(network: Network, number: int) -> fmpq:
    """The velocity of a point at tau = 0; that of one without mass is what balances the momentum of its bars."""
    point = network.points[number]
    momentum = weight = fmpq(0)
    for bar, side in network.ends_at.get(number, ()):
        ratio, impedance = network.bars[bar].ratios[side], network.bars[bar].impedance
        momentum += ratio * impedance * network.bars[bar].velocity
        weight += ratio**2 * impedance
    return momentum / weight if point.mass == 0 and weight != 0 else point.velocity


def _load_events(model: Model) -> Iterator[LoadEvent]:
    """The loads; for a prescribed motion its velocity, which begins as the point's own."""
    units = {}
    for number, point in enumerate(model.network.points):
        if point.motion and point.velocity != 0:
            yield LoadEvent(fraction(fmpq(0)), number, _coefficients([point.velocity]))
        for unit in point.loads:
            integrated = [fmpq(0), *(fmpq(c) / (k + 1) for k, c in enumerate(unit.coefficients))]
            units[unit.source] = number, integrated if point.motion == "acceleration" else unit.coefficients
    for load in model.loads:
        if load.source in units:  # an impact is in the velocities
            number, coefficients = units[load.source]
            yield LoadEvent(fraction(load.time), number, _coefficients([load.weight * c for c in coefficients]))


def _coefficients(exact: Sequence[fmpq]) -> tuple[float, float, float]:
    """The coefficients of a load, as many as every load has."""
    a, b, c = map(nearest, (*exact, *[fmpq(0)] * (LOAD_TERMS - len(exact))))
    return a, b, c


def _output_sums(model: Model) -> tuple[tuple[Gauge, ...], OutputSums]:
    """What a method has to read, and the sums of it that are the outputs."""
    sums = [_terms(model, probe) for probe in model.probes]
    readings = list(dict.fromkeys(each for terms in sums for _, each in terms if each.quantity != "load"))
    weights, loads = np.zeros((len(sums), len(readings))), []
    for output, terms in enumerate(sums):
        for weight, each in terms:
            if each.quantity != "load":
                weights[output, readings.index(each)] = nearest(weight)
            elif each.point is not None:
                units = {unit.source: unit.coefficients for unit in model.network.points[each.point].loads}
                for load in (load for load in model.loads if load.source in units):
                    powers = np.array([nearest(weight * load.weight * c) for c in reversed(units[load.source])])
                    loads.append((output, nearest(load.time), powers))
    return tuple(readings), OutputSums(weights, tuple(loads))


def _terms(model: Model, probe: Probe) -> Sum:
    """What an output is the sum of. Where modes are damped more acts on a mass than rods and loads."""
    if probe.quantity == "acceleration" and model.damping is not None:
        return (Weighted(probe.factor, Gauge(probe.quantity, probe.rod, probe.place, probe.point)),)
    return model.sums[probe]


def _numbers(parts: Sequence[object], name: str) -> Array:
    return np.array([nearest(getattr(part, name)) for part in parts])
