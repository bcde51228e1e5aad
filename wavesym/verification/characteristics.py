"""Integration along characteristics over any network whose delays have a common measure: windows as long as that.

In a bar two waves travel unchanged. Let a be the one that arrives at an end of impedance Z and ratio n, and q the
velocity of its point: n q - a is sent back, so that the bar's force on the end is Z (2 a - n q), and

    mass q' + (damping + sum of n^2 Z) q + stiffness u = sum of 2 n Z a + loads,        u' = q,

by Lobatto IIIA, of order 4. Points without mass balance at every instant. What arrives was sent a whole number of
windows earlier, and inside a window nothing jumps or bends but where loads begin: there it is cut into panels.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

import numpy as np
from flint import fmpq

from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import UNIT_ROUNDOFF, fraction, nearest, rational
from wavesym.verification.graph import Array, Graph

# Lobatto IIIA: the integral over a step, up to its middle and up to its end, from the values at 0, 1/2 and 1
LOBATTO = np.array([[5 / 24, 1 / 3, -1 / 24], [1 / 6, 2 / 3, 1 / 6]])

# interpolation is from the ends of steps: the middles are of order 4 too, but with errors of their own, which a
# polynomial through both would make larger; a panel has enough ends for it
_STENCIL = 8
_FEWEST_STEPS = 8

COARSEST = 16
"""Steps per unit of the coarsest grid. Others divide its steps, so that twice as many are half as long."""

# per step: two products and a sum for q, four for the right side, two for the waves sent
_ROUNDINGS = 8


@dataclass(frozen=True)
class SteppedPanel:
    """Part of every window: from `start` on, `length` long, cut into `steps`.

    It owns its points, the ends and middles of its steps, numbered from `first`; both its ends are among them, so that
    a value that jumps between two panels is kept from either side.
    """

    start: fmpq
    length: fmpq
    steps: int
    first: int

    @property
    def points(self) -> slice:
        """Its points among those of the window."""
        return slice(self.first, self.first + 2 * self.steps + 1)

    @property
    def step(self) -> float:
        """The length of a step."""
        return nearest(self.length / self.steps)


@dataclass(frozen=True)
class Integrated:
    """What an integration found: `waves[before + n, side, bar]` is sent into a bar in window n, at its points.

    The windows `before` the first hold the waves that are in the bars at tau = 0. After the bars come the velocities of
    the points (on side 0). A window is `measure` long.
    """

    panels: tuple[SteppedPanel, ...]
    waves: Array
    until: float
    before: int
    measure: Fraction
    graph: Graph

    @cached_property
    def integrals(self) -> Array:
        """The integrals of the waves from the first window on, at the same points."""
        result = np.empty_like(self.waves)
        total = np.zeros(self.waves.shape[1:3])
        for n in range(len(self.waves)):
            for panel in self.panels:
                values = self.waves[n, :, :, panel.points]
                middles, ends = np.moveaxis(panel.step * stages(values) @ LOBATTO.T, -1, 0)
                sums = total[..., np.newaxis] + np.cumsum(ends, axis=-1)
                here = result[n, :, :, panel.points]
                here[..., 0] = total
                here[..., 2::2] = sums
                here[..., 1::2] = here[..., :-1:2] + middles
                total = sums[..., -1]
        return result

    def at(self, probe: Probe, taus: Sequence[float]) -> Array:
        """The values of an output at doubles 0 <= tau <= until, right-hand limits where it jumps; shape (len(taus),).

        ValueError for a tau outside.
        """
        if not all(0 <= tau <= self.until for tau in taus):
            raise ValueError(f"tau outside [0, {self.until}]")
        instants = [rational(Fraction(tau) / self.measure) for tau in taus]
        displacement = probe.quantity == "displacement"
        field = float(self.measure) * self.integrals if displacement else self.waves

        def arrived(side: int, bar: int, lag: Fraction) -> Array:
            late = rational(lag / self.measure)
            values = self._sampled(field[:, side, bar], [tau - late for tau in instants])
            return values - self._sampled(field[:, side, bar], [-late]) if displacement else values

        if probe.point is not None:
            return arrived(0, len(self.graph.delays) + probe.point, Fraction(0))
        bar = probe.rod - 1
        delay, place = self.graph.delays[bar], fraction(probe.place)
        right, left = arrived(0, bar, place * delay), arrived(1, bar, (1 - place) * delay)
        return (left - right) / self.graph.speed[bar] if probe.quantity == "strain" else left + right

    @property
    def size(self) -> int:
        """How many doubles the waves are."""
        return self.waves.size

    def roundoff(self, probe: Probe) -> float:
        """What rounding may have added to an output, absolute.

        A step rounds a few times, each time by at most u times the largest wave. Nodes and rods do not amplify what
        was rounded (no node of a chain adds energy of its own), so that over the steps it adds up at most.
        """
        steps = (len(self.waves) - 1) * sum(panel.steps for panel in self.panels)
        largest = float(np.max(np.abs(self.waves)))
        if probe.quantity == "displacement":
            largest = self.until * largest + float(np.max(np.abs(self.integrals)))
        return _ROUNDINGS * steps * float(UNIT_ROUNDOFF) * largest

    def _sampled(self, field: Array, instants: Sequence[fmpq]) -> Array:
        """A field of one node at instants (in windows), by a polynomial of degree 7 inside the panel of each.

        Which panel that is, is decided exactly.
        """
        starts = [panel.start for panel in self.panels]
        windows, firsts, offsets = [], [], []
        for instant in instants:
            n = instant.floor()
            panel = self.panels[bisect_right(starts, instant - n) - 1]
            position = (instant - n - panel.start) / panel.length * panel.steps
            first = min(max(int(position.floor()) - _STENCIL // 2 + 1, 0), panel.steps + 1 - _STENCIL)
            windows.append(int(n) + self.before)
            firsts.append(panel.first + 2 * first)
            offsets.append(nearest(position - first))
        points = np.add.outer(np.array(firsts, dtype=int), 2 * np.arange(_STENCIL))
        values = field[np.array(windows, dtype=int)[:, np.newaxis], points]
        return np.asarray(np.sum(_lagrange(np.array(offsets)) * values, axis=1))


def doubles_of(made: Graph, until: float, steps: int) -> float:
    """How many doubles an integration holds."""
    windows = (Fraction(until) + max(made.delays)) // made.measure + 2
    points = 2 * sum(panel.steps for panel in _panels(made, COARSEST)) * steps / COARSEST
    return float(windows) * 2 * (len(made.delays) + len(made.mass)) * points


def integrate(made: Graph, until: float, steps: int) -> Integrated:
    """The motion for 0 <= tau <= until, with `steps` steps (order 4) per common measure of the delays or more."""
    measure = made.measure
    lags = [int(delay / measure) for delay in made.delays]
    before, bars = max(lags), len(lags)
    windows = Fraction(until) // measure + 1
    panels = _panels(made, steps)
    waves = np.zeros((before + windows, 2, bars + len(made.mass), panels[-1].points.stop))
    strain = made.speed * made.start_strain
    waves[:before, 0, :bars] = ((made.start_velocity - strain) / 2)[:, np.newaxis]
    waves[:before, 1, :bars] = ((made.start_velocity + strain) / 2)[:, np.newaxis]
    motion = _Motion(made)
    came = before - np.array(lags)
    every = np.arange(bars)
    for n in range(windows):
        for panel in panels:
            arriving = np.empty((2 * bars, panel.points.stop - panel.points.start))
            arriving[0::2] = waves[came + n, 1, every, panel.points]
            arriving[1::2] = waves[came + n, 0, every, panel.points]
            start = (n + fraction(panel.start)) * measure
            q = motion.moved(arriving, start, float(measure) * panel.step)
            sent = made.ratios[:, np.newaxis] * q[made.ends] - arriving
            here = waves[before + n, :, :, panel.points]
            here[0, :bars], here[1, :bars], here[0, bars:] = sent[0::2], sent[1::2], q
    return Integrated(panels, waves, until, before, measure, made)


def _panels(made: Graph, steps: int) -> tuple[SteppedPanel, ...]:
    return stepped_panels((rational(event.time / made.measure) for event in made.events), steps)


class _Motion:
    """All points at once: y' = A y + what acts, for their displacements and the velocities of those with mass."""

    def __init__(self, made: Graph) -> None:
        size = len(made.mass)
        self._made = made
        given = np.isin(np.arange(size), list(made.given))
        heavy = np.flatnonzero((made.mass > 0) & ~given)
        light = np.flatnonzero((made.mass == 0) & ~given)
        impedance = np.repeat(made.impedance, 2)
        onto = np.zeros((size, len(made.ends)))
        onto[made.ends, np.arange(len(made.ends))] = made.ratios
        damping = made.damping + np.diag(onto**2 @ impedance)
        self._onto = 2 * onto * impedance
        self._given = given
        # velocities from the state, and from what acts on free points (or is the velocity of the others)
        of_state, of_acting = np.zeros((size, size + len(heavy))), np.zeros((size, size))
        of_state[heavy, size + np.arange(len(heavy))] = 1.0
        of_acting[given, given] = 1.0
        inverse = np.linalg.inv(damping[np.ix_(light, light)])
        known = np.setdiff1d(np.arange(size), light)
        held = np.hstack([-made.stiffness, np.zeros((size, len(heavy)))])  # forces by displacements
        for matrix, own in ((of_state, held), (of_acting, np.eye(size))):
            matrix[light] = inverse @ (own[light] - damping[np.ix_(light, known)] @ matrix[known])
        self._of_state, self._of_acting = of_state, of_acting
        per_mass = (1 / made.mass[heavy])[:, np.newaxis]
        force = held - damping @ of_state
        self._state = np.vstack([of_state, per_mass * force[heavy]])
        self._acting = np.vstack([of_acting, per_mass * (np.eye(size) - damping @ of_acting)[heavy]])
        self.y = np.append(np.zeros(size), made.velocity[heavy])

    def moved(self, arriving: Array, start: Fraction, step: float) -> Array:
        """The velocities of the points at the points of a panel, shape (points, points of the panel)."""
        acting = self._loads(start, step / 2 * np.arange(arriving.shape[1], dtype=float))
        acting[~self._given] += (self._onto @ arriving)[~self._given]
        size = len(self.y)
        system = np.eye(2 * size) - step * np.kron(LOBATTO[:, 1:], self._state)
        kept = np.linalg.solve(system, np.tile(np.eye(size), (2, 1)) + step * np.kron(LOBATTO[:, :1], self._state))
        forced = stages(self._acting @ acting)
        gained = step * np.einsum("ij,ynj->niy", LOBATTO, forced).reshape(forced.shape[1], 2 * size)
        gained = np.linalg.solve(system, gained.T).T
        states = np.empty((arriving.shape[1], size))
        states[0] = y = self.y
        for j, gain in enumerate(gained):
            both = kept @ y + gain
            states[2 * j + 1], y = both[:size], both[size:]
            states[2 * j + 2] = y
        self.y = y
        return np.asarray(self._of_state @ states.T + self._of_acting @ acting)

    def _loads(self, start: Fraction, local: Array) -> Array:
        """The loads that began by `start`, or the velocities that they prescribe: shape (points, times)."""
        result = np.zeros((len(self._made.mass), len(local)))
        for point in self._made.given:
            result[point] = self._made.velocity[point]
        for event in self._made.events:
            if event.time <= start:
                since = float(start - event.time) + local
                order = max(self._made.given.get(event.point, 1) - 1, 0)
                for k, c in enumerate(event.coefficients):
                    result[event.point] += c * since ** (k + order) / (k + 1 if order else 1)
        return result


def stepped_panels(times: Iterable[fmpq], steps: int) -> tuple[SteppedPanel, ...]:
    """A window cut where loads begin, at these times in windows."""
    cuts = sorted({fmpq(0), fmpq(1)} | {time - time.floor() for time in times})
    panels: list[SteppedPanel] = []
    for low, high in pairwise(cuts):
        count = max(_FEWEST_STEPS, int(((high - low) * COARSEST).ceil())) * -(-steps // COARSEST)
        panels.append(SteppedPanel(low, high - low, count, panels[-1].points.stop if panels else 0))
    return tuple(panels)


def stages(values: Array) -> Array:
    """The values at the start, middle and end of every step; (..., points) -> (..., steps, 3)."""
    return np.stack([values[..., :-1:2], values[..., 1::2], values[..., 2::2]], axis=-1)


def _lagrange(u: Array) -> Array:
    """The weights of the values at 0, 1, ... 7 for the one at u; (n,) -> (n, 8)."""
    weights = np.ones((len(u), _STENCIL))
    for j in range(_STENCIL):
        for k in range(_STENCIL):
            if k != j:
                weights[:, j] *= (u - k) / (j - k)
    return weights
