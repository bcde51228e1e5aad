"""A joint whose motion is a polynomial: rational data in free flight, or at rest, stay exact.

The powers come one after another as in `joint`, in rational numbers. Once nothing acts any more and the state's next
powers are all 0, so are all that follow, and the series is the motion itself. Otherwise it has no end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from flint import fmpq, fmpq_poly

from wavesym.exact.joints.joint import JointLaw

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
    for n, (q, still) in zip(range(end + _MORE), powers(law, velocity, displacement, forces, prescribed), strict=False):
        if n >= end and still:
            return [fmpq_poly(c) for c in q]
    return None


def powers(
    law: JointLaw,
    velocity: Sequence[fmpq],
    displacement: Sequence[fmpq],
    forces: Sequence[fmpq_poly],
    prescribed: Sequence[fmpq_poly],
) -> Iterator[tuple[list[list[fmpq]], bool]]:
    """The first n powers of the velocities, for n = 0, 1, ...; and whether the state's next powers are all 0."""
    size = range(len(law.mass))
    inverse = law.inverse
    q: list[list[fmpq]] = [[] for _ in size]
    u = [[value] for value in displacement]
    last = {k: velocity[k] for k in law.heavy}
    n = 0
    while True:
        yield q, not any(last.values()) and not (law.springs and any(places[n] for places in u))
        pull = [forces[k][n] for k in size]
        if law.springs:
            for k in size:
                pull[k] -= sum((c * places[n] for c, places in zip(law.stiffness[k], u, strict=True)), fmpq(0))
        for k in size:
            if law.given[k] is not None:
                q[k].append(prescribed[k][n])
        for k in law.heavy:
            q[k].append(last[k])
        known = {k: q[k][n] for k in size if k not in law.light}
        right = [pull[k] - sum((law.damping[k][b] * v for b, v in known.items()), fmpq(0)) for k in law.light]
        for row, k in enumerate(law.light):
            q[k].append(sum((inverse[row, j] * value for j, value in enumerate(right)), fmpq(0)))
        for k in law.heavy:
            force = pull[k] - sum((law.damping[k][b] * q[b][n] for b in size), fmpq(0))
            last[k] = force / (law.mass[k] * (n + 1))
        if law.springs:
            for k, (group, ratio) in enumerate(law.moves):
                u[k].append(ratio * q[group][n] / (n + 1))
        n += 1
