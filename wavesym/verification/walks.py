"""Exact tables by another route: walk polynomials, by partial fractions of products of T = q/(s + q).

No delay equations, recurrences or clocks are used.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import factorial

from flint import fmpq, fmpq_poly, fmpz_mpoly

from wavesym.derivation.increments import Increment, add, trim
from wavesym.derivation.table import Function, Table
from wavesym.derivation.walks import Letters, Unit, departures, function_walks, letters, units, walks_until
from wavesym.mechanics.chain import Chain


def differences(chain: Chain, table: Table) -> Iterator[Function]:
    """A function for each interval in which its increment is not that of its walk polynomial; all equally far."""
    intervals = max(len(gains) for response in table.responses.values() for gains in response.values())
    for source, response in by_walks(chain, table, intervals, letters(chain)).items():
        for function, gains in response.items():
            for ours, theirs in zip(gains, table.responses[source][function], strict=True):
                if ours != theirs:
                    yield function


def by_walks(chain: Chain, table: Table, intervals: int, names: Letters) -> dict[str, dict[Function, list[Increment]]]:
    """The responses of a table from walk polynomials in the letters `names`, the contacts of an impact summed."""
    responses: dict[str, dict[Function, list[Increment]]] = {
        source: {function: [{} for _ in gains] for function, gains in response.items()}
        for source, response in table.responses.items()
    }
    for unit in units(chain):
        sent = walks_until(chain, unit, departures(chain, table.interval, intervals), names, names.symbols)
        response = responses["impact" if unit.name.startswith("impact") else unit.name]
        for function, gains in response.items():
            for n, gain in enumerate(gains, 1):
                polynomial = function_walks(chain, sent, function, n, table.interval)
                add(gain, _expand(polynomial, unit, names))
    return {source: {f: list(map(trim, gains)) for f, gains in r.items()} for source, r in responses.items()}


def _expand(polynomial: fmpz_mpoly, unit: Unit, letters: Letters) -> Increment:
    """The increment whose transform is unit.value/s**(unit.power + 1) times the polynomial; the chain in numbers.

    With u = s + q, the coefficient of u**(-k - 1) over k! is that of exp(-q w) w**k; that of s is rate 0.
    """
    order = dict(zip(letters.names, map(int, polynomial.degrees()), strict=True))
    poles = {fmpq(0): unit.power + 1} | {q: order[name] for name, q in letters.rates.items() if order[name]}
    increment: Increment = {}
    for pole, depth in poles.items():
        taylor = _at_pole(polynomial, pole, depth, letters)
        if pole != 0:
            taylor = taylor * _power(fmpq(1), -pole, unit.power + 1, depth)
        increment[pole] = [unit.value * taylor[depth - 1 - k] / factorial(k) for k in range(depth)]
    return trim(increment)


def _at_pole(polynomial: fmpz_mpoly, pole: fmpq, depth: int, letters: Letters) -> fmpq_poly:
    """The polynomial times u**depth at s = -pole + u, with numbers for the shares; a series to u**depth in front."""
    factors: dict[tuple[str, int], fmpq_poly] = {}

    def factor(name: str, exponent: int) -> fmpq_poly:
        if (name, exponent) not in factors:
            if name in letters.shares:
                power = fmpq_poly([letters.shares[name] ** exponent])
            elif (rate := letters.rates[name]) == pole:
                power = fmpq_poly([0] * (depth - exponent) + [rate**exponent])
            else:
                power = _power(rate, rate - pole, exponent, depth)
            factors[name, exponent] = power
        return factors[name, exponent]

    # a polynomial without this pole's letter still stands over u**0, that is, times u**depth
    own = next((name for name, rate in letters.rates.items() if rate == pole), None)
    total = fmpq_poly()
    for exponents, count in polynomial.to_dict().items():
        product = fmpq_poly([fmpq(int(count))])
        for name, exponent in zip(letters.names, map(int, exponents), strict=True):
            if exponent or name == own:
                product = (product * factor(name, exponent)).truncate(depth)
        total += product
    return total


def _power(above: fmpq, at: fmpq, exponent: int, depth: int) -> fmpq_poly:
    """(above/(at + u))**exponent to u**(depth - 1): a binomial series."""
    coefficients = [(above / at) ** exponent]
    for k in range(1, depth):
        coefficients.append(coefficients[-1] * fmpq(-(exponent + k - 1), k) / at)
    return fmpq_poly(coefficients)
