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
from wavesym.programs.march.operator import Array, PanelOperator, Sweeps, operator
from wavesym.programs.march.plan import LEFT, LOAD, RIGHT, Plan

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


class Run:
    """A march at some degree; dimensionless."""

    def __init__(self, plan: Plan, degree: int) -> None:
        self.plan = plan
        self.degree = degree
        nodes = plan.junctions
        self.massive = [c for c, node in enumerate(nodes) if node.rate is not None]
        self.operators = operators(plan, degree)
        self.alpha = np.array([[nearest(node.alpha)] for node in nodes])
        self.beta = np.array([[nearest(node.beta)] for node in nodes])
        rates = [node.rate for node in nodes if node.rate is not None]
        self.steps = [_Step([self.operators[rate * panel.length] for rate in rates], degree) for panel in plan.panels]
        self._loads = _Loads(plan)

    def blocks(self) -> Iterator[Block]:
        """The whole horizon, in order; a run can be taken once."""
        plan, size = self.plan, self.degree + 1
        last = np.zeros((plan.ways, len(plan.panels), len(plan.junctions) + 2, size))
        rods = np.array([nearest(v) for v in plan.rods])
        # a node sends what its rod holds: its left rod to the left; what comes in at the ends is sent by no node
        last[LEFT, :, 1:, 0] = rods
        last[RIGHT, :, :-1, 0] = rods
        q = np.array([nearest(node.motion) for node in plan.junctions])
        for first in range(0, plan.windows, _BLOCK):
            count = min(_BLOCK, plan.windows - first)
            waves = np.empty((count + 1, *last.shape))
            waves[:] = last
            shape = count, len(plan.panels), len(plan.junctions)
            starts, ends, excess, forces = (np.zeros(shape) for _ in range(4))
            for n in range(count):
                for p in range(len(plan.panels)):
                    a, b = waves[n, RIGHT, p, :-2], waves[n, LEFT, p, 2:]
                    balance = self.alpha * a + self.beta * b
                    forces[n, p] = self._loads.add(balance, waves[n + 1, LOAD:, p], first + n, p)
                    starts[n, p] = q
                    moved = balance.copy()
                    moved[self.massive], q[self.massive] = self.steps[p].moved(balance[self.massive], q[self.massive])
                    ends[n, p] = q
                    excess[n, p] = moved[:, -1] - balance[:, -1]
                    waves[n + 1, LEFT, p, 1:-1] = moved - a
                    waves[n + 1, RIGHT, p, 1:-1] = moved - b
            last = waves[-1]
            yield Block(waves[:-1], waves[1:], starts, ends, excess, forces)


def operators(plan: Plan, degree: int) -> dict[fmpq, PanelOperator]:
    """One for every different rate times length of a panel."""
    return {step: operator(step, degree) for step in steps(plan)}


def operator_count(plan: Plan) -> int:
    """How many those are."""
    return len(steps(plan))


def steps(plan: Plan) -> dict[fmpq, None]:
    rates = dict.fromkeys(node.rate for node in plan.junctions if node.rate is not None)
    return dict.fromkeys(rate * panel.length for panel in plan.panels for rate in rates)


class _Step:
    """All bodies on one panel."""

    def __init__(self, of: list[PanelOperator], degree: int) -> None:
        def table(rows: list[tuple[float, ...]]) -> Array:
            return np.array(rows).reshape(len(of), degree + 1)

        self.ratio = table([o.ratio for o in of])
        self.first, self.last = table([o.first for o in of]), table([o.last for o in of])
        self.slack = np.array([o.slack for o in of])
        self.loss = np.array([o.loss for o in of])
        self.sweeps = Sweeps(self.ratio)

    def moved(self, balance: Array, start: Array) -> tuple[Array, Array]:
        """q (..., bodies, coefficient) and its value at the end (..., bodies), from p and the value at the start."""
        difference = np.zeros_like(balance)
        difference[..., 1:] = balance[..., :-1]
        difference[..., 1] *= 2
        difference[..., 1:-1] -= balance[..., 2:]
        difference *= self.ratio
        y = self.sweeps.down(difference)
        first = start - _total(self.first * y)
        mean = first - self.slack * first
        end = mean + (_total(self.last * y) - self.loss * mean)
        y[..., 0] = 2 * mean
        y = self.sweeps.up(y)
        y[..., 0] = mean
        return y, end


class _Loads:
    """The forces, polynomials in the time since their last event."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._coming = list(reversed(plan.events))
        self._now: dict[int, tuple[int, int, list[float]]] = {}
        self._start = [[nearest(p.start - q.start) for q in plan.panels] for p in plan.panels]
        self._half = [nearest(panel.length / 2) for panel in plan.panels]

    def add(self, balance: Array, heard: Array, window: int, panel: int) -> Array:
        """Add the loads of a panel to p, and set what is `heard` of them; how large they are, by column."""
        while self._coming and (self._coming[-1].window, self._coming[-1].panel) == (window, panel):
            event = self._coming.pop()
            self._now[event.force] = window, panel, [nearest(c) for c in event.powers]
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


def _total(values: Array) -> Array:
    """Sums along the last axis, in pairs, so that each term is rounded as often as its number has bits."""
    while (count := values.shape[-1]) > 1:
        half = count // 2
        folded = values[..., : count - half].copy()
        folded[..., :half] += values[..., count - half :]
        values = folded
    return values[..., 0]
