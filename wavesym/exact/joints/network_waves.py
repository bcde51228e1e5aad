"""The waves of a network: joints moved from knot to knot, in the order in which their stretches start."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from heapq import heapify, heappop, heappush

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from wavesym.exact.joints.joint import STILL, Enclosed, JointLaw, JointMotion
from wavesym.exact.joints.node_rules import joint_rule
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.network import End, Joint, Network

# on a stretch that is shorter a few powers are enough
_BRIEF = fmpq(1, 2**64)
_COARSE, _FIRST = 32, 8


@dataclass
class SentWave:
    """The wave sent into a bar from one of its ends, stretch by stretch."""

    starts: list[fmpq] = field(default_factory=list)
    stretches: list[Enclosed] = field(default_factory=list)
    _asked: int = 0

    def at(self, tau: fmpq) -> tuple[Enclosed, fmpq]:
        """The stretch that tau is in, and how long after its start. (Mostly the one asked for last, or the next.)"""
        starts, place = self.starts, self._asked
        if tau < starts[place]:
            place = bisect_right(starts, tau, hi=place) - 1
        elif place + 1 < len(starts) and starts[place + 1] <= tau:
            place = bisect_right(starts, tau, lo=place + 1, hi=min(place + 3, len(starts))) - 1
            if place == self._asked + 2:
                place = bisect_right(starts, tau, lo=place) - 1
        self._asked = place
        return self.stretches[place], tau - starts[place]

    def rounded(self, last: fmpq) -> SentWave:
        """The same at the working precision, up to its `last` instant, without powers that count for nothing."""
        ends = [*self.starts[1:], last]
        return SentWave(
            self.starts,
            [_rounded(known, end - start) for start, end, known in zip(self.starts, ends, self.stretches, strict=True)],
        )


class Waves:
    """What is sent into the bars of a network: at first what they hold; and the velocities that no bar shows."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.sent: dict[End, SentWave] = {}
        for number, bar in enumerate(network.bars):
            for side in (0, 1):
                held = bar.held(side)
                constant = Enclosed.of(fmpq_poly([held])) if held != 0 else STILL
                self.sent[End(number, side)] = SentWave([-bar.delay], [constant])
        shown = {network.point_at(end) for end in self.sent if network.bars[end.bar].ratios[end.side] == 1}
        self.velocities = {
            number: SentWave()
            for number, point in enumerate(network.points)
            if number not in shown or point.motion is not None
        }

    def is_bare(self, end: End, tau: fmpq) -> bool:
        """Whether nothing acts at an end of a bar from an instant on, so that it is not strained."""
        return self.network.is_free(end)

    def arriving(self, number: int, start: fmpq, length: fmpq | None = None) -> list[Enclosed]:
        """What comes to the ends at a joint from an instant on, in the time since then (and for so long)."""
        waves = []
        for end, _ in self.network.joints[number].ends:
            known, offset = self.sent[self.network.beyond(end)].at(start - self.network.bars[end.bar].delay)
            if length is None:
                waves.append(later(known, offset))
            elif length < _BRIEF:
                waves.append(briefly(known, offset, length))
            else:
                waves.append(_shortened(later(known, offset), length))
        return waves


class NetworkWaves(Waves):
    """The waves of the joints whose knots are given, at the working precision."""

    def __init__(
        self, network: Network, knots: Mapping[int, Sequence[fmpq]], loads: Sequence[Applied], terms: int
    ) -> None:
        super().__init__(network)
        self._knots = knots
        self._terms = terms
        self._joints = {number: _MovingJoint(network, network.joints[number], loads) for number in knots}
        self._march()

    def _march(self) -> None:
        coming = [(times[0], number, 0) for number, times in self._knots.items() if times]
        heapify(coming)
        while coming:
            start, number, place = heappop(coming)
            times = self._knots[number]
            if place + 1 < len(times):
                heappush(coming, (times[place + 1], number, place + 1))
                self._move(number, start, times[place + 1] - start)

    def _move(self, number: int, start: fmpq, length: fmpq) -> None:
        joint = self.network.joints[number]
        arriving = self.arriving(number, start)
        for (end, _), wave in zip(
            joint.ends, self._joints[number].sends(arriving, start, length, self._terms), strict=True
        ):
            self.sent[end].starts.append(start)
            self.sent[end].stretches.append(wave)
        for k, point in enumerate(joint.points):
            if point in self.velocities:
                self.velocities[point].starts.append(start)
                self.velocities[point].stretches.append(self._joints[number].velocities[k])


class _MovingJoint:
    def __init__(self, network: Network, joint: Joint, loads: Sequence[Applied]) -> None:
        self._network, self._joint = network, joint
        self._place = {point: k for k, point in enumerate(joint.points)}
        self._motion = JointMotion(
            JointLaw.of(network, joint),
            [arb(network.points[point].velocity) for point in joint.points],
            [arb(0)] * len(joint.points),
        )
        self._loads = [Acting(network, point, loads) for point in joint.points]
        law = self._motion.law
        self._scatters = not (law.heavy or law.springs) and len(law.light) == len(joint.points)

    def sends(self, arriving: Sequence[Enclosed], start: fmpq, length: fmpq, terms: int) -> list[Enclosed]:
        """What goes back into the ends on a stretch."""
        acting = [load.on(start) for load in self._loads]
        rule = joint_rule()
        forces = [Enclosed(arb_poly([arb(rule.load * c) for c in p.coeffs()]), arb(0)) for p in acting]
        bars = [self._network.bars[end.bar] for end, _ in self._joint.ends]
        factors = [
            rule.arrives[1 - end.side] * bar.ratios[end.side] * bar.impedance
            for bar, (end, _) in zip(bars, self._joint.ends, strict=True)
        ]
        if self._scatters:
            return self._scattered(arriving, forces, factors)
        for (_, point), wave, factor in zip(self._joint.ends, arriving, map(arb, factors), strict=True):
            k = self._place[point]
            forces[k] = Enclosed(
                forces[k].polynomial + factor * wave.polynomial, forces[k].error + abs(factor) * wave.error
            )
        self.velocities = velocities = self._motion.moved(forces, acting, length, terms)
        result = []
        for (end, point), wave in zip(self._joint.ends, arriving, strict=True):
            ratio = arb(self._network.bars[end.bar].ratios[end.side])
            q = velocities[self._place[point]]
            result.append(Enclosed(ratio * q.polynomial - wave.polynomial, (abs(ratio) * q.error + wave.error).upper()))
        return result

    def _scattered(
        self, arriving: Sequence[Enclosed], forces: Sequence[Enclosed], factors: Sequence[fmpq]
    ) -> list[Enclosed]:
        """Where nothing has mass or springs: sums with exact factors, so that an absorbing end sends back exactly 0."""
        inverse, points = self._motion.law.inverse, range(len(self._joint.points))
        places = [self._place[point] for _, point in self._joint.ends]
        arrived = list(zip(places, factors, arriving, strict=True))
        felt = [[(factor * inverse[k, here], wave) for here, factor, wave in arrived] for k in points]
        pushed = [[(inverse[k, j], forces[j]) for j in points] for k in points]
        self.velocities = [weighted([*felt[k], *pushed[k]]) for k in points]
        result = []
        for number, ((end, _), k) in enumerate(zip(self._joint.ends, places, strict=True)):
            ratio = self._network.bars[end.bar].ratios[end.side]
            sent = [(ratio * factor - (n == number), wave) for n, (factor, wave) in enumerate(felt[k])]
            result.append(weighted([*sent, *((ratio * factor, force) for factor, force in pushed[k])]))
        return result


class Acting:
    """What acts on a point (or prescribes its velocity), as an exact polynomial in the time since some instant."""

    def __init__(self, network: Network, point: int, loads: Sequence[Applied]) -> None:
        units = {unit.source: fmpq_poly(list(unit.coefficients)) for unit in network.points[point].loads}
        motion = network.points[point].motion
        self._coming = sorted(
            ((load.time, load.weight * units[load.source]) for load in loads if load.source in units),
            key=lambda x: x[0],
        )
        if motion == "acceleration":
            self._coming = [(time, polynomial.integral()) for time, polynomial in self._coming]
        self._coming.reverse()
        begin = network.points[point].velocity if motion is not None else fmpq(0)
        self._since, self._total = fmpq(0), fmpq_poly([begin])

    def on(self, start: fmpq) -> fmpq_poly:
        """From `start` on; instants come in order."""
        self._total = self._total(fmpq_poly([start - self._since, 1]))
        self._since = start
        while self._coming and self._coming[-1][0] <= start:
            time, polynomial = self._coming.pop()
            self._total += polynomial(fmpq_poly([start - time, 1]))
        return self._total


def weighted(terms: Sequence[tuple[fmpq, Enclosed]]) -> Enclosed:
    """A sum with exact factors; what has the factor 0 is not in it."""
    polynomial, error = arb_poly(), arb(0)
    for factor, known in terms:
        if factor == 1:
            polynomial += known.polynomial
            error += known.error
        elif factor == -1:
            polynomial -= known.polynomial
            error += known.error
        elif factor != 0:
            size = arb(factor)
            polynomial += size * known.polynomial
            error += abs(size) * known.error
    return Enclosed(polynomial, error.upper())


def later(known: Enclosed, by: fmpq) -> Enclosed:
    """The same function in the time since an instant that is `by` later."""
    if by == 0 or (known.polynomial.length() <= 1 and not known.choices and not known.bounded):
        return known
    if known.exact is not None:
        return Enclosed.of(known.exact(fmpq_poly([by, 1])))
    choices = tuple(later(each, by) for each in known.choices)
    least, most = _bounds_later(known, by)
    return Enclosed(known.polynomial(arb_poly([arb(by), 1])), known.error, None, choices, None, least, most)


def _bounds_later(known: Enclosed, by: fmpq) -> tuple[fmpq_poly | None, fmpq_poly | None]:
    least, most = (None if p is None else p(fmpq_poly([by, 1])) for p in (known.least, known.most))
    return least, most


def _rounded(known: Enclosed, length: fmpq) -> Enclosed:
    return _shortened(Enclosed(known.polynomial * arb(1), known.error, known.exact), length)


def _shortened(known: Enclosed, length: fmpq) -> Enclosed:
    """Without the highest powers, as far as they count for less on a stretch than the last bit of the first ones."""
    powers = known.polynomial.coeffs()
    if known.exact is not None or len(powers) < 2:
        return known
    bits, count, rest = ctx.prec, len(powers), arb(0)
    with ctx.workprec(_COARSE):
        h = arb(length)
        size = max((abs(c) * h**k).upper() for k, c in enumerate(powers[:_FIRST]))
        least = size * arb(2) ** (-bits - 4)
        while count and (more := (rest + abs(powers[count - 1]) * h ** (count - 1)).upper()) <= least:
            rest = more
            count -= 1
    if count == len(powers):
        return known
    return replace(known, polynomial=arb_poly(powers[:count]), error=(known.error + rest).upper())


def briefly(known: Enclosed, by: fmpq, length: fmpq) -> Enclosed:
    """The same as `later` on a short stretch: Taylor's first powers, and what the others can add."""
    terms = 2 + ctx.prec // 64
    if known.exact is not None or known.polynomial.length() <= terms:
        return later(known, by)
    choices = tuple(briefly(each, by, length) for each in known.choices)
    here, derivative, powers, share = arb(by), known.polynomial, [], arb(1)
    for n in range(1, terms):
        powers.append(derivative(here) * share)
        derivative, share = derivative.derivative(), share / n
    span = here.union(arb(by + length))
    rest = abs(derivative(span) * share) * arb(length) ** (terms - 1)
    least, most = _bounds_later(known, by)
    return Enclosed(arb_poly(powers), (known.error + rest).upper(), None, choices, None, least, most)
