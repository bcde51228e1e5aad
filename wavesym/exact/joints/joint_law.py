"""The law of a joint in numbers: M, C and K of its points, and what its ends do.

Seen from a joint every rod end is a dashpot and a force, so that with arriving waves a, loads F and displacements u

    M q' + C q + K u = s,    u' = q,    s = sum over ends of 2 n Z a + F,    sent back into an end: n q - a.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isqrt
from typing import NamedTuple, TypeVar

from flint import arb, fmpq, fmpq_mat, fmpq_poly

from wavesym.derivation.factors import joint_rule
from wavesym.exact.joints.enclosure import Enclosure, Terms, scale_terms
from wavesym.mechanics.network import End, Joint, Network

Part = TypeVar("Part")
"""A force or a velocity: a number, a bound, a function, or a row of what it is made of."""

# a series is begun anew where it would have to bear more than exp(this)
SWING = 24


@dataclass(frozen=True)
class JointLaw:
    """M, C and K of a joint's points, in their order; `motions` says which move as prescribed.

    Where contacts are closed rows are those of groups of points, and so are the columns of C; those of K are points.
    `members` has the group of each point and how fast the point moves in it, `leaders` the point that a group moves
    like, and `elastic` the K of all points. They are empty where each point is on its own. Where it `rubs` friction
    holds masses of one group together, as far as is known.
    """

    mass: tuple[fmpq, ...]
    damping: tuple[tuple[fmpq, ...], ...]
    stiffness: tuple[tuple[fmpq, ...], ...]
    motions: tuple[str | None, ...]
    members: tuple[tuple[int, fmpq], ...] = ()
    leaders: tuple[int, ...] = ()
    elastic: tuple[tuple[fmpq, ...], ...] = ()
    rubs: bool = False

    @classmethod
    def assemble(cls, network: Network, joint: Joint, acting: Collection[int] | None = None) -> JointLaw:
        """Assembled from points, links and rod ends, each as it is derived.

        Of springs with a corner those `acting` (the numbers of their links) are in it, with the dashpots that act with
        them; all of them, where that is None.
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
                dashpot = link.steady_damping if idle else link.damping
                for matrix, value in ((damping, rule.damping * dashpot), (stiffness, spring)):
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

    def is_elastic(self, k: int) -> bool:
        """Whether springs act on a point."""
        return any(c != 0 for c in self.stiffness[k])

    def group(self, points: Sequence[int], members: Mapping[int, tuple[int, fmpq]], leaders: Sequence[int]) -> JointLaw:
        """The law of some points that nothing connects with the others, where they move in groups.

        Args:
            points: which of these points.
            members: the group of each, and how fast it moves in it.
            leaders: the points that groups move like.
        """
        of = [[(k, members[k][1]) for k in points if members[k][0] == a] for a in range(len(leaders))]
        return JointLaw(
            tuple(sum((x * x * self.mass[k] for k, x in row), fmpq(0)) for row in of),
            tuple(
                tuple(sum((x * y * self.damping[k][j] for k, x in row for j, y in column), fmpq(0)) for column in of)
                for row in of
            ),
            tuple(tuple(sum((x * self.stiffness[k][j] for k, x in row), fmpq(0)) for j in points) for row in of),
            tuple(self.motions[k] for k in leaders),
            tuple(members[k] for k in points),
            tuple(points.index(k) for k in leaders),
            tuple(tuple(self.stiffness[k][j] for j in points) for k in points),
            any(sum(self.mass[k] != 0 for k, _ in row) > 1 for row in of),
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
    def inverse(self) -> Mapping[tuple[int, int], fmpq]:
        """The inverse of C on the points without mass, its numbers functions if those of C are.

        ZeroDivisionError where a point has neither rod nor dashpot. As no dashpot gives energy, no pivot is 0 else.
        """
        size = len(self.light)
        damping = [self.damping[a][b] for a in self.light for b in self.light]
        if all(isinstance(number, fmpq) for number in damping):  # FLINT is up to 20 times as fast
            inverse = fmpq_mat(size, size, damping).inv()
            return {(n, m): inverse[n, m] for n in range(size) for m in range(size)}
        rows = [
            [*(self.damping[a][b] for b in self.light), *(fmpq(int(n == k)) for n in range(size))]
            for k, a in enumerate(self.light)
        ]
        for k, pivot in enumerate(rows):
            scale = 1 / pivot[k]
            pivot[:] = [scale * value for value in pivot]
            for row in rows:
                if row is not pivot and row[k] != 0:
                    row[:] = [a - row[k] * b for a, b in zip(row, pivot, strict=True)]
        return {(n, m): rows[n][size + m] for n in range(size) for m in range(size)}

    def light_velocities(
        self,
        forces: Mapping[int, Part] | Sequence[Part],
        known: Mapping[int, Part],
        add: Callable[[Sequence[tuple[fmpq, Part]]], Part],
    ) -> dict[int, Part]:
        """The velocities of points without mass, which the balance C q = s of forces on them gives.

        Args:
            forces: s on each of these points, less what springs pull.
            known: the velocities of other points; what is not in it stands still.
            add: a sum of parts, each times a factor. One of absolute values makes bounds of bounds.
        """
        acting = [
            add([(fmpq(1), forces[k]), *((-self.damping[k][other], q) for other, q in known.items())])
            for k in self.light
        ]
        return {
            k: add([(self.inverse[row, n], each) for n, each in enumerate(acting)]) for row, k in enumerate(self.light)
        }

    @cached_property
    def absorption(self) -> dict[int, fmpq]:
        """What takes energy from each point with mass, at least: c_k of q'S q >= sum of c_k q_k^2, where positive.

        S is C on those points, less what points without mass take of it as they follow: its Schur complement. Where it
        `rubs` there is none: each mass may go another way.
        """
        if self.rubs:
            return {}
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
    q = {**known, **law.light_velocities(forces, known, _join_terms)}
    return [q.get(a, []) for a in range(len(law.mass))]


def _join_terms(parts: Sequence[tuple[fmpq, Terms]]) -> Terms:
    """A sum of sums, each times a factor."""
    return [term for factor, terms in parts for term in scale_terms(terms, factor)]


def exact_sum(parts: Sequence[tuple[fmpq, fmpq]]) -> fmpq:
    """A sum of numbers, each times a factor."""
    return sum((factor * number for factor, number in parts), fmpq(0))


def bound_sum(parts: Sequence[tuple[fmpq, arb]]) -> arb:
    """What a sum is at most whose parts, each times a factor, are bounded; infinite ones where their factor is 0."""
    return sum((abs(arb(factor)) * bound for factor, bound in parts if factor != 0), arb(0))
