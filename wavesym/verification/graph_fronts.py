"""Integration between fronts over any network, contacts included: collocation at Gauss's points, panel by panel.

A panel ends where something not smooth may come to any point: what set out at tau = 0, from a load, or from a contact
that opened or closed. Let a be the wave that arrives at an end of impedance Z and ratio n, q the velocities of points:

    mass q' + (damping + sum of n^2 Z) q + stiffness u = sum of 2 n Z a + loads + pushes of contacts,        u' = q,

and n q - a is sent back. A closed contact has a push that keeps its gap 0. Where a push or a gap becomes negative
inside a panel, the panel ends there, and the state of the contacts is the first one with which neither does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from heapq import heapify, heappop, heappush
from itertools import product

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.probe import Probe
from wavesym.verification.graph import Array, Change, Graph

# instants closer than this, and forces and gaps smaller than this part of the largest, are not told apart
SAME = 1e-10

# what is a sign of a push or a gap, and what is noise: where no state will do, more is noise
_SIGNS = (1e-10, 1e-8, 1e-6)

# panels are no longer than this over the fastest rate of anything
_REACH = 2.0

# where signs of pushes and gaps are looked at in a panel: ever closer to its start
_LOOKED = np.linspace(0, 1, 65) ** 4
_HALVINGS = 60


class Undecided(ArithmeticError):
    """The integrator cannot go on; its text says why."""


@dataclass
class Fronts:
    """A motion: `waves[panel, side, bar]` is sent into a bar; after the bars come the points' velocities (on side 0).

    Each is known at Gauss's points of a panel, from `starts` on.
    """

    graph: Graph
    points: int
    starts: list[float] = field(default_factory=list)
    ends: list[float] = field(default_factory=list)
    waves: list[Array] = field(default_factory=list)
    sums: list[Array] = field(default_factory=list)
    """The integrals of waves from tau = 0 to the start of a panel."""
    changes: list[Change] = field(default_factory=list)

    def at(self, probe: Probe, taus: Sequence[float]) -> Array:
        """The values of an output, in the panels that these times lie in."""
        moved, times = probe.quantity == "displacement", np.array(taus, dtype=float)
        if probe.point is not None:
            return self.sent(0, len(self.graph.delays) + probe.point, times, moved)
        bar, delay = probe.rod - 1, float(self.graph.delays[probe.rod - 1])
        lates = [float(probe.place) * delay, float(1 - probe.place) * delay]
        right, left = (
            self.sent(side, bar, times - late, moved)
            - (self.sent(side, bar, np.array([-late]), moved) if moved else 0.0)
            for side, late in enumerate(lates)
        )
        return (left - right) / self.graph.speed[bar] if probe.quantity == "strain" else left + right

    def apart(self, probe: Probe, taus: Sequence[float]) -> Array:
        """How far these times are from where the output may jump or bend."""
        times = np.array(taus, dtype=float)
        places = [0.0] if probe.point is not None else [float(probe.place), float(1 - probe.place)]
        delay = 0.0 if probe.point is not None else float(self.graph.delays[probe.rod - 1])
        starts = np.array([*self.starts, self.ends[-1]])
        far = np.full(len(times), np.inf)
        for place in places:
            seen = times - place * delay
            after = np.clip(np.searchsorted(starts, seen), 1, len(starts) - 1)
            far = np.minimum(far, np.minimum(np.abs(seen - starts[after - 1]), np.abs(starts[after] - seen)))
        return far

    def sent(self, side: int, number: int, times: Array, integral: bool = False) -> Array:
        """A wave, or its integral from tau = 0 on, at any times."""
        held = self.held[side, number]
        values = held * times if integral else np.full(len(times), held)
        found = np.searchsorted(self.starts, times, side="right") - 1
        for panel in np.unique(found[(found >= 0) & (times >= 0)]):
            inside = (found == panel) & (times >= 0)
            start, width = self.starts[panel], self.ends[panel] - self.starts[panel]
            wave = self.waves[panel][side, number]
            local = (times[inside] - start) / width
            if integral:
                rule = gauss(self.points)
                wave = self.sums[panel][side, number] + width * rule.until @ wave
            values[inside] = interpolation(self.points, local) @ wave
        return values

    @cached_property
    def held(self) -> Array:
        """What was sent before tau = 0."""
        made = self.graph
        strain = made.speed * made.start_strain
        bars = np.stack([made.start_velocity - strain, made.start_velocity + strain]) / 2
        return np.hstack([bars, np.zeros((2, len(made.mass)))])


@dataclass(frozen=True)
class Gauss:
    """Points and weights on [0, 1], and the integrals from 0 to each point."""

    nodes: Array
    weights: Array
    until: Array


@cache
def gauss(points: int) -> Gauss:
    """Gauss's rule with so many points."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    integrals = np.stack(
        [np.polynomial.legendre.legval(nodes, np.polynomial.legendre.legint(unit, lbnd=-1)) for unit in np.eye(points)],
        axis=1,
    )
    return Gauss((nodes + 1) / 2, weights / 2, integrals @ _coefficients(points) / 2)


def interpolation(points: int, local: Array) -> Array:
    """From values at Gauss's points to values at others: shape (others, points)."""
    return np.asarray(np.polynomial.legendre.legvander(2 * local - 1, points - 1) @ _coefficients(points))


@cache
def _coefficients(points: int) -> Array:
    """Those of Legendre's polynomials, from values at Gauss's points."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    sizes = np.arange(points)[:, np.newaxis] + 0.5
    return np.asarray(sizes * weights * np.polynomial.legendre.legvander(nodes, points - 1).T)


@cache
def _looked(points: int) -> Array:
    return interpolation(points, _LOOKED)


def integrate_fronts(made: Graph, until: float, points: int, most: int) -> Fronts:
    """The motion for 0 <= tau <= until. Undecided where it takes more than `most` panels, or contacts have no state."""
    return _Integration(made, points, most).motion(until)


class _Integration:
    """Where everything is now."""

    def __init__(self, made: Graph, points: int, most: int) -> None:
        self._made, self._points, self._most = made, points, most
        self._found = Fronts(made, points)
        self._delays = [float(delay) for delay in made.delays]
        self._groups = made.groups
        self._group_of = {point: number for number, group in enumerate(self._groups) for point in group}
        self._given = np.isin(np.arange(len(made.mass)), list(made.given))
        impedance = np.repeat(made.impedance, 2)
        self._onto = np.zeros((len(made.mass), len(made.ends)))
        self._onto[made.ends, np.arange(len(made.ends))] = made.ratios
        self._damping = made.damping + np.diag(self._onto**2 @ impedance)
        self._onto = 2 * self._onto * impedance
        self._u, self._q = np.zeros(len(made.mass)), made.velocity.copy()
        self._open = made.gaps > 0
        self._sums = np.zeros((2, len(made.delays) + len(made.mass)))

    def motion(self, until: float) -> Fronts:
        made, found = self._made, self._found
        fronts = [(0.0, number) for number in range(len(self._groups))]
        fronts += [(float(event.time), self._group_of[event.point]) for event in made.events]
        heapify(fronts)
        fastest, same = self._fastest(), SAME * max(self._delays)
        longest = min([*self._delays, *([_REACH / fastest] if fastest else [])])
        now = 0.0
        while now <= until:
            met: set[int] = set()
            while fronts and fronts[0][0] <= now + same:
                met.add(heappop(fronts)[1])
            for time, group in self._sent_on(now, met):
                if not any(group == other and abs(time - when) <= same for when, other in fronts):
                    heappush(fronts, (time, group))
            end = min(now + longest, fronts[0][0]) if fronts else now + longest
            happened = self._panel(now, end - now)
            now = found.ends[-1]
            for group in happened:
                heappush(fronts, (now, group))
            if len(found.starts) > self._most:
                raise Undecided(f"{self._most} panels end at tau = {now:.4g}")
        return found

    def _sent_on(self, now: float, met: set[int]) -> Iterator[tuple[float, int]]:
        ends = self._made.ends.reshape(-1, 2)
        for bar, delay in enumerate(self._delays):
            for side in (0, 1):
                if self._group_of[int(ends[bar, side])] in met:
                    yield now + delay, self._group_of[int(ends[bar, 1 - side])]

    def _panel(self, now: float, width: float) -> set[int]:
        """One panel, or what there is of it before a contact opens or closes: the groups with such contacts."""
        falls = self._solve(now, width)
        part = min(falls.values(), default=1.0)
        if part < 1.0:  # once more, to where nothing has happened yet
            width *= part
            self._solve(now, width)
        self._store(now, width)
        return {number for number, each in falls.items() if each <= part * (1 + SAME) < 1}

    def _solve(self, now: float, width: float) -> dict[int, float]:
        """How all points move in a panel, and which part of it that holds for, by group with contacts."""
        times = now + width * gauss(self._points).nodes
        self._coming, acting = self._arriving(times), self._acting(times)
        self._velocities, self._states = np.zeros((len(self._q), self._points)), self._open.copy()
        return {
            number: self._settle(list(group), width, self._coming, acting) for number, group in enumerate(self._groups)
        }

    def _store(self, now: float, width: float) -> None:
        made, found, rule = self._made, self._found, gauss(self._points)
        arriving, velocities = self._coming, self._velocities
        for contact in np.flatnonzero(self._states != self._open):
            found.changes.append(Change(int(contact), "opens" if self._states[contact] else "closes", now))
        self._open = self._states
        sent = made.ratios[:, np.newaxis] * velocities[made.ends] - arriving
        bars = len(self._delays)
        waves = np.zeros((2, bars + len(self._q), self._points))
        waves[0, :bars], waves[1, :bars], waves[0, bars:] = sent[0::2], sent[1::2], velocities
        found.starts.append(now)
        found.ends.append(now + width)
        found.waves.append(waves)
        found.sums.append(self._sums.copy())
        self._sums += width * waves @ rule.weights
        self._u += width * velocities @ rule.weights
        self._q = velocities @ interpolation(self._points, np.ones(1))[0]

    def _arriving(self, times: Array) -> Array:
        """What arrives at all ends: shape (ends, times)."""
        result = np.empty((2 * len(self._delays), len(times)))
        for bar, delay in enumerate(self._delays):
            for side in (0, 1):
                result[2 * bar + side] = self._found.sent(1 - side, bar, times - delay)
        return result

    def _acting(self, times: Array) -> Array:
        """The loads on free points, and the velocities of the others: shape (points, times)."""
        made = self._made
        loads, once = (made.load_integral(times, order).T for order in (0, 1))
        for point, order in made.given.items():
            loads[point] = made.velocity[point] + (loads if order == 1 else once)[point]
        return loads

    # contacts

    def _settle(self, group: list[int], width: float, arriving: Array, acting: Array) -> float:
        """Moves a group in the first state of its contacts that will do; which part of the panel it holds for."""
        parting = self._made.parting[:, group]
        here = np.flatnonzero(np.any(parting != 0, axis=1))
        apart = self._made.gaps[here] + self._made.parting[here] @ self._u
        length, force = self._made.worth
        apart[np.abs(apart) <= SAME * length] = 0.0
        choices = [(o, not o) if gap == 0 else (True,) for gap, o in zip(apart, self._open[here], strict=True)]
        states = [np.array(each, dtype=bool) for each in product(*choices)]
        states.sort(key=lambda each: int(np.sum(each != self._open[here])))

        @cache
        def solved(number: int) -> tuple[Array, list[Array]]:
            state = states[number]
            moved, pushes = self._moved(group, here[~state], width, arriving, acting)
            gaps = apart[state, np.newaxis] + parting[here[state]] @ moved @ (width * gauss(self._points).until.T)
            return moved, [*(gaps / length), *(pushes / force)]

        for tolerance in _SIGNS:
            for number, state in enumerate(states):
                moved, positive = solved(number)
                part = min((self._falls(values, tolerance) for values in positive), default=1.0)
                if part > 0:
                    self._velocities[group], self._states[here] = moved, state
                    return part
        raise Undecided("contacts for which neither open nor closed will do")

    def _falls(self, values: Array, least: float) -> float:
        """Where on [0, 1] what is known at Gauss's points becomes negative: 1 if it does not, 0 if it begins so."""
        seen = _looked(self._points) @ values
        told = np.flatnonzero(np.abs(seen) > least)
        below = np.flatnonzero(seen < -least)
        if not len(below):
            return 1.0
        if below[0] == told[0]:
            return 0.0
        left, right = _LOOKED[np.flatnonzero(seen[: below[0]] > 0)[-1]], _LOOKED[below[0]]
        for _ in range(_HALVINGS):
            middle = (left + right) / 2
            value = float((interpolation(self._points, np.array([middle])) @ values)[0])
            left, right = (middle, right) if value > 0 else (left, middle)
        return float(right)

    # motion

    def _moved(
        self, group: list[int], closed: NDArray[np.int_], width: float, arriving: Array, acting: Array
    ) -> tuple[Array, Array]:
        """The velocities of a group at Gauss's points, and the pushes of its closed contacts: collocation."""
        made, n, rule = self._made, self._points, gauss(self._points)
        size, until, one = len(group), width * rule.until, np.eye(self._points)
        given = self._given[group]
        heavy = (made.mass[group] > 0) & ~given
        mass, bound = np.diag(made.mass[group] * heavy), made.parting[closed][:, group]
        damping, stiffness = (matrix[group][:, group] * ~given[:, None] for matrix in (self._damping, made.stiffness))
        # unknown are the accelerations of points with mass, the velocities of others, and pushes
        velocity = np.where(heavy[:, None, None], until, one)
        q0 = np.where(heavy, self._q[group], 0.0)[:, None]
        u0 = self._u[group][:, None] + q0 * (width * rule.nodes)
        held = np.einsum("ij,jab->iajb", damping, velocity) + np.einsum("ij,jab->iajb", stiffness, until @ velocity)
        moved = held + np.einsum("ij,ab->iajb", mass + np.diag(given), one)
        pushed = -np.einsum("ki,ab->iakb", bound * ~given, one)
        kept = np.einsum("kj,jab->kajb", bound, velocity)
        nothing = np.zeros((len(closed), n, len(closed), n))
        system = np.concatenate(
            [np.concatenate([moved, pushed], axis=2), np.concatenate([kept, nothing], axis=2)]
        ).reshape((size + len(closed)) * n, -1)
        right = acting[group] + ~given[:, None] * (self._onto[group] @ arriving) - damping @ q0 - stiffness @ u0
        right = np.concatenate([right, -(bound @ q0) * np.ones(n)]).ravel()
        found = np.linalg.solve(system, right).reshape(-1, n)
        return q0 + np.einsum("jab,jb->ja", velocity, found[:size]), found[size:]

    def _fastest(self) -> float:
        """How fast anything decays or swings, at most, roughly."""
        made = self._made
        c, k = np.sum(np.abs(self._damping), axis=1), np.sum(np.abs(made.stiffness), axis=1)
        heavy = (made.mass > 0) & ~self._given
        with np.errstate(divide="ignore", invalid="ignore"):
            rates = np.where(heavy, np.maximum(c / made.mass, np.sqrt(k / made.mass)), np.where(k > 0, k / c, 0.0))
        return float(2 * np.max(rates))
