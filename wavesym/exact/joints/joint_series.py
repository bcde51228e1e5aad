"""The motion of a joint as a power series, in exact numbers or in balls."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from itertools import count
from typing import Protocol, TypeVar

from flint import arb, fmpq

from wavesym.exact.joints.joint_law import JointLaw

Number = TypeVar("Number", fmpq, arb)
Coefficient = TypeVar("Coefficient", covariant=True)


class Powers(Protocol[Coefficient]):
    """The coefficients of a function, by powers: as many as are read."""

    def __getitem__(self, power: int, /) -> Coefficient: ...


def motion_series(
    law: JointLaw,
    velocity: Sequence[Number],
    displacement: Sequence[Number],
    forces: Sequence[Powers[Number]],
    prescribed: Sequence[Powers[Number]],
    number: Callable[[fmpq], Number],
    kept: Callable[[Number], Number],
) -> Iterator[tuple[list[list[Number]], list[list[Number]], Mapping[int, Number]]]:
    """The motion of a joint in powers of the time since some instant, from M q' + C q + K u = s and u' = q.

    Args:
        law: M, C and K.
        velocity: of groups, at that instant.
        displacement: of points, at that instant.
        forces: s on groups, by powers.
        prescribed: velocities of the groups whose motion is given, by powers.
        number: makes one of the arithmetic: exact, or a ball.
        kept: what is kept of a coefficient: all of it, or its middle.

    Yields:
        For n = 0, 1, ... the first n coefficients of q and, where there are springs, n + 1 of u; of groups with mass
        the next one of q. Lists are those of before, and longer.
    """
    size = range(len(law.mass))
    q: list[list[Number]] = [[] for _ in size]
    u = [[value] for value in displacement]

    def pulls(k: int, without: Collection[int] = ()) -> list[tuple[Number, list[Number]]]:
        """What else acts on a point: factors of velocities, but of some, and of displacements."""
        slow = [(number(c), q[b]) for b, c in enumerate(law.damping[k]) if c != 0 and b not in without]
        return slow + [(number(c), u[b]) for b, c in enumerate(law.stiffness[k]) if c != 0]

    given = [(q[k], prescribed[k]) for k in size if law.motions[k] is not None]
    light = [(forces[k], pulls(k, law.light)) for k in law.light]
    found = [(q[k], [number(law.inverse[row, b]) for b in range(len(light))]) for row, k in enumerate(law.light)]
    heavy = [(k, q[k], forces[k], pulls(k), number(law.mass[k])) for k in law.heavy]
    last = {k: velocity[k] for k in law.heavy}
    moves = [(u[k], q[group], number(ratio)) for k, (group, ratio) in enumerate(law.moves)] if law.springs else []
    for n in count():
        yield q, u, last
        for series, known in given:
            series.append(known[n])
        for k, series, *_ in heavy:
            series.append(last[k])
        right = [_subtract_pulls(force[n], pulled, n) for force, pulled in light]
        for series, shares in found:
            series.append(kept(dot(shares, right)))
        for k, _, force, pulled, mass in heavy:
            last[k] = kept(_subtract_pulls(force[n], pulled, n) / (mass * (n + 1)))
        for places, series, ratio in moves:
            places.append(kept(ratio * series[n] / (n + 1)))


def dot(one: Sequence[Number], other: Sequence[Number]) -> Number:
    """A sum of products of at least one pair."""
    total = one[0] * other[0]
    for a, b in zip(one[1:], other[1:], strict=True):
        total += a * b
    return total


def _subtract_pulls(value: Number, pulls: Sequence[tuple[Number, Sequence[Number]]], n: int) -> Number:
    """A power of a force without what pulls."""
    for factor, series in pulls:
        value -= factor * series[n]
    return value
