"""Friction and springs with a law by central differences, which pull back what went too far: return mapping.

The steps are those of `wavesym/methods/grid.py`, taken two at a time: what rubs pulls in the mean from t - h to t + h
what keeps it from moving, as much as it can; a spring pulls as much as it is longer, and what is beyond its limits
becomes permanent. Nothing is known of events. Fronts stay as sharp as they are; outputs are read where none is near.
"""

from __future__ import annotations

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.verification.link_pulls import find_pulls
from wavesym.verification.problem import CornerProblem, LinkLaw, OneSidedStep

REACH = 4
"""Steps before and after an instant in which no front may be: a pull is a mean over two steps."""

# pulls of links are found as exactly as this, relative to the largest
_EXACT = 1e-13


class ReturnMapping:
    """What links pull, step by step: that of a spring which yields goes on from its pull a step before.

    A spring is as long in two steps as those without a law are, half as in the middle and a quarter as at either end:
    else it swings up where nothing has mass. In the first step pulls are means over that.
    """

    def __init__(self, problem: CornerProblem, inverse: Array, h: float) -> None:
        self._h, self._laws = h, problem.laws
        self._rows = np.array([law.row for law in problem.laws])
        # what is prescribed gives no way
        self._influence = inverse @ (self._rows * problem.is_free).T
        # how a pull acts in one step, and in two
        self._over = [(k * self._influence, (k * h * self._rows @ self._influence).tolist()) for k in (1, 2)]
        self._ways: list[float] = np.sign(self._rows @ problem.velocity).tolist()
        self._longer, self._pulls = [0.0] * len(self._laws), [law.preload for law in self._laws]
        # what is counted of pulls in a step, so that its mean with that of the step before is a pull
        self._counted = np.zeros(len(self._laws))
        self._before = np.zeros(problem.points)

    def stop(self, after: Array, _: Array) -> Array:
        """The velocities of points at the end of a step, as they are."""
        return after

    def settle(self, free: Array, _: Array, u: Array, step: int) -> Array:
        """The mean velocities of points in a step, with what each link pulls when all bear what the others leave."""
        h, steps = self._h, 2 if step else 1
        influence, coupling = self._over[steps - 1]
        free = free + self._influence @ self._counted
        # from here on in the links' lengths, which are few: plain numbers
        longest: list[float] = (self._rows @ (u + h * free)).tolist()
        passed: list[float] = (self._rows @ self._before).tolist()
        known: list[float] = (self._rows @ (2 * u + self._before)).tolist()
        earlier, pulls = self._pulls, [0.0] * len(self._laws)

        def respond(number: int, free: float) -> tuple[float, float]:
            law, compliance = self._laws[number], coupling[number][number]
            if law.friction:
                held = (free - passed[number]) / compliance
                pull = _rub(law, self._ways[number], held)[0]
                return pull, 1 / compliance if pull == held else 0.0
            if law.side:
                rest = (law.side * known[number] - 3 * law.gap) / 4
                step = OneSidedStep(steps * h, law.excess(passed[number]), 1 / 4, rest)
                force, slope, _ = law.push_back(law.excess(free), compliance, step)
                return law.side * force, slope
            kept = earlier[number] - law.stiffness * self._longer[number]
            trial = kept + law.stiffness * (free + known[number]) / 4
            softer = 1 + law.stiffness * compliance / 4
            pull = law.limit(trial / softer)
            return pull, law.stiffness / (4 * softer) if pull == trial / softer else 0.0

        find_pulls(coupling, longest, pulls, respond, _EXACT)
        self._counted = steps * np.array(pulls) - self._counted
        v: Array = free - influence @ pulls
        lengths: list[float] = (self._rows @ (u + h * v)).tolist()
        for number, (law, length) in enumerate(zip(self._laws, lengths, strict=True)):
            if law.friction:
                held = pulls[number] + (length - passed[number]) / coupling[number][number]
                self._ways[number] = _rub(law, self._ways[number], held)[1]
            self._longer[number] = (length + known[number]) / 4
        self._pulls, self._before = pulls, u
        return v


def _rub(law: LinkLaw, way: float, held: float) -> tuple[float, float]:
    """What friction pulls where `held` would hold it, and its way: it slides on, or comes to rest at first."""
    if way != 0 and way * held > law.friction:
        return way * law.friction, way
    return law.limit(held), 0.0 if abs(held) <= law.rest else float(np.sign(held))
