"""Points of a joint that move on their own while some contacts are closed and the others open.

What rubs and sticks is closed, too: its two sides move as one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, combinations

from flint import fmpq

from wavesym.errors import WavesymError
from wavesym.exact.contacts.branches import Closed
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.joints.relaxation import Relaxation


@dataclass(frozen=True)
class Touch:
    """A contact between two points of a joint, told by their places in it: closed, right moves `ratio` times left.

    Where it has `friction` it takes that much against sliding, and at rest up to `breakaway`, where that is not 0.
    """

    left: int
    right: int
    ratio: fmpq
    friction: fmpq
    breakaway: fmpq

    @property
    def sides(self) -> tuple[int, int]:
        """Its two points."""
        return self.left, self.right


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
    def from_law(cls, law: JointLaw, points: Sequence[int], touches: Mapping[int, Touch], closed: Closed) -> Cluster:
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
        local = {k: n for n, k in enumerate(points)}
        grouped = law.restrict(points).group([members[k] for k in points], [local[k] for k in leaders])
        return cls(tuple(points), grouped, pushes, law, inertia, tuple(k for k in heavy if k not in leaders))

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

    def group(self, point: int) -> int:
        """The group of one of its points."""
        return self.law.moves[self.points.index(point)][0]

    def ratio(self, point: int) -> fmpq:
        """How fast a point moves in its group."""
        return self.law.moves[self.points.index(point)][1]

    def leader(self, group: int) -> int:
        """The point that a group moves like."""
        return self.points[self.law.leaders[group]]


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
