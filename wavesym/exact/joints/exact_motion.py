"""The motion of a joint in rational powers: all of them where it is a polynomial, the first where its state is exact.

Rational data in free flight, or at rest, stay exact. The powers come one after another as in `joint`, in rational
numbers. Once nothing acts any more and the state's next powers are all 0, so are all that follow, and the series is the
motion itself. Otherwise it has no end; then the first powers tell how the motion begins, and derivatives of the
velocities, which come one after another from M q' + C q + K u = s as do their bounds, what follows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from math import factorial

from flint import arb, fmpq, fmpq_poly

from wavesym.exact.joints.enclosed import ORDER, Onset
from wavesym.exact.joints.joint import JointLaw, motion_series

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
    acting, given = [each.powers for each in forces], [each.powers for each in prescribed]
    *_, (q, _, _) = islice(motion_series(law, velocity, displacement, acting, given, fmpq, _all), ORDER + 1)
    beyond = _derivatives(
        law,
        [each.derivatives(length) for each in forces],
        {k: each.derivatives(length) for k, each in enumerate(prescribed) if law.given[k] is not None},
        sizes,
        [
            abs(arb(u)) + abs(arb(ratio)) * arb(length) * sizes[a]
            for u, (a, ratio) in zip(displacement, law.moves, strict=True)
        ],
    )
    return [Onset(fmpq_poly(c[:ORDER]), (last / factorial(ORDER)).upper()) for c, last in zip(q, beyond, strict=True)]


def _derivatives(
    law: JointLaw,
    forces: Sequence[Sequence[arb]],
    given: Mapping[int, Sequence[arb]],
    sizes: Sequence[arb],
    places: Sequence[arb],
) -> list[arb]:
    """Bounds of the velocities' derivatives of ORDER, from those of all lower ones."""
    size = range(len(law.mass))
    now, springs = list(sizes), list(places)
    heavy = {k: sizes[k] for k in law.heavy}
    for j in range(ORDER + 1):
        for k in size:
            if k in given:
                now[k] = given[k][j]
            elif k in heavy:
                now[k] = heavy[k]
        pull = [
            forces[k][j] + sum((abs(arb(c)) * u for c, u in zip(law.stiffness[k], springs, strict=True)), arb(0))
            for k in size
        ]
        known = [k for k in size if k not in law.light]
        right = [pull[k] + sum((abs(arb(law.damping[k][b])) * now[b] for b in known), arb(0)) for k in law.light]
        for row, k in enumerate(law.light):
            now[k] = sum((abs(arb(law.inverse[row, n])) * value for n, value in enumerate(right)), arb(0)).upper()
        for k in law.heavy:
            force = pull[k] + sum((abs(arb(law.damping[k][b])) * now[b] for b in size), arb(0))
            heavy[k] = (force / arb(law.mass[k])).upper()
        springs = [abs(arb(ratio)) * now[a] for a, ratio in law.moves]
    return now
