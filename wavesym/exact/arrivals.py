"""When each output first differs from 0, exactly, and which never do though waves arrive: at a free end, or in
the middle of what is symmetric.

Rounding hides it, exact tables are too long; but a network moves as well in Laplace transforms, one number for what
each front carries and every fixed s. With all of them times s, and t = 1/s, a joint obeys

    (M + C t + K t^2) Q = M v + t P,        P = sum over ends of 2 n Z A + loads,        sent back: n Q - A

(v at tau = 0 only; without mass, (C + K t) Q = P). An output is 0 if all that arrives at one instant adds up to 0.
Computed modulo a prime at a random t, a sum that is not 0 is taken for 0 with a chance of less than one in 2**70: as a
rational function of t its numerator has a degree below 2**50, and t is one of 2**127 numbers.

Of what arrives at the end of the horizon only the jump is seen, and that is the sum at t = 0. Of an acceleration it is
the slope there of a sum Q with Q(0) = 0: Q(p) / p modulo the prime p, where Q(p) is known modulo p^2. So all is
computed modulo p^2, and t = p stands for 0.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from math import factorial

from flint import fmpq, fmpz_mod_ctx, fmpz_mod_mat

from wavesym.derivation.factors import joint_rule
from wavesym.exact.joints.fronts import departures
from wavesym.exact.joints.joint_law import JointLaw, joint_ends
from wavesym.mechanics.gauge import Gauge, Sum
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Bar, End, Network

_PRIME = 2**127 - 1
_MODULUS = _PRIME**2
_FIELD, _RING = fmpz_mod_ctx(_PRIME), fmpz_mod_ctx(_MODULUS)
_T = 0x5EED_C0FFEE_1234_5678_9ABC_DEF0_1357 % _PRIME  # drawn once, so that the same scene makes the same files


def identically_zero(model: Model, until: fmpq) -> list[bool]:
    """Whether each output is 0 on all of [0, until].

    Most outputs differ from 0 soon, and only those that do not are followed for longer; what a free end bears is known.

    Args:
        model: a scene's model.
        until: the end of the interval, in tau.

    Returns:
        One for each output, in its order. False where contacts open and close: no transform decides it then.
    """
    if model.network.corners:
        return [False] * len(model.probes)
    free = {k for k, probe in enumerate(model.probes) if _is_at_free_end(model.network, model.sums[probe])}
    still = {k: probe for k, probe in enumerate(model.probes) if k not in free}
    for part in (64, 8, 1):
        if still:
            found = arrivals(model.watching([*still.values()]), until / part)
            still = {k: still[k] for k, first in zip(still, found, strict=True) if first is None}
    return [k in still or k in free for k in range(len(model.probes))]


def _is_at_free_end(network: Network, terms: Sum) -> bool:
    """Whether an output is a strain of ends on which nothing acts, so that there is none."""
    return all(
        reading.quantity == "strain"
        and reading.place in (0, 1)
        and network.is_free(End(reading.rod - 1, int(reading.place)))
        for _, reading in terms
    )


def smooth_starts(model: Model, until: fmpq) -> list[fmpq | None]:
    """When each output, 0 until then, begins to differ from 0 without a jump.

    None where it jumps, or is identically zero, or where contacts open and close.
    """
    if model.network.corners:
        return [None] * len(model.probes)
    found: list[fmpq | None] = []
    for sums, jumps in _gains(model, until):
        first = min((time for time in sums if sums[time]), default=None)
        found.append(first if first is not None and not jumps[first] else None)
    return found


def arrivals(model: Model, until: fmpq) -> list[fmpq | None]:
    """When each output first differs from 0 on [0, until]; None where it does not.

    Not where contacts open and close.
    """
    return [
        min((time for time in sums if sums[time] and (time < until or jumps[until])), default=None)
        for sums, jumps in _gains(model, until)
    ]


_Sums = Mapping[fmpq, int]


def _gains(model: Model, until: fmpq) -> Iterator[tuple[_Sums, _Sums]]:
    """What each output gains at each instant, and by how much it jumps there; both in transforms."""
    orders = [_highest(terms) for terms in model.sums.values()]
    at_once = _Fronts(model, until, _PRIME if any(orders) else 0).sums()
    jumps = (
        defaultdict(int, {time: value // _PRIME**order % _PRIME for time, value in sums.items()})
        for order, sums in zip(orders, at_once, strict=True)
    )
    return zip(_Fronts(model, until, _T).sums(), jumps, strict=True)


def _highest(terms: Sum) -> int:
    """The highest order of the readings of an output, 0 at least: what is computed of it is times t to this power."""
    return max([0, *(reading.order for _, reading in terms)])


class _Fronts:
    """All that leaves joints, front by front, at one t."""

    def __init__(self, model: Model, until: fmpq, t: int) -> None:
        self._model, self._until, self._t = model, until, t
        self._network = model.network
        self._reached = model.joints_in_reach(until)
        self._joints = {number: _Answer(model, number, t) for number in self._reached}

    def sums(self) -> list[dict[fmpq, int]]:
        """What arrives at each output, by instant."""
        network = self._network
        sums: list[dict[fmpq, int]] = [defaultdict(int) for _ in self._model.probes]
        ends: dict[End, list[tuple[int, fmpq, int]]] = defaultdict(list)
        points: dict[int, list[tuple[int, int]]] = defaultdict(list)

        def gain(k: int, time: fmpq, value: int) -> None:
            sums[k][time] = (sums[k][time] + value) % _MODULUS

        for k, probe in enumerate(self._model.probes):
            highest = _highest(self._model.sums[probe])
            for weight, reading in self._model.sums[probe]:
                if reading.rod:
                    for end, factor, delay in reading.waves(network):
                        bar, weighted = network.bars[end.bar], self._velocity_weight(weight * factor, reading, highest)
                        ends[end].append((k, delay, weighted))
                        # what a bar holds is there until something is sent into it
                        gain(k, fmpq(0), weighted * _held_wave(bar, end.side, bar.delay - delay, self._t))
                elif (point := reading.point) is None:
                    gain(k, fmpq(0), _modular(weight))  # a constant
                elif reading.quantity == "load":
                    for time, value in self._joints[network.joint_of[point]].acts(point):
                        if time <= self._until:
                            gain(k, time, _modular(weight) * value)
                else:
                    points[point].append((k, self._velocity_weight(weight, reading, highest)))

        def answer(number: int, time: fmpq, came: Mapping[End, int]) -> Iterator[tuple[End, int]]:
            sent, moved = self._joints[number].respond(came, time)
            for point, value in moved.items():
                for k, counted in points[point]:
                    gain(k, time, counted * value)
            return ((end, value) for end, value in sent.items() if value)

        begins = ((time, n) for n, joint in self._joints.items() for time in (fmpq(0), *joint.begins))
        starts = [(time, number) for time, number in begins if time <= self._reached[number]]
        for time, end, value in departures(network, starts, answer, self._reached):
            for k, delay, counted in ends[end]:
                if time + delay <= self._until:
                    gain(k, time + delay, counted * value)
        return sums

    def _velocity_weight(self, weight: fmpq, reading: Gauge, highest: int) -> int:
        """What a velocity counts, times t to the `highest` power; t to the order less where it is differentiated."""
        return _modular(weight) * pow(self._t, highest - reading.order, _MODULUS) % _MODULUS


class _Answer:
    """What a joint sends when something arrives."""

    def __init__(self, model: Model, number: int, t: int) -> None:
        self._network = network = model.network
        self._joint = joint = network.joints[number]
        self._t = t
        law = JointLaw.assemble(network, joint)
        self._law = law
        self._ends = joint_ends(network, joint)
        self._free = [k for k, given in enumerate(law.motions) if given is None]
        rows = [[self._factor(k, b) for b in self._free] for k in self._free]
        self._inverse = _inverse(rows) if rows else None
        self._loads: dict[fmpq, dict[int, int]] = defaultdict(dict)
        place = {point: k for k, point in enumerate(joint.points)}
        self._place = place
        for load in model.loads:
            for point in joint.points:
                for unit in network.points[point].loads:
                    if unit.source == load.source:
                        k = place[point]
                        value = self._transform(network.points[point].action(unit))
                        here = self._loads[load.time]
                        here[k] = (here.get(k, 0) + _modular(load.weight) * value) % _MODULUS

    def acts(self, point: int) -> Iterator[tuple[fmpq, int]]:
        """The loads on a point, each with when it begins or changes."""
        return ((time, here.get(self._place[point], 0)) for time, here in self._loads.items())

    @property
    def begins(self) -> Iterator[fmpq]:
        """When loads on it begin or change."""
        return iter(self._loads)

    def _factor(self, a: int, b: int) -> int:
        """(M + C t + K t^2), or (C + K t) for a point without mass."""
        law, t = self._law, self._t
        c, k = _modular(law.damping[a][b]), _modular(law.stiffness[a][b])
        if law.mass[a] == 0:
            return (c + k * t) % _MODULUS
        return ((_modular(law.mass[a]) if a == b else 0) + c * t + k * t * t) % _MODULUS

    def _transform(self, coefficients: tuple[fmpq, ...]) -> int:
        return sum(_modular(c) * factorial(n) * pow(self._t, n, _MODULUS) for n, c in enumerate(coefficients))

    def respond(self, came: Mapping[End, int], time: fmpq) -> tuple[dict[End, int], dict[int, int]]:
        """What it sends into its ends when this arrives, and the velocities of its points; as changes of both.

        At tau = 0 what bars hold arrives.
        """
        network, law, t = self._network, self._law, self._t
        rule = joint_rule()
        loads = self._loads.get(time, {})
        if begins := time == 0:
            came = {
                each.end: _held_wave(network.bars[each.end.bar], 1 - each.end.side, fmpq(0), t) for each in self._ends
            }
        push = {k: _modular(rule.load) * loads.get(k, 0) for k in range(len(law.mass))}
        for each in self._ends:
            if value := came.get(each.end, 0):
                push[each.place] += _modular(each.force) * value
        q = {}
        for k, given in enumerate(law.motions):
            if given is not None:
                start = _modular(network.points[self._joint.points[k]].velocity) if begins else 0
                q[k] = (loads.get(k, 0) + start) % _MODULUS
        right = []
        for a in self._free:
            value = push[a] * (1 if law.mass[a] == 0 else t)
            if begins and law.mass[a] != 0:
                value += _modular(law.mass[a] * network.points[self._joint.points[a]].velocity)
            value -= sum(self._factor(a, b) * moved for b, moved in q.items())
            right.append([value % _MODULUS])
        if self._inverse is not None:
            found = self._inverse * fmpz_mod_mat(right, _RING)
            q |= {a: int(found[n, 0]) for n, a in enumerate(self._free)}
        sent = {}
        for end, k, ratio, _ in self._ends:
            value = _modular(ratio) * q[k] - came.get(end, 0)
            bar = network.bars[end.bar]
            sent[end] = (value - (_held_wave(bar, end.side, bar.delay, t) if begins else 0)) % _MODULUS
        return sent, {point: q[k] for point, k in self._place.items()}


def _inverse(rows: list[list[int]]) -> fmpz_mod_mat:
    """That of a matrix modulo p^2, from the one modulo p by Newton's step X (2 - A X)."""
    known = fmpz_mod_mat([[int(c) for c in row] for row in fmpz_mod_mat(rows, _FIELD).inv().tolist()], _RING)
    product = (fmpz_mod_mat(rows, _RING) * known).tolist()
    left = [[2 * (a == b) - int(c) for b, c in enumerate(row)] for a, row in enumerate(product)]
    return known * fmpz_mod_mat(left, _RING)


def _held_wave(bar: Bar, side: int, since: fmpq, t: int) -> int:
    """What a bar holds at tau = 0 and was sent from an end so long after the first of it, as if that went on."""
    return (_modular(bar.initial_wave(side, since)) + t * _modular(bar.initial_slope)) % _MODULUS


def _modular(value: fmpq) -> int:
    return int(value.p) * pow(int(value.q), -1, _MODULUS) % _MODULUS
