"""A network in doubles, as the wave equation in its bars and the balance of forces at its points say it.

In a bar U_tt = speed^2 U_xx, and its force is impedance * speed * U_x. Its end moves `ratio` times as fast as its
point, on which `ratio` times its force acts. At the points, all at once,

    mass u'' + damping u' + stiffness u = sum over ends of ratio * force of the bar + loads + pushes of contacts.

A contact between two points keeps its gap from being negative; while that is 0 it pushes, and never pulls.

At tau = 0 nothing is displaced: what a bar is strained then is counted besides. Every method but wavesym's own starts
here, and the integrators of `verify`: nothing knows of joints, waves or their laws. All is dimensionless.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm
from typing import NamedTuple

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.mechanics.damping import Damping
from wavesym.mechanics.gauge import Gauge
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import fraction, nearest, not_below, rational

Evaluate = Callable[[Array], Array]
"""Ascending tau in [0, until], shape (n,), to outputs, shape (outputs, n)."""

LOAD_TERMS = 3
"""Loads are polynomials in tau of at most this many terms: a ramp of acceleration is a parabola of ground velocity."""


@dataclass(frozen=True)
class LoadEvent:
    """From `time` on, the load on a point has sum_k coefficients[k] (tau - time)**k more."""

    time: Fraction
    point: int
    coefficients: tuple[float, float, float]


class ReadWave(NamedTuple):
    """So many times the wave, as a velocity, that an end sent `late` before; beyond the ends it is that of a point."""

    end: int
    weight: float
    late: Fraction


@dataclass(frozen=True)
class Problem:
    """Bars, and points that their ends move with.

    `velocity` and `mass` have shape (points,), `damping` and `stiffness` (points, points). The velocity of a point
    of `prescribed_points` is its load, at tau = 0, too; displacements relative to the `ground` are those beyond
    that of this point. `ends` has the points of each bar's left and right end, `ratios` their ratios, both (bars, 2);
    `speed`, `impedance`, `start_velocity`, `start_strain` (in the middle), `start_slope` (how fast the waves held at
    first grow as they come to an end) and `gravity` (along each bar, whose waves do not have it) have shape (bars,).
    `modal` is how modes are damped besides. The gaps of contacts are `gaps` + `parting` @ displacements, (contacts,);
    their pushes act on points by `parting` transposed.
    """

    mass: Array
    damping: Array
    stiffness: Array
    velocity: Array
    prescribed_points: tuple[int, ...]
    ground: int
    ends: NDArray[np.int_]
    ratios: Array
    delays: tuple[Fraction, ...]
    speed: Array
    impedance: Array
    start_velocity: Array
    start_strain: Array
    start_slope: Array
    gravity: Array
    gaps: Array
    parting: Array
    events: tuple[LoadEvent, ...]
    probes: tuple[Probe, ...]
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
        """The waves in the middle of each bar at tau = 0, from its left and its right end: (bars, 2)."""
        turned = self.speed * self.start_strain
        return np.stack([self.start_velocity - turned, self.start_velocity + turned], axis=1) / 2

    def held_waves(self, end: int, sent: Array) -> Array:
        """What a bar holds at tau = 0 of the waves that were sent from an end at instants before."""
        bar, side = divmod(end, 2)
        return np.asarray(self.start_waves[bar, side] + self.start_slope[bar] * (sent + self.delay[bar] / 2))

    def waves(self, reading: Gauge) -> tuple[ReadWave, ...]:
        """The waves that a strain, velocity, displacement or acceleration is read from: two on a bar, one at a point.

        A displacement is the sum of their integrals, an acceleration that of their derivatives.
        """
        if reading.point is not None:
            return (ReadWave(self.ends.size + reading.point, 1.0, Fraction(0)),)
        bar, place = reading.rod - 1, fraction(reading.place)
        over = 1 / float(self.speed[bar]) if reading.quantity == "strain" else 1.0
        return tuple(
            ReadWave(2 * bar + side, weight * over, part * self.delays[bar])
            for side, (weight, part) in enumerate(zip(reading.weights, (place, 1 - place), strict=True))
        )

    def held_part(self, end: int, taus: Array, late: float, order: int) -> Array:
        """What of a wave that comes so `late` is from before tau = 0: (taus,).

        Its value or derivative (`order` 0, 1) as if nothing else had been sent, or its integral from 0 on (-1).
        """
        if end >= self.ends.size:  # of a point
            return np.zeros(len(taus))
        if order > 0:
            return np.full(len(taus), self.start_slope[end // 2])
        if order == 0:
            return self.held_waves(end, taus - late)
        held = np.minimum(taus, late)  # of this length it has come
        return held * self.held_waves(end, held / 2 - late)

    def weight_strain(self, bar: int, place: float) -> float:
        """The strain that a bar has besides that of its waves, at a part of its length."""
        return float(self.gravity[bar] * self.delay[bar] / (2 * self.speed[bar]) * (1 - 2 * place))

    @cached_property
    def incidence(self) -> Array:
        """What a force of 1 at each end of a bar is at the points: (points, 2 * bars), left and right ends by turns."""
        matrix = np.zeros((self.points, self.ends.size))
        matrix[self.ends.ravel(), np.arange(self.ends.size)] = self.ratios.ravel()
        return matrix

    def load_means(self, low: Array, high: Array) -> Array:
        """The means of the loads over intervals [low, high], each (n,): shape (n, points)."""
        total = np.zeros((len(low), self.points))
        for event in self.events:
            start = float(event.time)
            first, last = np.maximum(low - start, 0.0), np.maximum(high - start, 0.0)
            for k, c in enumerate(event.coefficients):
                total[:, event.point] += c / (k + 1) * (last ** (k + 1) - first ** (k + 1)) / (high - low)
        return total

    @cached_property
    def _polynomials(self) -> dict[int, tuple[Array, Array]]:
        """Of each loaded point when its load changes, and what that is from then on, in the time since: (changes,),
        (LOAD_TERMS, changes). They are added up exactly, as what changes of long records cancel."""
        changes: dict[int, dict[Fraction, list[Fraction]]] = {}
        for event in sorted(self.events, key=lambda event: event.time):
            known = changes.setdefault(event.point, {})
            c0, c1, c2 = [Fraction(0)] * LOAD_TERMS
            if known:
                since = event.time - (last := next(reversed(known)))
                c0, c1, c2 = known[last]
                c0, c1 = c0 + since * (c1 + since * c2), c1 + 2 * since * c2
            known[event.time] = [c + Fraction(more) for c, more in zip((c0, c1, c2), event.coefficients, strict=True)]
        return {
            point: (
                np.array([not_below(rational(time)) for time in known]),
                np.array([[float(c) for c in powers] for powers in known.values()]).T,
            )
            for point, known in changes.items()
        }

    def loads(self, taus: Array) -> Array:
        """The loads at doubles tau, right-hand limits: (points, taus)."""
        values = np.zeros((self.points, len(taus)))
        for point, (times, (c0, c1, c2)) in self._polynomials.items():
            place = np.searchsorted(times, taus, side="right") - 1
            since = taus - times[place]
            values[point] = np.where(place >= 0, c0[place] + since * (c1[place] + since * c2[place]), 0.0)
        return values

    @cached_property
    def end_points(self) -> NDArray[np.int_]:
        """The point of each end, the left one of bar b at 2 b, the right one at 2 b + 1: (2 bars,)."""
        return self.ends.ravel()

    @cached_property
    def end_ratios(self) -> Array:
        """The ratio of each end: (2 bars,)."""
        return self.ratios.ravel()

    def rigid_motion(
        self,
        point: int,
        *,
        bars: bool = False,
        springs: bool = False,
        held: Collection[int] = (),
        parting: Array | None = None,
    ) -> tuple[Array, Array]:
        """How fast points (points,) and bars (bars,) move with a point of velocity 1, all contacts closed.

        Or those of `parting` alone. With `bars` these are rigid, with `springs` springs and dashpots are, too. Other
        points that are `held`, and what is not reached, have velocity 0.
        """
        points, rods = np.zeros(self.points), np.zeros(len(self.delays))
        linked = (self.damping != 0) | (self.stiffness != 0)
        points[point], waiting = 1.0, [point]
        while waiting:
            here = waiting.pop()
            found = [
                (int(o), -row[here] / row[o] * points[here])
                for row in (self.parting if parting is None else parting)
                for o in np.flatnonzero(row)
                if row[here] != 0
            ]
            if bars:
                for end in np.flatnonzero(self.end_points == here).tolist():
                    rods[end // 2] = self.end_ratios[end] * points[here]
                    found.append((int(self.end_points[end ^ 1]), rods[end // 2] / self.end_ratios[end ^ 1]))
            if springs:
                found += [(int(other), points[here]) for other in np.flatnonzero(linked[here])]
            for other, speed in found:
                if points[other] == 0 and other not in held:
                    points[other] = speed
                    waiting.append(other)
        return points, rods

    @cached_property
    def _sums(self) -> tuple[dict[Gauge, Array], Array, Array]:
        """What outputs are the sums of: times readings, each with (outputs,) weights; loads (outputs, points); and
        what never changes, (outputs,)."""
        readings: dict[Gauge, Array] = {}
        loads, constants = np.zeros((len(self.probes), self.points)), np.zeros(len(self.probes))
        for output, probe in enumerate(self.probes):
            for weight, reading in output_terms(self, probe):
                row = loads[:, reading.point] if reading.quantity == "load" else None
                if row is None:
                    row = readings.setdefault(reading, np.zeros(len(self.probes)))
                row[output] += nearest(probe.factor) * weight
                if probe.computed_quantity in ("strain", "force"):
                    more = self.weight_strain(probe.rod - 1, nearest(probe.place))
                    constants[output] += nearest(probe.factor) * weight * more
        return readings, loads, constants

    @property
    def readings(self) -> tuple[Gauge, ...]:
        """The strains, velocities and displacements that outputs are sums of; of damped modes accelerations, too."""
        return tuple(self._sums[0])

    @cached_property
    def weights(self) -> Array:
        """What the readings count in outputs: (outputs, readings)."""
        columns = list(self._sums[0].values())
        return np.stack(columns, axis=1) if columns else np.zeros((len(self.probes), 0))

    @property
    def load_weights(self) -> Array:
        """What the loads on points count in outputs: (outputs, points)."""
        return self._sums[1]

    @cached_property
    def reads_outputs(self) -> bool:
        """Whether outputs are the readings themselves."""
        return not (np.any(self.load_weights) or np.any(self._sums[2])) and np.array_equal(
            self.weights, np.eye(len(self.probes))
        )

    def strain_at_start(self, reading: Gauge) -> float:
        """What a reading has of the strain of the waves at tau = 0."""
        if reading.quantity != "strain":
            return 0.0
        bar = reading.rod - 1
        growth = 2 * self.start_slope[bar] * self.delay[bar] / self.speed[bar]
        return float(self.start_strain[bar] + growth * (nearest(reading.place) - 0.5))

    def outputs(self, values: Array, taus: Array) -> Array:
        """The outputs, (outputs, n), from the values (readings, n) of the readings at `taus` (n,)."""
        if self.reads_outputs:
            return values
        total = self.weights @ values + self._sums[2][:, np.newaxis]
        if np.any(self.load_weights):
            total += self.load_weights @ self.loads(taus)
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


def output_terms(problem: Problem, probe: Probe) -> Iterator[tuple[float, Gauge]]:
    """So many times strains, velocities, displacements and loads on points: what an output is the sum of.

    How a mass is accelerated the balance of forces says; what has none is read. What contacts hold together has no
    mass but that one: multiplied by how fast its points would move together, and added up, their balances are without
    pushes, whether contacts are open or closed. Where modes are damped more acts on it than rods and loads, so that it
    is read.
    """
    bar, here = probe.rod - 1, Gauge(probe.quantity, probe.rod, probe.place, probe.point)
    match probe.computed_quantity:
        case "acceleration" if problem.modal is None and (known := _acceleration(problem, probe)):
            yield from known
        case "force":
            yield float(problem.impedance[bar] * problem.speed[bar]), replace(here, quantity="strain")
        case "drift":
            yield 1.0, Gauge("displacement", probe.rod, fmpq(1))
            yield -1.0, Gauge("displacement", probe.rod, fmpq(0))
        case "relative":
            yield 1.0, replace(here, quantity="displacement")
            yield -1.0, _at_point("displacement", problem.ground)
        case _:
            yield 1.0, here


def _acceleration(problem: Problem, probe: Probe) -> list[tuple[float, Gauge]]:
    """All that acts on a mass, and on what touches it, but loads and pushes as they work where points are so fast.

    Nothing where there is no mass.
    """
    point, ratio = probe.point, 1.0
    if point is None:
        if probe.place not in (0, 1):
            return []
        end = 2 * (probe.rod - 1) + int(probe.place)
        point, ratio = int(problem.end_points[end]), float(problem.end_ratios[end])
    if problem.mass[point] == 0:
        return []
    found: list[tuple[float, Gauge]] = []
    speeds = problem.rigid_motion(point)[0] * (ratio / float(problem.mass[point]))
    stiffness = np.repeat(problem.impedance * problem.speed, 2) * np.tile([1.0, -1.0], len(problem.speed))
    for end, force in enumerate((speeds @ problem.incidence * stiffness).tolist()):
        if speeds[problem.end_points[end]]:
            found.append((force, Gauge("strain", end // 2 + 1, fmpq(end % 2))))
    unit = np.eye(problem.points)
    for matrix, quantity in ((-problem.damping, "velocity"), (-problem.stiffness, "displacement"), (unit, "load")):
        held = speeds @ matrix
        found += [(float(held[number]), _at_point(quantity, number)) for number in np.flatnonzero(held).tolist()]
    return found


def _at_point(quantity: str, point: int) -> Gauge:
    return Gauge(quantity, 0, fmpq(0), point)
