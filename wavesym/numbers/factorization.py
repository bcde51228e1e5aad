"""Rational functions told to a reader: factored over the rationals, in the symbols of a scene, as text.

General factoring takes longer than making a table. It is left for what nothing quicker settles: forms met before are
divided out first, and most of what then remains is seen to be irreducible on two small specializations.
"""

from __future__ import annotations

from collections.abc import Sequence
from string import ascii_letters
from typing import NamedTuple

from flint import fmpq, fmpq_mpoly, fmpq_poly, fmpz
from flint.utils.flint_exceptions import DomainError

from wavesym.numbers.forms import Denominator, Forms

# more terms than that hardly ever come back as a factor of another coefficient
_RECURRING = 20
# where polynomials are looked at; any numbers will do, and simple ones would hit special cases
_POINT = (3, -7, 5, 11, -13, 17, -19, 23, 29, -31, 37, -41)

Factor = tuple[fmpq_mpoly, int]  # a polynomial with coprime integers, and its exponent, at least 1


class Factorization(NamedTuple):
    """content * prod numerator / prod denominator in lowest terms, of irreducible factors that lead positively."""

    content: fmpq
    numerator: Sequence[Factor]
    denominator: Sequence[Factor]

    @property
    def parts(self) -> tuple[str, str]:
        """Numerator and denominator as text that Python reads as well."""
        return _product(int(self.content.p), self.numerator), _product(int(self.content.q), self.denominator)

    def __str__(self) -> str:
        above, below = self.parts
        if below == "1":
            return above
        if " " in above and "(" not in above:  # a lone sum
            above = f"({above})"
        return f"{above}/({below})" if below.strip("_0123456789" + ascii_letters) else f"{above}/{below}"


def factor(ring: Forms, numerator: fmpq_mpoly, denominator: Denominator) -> Factorization:
    """A rational function in the symbols that its ring is told in."""
    if not numerator:
        return Factorization(fmpq(0), (), ())
    content, known, rest = _factors(ring, numerator, denominator)
    powers = known | {form: -power for form, power in denominator.items()}
    exponents = [0] * ring.told.nvars()
    above: list[Factor] = []
    below: list[Factor] = []
    factors = [(*ring.telling(form), power) for form, power in sorted(powers.items())]
    for sign, monomial, polynomial, power in (*factors, *((*ring.tell(factor), power) for factor, power in rest)):
        content *= sign ** abs(power)
        exponents = [old + power * int(new) for old, new in zip(exponents, monomial, strict=True)]
        if not polynomial.is_constant():
            (above if power > 0 else below).append((polynomial, abs(power)))
    for symbol, exponent in zip(ring.told.gens(), exponents, strict=True):
        if exponent:
            (above if exponent > 0 else below).append((symbol, abs(exponent)))
    return Factorization(content, above, below)


def _factors(ring: Forms, numerator: fmpq_mpoly, denominator: Denominator) -> tuple[fmpq, dict[int, int], list[Factor]]:
    """The numerator's content, the exponents of known forms in it, and what other factors it has."""
    monomial = numerator.term_content()
    rest = numerator / monomial
    known = {form: int(power) for form, power in enumerate(monomial.degrees()) if power}
    for number in range(len(ring.names), len(ring.forms)):
        if number not in denominator:
            power, rest = _divide_out(rest, ring.forms[number])
            if power:
                known[number] = power
    content = _content(rest)
    rest = rest / content
    if rest.is_constant():
        return content, known, []
    if irreducible(rest):
        return content, known, [(rest, 1)]
    _, factors = rest.factor()
    found = [(factor, int(power)) for factor, power in factors]
    for factor, _ in found:
        if len(factor) <= _RECURRING:
            ring.form(factor)
    return content, known, found


def _divide_out(polynomial: fmpq_mpoly, form: fmpq_mpoly) -> tuple[int, fmpq_mpoly]:
    """How often a form divides a polynomial, and what is left."""
    power = 0
    try:
        while True:
            polynomial = polynomial / form
            power += 1
    except DomainError:  # not divisible
        return power, polynomial


def _content(polynomial: fmpq_mpoly) -> fmpq:
    """What the coefficients have in common, with the sign of the first."""
    coefficients = fmpq_poly(polynomial.coeffs())
    content = fmpq(coefficients.numer().content(), coefficients.denom())
    return content if polynomial.leading_coefficient() > 0 else -content


def irreducible(polynomial: fmpq_mpoly) -> bool:
    """Whether a polynomial, not constant, is seen to be irreducible over the rationals; False leaves it open.

    With numbers for all symbols but x it is irreducible in x, of the same degree: then only one factor has x in it. One
    that has not divides the polynomial whatever x is, so it is a constant where two of these have no common divisor.
    """
    degrees = polynomial.degrees()
    place = max(range(len(degrees)), key=lambda i: degrees[i])
    numbers: dict[str | int, int | fmpz | fmpq] = {
        i: _POINT[i % len(_POINT)] for i in range(len(degrees)) if i != place
    }
    slice = polynomial.subs(numbers)
    if slice.degrees()[place] != degrees[place]:
        return False
    _, factors = slice.factor()
    if len(factors) != 1 or factors[0][1] != 1:
        return False
    return bool(polynomial.subs({place: 0}).gcd(polynomial.subs({place: 1})).is_constant())


def _product(number: int, factors: Sequence[Factor]) -> str:
    """A product as text. A lone factor needs no brackets, unless something is to be divided by it (see `__str__`)."""
    if number == 1 and len(factors) == 1 and factors[0][1] == 1:
        return polynomial_text(factors[0][0])
    placed = sorted((_place(factor), polynomial_text(factor), power) for factor, power in factors)
    parts = [
        (f"({text})" if terms > 1 else text) + (f"**{power}" if power > 1 else "") for (terms, _), text, power in placed
    ]
    if abs(number) != 1 or not parts:
        return "*".join([str(number), *parts])
    return ("-" if number < 0 else "") + "*".join(parts)


def _place(factor: fmpq_mpoly) -> tuple[int, list[int]]:
    """Symbols before sums, in the order of their names."""
    return len(factor), [-int(power) for power in factor.degrees()]


def polynomial_text(polynomial: fmpq_mpoly) -> str:
    """A polynomial as text."""
    return str(polynomial).replace("^", "**")
