"""All modes of a chain without rods, from the roots of its determinant, a polynomial of s = i w that is exact.

Roots come in balls that each have one, so none is missed or searched for. How often each is one is known from factors
without squares (Yun), and what moves there from K(s) over the field of the numbers that a rational function of s is:
where it loses one rank and its root is a double one, as at critical damping, exp(s t) and t exp(s t) are one mode.

s and -s are both roots only where nothing is damped, as nothing gains energy: what a polynomial has in common with its
mirror image are the undamped modes, and their frequencies are real.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from flint import acb, acb_poly, arb, ctx, fmpq, fmpq_poly, fmpz_poly

from wavesym.exact.modes.shape import Mode, complex_mode
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.exact.modes.turns import absorb

_BITS, _BITS_A_ROW = 256, 12
_TIMES = (1, 4, 16)  # as many bits
_OFF = 4  # a frequency itself tells less of its mode than one near it: off by 2^-(a fourth of all bits) of it
_I = acb(0, 1)


@dataclass(frozen=True)
class _Root:
    """A frequency, how often it is one, and the factor whose root s it is."""

    frequency: acb
    multiplicity: int
    factor: fmpz_poly


def polynomial_modes(stiffness: Stiffness, determinant: fmpq_poly, sharp: arb) -> list[Mode | None]:
    """The modes of all roots but 0 with Re w >= 0, by |w|, each as often as its root is one.

    A root that is one more often than there are shapes has its last shape again. None of a mode whose shape is not
    `sharp`.

    Args:
        stiffness: of the network; it may have rods that are dashpots to all else (turns.absorb).
        determinant: that of its masses, springs and dashpots, a polynomial of s.
        sharp: the radius that its points may have.
    """
    found: list[tuple[float, list[Mode | None]]] = []
    for times in _TIMES:
        with ctx.workprec(times * (_BITS + _BITS_A_ROW * len(stiffness.points))):
            roots = sorted(_roots(determinant), key=lambda root: float(abs(root.frequency)))
            found = [(float(abs(root.frequency)), _shapes(stiffness, root, sharp)) for root in roots]
        if all(mode is not None for _, modes in found for mode in modes):
            break
    return [mode for _, modes in found for mode in modes]


def _roots(determinant: fmpq_poly) -> Iterator[_Root]:
    for factor, multiplicity in determinant.numer().factor_squarefree()[1]:
        # shapes of several are known over a field: there the factor has to be prime
        parts = factor.factor()[1] if multiplicity > 1 else [(factor, 1)]
        for part, _ in parts:
            undamped = part.gcd(part(fmpz_poly([0, -1])))
            for each, is_damped in ((undamped, False), (part // undamped, True)):
                roots: Any = each.complex_roots() if each.degree() > 0 else []  # pairs, whatever its types say
                for s, _ in roots:
                    if s != 0 and (s.imag == 0 or s.imag > 0):
                        yield _Root(acb(s.imag, -s.real if is_damped else 0), multiplicity, part)


def _shapes(stiffness: Stiffness, root: _Root, sharp: arb) -> list[Mode | None]:
    w = root.frequency
    if root.multiplicity == 1:
        law, near = stiffness.law(arb), w.mid() * (1 + arb(2) ** -(ctx.prec // _OFF))
        return [complex_mode(stiffness, law, w, stiffness.softest_row(law, near, _I * near), sharp)]
    bare = Stiffness(absorb(stiffness.network))
    points = [bare.point_motions(rows) for rows in _null_space(bare, root.factor, _I * w)]
    modes: list[Mode | None] = [Mode(stiffness, w, _with_far_ends(stiffness, bare, each, w)) for each in points]
    return modes + modes[-1:] * (root.multiplicity - len(modes))


def _with_far_ends(stiffness: Stiffness, bare: Stiffness, points: list[acb], w: acb) -> list[acb]:
    """Points with those at the far ends of rods that absorb, which do what the near ends did a delay before."""
    known, coming = set(bare.points), list(stiffness.network.bars)
    while coming:
        bar = next(bar for bar in coming if known & {bar.left, bar.right})
        coming.remove(bar)
        (near, ratio), (far, far_ratio) = sorted(
            zip((bar.left, bar.right), bar.ratios, strict=True), key=lambda end: end[0] not in known
        )
        points[far] = points[near] * (ratio / far_ratio) * (-_I * w * bar.delay).exp()
        known.add(far)
    return points


def _null_space(stiffness: Stiffness, factor: fmpz_poly, s: acb) -> list[list[acb]]:
    """How rows move where nothing acts on them: K(s) eliminated modulo a prime polynomial, and s put in."""
    prime = fmpq_poly(factor)
    rows, pivots = _dense(stiffness, prime), list[int]()
    count = len(rows)
    for column in range(count):
        done = len(pivots)
        pivot = next((k for k in range(done, count) if not rows[k][column].is_zero()), None)
        if pivot is None:
            continue
        rows[done], rows[pivot] = rows[pivot], rows[done]
        inverse = rows[done][column].xgcd(prime)[1]
        rows[done] = [each * inverse % prime for each in rows[done]]
        for k in (k for k in range(count) if k != done and not rows[k][column].is_zero()):
            share = rows[k][column]
            rows[k] = [(a - share * b) % prime for a, b in zip(rows[k], rows[done], strict=True)]
        pivots.append(column)
    found = []
    for free in (k for k in range(count) if k not in pivots):
        moved = [acb(int(k == free)) for k in range(count)]
        for row, column in zip(rows, pivots, strict=False):
            moved[column] = -acb_poly(row[free].coeffs())(s)
        found.append(moved)
    return found


def _dense(stiffness: Stiffness, prime: fmpq_poly) -> list[list[fmpq_poly]]:
    """K(s) modulo a polynomial of s."""
    law, count = stiffness.law(fmpq), len(stiffness.points)
    rows = [[fmpq_poly([])] * count for _ in range(count)]
    for row, parent in enumerate(stiffness.parents):
        rows[row][row] = fmpq_poly([law.stiffness[row], law.damping[row], law.mass[row]]) % prime
        if parent is not None:
            shared = fmpq_poly([law.coupling_stiffness[row], law.coupling_damping[row]]) % prime
            rows[row][parent] = rows[parent][row] = shared
    return rows
