"""Springs whose laws have corners, each on one branch of it: what they do, and what is not known of that.

A spring on one side acts while it is longer (or shorter) than its gap lets it be, else it idles. One that yields holds,
as any spring, while its pull is within its limits; at a limit it yields, with that force, as long as it goes on that
way. So the force is continuous in time, and it is not asked which branch the true motion is on: what is computed keeps
to its branch until that is certainly wrong. How far it is from its guard then, x, and what is not known of its stretch,
make its force wrong by K x at most, which is taken for a force that is not known (`docs/contacts.md`).

While a spring acts, it is longer than unstrained by what its points say and a `shift`. What is not known of that when
it begins to act, r, is energy not known, K r^2 / 2, which grows no more while it acts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.contacts.branches import Branches, Closed
from wavesym.exact.contacts.cluster import Cluster, Pair, PointState
from wavesym.exact.contacts.crossing import shortfall
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.joints.enclosure import UNIT, Enclosure, Terms, add_terms
from wavesym.mechanics.network import Link, Network
from wavesym.numbers.doubles import middle


@dataclass(frozen=True)
class SpringState:
    """How much longer a spring is: than at tau = 0, or, where it yields, than without force; exact if it is a fraction.

    `shift` is how much more than its points are apart, while it acts or holds; None where it does not.
    """

    stretch: fmpq | arb
    shift: fmpq | None = None

    @property
    def is_exact(self) -> bool:
        """Whether it is known exactly how long it is."""
        return isinstance(self.stretch, fmpq)

    @property
    def error(self) -> arb:
        """How far off the middle of its stretch may be."""
        stretch = arb(self.stretch)
        return abs(stretch - stretch.mid()).upper()

    def grow(self, rate: Enclosure, length: fmpq) -> Enclosure:
        """How long it is on a stretch of time, where it gets longer at a `rate`."""
        if isinstance(self.stretch, fmpq) and rate.exact is not None:
            return Enclosure.from_polynomial(rate.exact.integral() + self.stretch)
        error = (rate.error * arb(length) + self.error).upper()
        return self.with_onset(Enclosure(rate.polynomial.integral() + arb(self.stretch).mid(), error), rate)

    def with_onset(self, stretch: Enclosure, rate: Enclosure) -> Enclosure:
        """How long it is, with how that begins where it gets longer at a `rate`, if both are known exactly at first."""
        if stretch.exact is not None or not isinstance(self.stretch, fmpq) or rate.begins is None:
            return stretch
        return replace(stretch, onset=rate.begins.integral(self.stretch))


@dataclass(frozen=True)
class SpringMotion:
    """A spring on a stretch of time: its `stretch`, and the guards of its branch, which should not be negative.

    Of what yields, where its limit is not reached for certain at the start, `reach` is positive as soon as it is.
    """

    stretch: Enclosure
    guards: tuple[Enclosure, ...]
    limit: fmpq = field(default_factory=fmpq)
    reach: Enclosure | None = None

    @property
    def clears(self) -> tuple[Enclosure, ...]:
        """What is soon positive for certain, where it is not at the start."""
        return self.guards if self.reach is None else (*self.guards, self.reach)

    def at_end(self, length: fmpq, shift: fmpq | None = None) -> SpringState:
        """Its state at the end of a stretch, on which it acted with a shift, if it did."""
        if self.stretch.exact is not None:
            return SpringState(self.stretch.exact(length), shift)
        if self.reach is not None and self.reach.evaluate(length) > 0 and self.excess(length) == 0:
            return SpringState(self.limit, shift)
        return SpringState(self.stretch.evaluate(length), shift)

    def excess(self, length: fmpq) -> arb:
        """How far a guard may be below 0."""
        most = arb(0)
        for guard in self.guards:
            most = most.max(shortfall(guard, length))
        return most


@dataclass(frozen=True)
class CornerSpring(Pair):
    """A spring with a corner between two points of a joint.

    `rest` is how much longer it is than at tau = 0 where it has no force. One that yields is longer than without force
    by `start` at first. A `dashpot` acts while the spring does, on one side.
    """

    stiffness: fmpq
    side: int
    gap: fmpq
    limits: tuple[fmpq, fmpq]
    start: fmpq
    dashpot: fmpq = field(default_factory=fmpq)

    @classmethod
    def from_link(cls, link: Link, place: Mapping[int, int]) -> CornerSpring:
        """That of a link, where points have these places."""
        limits = link.limits or (fmpq(0), fmpq(0))
        start = link.preload / link.stiffness
        left, right, dashpot = place[link.left], place[link.right], link.damping - link.steady_damping
        return cls(left, right, link.ratio, link.stiffness, link.side, link.gap, limits, start, dashpot)

    @property
    def rest(self) -> fmpq:
        """How long it is without force, and yields nothing."""
        return self.side * self.gap

    @property
    def most(self) -> tuple[fmpq, fmpq]:
        """The stretches at which it yields: when pulled, and when pushed."""
        pull, push = self.limits
        return pull / self.stiffness, -push / self.stiffness

    def is_opposite(self, other: CornerSpring) -> bool:
        """Whether this one and another act between the same points, on two sides: never both at once."""
        same = (self.left, self.right, self.ratio, self.side) == (other.left, other.right, other.ratio, -other.side)
        return same and self.side != 0 and self.gap + other.gap >= 0

    def limit_force(self, sign: int) -> fmpq:
        """With how much it pulls where it yields."""
        return self.limits[0] if sign > 0 else -self.limits[1]

    def rate(self, velocities: Mapping[int, Terms]) -> Enclosure:
        """How fast it gets longer."""
        return add_terms(self.rate_terms(velocities))

    def steady_motion(self, stretch: Enclosure, acts: bool) -> SpringMotion:
        """A stretch of time on which it acts, or holds; or idles."""
        if self.side != 0:
            way = fmpq(1 if acts else -1)
            return SpringMotion(stretch, (add_terms([(way * self.side, stretch), (-way * self.gap, UNIT)]),))
        most, least = self.most
        guards = (add_terms([(most, UNIT), (fmpq(-1), stretch)]), add_terms([(-least, UNIT), (fmpq(1), stretch)]))
        return SpringMotion(stretch, guards)

    def yielding_motion(self, state: SpringState, sign: int, rate: Enclosure, length: fmpq) -> SpringMotion:
        """A stretch of time on which it yields one way, and gets longer at a `rate`."""
        limit = self.most[0 if sign > 0 else 1]
        reached = state.is_exact and state.stretch == limit
        off = arb(0) if reached else abs(arb(state.stretch) - arb(limit)).upper()
        stretch = Enclosure(arb_poly([arb(limit).mid()]), (off + abs(arb(limit) - arb(limit).mid())).upper())
        forward = add_terms([(fmpq(sign), rate)])
        if off == 0:
            return SpringMotion(Enclosure.from_polynomial(fmpq_poly([limit])), (forward,))
        error = (forward.error * arb(length)).upper()
        reach = Enclosure(forward.polynomial.integral() - off, error)
        return SpringMotion(stretch, (forward,), limit, reach)


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
        self._state = {n: SpringState(spring.start) for n, spring in self.of_link.items()}

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

    def select_between(self, links: Closed, points: Sequence[int]) -> Closed:
        """Of these springs, those between some points."""
        return frozenset(n for n in links if self.of_link[n].left in points)

    # what acts on points

    def shift(self, n: int) -> fmpq:
        """How much longer one is than its points are apart, while it acts: as before, or from now on."""
        spring, state = self.of_link[n], self._state[n]
        if state.shift is not None:
            return state.shift
        left, right = (self._points[k] for k in spring.sides)
        if isinstance(state.stretch, fmpq) and left.exact is not None and right.exact is not None:
            return state.stretch - right.place + spring.ratio * left.place
        return middle(arb(state.stretch)) - middle(right.displacement) + spring.ratio * middle(left.displacement)

    def add_pulls(self, forces: list[Terms], branches: Branches) -> None:
        """Add to forces on points what springs pull, besides what displacements of points make of it."""
        for n, spring in self.of_link.items():
            closed, sign = branches.of_link(n)
            if closed:
                spring.push(forces, [(spring.stiffness * (spring.rest - self.shift(n)), UNIT)])
            elif sign:
                spring.push(forces, [(-spring.limit_force(sign), UNIT)])

    def add_unknown(self, forces: list[Terms], unknown: Mapping[int, arb]) -> None:
        """Add what springs pull besides, which is known to be no more than this."""
        for n, force in unknown.items():
            if force != 0:
                self.of_link[n].push(forces, [(fmpq(-1), Enclosure(arb_poly(), force))])

    # how long they are

    def strain(self, result: JointStretch, apart: Mapping[int, Enclosure]) -> None:
        """How springs that act get longer on a stretch, from how far apart their points are."""
        for n, known in apart.items():
            spring, state, shift = self.of_link[n], self._state[n], self.shift(n)
            if known.exact is not None:
                stretch = Enclosure.from_polynomial(known.exact + shift)
            else:
                rate = spring.rate(result.velocities)
                stretch = state.with_onset(Enclosure(known.polynomial + arb(shift), known.error), rate)
                grown = state.grow(rate, result.length)
                if spring.dashpot != 0 and grown.error < stretch.error:  # of what has just engaged
                    stretch = grown
            self._note(n, result, spring.steady_motion(stretch, acts=True), shift)

    def strain_others(self, result: JointStretch) -> None:
        """How those that do not act get longer, as the velocities of all points are known."""
        for n, spring in self.of_link.items():
            if n not in result.branches.closed_links:
                state, rate, sign = self._state[n], spring.rate(result.velocities), result.branches.sliding.get(n, 0)
                if sign:
                    moving = spring.yielding_motion(state, sign, rate, result.length)
                else:
                    moving = spring.steady_motion(state.grow(rate, result.length), acts=False)
                self._note(n, result, moving, None)

    def follow(self, result: JointStretch, rates: Mapping[int, Enclosure]) -> None:
        """Know how these get longer from how fast, which is known more closely than of their points."""
        for n, rate in rates.items():
            stretch, acts = self._state[n].grow(rate, result.length), n in result.branches.closed_links
            self._note(n, result, self.of_link[n].steady_motion(stretch, acts), result.springs[n].shift)

    @staticmethod
    def _note(n: int, result: JointStretch, moving: SpringMotion, shift: fmpq | None) -> None:
        """Note how one moves on a stretch, and its state at the end."""
        result.spring_motions[n], result.springs[n] = moving, moving.at_end(result.length, shift)

    def reach_beyond(self, n: int) -> arb:
        """How far beyond its gap one that acts on one side may be, at the start of a stretch; at least 0."""
        spring = self.of_link[n]
        return (spring.side * arb(self._state[n].stretch) - arb(spring.gap)).upper().max(arb(0))

    def hold_back(self, moved: JointStretch, most: Mapping[int, arb]) -> None:
        """Know how far beyond their gaps some get at most that idle, as far as is known, on a stretch."""
        for n, beyond in most.items():
            side, last = self.of_link[n].side, arb(self.of_link[n].gap) + beyond
            reached = side * arb(moved.springs[n].stretch)
            if not reached < last:
                moved.springs[n] = replace(moved.springs[n], stretch=side * reached.lower().union(last.upper()))

    # what is not known

    def doubts(self, moved: JointStretch) -> dict[int, arb]:
        """Of springs with dashpots those that may be on the other branch: how wrong their forces are without these."""
        damped = [n for n, spring in self.of_link.items() if spring.dashpot != 0]
        wrong = self.wrong_forces(moved) if damped else {}
        return {n: wrong[n] for n in damped if wrong[n] != 0}

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
            elif not state.is_exact:
                moved.springs[n] = SpringState(arb(state.stretch) + arb(0, flow))
        return lost

    def are_exact(self, cluster: Cluster) -> bool:
        """Whether it is known exactly how long the springs are that act in a cluster."""
        return all(self._state[n].is_exact for n in cluster.springs)

    def energy(self, cluster: Cluster) -> arb:
        """What is not known, as energy, of springs that begin to act in a cluster; at most."""
        begin = [n for n in cluster.springs if self._state[n].shift is None]
        root = sum(((arb(self.of_link[n].stiffness) / 2).sqrt() * self._state[n].error for n in begin), arb(0))
        return (root**2).upper()
