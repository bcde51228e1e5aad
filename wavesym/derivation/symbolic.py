"""A chain with symbols for its numbers: the rules run over it as over numbers, and the table holds rational functions.

The symbols are kappa_i, r_i = J_i/J_(i+1) and u_i = v_(i-1) - v_(i+1), the jump of velocity at the contact x = i.
What is equal in a scene is one symbol, named after the first; shafts between equal discs have r = 1, bodies that move
together u = 0. Rates that meet in a scene, as 2 kappa_1 = kappa_m, meet in its symbols: coefficients have poles there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from math import factorial

from flint import fmpq, fmpq_mpoly

from wavesym.errors import SceneError
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters, Quantity, System
from wavesym.numbers.factorization import polynomial_text
from wavesym.numbers.ratio import Ratio, Ring


@dataclass(frozen=True)
class SymbolicChain:
    """`chain` has symbols for numbers; `meaning` has what every parameter is in them, `values` what they are."""

    chain: Chain
    ring: Ring
    meaning: Mapping[str, Ratio]
    values: Mapping[str, fmpq]


def symbolic(chain: Chain) -> SymbolicChain:
    """The chain of a scene with its pattern of equal parameters and rates. SceneError where symbols cannot have it."""
    given = _parameter_names(chain.parameters)
    values: dict[str, fmpq] = {}
    same: dict[str, str] = {}
    for name, value in given.items():
        first = (other for other in values if other[0] == name[0] and values[other] == value)
        if value != _TRIVIAL.get(name[0]):
            same[name] = next(first, name)
            values.setdefault(same[name], value)
    ring = Ring(tuple(values))
    symbols = ring.symbols()
    free = {name: symbols[same[name]] if name in same else ring.constant(_TRIVIAL[name[0]]) for name in given}
    images = _images(ring, replace(chain, parameters=parameters(chain.parameters, free)), values)
    meaning = {name: ratio.compose(images) for name, ratio in free.items()}
    return SymbolicChain(replace(chain, parameters=parameters(chain.parameters, meaning)), ring, meaning, values)


def generic(system: System, m: int) -> SymbolicChain:
    """The chain of m rods whose parameters are all different, and no rates meet."""
    return symbolic(unlike_chain(system, m))


def unlike_chain(system: System, m: int) -> Chain:
    """The same in numbers."""
    numbers = {name: {i: _DIFFERENT[name](i) for i in indices} for name, indices in system.indices(m).items()}
    return Chain(system, m, Parameters(**numbers))


# any numbers will do of which no two, and no two sums below, are equal
_DIFFERENT: Mapping[str, Callable[[int], fmpq]] = {
    "kappa": lambda i: fmpq(1000 ** (i + 1) + i),
    "inertia": lambda i: fmpq(1, factorial(i)),
    "velocity": lambda i: fmpq(-(2**i)),
    "dashpot": lambda i: fmpq(1, 1000 ** (i + 1)),
}
_TRIVIAL = {"r": fmpq(1), "u": fmpq(0), "b": fmpq(0)}


def _parameter_names(p: Parameters) -> dict[str, fmpq]:
    """The independent parameters of a system by the names of their symbols."""
    named = {f"kappa_{i}": value for i, value in p.kappa.items()}
    if p.inertia:
        named |= {f"r_{i}": p.inertia[i] / p.inertia[i + 1] for i in sorted(p.inertia)[:-1]}
    if p.velocity:
        named |= {f"u_{i + 1}": p.velocity[i] - p.velocity[i + 2] for i in sorted(p.velocity)[:-1]}
    return named | {f"b_{i}": value for i, value in (p.dashpot or {}).items()}


def parameters(p: Parameters, named: Mapping[str, Quantity]) -> Parameters:
    """The parameters of (2.1)-(2.5) from the independent ones: the last disc has inertia 1, the last body rests."""
    inertia, velocity = None, None
    if p.inertia:
        *others, last = sorted(p.inertia)
        inertia = {last: fmpq(1)}
        for i in reversed(others):
            inertia[i] = named[f"r_{i}"] * inertia[i + 1]
    if p.velocity:
        *others, last = sorted(p.velocity)
        velocity = {last: fmpq(0)}
        for i in reversed(others):
            velocity[i] = named[f"u_{i + 1}"] + velocity[i + 2]
    dashpot = {i: named[f"b_{i}"] for i in p.dashpot} if p.dashpot else None
    return Parameters({i: named[f"kappa_{i}"] for i in p.kappa}, inertia, velocity, dashpot)


def rates(chain: Chain) -> dict[int, Ratio]:
    """The rates of the bodies by their places, those that depend on a symbol."""
    found = {x: node.rate for x, node in enumerate(chain.nodes) if node.inertia}
    return {x: rate for x, rate in found.items() if isinstance(rate, Ratio)}


def _images(ring: Ring, chain: Chain, values: Mapping[str, fmpq]) -> list[Ratio]:
    """What the symbols become where rates are equal in numbers but not in symbols: one symbol less for each.

    SceneError where no symbol can be told by the others.
    """
    images = list(ring.symbols().values())
    for (x, one), (y, other) in combinations(rates(chain).items(), 2):
        difference = one.compose(images) - other.compose(images)
        if difference == 0 or difference.evaluate(values) != 0:
            continue
        _, factors = difference.numerator.factor()
        relation = next(factor for factor, _ in factors if Ratio(ring, factor).evaluate(values) == 0)
        place = _place(ring, relation, values)
        if place is None:
            raise SceneError(
                f"the rates of the bodies at x = {x} and {y} meet where {polynomial_text(relation)} = 0, which no "
                "symbol can be told from by the others; there is no symbolic table for that",
                "system",
            )
        letters = list(ring.symbols().values())
        letters[place] = letters[place] - Ratio(ring, relation) / Ratio(ring, relation.derivative(place))
        images = [image.compose(letters) for image in images]
    return images


def _place(ring: Ring, relation: fmpq_mpoly, values: Mapping[str, fmpq]) -> int | None:
    """The symbol that follows from the others where `relation` is 0: the last one that is a polynomial in them.

    Where there is none it is a kappa rather than a ratio of inertia: rates are linear in kappa, and stay so.
    """
    slopes = [(place, relation.derivative(place)) for place, power in enumerate(relation.degrees()) if power == 1]
    constant = [place for place, slope in slopes if slope.is_constant()]
    others = [place for place, slope in slopes if Ratio(ring, slope).evaluate(values) != 0]
    return constant[-1] if constant else next(iter(others), None)


def in_rates(symbols: SymbolicChain) -> SymbolicChain:
    """Compute the same chain in letters that suit its rates: who reads it sees the symbols only.

    In kappa_i and r_i a rate kappa_i r_i + kappa_(i+1) has two terms, a difference of rates, of which denominators are
    made, up to four; multiplied out that is three times as much. With kappa_i r_i and that rate as letters in place of
    r_i and kappa_(i+1), a table is made and factored in a fraction of the time.
    """
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
