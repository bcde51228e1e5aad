"""A joint as time goes on, with links whose laws have corners: moved over one stretch after another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import arb, fmpq

from wavesym.exact.contacts.branches import Branches, Closed
from wavesym.exact.contacts.cluster import Cluster, subsets
from wavesym.exact.contacts.joint_state import JointState
from wavesym.exact.contacts.joint_stretch import JointStretch, SwingError
from wavesym.exact.contacts.springs import CornerSpring
from wavesym.exact.contacts.steady_motion import SteadyMotion
from wavesym.exact.contacts.vague_motion import ChoiceMotions, VagueMotion, near_first
from wavesym.exact.joints.enclosure import Enclosure, Terms, add_terms, collect
from wavesym.exact.joints.joint_law import JointLaw, exact_sum, forces_on, outgoing_terms, scatter
from wavesym.exact.joints.network_waves import LoadPolynomial
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import Network

_ONE = fmpq(1)
_ROUNDS = 4  # in which a bound of springs' forces must hold
_SHORTER = 4  # where it does not, as a spring answers to its own force


class TouchingJoint(JointState):
    """A joint as time goes on, at the working precision, under some loads."""

    def __init__(self, network: Network, number: int, loads: Sequence[AppliedLoad]) -> None:
        super().__init__(network, number)
        self._loads = [LoadPolynomial(network, point, loads) for point in network.joints[number].points]
        touched = {k for touch in self.touches.values() for k in touch.sides}
        self._bare = {n for n, end in enumerate(self.ends) if end.place in touched and self.law.mass[end.place] == 0}

    def rate_on_motion(self, n: int, start: fmpq) -> arb | None:
        """How fast a mass slides on what moves as is given, from an instant on; None of other friction."""
        touch, total = self.touches[n], arb(0)
        motions = [self.law.motions[k] for k in touch.sides]
        if "velocity" not in motions and "acceleration" not in motions:
            return None
        for k, factor, motion in zip(touch.sides, (-touch.ratio, _ONE), motions, strict=True):
            if motion is None and self.law.mass[k] == 0:
                return None
            total += arb(factor) * self._velocity_from(k, start)
        return total

    def may_join(self, closed: Closed, start: fmpq) -> bool:
        """Whether masses that these would hold together, or on what moves as is given, may be as fast as each other.

        No force that is finite stops a mass at once, whatever without mass is between it and what it would stick to.
        """
        for cluster in self.clusters(closed, frozenset()):
            for k in cluster.stuck_points:
                like = arb(cluster.ratio(k)) * self._velocity_from(cluster.leader(k), start)
                if not (self._velocity_from(k, start) - like).contains(0):
                    return False
        return True

    def _velocity_from(self, k: int, start: fmpq) -> arb:
        """That of a mass, or of what moves as is given, with all that is not known of it."""
        given = self.law.motions[k] is not None
        return arb(self._loads[k].polynomial_from(start)(fmpq(0))) if given else self.velocity(k)

    def move(
        self,
        arriving: Sequence[Enclosure],
        start: fmpq,
        length: fmpq,
        branches: Branches,
        relaxing: bool | None = None,
        trial: bool = False,
    ) -> JointStretch:
        """Its motion on a stretch on which its corners are on these branches.

        Where a series would have to bear more than exp(`MOST_SWING`), that is its motion without what decays fast. Such
        a stretch is decided already (`relaxing` None), or it is seen that this is lost among rounding errors:
        SwingError where it is not, or where it is not to be tried. In a `trial` springs with a corner keep to their
        branches for certain, as long as they are on them.
        """
        unknown: dict[int, arb] = {}
        for _ in range(_ROUNDS):
            moved = self._move(arriving, start, length, branches, relaxing, trial, unknown)
            off = {} if trial or not self.springs else self._wrong_forces(moved, arriving, unknown)
            if all(force <= unknown.get(n, arb(0)) for n, force in off.items()):
                return moved
            unknown = {n: (2 * force).upper() for n, force in off.items()}
        raise SwingError(length / _SHORTER)

    def _move(
        self,
        arriving: Sequence[Enclosure],
        start: fmpq,
        length: fmpq,
        branches: Branches,
        relaxing: bool | None,
        trial: bool,
        unknown: Mapping[int, arb],
    ) -> JointStretch:
        """The same, where forces of springs with a corner are `unknown` by so much."""
        acting = [load.polynomial_from(start) for load in self._loads]
        forces = self.add_friction(forces_on(self.ends, arriving, acting), branches.sliding)
        self.springs.add_pulls(forces, branches)
        result = JointStretch(length, branches, acting=list(forces))
        self.springs.add_unknown(forces, unknown)
        clusters = self.clusters(branches.closed_links, branches.vague)
        for cluster in clusters:
            if any(self.touches[n].left in cluster.points for n in branches.vague):
                VagueMotion(self, cluster, result, forces, acting).move(arriving)
            else:
                SteadyMotion(self, cluster, result, forces, acting).move(relaxing, trial)
        self.springs.strain_others(result)
        for n, energy in self.springs.flows(result, unknown):
            for k in next(cluster.points for cluster in clusters if n in cluster.springs):
                result.state[k] = result.state.get(k, self.points[k]).lose(energy)
        for n, touch in self.touches.items():
            if all(self.points[k].exact is not None for k in touch.sides):
                result.exact_contacts.add(n)
            if n not in branches.closed_links | branches.vague:
                result.rates[n] = add_terms(touch.rate_terms(result.velocities))
        for number, (end, wave) in enumerate(zip(self.ends, arriving, strict=True)):
            if number not in result.sends:
                sent = outgoing_terms(end, result.velocities[end.place], wave)
                result.sends[number] = add_terms(sent)
                if number in self._bare and not collect([*sent, (-_ONE, wave)]):  # up to a factor, what acts on it
                    result.bare.add(number)
        return result

    # what is not known of the forces of springs

    def _wrong_forces(
        self, moved: JointStretch, arriving: Sequence[Enclosure], unknown: Mapping[int, arb]
    ) -> dict[int, arb]:
        """How wrong the force of each spring with a corner may be, with the dashpots that act with them."""
        held = self._farthest_reaches(moved, unknown) if any(unknown.values()) else {}
        most = {n: (arb(self.springs.of_link[n].stiffness) * beyond).upper() for n, beyond in held.items()}
        doubts = {n: force.min(most.get(n, force)) for n, force in self.springs.doubts(moved).items()}
        rates = self._resolve_doubts(moved, doubts, arriving) if doubts else {}
        self.springs.follow(moved, rates)
        off, span = self.springs.wrong_forces(moved), moved.span
        off |= {n: off[n].min(force) for n, force in most.items()}
        moved.doubts = frozenset(n for n in doubts if off[n] != 0)
        for n in moved.doubts:
            off[n] += (arb(self.springs.of_link[n].dashpot) * abs(rates[n].evaluate_on(span))).upper()
        self.springs.hold_back(moved, held)
        return off

    def _farthest_reaches(self, moved: JointStretch, unknown: Mapping[int, arb]) -> dict[int, arb]:
        """How far beyond their gaps springs get at most that idle, as far as is known, and whose ends have no mass.

        Such a spring gets longer at r - w f, its own force f = K s; r is what all else makes of it. Where s is largest
        on a stretch, beyond where it was before, its rate is 0, and so s = r/(w K).
        """
        if self.touches:
            return {}
        law, span = self.law_with(self.springs.select(moved.branches.closed_links)), moved.span
        known = {k: moved.velocities[k] for k in range(len(law.mass)) if k not in law.light}
        found = {}
        for n, spring in self.springs.of_link.items():
            if spring.side == 0 or n in moved.branches.closed_links or unknown.get(n, arb(0)) == 0:
                continue
            if (lightness := self._spring_lightness(spring, law)) == 0:
                continue
            both = {m for m, other in self.springs.of_link.items() if other.is_opposite(spring)}  # one at a time
            forces = self._pull_forces(moved, {m: force for m, force in unknown.items() if m != n and m not in both})
            q = scatter(law, forces, known)
            driven = spring.side * spring.rate(dict(enumerate(q))).evaluate_on(span)
            farthest = driven.upper() / arb(lightness * spring.stiffness)
            found[n] = self.springs.reach_beyond(n).max(farthest.upper())
        return found

    def _pull_forces(self, moved: JointStretch, unknown: Mapping[int, arb]) -> list[Terms]:
        """What acts on points, with what springs pull, but for such forces of some."""
        forces = [[*terms, (-_ONE, moved.elastic[k])] for k, terms in enumerate(moved.acting)]
        self.springs.add_unknown(forces, unknown)
        return forces

    def slowing(self, n: int) -> fmpq:
        """How many times as fast a spring gets longer without its dashpot, at most, where what is without mass does."""
        spring = self.springs.of_link[n]
        return 1 + spring.dashpot * self._spring_lightness(spring, self.law_with(frozenset()))

    @staticmethod
    def _spring_lightness(spring: CornerSpring, law: JointLaw) -> fmpq:
        """How much faster a spring would get longer if it pulled less by 1: 0 where its ends are masses."""
        push = [fmpq(0)] * len(law.mass)
        push[spring.right], push[spring.left] = _ONE, -spring.ratio
        given = law.light_velocities(push, {}, exact_sum)
        return sum((push[k] * velocity for k, velocity in given.items()), fmpq(0))

    def _resolve_doubts(
        self, moved: JointStretch, doubts: Mapping[int, arb], arriving: Sequence[Enclosure]
    ) -> dict[int, Enclosure]:
        """How fast springs get longer of which it is in doubt whether they act with their dashpots.

        What has mass moves the same whatever they do, what has none as under one choice of those that act: the force
        that is not known is that of the dashpots, and makes the velocity smaller that it comes from. Besides these the
        forces of springs are wrong by their `doubts`. What else follows from velocities is known as closely then.
        """
        span, points = moved.span, range(len(self.law.mass))
        acting = self.springs.select(moved.branches.closed_links)
        touching = moved.branches.closed_links - acting
        laws = [self.law_with(acting ^ other) for other in subsets(doubts)]
        together = Cluster.from_law(laws[0], points, self.touches, touching)
        known = {k: moved.velocities[k] for k in points if self.law.mass[k] != 0 or self.law.motions[k] is not None}
        settled = {k: moved.velocities[k] for k in points if together.leader(k) in known}
        forces = self._pull_forces(moved, doubts)
        found = ChoiceMotions(self, laws, points, touching, moved.branches.vague, forces, known, settled, span)
        if not together.stuck_points:
            free = found.of_points([k for k in points if k not in settled])
            for k, closer in near_first(free, span).items():
                if closer.error < add_terms(moved.velocities[k]).error:
                    moved.velocities[k] = [(_ONE, closer)]
            pressing = {n: ways for n, ways in found.pushes.items() if self.touches[n].friction == 0}
            sends = found.sends(arriving)
            for before, ways in ((moved.sends, sends), (moved.rates, found.rates), (moved.pushes, pressing)):
                close = near_first({n: each for n, each in ways.items() if n in before}, span)
                before |= {n: each for n, each in close.items() if each.error < before[n].error}
        rates = {n: [self.springs.of_link[n].rate_terms(q) for q in found.velocities] for n in doubts}
        return near_first(rates, span)
