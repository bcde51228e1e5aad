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

from collections.abc import Mapping
from dataclasses import dataclass, field

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.contacts.cluster import Pair, PointState
from wavesym.exact.contacts.crossing import shortfall
from wavesym.exact.joints.enclosure import UNIT, Enclosure, Onset, Terms, add_terms
from wavesym.mechanics.network import Link
from wavesym.numbers.doubles import middle


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

    def extension(self, points: Mapping[int, PointState]) -> tuple[fmpq, bool]:
        """How far apart its points are by their displacements, the middles of them; and whether that is exact."""
        left, right = points[self.left], points[self.right]
        if left.exact is not None and right.exact is not None:
            return right.exact[1] - self.ratio * left.exact[1], True
        return middle(right.displacement) - self.ratio * middle(left.displacement), False

    def rate(self, velocities: Mapping[int, Terms]) -> Enclosure:
        """How fast it gets longer."""
        return add_terms(self.rate_terms(velocities))


@dataclass(frozen=True)
class SpringState:
    """How much longer a spring is: than at tau = 0, or, where it yields, than without force; exact where that is known.

    `shift` is how much more than its points are apart, while it acts or holds; None where it does not.
    """

    stretch: arb
    exact: fmpq | None
    shift: fmpq | None = None

    @classmethod
    def from_exact(cls, stretch: fmpq) -> SpringState:
        """Known exactly."""
        return cls(arb(stretch), stretch)

    def begin(self, spring: CornerSpring, points: Mapping[int, PointState]) -> SpringState:
        """The same, acting."""
        if self.shift is not None:
            return self
        apart, exact = spring.extension(points)
        if self.exact is not None and exact:
            return SpringState(self.stretch, self.exact, self.exact - apart)
        return SpringState(self.stretch, None, middle(self.stretch) - apart)

    def onset(self, rate: Enclosure) -> Onset | None:
        """How the stretch goes on at a `rate`, where both are known exactly at first."""
        return None if self.exact is None or rate.begins is None else rate.begins.integral(self.exact)

    def grow(self, rate: Enclosure, length: fmpq) -> Enclosure:
        """How long it is on a stretch of time, where it gets longer at a `rate`."""
        if self.exact is not None and rate.exact is not None:
            return Enclosure.from_polynomial(rate.exact.integral() + self.exact)
        error = (rate.error * arb(length) + self.error).upper()
        return Enclosure(rate.polynomial.integral() + self.stretch.mid(), error, onset=self.onset(rate))

    @property
    def shift_known(self) -> fmpq:
        """That of a spring that acts."""
        assert self.shift is not None
        return self.shift

    @property
    def error(self) -> arb:
        """How far off the middle of its stretch may be."""
        return abs(self.stretch - self.stretch.mid()).upper()


@dataclass(frozen=True)
class SpringMotion:
    """A spring on a stretch of time: its `stretch`, and the guards of its branch, which should not be negative.

    Of what yields, where its limit is not reached for certain at the start, `reach` is positive as soon as it is.
    """

    stretch: Enclosure
    guards: tuple[Enclosure, ...]
    limit: fmpq | None = None
    reach: Enclosure | None = None

    @property
    def clears(self) -> tuple[Enclosure, ...]:
        """What is soon positive for certain, where it is not at the start."""
        return self.guards if self.reach is None else (*self.guards, self.reach)

    def at_end(self, length: fmpq) -> SpringState:
        """Its state at the end of a stretch, as if it did not act any more."""
        if self.stretch.exact is not None:
            return SpringState.from_exact(self.stretch.exact(length))
        if (
            self.limit is not None
            and self.reach is not None
            and self.reach.evaluate(length) > 0
            and self.excess(length) == 0
        ):
            return SpringState.from_exact(self.limit)
        return SpringState(self.stretch.evaluate(length), None)

    def excess(self, length: fmpq) -> arb:
        """How far a guard may be below 0."""
        most = arb(0)
        for guard in self.guards:
            most = most.max(shortfall(guard, length))
        return most


def acting_motion(spring: CornerSpring, stretch: Enclosure) -> SpringMotion:
    """A spring that acts, or holds."""
    if spring.side != 0:
        return SpringMotion(stretch, (add_terms([(fmpq(spring.side), stretch), (-spring.gap, UNIT)]),))
    most, least = spring.most
    guards = (add_terms([(most, UNIT), (fmpq(-1), stretch)]), add_terms([(-least, UNIT), (fmpq(1), stretch)]))
    return SpringMotion(stretch, guards)


def idle_motion(spring: CornerSpring, state: SpringState, rate: Enclosure, length: fmpq) -> SpringMotion:
    """A spring on one side that does not act, and gets longer at a `rate`."""
    stretch = state.grow(rate, length)
    return SpringMotion(stretch, (add_terms([(spring.gap, UNIT), (fmpq(-spring.side), stretch)]),))


def yielding_motion(spring: CornerSpring, state: SpringState, sign: int, rate: Enclosure, length: fmpq) -> SpringMotion:
    """A spring that yields one way, and gets longer at a `rate`."""
    limit = spring.most[0 if sign > 0 else 1]
    off = abs(state.stretch - arb(limit)).upper() if state.exact != limit else arb(0)
    stretch = Enclosure(arb_poly([arb(limit).mid()]), (off + abs(arb(limit) - arb(limit).mid())).upper())
    forward = add_terms([(fmpq(sign), rate)])
    if off == 0:
        return SpringMotion(Enclosure.from_polynomial(fmpq_poly([limit])), (forward,))
    error = (forward.error * arb(length)).upper()
    reach = Enclosure(forward.polynomial.integral() - off, error)
    return SpringMotion(stretch, (forward,), limit, reach)
