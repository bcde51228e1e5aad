"""Letters that suit a chain's rates: two rates differ by a difference of letters, and loads are products of them.

In kappa_i and r_i a rate kappa_i r_i + kappa_(i+1) has two terms, a difference of rates, of which denominators are
made, up to four; multiplied out that is three times as much. With kappa_i r_i and that rate as letters in place of r_i
and kappa_(i+1), a table is made and factored in a fraction of the time. Who reads it is told the symbols only.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from flint import fmpq_mpoly

from wavesym.mechanics.symbolic import SymbolicChain, parameters, rates
from wavesym.numbers.ratio import Ratio, Ring


def in_rates(symbols: SymbolicChain) -> SymbolicChain:
    """The same chain, computed in letters and told in its symbols."""
    context = symbols.ring.context
    names = [f"letter_{number}" for number in range(context.nvars())]
    free = Ring(names)
    letters = list(free.symbols().values())
    found = [rate.compose(letters) for rate in rates(symbols.chain).values()]
    if any(rate.denominator for rate in found):
        return symbols
    images, inverse = list(context.gens()), letters
    for place, slope, rest in _letters([rate.numerator for rate in found]):
        letter = slope * free.context.gens()[place] + rest
        images[place] = letter.compose(*images, ctx=context)
        change = list(letters)
        change[place] = (letters[place] - Ratio(free, rest)) / Ratio(free, slope)
        inverse = [symbol.compose(change) for symbol in inverse]
    ring = Ring(names, images)
    own = list(ring.symbols().values())
    inverse = [symbol.compose(own) for symbol in inverse]
    named = {name: ratio.compose(inverse) for name, ratio in symbols.meaning.items()}
    chain = replace(symbols.chain, parameters=parameters(symbols.chain.parameters, named))
    return replace(symbols, chain=chain, ring=ring)


def _letters(found: list[fmpq_mpoly]) -> Iterator[tuple[int, fmpq_mpoly, fmpq_mpoly]]:
    """New letters one by one: slope * old letter + rest, in the old letter's place, for old letters of one rate only.

    A slope is a product of symbols, neither it nor the rest has the old letter: so what is irreducible in letters is so
    in symbols, but for symbols that it is multiplied by, and integers without a common divisor have none afterwards.
    """
    rates = [rate for number, rate in enumerate(found) if not any(rate == other for other in found[:number])]
    for products in (True, False):
        for number, rate in enumerate(rates):
            others = rates[:number] + rates[number + 1 :]
            for place, symbol in enumerate(rate.context().gens()):
                slope = rate.derivative(place)
                alone = not any(other.degrees()[place] for other in others) and not slope.degrees()[place]
                if alone and _power_product(slope) and slope.is_constant() != products and rate != symbol:
                    yield place, slope, 0 * rate if products else rate - symbol
                    rates[number] = rate - slope * symbol + symbol if products else symbol
                    break


def _power_product(polynomial: fmpq_mpoly) -> bool:
    """Whether it is a product of symbols, or 1."""
    return len(polynomial) == 1 and bool(polynomial.leading_coefficient() == 1)
