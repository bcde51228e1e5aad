"""Momentum and energy over any network: every right evaluator keeps them, and none is told of them.

With M, C, K of the points (no part of the bars in them), impedances Z, delays T, speeds c and the forces
s = Z c U_x of the bars' ends on their points,

    energy = sum of M q^2/2 + u K u/2 + sum of Z times the integral over the last T of right^2 + left^2,
    momentum = sum of w M q + sum of w Z times the integral over the last T of right + left,

where right = (v - c U_x)/2 came in at the left end of a bar and left = (v + c U_x)/2 at its right end. Energy grows by
the work of loads and of prescribed motion, less what dashpots take; momentum by the impulse of loads, dashpots and
springs. The weights w are 1 at the first point; a bar counts `ratio` times as much as its point, so that forces
between bars and points cancel through gears, too. Nothing asks how long the delays are.

A contact pushes what is on its two sides alike, and takes no energy: what it pushes with follows from the balance of
the sides without mass. Where one moves as it is told, that is an impulse, and work.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from heapq import heapify, heappop, heappush
from itertools import pairwise, product
from math import ceil

import numpy as np
from flint import fmpq

from wavesym.exact.contacts.events import events
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import UNIT_ROUNDOFF, fraction, rational
from wavesym.verification.graph import Array, Graph, graph

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
    """By how much a balance fails at most where it is struck, and by how much it may.

    Energy relative to its largest value, momentum to the largest that all the mass can have with that energy.
    """

    name: str
    error: float
    allowed: float


@dataclass(frozen=True)
class Within:
    """Values, and what they may be wrong by."""

    value: Array
    error: Array

    def __add__(self, other: Within) -> Within:
        return Within(self.value + other.value, self.error + other.error)

    def __mul__(self, other: Within) -> Within:
        error = np.abs(self.value) * other.error + np.abs(other.value) * self.error + self.error * other.error
        return Within(self.value * other.value, error)

    def times(self, factor: float) -> Within:
        """A multiple."""
        return Within(factor * self.value, abs(factor) * self.error)

    def through(self, matrix: Array) -> Within:
        """Sums of rows."""
        return Within(matrix @ self.value, np.abs(matrix) @ self.error)

    def part(self, rows: Sequence[int] | slice) -> Within:
        """Some rows."""
        return Within(self.value[rows], self.error[rows])

    def total(self, weights: Array) -> Within:
        """The integral over all times that have weights; these are not negative."""
        return Within(self.value @ weights, self.error @ weights)


class Balancing:
    """A model as it is watched here: at the ends of all bars, and at all points, until the last balance is struck."""

    def __init__(self, model: Model, most: int) -> None:
        """With as many balances as take at most so many values of outputs; none where not even one does.

        CostError, GrazingError where it is not known when contacts open and close.
        """
        self._graph = graph(model)
        network = model.network
        seen: list[Probe] = []
        for quantity in ("velocity", "displacement"):
            seen += [self._at_point(quantity, point) for point in range(len(network.points))]
        ends = [(bar, side) for bar in range(len(network.bars)) for side in (0, 1)]
        seen += [Probe(f"strain@end{k}", "strain", bar + 1, fmpq(side)) for k, (bar, side) in enumerate(ends)]
        until = fraction(model.until)
        limit = most // ((_POINTS + _FEWER) * len(seen))
        fronts, last = self._fronts(until, limit, self._struck(model.watching(seen)))
        self.struck: list[Fraction] = []
        for end, count in product([until / 2**k for k in range(_HALVED)], _STRUCK):
            struck = [end * k / count for k in range(1, count + 1)]
            if end <= last and len(self._cuts(fronts, struck)) <= limit:
                self.struck = struck
                break
        self._cut = np.array([float(cut) for cut in self._cuts(fronts, self.struck)])
        self.model = model.watching(seen)
        if self.struck:
            self.model = self.model.shortened(rational(self.struck[-1]))

    def balances(self, evaluate: Evaluate, errors: Sequence[float] | None = None) -> tuple[Balance, ...]:
        """The balances of momentum and energy, as `evaluate` has the watched model, and what contacts must keep.

        `errors` are the proved errors of the outputs, absolute, None where each value is rounded once: what they come
        to is allowed, and what quadrature misses.
        """
        fine, coarse = (_Books(self, evaluate, errors, points) for points in (_POINTS, _FEWER))
        largest = fine.largest
        unit = _ROUNDINGS * len(self._cut) * float(UNIT_ROUNDOFF)

        def balance(name: str, scale: float) -> Balance:
            ours, theirs = getattr(fine, name), getattr(coarse, name)
            missed = float(np.max(np.abs(ours.value - theirs.value)))
            error, slack = float(np.max(np.abs(ours.value))), float(np.max(ours.error))
            return Balance(name, error / scale, (slack + missed) / scale + unit)

        found = balance("momentum", (2 * largest * fine.mass) ** 0.5), balance("energy", largest)
        return (*found, balance("contacts", largest)) if self._graph.contacts else found

    @property
    def graph(self) -> Graph:
        """What is balanced."""
        return self._graph

    def panels(self, points: int) -> tuple[Array, Array]:
        """Gauss's points and weights, one panel after the other; a panel ends where balances or delays ask for it."""
        nodes, weights = np.polynomial.legendre.leggauss(points)
        low, width = self._cut[:-1, np.newaxis], np.diff(self._cut)[:, np.newaxis]
        return (low + width * (nodes + 1) / 2).ravel(), (width * weights / 2).ravel()

    def _at_point(self, quantity: str, point: int) -> Probe:
        """An output at a point, or at the end of a bar there."""
        for bar, ends in enumerate(self._graph.ends.reshape(-1, 2)):
            for side in (0, 1):
                if ends[side] == point:
                    return Probe(f"{quantity}@point{point}", quantity, bar + 1, fmpq(side))
        return Probe(f"{quantity}@point{point}", quantity, 0, fmpq(0), point)

    def _cuts(self, fronts: Iterable[Fraction], struck: Sequence[Fraction]) -> list[Fraction]:
        """Where panels end: at fronts, and where what is in a bar when a balance is struck has come in."""
        came_in = {time - delay for time in struck for delay in (Fraction(0), *self._graph.delays)}
        ends = sorted({Fraction(0), *(time for time in (*fronts, *came_in) if struck and 0 < time <= struck[-1])})
        cuts = ends[:1]
        for low, high in pairwise(ends):
            parts = max(1, ceil(float(high - low) * self._graph.swings / _SWING))
            cuts += [low + (high - low) * k / parts for k in range(1, parts + 1)]
        return cuts

    def _struck(self, seen: Model) -> list[tuple[Fraction, int]]:
        """When contacts open and close, and a point of each: where panels end, and nothing else."""
        sides = {link.place: link.left for link in seen.network.links if link.contact}
        return [(Fraction(event.double), sides[event.x]) for event in events(seen)] if sides else []

    def _fronts(
        self, until: Fraction, most: int, struck: Sequence[tuple[Fraction, int]]
    ) -> tuple[set[Fraction], Fraction]:
        """When something not smooth can come to a point, so often at most, and until when that is all of them."""
        made = self._graph
        coming = [*struck]
        coming += [(event.time, event.point) for event in made.events]
        coming += [(Fraction(0), point) for point in range(len(made.mass))]
        heapify(coming)
        met: set[tuple[Fraction, int]] = set()
        times: set[Fraction] = set()
        while coming:
            time, here = front = heappop(coming)
            if front in met or time > until:
                continue
            met.add(front)
            times.add(time)
            if len(times) > most:
                return times, time
            for point in self._linked(here):
                heappush(coming, (time, point))
            for bar, ends in enumerate(made.ends.reshape(-1, 2).tolist()):
                for side in (0, 1):
                    if ends[side] == here:
                        heappush(coming, (time + made.delays[bar], ends[1 - side]))
        return times, until

    def _linked(self, point: int) -> Iterator[int]:
        yield from (other for group in self._graph.groups if point in group for other in group if other != point)


class _Books:
    """What is stored and what comes in, with so many points a panel."""

    def __init__(self, balancing: Balancing, evaluate: Evaluate, errors: Sequence[float] | None, points: int) -> None:
        made = self._graph = balancing.graph
        self._struck = np.array([float(time) for time in balancing.struck])
        self._delays = [float(delay) for delay in made.delays]
        self._times, self._weights = balancing.panels(points)
        size = len(made.mass)

        def at(times: Array) -> tuple[Within, Within, Within]:
            values = evaluate(times)
            rounded = float(UNIT_ROUNDOFF) * np.max(np.abs(values), axis=1)
            allowed = rounded if errors is None else np.array(errors)
            known = Within(values, np.zeros_like(values) + allowed[:, np.newaxis])
            speeds = np.repeat(made.speed, 2)
            scale = np.array([made.ratios[list(made.ends).index(p)] if p in made.ends else 1.0 for p in range(size)])
            both = [known.part(slice(k * size, (k + 1) * size)).through(np.diag(1 / scale)) for k in (0, 1)]
            return both[0], both[1], known.part(slice(2 * size, None)).through(np.diag(speeds))

        self._q, _, self._strain = at(self._times)
        self._end_q, self._end_u, _ = at(self._struck)
        self._end_u_all = at(self._times)[1]
        self._v = self._q.part(made.ends.tolist()).through(np.diag(made.ratios))
        self._load = Within(made.load_integral(self._times, 0).T, np.zeros((size, len(self._times))))
        impedance = np.repeat(made.impedance, 2)
        sign = np.tile([1.0, -1.0], len(made.impedance))
        self._force = self._strain.through(np.diag(sign * impedance))  # of the ends on their points

    @cached_property
    def _free(self) -> Array:
        """1 for points that are free to move, 0 for others."""
        free = np.zeros(len(self._graph.mass))
        free[self._graph.free] = 1.0
        return free

    @cached_property
    def _coming(self) -> Within:
        """What came in at all ends, each into its bar."""
        sign = np.tile([-0.5, 0.5], len(self._graph.impedance))
        return self._v.times(0.5) + self._strain.through(np.diag(sign))

    def _content(self, power: int, weights: Array) -> Within:
        """The sum over bars of weights times the integral of their waves, to a power, when balances are struck."""
        coming = self._coming if power == 1 else self._coming * self._coming
        value, error = np.zeros(len(self._struck)), np.zeros(len(self._struck))
        for k, tau in enumerate(self._struck):
            for bar, delay in enumerate(self._delays):
                inside = self._weights * ((self._times > tau - delay) & (self._times < tau))
                part = coming.part([2 * bar, 2 * bar + 1]).total(inside)
                left = max(delay - tau, 0.0)  # of this length there is still what was there at the start
                first = np.array([-1.0, 1.0]) * self._graph.speed[bar] * self._graph.start_strain[bar]
                held = (self._graph.start_velocity[bar] + first) / 2
                value[k] += weights[bar] * (np.sum(part.value) + left * np.sum(held**power))
                error[k] += abs(weights[bar]) * np.sum(part.error)
        return Within(value, error)

    def _since(self, rate: Within) -> Within:
        """The integral of what comes in, until balances are struck."""
        until = (self._times[:, np.newaxis] < self._struck) * self._weights[:, np.newaxis]
        return Within(rate.value @ until, rate.error @ until)

    # energy

    @cached_property
    def stored(self) -> Within:
        """The energy when balances are struck."""
        made, q, u = self._graph, self._end_q, self._end_u
        total = self._content(2, made.impedance) + (q * q).through(made.mass / 2)
        return total + (u * u.through(made.stiffness)).through(np.full(len(made.mass), 0.5))

    @property
    def largest(self) -> float:
        """The largest energy, at tau = 0 or when balances are struck; 1 where all are 0."""
        return max(float(np.max(self.stored.value)), self.started) or 1.0

    @cached_property
    def started(self) -> float:
        """The energy at tau = 0."""
        made = self._graph
        bars = made.impedance * np.array(self._delays)
        strain = made.speed * made.start_strain
        moving = made.mass @ made.velocity**2 / 2
        return float(moving + bars @ (made.start_velocity**2 + strain**2) / 2)

    @cached_property
    def energy(self) -> Within:
        """By how much energy is not what was there and what came."""
        made, q = self._graph, self._q
        power = (self._load * q).through(self._free) + (q * q.through(made.damping)).through(
            np.full(len(q.value), -1.0)
        )
        told = (self._force * self._v).through(-(1 - self._free)[made.ends])
        told += (self._pushed * q).through(self._free - 1)
        lost = q.through(made.damping) + self._end_u_all.through(made.stiffness)
        power = power + told + (q * lost).through(1 - self._free)
        came = self._since(power)
        return self.stored + came.times(-1.0) + Within(np.full(len(self._struck), -self.started), np.zeros(1))

    # momentum

    @cached_property
    def _counted(self) -> tuple[Array, Array]:
        """The weights of points and of bars in the momentum."""
        made = self._graph
        points, bars = np.zeros(len(made.mass)), np.zeros(len(made.impedance))
        ends, ratios = made.ends.reshape(-1, 2), made.ratios.reshape(-1, 2)
        known = np.zeros(len(points), dtype=bool)
        for first in range(len(points)):
            if known[first]:
                continue
            points[first], known[first] = 1.0, True
            waiting = [first]
            while waiting:
                here = waiting.pop()
                joined = [(b, s) for b in range(len(bars)) for s in (0, 1) if ends[b, s] == here]
                for bar, side in joined:
                    bars[bar] = ratios[bar, side] * points[here]
                    there = ends[bar, 1 - side]
                    if not known[there]:
                        points[there], known[there] = bars[bar] / ratios[bar, 1 - side], True
                        waiting.append(int(there))
                for row in made.parting[made.parting[:, here] != 0]:
                    for other in np.flatnonzero(row):
                        if not known[other]:
                            points[other], known[other] = -row[here] / row[other] * points[here], True
                            waiting.append(int(other))
                for other in np.flatnonzero((made.damping[here] != 0) | (made.stiffness[here] != 0)):
                    if not known[other]:
                        points[other], known[other] = points[here], True
                        waiting.append(int(other))
        return points, bars

    @property
    def mass(self) -> float:
        """All of it, as it counts in the momentum."""
        points, bars = self._counted
        return float(points**2 @ self._graph.mass + bars**2 @ (self._graph.impedance * np.array(self._delays)))

    @cached_property
    def momentum(self) -> Within:
        """By how much momentum is not what was there and what came."""
        made = self._graph
        points, bars = self._counted
        counted = points * self._free * self._unheld
        value = self._content(1, bars * made.impedance) + self._end_q.through(counted * made.mass)
        rate = (self._load + self._q.through(-made.damping) + self._end_u_all.through(-made.stiffness)).through(counted)
        across = made.ratios * counted[made.ends] - np.repeat(bars, 2)  # 0 but where prescribed motion holds
        came = self._since(rate + self._force.through(across))
        moving = bars * made.impedance * np.array(self._delays)
        before = float(counted * made.mass @ made.velocity + moving @ made.start_velocity)
        return value + came.times(-1.0) + Within(np.full(len(self._struck), -before), np.zeros(1))

    # contacts

    @cached_property
    def _unheld(self) -> Array:
        """0 for points without mass that contacts may hold to a prescribed motion, 1 for others."""
        made, held = self._graph, 1 - self._free
        touching = made.parting != 0
        for _ in made.parting:
            held = np.maximum(held, np.any(touching[np.any(touching & (held > 0), axis=1)], axis=0))
        return np.where(made.mass == 0, 1 - held, 1.0)

    @cached_property
    def _push(self) -> Within:
        """What contacts push with: what points without mass need to be in balance."""
        made = self._graph
        onto = np.zeros((len(made.mass), len(made.ends)))
        onto[made.ends, np.arange(len(made.ends))] = made.ratios
        acting = self._load + self._force.through(onto) + self._q.through(-made.damping)
        acting += self._end_u_all.through(-made.stiffness)
        light = (made.mass == 0) & (self._free > 0)
        return acting.part(np.flatnonzero(light).tolist()).through(
            np.asarray(-np.linalg.pinv(made.parting[:, light].T))
        )

    @cached_property
    def _pushed(self) -> Within:
        """What contacts do to points."""
        return self._push.through(self._graph.parting.T)

    @cached_property
    def contacts(self) -> Within:
        """How far a push or a gap is negative, or neither is 0, at any time; as an energy."""
        made, push = self._graph, self._push
        gap = self._end_u_all.through(made.parting) + Within(made.gaps[:, np.newaxis], np.zeros(1))
        length = (2 * self.largest / self.mass) ** 0.5 * max(self._delays)
        parts = [push.times(length), gap.times(self.largest / length)]
        wrong = [np.maximum(-part.value, 0.0) for part in parts]
        both = np.minimum(*(np.abs(part.value) for part in parts))
        errors = np.maximum(*(part.error for part in parts))
        return Within(np.max(np.maximum(np.maximum(*wrong), both), axis=1), np.max(errors, axis=1))
