"""A joint whose contacts are closed or open: closed ones make one of their points, open ones leave them apart.

A closed contact pushes with a force N >= 0, the right point forwards and the left one backwards; an open one has a gap
>= 0, which grows at a `rate`. With the balance of a point k, M q' + C q + K u = s + what contacts push, N is the sum
of C q + K u - s over the points on one side of the contact, which have no mass.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from math import log2

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from wavesym.exact.contacts.branches import Branches, Closed
from wavesym.exact.contacts.cluster import Cluster, Touch, connected_sets
from wavesym.exact.contacts.cluster_states import ClusterStates
from wavesym.exact.contacts.friction_stops import FrictionStops
from wavesym.exact.contacts.holding_forces import HoldingForces
from wavesym.exact.contacts.joint_springs import Displacements, JointSprings
from wavesym.exact.contacts.joint_stretch import MOST_SWING, JointStretch, PointState, SwingError
from wavesym.exact.contacts.springs import CornerSpring
from wavesym.exact.joints.enclosure import UNIT, Enclosure, Onset, Terms, add_terms, collect, scale_terms, with_bounds
from wavesym.exact.joints.exact_motion import exact_motion, onsets
from wavesym.exact.joints.joint_law import (
    JointLaw,
    bound_sum,
    exact_sum,
    forces_on,
    joint_ends,
    outgoing_terms,
    scatter,
)
from wavesym.exact.joints.joint_motion import JointMotion
from wavesym.exact.joints.network_waves import LoadPolynomial
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import Network

_ONE = fmpq(1)
_ROUNDS = 4  # in which a bound of springs' forces must hold
_SHORTER = 4  # where it does not, as a spring answers to its own force
_MISSED = 16  # bits: what has died away is that much more than rounding errors, at most


class SteadyJoint(ABC):
    """A joint as time goes on, at the working precision; whether what decays fast has been left out."""

    def __init__(self, network: Network, number: int, loads: Sequence[AppliedLoad]) -> None:
        joint = network.joints[number]
        place = {point: k for k, point in enumerate(joint.points)}
        self.law = JointLaw.assemble(network, joint)
        self.touches = {
            n: Touch(place[link.left], place[link.right], link.ratio, link.friction, link.breakaway)
            for n, link in enumerate(network.links)
            if link.has_corner and not link.is_spring_with_corner and link.left in place
        }
        self.springs = JointSprings(network, place)
        self._law_of: Callable[[Closed], JointLaw] = cache(lambda springs: JointLaw.assemble(network, joint, springs))
        self._clusters: dict[tuple[Closed, Closed], list[Cluster]] = {}
        self._loads = [LoadPolynomial(network, point, loads) for point in joint.points]
        self._ends = joint_ends(network, joint)
        touched = {k for touch in self.touches.values() for k in (touch.left, touch.right)}
        self._bare = {n for n, end in enumerate(self._ends) if end.place in touched and self.law.mass[end.place] == 0}
        self._energy = arb(0)  # the largest that a set had
        self.has_relaxed = False
        # sets of points that have energy, mass or springs, while no contact is closed and no spring with a corner acts
        apart = connected_sets(self._law_of(frozenset()), self.touches, frozenset())
        sets = [points for points in apart if any(self.law.mass[k] != 0 or self.law.is_elastic(k) for k in points)]
        first = {k: PointState.from_exact(network.points[p].velocity, fmpq(0)) for k, p in enumerate(joint.points)}
        self._states = ClusterStates(self.law, self.springs, sets, first)
        self.forces = HoldingForces(self.law, self.touches)
        self.stops = FrictionStops(self.law, self.touches, self.forces, self._states)

    def take(self, moved: JointStretch) -> None:
        """Go on to the end of a stretch."""
        self._states.take(moved)
        self.springs.take(moved)
        self.stops.take(moved)

    def rate_on_motion(self, n: int, start: fmpq) -> arb | None:
        """How fast a mass slides on what moves as is given, from an instant on; None of other friction."""
        touch, total = self.touches[n], arb(0)
        motions = [self.law.motions[k] for k in (touch.left, touch.right)]
        if "velocity" not in motions and "acceleration" not in motions:
            return None
        for k, factor, motion in zip((touch.left, touch.right), (-touch.ratio, _ONE), motions, strict=True):
            if motion is None and self.law.mass[k] == 0:
                return None
            total += arb(factor) * self._velocity(k, start)
        return total

    def may_join(self, closed: Closed, start: fmpq) -> bool:
        """Whether masses that these would hold together, or on what moves as is given, may be as fast as each other.

        No force that is finite stops a mass at once, whatever without mass is between it and what it would stick to.
        """
        for cluster in self._split(closed, frozenset()):
            for k in cluster.stuck_points:
                leader = cluster.leader(cluster.group(k))
                apart = self._velocity(k, start) - arb(cluster.ratio(k)) * self._velocity(leader, start)
                if not apart.contains(0):
                    return False
        return True

    def _velocity(self, k: int, start: fmpq) -> arb:
        """That of a mass, or of what moves as is given, with all that is not known of it."""
        if self.law.motions[k] is not None:
            return arb(self._loads[k].polynomial_from(start)(fmpq(0)))
        state = self._states.of_point[k]
        return state.velocity + arb(0, (2 * state.error_energy / arb(self.law.mass[k])).sqrt().upper())

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
        if trial or not self.springs:
            return self._move(arriving, start, length, branches, relaxing, {}, trial)
        unknown: dict[int, arb] = {}
        for _ in range(_ROUNDS):
            moved = self._move(arriving, start, length, branches, relaxing, unknown, trial)
            off = self._wrong_forces(moved, arriving, unknown)
            if all(force <= unknown.get(n, arb(0)) for n, force in off.items()):
                return moved
            unknown = {n: (2 * force).upper() for n, force in off.items()}
        raise SwingError(length / _SHORTER)

    def _wrong_forces(
        self, moved: JointStretch, arriving: Sequence[Enclosure], unknown: Mapping[int, arb]
    ) -> dict[int, arb]:
        """How wrong the force of each spring with a corner may be, with the dashpots that act with them."""
        held = self._farthest_reaches(moved, unknown) if any(unknown.values()) else {}
        most = {n: (arb(self.springs.of_link[n].stiffness) * beyond).upper() for n, beyond in held.items()}
        doubts = {n: force.min(most.get(n, force)) for n, force in self.springs.doubts(moved).items()}
        rates = self._resolve_doubts(moved, doubts, arriving) if doubts else {}
        self.springs.follow(moved, rates)
        off, span = self.springs.wrong_forces(moved), arb(0).union(arb(moved.length))
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
        law, span = self._law_of(self.springs.select(moved.branches.closed)), arb(0).union(arb(moved.length))
        known = {k: moved.velocities[k] for k in range(len(law.mass)) if k not in law.light}
        found = {}
        for n, spring in self.springs.of_link.items():
            if spring.side == 0 or n in moved.branches.closed or unknown.get(n, arb(0)) == 0:
                continue
            if (lightness := self._lightness(spring, law)) == 0:
                continue
            forces = [[*terms, (-_ONE, moved.elastic[k])] for k, terms in enumerate(moved.acting)]
            both = {m for m, other in self.springs.of_link.items() if other.is_opposite(spring)}  # one at a time
            self.springs.add_unknown(forces, {m: force for m, force in unknown.items() if m != n and m not in both})
            q = scatter(law, forces, known)
            driven = spring.side * spring.rate(dict(enumerate(q))).evaluate_on(span)
            farthest = driven.upper() / arb(lightness * spring.stiffness)
            found[n] = self.springs.reach_beyond(n).max(farthest.upper())
        return found

    @abstractmethod
    def _resolve_doubts(
        self, moved: JointStretch, doubts: Mapping[int, arb], arriving: Sequence[Enclosure]
    ) -> dict[int, Enclosure]:
        """How fast springs get longer of which it is in doubt whether they act with their dashpots."""

    def slowing(self, n: int) -> fmpq:
        """How many times as fast a spring gets longer without its dashpot, at most, where what is without mass does."""
        spring = self.springs.of_link[n]
        return 1 + spring.dashpot * self._lightness(spring, self._law_of(frozenset()))

    @staticmethod
    def _lightness(spring: CornerSpring, law: JointLaw) -> fmpq:
        """How much faster a spring would get longer if it pulled less by 1: 0 where its ends are masses."""
        push = [fmpq(0)] * len(law.mass)
        push[spring.right], push[spring.left] = _ONE, -spring.ratio
        given = law.light_velocities(push, {}, exact_sum)
        return sum((push[k] * velocity for k, velocity in given.items()), fmpq(0))

    def _move(
        self,
        arriving: Sequence[Enclosure],
        start: fmpq,
        length: fmpq,
        branches: Branches,
        relaxing: bool | None,
        unknown: Mapping[int, arb],
        trial: bool,
    ) -> JointStretch:
        """The same, where forces of springs with a corner are `unknown` by so much."""
        acting = [load.polynomial_from(start) for load in self._loads]
        forces = self._add_friction(forces_on(self._ends, arriving, acting), branches.sliding)
        self.springs.add_pulls(forces, branches, self._states.of_point)
        result = JointStretch(length, branches, acting=list(forces))
        self.springs.add_unknown(forces, unknown)
        clusters = self._split(branches.closed, branches.vague)
        for cluster in clusters:
            if any(self.touches[n].left in cluster.points for n in branches.vague):
                self._drift(cluster, result, arriving, forces, acting)
            else:
                self._move_cluster(cluster, result, forces, acting, relaxing, trial)
        self.springs.strain_others(result)
        for n, energy in self.springs.flows(result, unknown):
            for k in next(cluster.points for cluster in clusters if n in cluster.springs):
                result.state[k] = result.state.get(k, self._states.of_point[k]).lose(energy)
        for n, touch in self.touches.items():
            if (
                self._states.of_point[touch.left].exact is not None
                and self._states.of_point[touch.right].exact is not None
            ):
                result.exact_contacts.add(n)
            if n not in branches.closed | branches.vague:
                result.rates[n] = add_terms(rate_terms(touch, result.velocities))
        for number, wave in enumerate(arriving):
            if number not in result.sends:
                result.sends[number] = self._outgoing(number, result.velocities, wave)
                if number in self._bare and not collect(self._end_force(number, result.velocities, wave)):
                    result.bare.add(number)
        return result

    def _add_friction(self, forces: Sequence[Terms], sliding: Mapping[int, int]) -> list[Terms]:
        """With what is taken against sliding."""
        result = list(forces)
        for n, touch in self.touches.items():
            sign = sliding.get(n, 0)
            if sign == 0:
                continue
            against = -sign * touch.friction
            result[touch.right] = [*result[touch.right], (against, UNIT)]
            result[touch.left] = [*result[touch.left], (-against * touch.ratio, UNIT)]
        return result

    def _outgoing(self, number: int, velocities: Mapping[int, Terms], wave: Enclosure) -> Enclosure:
        end = self._ends[number]
        return add_terms(outgoing_terms(end, velocities[end.place], wave))

    def _end_force(self, number: int, velocities: Mapping[int, Terms], wave: Enclosure) -> Terms:
        """What is sent less what arrives: up to a factor, what acts on the end."""
        end = self._ends[number]
        return [*outgoing_terms(end, velocities[end.place], wave), (fmpq(-1), wave)]

    def _split(self, closed: Closed, vague: Closed) -> list[Cluster]:
        if (closed, vague) not in self._clusters:
            springs = self.springs.select(closed)
            law, touching = self._law_of(springs), closed - springs
            self._clusters[closed, vague] = [
                replace(
                    Cluster.from_law(law, points, self.touches, touching),
                    springs=frozenset(n for n in springs if self.springs.of_link[n].left in points),
                )
                for points in connected_sets(law, self.touches, touching | vague)
            ]
        return self._clusters[closed, vague]

    @abstractmethod
    def _drift(
        self,
        cluster: Cluster,
        result: JointStretch,
        arriving: Sequence[Enclosure],
        forces: Sequence[Terms],
        acting: Sequence[fmpq_poly],
    ) -> None:
        """Move a cluster some of whose contacts are vague."""

    def _move_cluster(
        self,
        cluster: Cluster,
        result: JointStretch,
        forces: Sequence[Terms],
        acting: Sequence[fmpq_poly],
        relaxing: bool | None,
        trial: bool,
    ) -> None:
        law, points = cluster.law, cluster.points
        pushed = group_forces(cluster, forces)
        prescribed = [acting[cluster.leader(a)] for a in range(len(law.mass))]
        motion, places = None, None
        if cluster.stateless:
            q = scatter(law, pushed, prescribed_terms(law, prescribed))
            result.state |= self._states.sticking_state(cluster, prescribed, result.length)
        elif (exact := self._move_exactly(cluster, pushed, prescribed)) is not None:
            q = [[(_ONE, Enclosure.from_polynomial(p))] for p in exact]
            places = {
                k: ratio * exact[group].integral() + self._states.of_point[k].place
                for k, (group, ratio) in zip(points, law.moves, strict=True)
            }
            for k, (group, ratio) in zip(points, law.moves, strict=True):
                place = places[k](result.length) if self.law.is_elastic(k) else fmpq(0)
                result.state[k] = PointState.from_exact(ratio * exact[group](result.length), place)
        else:
            motion = self._states.balls(cluster, prescribed)
            waves = [add_terms(force) for force in pushed]
            longest = max(wave.polynomial.length() for wave in waves)
            if law.fastest * result.length > MOST_SWING:
                rate, moving = self._relax(cluster, motion, waves, prescribed, result.length, relaxing)
            else:
                rate, terms = law.fastest, series_terms(law.fastest * result.length, longest)
                moving = motion.move(waves, prescribed, result.length, terms)
            q = [[(_ONE, each)] for each in self._add_onsets(cluster, pushed, prescribed, moving, result.length)]
            for group, given in prescribed_terms(law, prescribed).items():
                q[group] = given
            result.state |= self._states.state_after(cluster, motion)
            if rate > result.swing:
                result.swing = rate
                cut = 2 * rate * result.length > MOST_SWING
                result.fleeting = cut and any(each.slow < rate for each in cluster.relaxations)
            self._energy = self._energy.max(motion.energy(motion.velocity, motion.displacement))
        moving_points = {k: scale_terms(q[group], ratio) for k, (group, ratio) in zip(points, law.moves, strict=True)}
        begun = self._states.exact_state(cluster)
        before = {k: result.state[k] for k in points if k in result.state}
        assumed: dict[int, arb] = {}
        self.stops.find_ways(cluster, result)
        for _ in range(_ROUNDS):
            result.velocities |= self._less_known(cluster, result, moving_points, sum(assumed.values(), arb(0)))
            result.pushes |= self.forces.of_cluster(cluster, result, forces, acting, motion or places, begun)
            slipped = {} if trial else self.stops.slips(cluster, result)
            if all(root <= assumed.get(n, arb(0)) for n, root in slipped.items()):
                break
            assumed = {n: (2 * root).upper() for n, root in slipped.items()}
            lost = (sum(assumed.values(), arb(0)) ** 2).upper()
            result.state |= {k: before.get(k, self._states.of_point[k]).lose(lost) for k in points}
        else:
            raise ArithmeticError("what friction bears has no bound")
        self._strain(cluster, result, places if motion is None else motion)
        self.stops.find_rests(cluster, result)

    def _strain(self, cluster: Cluster, result: JointStretch, places: Displacements | None) -> None:
        """How springs with a corner get longer; and what all springs pull, where dashpots act with some."""
        self.springs.strain(cluster, result, self._states.of_point, places)
        if self.springs.may_idle:
            result.elastic |= self.forces.of_all_springs(cluster, places)

    def _less_known(
        self, cluster: Cluster, result: JointStretch, velocities: Mapping[int, Terms], root: arb
    ) -> dict[int, Terms]:
        """Velocities, with what is not known of masses that stick; `root`^2 is energy that others may have got."""
        certain = {k for n in cluster.pushes for k in self.touches[n].sides if self.touches[n].breakaway != 0}
        rates = {k: slow for k, slow in self._states.unseen_rates(cluster, result.state).items() if k not in certain}
        if root != 0:
            law = cluster.law
            known = {a: (arb(2) / arb(law.mass[a])).sqrt() * root for a in law.heavy}
            known |= {a: arb(0) for a in range(len(law.mass)) if law.motions[a] is not None}
            known |= law.light_velocities([arb(0)] * len(law.mass), known, bound_sum)
            for k, (group, ratio) in zip(cluster.points, law.moves, strict=True):
                rates[k] = (rates.get(k, arb(0)) + abs(arb(ratio)) * known[group]).upper()
        one_way = {k: sign for n, (k, sign) in result.stops.items() if n not in result.excesses}
        return {
            k: [*terms, (_ONE, _slow_enclosure(slow, self.stops.way(cluster, k, one_way)))] if slow != 0 else terms
            for k, terms in velocities.items()
            for slow in [rates.get(k, arb(0))]
        }

    def _relax(
        self,
        cluster: Cluster,
        motion: JointMotion,
        waves: Sequence[Enclosure],
        prescribed: Sequence[fmpq_poly],
        length: fmpq,
        relaxing: bool | None,
    ) -> tuple[fmpq, list[Enclosure]]:
        """The rate at which a cluster moves when what decays fast has died away, and its velocities."""
        longest = max(wave.polynomial.length() for wave in waves)
        if relaxing is None:
            relaxation = next(each for each in reversed(cluster.relaxations) if each.slow * length <= MOST_SWING)
            q, u, missed = motion.relax(relaxation, waves, prescribed, series_terms(relaxation.slow * length, longest))
            motion.lose(missed)
            return relaxation.slow, motion.follow(q, u, waves, length)
        for relaxation in cluster.relaxations if relaxing else ():
            shorter = min(length, MOST_SWING / relaxation.slow) if relaxation.slow != 0 else length
            terms = series_terms(relaxation.slow * shorter, longest)
            if not relaxation.serves(shorter, terms):
                continue
            q, u, missed = motion.relax(relaxation, waves, prescribed, terms)
            if missed > self._energy.max(motion.rounded_energy) * arb(2) ** (2 * (_MISSED - ctx.prec)):
                continue
            if shorter < length:
                raise SwingError(shorter)
            self.has_relaxed = True
            motion.lose(missed)
            return relaxation.slow, motion.follow(q, u, waves, length)
        raise SwingError(MOST_SWING / cluster.law.fastest)

    def _move_exactly(
        self, cluster: Cluster, pushed: Sequence[Terms], prescribed: Sequence[fmpq_poly]
    ) -> list[fmpq_poly] | None:
        """The velocities of groups, where all is known exactly and they are polynomials."""
        if (known := self._states.exact_state(cluster)) is None:
            return None
        forces = [force for terms in pushed if (force := add_terms(terms).exact) is not None]
        if len(forces) < len(pushed):
            return None
        velocity = [known[leader][0] for leader in cluster.law.leaders]
        return exact_motion(cluster.law, velocity, [u for _, u in known], forces, prescribed)

    def _add_onsets(
        self,
        cluster: Cluster,
        pushed: Sequence[Terms],
        prescribed: Sequence[fmpq_poly],
        velocities: Sequence[Enclosure],
        length: fmpq,
    ) -> Sequence[Enclosure]:
        """The velocities of groups, with how they begin, where that is known."""
        if (known := self._states.exact_state(cluster)) is None:
            return velocities
        forces = [begins for terms in pushed if (begins := add_terms(terms).begins) is not None]
        if len(forces) < len(pushed):
            return velocities
        span = arb(0).union(arb(length))
        begin = onsets(
            cluster.law,
            ([known[leader][0] for leader in cluster.law.leaders], [u for _, u in known]),
            forces,
            [Onset(p) for p in prescribed],
            [abs(each.evaluate_on(span)).upper() for each in velocities],
            length,
        )
        return [replace(each, onset=onset) for each, onset in zip(velocities, begin, strict=True)]


def _slow_enclosure(most: arb, way: int) -> Enclosure:
    """A rate that is unknown but for its size, and perhaps for its sign."""
    bounds = (fmpq_poly() if way > 0 else None, fmpq_poly() if way < 0 else None)
    return with_bounds(Enclosure(arb_poly(), most), None, *bounds)


def group_forces(cluster: Cluster, forces: Sequence[Terms]) -> list[Terms]:
    """What acts on the groups of a cluster."""
    terms: list[Terms] = [[] for _ in cluster.law.mass]
    for k, (group, ratio) in zip(cluster.points, cluster.law.moves, strict=True):
        terms[group] += scale_terms(forces[k], ratio)
    return terms


def prescribed_terms(law: JointLaw, prescribed: Sequence[fmpq_poly]) -> dict[int, Terms]:
    return {a: [(_ONE, Enclosure.from_polynomial(p))] for a, p in enumerate(prescribed) if law.motions[a] is not None}


def rate_terms(touch: Touch, velocities: Mapping[int, Terms]) -> Terms:
    return [*velocities[touch.right], *scale_terms(velocities[touch.left], -touch.ratio)]


def series_terms(swing: fmpq, least: int) -> int:
    """As many terms as a series needs that goes like exp(swing)."""
    x, size, n = float(swing), 0.0, 0
    while x > 0 and size > -ctx.prec - 8:
        n += 1
        size += log2(x / n)
    return max(n, least) + 2
