"""A cluster of a joint on a stretch of time: where it begins, what acts on it, and the forces that hold it together.

Where masses stick to each other their velocities agree but for what is not known: that is energy, which they may have.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.contacts.cluster import Cluster, PointState
from wavesym.exact.contacts.joint_state import JointState
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.contacts.springs import CornerSpring
from wavesym.exact.joints.enclosure import STILL, Enclosure, Onset, Terms, add_terms, combine
from wavesym.exact.joints.joint_motion import JointMotion

ONE = fmpq(1)


class ClusterMotion:
    """A cluster on a stretch, under `forces` on the points of its joint; what moves as is given moves as is `acting`.

    Its velocities, forces and state at the end become part of the `result`; `places` are the displacements of its
    points meanwhile, exact or in balls, where they matter.
    """

    def __init__(
        self,
        joint: JointState,
        cluster: Cluster,
        result: JointStretch,
        forces: Sequence[Terms],
        acting: Sequence[fmpq_poly],
    ) -> None:
        self.joint, self.cluster, self.result = joint, cluster, result
        self.law, self.points, self.length = cluster.law, cluster.points, result.length
        self.span = result.span
        self.forces, self.acting = forces, acting
        self.prescribed = [acting[k] for k in cluster.leaders]
        self.given: dict[int, Terms] = {
            a: [(ONE, Enclosure.from_polynomial(each))]
            for a, each in enumerate(self.prescribed)
            if self.law.motions[a] is not None
        }
        self.places: Mapping[int, fmpq_poly] | JointMotion | None = None

    # the start

    @cached_property
    def exact(self) -> Sequence[tuple[fmpq, fmpq]] | None:
        """The velocities and displacements of its points at the start, where they are known exactly."""
        known = {k: exact for k in self.points if (exact := self.joint.points[k].exact) is not None}
        if len(known) < len(self.points) or not self.joint.springs.are_exact(self.cluster):
            return None
        together = all(
            known[k][0] == self.cluster.ratio(k) * known[self.cluster.leader(k)][0]
            for k in self.cluster.stuck_points
            if self.law.motions[self.cluster.group(k)] is None
        )
        return list(known.values()) if together else None

    def begin(self) -> JointMotion:
        """Its motion in balls, at the start; what rounding loses of what was exact is energy not known."""
        unknown: dict[frozenset[int], arb] = {}  # of sets that moved together it is that of all
        for each in self.joint.sets:
            if each[0] in self.points:
                known = self.joint.points[each[0]]
                among = known.companions or frozenset(each)
                unknown[among] = known.error_energy.max(unknown.get(among, arb(0)))
        velocity, lost = self._joined_velocities
        displacement = [self.joint.points[k].displacement for k in self.points]
        energy = sum(unknown.values(), arb(0))
        motion = JointMotion(self.law, velocity, [each.mid() for each in displacement], energy, decays=True)
        motion.round(velocity, displacement)
        motion.lose(self.joint.springs.energy(self.cluster))
        motion.lose(lost)
        return motion

    @cached_property
    def _joined_velocities(self) -> tuple[list[arb], arb]:
        """The velocities of groups, and the energy that masses that stick, with the same momentum, lose by it."""
        law, points = self.joint.law, self.joint.points
        velocity, lost = [points[k].velocity for k in self.cluster.leaders], arb(0)
        for a in {self.cluster.group(k) for k in self.cluster.stuck_points}:
            among = [
                (points[k].velocity, arb(self.cluster.ratio(k)), arb(law.mass[k]))
                for k in self.held_masses
                if self.cluster.group(k) == a
            ]
            if self.law.motions[a] is not None:
                velocity[a] = arb(self.prescribed[a](fmpq(0)))
            elif any(q != ratio * velocity[a] for q, ratio, _ in among):  # else none is rounded
                momentum = sum((ratio * mass * q for q, ratio, mass in among), arb(0))
                velocity[a] = (momentum / sum((ratio**2 * mass for _, ratio, mass in among), arb(0))).mid()
            apart = ((mass, abs(q - ratio * velocity[a]).upper()) for q, ratio, mass in among)
            lost += sum((mass * each * each / 2 for mass, each in apart), arb(0)).upper()
        return velocity, lost

    @cached_property
    def held_masses(self) -> Sequence[int]:
        """The points with mass in groups of which some stick: what is not known of a group may be in one of them."""
        groups = {self.cluster.group(k) for k in self.cluster.stuck_points}
        return [k for k in self.points if self.joint.law.mass[k] != 0 and self.cluster.group(k) in groups]

    # on the way

    def unseen_rates(self, later: Mapping[int, PointState]) -> dict[int, arb]:
        """How fast the points of such groups may be besides: one without mass as fast as some mass of its group.

        What is resting is known. `later` are states at the end of a stretch, where less is known.
        """
        joint, cluster = self.joint, self.cluster
        held = [k for k in self.held_masses if k not in joint.resting]
        rates = {k: joint.speed(k, later.get(k, joint.points[k]).error_energy) for k in held}
        for k in self.points:
            like = [j for j in held if cluster.group(j) == cluster.group(k)]
            if like and k not in held and joint.law.motions[k] is None:
                rates[k] = max((rates[j] * arb(abs(cluster.ratio(k) / cluster.ratio(j)))).upper() for j in like)
        return rates

    def holding_forces(self, onsets: Mapping[int, Onset] = MappingProxyType({})) -> dict[int, Enclosure]:
        """The forces of closed contacts; and what would hold friction with a larger limit at rest, beyond what acts.

        The displacements of some points are known to begin so.
        """
        joint, cluster, found = self.joint, self.cluster, {}
        for n, push in cluster.pushes.items():
            moving = self.acting[cluster.leader(joint.touches[n].right)]
            found[n] = self._holding_force(push, cluster.inertia.get(n, fmpq(0)), moving, onsets)
        for n, touch in joint.touches.items():
            if touch.breakaway != 0 and n not in cluster.pushes:
                k, factor, other, ratio = joint.free_side(n)
                if k in self.points:
                    inertia = factor * ratio * joint.law.mass[k]
                    found[n] = self._holding_force([(k, factor)], inertia, self.acting[other], onsets)
        return found

    def _holding_force(
        self, push: Sequence[tuple[int, fmpq]], inertia: fmpq, moving: fmpq_poly, onsets: Mapping[int, Onset]
    ) -> Enclosure:
        """One, with what gives a mass the acceleration of what it sticks to."""
        pull = self.cluster.pull(push, self.result.velocities, self.forces)
        pull.append((inertia, Enclosure.from_polynomial(moving.derivative())))
        springs = [(factor, self.spring_pull(k, onsets)) for k, factor in push]
        return add_terms([(ONE, add_terms(pull)), *(each for each in springs if each[1] is not STILL)])

    def spring_pull(self, k: int, onsets: Mapping[int, Onset] = MappingProxyType({})) -> Enclosure:
        """What springs pull at a point; the displacements of some points are known to begin so."""
        if self.places is None or not self.joint.law.is_elastic(k):
            return STILL
        stiffness = self.cluster.joint_law.stiffness[k]
        if not isinstance(self.places, JointMotion):
            return Enclosure.from_polynomial(
                sum((stiffness[j] * place for j, place in self.places.items()), fmpq_poly())
            )
        polynomial = arb_poly()
        for j, series in zip(self.points, self.places.places, strict=True):
            polynomial += arb(stiffness[j]) * arb_poly(series)
        pulled = [j for j in self.points if stiffness[j] != 0]
        begins = combine([(stiffness[j], onsets[j]) for j in pulled]) if all(j in onsets for j in pulled) else None
        return Enclosure(polynomial, (arb(stiffness[k]).sqrt() * self.places.spring_error).upper(), onset=begins)

    def strain(self) -> None:
        """How springs with a corner get longer; and what all springs pull, where dashpots act with some."""
        springs = self.joint.springs
        springs.strain(self.result, {n: self._extension(springs.of_link[n]) for n in self.cluster.springs})
        if springs.may_idle:
            self.result.elastic |= {k: self.spring_pull(k) for k in self.points}

    def _extension(self, spring: CornerSpring) -> Enclosure:
        """How far apart the points are of a spring that acts, beyond what they were at tau = 0."""
        places = self.places
        assert places is not None
        if not isinstance(places, JointMotion):
            return Enclosure.from_polynomial(places[spring.right] - spring.ratio * places[spring.left])
        left, right = (arb_poly(places.places[self.points.index(k)]) for k in spring.sides)
        return Enclosure(right - arb(spring.ratio) * left, (places.spring_error / arb(spring.stiffness).sqrt()).upper())

    # the end

    def sticking_state(self) -> dict[int, PointState]:
        """What sticks, where nothing has a state: how fast it may be yet is energy not known of it."""
        if not self.cluster.stuck_points:
            return {}
        points, length = self.joint.points, self.length
        given = {k: self.cluster.ratio(k) * self.prescribed[self.cluster.group(k)] for k in self.held_masses}
        if self.exact is not None:
            return {
                k: PointState.from_exact(p(length), points[k].place + p.integral()(length)) for k, p in given.items()
            }
        unknown = max(points[k].error_energy for k in self.points)
        unknown = ((unknown.sqrt() + self._joined_velocities[1].sqrt()) ** 2).upper()
        return {k: PointState(arb(p(length)), points[k].displacement, None, unknown) for k, p in given.items()}

    def state_after(self, motion: JointMotion) -> dict[int, PointState]:
        """That of its points, from where its motion in balls has come to."""
        moving = dict(zip(self.cluster.leaders, motion.velocity, strict=True))
        for k in self.cluster.stuck_points:
            moving[k] = (arb(self.cluster.ratio(k)) * motion.velocity[self.cluster.group(k)]).mid()
        among = frozenset(self.points)
        return {
            k: PointState(moving.get(k, arb(0)), motion.displacement[n], None, motion.unknown_energy, among)
            for n, k in enumerate(self.points)
        }

    def lose(self, root: arb, states: Mapping[int, PointState]) -> dict[int, PointState]:
        """The same with what is not known of its points more by an energy, of which this is the root."""
        return {k: states.get(k, self.joint.points[k]).lose(root**2) for k in self.points}
