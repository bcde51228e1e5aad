"""The motion of a joint in rational powers: all of them where it is a polynomial, the first where its state is exact.

Rational data in free flight, or at rest, stay exact. The powers come one after another as in `joint`, in rational
numbers. Once nothing acts any more and the state's next powers are all 0, so are all that follow, and the series is the
motion itself. Otherwise it has no end; then the first powers tell how the motion begins, and derivatives of the
velocities, which come one after another from M q' + C q + K u = s as do their bounds, what follows.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from math import factorial, inf

from flint import arb, fmpq, fmpq_poly

from wavesym.exact.joints.enclosure import ORDER, Onset
from wavesym.exact.joints.joint_law import JointLaw, bound_sum
from wavesym.exact.joints.joint_series import motion_series

# powers beyond those of what acts, in which a motion that is a polynomial must have come to its end
_MORE = 5


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
