"""Between powers and Chebyshev polynomials on [-1, 1], for many polynomials at once, in balls."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import comb

from flint import arb, arb_mat, arb_poly, ctx, fmpq


@cache
def polynomial(n: int) -> tuple[int, ...]:
    """The coefficients of T_n, lowest first."""
    if n < 2:
        return (1,) if n == 0 else (0, 1)
    before, last = polynomial(n - 2), polynomial(n - 1)
    doubled = (0, *(2 * c for c in last))
    return tuple(c - (before[k] if k < len(before) else 0) for k, c in enumerate(doubled))


@cache
def _from_powers(size: int, bits: int) -> arb_mat:
    """t**k = 2**(1-k) sum_j comb(k, j) T_(k-2j), the T_0 term halved: column k holds it, in so many bits."""
    entries = [[fmpq(0)] * size for _ in range(size)]
    for k in range(size):
        for j in range(k // 2 + 1):
            n = k - 2 * j
            entries[n][k] = fmpq(comb(k, j), 2**k) * (1 if n == 0 else 2)
    return arb_mat([[arb(entry) for entry in row] for row in entries])


def coefficients(polynomials: Sequence[arb_poly], bits: int) -> list[list[arb]]:
    """The Chebyshev coefficients of each polynomial, all of the length of the longest, with so many bits."""
    size = max((p.length() for p in polynomials), default=0)
    if size == 0:
        return [[] for _ in polynomials]
    columns = [[*p.coeffs(), *[arb(0)] * (size - p.length())] for p in polynomials]
    powers = arb_mat([list(row) for row in zip(*columns, strict=True)])
    with ctx.workprec(bits):
        product = _from_powers(size, bits) * powers
    return [[product[n, j] for n in range(size)] for j in range(len(polynomials))]


def powers(series: Sequence[arb]) -> list[arb]:
    """The coefficients in powers of sum_n series[n] T_n, lowest first."""
    result = [arb(0)] * len(series)
    for n, c in enumerate(series):
        for k, factor in enumerate(polynomial(n)):
            if factor:
                result[k] += factor * c
    return result
