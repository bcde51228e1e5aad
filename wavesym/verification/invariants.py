"""Momentum and energy over any network: every right evaluator keeps them, and none uses them.

With M, C, K of the points (no part of the bars in them), impedances Z, delays T, speeds c and the forces
s = Z c U_x of the bars' ends on their points,

    energy = sum of M q^2/2 + u K u/2 + sum of Z times the integral over the last T of right^2 + left^2,
    momentum = sum of w M q + sum of w Z times the integral over the last T of right + left,

where right = (v - c U_x)/2 came in at the left end of a bar and left = (v + c U_x)/2 at its right end. Energy grows by
the work of loads and of prescribed motion, less what dashpots take; momentum by the impulse of loads, dashpots and
springs. The weights w are 1 at the first point; a bar counts `ratio` times as much as its point, so that forces
between bars and points cancel through gears, too. Nothing asks how long the delays are.

A contact pushes what is on its two sides alike, and takes no energy: what it pushes with follows from the balance of
the sides without mass. Where one has a prescribed motion, that is an impulse, and work.

Other links with corners take energy and may give it back: a spring pulls what its law says of how long it has been, and
friction the way it slides. What holds a point that sticks is not known from its motion; momentum is counted without it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise, product
from math import ceil

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.exact.contacts.events import events
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.methods.quadrature import gauss
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import UNIT_ROUNDOFF, fraction, rational
from wavesym.verification.problem import CornerProblem, LinkLaw, corner_problem

Evaluate = Callable[[Array], Array]
"""tau, shape (n,), to the outputs, shape (outputs, n)."""

# of Gauss's rule between two fronts, where everything is an entire function; fewer say how much is missed
_POINTS, _FEWER = 24, 16

# at so many instants balances are struck, on the horizon or on what is left when it is halved less often than this
_STRUCK, _HALVED = (8, 4, 2, 1), 6

# springs swing no further in a panel, in radians
_SWING = 12

# a sum rounds no more often than this for every panel
_ROUNDINGS = 100


@dataclass(frozen=True)
class Balance:
    """By how much a balance fails at most where it is struck, and by how much it may: its `error_bound`.

    Energy relative to its largest value, momentum to the largest that all the mass can have with that energy.
    """

    name: str
    error: float
    error_bound: float


@dataclass(frozen=True)
class BoundedValues:
    """Values, and what they may be wrong by."""

    value: Array
    error: Array

    def __add__(self, other: BoundedValues | Array | float) -> BoundedValues:
        other = other if isinstance(other, BoundedValues) else BoundedValues(np.asarray(other), np.zeros(1))
        return BoundedValues(self.value + other.value, self.error + other.error)

    def times(self, other: BoundedValues) -> BoundedValues:
        """Products."""
        size, wrong = np.abs(self.value), self.error
        error = size * other.error + wrong * (np.abs(other.value) + other.error)
        return BoundedValues(self.value * other.value, error)

    def sums(self, rows: Array) -> BoundedValues:
        """Weighted sums: rows @ values."""
        return BoundedValues(rows @ self.value, np.abs(rows) @ self.error)

    def integrals(self, weights: Array) -> BoundedValues:
        """Weighted sums over instants: values @ weights, which are not negative."""
        return BoundedValues(self.value @ weights, self.error @ weights)

    def form(self, matrix: Array) -> BoundedValues:
        """The quadratic form: sum over i and j of matrix[i, j] value[i] value[j]."""
        size, wrong, weight = np.abs(self.value), self.error, np.abs(matrix)
        error = size * (weight @ wrong) + wrong * (weight @ (size + wrong))
        return BoundedValues(np.sum(self.value * (matrix @ self.value), axis=0), np.sum(error, axis=0))


class Balancing:
    """A model as it is watched here: at the ends of all bars, and at all points, until the last balance is struck."""

    def __init__(self, model: Model, most: int) -> None:
        """With as many balances as take at most so many values of outputs; none where not even one does.

        CostError, GrazingError where it is not known when contacts open and close.
        """
        problem = self.problem = corner_problem(model)
        at = [_end_at(problem, point) for point in range(problem.points)]
        seen = [Probe(f"{q}@{k}", q, *here) for q in ("velocity", "displacement") for k, here in enumerate(at)]
        seen += [Probe(f"strain@{k}", "strain", *_end(k)) for k in range(len(problem.end_points))]
        # what is watched is so many times the velocity of its point, and c U_x
        self.scales = np.array(
            [1 / problem.end_ratios[2 * rod - 2 + int(place)] if rod else 1.0 for rod, place, _ in at]
        )
        limit, until = most // ((_POINTS + _FEWER) * len(seen)), fraction(model.until)
        fronts, last = self._fronts(model.watching(seen), until, limit)
        self.balance_times: list[Fraction] = []
        for end, count in product([until / 2**k for k in range(_HALVED)], _STRUCK):
            struck = [end * k / count for k in range(1, count + 1)]
            if end <= last and len(self._cuts(fronts, struck)) <= limit:
                self.balance_times = struck
                break
        self.cuts = np.array([float(cut) for cut in self._cuts(fronts, self.balance_times)])
        self.model = model.watching(seen)
        if self.balance_times:
            self.model = self.model.shorten(rational(self.balance_times[-1]))

    def balances(self, evaluate: Evaluate, errors: Sequence[float] | None = None) -> tuple[Balance, ...]:
        """The balances of momentum and energy, as `evaluate` has the watched model, and what contacts must keep.

        `errors` are the proved errors of the outputs, absolute, None where each value is rounded once: what they come
        to is allowed, and what quadrature misses.
        """
        fine, coarse = (_Books(self, evaluate, errors, points) for points in (_POINTS, _FEWER))
        largest = max(float(np.max(fine.stored_energy.value)), fine.initial_energy) or 1.0
        unit = _ROUNDINGS * len(self.cuts) * float(UNIT_ROUNDOFF)

        def balance(name: str, ours: BoundedValues, theirs: BoundedValues, scale: float) -> Balance:
            missed = float(np.max(np.abs(ours.value - theirs.value)))
            error, slack = float(np.max(np.abs(ours.value))), float(np.max(ours.error))
            return Balance(name, error / scale, (slack + missed) / scale + unit)

        found = [balance("momentum", fine.momentum, coarse.momentum, (2 * largest * fine.mass) ** 0.5)]
        if not self._rubs_on_motion:
            found.append(balance("energy", fine.energy, coarse.energy, largest))
        if not len(self.problem.gaps):
            return tuple(found)
        return (*found, balance("contacts", fine.contacts(largest), coarse.contacts(largest), largest))

    @property
    def _rubs_on_motion(self) -> bool:
        """Whether friction may hold something on what moves: what that takes, and so the work, no output says."""
        moving = [
            number for number in self.problem.prescribed_points if self.model.network.points[number].motion != "fixed"
        ]
        return any(law.friction and np.any(law.row[moving] != 0) for law in self.problem.laws)

    def _cuts(self, fronts: Iterable[Fraction], struck: Sequence[Fraction]) -> list[Fraction]:
        """Where panels end: at fronts, and where what is in a bar when a balance is struck has come in."""
        came_in = {time - delay for time in struck for delay in (Fraction(0), *self.problem.delays)}
        ends = sorted({Fraction(0), *(time for time in (*fronts, *came_in) if struck and 0 < time <= struck[-1])})
        cuts = ends[:1]
        for low, high in pairwise(ends):
            parts = max(1, ceil(float(high - low) * self.problem.swings / _SWING))
            cuts += [low + (high - low) * k / parts for k in range(1, parts + 1)]
        return cuts

    def _fronts(self, watched: Model, until: Fraction, most: int) -> tuple[list[Fraction], Fraction]:
        """When something not smooth can come to a point, so often at most, and until when that is all of them."""
        links = watched.network.links
        more = [(Fraction(event.double), links[event.link].right) for event in events(watched)]
        times: list[Fraction] = []
        for time, _ in self.problem.fronts(more):
            if time > until:
                break
            times.append(time)
            if len(times) > most:
                return times, time
        return times, until


def _end(end: int) -> tuple[int, fmpq, None]:
    return end // 2 + 1, fmpq(end % 2), None


def _end_at(problem: CornerProblem, point: int) -> tuple[int, fmpq, int | None]:
    """Where a point is watched: at the end of a bar there, or by itself."""
    ends = np.flatnonzero(problem.end_points == point)
    return _end(int(ends[0])) if len(ends) else (0, fmpq(0), point)


def _pulls(
    law: LinkLaw,
    rates: BoundedValues,
    row: Array,
    known: tuple[BoundedValues, BoundedValues],
    order: NDArray[np.int_],
) -> BoundedValues:
    """What a link pulls at instants, `known` there and at more, by how long it is then, `row` @ values; in `order`."""
    if law.friction:
        return BoundedValues(law.friction * np.sign(rates.value), np.zeros(1))
    longer = np.concatenate([row @ each.value for each in known])
    pulls, pull, before = np.zeros(len(longer)), law.preload, 0.0
    for k in order.tolist():
        if law.side:
            pull = law.limit(law.side * law.stiffness * law.excess(longer[k]))
        else:
            pull = law.limit(pull + law.stiffness * (longer[k] - before))
        before, pulls[k] = longer[k], pull
    wrong = max(float(np.max(np.abs(row) @ each.error)) for each in known)
    errors = np.full(len(rates.value), 2 * law.stiffness * wrong)
    if law.dashpot:
        beyond = law.side * longer[: len(rates.value)] - law.gap
        pulls[: len(rates.value)] += law.dashpot * np.where(beyond > 0, rates.value, 0.0)
        unsure = np.where(np.abs(beyond) > wrong, 0.0, np.abs(rates.value))
        errors += law.dashpot * (rates.error + unsure)
    return BoundedValues(pulls[: len(rates.value)], errors)


class _Books:
    """What is stored and what comes in, with so many points a panel.

    The rows of values are the velocities and the displacements of points, c U_x at the ends of bars, and the loads.
    """

    def __init__(self, balancing: Balancing, evaluate: Evaluate, errors: Sequence[float] | None, points: int) -> None:
        problem = self._problem = balancing.problem
        self._delays = np.array([float(delay) for delay in problem.delays])
        self._struck = np.array([float(time) for time in balancing.balance_times])
        low, width, rule = balancing.cuts[:-1, np.newaxis], np.diff(balancing.cuts)[:, np.newaxis], gauss(points)
        self._times, self._weights = (low + width * rule.nodes).ravel(), (width * rule.weights).ravel()
        size, ends = problem.points, len(problem.end_points)
        scales = np.concatenate([balancing.scales, balancing.scales, np.repeat(problem.speed, 2)])[:, np.newaxis]

        weight = [problem.weight_strain(*divmod(end, 2)) for end in range(ends)]
        offsets = np.concatenate([np.zeros(2 * size), weight])[:, np.newaxis]

        def state(times: Array) -> BoundedValues:
            values = evaluate(times) - offsets
            rounded = float(UNIT_ROUNDOFF) * np.max(np.abs(values), axis=1)
            wrong = np.abs(scales) * (rounded if errors is None else np.array(errors))[:, np.newaxis]
            return BoundedValues(
                np.concatenate([scales * values, problem.loads(times)]),
                np.concatenate([wrong, np.zeros((size, 1))]) + np.zeros(len(times)),
            )

        self._all, self._ends = state(self._times), state(self._struck)
        unit = np.eye(3 * size + ends)
        self._q, self._u, self._strain, self._load = np.split(unit, [size, 2 * size, 2 * size + ends])
        sign = np.tile([1.0, -1.0], len(problem.delays))
        self._v = problem.incidence.T @ self._q
        self._force = (sign * np.repeat(problem.impedance, 2))[:, np.newaxis] * self._strain  # of ends on their points
        self._coming = (self._v - sign[:, np.newaxis] * self._strain) / 2  # into the bar at each end
        self._resisted = problem.damping @ self._q + problem.stiffness @ self._u
        self._free = problem.is_free.astype(float)
        # how springs have got longer is followed through all instants, and through those at which they may turn
        turns = state(balancing.cuts)
        instants = np.concatenate([self._times, balancing.cuts])
        order = np.argsort(instants, kind="stable")
        self._pulls = [
            _pulls(law, self._all.sums(law.row @ self._q), law.row @ self._u, (self._all, turns), order)
            for law in problem.laws
        ]

    def _content(self, power: int, weights: Array) -> BoundedValues:
        """The sum over bars of weights times the integral of their waves, to a power, when balances are struck."""
        problem, total = self._problem, BoundedValues(np.zeros(len(self._struck)), np.zeros(len(self._struck)))
        since = self._struck - self._times[:, np.newaxis]
        for bar, delay in enumerate(self._delays):
            inside = self._weights[:, np.newaxis] * ((since < delay) & (since > 0))
            rows = self._coming[2 * bar : 2 * bar + 2]
            came = self._all.form(rows.T @ rows) if power == 2 else self._all.sums(np.sum(rows, axis=0))
            left = np.maximum(delay - self._struck, 0.0)  # of this length there is still what was there at the start
            # Simpson's rule, which is exact for squares of what is linear
            waves = [
                problem.held_waves(2 * bar + side, -part * left) ** power for side in (0, 1) for part in (0.0, 0.5, 1.0)
            ]
            held = np.tile([1.0, 4.0, 1.0], 2) / 6 @ np.array(waves)
            part = came.integrals(inside) + left * held
            total += BoundedValues(weights[bar] * part.value, abs(weights[bar]) * part.error)
        return total

    def _balance(self, stored: BoundedValues, rate: BoundedValues, before: float) -> BoundedValues:
        """What is stored when balances are struck, less what was there and what came."""
        until = (self._times[:, np.newaxis] < self._struck) * self._weights[:, np.newaxis]
        came = rate.integrals(until)
        return stored + BoundedValues(-came.value, came.error) + -before

    # energy

    @cached_property
    def stored_energy(self) -> BoundedValues:
        """The energy when balances are struck."""
        problem = self._problem
        kept = self._q.T @ (problem.mass[:, np.newaxis] * self._q) + self._u.T @ problem.stiffness @ self._u
        return self._content(2, problem.impedance) + self._ends.form(kept / 2)

    @cached_property
    def initial_energy(self) -> float:
        """The energy at tau = 0."""
        problem = self._problem
        waves = np.sum(problem.start_waves**2, axis=1) + (problem.start_slope * self._delays) ** 2 / 6
        return float(problem.mass @ problem.velocity**2 / 2 + (problem.impedance * self._delays) @ waves)

    @property
    def energy(self) -> BoundedValues:
        """By how much energy is not what was there and what came."""
        problem, free = self._problem, self._free
        work = self._q.T @ (free[:, np.newaxis] * self._load) - self._q.T @ problem.damping @ self._q
        reaction = self._resisted - problem.incidence @ self._force - problem.parting.T @ self._push
        work += self._q.T @ ((1 - free)[:, np.newaxis] * reaction)
        rate = self._all.form(work)
        for law, pull in zip(problem.laws, self._pulls, strict=True):
            through = (1 - free) * (problem.parting.T @ self._pushes(-law.row))  # by contacts, on what is prescribed
            rate += pull.times(self._all.sums(-(law.row * free + through) @ self._q))
        return self._balance(self.stored_energy, rate, self.initial_energy)

    # momentum

    @cached_property
    def _momentum_weights(self) -> tuple[Array, Array]:
        """The weights of points and of bars in the momentum."""
        problem = self._problem
        points, bars = np.zeros(problem.points), np.zeros(len(problem.delays))
        for first in range(problem.points):
            if points[first] == 0:
                more = problem.rigid_motion(first, bars=True, springs=True)
                points, bars = points + more[0], bars + more[1]
        return points, bars

    @property
    def mass(self) -> float:
        """All of it, as it counts in the momentum."""
        points, bars = self._momentum_weights
        return float(points**2 @ self._problem.mass + bars**2 @ (self._problem.impedance * self._delays))

    @property
    def momentum(self) -> BoundedValues:
        """By how much momentum is not what was there and what came."""
        problem, (points, bars) = self._problem, self._momentum_weights
        counted, moving = points * self._free * self._free_weights, bars * problem.impedance
        stored = self._content(1, moving) + self._ends.sums(counted * problem.mass @ self._q)
        across = counted @ problem.incidence - np.repeat(bars, 2)  # 0 but where prescribed motion holds
        rate = self._all.sums(counted @ (self._load - self._resisted) + across @ self._force)
        for law, pull in zip(problem.laws, self._pulls, strict=True):
            share = float(counted @ law.row)
            rate += BoundedValues(-share * pull.value, abs(share) * pull.error)
        before = counted * problem.mass @ problem.velocity + moving * self._delays @ problem.start_velocity
        return self._balance(stored, rate, float(before))

    # contacts

    @cached_property
    def _free_weights(self) -> Array:
        """0 for points that friction or contacts to such may hold, or, without mass, to a prescribed motion; else 1."""
        problem, held = self._problem, 1 - self._free
        touching = problem.parting != 0
        for _ in problem.parting:
            held = np.maximum(held, np.any(touching[np.any(touching & (held > 0), axis=1)], axis=0))
        rubbing = self._rubbing
        for _ in problem.parting:
            rubbing = rubbing | np.any(touching[np.any(touching & rubbing, axis=1)], axis=0)
        return np.where(rubbing, 0.0, np.where(problem.mass == 0, 1 - held, 1.0))

    @cached_property
    def _rubbing(self) -> Array:
        """Whether friction acts on a point: what that takes while it sticks is not known."""
        laws = [law.row != 0 for law in self._problem.laws if law.friction]
        return np.any(laws, axis=0) if laws else np.zeros(self._problem.points, dtype=bool)

    @cached_property
    def _push(self) -> Array:
        """What contacts push with, (contacts, rows), but for links: what points without mass need to be in balance."""
        return self._pushes(self._load + self._problem.incidence @ self._force - self._resisted)

    def _pushes(self, acting: Array) -> Array:
        """What contacts push with where that acts on points."""
        problem = self._problem
        light = (problem.mass == 0) & problem.is_free & np.logical_not(self._rubbing)
        return np.asarray(-np.linalg.pinv(problem.parting[:, light].T) @ acting[light])

    def contacts(self, largest: float) -> BoundedValues:
        """How far a push or a gap is negative, or neither is 0, at any time; as an energy."""
        problem = self._problem
        length = (2 * largest / self.mass) ** 0.5 * float(np.max(self._delays))
        push = self._all.sums(length * self._push)
        for law, pull in zip(problem.laws, self._pulls, strict=True):
            share = length * self._pushes(-law.row)[:, np.newaxis]
            push += BoundedValues(share * pull.value, np.abs(share) * pull.error)
        gap = self._all.sums(largest / length * problem.parting @ self._u)
        gap += largest / length * problem.gaps[:, np.newaxis]
        wrong = np.maximum(np.maximum(-push.value, -gap.value), np.minimum(np.abs(push.value), np.abs(gap.value)))
        worst = np.maximum(push.error, gap.error)
        return BoundedValues(np.max(np.maximum(wrong, 0.0), axis=1), np.max(worst, axis=1))
