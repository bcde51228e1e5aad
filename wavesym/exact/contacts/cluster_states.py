"""What is known of the points of a joint at an instant, and of clusters of them: exactly, or in balls.

Where masses stick to each other their velocities agree but for what is not known: that is energy, which they may have.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import arb, fmpq, fmpq_poly

from wavesym.exact.contacts.cluster import Cluster
from wavesym.exact.contacts.joint_springs import JointSprings
from wavesym.exact.contacts.joint_stretch import JointStretch, PointState
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.joints.joint_motion import JointMotion


class ClusterStates:
    """States of the points of a joint; `sets` of these have energy while nothing touches."""

    def __init__(
        self, law: JointLaw, springs: JointSprings, sets: Sequence[Sequence[int]], of_point: Mapping[int, PointState]
    ) -> None:
        self.of_point = dict(of_point)
        self.resting: set[int] = set()  # masses that certainly do not move, held on the ground
        self._law, self._springs, self._sets = law, springs, sets

    def take(self, moved: JointStretch) -> None:
        """Go on to the end of a stretch."""
        self.of_point |= moved.state

    def exact_state(self, cluster: Cluster) -> list[tuple[fmpq, fmpq]] | None:
        """The state of a cluster, where it is known exactly."""
        known = {k: exact for k in cluster.points if (exact := self.of_point[k].exact) is not None}
        if len(known) < len(cluster.points) or not self._springs.are_exact(cluster):
            return None
        together = all(
            known[k][0] == cluster.ratio(k) * known[leader][0]
            for k in cluster.stuck_points
            if cluster.law.motions[cluster.group(k)] is None and (leader := cluster.leader(cluster.group(k))) in known
        )
        return list(known.values()) if together else None

    def balls(self, cluster: Cluster, prescribed: Sequence[fmpq_poly]) -> JointMotion:
        """The state of a cluster; what rounding loses of one that was exact is energy not known."""
        points = cluster.points
        state = [self.of_point[k] for k in points]
        unknown: dict[frozenset[int], arb] = {}  # of sets that moved together it is that of all
        for each in self._sets:
            if each[0] in points:
                known = self.of_point[each[0]]
                among = known.companions or frozenset(each)
                unknown[among] = known.error_energy.max(unknown.get(among, arb(0)))
        velocity, lost = self._joined_velocities(cluster, prescribed)
        displacement = [each.displacement for each in state]
        energy = sum(unknown.values(), arb(0))
        motion = JointMotion(cluster.law, velocity, [each.mid() for each in displacement], energy, decays=True)
        motion.round(velocity, displacement)
        motion.lose(self._springs.energy(cluster))
        motion.lose(lost)
        return motion

    def held_masses(self, cluster: Cluster) -> list[int]:
        """The points with mass in groups of which some stick: what is not known of a group may be in one of them."""
        groups = {cluster.group(k) for k in cluster.stuck_points}
        return [k for k in cluster.points if self._law.mass[k] != 0 and cluster.group(k) in groups]

    def unseen_rates(self, cluster: Cluster, later: Mapping[int, PointState]) -> dict[int, arb]:
        """How fast the points of such groups may be besides: one without mass as fast as some mass of its group.

        What is resting is known. `later` are states at the end of a stretch, where less is known.
        """
        held = [k for k in self.held_masses(cluster) if k not in self.resting]
        rates = {
            k: (2 * later.get(k, self.of_point[k]).error_energy / arb(self._law.mass[k])).sqrt().upper() for k in held
        }
        for k in cluster.points:
            like = [j for j in held if cluster.group(j) == cluster.group(k)]
            if like and k not in held and self._law.motions[k] is None:
                rates[k] = max((rates[j] * arb(abs(cluster.ratio(k) / cluster.ratio(j)))).upper() for j in like)
        return rates

    def _joined_velocities(self, cluster: Cluster, prescribed: Sequence[fmpq_poly]) -> tuple[list[arb], arb]:
        """The velocities of groups, and the energy that masses that stick, with the same momentum, lose by it."""
        law = cluster.law
        velocity, lost = [self.of_point[cluster.leader(a)].velocity for a in range(len(law.mass))], arb(0)
        held = self.held_masses(cluster)
        for a in {cluster.group(k) for k in cluster.stuck_points}:
            among = [(k, arb(cluster.ratio(k)), arb(self._law.mass[k])) for k in held if cluster.group(k) == a]
            if law.motions[a] is not None:
                velocity[a] = arb(prescribed[a](fmpq(0)))
            elif any(self.of_point[k].velocity != ratio * velocity[a] for k, ratio, _ in among):  # else none is rounded
                momentum = sum((ratio * mass * self.of_point[k].velocity for k, ratio, mass in among), arb(0))
                velocity[a] = (momentum / sum((ratio**2 * mass for _, ratio, mass in among), arb(0))).mid()
            apart = ((mass, abs(self.of_point[k].velocity - ratio * velocity[a]).upper()) for k, ratio, mass in among)
            lost += sum((mass * each * each / 2 for mass, each in apart), arb(0)).upper()
        return velocity, lost

    def sticking_state(self, cluster: Cluster, prescribed: Sequence[fmpq_poly], length: fmpq) -> dict[int, PointState]:
        """What sticks, where nothing has a state: how fast it may be yet is energy not known of it."""
        if not cluster.stuck_points:
            return {}
        given = {k: cluster.ratio(k) * prescribed[cluster.group(k)] for k in self.held_masses(cluster)}
        if self.exact_state(cluster) is not None:
            return {
                k: PointState.from_exact(p(length), self.of_point[k].place + p.integral()(length))
                for k, p in given.items()
            }
        unknown = max(self.of_point[k].error_energy for k in cluster.points)
        unknown = ((unknown.sqrt() + self._joined_velocities(cluster, prescribed)[1].sqrt()) ** 2).upper()
        return {k: PointState(arb(p(length)), self.of_point[k].displacement, None, unknown) for k, p in given.items()}

    def state_at_end(
        self, cluster: Cluster, motion: JointMotion, prescribed: Sequence[fmpq_poly], length: fmpq
    ) -> dict[int, PointState]:
        """That of a cluster after a stretch."""
        return (
            self.sticking_state(cluster, prescribed, length) if cluster.stateless else self.state_after(cluster, motion)
        )

    def state_after(self, cluster: Cluster, motion: JointMotion) -> dict[int, PointState]:
        moving = {cluster.leader(a): each for a, each in enumerate(motion.velocity)}
        moving |= {k: (arb(cluster.ratio(k)) * motion.velocity[cluster.group(k)]).mid() for k in cluster.stuck_points}
        among = frozenset(cluster.points)
        return {
            k: PointState(moving.get(k, arb(0)), motion.displacement[n], None, motion.unknown_energy, among)
            for n, k in enumerate(cluster.points)
        }
