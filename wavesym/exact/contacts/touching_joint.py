"""A joint with contacts of which it is not certain which are closed when.

On a stretch so short that it does not matter which contacts are closed when, these are `vague`. Whatever they do, the
velocities of points without mass are those under one choice of closed contacts, of which there are few, and the force
of a contact is 0 or what it is under one of them. What has mass, and springs, feel a force between 0 and the largest
of these. The bound is taken for granted, and then shown to be larger than what follows from it: as velocities of masses
and displacements are continuous, no force can have been the first to pass it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.contacts.branches import Closed
from wavesym.exact.contacts.choices import ChoiceMotions, Choices, any_of, near_first
from wavesym.exact.contacts.cluster import Cluster, subsets
from wavesym.exact.contacts.joint_stretch import JointStretch, PointState
from wavesym.exact.contacts.steady_joint import SteadyJoint, group_forces, prescribed_terms, rate_terms, series_terms
from wavesym.exact.joints.enclosure import Enclosure, Terms, add_terms, scale_terms, with_bounds
from wavesym.exact.joints.joint_law import JointLaw, exact_sum, outgoing_terms, scatter

_ONE = fmpq(1)
_SLACK = fmpq(1, 2**20)
_ROUNDS = 8  # in which a bound of the forces must hold
_CLOSER = 4  # times: what friction takes is looked for again where it is known so much closer


class TouchingJoint(SteadyJoint):
    """A joint as time goes on, of whose contacts some may be vague for a while."""

    def _drift(
        self,
        cluster: Cluster,
        result: JointStretch,
        arriving: Sequence[Enclosure],
        forces: Sequence[Terms],
        acting: Sequence[fmpq_poly],
    ) -> None:
        law, points = cluster.law, cluster.points
        vague = frozenset(n for n in result.branches.vague if self.touches[n].left in points)
        closed = frozenset(n for n in result.branches.closed & self.touches.keys() if self.touches[n].left in points)
        span = arb(0).union(arb(result.length))
        prescribed = [acting[cluster.leader(a)] for a in range(len(law.mass))]
        bounds = {n: arb(0) for n in vague}
        taken = {
            n: arb(0, arb(max(touch.friction, touch.breakaway)).upper())
            for n in vague
            if (touch := self.touches[n]).friction != 0
        }
        pressing = [n for n in vague if self.touches[n].friction == 0]
        slow: dict[int, arb] = {}
        for tried in range(_ROUNDS):
            motion = self._states.balls(cluster, prescribed)
            pushes = self._add_pushes(forces, {n: bounds[n] for n in pressing}, taken)
            pushed = [add_terms(each) for each in group_forces(cluster, pushes)]
            terms = series_terms(law.fastest * result.length, max(wave.polynomial.length() for wave in pushed))
            q = motion.move(pushed, prescribed, result.length, terms)
            known = {cluster.leader(a): [(_ONE, q[a])] for a in law.heavy}
            known |= {cluster.leader(a): each for a, each in prescribed_terms(law, prescribed).items()}
            for k, rate in slow.items():
                leader, besides = cluster.leader(cluster.group(k)), (rate / arb(abs(cluster.ratio(k)))).upper()
                known[leader] = [*known.get(leader, []), (_ONE, Enclosure(arb_poly(), besides))]
            pulls = list(forces)
            for k in points:
                pulls[k] = [*forces[k], (fmpq(-1), self.forces.of_springs(cluster, motion, k))]
            choices = Choices([cluster.joint_law], points, closed, vague, known)
            found = self._try_every_choice(choices, arriving, pulls, span)
            if tried < _ROUNDS // 2 and any(force.rad() * _CLOSER < taken[n].rad() for n, force in found.takes.items()):
                taken |= found.takes
                continue
            forced = any_of(found.pushes, span)
            largest = {n: forced[n].evaluate_on(span).upper().max(arb(0)) for n in pressing}
            after = self._states.state_at_end(cluster, motion, prescribed, result.length)
            faster = self._hidden_rates(cluster, after, forced, result.length)
            seen = all(rate <= slow.get(k, arb(0)) for k, rate in faster.items())
            if seen and all(largest[n] < bounds[n] or largest[n] == 0 for n in pressing):
                break
            if not seen:
                slow = {k: (2 * rate).upper() for k, rate in faster.items()}
            bounds |= {n: (largest[n] * arb(1 + _SLACK)).upper() for n in pressing}
        else:
            raise ArithmeticError("the force of a contact has no bound")
        result.velocities |= {k: [(_ONE, each)] for k, each in any_of(found.velocities, span).items()}
        for k in points:  # what has mass moves like that under every choice, as time goes on
            if (leader := cluster.leader(cluster.group(k))) in known:
                result.velocities[k] = scale_terms(known[leader], cluster.ratio(k))
        result.sends |= any_of(found.sends, span)
        self._bound_sends(cluster, result, closed, vague, arriving, forces)
        result.rates |= any_of(found.rates, span)
        result.pushes |= forced
        result.pushes |= {
            n: force
            for n, force in self.forces.of_cluster(cluster, result, forces, acting, motion, None).items()
            if n in vague
        }
        result.state |= after
        self._strain(cluster, result, motion)
        self.stops.lose_excess(cluster, result)
        self.stops.find_rests(cluster, result)

    def _hidden_rates(
        self, cluster: Cluster, after: Mapping[int, PointState], pushes: Mapping[int, Enclosure], length: fmpq
    ) -> dict[int, arb]:
        """How fast masses that stick may be on a stretch, besides: by what is not known of them, or pulled to slide."""
        rates = {k: rate for k, rate in self._states.unseen_rates(cluster, after).items() if self.law.mass[k] != 0}
        for n in cluster.pushes:
            touch = self.touches[n]
            excess = self.stops.excess(n, pushes[n], arb(0).union(arb(length)))
            for k, factor in ((touch.right, _ONE), (touch.left, abs(touch.ratio))) if excess > 0 else ():
                if self.law.mass[k] != 0 and self.law.motions[k] is None:
                    gained = excess * arb(length * factor / self.law.mass[k])
                    rates[k] = (rates.get(k, arb(0)) + gained).upper()
        return rates

    def _bound_sends(
        self,
        cluster: Cluster,
        result: JointStretch,
        closed: Closed,
        vague: Closed,
        arriving: Sequence[Enclosure],
        forces: Sequence[Terms],
    ) -> None:
        """What is sent is on one side of what would be, were all vague contacts open: they push, and never pull."""
        if any(self.touches[n].friction != 0 for n in vague):
            return
        for alone in self._split(closed, frozenset()):
            law, points = alone.law, alone.points
            pushed = (
                [add_terms(each) for each in group_forces(alone, forces)] if set(points) <= set(cluster.points) else []
            )
            if not pushed or len(law.light) < len(pushed) or law.springs or any(each.exact is None for each in pushed):
                continue
            free = scatter(law, [[(_ONE, each)] for each in pushed], {})
            moves = dict(zip(points, law.moves, strict=True))
            gained = [self._velocity_gains(n, moves, law) for n in vague]
            for n, end in enumerate(self._ends):
                if (k := end.place) in moves and result.sends[n].exact is None:
                    group, ratio = moves[k]
                    exact = self._outgoing(n, {k: scale_terms(free[group], ratio)}, arriving[n]).exact
                    signs = [end.ratio * ratio * gains[group] for gains in gained]
                    least = exact if all(sign >= 0 for sign in signs) else None
                    most = exact if all(sign <= 0 for sign in signs) else None
                    result.sends[n] = with_bounds(result.sends[n], None, least, most)

    def _velocity_gains(self, n: int, moves: Mapping[int, tuple[int, fmpq]], law: JointLaw) -> dict[int, fmpq]:
        """The velocities that groups without mass gain where a contact pushes with 1."""
        touch, push = self.touches[n], [fmpq(0)] * len(law.mass)
        for place, factor in ((touch.right, _ONE), (touch.left, -touch.ratio)):
            if place in moves:
                group, ratio = moves[place]
                push[group] += factor * ratio
        return law.light_velocities(push, {}, exact_sum)

    def _try_every_choice(
        self, choices: Choices, arriving: Sequence[Enclosure], pulls: Sequence[Terms], span: arb
    ) -> ChoiceMotions:
        """Velocities, rates and forces, over all choices.

        And what friction without mass takes: no choice counts under which it would go back, or be beyond its limit.
        """
        points, vague, known = choices.points, choices.vague, choices.known_velocities
        ends = [n for n, end in enumerate(self._ends) if end.place in points]
        found = ChoiceMotions({k: [] for k in points}, {n: [] for n in ends}, {n: [] for n in choices.springs})
        for law, (chosen, sliding) in product(choices.laws, self._branches(vague)):
            cluster = Cluster.from_law(law, points, self.touches, choices.closed_links | chosen)
            if not _may_join(cluster, known, span):
                continue
            rigid = {a: known[k] for a in range(len(cluster.law.mass)) if (k := cluster.leader(a)) in known}
            rubbed = self._add_friction(pulls, sliding)
            q = scatter(cluster.law, group_forces(cluster, rubbed), rigid)
            moving = {k: scale_terms(q[a], ratio) for k, (a, ratio) in zip(points, cluster.law.moves, strict=True)}
            moving |= choices.settled_velocities
            forces = {
                n: self._friction_force(n, cluster, sliding, moving, rubbed, span) for n in vague if self._rubs_alone(n)
            }
            if any(force is None for force in forces.values()):
                continue
            takes = {n: found.takes.get(n, force).union(force) for n, force in forces.items() if force is not None}
            found.takes |= takes
            for k in points:
                found.velocities[k].append(moving[k])
            for n, sent in found.sends.items():
                sent.append(outgoing_terms(self._ends[n], moving[self._ends[n].place], arriving[n]))
            for n, rates in found.spring_rates.items():
                rates.append(self.springs.of_link[n].rate_terms(moving))
            for n, touch in self.touches.items():
                if n in cluster.pushes:
                    force = self.forces.pull(cluster, cluster.pushes[n], moving, rubbed)
                    found.pushes.setdefault(n, []).append(force)
                elif touch.left in moving and touch.right in moving:
                    found.rates.setdefault(n, []).append(rate_terms(touch, moving))
        return found

    def _resolve_doubts(
        self, moved: JointStretch, doubts: Mapping[int, arb], arriving: Sequence[Enclosure]
    ) -> dict[int, Enclosure]:
        """How fast springs get longer of which it is in doubt whether they act with their dashpots.

        What has mass moves the same whatever they do, what has none as under one choice of those that act: the force
        that is not known is that of the dashpots, and makes the velocity smaller that it comes from. Besides these the
        forces of springs are wrong by their `doubts`. What else follows from velocities is known as closely then.
        """
        span, points = arb(0).union(arb(moved.length)), range(len(self.law.mass))
        pulls = [[*terms, (fmpq(-1), moved.elastic[k])] for k, terms in enumerate(moved.acting)]
        self.springs.add_unknown(pulls, doubts)
        acting = self.springs.select(moved.branches.closed)
        touching = moved.branches.closed - acting
        laws = [self._law_of(acting ^ other) for other in subsets(doubts)]
        together = Cluster.from_law(laws[0], points, self.touches, touching)
        known = {k: moved.velocities[k] for k in points if self.law.mass[k] != 0 or self.law.motions[k] is not None}
        settled = {k: moved.velocities[k] for k in points if together.leader(together.group(k)) in known}
        choices = Choices(laws, points, touching, moved.branches.vague, known, settled, tuple(doubts))
        found = self._try_every_choice(choices, arriving, pulls, span)
        if not together.stuck_points:
            free = {k: ways for k, ways in found.velocities.items() if k not in settled}
            for k, closer in near_first(free, span).items():
                if closer.error < add_terms(moved.velocities[k]).error:
                    moved.velocities[k] = [(_ONE, closer)]
            pressing = {n: ways for n, ways in found.pushes.items() if self.touches[n].friction == 0}
            for before, ways in ((moved.sends, found.sends), (moved.rates, found.rates), (moved.pushes, pressing)):
                close = near_first({n: each for n, each in ways.items() if n in before}, span)
                before |= {n: each for n, each in close.items() if each.error < before[n].error}
        return near_first(found.spring_rates, span)

    def _rubs_alone(self, n: int) -> bool:
        """Whether what rubs has a side without mass: its joint has no other corner then."""
        return self.touches[n].friction != 0 and not self.is_inert(n)

    def _friction_force(
        self,
        n: int,
        cluster: Cluster,
        sliding: Mapping[int, int],
        velocities: Mapping[int, Terms],
        forces: Sequence[Terms],
        span: arb,
    ) -> arb | None:
        """What friction takes under a choice, on its right side; None where the choice contradicts itself."""
        limit = arb(self.touches[n].friction)
        if sign := sliding.get(n, 0):
            rate = add_terms(rate_terms(self.touches[n], velocities)).evaluate_on(span)
            return None if sign * rate < 0 else -sign * limit
        force = add_terms(self.forces.pull(cluster, cluster.pushes[n], velocities, forces)).evaluate_on(span)
        least, most = force.lower().max(-limit), force.upper().min(limit)
        return None if least > most else least.union(most)

    def _branches(self, vague: Closed) -> list[tuple[Closed, dict[int, int]]]:
        """All that vague contacts may do: be closed or open; and what rubs: stick, or slide either way.

        What rubs where both sides have mass, or move as is given, moves as these do whatever it does.
        """
        light = [n for n in sorted(vague) if not self.is_inert(n)]
        found = []
        for closed in subsets(light):
            rubbing = [n for n in light if self.touches[n].friction != 0 and n not in closed]
            found += [
                (closed, dict(zip(rubbing, signs, strict=True))) for signs in product((1, -1), repeat=len(rubbing))
            ]
        return found

    def is_inert(self, n: int) -> bool:
        """Whether what rubs has no side without mass, so that it slides no other way at once."""
        touch = self.touches[n]
        return touch.friction != 0 and all(
            self.law.mass[k] != 0 or self.law.motions[k] is not None for k in (touch.left, touch.right)
        )

    def _add_pushes(self, forces: Sequence[Terms], bounds: Mapping[int, arb], taken: Mapping[int, arb]) -> list[Terms]:
        """With contacts that push with anything between 0 and their bounds, and what friction takes."""
        result = list(forces)
        pushes = {n: arb((bound / 2).upper(), (bound / 2).upper()) for n, bound in bounds.items()}
        for n, push in (pushes | dict(taken)).items():
            between = Enclosure(arb_poly([push.mid()]), push.rad())
            result[self.touches[n].right] = [*result[self.touches[n].right], (_ONE, between)]
            result[self.touches[n].left] = [*result[self.touches[n].left], (-self.touches[n].ratio, between)]
        return result


def _may_join(cluster: Cluster, known: Mapping[int, Terms], span: arb) -> bool:
    """Whether what sticks may be as fast at some instant as what it sticks to: see `SteadyJoint.may_join`."""
    for k in cluster.stuck_points:
        slower = scale_terms(known[cluster.leader(cluster.group(k))], -cluster.ratio(k))
        if k in known and not add_terms([*known[k], *slower]).evaluate_on(span).contains(0):
            return False
    return True
