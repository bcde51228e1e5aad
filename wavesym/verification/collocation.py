"""Integration between fronts over any network, contacts included: collocation at Gauss's points, panel by panel.

A panel ends where something not smooth may come to any point: what set out at tau = 0, from a load, or from a contact
that opened or closed. Let a be the wave that arrives at an end of impedance Z and ratio n, q the velocities of points:

    mass q' + (damping + sum of n^2 Z) q + stiffness u = sum of 2 n Z a + loads + pushes of contacts,        u' = q,

and n q - a is sent back. A closed contact has a push that keeps its gap 0. Where a push or a gap becomes negative
inside a panel, the panel ends there, and the state of the contacts is the first one with which neither does.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, cached_property, lru_cache
from heapq import heapify, heappop, heappush
from itertools import product
from math import ceil

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.quadrature import gauss
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import UNIT_ROUNDOFF
from wavesym.verification.problem import Change, CornerProblem

# where contacts open and close, instants closer than this part of the longest delay are one, and so are fronts, and
# forces and gaps smaller than this part of the largest are 0
SAME = 1e-10

# what is a sign of a push or a gap, and what is noise: where no state will do, more is noise
_SIGNS = (1e-10, 1e-8, 1e-6)

# panels are no longer than this over the fastest rate of anything
_REACH = 2.0

# where signs of pushes and gaps are looked at in a panel: ever closer to its start
_LOOKED = np.linspace(0, 1, 65) ** 4
_HALVINGS = 60

# a panel rounds no more often than this for each of its points: a tenth of it was seen
_ROUNDINGS = 1


class UndecidedError(ArithmeticError):
    """The integrator cannot go on; its text says why."""


@dataclass
class Motion:
    """A motion for 0 <= tau <= `until`: `waves[panel][end]` is sent from an end of a bar, known at Gauss's points.

    After the ends come the velocities of points. A panel begins at one of `starts`; `vague` are those that
    a contact's opening or closing causes, which are known to rounding only.
    """

    problem: CornerProblem
    points: int
    until: float
    starts: list[Fraction] = field(default_factory=list)
    widths: list[Fraction] = field(default_factory=list)
    waves: list[Array] = field(default_factory=list)
    vague: list[float] = field(default_factory=list)
    changes: list[Change] = field(default_factory=list)

    def evaluate(self, reading: Gauge, taus: Sequence[float]) -> Array:
        """Evaluate a strain, velocity, displacement or acceleration.

        Args:
            reading: what is read, on a bar or at a point.
            taus: doubles in [0, until].

        Returns:
            The values, right-hand limits where they jump: shape (len(taus),).

        Raises:
            ValueError: a tau lies outside.
        """
        if not all(0 <= tau <= self.until for tau in taus):
            raise ValueError(f"tau outside [0, {self.until}]")
        waves = self.problem.waves(reading)
        parts = [weight * self._sent_wave(end, taus, late, reading.order) for end, weight, late in waves]
        return np.asarray(np.sum(parts, axis=0))

    def outputs(self, taus: Array) -> Array:
        """The outputs at doubles tau in [0, until], right-hand limits: (outputs, taus)."""
        values = [self.evaluate(reading, taus.tolist()) for reading in self.problem.readings]
        return self.problem.outputs(np.array(values).reshape(-1, len(taus)), taus)

    @property
    def output_roundoff(self) -> Array:
        """What rounding may have added to the outputs: (outputs,)."""
        rounded = [self.roundoff(reading) for reading in self.problem.readings]
        return np.asarray(np.abs(self.problem.weights) @ np.array(rounded))

    def distance(self, reading: Gauge, taus: Array) -> Array:
        """How far instants (n,) are from where a reading may jump or bend at a time that is not known exactly: (n,)."""
        vague = np.array([-np.inf, *self.vague, np.inf])
        seen = taus - np.array([[float(wave.late)] for wave in self.problem.waves(reading)])
        after = np.searchsorted(vague, seen)
        return np.asarray(np.min(np.minimum(seen - vague[after - 1], vague[after] - seen), axis=0))

    def roundoff(self, reading: Gauge) -> float:
        """What rounding may have added to a reading, absolute: it adds up over panels, and no joint amplifies it."""
        largest = float(np.max(np.abs(self._coefficients)))
        if reading.quantity == "displacement":
            largest *= max(self.until, 1.0)
        if reading.quantity == "acceleration":  # Markov's inequality, on each panel
            panels = np.max(np.abs(self._coefficients), axis=(1, 2)) / self._widths
            largest = 2 * self.points**2 * float(np.max(panels))
        relative = _ROUNDINGS * self.points * len(self.starts) * float(UNIT_ROUNDOFF)
        return max(relative, 10 * SAME if len(self.problem.gaps) else 0.0) * largest

    @cached_property
    def _coefficients(self) -> Array:
        """The waves as Legendre's series: (panels, ends + points, points of a panel)."""
        return np.array(self.waves) @ gauss(self.points).series.T

    @cached_property
    def _sums(self) -> Array:
        """The integrals of the waves from tau = 0 to the start of each panel."""
        totals = np.cumsum(self._coefficients[..., 0] * self._widths[:, np.newaxis], axis=0)
        return np.concatenate([np.zeros_like(totals[:1]), totals])

    @cached_property
    def _starts(self) -> Array:
        return np.array([float(start) for start in self.starts])

    @cached_property
    def _widths(self) -> Array:
        return np.array([float(width) for width in self.widths])

    def _sent_wave(self, end: int, taus: Sequence[float], late: Fraction, order: int) -> Array:
        """A wave that was sent so long before, its derivative (`order` 1) or its integral since then (-1).

        Which panel that is, is decided exactly.
        """
        times = np.array(taus, dtype=float) - float(late)
        panel = np.searchsorted(self._starts, times, side="right") - 1
        beside = np.append(self._starts, np.inf)
        close = 1e-9 * (1 + np.abs(times))
        near = (np.abs(times - beside[panel]) < close) | (np.abs(beside[panel + 1] - times) < close)
        for k in np.flatnonzero(near).tolist():
            panel[k] = bisect_right(self.starts, Fraction(taus[k]) - late) - 1
        held = self.problem.held_part(end, np.array(taus, dtype=float), float(late), order)
        x = np.clip(2 * (times - self._starts[panel]) / self._widths[panel] - 1, -1, 1)
        series = self._coefficients[panel, end]
        if order > 0:
            steeper = 2 * legendre.legder(series, axis=1) / self._widths[panel, np.newaxis]
            return np.where(panel < 0, held, np.sum(legendre.legvander(x, self.points - 2) * steeper, axis=1))
        if order == 0:
            return np.where(panel < 0, held, np.sum(legendre.legvander(x, self.points - 1) * series, axis=1))
        since = legendre.legvander(x, self.points)
        orders = np.arange(1, self.points)
        terms = np.column_stack([x + 1, (since[:, 2:] - since[:, : self.points - 1]) / (2 * orders + 1)])
        moved = self._sums[panel, end] + self._widths[panel] / 2 * np.sum(terms * series, axis=1)
        return np.asarray(np.where(panel < 0, 0.0, moved) + held)


def integrate(problem: CornerProblem, until: float, points: int, most: int = 100_000) -> Motion:
    """Integrate a motion from tau = 0.

    Args:
        problem: what moves.
        until: the end.
        points: Gauss's points of a panel, which the order is twice of.
        most: panels at most.

    Raises:
        Undecided: it takes more panels, contacts have no state, or other links have corners.
    """
    if problem.laws:
        raise UndecidedError("what rubs or yields, or acts on one side, is not followed")
    return _Collocation(problem, Motion(problem, points, until), most).motion()


class _Collocation:
    """The displacements and velocities of points now, and which contacts are open."""

    def __init__(self, problem: CornerProblem, found: Motion, most: int) -> None:
        self._problem, self._found, self._most = problem, found, most
        self._rule = gauss(found.points)
        self._looked = self._rule.interpolation(_LOOKED)
        impedance = np.repeat(problem.impedance, 2)
        self._damping = problem.damping + np.diag(problem.incidence**2 @ impedance)
        self._arriving_force = 2 * problem.incidence * impedance
        self._u, self._q = np.zeros(problem.points), problem.velocity.copy()
        self._open = problem.gaps > 0
        self._same = Fraction(SAME) * max(problem.delays) if len(problem.gaps) else Fraction(0)
        self._panels: dict[tuple[Fraction, Fraction], int] = {}
        self._system = lru_cache(maxsize=256)(self._new_system)

    def motion(self) -> Motion:
        """Integrate panel by panel."""
        problem, found = self._problem, self._found
        fronts = [(Fraction(0), group) for group in range(len(problem.groups))]
        fronts += [(event.time, problem.group_of[event.point]) for event in problem.events]
        fronts = list(dict.fromkeys(fronts))
        heapify(fronts)
        vague: set[tuple[Fraction, int]] = set()
        fastest = self._fastest()
        longest = min([found.until + 1, *map(float, problem.delays), *([_REACH / fastest] if fastest else [])])
        now = Fraction(0)
        while now <= found.until:
            here, is_vague = set[int](), False
            while fronts and fronts[0][0] <= now + self._same:
                front = heappop(fronts)
                here.add(front[1])
                is_vague |= front in vague
            if is_vague:
                found.vague.append(float(now))
            for time, group in problem.onward_arrivals(now, here):
                if not any(group == other and abs(time - when) <= self._same for when, other in fronts):
                    heappush(fronts, (time, group))
                    vague |= {(time, group)} if is_vague else set()
            if not fronts:  # without bars none comes back
                fronts.append((Fraction(found.until) + 1, 0))
            parts = ceil((fronts[0][0] - now) / Fraction(longest))
            width = (fronts[0][0] - now) / parts
            for _ in range(parts):
                if len(found.starts) == self._most:
                    raise UndecidedError(f"{self._most} panels end at tau = {float(now):.4g}")
                changed = self._panel(now, width)
                now += found.widths[-1]
                if changed:
                    for group in changed:
                        heappush(fronts, (now, group))
                    vague |= {(now, group) for group in changed}
                    break
        return found

    def _panel(self, now: Fraction, width: Fraction) -> set[int]:
        """One panel, or what there is of it before a contact opens or closes: the groups with such contacts."""
        falls = self._solve(now, width)
        part = min(falls.values(), default=1.0)
        if part < 1.0:  # once more, to where nothing has happened yet
            width *= Fraction(part)
            self._solve(now, width)
        self._store(now, width)
        return {number for number, each in falls.items() if each <= part * (1 + SAME) < 1}

    def _solve(self, now: Fraction, width: Fraction) -> dict[int, float]:
        """Move all points through a panel; which part of it that holds for, by group with contacts."""
        problem = self._problem
        times = float(now) + float(width) * self._rule.nodes
        arriving = [self._wave(end, now, width, times) for end in range(len(problem.end_points))]
        self._arriving = np.array(arriving).reshape(-1, len(times))
        acting = problem.loads(times)
        acting[problem.is_free] += (self._arriving_force @ self._arriving)[problem.is_free]
        self._velocities, self._states = np.zeros((len(self._q), self._found.points)), self._open.copy()
        return {number: self._settle(number, width, acting) for number in range(len(problem.groups))}

    def _wave(self, end: int, now: Fraction, width: Fraction, times: Array) -> Array:
        """The wave that arrives at an end of a bar: (times,)."""
        found, late, end = self._found, self._problem.delays[end // 2], end ^ 1
        sent, times = now - late, times - float(late)
        if (sent, width) in self._panels:
            return np.asarray(found.waves[self._panels[sent, width]][end])
        values = self._problem.held_waves(end, times)
        if sent + width > 0:
            first = max(bisect_right(found.starts, sent) - 1, 0)
            last = bisect_right(found.starts, sent + width)
            for panel in range(first, last):
                start = float(found.starts[panel])
                inside = times >= start
                local = np.minimum((times[inside] - start) / float(found.widths[panel]), 1.0)
                values[inside] = self._rule.interpolation(local) @ found.waves[panel][end]
        return values

    def _store(self, now: Fraction, width: Fraction) -> None:
        problem, found, velocities = self._problem, self._found, self._velocities
        for contact in np.flatnonzero(self._states != self._open).tolist():
            happens = "opens" if self._states[contact] else "closes"
            found.changes.append(Change(self._problem.contacts[contact], happens, float(now)))
        self._open = self._states
        sent = problem.end_ratios[:, np.newaxis] * velocities[problem.end_points] - self._arriving
        self._panels[now, width] = len(found.starts)
        found.starts.append(now)
        found.widths.append(width)
        found.waves.append(np.concatenate([sent, velocities]))
        self._u += float(width) * velocities @ self._rule.weights
        self._q = velocities @ self._rule.interpolation(np.ones(1))[0]

    # contacts

    def _settle(self, number: int, width: Fraction, acting: Array) -> float:
        """Move a group in the first state of its contacts that will do; which part of the panel it holds for."""
        problem, group = self._problem, list(self._problem.groups[number])
        parting = problem.parting[:, group]
        here = np.flatnonzero(np.any(parting != 0, axis=1))
        if not len(here):
            self._velocities[group] = self._group_motion(number, (), width, acting)[0]
            return 1.0
        apart = problem.gaps[here] + problem.parting[here] @ self._u
        length, force = problem.worth
        apart[np.abs(apart) <= SAME * length] = 0.0
        choices = [(o, not o) if gap == 0 else (True,) for gap, o in zip(apart, self._open[here], strict=True)]
        states = sorted(product(*choices), key=lambda each: int(np.sum(np.array(each) != self._open[here])))

        @cache
        def solve(state: tuple[bool, ...]) -> tuple[Array, list[Array]]:
            is_open = np.array(state)
            moved, pushes = self._group_motion(number, tuple(here[~is_open].tolist()), width, acting)
            gaps = apart[is_open, np.newaxis] + parting[here[is_open]] @ moved @ (float(width) * self._rule.until.T)
            return moved, [*(gaps / length), *(pushes / force)]

        for noise in _SIGNS:
            for state in states:
                moved, positive = solve(state)
                part = min((self._first_negative(values, noise) for values in positive), default=1.0)
                if part > 0:
                    self._velocities[group], self._states[here] = moved, state
                    return part
        raise UndecidedError("contacts for which neither open nor closed will do")

    def _first_negative(self, values: Array, noise: float) -> float:
        """Where on [0, 1] a polynomial by its values becomes negative: 1 if it does not, 0 if it begins so."""
        seen = self._looked @ values
        below = np.flatnonzero(seen < -noise)
        if not len(below):
            return 1.0
        if below[0] == np.flatnonzero(np.abs(seen) > noise)[0]:
            return 0.0
        left, right = _LOOKED[np.flatnonzero(seen[: below[0]] > 0)[-1]], _LOOKED[below[0]]
        for _ in range(_HALVINGS):
            middle = (left + right) / 2
            value = float((self._rule.interpolation(np.array([middle])) @ values)[0])
            left, right = (middle, right) if value > 0 else (left, middle)
        return float(right)

    # motion

    def _group_motion(
        self, number: int, closed: tuple[int, ...], width: Fraction, acting: Array
    ) -> tuple[Array, Array]:
        """The velocities of a group at Gauss's points, and the pushes of its closed contacts."""
        group = list(self._problem.groups[number])
        system = self._system(number, closed, width)
        q0 = np.where(system.heavy, self._q[group], 0.0)[:, np.newaxis]
        u0 = self._u[group][:, np.newaxis] + q0 * (float(width) * self._rule.nodes)
        right = acting[group] - system.damping @ q0 - system.stiffness @ u0
        right = np.concatenate([right, -(system.bound @ q0) * np.ones(len(self._rule.nodes))])
        found = (system.inverse @ right.ravel()).reshape(right.shape)
        return q0 + np.einsum("jab,jb->ja", system.velocity, found[: len(group)]), found[len(group) :]

    def _new_system(self, number: int, closed: tuple[int, ...], width: Fraction) -> _System:
        """The equations of a group on a panel so wide, factorized."""
        problem, n = self._problem, self._found.points
        group, until, one = list(problem.groups[number]), float(width) * self._rule.until, np.eye(n)
        free = problem.is_free[group]
        heavy = (problem.mass[group] > 0) & free
        bound = problem.parting[list(closed)][:, group]
        damping, stiffness = (matrix[group][:, group] * free[:, None] for matrix in (self._damping, problem.stiffness))
        # unknown are the accelerations of points with mass, the velocities of others, and pushes
        velocity = np.where(heavy[:, None, None], until, one)
        moved = np.einsum("ij,jab->iajb", damping, velocity) + np.einsum("ij,jab->iajb", stiffness, until @ velocity)
        moved += np.einsum("ij,ab->iajb", np.diag(problem.mass[group] * heavy + ~free), one)
        pushed = -np.einsum("ki,ab->iakb", bound * free, one)
        kept = np.einsum("kj,jab->kajb", bound, velocity)
        nothing = np.zeros((len(closed), n, len(closed), n))
        matrix = np.concatenate([np.concatenate([moved, pushed], axis=2), np.concatenate([kept, nothing], axis=2)])
        inverse = np.linalg.inv(matrix.reshape((len(group) + len(closed)) * n, -1))
        return _System(heavy, damping, stiffness, bound, velocity, inverse)

    def _fastest(self) -> float:
        """How fast anything decays or swings, at most, roughly."""
        problem = self._problem
        c, k = np.sum(np.abs(self._damping), axis=1), np.sum(np.abs(problem.stiffness), axis=1)
        heavy, held = (problem.mass > 0) & problem.is_free, (problem.mass == 0) & (k > 0) & problem.is_free
        rates = [c[heavy] / problem.mass[heavy], np.sqrt(k[heavy] / problem.mass[heavy]), k[held] / c[held]]
        return float(2 * np.max(np.concatenate(rates), initial=0.0))


@dataclass(frozen=True)
class _System:
    """A group on a panel: its matrices, how velocities follow from unknowns, and the inverse for these."""

    heavy: NDArray[np.bool_]
    damping: Array
    stiffness: Array
    bound: Array
    velocity: Array
    inverse: Array
