"""Walk polynomials as a document: text for the terminal, LaTeX, JSON for machines."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass

from flint import fmpq

from wavesym.derivation.symbolic import SymbolicChain
from wavesym.derivation.table import Function, Rules
from wavesym.derivation.walks import Letters, Unit, departures, function_walks, letters, units, walks
from wavesym.documents.derivation.document import template
from wavesym.errors import CostError
from wavesym.mechanics.node import Quantity
from wavesym.numbers.ratio import Ratio
from wavesym.rendering import render

MOST_TERMS = 1_000_000  # about 200 MB


@dataclass(frozen=True)
class Polynomial:
    """What a function gains in an interval; `powers` has the highest power beside each rate, by its letter."""

    function: str
    interval: int
    polynomial: str
    powers: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class WalkResponse:
    """The polynomials for one source, over `unit`."""

    source: str
    unit: str
    polynomials: tuple[Polynomial, ...]


@dataclass(frozen=True)
class Walks:
    """The walk polynomials of a chain in its `letters`."""

    name: str
    m: int
    intervals: int
    letters: tuple[tuple[str, str], ...]
    responses: tuple[WalkResponse, ...]


def walk_polynomials(chains: Iterable[SymbolicChain], intervals: int, format: str) -> str:
    """The walk polynomials of every function for every source, `intervals` of each, as "text", "latex" or "json".

    CostError where they would have more than MOST_TERMS terms.
    """
    write = _latex if format in ("latex", "fragment") else str
    made = tuple(_walks(symbols, intervals, write) for symbols in chains)
    if format == "json":
        return json.dumps([asdict(walks) for walks in made], indent=2) + "\n"
    return render(template("walks", format), systems=made)


def _walks(symbols: SymbolicChain, intervals: int, write: Callable[[str], str]) -> Walks:
    names = letters(symbols.chain)
    return Walks(
        symbols.chain.system.name,
        symbols.chain.m,
        intervals,
        tuple(_meanings(names, write)),
        tuple(_response(symbols, unit, names, intervals, write) for unit in units(symbols.chain)),
    )


def _meanings(names: Letters, write: Callable[[str], str]) -> Iterator[tuple[str, str]]:
    for name, rate in names.rates.items():
        bodies = ", ".join(str(x) for x, letter in names.visit.items() if letter == name)
        yield write(name), f"q/(s + q), q = {write(_plain(rate))}, x = {bodies}"
    for name, share in names.shares.items():
        bodies = ", ".join(str(x) for x, letter in names.share.items() if letter == name)
        yield write(name), f"{write(_plain(share))}, x = {bodies}"


def _response(
    symbols: SymbolicChain, unit: Unit, names: Letters, intervals: int, write: Callable[[str], str]
) -> WalkResponse:
    chain = symbols.chain
    step = Rules(chain).interval
    times = departures(chain, step, intervals)
    terms = 0
    for tau, sent in enumerate(walks(chain, unit, names, names.symbols), 1):
        terms += sum(len(waves[-1]) for node in sent for waves in node)
        if terms > MOST_TERMS:
            raise CostError(
                f"--intervals: the walk polynomials of {tau} of {times} units of tau have {terms:.1e} terms, the "
                f"limit is {MOST_TERMS:.1e} (fewer intervals help)"
            )
        if tau == times:
            break
    polynomials = []
    for letter in "fg":
        for rod in range(1, chain.m + 1):
            for n in range(1, intervals + 1):
                polynomial = function_walks(chain, sent, Function(letter, rod), n, step)
                if polynomial:
                    degrees = zip(names.names, map(int, polynomial.degrees()), strict=True)
                    powers = tuple((write(name), d - 1) for name, d in degrees if d and name in names.rates)
                    polynomials.append(Polynomial(write(f"{letter}_{rod}"), n, write(str(polynomial)), powers))
    over = "s" if unit.power == 0 else f"s^{unit.power + 1}"
    return WalkResponse(unit.name, f"({write(_plain(unit.value))})/{over}", tuple(polynomials))


def _plain(value: Quantity) -> str:
    return str(value if isinstance(value, (Ratio, fmpq)) else fmpq(value))


def _latex(text: str) -> str:
    """The same in LaTeX: indices and exponents in braces, products without a sign."""
    braced = re.sub(r"(\*\*|\^)(\d+)", r"^{\2}", re.sub(r"_(\d+)", r"_{\1}", text))
    return braced.replace("*", r" \, ").replace("kappa", r"\kappa")
