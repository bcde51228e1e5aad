"""A joint with contacts: closed ones make one of their points, open ones leave them apart.

A closed contact pushes with a force N >= 0, the right point forwards and the left one backwards; an open one has a gap
>= 0, which changes at a `rate`. With the balance of a point k, M q' + C q + K u = s + what contacts push, N is the sum
of C q + K u - s over the points on one side of the contact, which have no mass.

On a stretch so short that it does not matter which contacts are closed when, these are `vague`. Whatever they do, the
velocities of points without mass are those under one choice of closed contacts, of which there are few, and the force
of a contact is 0 or what it is under one of them. What has mass, and springs, feel a force between 0 and the largest
of these. The bound is taken for granted, and then shown to be larger than what follows from it: as velocities of masses
and displacements are continuous, no force can have been the first to pass it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, combinations
from math import log2

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from wavesym.errors import WavesymError
from wavesym.exact.exact_joint import ExactMotion
from wavesym.exact.joint import Enclosed, JointLaw, JointMotion
from wavesym.exact.network_waves import Acting, weighted
from wavesym.exact.node_rules import joint_rule
from wavesym.model.loads import Applied
from wavesym.model.network import Network

Closed = frozenset[int]
"""Contacts, by the numbers of their links."""

_SLACK = fmpq(1, 2**20)
_ROUNDS = 8  # in which a bound of the forces must hold


@dataclass(frozen=True)
class Touch:
    """A contact between two points of a joint, told by their places in it: closed, right moves `ratio` times left."""

    left: int
    right: int
    ratio: fmpq


@dataclass(frozen=True)
class TouchingLaw:
    """The law of a joint with some contacts closed; `pushes` has the points and factors that make each one's force."""

    law: JointLaw
    pushes: Mapping[int, Sequence[tuple[int, fmpq]]]

    @classmethod
    def of(cls, law: JointLaw, touches: Mapping[int, Touch], closed: Closed) -> TouchingLaw:
        """From the law with all contacts open."""
        size = len(law.mass)
        rigid = [k for k in range(size) if law.mass[k] != 0 or law.given[k] is not None]
        ways: dict[int, list[tuple[int, fmpq]]] = {k: [] for k in range(size)}
        for number in closed:
            touch = touches[number]
            ways[touch.left].append((touch.right, touch.ratio))
            ways[touch.right].append((touch.left, 1 / touch.ratio))
        members: dict[int, tuple[int, fmpq]] = {}
        leaders: list[int] = []
        for leader in chain(rigid, range(size)):
            if leader in members:
                if leader in rigid and leader not in leaders:
                    raise WavesymError("contacts: two rigid bodies would touch each other, a rod between them expected")
                continue
            for k, ratio in _reached(leader, ways):
                members[k] = (len(leaders), ratio)
            leaders.append(leader)
        pushes = {}
        for number in closed:
            touch = touches[number]
            cut = {
                k: [(j, ratio) for j, ratio in way if {k, j} != {touch.left, touch.right}] for k, way in ways.items()
            }
            beyond = [k for k, _ in _reached(touch.right, cut)]
            sign = fmpq(1)
            if leaders[members[touch.right][0]] in beyond:
                beyond, sign = [k for k, _ in _reached(touch.left, cut)], fmpq(-1)
            pushes[number] = [(k, sign * members[k][1] / members[touch.right][1]) for k in beyond]
        order = sorted(range(len(leaders)), key=leaders.__getitem__)
        place = {group: n for n, group in enumerate(order)}
        return cls(
            law.grouped(
                [(place[group], ratio) for group, ratio in (members[k] for k in range(size))],
                [leaders[group] for group in order],
            ),
            pushes,
        )


def _reached(start: int, ways: Mapping[int, Sequence[tuple[int, fmpq]]]) -> Iterator[tuple[int, fmpq]]:
    """The points that move with one, and how fast."""
    known = {start}
    coming = [(start, fmpq(1))]
    while coming:
        here, ratio = coming.pop()
        yield here, ratio
        for other, factor in ways[here]:
            if other not in known:
                known.add(other)
                coming.append((other, ratio * factor))


@dataclass(frozen=True)
class Moved:
    """A joint on a stretch: the velocities of its points, what it sends, and its state at the end."""

    joint: TouchingJoint
    law: TouchingLaw
    length: fmpq
    velocities: list[Enclosed]
    sent: list[Enclosed]
    forces: list[Enclosed]
    motion: JointMotion | None
    exact: ExactMotion | None
    exact_places: list[fmpq_poly] | None

    def rate(self, number: int) -> Enclosed:
        """How fast the gap of an open contact grows."""
        touch = self.joint.touches[number]
        return _together([(fmpq(1), self.velocities[touch.right]), (-touch.ratio, self.velocities[touch.left])])

    def push(self, number: int) -> Enclosed:
        """The force of a closed contact."""
        open_law = self.joint.law
        terms: list[tuple[fmpq, Enclosed]] = []
        for k, factor in self.law.pushes[number]:
            terms.append((-factor, self.forces[k]))
            terms += [(factor * c, q) for c, q in zip(open_law.damping[k], self.velocities, strict=True)]
        total = _together(terms)
        if not open_law.springs:
            return total
        if self.exact_places is not None and total.exact is not None:
            return Enclosed.of(
                total.exact
                + sum(
                    (
                        factor * c * u
                        for k, factor in self.law.pushes[number]
                        for c, u in zip(open_law.stiffness[k], self.exact_places, strict=True)
                    ),
                    fmpq_poly(),
                )
            )
        assert self.motion is not None  # a joint with springs is not without state
        polynomial, error = total.polynomial, total.error
        for k, factor in self.law.pushes[number]:
            for c, places in zip(open_law.stiffness[k], self.motion.places, strict=True):
                if c != 0:
                    polynomial += arb(factor * c) * arb_poly(places)
            error += abs(arb(factor)) * arb(open_law.stiffness[k][k]).sqrt() * self.motion.strained
        return Enclosed(polynomial, error.upper())


@dataclass(frozen=True)
class Drifted:
    """A joint on a short stretch with vague contacts: as `Moved`, and the ranges of rates and forces, while open and
    while closed, under every choice."""

    length: fmpq
    velocities: list[Enclosed]
    sent: list[Enclosed]
    motion: JointMotion
    rates: Mapping[int, arb]
    pushes: Mapping[int, arb]


class TouchingJoint:
    """A joint as time goes on, at the working precision."""

    def __init__(self, network: Network, number: int, loads: Sequence[Applied]) -> None:
        self._joint = joint = network.joints[number]
        place = {point: k for k, point in enumerate(joint.points)}
        self.law = JointLaw.of(network, joint)
        self.touches = {
            n: Touch(place[link.left], place[link.right], link.ratio)
            for n, link in enumerate(network.links)
            if link.contact and link.left in place
        }
        self._laws: dict[Closed, TouchingLaw] = {}
        self._loads = [Acting(network, point, loads) for point in joint.points]
        rule = joint_rule()
        bars = [network.bars[end.bar] for end, _ in joint.ends]
        self._ends = [
            (place[point], bar.ratios[end.side], rule.arrives[1 - end.side] * bar.ratios[end.side] * bar.impedance)
            for bar, (end, point) in zip(bars, joint.ends, strict=True)
        ]
        begun = {k: network.points[point].velocity for k, point in enumerate(joint.points)}
        self._exact: ExactMotion | None = ExactMotion(begun, [fmpq(0)] * len(joint.points))
        self._motion: JointMotion | None = None

    def under(self, closed: Closed) -> TouchingLaw:
        """The law with these contacts closed."""
        if closed not in self._laws:
            self._laws[closed] = TouchingLaw.of(self.law, self.touches, closed)
        return self._laws[closed]

    @property
    def _stateless(self) -> bool:
        return not (self.law.heavy or self.law.springs)

    def take(self, moved: Moved | Drifted) -> None:
        """Go on to the end of a stretch."""
        if not self._stateless:
            self._motion = moved.motion
            self._exact = moved.exact if isinstance(moved, Moved) else None

    def moved(self, arriving: Sequence[Enclosed], start: fmpq, length: fmpq, closed: Closed) -> Moved:
        """Its motion on a stretch on which just these contacts are closed."""
        touching = self.under(closed)
        law = touching.law
        acting = [load.on(start) for load in self._loads]
        forces = self._forces(arriving, acting)
        grouped = [self._on_group(law, forces, a) for a in range(len(law.mass))]
        prescribed = [acting[k] for k in law.leaders]
        if self._exact is not None and all(wave.exact is not None for wave in arriving):
            given = [force.exact for force in grouped if force.exact is not None]
            if (q := self._exact.moved(law, given, prescribed)) is not None:
                return self._exactly(touching, q, arriving, forces, length)
        motion = None
        if self._stateless and len(law.light) == len(law.mass):
            velocities = [
                weighted([(law.inverse[k, j], force) for j, force in enumerate(grouped)]) for k in range(len(law.mass))
            ]
            sent = self._scattered(law, arriving, acting)
        else:
            motion = self._state(law)
            waves = [_shortened(force, length) for force in grouped]
            terms = _terms(law.fastest * length, max(wave.polynomial.length() for wave in waves))
            velocities = motion.moved(waves, prescribed, length, terms)
            sent = self._sent(law, velocities, arriving)
        points = [_scaled(velocities[group], ratio) for group, ratio in law.moves]
        return Moved(self, touching, length, points, sent, forces, motion, None, None)

    def _exactly(
        self,
        touching: TouchingLaw,
        q: Sequence[fmpq_poly],
        arriving: Sequence[Enclosed],
        forces: list[Enclosed],
        length: fmpq,
    ) -> Moved:
        assert self._exact is not None  # or it would not be known exactly
        law = touching.law
        points = [Enclosed.of(ratio * q[group]) for group, ratio in law.moves]
        sent = [
            Enclosed.of(ratio * velocity - wave.exact)
            for (k, ratio, _), wave in zip(self._ends, arriving, strict=True)
            if (velocity := points[k].exact) is not None and wave.exact is not None
        ]
        places = [
            u + point.exact.integral()
            for u, point in zip(self._exact.displacement, points, strict=True)
            if point.exact is not None
        ]
        return Moved(self, touching, length, points, sent, forces, None, self._exact.after(law, q, length), places)

    def drifted(
        self, arriving: Sequence[Enclosed], start: fmpq, length: fmpq, closed: Closed, vague: Closed
    ) -> Drifted:
        """Its motion on a short stretch on which `closed` are closed, and the `vague` ones now and then."""
        law = self.under(closed).law
        acting = [load.on(start) for load in self._loads]
        forces = self._forces([_shortened(wave, length) for wave in arriving], acting)
        span = arb(0).union(arb(length))
        prescribed = {k: _range(Enclosed.of(acting[k]), span) for k, kind in enumerate(self.law.given) if kind}
        bounds = dict.fromkeys(vague, arb(0))
        for _ in range(_ROUNDS):
            motion = self._state(law)
            pushed = self._pushed(forces, bounds)
            waves = [self._on_group(law, pushed, a) for a in range(len(law.mass))]
            terms = _terms(law.fastest * length, max(wave.polynomial.length() for wave in waves))
            found = motion.moved(waves, [acting[k] for k in law.leaders], length, terms)
            known = prescribed | {law.leaders[a]: _range(found[a], span) for a in law.heavy}
            pulls = [_range(force, span) - self._spring(motion, k, span) for k, force in enumerate(forces)]
            velocities, rates, pushes = self._choices(closed, vague, known, pulls)
            largest = {n: pushes[n].upper().max(arb(0)) for n in vague}
            if all(largest[n] < bounds[n] or largest[n] == 0 for n in vague):
                break
            bounds = {n: (largest[n] * arb(1 + _SLACK)).upper() for n in vague}
        else:
            raise ArithmeticError("the force of a contact has no bound")
        points = [Enclosed(arb_poly([v.mid()]), v.rad()) for v in velocities]
        sent = [
            _together([(ratio, points[k]), (fmpq(-1), wave)])
            for (k, ratio, _), wave in zip(self._ends, arriving, strict=True)
        ]
        return Drifted(length, points, sent, motion, rates, pushes)

    def _choices(
        self, closed: Closed, vague: Closed, known: Mapping[int, arb], pulls: Sequence[arb]
    ) -> tuple[list[arb], dict[int, arb], dict[int, arb]]:
        """Velocities, rates and forces, over all choices of closed contacts; `known` are those of rigid points."""
        velocities: list[arb] = []
        rates: dict[int, arb] = {}
        pushes: dict[int, arb] = {}
        for chosen in _subsets(vague):
            touching = self.under(closed | chosen)
            law = touching.law
            right = [
                sum((arb(ratio) * pulls[k] for k, (group, ratio) in enumerate(law.moves) if group == a), arb(0))
                - sum((arb(law.damping[a][b]) * known[law.leaders[b]] for b in self._stiff(law)), arb(0))
                for a in law.light
            ]
            groups = {b: known[law.leaders[b]] for b in self._stiff(law)}
            for row, a in enumerate(law.light):
                groups[a] = sum((arb(law.inverse[row, j]) * value for j, value in enumerate(right)), arb(0))
            here = [arb(ratio) * groups[group] for group, ratio in law.moves]
            velocities = [old.union(new) for old, new in zip(velocities, here, strict=True)] if velocities else here
            for n, touch in self.touches.items():
                if n in touching.pushes:
                    force = arb(0)
                    for k, factor in touching.pushes[n]:
                        drag = sum((arb(c) * q for c, q in zip(self.law.damping[k], here, strict=True)), arb(0))
                        force += arb(factor) * (drag - pulls[k])
                    pushes[n] = pushes[n].union(force) if n in pushes else force
                else:
                    rate = here[touch.right] - arb(touch.ratio) * here[touch.left]
                    rates[n] = rates[n].union(rate) if n in rates else rate
        return velocities, rates, pushes

    def _stiff(self, law: JointLaw) -> list[int]:
        return [a for a in range(len(law.mass)) if a not in law.light]

    def _spring(self, motion: JointMotion, k: int, span: arb) -> arb:
        """What springs pull at a point on a stretch."""
        if not self.law.springs:
            return arb(0)
        row = self.law.stiffness[k]
        pull = sum((arb(c) * arb_poly(motion.places[j])(span) for j, c in enumerate(row) if c != 0), arb(0))
        return pull + arb(0, (arb(row[k]).sqrt() * motion.strained).upper())

    def _pushed(self, forces: Sequence[Enclosed], bounds: Mapping[int, arb]) -> list[Enclosed]:
        """With contacts that push with anything between 0 and their bounds."""
        result = list(forces)
        for n, bound in bounds.items():
            touch = self.touches[n]
            between = Enclosed(arb_poly([bound / 2]), (bound / 2).upper())
            for k, factor in ((touch.right, fmpq(1)), (touch.left, -touch.ratio)):
                result[k] = _together([(fmpq(1), result[k]), (factor, between)])
        return result

    def _state(self, law: JointLaw) -> JointMotion:
        """In balls."""
        if self._motion is not None:
            return self._motion.under(law)
        assert self._exact is not None  # one of them is
        velocity = [arb(self._exact.velocity[leader]) for leader in law.leaders]
        displacement = [arb(u) for u in self._exact.displacement]
        lost = sum((arb(m) * v.rad() ** 2 for m, v in zip(law.mass, velocity, strict=True)), arb(0))
        for a, row in enumerate(self.law.stiffness):
            lost += sum(
                (abs(arb(c)) * displacement[a].rad() * displacement[b].rad() for b, c in enumerate(row)), arb(0)
            )
        unknown = (lost / 2).upper()
        return JointMotion(law, [v.mid() for v in velocity], [u.mid() for u in displacement], unknown)

    def _forces(self, arriving: Sequence[Enclosed], acting: Sequence[fmpq_poly]) -> list[Enclosed]:
        """What acts on each point: loads, and waves that arrive."""
        rule = joint_rule()
        terms: list[list[tuple[fmpq, Enclosed]]] = [[(rule.load, Enclosed.of(p))] for p in acting]
        for (k, _, factor), wave in zip(self._ends, arriving, strict=True):
            terms[k].append((factor, wave))
        return list(map(_together, terms))

    def _on_group(self, law: JointLaw, forces: Sequence[Enclosed], a: int) -> Enclosed:
        return _together(
            [(ratio, force) for (group, ratio), force in zip(law.moves, forces, strict=True) if group == a]
        )

    def _sent(self, law: JointLaw, velocities: Sequence[Enclosed], arriving: Sequence[Enclosed]) -> list[Enclosed]:
        result = []
        for (k, ratio, _), wave in zip(self._ends, arriving, strict=True):
            group, share = law.moves[k]
            result.append(weighted([(ratio * share, velocities[group]), (fmpq(-1), wave)]))
        return result

    def _scattered(self, law: JointLaw, arriving: Sequence[Enclosed], acting: Sequence[fmpq_poly]) -> list[Enclosed]:
        """Where nothing has mass or springs: sums with exact factors, so that an absorbing end sends back exactly 0."""
        result = []
        for number, (k, ratio, _) in enumerate(self._ends):
            group, share = law.moves[k]
            terms = []
            for n, ((j, _, factor), wave) in enumerate(zip(self._ends, arriving, strict=True)):
                other, part = law.moves[j]
                terms.append((ratio * share * law.inverse[group, other] * part * factor - (n == number), wave))
            for j, p in enumerate(acting):
                other, part = law.moves[j]
                terms.append((ratio * share * law.inverse[group, other] * part * joint_rule().load, Enclosed.of(p)))
            result.append(weighted(terms))
        return result


def _subsets(numbers: Iterable[int]) -> Iterator[Closed]:
    every = sorted(numbers)
    return map(frozenset, chain.from_iterable(combinations(every, k) for k in range(len(every) + 1)))


def _range(known: Enclosed, span: arb) -> arb:
    """All values on a stretch."""
    return known.polynomial(span) + arb(0, known.error)


def _together(terms: Sequence[tuple[fmpq, Enclosed]]) -> Enclosed:
    """A sum with exact factors; exact where all of it is."""
    exact = fmpq_poly()
    for factor, known in terms:
        if factor == 0:
            continue
        if known.exact is None:
            return weighted(terms)
        exact += factor * known.exact
    return Enclosed.of(exact)


def _scaled(known: Enclosed, factor: fmpq) -> Enclosed:
    return known if factor == 1 else _together([(factor, known)])


def _shortened(known: Enclosed, length: fmpq) -> Enclosed:
    """Without the powers that count for less on a stretch than the last bit of the others."""
    powers = known.polynomial.coeffs()
    if known.exact is not None or len(powers) < 2:
        return known
    h, sizes, power = arb(length), [], arb(1)
    for c in powers:
        sizes.append((abs(c) * power).upper())
        power *= h
    least = max(sizes) * arb(2) ** (-ctx.prec - 4)
    rest = arb(0)
    while sizes and (more := (rest + sizes[-1]).upper()) <= least:
        rest = more
        sizes.pop()
    return Enclosed(arb_poly(powers[: len(sizes)]), (known.error + rest).upper())


def _terms(swing: fmpq, least: int) -> int:
    """As many terms as a series needs that goes like exp(swing)."""
    x, size, n = float(swing), 0.0, 0
    while x > 0 and size > -ctx.prec - 8:
        n += 1
        size += log2(x / n)
    return max(n, least) + 2
