"""A cluster whose corners keep to their branches on a stretch: it moves in exact polynomials, or in a series of balls.

A closed contact pushes with a force N >= 0, the right point forwards and the left one backwards; an open one has a gap
>= 0, which grows at a `rate`. With the balance of a point k, M q' + C q + K u = s + what contacts push, N is the sum
of C q + K u - s over the points on one side of the contact, which have no mass.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import log2

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from wavesym.exact.contacts.cluster import PointState
from wavesym.exact.contacts.cluster_motion import ONE, ClusterMotion
from wavesym.exact.contacts.friction_stops import find_rests, find_ways, slips, way_of
from wavesym.exact.contacts.joint_stretch import MOST_SWING, SwingError
from wavesym.exact.joints.enclosure import Enclosure, Onset, Terms, add_terms, with_bounds
from wavesym.exact.joints.joint_law import bound_sum, scatter
from wavesym.exact.joints.joint_motion import JointMotion
from wavesym.exact.joints.joint_series import exact_motion, onsets

_ROUNDS = 4  # in which a bound of what slips must hold
_MISSED = 16  # bits: what has died away is that much more than rounding errors, at most


class SteadyMotion(ClusterMotion):
    """A cluster on a stretch on which it is certain what its corners do, or taken for certain."""

    def move(self, relaxing: bool | None, trial: bool) -> None:
        """Move it. SwingError where that takes a shorter stretch (`TouchingJoint.move`, which has the arguments)."""
        result = self.result
        pushed = self.cluster.gather(self.forces)
        if self.cluster.stateless:
            q = scatter(self.law, pushed, self.given)
            state = self.sticking_state()
        elif (exact := self._exact_motion(pushed)) is not None:
            q = [[(ONE, Enclosure.from_polynomial(p))] for p in exact]
            state = self._exact_end(exact)
        else:
            q, state = self._series_motion(pushed, relaxing)
        velocities = self.cluster.spread(q)
        result.state |= state
        assumed: dict[int, arb] = {}
        find_ways(self)
        for _ in range(_ROUNDS):
            root = sum(assumed.values(), arb(0))
            result.velocities |= self._less_known(velocities, root)
            result.pushes |= self.holding_forces(self._displacement_onsets())
            slipped = {} if trial else slips(self)
            if all(each <= assumed.get(n, arb(0)) for n, each in slipped.items()):
                break
            assumed = {n: (2 * each).upper() for n, each in slipped.items()}
            result.state |= self.lose(sum(assumed.values(), arb(0)), state)
        else:
            raise ArithmeticError("what friction bears has no bound")
        self.strain()
        find_rests(self)

    def _exact_motion(self, pushed: Sequence[Terms]) -> list[fmpq_poly] | None:
        """The velocities of groups, where all is known exactly and they are polynomials."""
        if self.exact is None:
            return None
        forces = [force for terms in pushed if (force := add_terms(terms).exact) is not None]
        if len(forces) < len(pushed):
            return None
        return exact_motion(self.law, *self._exact_begin, forces, self.prescribed)

    @property
    def _exact_begin(self) -> tuple[list[fmpq], list[fmpq]]:
        """The velocities of groups and the displacements of points, which are known exactly."""
        assert self.exact is not None
        return [self.exact[leader][0] for leader in self.law.leaders], [u for _, u in self.exact]

    def _exact_end(self, velocities: Sequence[fmpq_poly]) -> dict[int, PointState]:
        """The state after such a motion; its displacements are known then."""
        self.places, state = {}, {}
        for k, (group, ratio) in self.cluster.moves.items():
            self.places[k] = ratio * velocities[group].integral() + self.joint.points[k].place
            place = self.places[k](self.length) if self.joint.law.is_elastic(k) else fmpq(0)
            state[k] = PointState.from_exact(ratio * velocities[group](self.length), place)
        return state

    def _series_motion(
        self, pushed: Sequence[Terms], relaxing: bool | None
    ) -> tuple[list[Terms], dict[int, PointState]]:
        """The velocities of groups as a series in balls, and the state at the end."""
        joint, result = self.joint, self.result
        self.places = motion = self.begin()
        waves = [add_terms(force) for force in pushed]
        rate, longest = self.law.fastest, max(wave.polynomial.length() for wave in waves)
        if rate * self.length > MOST_SWING:
            rate, moving = self._relax(motion, waves, longest, relaxing)
        else:
            moving = motion.move(waves, self.prescribed, self.length, series_terms(rate * self.length, longest))
        q = [[(ONE, each)] for each in self._add_onsets(pushed, moving)]
        for group, given in self.given.items():
            q[group] = given
        if rate > result.swing:
            result.swing = rate
            cut = 2 * rate * self.length > MOST_SWING
            result.fleeting = cut and any(each.slow < rate for each in self.cluster.relaxations)
        joint.largest_energy = joint.largest_energy.max(motion.energy(motion.velocity, motion.displacement))
        return q, self.state_after(motion)

    def _relax(
        self, motion: JointMotion, waves: Sequence[Enclosure], longest: int, relaxing: bool | None
    ) -> tuple[fmpq, list[Enclosure]]:
        """The rate at which it moves when what decays fast has died away, and its velocities.

        Where that is `relaxing` None it is known that it has; else it is tried, and has to be seen.
        """
        joint, cluster = self.joint, self.cluster
        found = tuple(reversed(cluster.relaxations)) if relaxing is None else cluster.relaxations if relaxing else ()
        for relaxation in found:
            shorter = min(self.length, MOST_SWING / relaxation.slow) if relaxation.slow != 0 else self.length
            terms = series_terms(relaxation.slow * shorter, longest)
            if shorter < self.length if relaxing is None else not relaxation.serves(shorter, terms):
                continue
            q, u, missed = motion.relax(relaxation, waves, self.prescribed, terms)
            most = joint.largest_energy.max(motion.rounded_energy) * arb(2) ** (2 * (_MISSED - ctx.prec))
            if relaxing and missed > most:
                continue
            if shorter < self.length:
                raise SwingError(shorter)
            joint.has_relaxed = True
            motion.lose(missed)
            return relaxation.slow, motion.follow(q, u, waves, self.length)
        raise SwingError(MOST_SWING / self.law.fastest)

    def _add_onsets(self, pushed: Sequence[Terms], velocities: Sequence[Enclosure]) -> Sequence[Enclosure]:
        """The velocities of groups, with how they begin, where that is known."""
        if self.exact is None:
            return velocities
        forces = [begins for terms in pushed if (begins := add_terms(terms).begins) is not None]
        if len(forces) < len(pushed):
            return velocities
        sizes = [abs(each.evaluate_on(self.span)).upper() for each in velocities]
        given = [Onset(p) for p in self.prescribed]
        begin = onsets(self.law, self._exact_begin, forces, given, sizes, self.length)
        return [replace(each, onset=onset) for each, onset in zip(velocities, begin, strict=True)]

    def _displacement_onsets(self) -> dict[int, Onset]:
        """How the displacements of points begin, where that is known."""
        found = {}
        for k, (_, place) in zip(self.points, self.exact or (), strict=self.exact is not None):
            if (rate := add_terms(self.result.velocities[k]).begins) is not None:
                found[k] = rate.integral(place)
        return found

    def _less_known(self, velocities: Mapping[int, Terms], root: arb) -> dict[int, Terms]:
        """Velocities, with what is not known of masses that stick; `root`^2 is energy that others may have got."""
        joint, law = self.joint, self.law
        certain = {k for n in self.cluster.pushes for k in joint.touches[n].sides if joint.touches[n].breakaway != 0}
        rates = {k: slow for k, slow in self.unseen_rates(self.result.state).items() if k not in certain}
        if root != 0:
            known = {a: (arb(2) / arb(law.mass[a])).sqrt() * root for a in law.heavy}
            known |= {a: arb(0) for a in self.given}
            known |= law.light_velocities([arb(0)] * len(law.mass), known, bound_sum)
            for k, (group, ratio) in self.cluster.moves.items():
                rates[k] = (rates.get(k, arb(0)) + abs(arb(ratio)) * known[group]).upper()
        one_way = {k: sign for n, (k, sign) in self.result.stops.items() if n not in self.result.excesses}
        return {
            k: [*terms, (ONE, _slow_enclosure(slow, way_of(self, k, one_way)))] if slow != 0 else terms
            for k, terms in velocities.items()
            for slow in [rates.get(k, arb(0))]
        }


def _slow_enclosure(most: arb, way: int) -> Enclosure:
    """A rate that is unknown but for its size, and perhaps for its sign."""
    bounds = (fmpq_poly() if way > 0 else None, fmpq_poly() if way < 0 else None)
    return with_bounds(Enclosure(arb_poly(), most), None, *bounds)


def series_terms(swing: fmpq, least: int) -> int:
    """As many terms as a series needs that goes like exp(swing)."""
    x, size, n = float(swing), 0.0, 0
    while x > 0 and size > -ctx.prec - 8:
        n += 1
        size += log2(x / n)
    return max(n, least) + 2
