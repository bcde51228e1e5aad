"""The points of a joint, and those that move on their own while some contacts are closed and the others open.

What rubs and sticks is closed, too: its two sides move as one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, combinations

from flint import arb, fmpq

from wavesym.errors import WavesymError
from wavesym.exact.contacts.branches import Closed
from wavesym.exact.joints.enclosure import Terms, scale_terms
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.joints.relaxation import Relaxation


@dataclass(frozen=True)
class PointState:
    """How fast a point is, and where: exact where that is known, and the energy of the error of its set.

    Or, that of it and all `companions` together, with which it moved on the last stretch.
    """

    velocity: arb
    displacement: arb
    exact: tuple[fmpq, fmpq] | None
    error_energy: arb
    companions: frozenset[int] = frozenset()

    @property
    def place(self) -> fmpq:
        """The displacement, where it is known exactly."""
        assert self.exact is not None
        return self.exact[1]

    @classmethod
    def from_exact(cls, velocity: fmpq, displacement: fmpq) -> PointState:
        """Known exactly."""
        return cls(arb(velocity), arb(displacement), (velocity, displacement), arb(0))

    def lose(self, energy: arb) -> PointState:
        """The same, by so much energy less known."""
        error_energy = ((self.error_energy.sqrt() + energy.sqrt()) ** 2).upper()
        return replace(self, exact=None, error_energy=error_energy)


@dataclass(frozen=True)
class Pair:
    """Two points of a joint, by their places in it, with a law for how the right one moves less `ratio` the left."""

    left: int
    right: int
    ratio: fmpq

    @property
    def sides(self) -> tuple[int, int]:
        """Its two points."""
        return self.left, self.right

    def rate_terms(self, velocities: Mapping[int, Terms]) -> Terms:
        """How fast the right one moves, less what the left one does times the ratio."""
        return [*velocities[self.right], *scale_terms(velocities[self.left], -self.ratio)]

    def push(self, forces: list[Terms], terms: Terms) -> None:
        """Add a force to those on points: it pushes the right one forwards and the left one backwards."""
        forces[self.right] = [*forces[self.right], *terms]
        forces[self.left] = [*forces[self.left], *scale_terms(terms, -self.ratio)]


@dataclass(frozen=True)
class Touch(Pair):
    """A contact: closed, right moves `ratio` times left.

    Where it has `friction` it takes that much against sliding, and at rest up to `breakaway`, where that is not 0.
    """

    friction: fmpq
    breakaway: fmpq


@dataclass(frozen=True)
class Cluster:
    """The points, their law with closed contacts, and for each of these the points and factors that make its force.

    A contact pushes with N = sum over these of factor (C q + K u - s), of what is on one side of it. Where that has
    mass m, as it sticks to what moves as given, there is m times the acceleration of that too: `inertia`. Where it
    sticks to another mass, M with its own, the sum over both sides, times m/M, is taken off. `stuck_points` are
    those with mass that stick, `springs` the links whose springs act in it. The `joint_law` is that of all points of
    the joint, each on its own, with these springs.
    """

    points: tuple[int, ...]
    law: JointLaw
    pushes: Mapping[int, Sequence[tuple[int, fmpq]]]
    joint_law: JointLaw
    inertia: Mapping[int, fmpq]
    stuck_points: tuple[int, ...] = ()
    springs: Closed = frozenset()

    @classmethod
    def from_law(
        cls,
        law: JointLaw,
        points: Sequence[int],
        touches: Mapping[int, Touch],
        closed: Closed,
        springs: Closed = frozenset(),
    ) -> Cluster:
        """From the law of the joint with all contacts open. WavesymError where two rigid bodies would touch."""
        rigid = [k for k in points if law.motions[k] is not None]
        heavy = [k for k in points if law.motions[k] is None and law.mass[k] != 0]
        ways: dict[int, list[tuple[int, fmpq]]] = {k: [] for k in points}
        inside = [n for n in closed if touches[n].left in ways]
        for n in inside:
            ways[touches[n].left].append((touches[n].right, touches[n].ratio))
            ways[touches[n].right].append((touches[n].left, 1 / touches[n].ratio))
        members: dict[int, tuple[int, fmpq]] = {}
        leaders: list[int] = []

        rubs = any(touches[n].friction != 0 for n in inside)
        for leader in chain(rigid, heavy, points):
            if leader not in members:
                members |= {k: (len(leaders), ratio) for k, ratio in _moving(leader, ways)}
                leaders.append(leader)
            elif leader not in leaders and (leader in rigid or (leader in heavy and not rubs)):
                raise WavesymError("contacts: two rigid bodies would touch each other; write a rod between them")
        pushes, inertia = {}, {}
        for n in inside:
            touch = touches[n]
            cut = {k: [(j, r) for j, r in way if {k, j} != {touch.left, touch.right}] for k, way in ways.items()}
            side, sign = [k for k, _ in _moving(touch.right, cut)], fmpq(1)
            if leaders[members[touch.right][0]] in side:
                side, sign = [k for k, _ in _moving(touch.left, cut)], fmpq(-1)
            share = sign / members[touch.right][1]
            pushes[n] = [(k, share * members[k][1]) for k in side]
            if heavier := sum((members[k][1] ** 2 * law.mass[k] for k in side), fmpq(0)):
                group = members[touch.right][0]
                among = [(k, ratio) for k, (other, ratio) in members.items() if other == group]
                if law.motions[leaders[group]] is not None:
                    inertia[n] = share * heavier
                else:
                    mass = sum((ratio**2 * law.mass[k] for k, ratio in among), fmpq(0))
                    pushes[n] += [(k, -share * heavier / mass * ratio) for k, ratio in among]
        grouped = law.group(points, members, leaders)
        stuck = tuple(k for k in heavy if k not in leaders)
        return cls(tuple(points), grouped, pushes, law, inertia, stuck, springs)

    @property
    def stateless(self) -> bool:
        """Whether what it does depends on nothing but what acts now."""
        return not (self.law.heavy or any(value != 0 for row in self.law.elastic for value in row))

    @cached_property
    def relaxations(self) -> tuple[Relaxation, ...]:
        """How it moves when all that is fast has died away.

        A body alone that presses on a contact is let die away as it does: the sign of its force stays known.
        """
        return () if self.pushes and len(self.law.mass) == 1 and not self.law.springs else Relaxation.separate(self.law)

    @cached_property
    def moves(self) -> Mapping[int, tuple[int, fmpq]]:
        """The group of each point, and how fast the point moves in it."""
        return dict(zip(self.points, self.law.moves, strict=True))

    @cached_property
    def leaders(self) -> tuple[int, ...]:
        """The points that groups move like."""
        return tuple(self.points[k] for k in self.law.leaders)

    def group(self, point: int) -> int:
        """The group of one of its points."""
        return self.moves[point][0]

    def ratio(self, point: int) -> fmpq:
        """How fast a point moves in its group."""
        return self.moves[point][1]

    def leader(self, point: int) -> int:
        """The point that the group of a point moves like."""
        return self.leaders[self.group(point)]

    def spread(self, velocities: Sequence[Terms]) -> dict[int, Terms]:
        """The velocities of its points, from those of groups."""
        return {k: scale_terms(velocities[group], ratio) for k, (group, ratio) in self.moves.items()}

    def gather(self, forces: Sequence[Terms]) -> list[Terms]:
        """What acts on its groups, from what acts on points."""
        terms: list[Terms] = [[] for _ in self.law.mass]
        for k, (group, ratio) in self.moves.items():
            terms[group] += scale_terms(forces[k], ratio)
        return terms

    def pull(self, push: Sequence[tuple[int, fmpq]], velocities: Mapping[int, Terms], forces: Sequence[Terms]) -> Terms:
        """The force of a closed contact that such factors of points make, but for what springs do."""
        terms: Terms = []
        for k, factor in push:
            terms += scale_terms(forces[k], -factor)
            for j in self.points:
                terms += scale_terms(velocities[j], factor * self.joint_law.damping[k][j])
        return terms


def _moving(start: int, ways: Mapping[int, Sequence[tuple[int, fmpq]]]) -> Iterator[tuple[int, fmpq]]:
    """The points that move with one, and how fast."""
    known = {start}
    coming = [(start, fmpq(1))]
    while coming:
        here, ratio = coming.pop()
        yield here, ratio
        for other, factor in ways[here]:
            if other not in known:
                known.add(other)
                coming.append((other, ratio * factor))


def subsets(contacts: Iterable[int]) -> list[Closed]:
    """All choices of some contacts, small ones first."""
    every = sorted(contacts)
    return [frozenset(some) for size in range(len(every) + 1) for some in combinations(every, size)]


def connected_sets(law: JointLaw, touches: Mapping[int, Touch], linked: Closed) -> list[list[int]]:
    """The points of a joint in sets that nothing connects: no spring, no dashpot, none of these contacts."""
    size = len(law.mass)
    near: list[set[int]] = [
        {j for j in range(size) if law.damping[k][j] != 0 or law.stiffness[k][j] != 0} | {k} for k in range(size)
    ]
    for n in linked:
        near[touches[n].left].add(touches[n].right)
        near[touches[n].right].add(touches[n].left)
    sets: list[list[int]] = []
    left = set(range(size))
    while left:
        found, coming = set(), {min(left)}
        while coming:
            found |= coming
            coming = {j for k in coming for j in near[k]} - found
        sets.append(sorted(found))
        left -= found
    return sets
