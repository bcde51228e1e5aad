"""The forces that hold a joint together: of closed contacts, of what sticks, and of springs at its points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.contacts.cluster import Cluster, Touch
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.joints.enclosure import STILL, Enclosure, Onset, Terms, add_terms, combine, scale_terms
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.joints.joint_motion import JointMotion

_ONE = fmpq(1)


class HoldingForces:
    """Those of a joint with this law, all contacts of which are open, and these `touches` by the numbers of links."""

    def __init__(self, law: JointLaw, touches: Mapping[int, Touch]) -> None:
        self._law, self._touches = law, touches

    def of_cluster(
        self,
        cluster: Cluster,
        result: JointStretch,
        forces: Sequence[Terms],
        acting: Sequence[fmpq_poly],
        places: JointMotion | Mapping[int, fmpq_poly] | None,
        begun: Sequence[tuple[fmpq, fmpq]] | None,
    ) -> dict[int, Enclosure]:
        """The forces of closed contacts; and what would hold friction with a larger limit at rest, beyond `forces`.

        Where velocities and displacements are known exactly at first, these are what has `begun`.
        """
        found = {}
        rates = {j: add_terms(result.velocities[j]).begins for j in cluster.points} if begun is not None else {}
        onsets = {
            j: rate.integral(place)
            for (j, rate), (_, place) in zip(rates.items(), begun or (), strict=True)
            if rate is not None
        }
        for n, push in cluster.pushes.items():
            given = acting[cluster.leader(cluster.group(self._touches[n].right))].derivative()
            pull = [*self.pull(cluster, push, result.velocities, forces)]
            pull.append((cluster.inertia.get(n, fmpq(0)), Enclosure.from_polynomial(given)))
            found[n] = self._add_springs(cluster, push, places, pull, onsets)
        for n, touch in self._touches.items():
            if touch.breakaway == 0 or n in cluster.pushes:
                continue
            k, factor, other, ratio = self._free_side(n)
            if k in cluster.points:
                pull = self.pull(cluster, [(k, factor)], result.velocities, forces)
                given = acting[other].derivative()
                pull.append((factor * ratio * self._law.mass[k], Enclosure.from_polynomial(given)))
                found[n] = self._add_springs(cluster, [(k, factor)], places, pull, onsets)
        return found

    def _free_side(self, n: int) -> tuple[int, fmpq, int, fmpq]:
        """The mass that rubs on what moves as is given, its part in the force on the right side; and what it rubs on.

        The last number says how fast it moves with that.
        """
        touch = self._touches[n]
        if self._law.motions[touch.right] is None:
            return touch.right, _ONE, touch.left, touch.ratio
        return touch.left, -1 / touch.ratio, touch.right, 1 / touch.ratio

    def lightness(self, n: int) -> fmpq:
        """How fast the rate changes at which such a mass slides, by a force of 1."""
        k, factor, _, _ = self._free_side(n)
        return 1 / (factor**2 * self._law.mass[k])

    def pull(
        self,
        cluster: Cluster,
        push: Sequence[tuple[int, fmpq]],
        velocities: Mapping[int, Terms],
        forces: Sequence[Terms],
    ) -> Terms:
        """The force of a closed contact, but for what springs do."""
        terms: Terms = []
        for k, factor in push:
            terms += scale_terms(forces[k], -factor)
            for j in cluster.points:
                terms += scale_terms(velocities[j], factor * cluster.joint_law.damping[k][j])
        return terms

    def _add_springs(
        self,
        cluster: Cluster,
        push: Sequence[tuple[int, fmpq]],
        places: JointMotion | Mapping[int, fmpq_poly] | None,
        pull: Terms,
        onsets: Mapping[int, Onset],
    ) -> Enclosure:
        """With what springs do, at these places, which begin so where that is known."""
        if isinstance(places, JointMotion):
            springs = [
                (factor, self.of_springs(cluster, places, k, onsets)) for k, factor in push if self._law.is_elastic(k)
            ]
            return add_terms([(_ONE, add_terms(pull)), *springs])
        exact = [
            (factor * cluster.joint_law.stiffness[k][j], Enclosure.from_polynomial(place))
            for k, factor in push
            for j, place in (places or {}).items()
        ]
        return add_terms([*pull, *exact])

    def of_all_springs(
        self, cluster: Cluster, places: JointMotion | Mapping[int, fmpq_poly] | None
    ) -> dict[int, Enclosure]:
        """What springs pull at each point of a cluster, at these places."""
        if isinstance(places, JointMotion):
            return {k: self.of_springs(cluster, places, k) for k in cluster.points}
        return {
            k: Enclosure.from_polynomial(
                sum((cluster.joint_law.stiffness[k][j] * place for j, place in (places or {}).items()), fmpq_poly())
            )
            for k in cluster.points
        }

    def of_springs(
        self, cluster: Cluster, motion: JointMotion, k: int, onsets: Mapping[int, Onset] = MappingProxyType({})
    ) -> Enclosure:
        """What springs pull at a point on a stretch; the displacements of points may be known to begin so."""
        if not self._law.is_elastic(k):
            return STILL
        polynomial, stiffness = arb_poly(), cluster.joint_law.stiffness[k]
        for j, series in zip(cluster.points, motion.places, strict=True):
            polynomial += arb(stiffness[j]) * arb_poly(series)
        pulled = [j for j in cluster.points if stiffness[j] != 0]
        begins = combine([(stiffness[j], onsets[j]) for j in pulled]) if all(j in onsets for j in pulled) else None
        return Enclosure(polynomial, (arb(stiffness[k]).sqrt() * motion.spring_error).upper(), onset=begins)
