"""What is multiplied and added up on the way to a law: it has to be a number with all its digits.

A product beyond the largest number makes a quotient 0, one below the smallest normal number loses digits, and nothing
tells afterwards: what would be wrong is the chain itself. So such parameters are refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Set

from flint import fmpq, fmpq_mpoly

from wavesym.numbers.ratio import Ratio

Product = tuple[fmpq_mpoly, ...]
"""Its factors, which are sums of products of symbols."""


def products(function: Ratio, positive: Set[str]) -> Iterator[Product]:
    """Those of a law, in the order in which it is computed. `positive` are the symbols that have to be; what others are
    in may be 0.
    """
    names = function.ring.names
    forms = [(function.ring.forms[form], power) for form, power in sorted(function.denominator.items())]
    below = tuple(form for form, power in forms for _ in range(power))
    for polynomial in (function.numerator, *(form for form, _ in forms)):
        if {names[place] for place, power in enumerate(polynomial.degrees()) if power} <= positive:
            yield from _parts(polynomial)
    for count in range(2, len(below) + 1):
        yield below[:count]


def _parts(polynomial: fmpq_mpoly) -> Iterator[Product]:
    """Each term factor by factor; and the sum, where nothing cancels."""
    terms = {tuple(map(int, powers)): fmpq(value) for powers, value in polynomial.to_dict().items()}
    for powers, value in terms.items():
        letters = [place for place, power in enumerate(powers) for _ in range(power)]
        for count in range(1 if abs(value) != 1 else 2, len(letters) + 1):
            begun = tuple(letters[:count].count(place) for place in range(len(powers)))
            yield (polynomial.context().from_dict({begun: value}),)
    if len(terms) > 1 and len({value > 0 for value in terms.values()}) == 1:
        yield (polynomial,)
