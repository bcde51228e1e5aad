"""The springs of a joint whose laws have corners, as time goes on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.contacts.branches import Branches, Closed
from wavesym.exact.contacts.cluster import Cluster, PointState
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.contacts.springs import CornerSpring, SpringState, acting_motion, idle_motion, yielding_motion
from wavesym.exact.joints.enclosure import UNIT, Enclosure, Terms
from wavesym.exact.joints.joint_motion import JointMotion
from wavesym.mechanics.network import Network

Displacements = Mapping[int, fmpq_poly] | JointMotion
"""Those of points, exact; or in balls, those of a cluster's points in their order."""


class JointSprings:
    """The springs, by the numbers of their links, and how long each is; with the states of the points between them."""

    def __init__(self, network: Network, place: Mapping[int, int], points: Mapping[int, PointState]) -> None:
        """Those between points that have a place in the joint."""
        self._points = points
        self.of_link = {
            n: CornerSpring.from_link(link, place)
            for n, link in enumerate(network.links)
            if link.is_spring_with_corner and link.left in place
        }
        self._state = {n: SpringState.from_exact(spring.start) for n, spring in self.of_link.items()}

    def __bool__(self) -> bool:
        return bool(self.of_link)

    @property
    def may_idle(self) -> bool:
        """Whether some of them act on one side."""
        return any(spring.side != 0 for spring in self.of_link.values())

    def take(self, moved: JointStretch) -> None:
        """Go on to the end of a stretch."""
        self._state |= moved.springs

    def select(self, closed: Closed) -> Closed:
        """Of what is closed, springs."""
        return closed.intersection(self.of_link)

    def among(self, links: Closed, points: Sequence[int]) -> Closed:
        """Of these springs, those between some points."""
        return frozenset(n for n in links if self.of_link[n].left in points)

    def add_pulls(self, forces: list[Terms], branches: Branches) -> None:
        """Add to forces on points what springs pull, besides what displacements of points make of it."""
        for n, spring in self.of_link.items():
            closed, sign = branches.of_link(n)
            if closed:
                constant = spring.stiffness * (self._begin(n).shift_known - spring.rest)
            else:
                constant = spring.limit_force(sign) if sign else fmpq(0)
            spring.push(forces, [(-constant, UNIT)] if constant != 0 else [])

    def add_unknown(self, forces: list[Terms], unknown: Mapping[int, arb]) -> None:
        """Add what springs pull besides, which is known to be no more than this."""
        for n, force in unknown.items():
            if force != 0:
                self.of_link[n].push(forces, [(fmpq(-1), Enclosure(arb_poly(), force))])

    def strain(self, cluster: Cluster, result: JointStretch, displacements: Displacements | None) -> None:
        """How the springs that act in a cluster get longer on a stretch, as the displacements there are known."""
        for n in cluster.springs:
            assert displacements is not None
            spring, state = self.of_link[n], self._begin(n)
            stretch = self._stretch(spring, state, cluster.points, displacements)
            if stretch.exact is None and state.exact is not None:
                stretch = replace(stretch, onset=state.onset(spring.rate(result.velocities)))
            if stretch.exact is None and spring.dashpot != 0:  # of what has just engaged it is known more closely
                grown = state.grow(spring.rate(result.velocities), result.length)
                stretch = grown if grown.error < stretch.error else stretch
            moving = acting_motion(spring, stretch)
            result.spring_motions[n] = moving
            result.springs[n] = replace(moving.at_end(result.length), shift=state.shift)

    def strain_others(self, result: JointStretch) -> None:
        """How those that do not act get longer, as the velocities of all points are known."""
        for n, spring in self.of_link.items():
            if n not in result.branches.closed:
                rate = spring.rate(result.velocities)
                sign, state = result.branches.sliding.get(n, 0), self._state[n]
                moving = idle_motion(spring, state, rate, result.length)
                if sign:
                    moving = yielding_motion(spring, state, sign, rate, result.length)
                result.spring_motions[n], result.springs[n] = moving, moving.at_end(result.length)

    @staticmethod
    def _stretch(
        spring: CornerSpring, state: SpringState, among: Sequence[int], displacements: Displacements
    ) -> Enclosure:
        """That of a spring that acts."""
        if not isinstance(displacements, JointMotion):
            apart = displacements[spring.right] - spring.ratio * displacements[spring.left]
            return Enclosure.from_polynomial(apart + state.shift_known)
        series = dict(zip(among, displacements.places, strict=True))
        polynomial = arb_poly(series[spring.right]) - arb(spring.ratio) * arb_poly(series[spring.left])
        error = (displacements.spring_error / arb(spring.stiffness).sqrt()).upper()
        return Enclosure(polynomial + arb(state.shift_known), error)

    def doubts(self, moved: JointStretch) -> dict[int, arb]:
        """Of springs with dashpots those that may be on the other branch: how wrong their forces are without these."""
        damped = [n for n, spring in self.of_link.items() if spring.dashpot != 0]
        wrong = self.wrong_forces(moved) if damped else {}
        return {n: wrong[n] for n in damped if wrong[n] != 0}

    def follow(self, moved: JointStretch, rates: Mapping[int, Enclosure]) -> None:
        """Know how these get longer from how fast, which is known more closely than of their points."""
        for n, rate in rates.items():
            spring, state = self.of_link[n], self._state[n]
            moving = idle_motion(spring, state, rate, moved.length)
            if n in moved.branches.closed:
                moving = acting_motion(spring, state.grow(rate, moved.length))
            moved.spring_motions[n] = moving
            moved.springs[n] = replace(moving.at_end(moved.length), shift=moved.springs[n].shift)

    def reach_beyond(self, n: int) -> arb:
        """How far beyond its gap one that acts on one side may be, at the start of a stretch; at least 0."""
        spring = self.of_link[n]
        return (spring.side * self._state[n].stretch - arb(spring.gap)).upper().max(arb(0))

    def hold_back(self, moved: JointStretch, most: Mapping[int, arb]) -> None:
        """Know how far beyond their gaps some get at most that idle, as far as is known, on a stretch."""
        for n, beyond in most.items():
            spring, state = self.of_link[n], moved.springs[n]
            last = arb(spring.gap) + beyond
            if spring.side * state.stretch < last:
                continue
            ends = (spring.side * state.stretch).lower(), last.upper()
            moved.springs[n] = replace(state, stretch=spring.side * ends[0].union(ends[1]), exact=None)

    def wrong_forces(self, moved: JointStretch) -> dict[int, arb]:
        """How wrong the force of each may be on a stretch, as the true motion may be on another branch."""
        found = {}
        for n, spring in self.of_link.items():
            moving = moved.spring_motions[n]
            excess = moving.excess(moved.length)
            if moved.branches.sliding.get(n, 0):
                excess = excess * arb(moved.length) + moving.stretch.error
            found[n] = (arb(spring.stiffness) * excess).upper()
        return found

    def flows(self, moved: JointStretch, unknown: Mapping[int, arb]) -> list[tuple[int, arb]]:
        """What may have yielded, or come back, by forces that are unknown: of springs that hold, as energy.

        What does not hold is known so much less at the end of the stretch.
        """
        lost = []
        for n, force in unknown.items():
            spring, state = self.of_link[n], moved.springs[n]
            if spring.side != 0 or force == 0:
                continue
            flow = (force / arb(spring.stiffness)).upper()
            if state.shift is not None:
                lost.append((n, arb(spring.stiffness) * flow**2 / 2))
            elif state.exact is None:
                moved.springs[n] = SpringState(state.stretch + arb(0, flow), None)
        return lost

    def are_exact(self, cluster: Cluster) -> bool:
        """Whether it is known exactly how long the springs are that act in a cluster."""
        return all(self._state[n].exact is not None for n in cluster.springs)

    def energy(self, cluster: Cluster) -> arb:
        """What is not known, as energy, of springs that begin to act in a cluster; at most."""
        root = arb(0)
        for n in cluster.springs:
            if self._state[n].shift is None:
                root += (arb(self.of_link[n].stiffness) / 2).sqrt() * self._state[n].error
        return (root**2).upper()

    def _begin(self, n: int) -> SpringState:
        """Its state, acting."""
        return self._state[n].begin(self.of_link[n], self._points)
