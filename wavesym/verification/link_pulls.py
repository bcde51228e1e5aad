"""Links with corners in a step of the midpoint rule: how much contacts, friction and springs with a law pull.

What they pull depends on the mean velocity in the step: a contact pushes as little as keeps its gap from being
negative, friction takes what keeps its sides together, as much as it can, and springs have the mean of their pulls at
both ends of the step. Each of these is monotone and linear in parts: they are found one after another, again and again,
and in between all at once, as if each stayed on its part (Newton's rounds).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from operator import mul

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.verification.problem import BranchChange, CornerProblem, LinkLaw, OneSidedStep

# pulls of links are found as exactly as this, relative to the largest, and as rates are rounded
_EXACT, _NOISE = 1e-15, 4e-16

# rounds, and the first of them after which there is one of Newton's
_ROUNDS, _NEWTON = 1000, 20

Response = Callable[[int, float], tuple[float, float]]
"""What a link pulls at a rate that it has without itself, and how much more for more of that."""

# what comes to rest within a step is turned back by twice what its force does in one
_TURNED = 2

# parts of what pushes and gaps are worth that tell whether a contact is closed
_SIGN = 1e-9


@dataclass
class _Spring:
    """A spring with a corner: its pull, what that would be without limits, and its branch."""

    law: LinkLaw
    branch: int
    pull: float = 0.0
    trial: float = 0.0

    def mean(self, rate: float, longer: float, compliance: float, h: float) -> tuple[float, float]:
        """Its mean pull in a step, where it gets longer at a `rate` without: less by `compliance` times the pull."""
        law, stiff = self.law, self.law.stiffness * h / 2
        if law.side:
            before = law.excess(longer)
            step = OneSidedStep(h, before, 1 / 2, before / 2)
            force, slope, middle = law.push_back(before + h * law.side * rate, h * compliance, step)
            self.trial = law.side * law.stiffness * middle
            return law.side * force, h * slope
        self.trial = 2 * (self.pull + stiff * rate) / (1 + stiff * compliance) - self.pull
        pull, mean = (self.pull + self.trial) / 2, (self.pull + law.limit(self.trial)) / 2
        return mean, stiff / (1 + stiff * compliance) if mean == pull else 0.0

    def finish(self) -> None:
        """Go on to the next step."""
        self.pull = self.law.limit(self.trial)


@dataclass
class _Friction:
    """What rubs: how fast it slides at the start of a step (`speed`, 0 where a side has no mass), and its branch.

    `inertia` is its mean velocity in a step if nothing but its mass acts, over that speed.
    """

    law: LinkLaw
    branch: int
    inertia: float
    speed: float = 0.0
    trial: float = 0.0
    _fastest: float = 0.0

    def mean(self, rate: float, _: float, compliance: float, __: float) -> tuple[float, float]:
        """Its mean pull in a step, where it would go at a mean `rate` without: less by `compliance` times the pull.

        What comes to rest and goes back is pulled one way first, and the other way for the rest of the step.
        """
        most, before = self.law.friction, abs(self.speed)
        self._fastest = max(self._fastest, before)
        way = 1.0 if self.speed > 0 else -1.0
        held = (rate - self.inertia * self.speed) / compliance  # what keeps it at rest
        if before == 0 or (self.branch == 0 and before <= _SIGN * self._fastest):
            self.trial = held
            mean = self.law.limit(held)
            return mean, 1 / compliance if mean == held else 0.0
        after = 2 * (way * rate - compliance * most) - before
        self.trial = 2 * self.law.rest * way
        if after >= 0:
            return most * way, 0.0
        if abs(held) <= self.law.rest:
            self.trial = held
            return (rate - self.speed / 2) / compliance, 1 / compliance
        self.trial = -self.trial
        part = before / (before - after)
        return most * way * (2 * part - 1), 4 * most * part**2 / before

    def finish(self) -> None:
        """Go on to the next step."""


class LinkPulls:
    """The pulls of all links with corners, contacts and then others, step by step, and when branches change."""

    def __init__(self, problem: CornerProblem, inverse: Array, h: float) -> None:
        self._problem, self._h = problem, h
        self._rows = np.array([*problem.parting, *(law.row for law in problem.laws)]).reshape(-1, problem.points)
        # what is prescribed gives no way
        self._influence = inverse @ (self._rows * problem.is_free).T
        self._compliance: list[list[float]] = (self._rows @ self._influence).tolist()
        self._pulls = [0.0] * len(self._rows)
        self._gaps: list[float] = problem.gaps.tolist()
        self._laws = [self._link(law, inverse) for law in problem.laws]
        # friction beside what has no mass of its own
        self._rubbing = [link for link in self._laws if isinstance(link, _Friction) and not link.inertia]
        self._open = problem.gaps > 0
        self.changes: list[BranchChange] = []

    def _link(self, law: LinkLaw, inverse: Array) -> _Spring | _Friction:
        if not law.friction:
            return _Spring(law, law.first, law.preload)
        compliance = float(law.row @ inverse @ (law.row * self._problem.is_free))
        return _Friction(law, law.first, compliance * 2 * self._problem.sliding_mass(law) / self._h)

    def settle(self, free: Array, q: Array, u: Array, step: int) -> Array:
        """The mean velocities of points in a step, from those without links, `free`, and their state before it."""
        if not len(self._rows):
            return free
        for link in self._laws:
            if isinstance(link, _Friction):
                link.speed = float(link.law.row @ q) if link.inertia else 0.0
        # from here on of the links, which are few: plain numbers
        rates: list[float] = (self._rows @ free).tolist()
        longer, pulls = self._rows @ u, self._pulls
        lengths: list[float] = longer.tolist()
        find_pulls(self._compliance, rates, pulls, lambda k, rate: self._mean(k, rate, lengths[k]), _EXACT)
        v = free - self._influence @ pulls
        self._record_branches((longer + self._h * (self._rows @ v)).tolist(), step)
        return np.asarray(v)

    def stop(self, after: Array, v: Array) -> Array:
        """The velocities of points at the end of a step, `after` it for all that is known of `v`, the mean ones in it.

        A mass that a contact presses on a joint without mass comes to rest as friction stops that: what goes on after
        would leave it with what was lost in the step, the other way.
        """
        problem, contacts = self._problem, len(self._gaps)
        rubbing = [link for link in self._rubbing if min(self._pulls[:contacts], default=0.0) < 0]
        gone = np.where(problem.mass > 0, after, v) if rubbing else after
        for link in rubbing:
            row, pressed = link.law.row, np.array(self._pulls[:contacts]) < 0
            stuck = link.law.limit(link.trial) == link.trial
            for joint in np.flatnonzero((row != 0) & (problem.mass == 0) & problem.is_free).tolist():
                ratios = problem.rigid_motion(joint, parting=problem.parting[pressed])[0]
                others = float(row @ gone) - row[joint] * v[joint]
                for mass in np.flatnonzero((ratios != 0) & (problem.mass > 0)).tolist():
                    ratio = ratios[mass] / row[joint]
                    slides = after[mass] / ratio + others
                    turns = stuck or slides * (row @ v) < 0
                    if turns and problem.mass[mass] * ratio**2 * abs(slides) <= _TURNED * self._h * link.law.rest:
                        after[mass] = -others * ratio
        return after

    def _mean(self, k: int, rate: float, longer: float) -> tuple[float, float]:
        contacts, compliance = len(self._gaps), self._compliance[k][k]
        if k >= contacts:
            return self._laws[k - contacts].mean(rate, longer, compliance, self._h)
        push = ((self._gaps[k] + longer) / self._h + rate) / compliance
        return (push, 1 / compliance) if push < 0 else (0.0, 0.0)

    def _record_branches(self, longer: list[float], step: int) -> None:
        """On which branches links are at the end of a step."""
        problem = self._problem
        length, force = problem.worth
        for k, number in enumerate(problem.contacts):
            apart, push = self._gaps[k] + longer[k], -self._pulls[k]
            if push > _SIGN * force if self._open[k] else apart > _SIGN * length:
                self._open[k] ^= True
                self.changes.append(BranchChange(number, int(self._open[k]), int(not self._open[k]), step))
        for moving in self._laws:
            law, before = moving.law, moving.branch
            moving.finish()
            moving.branch = law.branch(moving.trial, _SIGN * force, before)
            if moving.branch != before and step:  # what it is from the start is no event
                self.changes.append(BranchChange(law.corner, before, moving.branch, step))


def find_pulls(
    compliance: list[list[float]], rates: list[float], pulls: list[float], respond: Response, exact: float
) -> None:
    """Find what links pull, as exactly as that relative to the largest; `pulls` are those to begin with.

    Args:
        compliance: by how much a pull (column) makes a rate (row) less.
        rates: how fast links would get longer without any pull.
        pulls: as many; they are replaced.
        respond: a link's pull for the rate that the others leave it.
        exact: rounds end when they change no more than that, and what rates are rounded by.
    """
    for number in range(_ROUNDS):
        before, noise = pulls.copy(), 0.0
        for k, row in enumerate(compliance):
            pulls[k], slope = respond(k, rates[k] - sum(map(mul, row, pulls)) + row[k] * pulls[k])
            noise = max(noise, _NOISE * slope * abs(rates[k]))
        changed = max(abs(pull - last) for pull, last in zip(pulls, before, strict=True))
        if len(pulls) == 1 or changed <= exact * max(map(abs, pulls)) + noise:
            return
        if number < _NEWTON:  # those may go round in circles, the others come closer each time
            _step_on(compliance, rates, pulls, respond)


def _step_on(compliance: list[list[float]], rates: list[float], pulls: list[float], respond: Response) -> None:
    """Newton's round: to where all pulls would be, if each stayed on its part; no step where that is nowhere."""
    size = len(pulls)
    matrix, missing = np.eye(size), np.empty(size)
    for k, row in enumerate(compliance):
        pull, slope = respond(k, rates[k] - sum(map(mul, row, pulls)) + row[k] * pulls[k])
        matrix[k] += slope * np.array(row)
        matrix[k, k] = 1.0
        missing[k] = pull - pulls[k]
    try:
        step = np.linalg.solve(matrix, missing)
    except np.linalg.LinAlgError:
        return
    if np.all(np.isfinite(step)):
        pulls[:] = (np.array(pulls) + step).tolist()
