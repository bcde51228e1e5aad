"""A cluster on a stretch so short that it does not matter which of its contacts are closed when: these are vague.

Whatever they do, the velocities of points without mass are those under one choice of closed contacts, of which there
are few, and the force of a contact is 0 or what it is under one of them. What has mass, and springs, feel a force
between 0 and the largest of these. The bound is taken for granted, and then shown to be larger than what follows from
it: as velocities of masses and displacements are continuous, no force can have been the first to pass it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from flint import arb, arb_poly, fmpq

from wavesym.exact.contacts.branches import Closed
from wavesym.exact.contacts.cluster import Cluster, PointState, subsets
from wavesym.exact.contacts.cluster_motion import ONE, ClusterMotion
from wavesym.exact.contacts.friction_stops import excess, find_rests, lose_excess
from wavesym.exact.contacts.joint_state import JointState
from wavesym.exact.contacts.steady_motion import series_terms
from wavesym.exact.joints.enclosure import Enclosure, Terms, add_terms, one_at_each_instant, scale_terms, with_bounds
from wavesym.exact.joints.joint_law import JointLaw, exact_sum, outgoing_terms, scatter
from wavesym.exact.joints.joint_motion import JointMotion

_SLACK = fmpq(1, 2**20)
_ROUNDS = 8  # in which a bound of the forces must hold
_CLOSER = 4  # times: what friction takes is looked for again where it is known so much closer


class VagueMotion(ClusterMotion):
    """A cluster some of whose contacts are vague."""

    def move(self, arriving: Sequence[Enclosure]) -> None:
        """Move it, under all that its contacts may do."""
        joint, cluster, result, span = self.joint, self.cluster, self.result, self.span
        inside = {n for n, touch in joint.touches.items() if touch.left in self.points}
        vague, closed = result.branches.vague & inside, result.branches.closed_links & inside
        touches = {n: joint.touches[n] for n in vague}
        pressing = [n for n, touch in touches.items() if touch.friction == 0]
        bounds = {n: arb(0) for n in pressing}
        taken = {
            n: arb(0, arb(max(touch.friction, touch.breakaway)).upper())
            for n, touch in touches.items()
            if touch.friction != 0
        }
        slow: dict[int, arb] = {}
        for tried in range(_ROUNDS):
            motion, q = self._series(bounds, taken)
            self.places = motion
            known = self._known_velocities(q, slow)
            pulls = list(self.forces)
            for k in self.points:
                pulls[k] = [*self.forces[k], (fmpq(-1), self.spring_pull(k))]
            found = ChoiceMotions(joint, [cluster.joint_law], self.points, closed, vague, pulls, known, {}, span)
            if tried < _ROUNDS // 2 and any(force.rad() * _CLOSER < taken[n].rad() for n, force in found.takes.items()):
                taken |= found.takes
                continue
            forced = any_of(found.pushes, span)
            largest = {n: forced[n].evaluate_on(span).upper().max(arb(0)) for n in pressing}
            after = self.sticking_state() if cluster.stateless else self.state_after(motion)
            faster = self._hidden_rates(after, forced)
            seen = all(rate <= slow.get(k, arb(0)) for k, rate in faster.items())
            if seen and all(largest[n] < bounds[n] or largest[n] == 0 for n in pressing):
                break
            if not seen:
                slow = {k: (2 * rate).upper() for k, rate in faster.items()}
            bounds = {n: (most * arb(1 + _SLACK)).upper() for n, most in largest.items()}
        else:
            raise ArithmeticError("the force of a contact has no bound")
        result.velocities |= {k: [(ONE, each)] for k, each in any_of(found.of_points(self.points), span).items()}
        for k in self.points:  # what has mass moves like that under every choice, as time goes on
            if (leader := cluster.leader(k)) in known:
                result.velocities[k] = scale_terms(known[leader], cluster.ratio(k))
        result.sends |= any_of(found.sends(arriving), span)
        if not taken:
            self._bound_sends(arriving)
        result.rates |= any_of(found.rates, span)
        result.pushes |= forced
        result.pushes |= {n: force for n, force in self.holding_forces().items() if n in vague}
        result.state |= after
        self.strain()
        lose_excess(self)
        find_rests(self)

    def _series(self, bounds: Mapping[int, arb], taken: Mapping[int, arb]) -> tuple[JointMotion, list[Enclosure]]:
        """The motion where contacts push with anything between 0 and their bounds, and of what friction takes."""
        forces = list(self.forces)
        pushes = {n: arb((bound / 2).upper(), (bound / 2).upper()) for n, bound in bounds.items()}
        for n, push in (pushes | dict(taken)).items():
            self.joint.touches[n].push(forces, [(ONE, Enclosure(arb_poly([push.mid()]), push.rad()))])
        pushed = [add_terms(each) for each in self.cluster.gather(forces)]
        longest = max(wave.polynomial.length() for wave in pushed)
        motion = self.begin()
        terms = series_terms(self.law.fastest * self.length, longest)
        return motion, motion.move(pushed, self.prescribed, self.length, terms)

    def _known_velocities(self, q: Sequence[Enclosure], slow: Mapping[int, arb]) -> dict[int, Terms]:
        """Those of points that groups with mass, or that move as is given, move like; besides, some may be so fast."""
        cluster = self.cluster
        known: dict[int, Terms] = {cluster.leaders[a]: [(ONE, q[a])] for a in self.law.heavy}
        known |= {cluster.leaders[a]: each for a, each in self.given.items()}
        for k, rate in slow.items():
            besides = Enclosure(arb_poly(), (rate / arb(abs(cluster.ratio(k)))).upper())
            known[cluster.leader(k)] = [*known.get(cluster.leader(k), []), (ONE, besides)]
        return known

    def _hidden_rates(self, after: Mapping[int, PointState], pushes: Mapping[int, Enclosure]) -> dict[int, arb]:
        """How fast masses that stick may be on a stretch, besides: by what is not known of them, or pulled to slide."""
        law = self.joint.law
        rates = {k: rate for k, rate in self.unseen_rates(after).items() if law.mass[k] != 0}
        for n in self.cluster.pushes:
            touch = self.joint.touches[n]
            beyond = excess(touch, pushes[n], self.span)
            for k, factor in ((touch.right, ONE), (touch.left, abs(touch.ratio))) if beyond > 0 else ():
                if law.mass[k] != 0 and law.motions[k] is None:
                    gained = beyond * arb(self.length * factor / law.mass[k])
                    rates[k] = (rates.get(k, arb(0)) + gained).upper()
        return rates

    def _bound_sends(self, arriving: Sequence[Enclosure]) -> None:
        """What is sent is on one side of what would be, were all vague contacts open: they push, and never pull."""
        closed, vague = self.result.branches.closed_links, self.result.branches.vague
        for alone in self.joint.clusters(closed, frozenset()):
            if not set(alone.points) <= set(self.points):
                continue
            law, pushed = alone.law, [add_terms(each) for each in alone.gather(self.forces)]
            if len(law.light) < len(pushed) or law.springs or any(each.exact is None for each in pushed):
                continue
            free = alone.spread(scatter(law, [[(ONE, each)] for each in pushed], {}))
            gained = [self._velocity_gains(n, alone) for n in vague]
            for n, end in enumerate(self.joint.ends):
                if (k := end.place) in free and self.result.sends[n].exact is None:
                    exact = add_terms(outgoing_terms(end, free[k], arriving[n])).exact
                    signs = [end.ratio * alone.ratio(k) * gains[alone.group(k)] for gains in gained]
                    least = exact if all(sign >= 0 for sign in signs) else None
                    most = exact if all(sign <= 0 for sign in signs) else None
                    self.result.sends[n] = with_bounds(self.result.sends[n], None, least, most)

    def _velocity_gains(self, n: int, cluster: Cluster) -> dict[int, fmpq]:
        """The velocities that groups without mass gain where a contact pushes with 1."""
        touch, push = self.joint.touches[n], [fmpq(0)] * len(cluster.law.mass)
        for k, factor in ((touch.right, ONE), (touch.left, -touch.ratio)):
            if k in cluster.moves:
                push[cluster.group(k)] += factor * cluster.ratio(k)
        return cluster.law.light_velocities(push, {}, exact_sum)


class ChoiceMotions:
    """Under each choice the velocities of points, and the rates and forces of contacts that are open or closed then.

    The law of the joint is one of some `laws`, and contacts are closed, or not, if `vague`. The velocities of rigid
    points are `known`, and those of others are `settled` that move like rigid ones. What friction without mass `takes`
    is anything in a range: no choice counts under which it would go back, or be beyond its limit.
    """

    def __init__(
        self,
        joint: JointState,
        laws: Sequence[JointLaw],
        points: Sequence[int],
        closed: Closed,
        vague: Closed,
        forces: Sequence[Terms],
        known: Mapping[int, Terms],
        settled: Mapping[int, Terms],
        span: arb,
    ) -> None:
        self._joint, self._span = joint, span
        self.velocities: list[dict[int, Terms]] = []
        self.rates: dict[int, list[Terms]] = {}
        self.pushes: dict[int, list[Terms]] = {}
        self.takes: dict[int, arb] = {}
        light = [n for n in sorted(vague) if not joint.is_inert(n)]  # what has mass on both sides moves as these do
        for law, (chosen, sliding) in product(laws, self._branches(light)):
            cluster = Cluster.from_law(law, points, joint.touches, closed | chosen)
            if not self._may_join(cluster, known):
                continue
            rigid = {a: known[k] for a, k in enumerate(cluster.leaders) if k in known}
            rubbed = joint.add_friction(forces, sliding)
            velocities = {**cluster.spread(scatter(cluster.law, cluster.gather(rubbed), rigid)), **settled}
            pushes = {n: cluster.pull(push, velocities, rubbed) for n, push in cluster.pushes.items()}
            rubs = [n for n in light if joint.touches[n].friction != 0]
            takes = {n: taken for n in rubs if (taken := self._take(n, sliding, velocities, pushes)) is not None}
            if len(takes) == len(rubs):
                self.velocities.append(velocities)
                self.takes |= {n: self.takes.get(n, taken).union(taken) for n, taken in takes.items()}
                for n, touch in joint.touches.items():
                    if n in pushes:
                        self.pushes.setdefault(n, []).append(pushes[n])
                    elif touch.left in velocities and touch.right in velocities:
                        self.rates.setdefault(n, []).append(touch.rate_terms(velocities))

    def of_points(self, points: Sequence[int]) -> dict[int, list[Terms]]:
        """The velocities of some points, under each choice."""
        return {k: [velocities[k] for velocities in self.velocities] for k in points}

    def sends(self, arriving: Sequence[Enclosure]) -> dict[int, list[Terms]]:
        """What ends send, under each choice."""
        ends = [(n, end) for n, end in enumerate(self._joint.ends) if all(end.place in q for q in self.velocities)]
        return {n: [outgoing_terms(end, q[end.place], arriving[n]) for q in self.velocities] for n, end in ends}

    def _branches(self, light: Sequence[int]) -> Iterator[tuple[Closed, dict[int, int]]]:
        """All that these may do: be closed or open; and what rubs: stick, or slide either way."""
        for closed in subsets(light):
            rubbing = [n for n in light if self._joint.touches[n].friction != 0 and n not in closed]
            for signs in product((1, -1), repeat=len(rubbing)):
                yield closed, dict(zip(rubbing, signs, strict=True))

    def _may_join(self, cluster: Cluster, known: Mapping[int, Terms]) -> bool:
        """Whether what sticks may be as fast at some instant as what it sticks to: see `TouchingJoint.may_join`."""
        for k in cluster.stuck_points:
            slower = scale_terms(known[cluster.leader(k)], -cluster.ratio(k))
            if k in known and not add_terms([*known[k], *slower]).evaluate_on(self._span).contains(0):
                return False
        return True

    def _take(
        self, n: int, sliding: Mapping[int, int], velocities: Mapping[int, Terms], pushes: Mapping[int, Terms]
    ) -> arb | None:
        """What friction takes under a choice, on its right side; None where the choice contradicts itself."""
        touch, limit = self._joint.touches[n], arb(self._joint.touches[n].friction)
        if sign := sliding.get(n, 0):
            rate = add_terms(touch.rate_terms(velocities)).evaluate_on(self._span)
            return None if sign * rate < 0 else -sign * limit
        force = add_terms(pushes[n]).evaluate_on(self._span)
        least, most = force.lower().max(-limit), force.upper().min(limit)
        return None if least > most else least.union(most)


def any_of(ways: Mapping[int, Sequence[Terms]], span: arb) -> dict[int, Enclosure]:
    """Functions that are, at each instant, what one choice makes them."""
    return {n: one_at_each_instant([add_terms(each) for each in functions], span) for n, functions in ways.items()}


def near_first(ways: Mapping[int, Sequence[Terms]], span: arb) -> dict[int, Enclosure]:
    """The same, as what the first choice makes them with what they may differ from it: where that is little."""
    return {n: _near_first(functions, span) for n, functions in ways.items()}


def _near_first(ways: Sequence[Terms], span: arb) -> Enclosure:
    first, apart = add_terms(ways[0]), arb(0)
    for other in ways[1:]:
        apart = apart.union(add_terms([*other, *scale_terms(ways[0], fmpq(-1))]).evaluate_on(span))
    if apart == 0:
        return first
    return Enclosure(first.polynomial + apart.mid(), (first.error + apart.rad()).upper())
