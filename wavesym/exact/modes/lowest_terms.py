"""Fractions of s = i w and z = exp(s h) in lowest terms: what no load excites, or no output sees, is no pole.

Where all delays are multiples of h, an amplitude is such a fraction with rational coefficients. Polynomials P and Q
without a common factor are both 0 at finitely many (s, z), all of them algebraic; by Lindemann exp(s h) is not, where
s is and is not 0. So on z = exp(s h) nothing is 0/0 but w = 0, and P/Q has a pole wherever Q is 0.

At a real w the conjugate of Q(s, z) is Q(-s, 1/z). Both are 0 where Q is: by the same token there alone where their
greatest common factor U is. U is its own conjugate but for a power of z and a sign, so it is a real function of w,
and between two w at which it differs in sign Q has a zero that nothing damps.
"""

from __future__ import annotations

from itertools import count
from math import factorial, inf
from typing import Any

from flint import Ordering, acb, acb_series, arb, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from wavesym.exact.modes.harmonic import UNKNOWN, Frequency, Quantity, Turn, inverse

_RING = fmpq_mpoly_ctx.get(("s", "z"), Ordering.lex)
_S, _Z = _RING.gens()
_I = acb(0, 1)


class Laurent:
    """A polynomial of s and z over a power of each: `over` says which. Numbers are such polynomials, too."""

    def __init__(self, polynomial: fmpq_mpoly, over: tuple[int, int] = (0, 0)) -> None:
        self.polynomial, self.over = polynomial, over

    def __add__(self, other: Any) -> Laurent:
        other = _laurent(other)
        most = max(self.over[0], other.over[0]), max(self.over[1], other.over[1])
        return Laurent(self._expand(most) + other._expand(most), most)

    def __mul__(self, other: Any) -> Laurent:
        other = _laurent(other)
        over = self.over[0] + other.over[0], self.over[1] + other.over[1]
        return Laurent(self.polynomial * other.polynomial, over)

    def __neg__(self) -> Laurent:
        return Laurent(-self.polynomial, self.over)

    def __sub__(self, other: Any) -> Laurent:
        return self + -_laurent(other)

    def __truediv__(self, other: Any) -> Laurent:
        """By a number, or by s."""
        if isinstance(other, Laurent):
            assert (other.polynomial, other.over) == (_S, (0, 0))
            return Laurent(self.polynomial, (self.over[0] + 1, self.over[1]))
        return self * (1 / fmpq(other))

    __radd__, __rmul__ = __add__, __mul__

    def _expand(self, most: tuple[int, int]) -> fmpq_mpoly:
        return self.polynomial * _S ** (most[0] - self.over[0]) * _Z ** (most[1] - self.over[1])


def _laurent(value: Any) -> Laurent:
    return value if isinstance(value, Laurent) else Laurent(_RING.constant(fmpq(value)))


def polynomial_frequency(measure: fmpq) -> Frequency:
    """Any frequency, of a network whose delays are multiples of `measure`."""

    def turn(delay: fmpq) -> Turn:
        """sinh(s T)/s and cosh(s T)."""
        steps = int(delay / measure)
        twice, half = _Z ** (2 * steps), fmpq(1, 2)
        return Turn(Laurent((twice - 1) * half, (1, steps)), Laurent((twice + 1) * half, (0, steps)))

    return Frequency(Laurent(-(_S**2)), Laurent(_S), turn, _laurent)


class LowestTerms:
    """A fraction that has no common factor; `measure` is h, and may be anything where nothing depends on z."""

    def __init__(self, numerator: Laurent, divisor: Laurent, measure: fmpq) -> None:
        above, below = numerator.over, divisor.over
        p = numerator.polynomial * _S ** max(below[0] - above[0], 0) * _Z ** max(below[1] - above[1], 0)
        q = divisor.polynomial * _S ** max(above[0] - below[0], 0) * _Z ** max(above[1] - below[1], 0)
        common = p.gcd(q)
        self._measure = measure
        self._numerator, self._divisor = p / common, q / common
        undamped = self._divisor.gcd(_conjugate(self._divisor))
        self._undamped = undamped / undamped.term_content()
        self._is_real = _conjugate(self._undamped) == self._undamped

    def __call__(self, w: Quantity) -> list[Quantity]:
        """Its value at a frequency, alone in a list: not finite at a pole. At 0 it is its limit."""
        if not isinstance(w, acb_series) and w == 0:
            (order, first), (other, below) = self._first_power(self._numerator), self._first_power(self._divisor)
            return [acb(first / below) if order == other else acb(0) if order > other else UNKNOWN]
        (numerator,), divisor = self.parts(w)
        return [numerator * inverse(divisor)]

    def parts(self, w: Quantity) -> tuple[list[Quantity], Quantity]:
        """The numerator, alone in a list, and the divisor: neither has a pole."""
        return [self._evaluate(self._numerator, w)], self._evaluate(self._divisor, w)

    def has_pole(self, k: int, low: arb, high: arb) -> bool:
        """Whether it has one between two frequencies, as its divisor has a real zero there; `k` is 0."""
        return bool(self._undamped_part(low) * self._undamped_part(high) < 0)

    def lowest_terms(self, k: int) -> None:
        """It is that already."""

    def _undamped_part(self, w: arb) -> arb:
        """U, a real function of the frequency."""
        value = self._evaluate(self._undamped, w)
        value = acb(value) * acb(0, -w * self._measure * self._undamped.degrees()[1] / 2).exp()
        return value.real if self._is_real else value.imag

    def _first_power(self, polynomial: fmpq_mpoly) -> tuple[float, fmpq]:
        """The first power of s that it has on z = exp(s h), with its coefficient; a polynomial that is 0 has none."""
        terms = polynomial.to_dict()
        for power in count() if terms else ():
            rest = {(power - a, b * self._measure): c for (a, b), c in terms.items() if a <= power}
            total = sum((c * rate**n / factorial(n) for (n, rate), c in rest.items()), start=fmpq(0))
            if total != 0:
                return power, total
        return inf, fmpq(0)

    def _evaluate(self, polynomial: fmpq_mpoly, w: Quantity) -> Quantity:
        s = w * _I
        z = (s * self._measure).exp()
        powers: dict[int, dict[int, fmpq]] = {}
        for (a, b), c in polynomial.to_dict().items():
            powers.setdefault(b, {})[a] = c
        return _horner({b: _horner(each, s) for b, each in powers.items()}, z)


def _conjugate(polynomial: fmpq_mpoly) -> fmpq_mpoly:
    """What is its conjugate at every real w, but for a power of z."""
    steps = polynomial.degrees()[1]
    return _RING.from_dict({(a, steps - b): c * (-1) ** a for (a, b), c in polynomial.to_dict().items()})


def _horner(coefficients: dict[int, Any], x: Quantity) -> Quantity:
    """The sum of coefficients times powers of x."""
    total: Quantity = acb(0)
    for power in range(max(coefficients, default=0), -1, -1):
        total = total * x + coefficients.get(power, 0)
    return total
