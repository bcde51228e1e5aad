"""Sums of exp(-rate w) w^power for w >= 0 with rational coefficients: what the waves of a chain are made of."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from flint import fmpq, fmpq_poly

_U = fmpq_poly([0, 1])


class Decays:
    """By rate, the Laplace transform as a polynomial in u = 1/(s + rate): w^k/k! exp(-rate w) is u^(k+1)."""

    def __init__(self, terms: Mapping[fmpq, fmpq_poly] | None = None) -> None:
        self._terms = {rate: poly for rate, poly in (terms or {}).items() if poly}

    @classmethod
    def power(cls, k: int, size: fmpq | int = 1) -> Decays:
        """size w^k/k!"""
        return cls({fmpq(0): _U ** (k + 1) * size})

    def __bool__(self) -> bool:
        return bool(self._terms)

    def __add__(self, other: Decays) -> Decays:
        terms = dict(self._terms)
        for rate, poly in other._terms.items():
            terms[rate] = terms.get(rate, 0) + poly
        return Decays(terms)

    def __sub__(self, other: Decays) -> Decays:
        return self + other * -1

    def __mul__(self, factor: fmpq | int) -> Decays:
        return Decays({rate: poly * factor for rate, poly in self._terms.items()})

    def lagged(self, rate: fmpq | int, start: fmpq | int = 0) -> Decays:
        """The q with q' + rate q = self and q(0) = start: partial fractions of (transform + start)/(s + rate)."""
        rate = fmpq(rate)
        terms = {rate: _U * start}
        for own, poly in self._terms.items():
            lag = rate - own
            if lag == 0:
                terms[rate] += poly * _U
                continue
            # 1/(s + rate) is u/(1 + lag u), and rest/(1 + lag u) is rest - rest lag/(s + rate)
            quotient, rest = divmod(poly * _U, fmpq_poly([1, lag]))
            terms[own] = terms.get(own, 0) + quotient - quotient[0]
            terms[rate] -= _U * (rest[0] * lag)
        return Decays(terms)

    def polynomials(self) -> Iterator[tuple[fmpq, fmpq_poly]]:
        """By rate, the polynomial in w that is the factor of exp(-rate w)."""
        for rate, poly in self._terms.items():
            coefficients, factorial = poly.coeffs()[1:], 1
            for k in range(1, len(coefficients)):
                factorial *= k
                coefficients[k] /= factorial
            yield rate, fmpq_poly(coefficients)
