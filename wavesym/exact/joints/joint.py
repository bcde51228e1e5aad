"""A joint in motion: its points' velocities on a stretch without fronts, as polynomials with a proved error.

Seen from a joint every rod end is a dashpot and a force, so that with arriving waves a, loads F and displacements u

    M q' + C q + K u = s,    u' = q,    s = sum over ends of 2 n Z a + F,    sent back into an end: n q - a.

Coefficients of powers of w (the time since the start of the stretch) come one after another; points without mass follow
from the others at each power. What is kept are the middles: any error of theirs is in the defect
d = s - (M q' + C q + K u), and with E = (e M e + v K v)/2 for the errors e of q and v of u

    dE/dt = e d - e C e <= sqrt(2 E) delta + rho,

where delta is the size of d on points with mass, rho what points without mass can add. So
sqrt(E(t)) <= sqrt(E(0)) + delta t / sqrt(2) + sqrt(rho t): stiffness does not make errors grow. On a short stretch with
large defects another bound is better: with x = C^-1 d on the points without mass, what they add to dE/dt is at most
v K x <= sqrt(2 E) kappa, kappa = sqrt(x K x), and kappa t / sqrt(2) takes the place of sqrt(rho t).

Contacts that are closed make one `group` of their points, which move with fixed ratios. The defect of a group is the
sum over its points, each times its ratio, and the energy is the same sum over all points: the proof stays as it is,
and what is not known goes on unchanged where a contact opens or closes, as no mass changes its velocity then.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import count, islice
from math import isqrt
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeVar

from flint import arb, arb_poly, fmpq, fmpq_mat, fmpq_poly

from wavesym.derivation.exact_rule import joint_rule
from wavesym.exact.joints.enclosure import Enclosure, Terms, scale_terms, weighted_sum
from wavesym.mechanics.network import End, Joint, Network

if TYPE_CHECKING:
    from wavesym.exact.joints.relaxation import Relaxation

Number = TypeVar("Number", fmpq, arb)
Coefficient = TypeVar("Coefficient", covariant=True)


class Powers(Protocol[Coefficient]):
    """The coefficients of a function, by powers: as many as are read."""

    def __getitem__(self, power: int, /) -> Coefficient: ...


# a series is begun anew where it would have to bear more than exp(this)
SWING = 24


@dataclass(frozen=True)
class JointLaw:
    """M, C and K of a joint's points, in their order; `motions` says which move as prescribed.

    Where contacts are closed rows are those of groups of points, and so are the columns of C; those of K are points.
    `members` has the group of each point and how fast the point moves in it, `leaders` the point that a group moves
    like, and `elastic` the K of all points. They are empty where each point is on its own.
    """

    mass: tuple[fmpq, ...]
    damping: tuple[tuple[fmpq, ...], ...]
    stiffness: tuple[tuple[fmpq, ...], ...]
    motions: tuple[str | None, ...]
    members: tuple[tuple[int, fmpq], ...] = ()
    leaders: tuple[int, ...] = ()
    elastic: tuple[tuple[fmpq, ...], ...] = ()

    @classmethod
    def assemble(cls, network: Network, joint: Joint, acting: Collection[int] | None = None) -> JointLaw:
        """Assembled from points, links and rod ends, each as it is derived.

        Of springs with a corner those `acting` (the numbers of their links) are in it; all of them, where that is None.
        """
        size = len(joint.points)
        place = {point: k for k, point in enumerate(joint.points)}
        points = [network.points[point] for point in joint.points]
        rule = joint_rule()
        damping = [[fmpq(0)] * size for _ in range(size)]
        stiffness = [[fmpq(0)] * size for _ in range(size)]
        for k, point in enumerate(points):
            damping[k][k] += rule.damping * point.damping
            stiffness[k][k] += point.stiffness
        for end, number in joint.ends:
            bar = network.bars[end.bar]
            radiated = rule.radiates[1 - end.side] * bar.ratios[end.side] ** 2 * bar.impedance
            damping[place[number]][place[number]] += radiated
        for n, link in enumerate(network.links):
            if link.left in place:
                a, b = place[link.left], place[link.right]
                idle = acting is not None and link.is_spring_with_corner and n not in acting
                spring = fmpq(0) if idle else link.stiffness
                for matrix, value in ((damping, rule.damping * link.damping), (stiffness, spring)):
                    matrix[a][a] += link.ratio**2 * value
                    matrix[b][b] += value
                    matrix[a][b] -= link.ratio * value
                    matrix[b][a] -= link.ratio * value
        return cls(
            tuple(rule.inertia * point.mass for point in points),
            tuple(map(tuple, damping)),
            tuple(map(tuple, stiffness)),
            tuple(point.motion for point in points),
        )

    def restrict(self, points: Sequence[int]) -> JointLaw:
        """The law of some points that nothing connects with the others."""
        return JointLaw(
            tuple(self.mass[k] for k in points),
            tuple(tuple(self.damping[k][j] for j in points) for k in points),
            tuple(tuple(self.stiffness[k][j] for j in points) for k in points),
            tuple(self.motions[k] for k in points),
        )

    def group(self, members: Sequence[tuple[int, fmpq]], leaders: Sequence[int]) -> JointLaw:
        """The same with points that move as one: the group of each, its ratio, and the point that each moves like."""
        of = [[(k, ratio) for k, (group, ratio) in enumerate(members) if group == a] for a in range(len(leaders))]
        return JointLaw(
            tuple(self.mass[k] for k in leaders),
            tuple(
                tuple(sum((x * y * self.damping[k][j] for k, x in row for j, y in column), fmpq(0)) for column in of)
                for row in of
            ),
            tuple(
                tuple(sum((x * self.stiffness[k][j] for k, x in row), fmpq(0)) for j in range(len(members)))
                for row in of
            ),
            tuple(self.motions[k] for k in leaders),
            tuple(members),
            tuple(leaders),
            self.stiffness,
        )

    @cached_property
    def moves(self) -> tuple[tuple[int, fmpq], ...]:
        """The group of each point, and how fast the point moves in it."""
        return self.members or tuple((k, fmpq(1)) for k in range(len(self.mass)))

    @cached_property
    def group_stiffness(self) -> tuple[tuple[fmpq, ...], ...]:
        """K with groups as columns too."""
        if not self.members:
            return self.stiffness
        groups = range(len(self.mass))
        return tuple(
            tuple(
                sum((ratio * c for c, (group, ratio) in zip(row, self.members, strict=True) if group == b), fmpq(0))
                for b in groups
            )
            for row in self.stiffness
        )

    @cached_property
    def heavy(self) -> tuple[int, ...]:
        """Points with mass that are free to move."""
        return tuple(k for k, mass in enumerate(self.mass) if mass != 0 and self.motions[k] is None)

    @cached_property
    def light(self) -> tuple[int, ...]:
        """Points without mass that are free to move."""
        return tuple(k for k, mass in enumerate(self.mass) if mass == 0 and self.motions[k] is None)

    @cached_property
    def springs(self) -> bool:
        """Whether displacements matter."""
        return any(value != 0 for row in self.stiffness for value in row)

    @cached_property
    def fastest(self) -> fmpq:
        """A rate that no motion of the joint exceeds by much: what its series must bear."""
        rates = [fmpq(0)]
        for k, mass in enumerate(self.mass):
            if self.motions[k] is None:
                stiff = sum(map(abs, self.stiffness[k]), fmpq(0))
                rates.append(
                    sum(map(abs, self.damping[k]), fmpq(0)) / mass + isqrt(int((stiff / mass).ceil()))
                    if mass != 0
                    else stiff / self.damping[k][k]
                )
        return max(rates)

    @cached_property
    def longest(self) -> fmpq | None:
        """How long a stretch may be for the sake of springs; None where there are none."""
        return SWING / self.fastest if self.springs and self.fastest != 0 else None

    @cached_property
    def inverse(self) -> fmpq_mat:
        """The inverse of C on the points without mass. ZeroDivisionError where one has neither rod nor dashpot."""
        size = len(self.light)
        return fmpq_mat(size, size, [self.damping[a][b] for a in self.light for b in self.light]).inv()

    @cached_property
    def absorption(self) -> dict[int, fmpq]:
        """What takes energy from each point with mass, at least: c_k of q'S q >= sum of c_k q_k^2, where positive.

        S is C on those points, less what points without mass take of it as they follow: its Schur complement.
        """
        schur = {a: {b: self.damping[a][b] for b in self.heavy} for a in self.heavy}
        for a, row in schur.items():
            for b in row:
                for n, x in enumerate(self.light):
                    for m, y in enumerate(self.light):
                        row[b] -= self.damping[a][x] * self.inverse[n, m] * self.damping[y][b]
        least = {a: 2 * row[a] - sum(map(abs, row.values()), fmpq(0)) for a, row in schur.items()}
        return {a: c for a, c in least.items() if c > 0}


class JointEnd(NamedTuple):
    """The end of a bar at a joint, and the place of its point there.

    The end moves `ratio` n times as fast as the point; on that acts the `force` 2 n Z of a wave 1 that arrives.
    """

    end: End
    place: int
    ratio: fmpq
    force: fmpq


def joint_ends(network: Network, joint: Joint) -> tuple[JointEnd, ...]:
    """The ends of bars at a joint, in its order."""
    rule, place = joint_rule(), {point: k for k, point in enumerate(joint.points)}
    found = []
    for end, point in joint.ends:
        bar, ratio = network.bars[end.bar], network.bars[end.bar].ratios[end.side]
        found.append(JointEnd(end, place[point], ratio, rule.arrives[1 - end.side] * ratio * bar.impedance))
    return tuple(found)


def forces_on(ends: Sequence[JointEnd], arriving: Sequence[Enclosure], loads: Sequence[fmpq_poly]) -> list[Terms]:
    """What acts on each point of a joint: loads, and the waves that arrive."""
    load = joint_rule().load
    forces: list[Terms] = [[(load, Enclosure.from_polynomial(each))] if each.length() else [] for each in loads]
    for each, wave in zip(ends, arriving, strict=True):
        forces[each.place].append((each.force, wave))
    return forces


def outgoing_terms(end: JointEnd, velocity: Terms, wave: Enclosure) -> Terms:
    """What an end sends when a wave arrives: n q - a."""
    return [*scale_terms(velocity, end.ratio), (fmpq(-1), wave)]


def scatter(law: JointLaw, forces: Sequence[Terms], known: Mapping[int, Terms]) -> list[Terms]:
    """The velocities of groups: of those without mass they follow from what acts and from the others, `known`."""
    q = [known.get(a, []) for a in range(len(law.mass))]
    for row, a in enumerate(law.light):
        for column, b in enumerate(law.light):
            share = law.inverse[row, column]
            q[a] = [*q[a], *scale_terms(forces[b], share)]
            for c, velocity in known.items():
                q[a] += scale_terms(velocity, -share * law.damping[b][c])
    return q


@dataclass
class JointMotion:
    """A joint as time goes on: where its points are and how fast, and the energy of what is not known of that.

    Velocities are those of groups. `places` are the coefficients of the points' displacements on the last stretch;
    what springs make of these is off by at most sqrt(K_kk) `spring_error` at point k. Where it `decays`, the error of a
    body alone is taken to decay as the body does, which matters only where signs of what is left are asked for.
    """

    law: JointLaw
    velocity: list[arb]
    displacement: list[arb]
    unknown_energy: arb = field(default_factory=lambda: arb(0))
    places: list[list[arb]] = field(default_factory=list)
    spring_error: arb = field(default_factory=lambda: arb(0))
    decays: bool = False

    def move(
        self, forces: Sequence[Enclosure], prescribed: Sequence[fmpq_poly], length: fmpq, terms: int
    ) -> list[Enclosure]:
        """The velocities of the points on a stretch, in so many terms; afterwards the joint is at its end.

        `prescribed` are the velocities of the points whose motion is given, exact.
        """
        return self.follow(*self._series(forces, prescribed, terms), forces, length)

    def follow(
        self, q: list[list[arb]], u: list[list[arb]], forces: Sequence[Enclosure], length: fmpq
    ) -> list[Enclosure]:
        """The same along any series of the velocities of groups and the displacements of points, its integrals.

        How far it begins from where the joint is has to be among `unknown_energy`.
        """
        errors = self._errors(forces, q, u, length)
        result = [Enclosure(arb_poly(c), e) for c, e in zip(q, errors, strict=True)]
        self.places, h = u, arb(length)
        self.round([arb_poly(c)(h) for c in q], [arb_poly(c)(h) for c in u] if self.law.springs else [])
        return result

    def accelerations(
        self,
        forces: Sequence[Enclosure],
        rates: Sequence[Enclosure],
        velocities: Sequence[Enclosure],
        prescribed: Sequence[fmpq_poly],
    ) -> list[Enclosure]:
        """The derivatives of the `velocities` that `move` found for the last stretch.

        Args:
            forces: s on the points, and `rates`, its derivatives; on points with mass s alone matters.
            rates: M q' = s - C q - K u of points with mass, C q' = s' - K q of those without.
            velocities: q, as `move` gave it.
            prescribed: the velocities of the points whose motion is given.
        """
        law = self.law
        found = {
            k: Enclosure.from_polynomial(each.derivative())
            for k, each in enumerate(prescribed)
            if law.motions[k] is not None
        }
        for k in law.heavy:
            share = 1 / law.mass[k]
            slow = [(-share * c, velocities[b]) for b, c in enumerate(law.damping[k])]
            places = self.places if law.springs else [[]] * len(law.mass)
            sprung = [
                (-share * c, Enclosure(arb_poly(u), arb(0))) for c, u in zip(law.stiffness[k], places, strict=True)
            ]
            total = weighted_sum([(share, forces[k]), *slow, *sprung])
            strained = arb(share) * arb(law.stiffness[k][k]).sqrt() * self.spring_error
            found[k] = replace(total, error=(total.error + strained).upper())
        right = [
            weighted_sum(
                [
                    (fmpq(1), rates[k]),
                    *((-law.damping[k][b], each) for b, each in found.items()),
                    *((-c, velocities[b]) for b, c in enumerate(law.stiffness[k])),
                ]
            )
            for k in law.light
        ]
        for row, k in enumerate(law.light):
            found[k] = weighted_sum([(law.inverse[row, n], each) for n, each in enumerate(right)])
        return [found[k] for k in range(len(law.mass))]

    def relax(
        self, relaxation: Relaxation, forces: Sequence[Enclosure], prescribed: Sequence[fmpq_poly], terms: int
    ) -> tuple[list[list[arb]], list[list[arb]], arb]:
        """The series without what decays fast, as `follow` takes it, and the energy of what it leaves out."""
        velocities, places = relaxation.series(
            self.velocity, self.displacement, *self._inputs(forces, prescribed, terms), terms
        )
        u = [[place] for place in places]
        if self.law.springs:
            for series, (group, ratio) in zip(u, self.law.moves, strict=True):
                series += [(arb(ratio) * c / n).mid() for n, c in enumerate(velocities[group], 1)]
        missed = self.energy(
            [now - series[0] for now, series in zip(self.velocity, velocities, strict=True)],
            [now - place for now, place in zip(self.displacement, places, strict=True)],
        )
        return velocities, u, missed

    def energy(self, velocity: Sequence[arb], displacement: Sequence[arb]) -> arb:
        """An upper bound of the energy that velocities of groups and displacements of points have."""
        law = self.law
        twice = sum((arb(law.mass[k]) * velocity[k] * velocity[k] for k in law.heavy), arb(0))
        if law.springs:
            for u, row in zip(displacement, law.elastic or law.stiffness, strict=True):
                twice += sum((arb(c) * u * other for c, other in zip(row, displacement, strict=True) if c != 0), arb(0))
        return (twice / 2).upper().max(arb(0))

    def lose(self, energy: arb) -> None:
        """Know less of the joint, by so much energy."""
        root = self.unknown_energy.sqrt() + energy.sqrt()
        self.unknown_energy = (root * root).upper()

    def round(self, velocity: Sequence[arb], displacement: Sequence[arb]) -> None:
        """Go on from the middles of balls; what rounding loses there is energy not known."""
        self.velocity = [each.mid() for each in velocity]
        if self.law.springs:
            self.displacement = [each.mid() for each in displacement]
        around = [[each - each.mid() for each in balls] for balls in (velocity, displacement)]
        self.lose(self.energy(*around))

    def _series(
        self, forces: Sequence[Enclosure], prescribed: Sequence[fmpq_poly], terms: int
    ) -> tuple[list[list[arb]], list[list[arb]]]:
        """The coefficients of q and u: middles, whatever rounding made of them."""
        acting, given = self._inputs(forces, prescribed, terms)
        *_, (q, u, _) = islice(
            motion_series(self.law, self.velocity, self.displacement, acting, given, arb, arb.mid), terms + 1
        )
        return q, u

    @staticmethod
    def _inputs(
        forces: Sequence[Enclosure], prescribed: Sequence[fmpq_poly], terms: int
    ) -> tuple[list[arb_poly], list[arb_poly]]:
        """The middles of forces, in so many terms, and prescribed velocities."""
        acting = [arb_poly([c.mid() for c in force.polynomial.coeffs()[:terms]]) for force in forces]
        return acting, [arb_poly([arb(c) for c in each.coeffs()]) for each in prescribed]

    def _errors(self, forces: Sequence[Enclosure], q: list[list[arb]], u: list[list[arb]], length: fmpq) -> list[arb]:
        """What the velocities may be off by, at most, on the stretch; and the energy of it at the end."""
        law = self.law
        h = arb(length)
        defect = {}
        for k in (*law.heavy, *law.light):
            left = sum((arb(c) * arb_poly(q[b]) for b, c in enumerate(law.damping[k]) if c != 0), arb_poly())
            left += sum((arb(c) * arb_poly(u[b]) for b, c in enumerate(law.stiffness[k]) if c != 0), arb_poly())
            if law.mass[k] != 0:
                left += arb(law.mass[k]) * arb_poly(q[k]).derivative()
            defect[k] = (_size(forces[k].polynomial - left, h) + forces[k].error).upper()
        inverse = [[abs(arb(law.inverse[a, b])) for b in range(len(law.light))] for a in range(len(law.light))]
        light = [defect[k] for k in law.light]
        through = [_dot(row, light) for row in inverse]
        delta, absorbed, kept = arb(0), arb(0), arb(0)  # kept and absorbed: the same, where points are slowed down
        for k in law.heavy:
            more = sum((abs(arb(law.damping[k][b])) * t for b, t in zip(law.light, through, strict=True)), arb(0))
            square = (defect[k] + more) ** 2
            delta += square / arb(law.mass[k])
            if k in law.absorption:
                absorbed += square / (4 * arb(law.absorption[k]))
            else:
                kept += square / arb(law.mass[k])
        rho = _dot(light, through) / 4 if light else arb(0)
        before = (2 * self.unknown_energy / arb(law.mass[law.heavy[0]])).sqrt() if law.heavy else arb(0)
        kappa = sum(
            (
                abs(arb(law.group_stiffness[a][b])) * one * other
                for a, one in zip(law.light, through, strict=True)
                for b, other in zip(law.light, through, strict=True)
                if law.group_stiffness[a][b] != 0
            ),
            arb(0),
        ).sqrt()
        added = (rho * h).sqrt().min(kappa * h / arb(2).sqrt())
        # the energy E grows as E' <= sum of d_k |q_k| - c_k q_k^2 <= sum of d_k^2/(4 c_k) + sqrt(2 E sum of d_k^2/M_k)
        slowed = (self.unknown_energy + absorbed * h).sqrt() + kept.sqrt() * h / arb(2).sqrt()
        root = ((self.unknown_energy.sqrt() + delta.sqrt() * h / arb(2).sqrt()).min(slowed) + added).upper()
        self.unknown_energy = (root * root).upper()
        self.spring_error = speed = (root * arb(2).sqrt()).upper()
        errors = {k: (speed / arb(law.mass[k]).sqrt()).upper() for k in law.heavy}
        if len(law.mass) == 1 and law.heavy and not law.springs and law.damping[0][0] != 0:
            (k,) = law.heavy  # a body alone comes to rest
            held = defect[k] / arb(law.damping[k][k])
            errors[k] = errors[k].min((before + held).upper())
            after = errors[k]
            if self.decays:
                after = after.min((before * (-arb(law.damping[k][k]) * h / arb(law.mass[k])).exp() + held).upper())
            self.unknown_energy = (arb(law.mass[k]) * after**2 / 2).upper()
        right = []
        for k in law.light:
            value = defect[k] + speed * arb(law.group_stiffness[k][k]).sqrt()
            value += sum((abs(arb(law.damping[k][b])) * e for b, e in errors.items()), arb(0))
            right.append(value)
        for row, k in enumerate(law.light):
            errors[k] = _dot(inverse[row], right).upper()
        return [errors.get(k, arb(0)) for k in range(len(law.mass))]


def motion_series(
    law: JointLaw,
    velocity: Sequence[Number],
    displacement: Sequence[Number],
    forces: Sequence[Powers[Number]],
    prescribed: Sequence[Powers[Number]],
    number: Callable[[fmpq], Number],
    kept: Callable[[Number], Number],
) -> Iterator[tuple[list[list[Number]], list[list[Number]], Mapping[int, Number]]]:
    """The motion of a joint in powers of the time since some instant, from M q' + C q + K u = s and u' = q.

    Args:
        law: M, C and K.
        velocity: of groups, at that instant.
        displacement: of points, at that instant.
        forces: s on groups, by powers.
        prescribed: velocities of the groups whose motion is given, by powers.
        number: makes one of the arithmetic: exact, or a ball.
        kept: what is kept of a coefficient: all of it, or its middle.

    Yields:
        For n = 0, 1, ... the first n coefficients of q and, where there are springs, n + 1 of u; of groups with mass
        the next one of q. Lists are those of before, and longer.
    """
    size = range(len(law.mass))
    q: list[list[Number]] = [[] for _ in size]
    u = [[value] for value in displacement]

    def pulls(k: int, without: Collection[int] = ()) -> list[tuple[Number, list[Number]]]:
        """What else acts on a point: factors of velocities, but of some, and of displacements."""
        slow = [(number(c), q[b]) for b, c in enumerate(law.damping[k]) if c != 0 and b not in without]
        return slow + [(number(c), u[b]) for b, c in enumerate(law.stiffness[k]) if c != 0]

    given = [(q[k], prescribed[k]) for k in size if law.motions[k] is not None]
    light = [(forces[k], pulls(k, law.light)) for k in law.light]
    found = [(q[k], [number(law.inverse[row, b]) for b in range(len(light))]) for row, k in enumerate(law.light)]
    heavy = [(k, q[k], forces[k], pulls(k), number(law.mass[k])) for k in law.heavy]
    last = {k: velocity[k] for k in law.heavy}
    moves = [(u[k], q[group], number(ratio)) for k, (group, ratio) in enumerate(law.moves)] if law.springs else []
    for n in count():
        yield q, u, last
        for series, known in given:
            series.append(known[n])
        for k, series, *_ in heavy:
            series.append(last[k])
        right = [_subtract_pulls(force[n], pulled, n) for force, pulled in light]
        for series, shares in found:
            series.append(kept(_dot(shares, right)))
        for k, _, force, pulled, mass in heavy:
            last[k] = kept(_subtract_pulls(force[n], pulled, n) / (mass * (n + 1)))
        for places, series, ratio in moves:
            places.append(kept(ratio * series[n] / (n + 1)))


def _size(polynomial: arb_poly, h: arb) -> arb:
    """The largest value on [0, h], at most."""
    total, power = arb(0), arb(1)
    for c in polynomial.coeffs():
        total += abs(c) * power
        power *= h
    return total.upper()


def _dot(one: Sequence[Number], other: Sequence[Number]) -> Number:
    """A sum of products of at least one pair."""
    total = one[0] * other[0]
    for a, b in zip(one[1:], other[1:], strict=True):
        total += a * b
    return total


def _subtract_pulls(value: Number, pulls: Sequence[tuple[Number, Sequence[Number]]], n: int) -> Number:
    """A power of a force without what pulls."""
    for factor, series in pulls:
        value -= factor * series[n]
    return value
