"""A joint at an instant: its law, its corners, and what is known of its points: exactly, or in balls."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache, cached_property

from flint import arb, fmpq

from wavesym.exact.contacts.branches import Closed
from wavesym.exact.contacts.cluster import Cluster, PointState, Touch, connected_sets
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.contacts.springs import JointSprings
from wavesym.exact.joints.enclosure import UNIT, Terms
from wavesym.exact.joints.joint_law import JointLaw, joint_ends
from wavesym.mechanics.network import Network


class JointState:
    """The points of a joint with their states, and its links with corners, by their numbers.

    Masses that are `resting` certainly do not move, held on the ground. Those that friction is `stopping` there may
    yet be moving one way.
    """

    def __init__(self, network: Network, number: int) -> None:
        joint = network.joints[number]
        place = {point: k for k, point in enumerate(joint.points)}
        self.law, self.ends = JointLaw.assemble(network, joint), joint_ends(network, joint)
        # the law where of the springs with corners just these act, and the clusters where this is closed and that vague
        self.law_with: Callable[[Closed], JointLaw] = cache(lambda springs: JointLaw.assemble(network, joint, springs))
        self.clusters: Callable[[Closed, Closed], list[Cluster]] = cache(self._clusters)
        self.touches = {
            n: Touch(place[link.left], place[link.right], link.ratio, link.friction, link.breakaway)
            for n, link in enumerate(network.links)
            if link.has_corner and not link.is_spring_with_corner and link.left in place
        }
        self.points = {k: PointState.from_exact(network.points[point].velocity, fmpq(0)) for point, k in place.items()}
        self.springs = JointSprings(network, place, self.points)
        grounded = {self.mass_on_ground(n) for n, touch in self.touches.items() if touch.friction != 0}
        self.resting = {k for k in grounded - {-1} if self.points[k].velocity == 0}
        self.stopping: dict[int, int] = {}
        self.largest_energy = arb(0)  # that a cluster had
        self.has_relaxed = False

    def take(self, moved: JointStretch) -> None:
        """Go on to the end of a stretch."""
        self.points |= moved.state
        self.springs.take(moved)
        self.resting = {self.mass_on_ground(n) for n in moved.rests.keys() - moved.excesses}
        self.stopping = {k: sign for n, (k, sign) in moved.stops.items() if n not in moved.excesses}

    def _clusters(self, closed: Closed, vague: Closed) -> list[Cluster]:
        """The points that move on their own where this is closed; with what is vague between them they are one."""
        springs = self.springs.select(closed)
        law, touching = self.law_with(springs), closed - springs
        return [
            Cluster.from_law(law, points, self.touches, touching, self.springs.select_between(springs, points))
            for points in connected_sets(law, self.touches, touching | vague)
        ]

    @cached_property
    def sets(self) -> list[list[int]]:
        """Points that have energy together while no contact is closed and no spring with a corner acts."""
        apart = connected_sets(self.law_with(frozenset()), self.touches, frozenset())
        return [points for points in apart if any(self.law.mass[k] != 0 or self.law.is_elastic(k) for k in points)]

    def speed(self, k: int, energy: arb) -> arb:
        """How fast a mass is at most that has so much energy."""
        return (2 * energy / arb(self.law.mass[k])).sqrt().upper()

    def velocity(self, k: int) -> arb:
        """That of a mass, with all that is not known of it."""
        return self.points[k].velocity + arb(0, self.speed(k, self.points[k].error_energy))

    # friction

    def add_friction(self, forces: Sequence[Terms], sliding: Mapping[int, int]) -> list[Terms]:
        """Forces on points, with what is taken against sliding."""
        result = list(forces)
        for n, touch in self.touches.items():
            if sign := sliding.get(n, 0):
                touch.push(result, [(-sign * touch.friction, UNIT)])
        return result

    def is_inert(self, n: int) -> bool:
        """Whether what rubs has no side without mass, so that it slides no other way at once."""
        touch = self.touches[n]
        return touch.friction != 0 and all(
            self.law.mass[k] != 0 or self.law.motions[k] is not None for k in touch.sides
        )

    def mass_on_ground(self, n: int) -> int:
        """The mass that rubs on the ground, and on nothing else; -1 of other friction, or if it bears more at rest."""
        touch = self.touches[n]
        for k, other in (touch.sides, touch.sides[::-1]):
            if self.law.motions[other] == "fixed" and self.law.motions[k] is None and self.law.mass[k] != 0:
                rubs = [m for m, each in self.touches.items() if each.friction != 0 and k in each.sides]
                return k if rubs == [n] and touch.breakaway == 0 else -1
        return -1

    def free_side(self, n: int) -> tuple[int, fmpq, int, fmpq]:
        """The mass that rubs on what moves as is given, its part in the force on the right side; and what it rubs on.

        The last number says how fast it moves with that.
        """
        touch = self.touches[n]
        if self.law.motions[touch.right] is None:
            return touch.right, fmpq(1), touch.left, touch.ratio
        return touch.left, -1 / touch.ratio, touch.right, 1 / touch.ratio

    def lightness(self, n: int) -> fmpq:
        """How fast the rate changes at which such a mass slides, by a force of 1."""
        k, factor, _, _ = self.free_side(n)
        return 1 / (factor**2 * self.law.mass[k])
