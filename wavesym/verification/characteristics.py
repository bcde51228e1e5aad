"""Direct integration of the wave equation with its boundary conditions, (2.1)-(2.4), along characteristics.

On a rod (2.1) says that two waves travel unchanged, one each way, dU/dtau their sum and dU/dx the left-going less the
right-going; at tau = 0 each is v/2, by (2.2). Let a and b be the waves that arrive at a node from its left and right
rod, and q the node's velocity. It is that of both rods, (2.3): q - a leaves to the left and q - b to the right, so that

    dU_left/dx = (q - a) - a = q - 2 a,        dU_right/dx = b - (q - b) = 2 b - q,

and (2.4), inertia U_tt + damping U_t = (beta/2) dU_right/dx - (alpha/2) dU_left/dx + loads, becomes

    inertia q' + (damping + (alpha + beta)/2) q = alpha a + beta b + loads.

What arrives was sent one unit of tau earlier. So the nodes are independent of each other on every window [n, n + 1),
and inside a window nothing jumps or bends but at the fractional parts of the load times: there it is cut into panels.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import prod

import numpy as np
from flint import fmpq, fmpq_poly
from numpy.typing import NDArray

from wavesym.errors import CostError
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.node import Node
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import UNIT_ROUNDOFF, nearest, rational

Array = NDArray[np.float64]

LEFT, RIGHT = 0, 1  # which way a wave goes

MOST_DOUBLES = 50_000_000

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


def integrate(chain: Chain, loads: Sequence[Applied], until: float, steps: int) -> Integrated:
    """The motion of a chain under `loads` for 0 <= tau <= until, with `steps` steps (order 4) per unit of tau or more.

    Dimensionless. ValueError for a load whose source the chain does not have, CostError where it would not fit into
    memory.
    """
    windows = int(rational(until).floor()) + 1
    panels = stepped_panels((load.time for load in loads), steps)
    shape = windows + 1, 2, len(chain.nodes), panels[-1].points.stop
    if prod(shape) > MOST_DOUBLES:
        raise CostError(
            f"output.until: direct integration would hold {float(prod(shape)):.1e} doubles, at most {MOST_DOUBLES:.1e} "
            "expected (a shorter horizon, fewer rods or fewer load times help)"
        )
    waves = np.zeros(shape)
    for x, node in enumerate(chain.nodes):  # the window before tau = 0
        waves[0, LEFT, x] = nearest(node.left.velocity / 2) if node.left else 0.0
        waves[0, RIGHT, x] = nearest(node.right.velocity / 2) if node.right else 0.0
    bodies = _NodeSteps(chain.nodes)
    forces = _NodeForces(chain, loads)
    arriving = np.zeros((2, *waves.shape[2:]))
    for n in range(windows):
        arriving[RIGHT, 1:] = waves[n, RIGHT, :-1]
        arriving[LEFT, :-1] = waves[n, LEFT, 1:]
        for panel in panels:
            a, b = arriving[RIGHT, :, panel.points], arriving[LEFT, :, panel.points]
            q = bodies.moved(a, b, forces.on(n, panel), panel.step)
            waves[n + 1, LEFT, :, panel.points] = q - a
            waves[n + 1, RIGHT, :, panel.points] = q - b
    return Integrated(panels, waves, until)


@dataclass(frozen=True)
class Integrated:
    """What an integration found: `waves[1 + n, direction, x]` is sent by the node at x, at the points of window n.

    Window -1 (all of them `before` the first) holds the waves that are in the rods at tau = 0.
    """

    panels: tuple[SteppedPanel, ...]
    waves: Array
    until: float
    before: int = 1

    @cached_property
    def integrals(self) -> Array:
        """The integrals of the waves from tau = -1 on, at the same points."""
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
        instants = [rational(tau) for tau in taus]
        displacement = probe.quantity == "displacement"
        field = self.integrals if displacement else self.waves

        def arrived(direction: int, node: int, lag: fmpq) -> Array:
            values = self._sampled(field[:, direction, node], [tau - lag for tau in instants])
            return values - self._sampled(field[:, direction, node], [-lag]) if displacement else values

        right, left = arrived(RIGHT, probe.rod - 1, probe.place), arrived(LEFT, probe.rod, 1 - probe.place)
        return left - right if probe.quantity == "strain" else left + right

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


class _NodeSteps:
    """The nodes' conditions, for all of them at once."""

    def __init__(self, nodes: Sequence[Node]) -> None:
        inertia = _column(node.inertia for node in nodes)
        self.alpha = _column(node.alpha for node in nodes)
        self.beta = _column(node.beta for node in nodes)
        self.gamma = _column(node.damping for node in nodes) + (self.alpha + self.beta) / 2
        self.massive = np.flatnonzero(inertia)
        self.inertia = inertia[self.massive]
        # a body moves at first with the rod that is fixed to it
        self.q = np.array([nearest(nodes[x].velocity) for x in self.massive.tolist()])

    def moved(self, a: Array, b: Array, loads: Array, step: float) -> Array:
        """The velocities of the nodes at the points of a panel, all of shape (nodes, points)."""
        right = self.alpha * a + self.beta * b + loads
        result = right / self.gamma  # what balances at once where there is no inertia
        if self.massive.size:
            result[self.massive] = self._carried(right[self.massive] / self.inertia, step)
            self.q = result[self.massive, -1]
        return result

    def _carried(self, right: Array, step: float) -> Array:
        """q' + rate q = right from the present q on, by Lobatto IIIA; exact in q, as the equation is linear."""
        z = self.gamma[self.massive] / self.inertia * step
        system = np.eye(2) + z[..., np.newaxis] * LOBATTO[:, 1:]
        kept = np.linalg.solve(system, 1 - z[..., np.newaxis] * LOBATTO[:, :1])[..., 0]
        gained = np.linalg.solve(system, step * LOBATTO @ np.swapaxes(stages(right), 1, 2))
        result = np.empty_like(right)
        q = self.q
        result[:, 0] = q
        for j, gain in enumerate(np.ascontiguousarray(gained[:, 1].T)):
            q = kept[:, 1] * q + gain
            result[:, 2 * j + 2] = q
        result[:, 1::2] = kept[:, :1] * result[:, :-1:2] + gained[:, 0]
        return result


class _NodeForces:
    """The loads at the nodes, polynomials in the time since the start of the present panel; panels come in order."""

    def __init__(self, chain: Chain, loads: Sequence[Applied]) -> None:
        self._coming: dict[fmpq, list[tuple[int, fmpq_poly]]] = defaultdict(list)
        for load in loads:
            if load.source == "impact":  # that is in the rods' initial velocities
                continue
            if load.source not in chain.loaded:
                raise ValueError(f"{load.source}: no such load")
            x, unit = chain.loaded[load.source]
            self._coming[load.time].append((x, load.weight * fmpq_poly(list(unit.coefficients))))
        self._now = {x: fmpq_poly() for x, _ in chain.loaded.values()}
        self._nodes = len(chain.nodes)

    def on(self, window: int, panel: SteppedPanel) -> Array:
        """The loads at the points of the panel in a window, shape (nodes, points)."""
        for x, new in self._coming.get(window + panel.start, ()):
            self._now[x] += new
        local = panel.step / 2 * np.arange(2 * panel.steps + 1)
        result = np.zeros((self._nodes, len(local)))
        for x, load in self._now.items():
            for coefficient in reversed(load.coeffs()):
                result[x] = result[x] * local + nearest(coefficient)
            self._now[x] = load(fmpq_poly([panel.length, 1]))
        return result


def stepped_panels(times: Iterable[fmpq], steps: int) -> tuple[SteppedPanel, ...]:
    """A window cut where loads begin, at these times in windows."""
    cuts = sorted({fmpq(0), fmpq(1)} | {time - time.floor() for time in times})
    panels: list[SteppedPanel] = []
    for low, high in pairwise(cuts):
        count = max(_FEWEST_STEPS, int(((high - low) * COARSEST).ceil())) * -(-steps // COARSEST)
        panels.append(SteppedPanel(low, high - low, count, panels[-1].points.stop if panels else 0))
    return tuple(panels)


def _column(values: Iterable[fmpq]) -> Array:
    return np.array([[nearest(value)] for value in values])


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
