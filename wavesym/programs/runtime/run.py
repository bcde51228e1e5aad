"""The march itself in NumPy, over all nodes at once: what the generated programs do, watched by the generator.

A window's waves are an array (direction, panel, column + 1, coefficient): direction LEFT or RIGHT of the wave that a
column sends, with one more column at either end for what arrives from outside the light cone, which never changes.
Where loads are heard, they are one more direction, by number + 1.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from flint import fmpq

from wavesym.numbers.doubles import nearest
from wavesym.programs.march.body import Array, BodyOperator, body_operator
from wavesym.programs.march.load_events import LoadEvent
from wavesym.programs.runtime.line import LEFT, LOAD, RIGHT, Plan

_BLOCK = 64


@dataclass(frozen=True)
class Block:
    """Some windows, of one march or of many: the waves sent on each of them, and those of the window `before` it.

    `starts` and `ends` are the velocities q of the nodes at the start and end of every panel, `excess` the last
    coefficient of q - p, `forces` bounds of what the loads add to p: all of shape (windows, panels, columns).
    """

    before: Array
    after: Array
    starts: Array
    ends: Array
    excess: Array
    forces: Array


@dataclass(frozen=True)
class Since:
    """Where a march goes on: at the start of `window`, from the waves sent on the window before, of any lower degree,
    and the `velocities` of the nodes.
    """

    window: int
    waves: Array
    velocities: Array


class Run:
    """A march at some degree; dimensionless."""

    def __init__(self, plan: Plan, degree: int) -> None:
        self.plan = plan
        self.degree = degree
        nodes = plan.junctions
        self._massive = np.array([c for c, node in enumerate(nodes) if node.rate is not None], dtype=np.intp)
        self.operators = operators(plan, degree)
        self.alpha = np.array([[nearest(node.alpha)] for node in nodes])
        self.beta = np.array([[nearest(node.beta)] for node in nodes])
        rates = [node.rate for node in nodes if node.rate is not None]
        self._step = _Step([[self.operators[rate * panel.length] for rate in rates] for panel in plan.panels], degree)

    def blocks(self, since: Since | None = None, length: int | None = None) -> Iterator[Block]:
        """The horizon from its start or `since` on, in order, at most `length` windows at once."""
        plan, length = self.plan, length or _BLOCK
        since = since or _rest(plan)
        last = np.zeros((*since.waves.shape[:-1], self.degree + 1))
        last[..., : since.waves.shape[-1]] = since.waves
        q, loads = since.velocities, _Loads(plan, since.window)
        for first in range(since.window, plan.windows, length):
            count = min(length, plan.windows - first)
            waves = np.empty((count + 1, *last.shape))
            waves[:] = last
            shape = count, len(plan.panels), len(plan.junctions)
            starts, ends, excess, forces = (np.zeros(shape) for _ in range(4))
            for n in range(count):
                a, b = waves[n, RIGHT, :, :-2], waves[n, LEFT, :, 2:]
                balance = self.alpha * a + self.beta * b
                for p in range(len(plan.panels)):
                    forces[n, p] = loads.add(balance[p], waves[n + 1, LOAD:, p], first + n, p)
                moved, starts[n], ends[n] = self.moved(balance, q)
                q = ends[n, -1]
                excess[n] = moved[..., -1] - balance[..., -1]
                waves[n + 1, LEFT, :, 1:-1] = moved - a
                waves[n + 1, RIGHT, :, 1:-1] = moved - b
            last = waves[-1]
            yield Block(waves[:-1], waves[1:], starts, ends, excess, forces)

    def moved(self, balance: Array, start: Array) -> tuple[Array, Array, Array]:
        """q on all panels of a window (..., panels, columns, coefficient) and its values at their starts and ends
        (..., panels, columns), from p and the value at the start of the window (..., columns).
        """
        q = balance.copy()
        starts = np.empty(balance.shape[:-1])
        starts[:] = start[..., np.newaxis, :]
        ends = starts.copy()
        massive = self._massive
        held = np.take(balance, massive, axis=-2), np.take(start, massive, axis=-1)
        q[..., massive, :], starts[..., massive], ends[..., massive] = self._step.moved(*held)
        return q, starts, ends


def _rest(plan: Plan) -> Since:
    """The start of the horizon."""
    waves = np.zeros((plan.ways, len(plan.panels), len(plan.junctions) + 2, 1))
    rods = np.array([nearest(v) for v in plan.rods])
    # a node sends what its rod holds: its left rod to the left; what comes in at the ends is sent by no node
    waves[LEFT, :, 1:, 0] = rods
    waves[RIGHT, :, :-1, 0] = rods
    return Since(0, waves, np.array([nearest(node.motion) for node in plan.junctions]))


def operators(plan: Plan, degree: int) -> dict[fmpq, BodyOperator]:
    """One for every different rate times length of a panel."""
    return {step: body_operator(step, degree) for step in steps(plan)}


def operator_count(plan: Plan) -> int:
    """How many those are."""
    return len(steps(plan))


def steps(plan: Plan) -> dict[fmpq, None]:
    rates = dict.fromkeys(node.rate for node in plan.junctions if node.rate is not None)
    return dict.fromkeys(rate * panel.length for panel in plan.panels for rate in rates)


class _Step:
    """All bodies on all panels of a window. What arrives is known, so that only their velocities go from panel to
    panel.
    """

    def __init__(self, of: list[list[BodyOperator]], degree: int) -> None:
        shape = len(of), len(of[0])
        self.ratio = np.array([[o.ratio for o in row] for row in of]).reshape(*shape, degree + 1)
        self.sides = np.array([[(o.first, o.last) for o in row] for row in of]).reshape(*shape, 2, degree + 1)
        self.slack = np.array([[o.slack for o in row] for row in of])
        self.loss = np.array([[o.loss for o in row] for row in of])
        self.sweeps = Sweeps(self.ratio)

    def moved(self, balance: Array, start: Array) -> tuple[Array, Array, Array]:
        """q (..., panels, bodies, coefficient) and its values at the starts and ends of panels (..., panels, bodies),
        from p and the value at the start of the window (..., bodies).
        """
        difference = np.zeros_like(balance)
        difference[..., 1:] = balance[..., :-1]
        difference[..., 1] *= 2
        difference[..., 1:-1] -= balance[..., 2:]
        difference *= self.ratio
        y = self.sweeps.down(difference)
        sums = _total(self.sides * y[..., np.newaxis, :])
        early, late = sums[..., 0], sums[..., 1]
        starts, means, ends = np.empty((3, *early.shape))
        for p in range(len(self.slack)):
            starts[..., p, :] = start
            first = start - early[..., p, :]
            means[..., p, :] = mean = first - self.slack[p] * first
            ends[..., p, :] = start = mean + (late[..., p, :] - self.loss[p] * mean)
        y[..., 0] = 2 * means
        y = self.sweeps.up(y)
        y[..., 0] = means
        return y, starts, ends


class _Loads:
    """The forces from window `first` on, polynomials in the time since their last event."""

    def __init__(self, plan: Plan, first: int) -> None:
        self._plan = plan
        self._coming = [event for event in reversed(plan.events) if event.window >= first]
        self._now: dict[int, tuple[int, int, list[float]]] = {}
        for event in {event.force: event for event in plan.events if event.window < first}.values():
            self._act(event)
        self._start = [[nearest(p.start - q.start) for q in plan.panels] for p in plan.panels]
        self._half = [nearest(panel.length / 2) for panel in plan.panels]

    def add(self, balance: Array, heard: Array, window: int, panel: int) -> Array:
        """Add the loads of a panel to p, and set what is `heard` of them; how large they are, by column."""
        while self._coming and (self._coming[-1].window, self._coming[-1].panel) == (window, panel):
            self._act(self._coming.pop())
        sizes = np.zeros(len(balance))
        half = self._half[panel]
        for force, (since, place, (c0, c1, c2)) in self._now.items():
            middle = (window - since) + self._start[panel][place] + half
            column = self._plan.loaded[force]
            mean = c0 + middle * c1 + (middle * middle + 0.5 * half * half) * c2
            series = mean, half * (c1 + 2.0 * middle * c2), 0.5 * half * half * c2
            balance[column, :3] += series
            heard[:, force + 1, :3] = series
            reach = middle + half
            sizes[column] = 2 * (abs(c0) + reach * abs(c1) + 2 * reach * reach * abs(c2))
        return sizes

    def _act(self, event: LoadEvent) -> None:
        self._now[event.force] = event.window, event.panel, [nearest(c) for c in event.powers]


def _total(values: Array) -> Array:
    """Sums along the last axis, in pairs, so that each term is rounded as often as its number has bits."""
    while (count := values.shape[-1]) > 1:
        half = count // 2
        folded = values[..., : count - half].copy()
        folded[..., :half] += values[..., count - half :]
        values = folded
    return values[..., 0]


class Sweeps:
    """The recurrences of some operators on arrays, each as a scan: log2(degree) steps instead of degree.

    `down(v)` solves w_k = v_k + e_k w_(k+1), `up(v)` solves w_k = v_k - e_k w_(k-1), along the last axis, for rows of
    coefficients 0 ... degree that belong to the operators in order (the axis before).
    """

    def __init__(self, ratio: Array) -> None:
        self._down = _strides(ratio, backwards=True)
        self._up = _strides(-ratio, backwards=False)

    @property
    def levels(self) -> int:
        """Into how many additions an input goes at most, less one."""
        return max(len(self._down), len(self._up))

    def down(self, values: Array) -> Array:
        """From the last coefficient to the first."""
        result = values.copy()
        for stride, products in self._down:
            result[..., :-stride] += products * result[..., stride:]
        return result

    def up(self, values: Array) -> Array:
        """From the first coefficient to the last."""
        result = values.copy()
        for stride, products in self._up:
            result[..., stride:] += products * result[..., :-stride]
        return result


NEGLIGIBLE = 2.0**-100
"""Products of ratios below it are left out of a scan: all of them together are far below one rounding."""


def _strides(factor: Array, *, backwards: bool) -> list[tuple[int, Array]]:
    """For stride 1, 2, 4 ... the products of as many factors; none where they are too small to matter."""
    result = []
    stride, products = 1, factor
    while stride < factor.shape[-1] and np.max(np.abs(products), initial=0.0) > NEGLIGIBLE:
        longer = np.zeros_like(products)
        if backwards:
            result.append((stride, products[..., :-stride].copy()))
            longer[..., :-stride] = products[..., :-stride] * products[..., stride:]
        else:
            result.append((stride, products[..., stride:].copy()))
            longer[..., stride:] = products[..., stride:] * products[..., :-stride]
        stride, products = 2 * stride, longer
    return result
