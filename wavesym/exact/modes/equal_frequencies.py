"""Frequencies that no bits tell apart, as of equal branches: their shapes, all of them, from what forces do.

Under a force on one point that swings with the frequency v, points move by K(v)^-1, which is, summed over all modes of
mass 1, that of q q^T/(w_n^2 - v^2). So near frequencies that all lie within a much smaller ball, (w^2 - v^2) K(v)^-1 is
the sum of q q^T over their modes, but for what all others add. That is at most

    (G_ii G_jj)^(1/2) times their largest |w^2 - v^2| (w_n^2 + w^2)/|w_n^2 - v^2|,    G = K(i w)^-1,

as G is the sum of q q^T/(w_n^2 + w^2). A matrix of rank r has r columns of which it is made, each at right angles to
those before (Cholesky): shapes of mass 1. Which of the many that there are does not matter, as all vibrate alike.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import acb, arb

from wavesym.exact.modes.shape import Mode, moved_mass
from wavesym.exact.modes.stiffness import HarmonicLaw, Stiffness, cot_csc

_NEWTON = 12
WIDE = 560
"""Bits that the frequencies of a cluster share."""
_APART = (11, 22, 44, 88, 176, 352)  # bits that other frequencies may share with them
_BETWEEN = 100  # bits that a force is nearer to the cluster than others are


def prove_cluster(stiffness: Stiffness, law: HarmonicLaw, n: int, w: arb) -> list[Mode] | None:
    """Modes whose frequencies are equal, but for 2^-560 of them, with their shapes.

    The precision that is set has twice as many bits and more.

    Args:
        stiffness: how the network resists a harmonic motion.
        law: its numbers, as balls.
        n: the number of the first of these modes, from 1 on.
        w: their frequency, in rad per tau.

    Returns:
        None where that is not proved: no frequency is certain to lie there, or others may be as near.
    """
    ball = arb(w, (w * arb(2) ** -WIDE).upper())
    below, above = stiffness.proved_count(law, ball.lower()), stiffness.proved_count(law, ball.upper())
    if below != n - 1 or above is None or above < n:
        return None
    if not all(csc.is_finite() for csc in cot_csc(law, ball)[1]):
        return None  # a bar may vibrate between points at rest: they do not tell how
    for apart in _APART:
        aside = arb(2) ** -apart
        if [stiffness.proved_count(law, w * (1 + sign * aside)) for sign in (-1, 1)] == [below, above]:
            break
    else:
        return None
    shapes = _shapes(stiffness, law, ball, aside, above - below)
    return [Mode(stiffness, ball, points) for points in shapes]


def common_frequency(stiffness: Stiffness, law: HarmonicLaw, w: arb, root: int) -> arb | None:
    """Where frequencies meet near w, by Newton's method; `root` is a row that moves much in one of their modes."""
    force = [arb(0)] * len(stiffness.points)
    force[root] = arb(1)
    for _ in range(_NEWTON):
        cot, csc = cot_csc(law, w)
        moved = stiffness.solve(*law.matrix(w, cot, csc), force)
        better = (w * w + moved[root] / moved_mass(law, w, moved, stiffness.parents, cot, csc)).sqrt().mid()
        if not better.is_finite():
            return None
        off, w = abs(better - w), better
        if off < w * arb(2) ** -(WIDE // 2 + 8):  # it squares
            return w
    return None


def _compliances(stiffness: Stiffness, diagonal: list[arb], up: Sequence[arb]) -> list[arb]:
    """How far each row moves under a force on it alone."""
    pivots = stiffness.pivots(diagonal, up)
    made = list(pivots)
    for row in reversed(range(len(pivots))):
        parent = stiffness.parents[row]
        made[row] = 1 / pivots[row]
        if parent is not None:
            made[row] += (up[row] / pivots[row]) ** 2 * made[parent]
    return made


def _shapes(stiffness: Stiffness, law: HarmonicLaw, w: arb, aside: arb, count: int) -> list[list[arb]]:
    """`count` shapes at right angles; other frequencies are `aside` of w or more away from it, relative to it."""
    v = (w * (1 + aside * arb(2) ** -_BETWEEN)).mid()
    square = w * w - v * v
    near = law.matrix(v, *cot_csc(law, v))
    still = acb(0, w.mid())
    quiet = law.matrix(still, *cot_csc(law, still))
    calm = [g.real.upper().sqrt() for g in _compliances(stiffness, *quiet)]
    far = [((1 + side * aside) * w) ** 2 for side in (-1, 1)]
    others = max((abs(square) * (x + w * w) / abs(x - v * v)).upper() for x in far)
    others += (square.rad() / abs(square) * 2 * w * w).upper()  # what they differ
    alone = _compliances(stiffness, list(near[0]), near[1])
    left = [square * g + arb(0, (others * c * c).upper()) for g, c in zip(alone, calm, strict=True)]
    shapes: list[list[arb]] = []
    for _ in range(count):
        row = max(range(len(left)), key=lambda k: float(left[k].mid()))
        force = [arb(0)] * len(left)
        force[row] = square
        column = stiffness.solve(list(near[0]), near[1], force)
        column = [q + arb(0, (others * c * calm[row]).upper()) for q, c in zip(column, calm, strict=True)]
        for shape in shapes:
            column = [q - s * shape[row] for q, s in zip(column, shape, strict=True)]
        if not left[row] > 0:
            return []
        scale = column[row].rsqrt()
        shapes.append([q * scale for q in column])
        left = [each - q * q for each, q in zip(left, shapes[-1], strict=True)]
    return [stiffness.point_motions(shape) for shape in shapes]
