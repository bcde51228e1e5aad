"""What a joint answers: the inverse of M s + C + K/s in partial fractions, where its polynomial splits.

The velocities of a joint's free points are (M D + C + K/D)^-1 of the forces on them. The determinant, times what clears
the fractions, is the joint's polynomial. Where its factors are s + g with rational g, the inverse is

    direct + sum over g and k of residues[g, k] / (D + g)**k,

and to divide by D + g is the rule that tables run for a body (`increments.solve`): coefficients stay exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product

from flint import arb, ctx, fmpq, fmpq_poly, fmpq_series

from wavesym.derivation.factors import factor_weights
from wavesym.derivation.increments import Increment, add, solve, trim
from wavesym.derivation.rules import Weights
from wavesym.exact.joints.joint_law import JointLaw

Matrix = Mapping[tuple[int, int], fmpq]
"""Entries by (moved point, pushed point); those that are 0 are left out."""
_S = fmpq_poly([0, 1])
_ZERO = fmpq(0)
LONGEST_WRITTEN = 32  # characters of a number in a message
_KEPT = 512  # laws whose answers are kept: joints of one network are often alike, those of many need not stay


@dataclass(frozen=True)
class Pole:
    """`residues[k - 1]` / (D + rate)**k, for k = 1, 2, ...; `factor` has the weights of D + rate."""

    rate: fmpq
    residues: tuple[Matrix, ...]

    @cached_property
    def factor(self) -> Weights:
        """What D + rate does to coefficients."""
        return factor_weights(self.rate)


@dataclass(frozen=True)
class JointResponse:
    """The velocities of a joint's free points (by their places in it) from the forces on them."""

    direct: Matrix
    poles: tuple[Pole, ...]

    @cached_property
    def later(self) -> frozenset[tuple[int, int]]:
        """Which points a force moves more and more: pairs of moved and pushed points."""
        return frozenset(at for pole in self.poles for residues in pole.residues for at in residues)

    @property
    def entries(self) -> frozenset[tuple[int, int]]:
        """Which points a force moves at all."""
        return self.later.union(self.direct)

    def velocities(self, forces: Mapping[int, Increment], pushes: Mapping[int, fmpq]) -> dict[int, Increment]:
        """What forces and pushes (sudden momentum) on points make of the velocities of all points."""
        found: dict[int, Increment] = {}

        def gain(matrix: Matrix, pushed: int, part: Increment) -> None:
            for (moved, by), factor in matrix.items():
                if by == pushed:
                    add(found.setdefault(moved, {}), part, factor)

        for point in {**forces, **pushes}:
            force = forces.get(point, {})
            gain(self.direct, point, force)
            for pole in self.poles:
                push, part = pushes.get(point, _ZERO), force
                for residues in pole.residues:
                    part = solve(pole.factor, part, push)
                    push = _ZERO
                    gain(residues, point, part)
        return {point: increment for point, total in found.items() if (increment := trim(total))}


@lru_cache(_KEPT)
def joint_polynomial(law: JointLaw) -> fmpq_poly:
    """The determinant of M s + C + K/s of the free points, times the powers of s that clear the fractions."""
    determinant, _ = _invert(law)
    cleared = 0
    while cleared < len(_free(law)) and determinant[cleared] == 0:
        cleared += 1
    return fmpq_poly(determinant.coeffs()[cleared:])


def rates(law: JointLaw) -> Mapping[fmpq, int] | None:
    """The g of the factors s + g of a joint's polynomial, with their powers; None where it does not split."""
    _, factors = joint_polynomial(law).factor()
    if any(factor.degree() > 1 for factor, _ in factors):
        return None
    return {factor[0] / factor[1]: int(power) for factor, power in factors}


@lru_cache(_KEPT)
def joint_response(law: JointLaw) -> JointResponse:
    """The partial fractions. ValueError where the polynomial does not split over the rationals."""
    if rates(law) is None:
        raise ValueError("the polynomial of the joint does not split")
    determinant, adjugate = _invert(law)
    free = _free(law)
    direct: dict[tuple[int, int], fmpq] = {}
    poles: dict[fmpq, list[dict[tuple[int, int], fmpq]]] = {}
    for (i, moved), (j, pushed) in product(enumerate(free), repeat=2):
        whole, parts = partial_fractions(_S * adjugate[i][j], determinant)
        if whole != 0:
            direct[moved, pushed] = whole
        for rate, residues in parts.items():
            matrices = poles.setdefault(rate, [])
            matrices += [{} for _ in range(len(residues) - len(matrices))]
            for matrix, residue in zip(matrices, residues, strict=False):
                if residue != 0:
                    matrix[moved, pushed] = residue
    return JointResponse(direct, tuple(Pole(rate, tuple(poles[rate])) for rate in sorted(poles)))


def partial_fractions(above: fmpq_poly, below: fmpq_poly) -> tuple[fmpq, dict[fmpq, list[fmpq]]]:
    """above/below as a number and, by g, the numbers over s + g, (s + g)**2, ...; all roots are rational."""
    common = above.gcd(below)
    above, below = divmod(above, common)[0], divmod(below, common)[0]
    whole, above = divmod(above, below)
    parts = {}
    _, factors = below.factor()
    for factor, power in factors:
        rate = factor[0] / factor[1]
        near = fmpq_poly([-rate, 1])
        # of below, the first `power` coefficients are 0 there
        bottom = fmpq_poly(below(near).coeffs()[power:])
        series = fmpq_series(above(near), prec=power) / fmpq_series(bottom, prec=power)
        parts[rate] = [series[k] for k in reversed(range(power))]
    return whole[0], parts


def _free(law: JointLaw) -> tuple[int, ...]:
    return tuple(sorted((*law.heavy, *law.light)))


@lru_cache(_KEPT)
def _invert(law: JointLaw) -> tuple[fmpq_poly, list[list[fmpq_poly]]]:
    """The determinant and the adjugate of M s^2 + C s + K of the free points, by elimination without fractions.

    For s > 0 the matrix is positive definite, so that no pivot is 0.
    """
    free = _free(law)
    size = len(free)
    rows = [
        [
            *(fmpq_poly([law.stiffness[a][b], law.damping[a][b], law.mass[a] if a == b else _ZERO]) for b in free),
            *(fmpq_poly([int(a == b)]) for b in free),
        ]
        for a in free
    ]
    last = fmpq_poly([1])
    for k in range(size):
        pivot = rows[k]
        for i in range(size):
            if i != k:
                factor = rows[i][k]
                rows[i] = [
                    _divide_exactly(pivot[k] * x - factor * y, last) for x, y in zip(rows[i], pivot, strict=True)
                ]
        last = pivot[k]
    return last, [row[size:] for row in rows]


def _divide_exactly(above: fmpq_poly, below: fmpq_poly) -> fmpq_poly:
    return divmod(above, below)[0]


def polynomial_text(polynomial: fmpq_poly, most: int = 6) -> str:
    """A polynomial in s, its highest powers first; of a long one not all, of a long number the first digits."""
    terms: Sequence[tuple[int, fmpq]] = [(k, c) for k, c in enumerate(polynomial.coeffs()) if c != 0][::-1]
    shown = ""
    for k, c in terms[:most]:
        power = "" if k == 0 else "s" if k == 1 else f"s^{k}"
        size = "" if abs(c) == 1 and k else _digits(abs(c))
        sign = "-" if c < 0 else "+"
        shown += f" {sign} " if shown else sign.removesuffix("+")
        shown += f"{size} {power}".strip()
    return shown + (f" + ... ({len(terms)} terms)" if len(terms) > most else "")


def _digits(value: fmpq) -> str:
    exact = str(value)
    if len(exact) <= LONGEST_WRITTEN:
        return exact
    with ctx.workprec(64):
        return str(arb(value).str(5, radius=False))
