"""The motion of a joint as a power series, in balls or in rational numbers: all powers where it is a polynomial.

Rational data in free flight, or at rest, stay exact. Once nothing acts any more and the state's next powers are all 0,
so are all that follow, and the series is the motion itself. Otherwise it has no end; then the first powers tell how the
motion begins, and derivatives of the velocities, which come one after another from M q' + C q + K u = s as do their
bounds, what follows.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from itertools import count, islice
from math import factorial, inf
from typing import Protocol, TypeVar

from flint import arb, fmpq, fmpq_poly

from wavesym.exact.joints.enclosure import ORDER, Onset
from wavesym.exact.joints.joint_law import JointLaw, bound_sum

# powers beyond those of what acts, in which a motion that is a polynomial must have come to its end
_MORE = 5

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


def exact_motion(
    law: JointLaw,
    velocity: Sequence[fmpq],
    displacement: Sequence[fmpq],
    forces: Sequence[fmpq_poly],
    prescribed: Sequence[fmpq_poly],
) -> list[fmpq_poly] | None:
    """The velocities of a law's groups of points, whose velocities are given (points' displacements too).

    None where they are no polynomials.
    """
    end = max([p.length() for p in (*forces, *prescribed)], default=0)
    series = motion_series(law, velocity, displacement, forces, prescribed, fmpq, _all)
    for n, (q, u, last) in zip(range(end + _MORE), series, strict=False):
        if n >= end and not any(last.values()) and not (law.springs and any(places[n] for places in u)):
            return [fmpq_poly(c) for c in q]
    return None


def _all(value: fmpq) -> fmpq:
    return value


def onsets(
    law: JointLaw,
    state: tuple[Sequence[fmpq], Sequence[fmpq]],
    forces: Sequence[Onset],
    prescribed: Sequence[Onset],
    sizes: Sequence[arb],
    length: fmpq,
) -> list[Onset]:
    """Those of the velocities of a law's groups, from the state (velocities of groups, displacements of points).

    `sizes` are bounds of the velocities on the stretch.
    """
    velocity, displacement = state
    orders = _orders(law, [each.order for each in forces], [each.order for each in prescribed])
    acting, given = [each.powers for each in forces], [each.powers for each in prescribed]
    *_, (q, _, _) = islice(motion_series(law, velocity, displacement, acting, given, fmpq, _all), max(orders) + 1)
    places = [
        abs(arb(u)) + abs(arb(ratio)) * arb(length) * sizes[a]
        for u, (a, ratio) in zip(displacement, law.moves, strict=True)
    ]
    beyond = _derivatives(law, forces, prescribed, orders, sizes, places, length)
    return [
        Onset(fmpq_poly(c[:order]), ((order, (last / factorial(order)).upper()),))
        for c, order, last in zip(q, orders, beyond, strict=True)
    ]


def _orders(law: JointLaw, forces: Sequence[float], prescribed: Sequence[float]) -> list[int]:
    """How many powers of each velocity follow from those that are known: each mass or spring in between adds one."""
    size = range(len(law.mass))
    orders = [prescribed[k] if law.motions[k] is not None else inf for k in size]

    def order_of_pull(k: int) -> float:
        """What is known of what acts on a group, but for groups without mass."""
        slow = (orders[b] for b in size if law.damping[k][b] != 0 and b not in law.light)
        sprung = (orders[law.moves[p][0]] + 1 for p, c in enumerate(law.stiffness[k]) if c != 0)
        return min([forces[k], *slow, *sprung])

    while True:
        before = list(orders)
        for row, k in enumerate(law.light):
            orders[k] = min(order_of_pull(b) for n, b in enumerate(law.light) if law.inverse[row, n] != 0)
        for k in law.heavy:
            orders[k] = 1 + min([order_of_pull(k), *(orders[b] for b in law.light if law.damping[k][b] != 0)])
        if orders == before:
            return [ORDER + 2 * (len(orders) - 1) if order == inf else int(order) for order in orders]


def _derivatives(
    law: JointLaw,
    forces: Sequence[Onset],
    prescribed: Sequence[Onset],
    orders: Sequence[int],
    sizes: Sequence[arb],
    places: Sequence[arb],
    length: fmpq,
) -> list[arb]:
    """Bounds of the velocities' derivatives of these orders, from those of all lower ones."""
    size = range(len(law.mass))
    now, springs = list(sizes), list(places)
    heavy = {k: sizes[k] for k in law.heavy}
    found = list(sizes)
    for j in range(max(orders) + 1):
        for k in size:
            if law.motions[k] is not None:
                now[k] = prescribed[k].derivative(j, length)
            elif k in heavy:
                now[k] = heavy[k]
        pull = [
            forces[k].derivative(j, length) + bound_sum(list(zip(law.stiffness[k], springs, strict=True))) for k in size
        ]
        known = {k: now[k] for k in size if k not in law.light}
        for k, bound in law.light_velocities(pull, known, bound_sum).items():
            now[k] = bound.upper()
        for k in law.heavy:
            slow = bound_sum(list(zip(law.damping[k], now, strict=True)))
            heavy[k] = ((pull[k] + slow) / arb(law.mass[k])).upper()
        springs = [abs(arb(ratio)) * now[a] for a, ratio in law.moves]
        found = [now[k] if orders[k] == j else found[k] for k in size]
    return found
