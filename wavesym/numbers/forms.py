"""The irreducible forms that denominators are made of, and how a reader is told of them."""

from __future__ import annotations

from collections.abc import Sequence
from math import prod

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx

Denominator = dict[int, int]  # number of a form: its exponent, at least 1
Telling = tuple[int, Sequence[int], fmpq_mpoly]


class Forms:
    """The polynomials in `names` over the rationals, with the irreducible forms met so far.

    The first forms are the names themselves. A ring that computes in other letters than its functions are told in has
    `images`: what each letter is, a polynomial with integer coefficients in the symbols that a reader knows.
    """

    def __init__(self, names: Sequence[str], images: Sequence[fmpq_mpoly] | None = None) -> None:
        self.names = tuple(names)
        self.context = fmpq_mpoly_ctx.get(self.names, Ordering.lex)
        self.forms: list[fmpq_mpoly] = list(self.context.gens())
        self.images = images
        self.told: fmpq_mpoly_ctx = images[0].context() if images else self.context
        self._tellings: list[Telling] = []

    def telling(self, form: int) -> Telling:
        """What a form is in the symbols that a reader knows (see `factorization`)."""
        for number in range(len(self._tellings), form + 1):
            self._tellings.append(self.tell(self.forms[number]))
        return self._tellings[form]

    def product(self, exponents: Denominator) -> fmpq_mpoly:
        """The product of forms with these exponents."""
        return prod(
            (self.forms[form] ** power for form, power in exponents.items() if power), start=self.context.constant(1)
        )

    def form(self, polynomial: fmpq_mpoly) -> int:
        """The number of an irreducible polynomial among the forms, a new one where it is new."""
        for number, form in enumerate(self.forms):
            if form == polynomial:
                return number
        self.forms.append(polynomial)
        return len(self.forms) - 1

    def tell(self, factor: fmpq_mpoly) -> Telling:
        """An irreducible polynomial in the letters as sign * monomial * one that is irreducible in symbols, or 1."""
        polynomial = factor.compose(*self.images, ctx=self.told) if self.images else factor
        monomial = polynomial.term_content()
        polynomial = polynomial / monomial
        sign = 1 if polynomial.leading_coefficient() > 0 else -1
        return sign, monomial.degrees(), polynomial * sign
