"""The springs of a joint whose laws have corners, as time goes on."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.contacts.cluster import Closed, Sliding
from wavesym.exact.contacts.joint_stretch import JointStretch, PointState, way
from wavesym.exact.contacts.springs import CornerSpring, SpringState, acting, at_end, idle, yielding
from wavesym.exact.joints.enclosed import UNIT, Enclosed, Terms, add_terms, scale_terms
from wavesym.exact.joints.joint import JointMotion
from wavesym.mechanics.network import Network

Displacements = Mapping[int, fmpq_poly] | JointMotion
"""Those of points, exact; or in balls, those of a cluster's points in their order."""


class JointSprings:
    """The springs, by the numbers of their links, and how long each is."""

    def __init__(self, network: Network, place: Mapping[int, int]) -> None:
        """Those between points that have a place in the joint."""
        self.springs = {
            n: CornerSpring.of(link, place)
            for n, link in enumerate(network.links)
            if link.is_spring_with_corner and link.left in place
        }
        self._state = {n: SpringState.from_exact(fmpq(0)) for n in self.springs}

    def __bool__(self) -> bool:
        return bool(self.springs)

    def take(self, moved: JointStretch) -> None:
        """Go on to the end of a stretch."""
        self._state |= moved.springs

    def acting(self, closed: Closed) -> Closed:
        """Of what is closed, springs."""
        return closed.intersection(self.springs)

    def add_pulls(
        self,
        forces: list[Terms],
        closed: Closed,
        sliding: Sliding,
        points: Mapping[int, PointState],
        unknown: Mapping[int, arb],
    ) -> None:
        """Add to forces on points what springs pull, besides what displacements of points make of it.

        Their forces are `unknown` by so much.
        """
        for n, spring in self.springs.items():
            sign = way(n, sliding)
            if n in closed:
                constant = spring.stiffness * (self._begin(n, points).shift_known - spring.rest)
            else:
                constant = spring.pull(sign) if sign else fmpq(0)
            spring.add_pull(forces, [(constant, UNIT)] if constant != 0 else [])
            if (force := unknown.get(n, arb(0))) != 0:
                spring.add_pull(forces, [(fmpq(1), Enclosed(arb_poly(), force))])

    def strain(
        self,
        among: Sequence[int],
        result: JointStretch,
        points: Mapping[int, PointState],
        displacements: Displacements | None,
    ) -> None:
        """How the springs between some points get longer on a stretch, as the velocities of these are known."""
        for n, spring in self._between(among):
            if n in result.closed:
                assert displacements is not None
                state = self._begin(n, points)
                moving = acting(spring, self._stretch(spring, state, among, displacements))
                end = replace(at_end(moving, result.length), shift=state.shift)
            else:
                left = scale_terms(result.velocities[spring.left], -spring.ratio)
                rate = add_terms([*result.velocities[spring.right], *left])
                sign, state = way(n, result.sliding), self._state[n]
                moving = yielding(spring, state, sign, rate) if sign else idle(spring, state, rate, result.length)
                end = at_end(moving, result.length)
            result.strained[n], result.springs[n] = moving, end

    @staticmethod
    def _stretch(
        spring: CornerSpring, state: SpringState, among: Sequence[int], displacements: Displacements
    ) -> Enclosed:
        """That of a spring that acts."""
        if not isinstance(displacements, JointMotion):
            apart = displacements[spring.right] - spring.ratio * displacements[spring.left]
            return Enclosed.of(apart + state.shift_known)
        series = dict(zip(among, displacements.places, strict=True))
        polynomial = arb_poly(series[spring.right]) - arb(spring.ratio) * arb_poly(series[spring.left])
        error = (displacements.strained / arb(spring.stiffness).sqrt()).upper()
        return Enclosed(polynomial + arb(state.shift_known), error)

    def wrong_forces(self, moved: JointStretch) -> dict[int, arb]:
        """How wrong the force of each may be on a stretch, as the true motion may be on another branch."""
        found = {}
        for n, spring in self.springs.items():
            moving = moved.strained[n]
            excess = moving.excess(moved.length)
            if way(n, moved.sliding):
                excess = excess * arb(moved.length) + moving.stretch.error
            found[n] = (arb(spring.stiffness) * excess).upper()
        return found

    def flows(self, moved: JointStretch, unknown: Mapping[int, arb]) -> list[tuple[CornerSpring, arb]]:
        """What may have yielded, or come back, by forces that are unknown: energy of springs that hold.

        What does not hold is known so much less at the end of the stretch.
        """
        lost = []
        for n, force in unknown.items():
            spring, state = self.springs[n], moved.springs[n]
            if spring.side != 0 or force == 0:
                continue
            flow = (force / arb(spring.stiffness)).upper()
            if state.shift is None:
                moved.springs[n] = SpringState(state.stretch + arb(0, flow), None)
            else:
                lost.append((spring, arb(spring.stiffness) * flow**2 / 2))
        return lost

    def are_exact(self, among: Collection[int]) -> bool:
        """Whether it is known exactly how long springs between some points are."""
        return all(self._state[n].exact is not None for n, _ in self._between(among))

    def energy(self, among: Collection[int]) -> arb:
        """What is not known, as energy, of springs between some points that begin to act; at most."""
        root = arb(0)
        for n, spring in self._between(among):
            if self._state[n].shift is None:
                root += (arb(spring.stiffness) / 2).sqrt() * self._state[n].unknown
        return (root**2).upper()

    def _begin(self, n: int, points: Mapping[int, PointState]) -> SpringState:
        return self._state[n].begin(self.springs[n], points)

    def _between(self, among: Collection[int]) -> list[tuple[int, CornerSpring]]:
        return [(n, spring) for n, spring in self.springs.items() if spring.left in among]
