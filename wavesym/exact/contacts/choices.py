"""How fast the points of a joint are on a short stretch, under one of a few choices at a time of what is in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from flint import arb, fmpq

from wavesym.exact.contacts.branches import Closed
from wavesym.exact.contacts.cluster import Cluster, subsets
from wavesym.exact.contacts.joint_state import JointState
from wavesym.exact.joints.enclosure import Enclosure, Terms, add_terms, one_at_each_instant, scale_terms
from wavesym.exact.joints.joint_law import JointLaw, outgoing_terms, scatter


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
