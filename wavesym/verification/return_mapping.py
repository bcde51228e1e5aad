"""Friction and springs with a law by central differences, which pull back what went too far: return mapping.

`wavesym/methods/differences.py` has the steps. What rubs pulls in the mean from t - h to t + h what keeps it from
moving, as much as it can; a spring pulls as much as it is longer, and what is beyond its limits becomes permanent.
Nothing is known of events. Fronts stay as sharp as they are, and outputs are read where none is within a few cells.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.differences import Grid, fields, point_steps
from wavesym.methods.elements import keep_places
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import UNIT_ROUNDOFF
from wavesym.verification.link_pulls import find_pulls
from wavesym.verification.problem import CornerProblem, LinkLaw, OneSidedStep

REACH = 4
"""Steps before and after an instant, and cells beside a place, that what is read there rests on."""

# a point rounds three sums, a node and what is read off a little more
_ROUNDINGS = 8

# pulls of links are found as exactly as this, relative to the largest
_EXACT = 1e-13


def integrate_differences(problem: CornerProblem, step: Fraction, instants: NDArray[np.int_]) -> tuple[Array, Array]:
    """Integrate a network by central differences.

    Args:
        problem: what moves; it has bars.
        step: of tau; it divides all delays, and is how long cells are.
        instants: positive numbers of steps, ascending: (n,).

    Returns:
        The readings (readings, n), and what rounding adds to each at most (readings,).
    """
    h = float(step)
    grid = Grid(problem, np.array([int(delay / step) for delay in problem.delays]), h)
    steps = int(instants[-1]) + 1
    motion = fields(grid, point_steps(problem, h, steps), _ReturnMapping(problem, h).settle)
    kept, stencils = keep_places([grid.stencil(reading) for reading in problem.readings])
    history, largest, rows = np.zeros((steps + 1, len(kept))), 0.0, []
    for row, field in zip(history[1:], motion, strict=False):
        row[:], largest = field[kept], max(largest, float(np.max(np.abs(field))))
    for reading, (columns, weights) in zip(problem.readings, stencils, strict=True):
        before, now, after = (history[np.ix_(instants + k, columns)] @ weights for k in (-1, 0, 1))
        changes = {-1: now, 0: (after - before) / (2 * h), 1: (after - 2 * now + before) / h**2}
        of_strain = reading.quantity == "strain"
        rows.append((now if of_strain else changes[reading.order]) + problem.strain_at_start(reading))
    unsure = [_roundoff(problem, reading, h, steps) * largest for reading in problem.readings]
    return np.array(rows).reshape(-1, len(instants)), np.array(unsure)


def _roundoff(problem: CornerProblem, reading: Gauge, h: float, steps: int) -> float:
    """What rounding adds to a reading for displacements of 1, at most: it goes on to every second point."""
    sizes = {"displacement": float(steps * steps), "velocity": steps / h, "acceleration": 4 * steps / h**2}
    of_strain = reading.quantity == "strain"
    size = steps / h / float(problem.speed[reading.rod - 1]) if of_strain else sizes[reading.quantity]
    return _ROUNDINGS * float(UNIT_ROUNDOFF) * size


class _ReturnMapping:
    """What links pull, step by step: that of a spring which yields goes on from its pull a step before.

    A spring is as long in a step as those without a law are (`point_steps`): else it swings up where nothing has mass.
    Forces are means from one step before to one after, in the first step over that.
    """

    def __init__(self, problem: CornerProblem, h: float) -> None:
        self._laws = laws = problem.laws
        self._h, self._span = h, h
        self._rows = np.array([law.row for law in laws])
        self._ways: list[float] = np.sign(self._rows @ problem.velocity).tolist()
        self._longer, self._pulls = [0.0] * len(laws), [law.preload for law in laws]
        self._influence, self._yields, self._coupling = np.empty(0), np.empty(0), list[list[float]]()

    def settle(self, after: Array, influence: Array, now: Array, before: Array) -> Array:
        """Displacements with what each link pulls, within its limits, when all bear what the others leave."""
        if influence is not self._influence:
            self._influence, self._yields = influence, influence @ self._rows.T
            self._coupling = (self._rows @ self._yields).tolist()
        # from here on in the links' lengths, which are few: plain numbers
        longest: list[float] = (self._rows @ after).tolist()
        passed: list[float] = (self._rows @ before).tolist()
        known: list[float] = (self._rows @ (2 * now + before)).tolist()
        earlier, pulls = self._pulls, [0.0] * len(self._laws)

        def respond(number: int, free: float) -> tuple[float, float]:
            law, compliance = self._laws[number], self._coupling[number][number]
            if law.friction:
                held = (free - passed[number]) / compliance
                pull = _rub(law, self._ways[number], held)[0]
                return pull, 1 / compliance if pull == held else 0.0
            if law.side:
                rest = (law.side * known[number] - 3 * law.gap) / 4
                step = OneSidedStep(self._span, law.excess(passed[number]), 1 / 4, rest)
                force, slope, _ = law.push_back(law.excess(free), compliance, step)
                return law.side * force, slope
            kept = earlier[number] - law.stiffness * self._longer[number]
            trial = kept + law.stiffness * (free + known[number]) / 4
            softer = 1 + law.stiffness * compliance / 4
            pull = law.limit(trial / softer)
            return pull, law.stiffness / (4 * softer) if pull == trial / softer else 0.0

        find_pulls(self._coupling, longest, pulls, respond, _EXACT)
        after -= self._yields @ pulls
        lengths: list[float] = (self._rows @ after).tolist()
        for number, (law, length) in enumerate(zip(self._laws, lengths, strict=True)):
            if law.friction:
                held = pulls[number] + (length - passed[number]) / self._coupling[number][number]
                self._ways[number] = _rub(law, self._ways[number], held)[1]
            self._longer[number] = (length + known[number]) / 4
        self._pulls, self._span = pulls, 2 * self._h
        return after


def _rub(law: LinkLaw, way: float, held: float) -> tuple[float, float]:
    """What friction pulls where `held` would hold it, and its way: it slides on, or comes to rest at first."""
    if way != 0 and way * held > law.friction:
        return way * law.friction, way
    return law.limit(held), 0.0 if abs(held) <= law.rest else float(np.sign(held))
