"""Rational functions whose denominators are products of known forms: what symbolic tables are made of.

The numerator is one polynomial, the denominator the exponents of irreducible forms such as kappa_1 or
2*kappa_1 - kappa_3, each met first where something is divided by it. So no greatest common divisor is ever taken: what
may cancel is known, and tried by exact division.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from math import prod
from typing import Any

from flint import fmpq, fmpq_mpoly
from flint.utils.flint_exceptions import DomainError

from wavesym.numbers.factorization import Factorization, factor
from wavesym.numbers.forms import Denominator, Forms


class Ring(Forms):
    """The rational functions of `names` over the rationals."""

    def symbols(self) -> dict[str, Ratio]:
        """The symbols by name."""
        return {name: Ratio(self, symbol) for name, symbol in zip(self.names, self.context.gens(), strict=True)}

    def constant(self, value: fmpq | int) -> Ratio:
        """A number."""
        return Ratio(self, self.context.constant(value))


class Ratio:
    """numerator / prod forms**exponent in lowest terms; with ints and fmpq it mixes as numbers do.

    Equality is that of functions. The order, which sorts rates, is that of the first symbols in them; 0 is least.
    """

    __slots__ = ("__dict__", "denominator", "numerator", "ring")

    def __init__(self, ring: Ring, numerator: fmpq_mpoly, denominator: Denominator | None = None) -> None:
        self.ring = ring
        self.numerator = numerator
        self.denominator: Denominator = denominator or {}

    def _other(self, value: object) -> Ratio | None:
        if isinstance(value, Ratio):
            return value
        return self.ring.constant(value) if isinstance(value, (int, fmpq)) else None

    def __add__(self, value: Ratio | fmpq | int) -> Ratio:
        other = self._other(value)
        if other is None:
            return NotImplemented
        if not other.numerator:
            return self
        if not self.numerator:
            return other
        if self.denominator == other.denominator:
            return self._reduce(self.numerator + other.numerator, self.denominator, self.denominator)
        common = dict(self.denominator)
        for form, exponent in other.denominator.items():
            common[form] = max(exponent, common.get(form, 0))
        # where the exponents differ nothing can cancel: one of the two numerators has been multiplied by the form
        equal = [form for form, exponent in self.denominator.items() if other.denominator.get(form) == exponent]
        return self._reduce(self._numerator_over(common) + other._numerator_over(common), common, equal)

    __radd__ = __add__

    def __neg__(self) -> Ratio:
        return Ratio(self.ring, -self.numerator, self.denominator)

    def __sub__(self, value: Ratio | fmpq | int) -> Ratio:
        return self + -value

    def __rsub__(self, value: fmpq | int) -> Ratio:
        return -self + value

    def __mul__(self, value: Ratio | fmpq | int) -> Ratio:
        if isinstance(value, (int, fmpq)):
            return Ratio(self.ring, self.numerator * value, self.denominator if value != 0 else None)
        if not isinstance(value, Ratio):
            return NotImplemented
        # forms are irreducible: one that divides the product divides the numerator that did not stand over it
        ours = self._reduce(self.numerator, value.denominator, value.denominator)
        theirs = self._reduce(value.numerator, self.denominator, self.denominator)
        denominator = dict(ours.denominator)
        for form, exponent in theirs.denominator.items():
            denominator[form] = denominator.get(form, 0) + exponent
        product = ours.numerator * theirs.numerator
        return Ratio(self.ring, product, denominator if product else None)

    __rmul__ = __mul__

    def __truediv__(self, value: Ratio | fmpq | int) -> Ratio:
        if not isinstance(value, Ratio):
            return self * (1 / fmpq(value))
        # what both stand over is not multiplied out
        shared = {form: min(power, value.denominator.get(form, 0)) for form, power in self.denominator.items()}
        return self._times(shared) * value._times(shared).inverse

    def _times(self, forms: Denominator) -> Ratio:
        """This times forms of its denominator."""
        left = {form: power - forms.get(form, 0) for form, power in self.denominator.items()}
        return Ratio(self.ring, self.numerator, {form: power for form, power in left.items() if power})

    def __rtruediv__(self, value: fmpq | int) -> Ratio:
        return self.inverse * value

    def __pow__(self, exponent: int) -> Ratio:
        base = self if exponent >= 0 else self.inverse
        return prod([base] * abs(exponent), start=self.ring.constant(1))

    @cached_property
    def inverse(self) -> Ratio:
        """1 over this. ZeroDivisionError for 0."""
        if not self.numerator:
            raise ZeroDivisionError("1/0")
        content, factors = self.numerator.factor()
        above = self.ring.product(self.denominator)
        return Ratio(self.ring, above / content, {self.ring.form(factor): int(power) for factor, power in factors})

    def _numerator_over(self, common: Denominator) -> fmpq_mpoly:
        """The numerator over the `common` denominator."""
        result = self.numerator
        for form, exponent in common.items():
            missing = exponent - self.denominator.get(form, 0)
            if missing:  # power by power: their product first takes twice as long
                result = result * self.ring.forms[form] ** missing
        return result

    def _reduce(self, numerator: fmpq_mpoly, denominator: Denominator, candidates: Any) -> Ratio:
        """numerator / denominator, with the `candidates` among the forms cancelled as often as they can be."""
        if not numerator:
            return Ratio(self.ring, numerator)
        left = dict(denominator)
        for form in candidates:
            while form in left:
                try:
                    numerator = numerator / self.ring.forms[form]
                except DomainError:  # not divisible
                    break
                left[form] -= 1
                if not left[form]:
                    del left[form]
        return Ratio(self.ring, numerator, left)

    def evaluate(self, values: Mapping[str, fmpq]) -> fmpq:
        """The number that this is where the symbols have `values`. ZeroDivisionError at a pole."""
        point = [values[name] for name in self.ring.told.names()]
        if self.ring.images is not None:
            point = [image(*point) for image in self.ring.images]
        below = prod(
            (self.ring.forms[form](*point) ** power for form, power in self.denominator.items()), start=fmpq(1)
        )
        return fmpq(self.numerator(*point)) / below

    def derivative(self, name: str) -> Ratio:
        """By a symbol."""
        place = self.ring.names.index(name)
        slope = Ratio(self.ring, self.numerator.derivative(place)) / Ratio(
            self.ring, self.ring.product(self.denominator)
        )
        for form, power in self.denominator.items():
            own = self.ring.forms[form]
            slope = slope - power * self * Ratio(self.ring, own.derivative(place)) / Ratio(self.ring, own)
        return slope

    @property
    def letters(self) -> set[int]:
        """The places of the names that occur in it."""
        polynomials = [self.numerator, *(self.ring.forms[form] for form in self.denominator)]
        return {place for one in polynomials for place, power in enumerate(one.degrees()) if power}

    def compose(self, images: Sequence[Ratio]) -> Ratio:
        """This function with `images`, functions of one ring, for the names."""
        ring = images[0].ring

        def value(polynomial: fmpq_mpoly) -> Ratio:
            terms = (
                prod((images[place] ** int(power) for place, power in enumerate(powers) if power), start=factor * one)
                for powers, factor in polynomial.to_dict().items()
            )
            return sum(terms, ring.constant(0))

        one = ring.constant(1)
        below = (value(self.ring.forms[form]) ** power for form, power in self.denominator.items())
        return value(self.numerator) / prod(below, start=one)

    def __eq__(self, value: object) -> bool:
        other = self._other(value)
        return other is not None and self.denominator == other.denominator and bool(self.numerator == other.numerator)

    def __hash__(self) -> int:
        if not self.denominator and self.numerator.is_constant():
            return hash(
                self.numerator.leading_coefficient() if self.numerator else fmpq(0)
            )  # like the number it equals
        return hash((self._key, tuple(sorted(self.denominator.items()))))

    @cached_property
    def _key(self) -> tuple[tuple[tuple[int, ...], fmpq], ...]:
        terms = self.numerator.to_dict().items()
        return tuple((tuple(-int(power) for power in monomial), value) for monomial, value in terms)

    def _order(self) -> tuple[Any, ...]:
        return self._key, tuple(sorted(self.denominator.items()))

    def __lt__(self, value: Ratio | fmpq | int) -> bool:
        other = self._other(value)
        assert other is not None
        return self._order() < other._order()

    def __gt__(self, value: Ratio | fmpq | int) -> bool:
        other = self._other(value)
        assert other is not None
        return other._order() < self._order()

    def __str__(self) -> str:
        return str(self.factorization)

    @property
    def factorization(self) -> Factorization:
        """This in lowest terms, for a reader."""
        return factor(self.ring, self.numerator, self.denominator)
