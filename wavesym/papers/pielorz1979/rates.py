"""What Tables 2 to 4 leave unsaid: their highest powers are those of bodies whose rates differ.

A body that is shaken at its own rate answers with one power more, so that powers of bodies with one rate add up. The
tables are tried on chains with all rates different, with every pair equal, and with one twice another.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache, partial
from itertools import product
from typing import Any

from flint import fmpq

from wavesym.model.node import Parameters
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import Scope, holds, span
from wavesym.papers.exact_tables import Exact, collision, gammas, with_parameters
from wavesym.papers.mutations import ends
from wavesym.papers.pielorz1979.cells import KINDS
from wavesym.papers.record import Case, Reading, Test
from wavesym.papers.tree import Progression, Symbol, Tree, latex

Numbers = Mapping[int, fmpq]
_A, _B, _C = fmpq(2, 3), fmpq(3, 5), fmpq(5, 7)
_COLLISIONS = ((_A, _B), (_A, _A), (_A, 2 * _A), (2 * _A, _A), (_A, _B, _B), (_A, _B, _A), (_A, _A, _B), (_A, _B, _C))
_DRIVES = (  # kappa, J
    ((_A,), (1, 3)),
    ((_A,), (1, 1)),
    ((_A,), (2, 1)),
    ((_A,), (1, 2)),
    ((_A, _B), (1, 2, 3)),
    ((_A, _A / 2), (1, 2, 3)),
    ((_A, _B), (1, 2, 2 * _B / _A)),
    ((_A, _A), (1, 2, fmpq(4, 3))),
)
INTERVALS = 9
_BUILDINGS = ((2, _A, _B), (2, _A, 2 * _A), (3, _A, _B), (3, _A, 2 * _A))  # m, kappa of floors, of the roof


def rates(entry: Entry) -> Test:
    """The functions of a table: for which rates its powers are theirs."""
    return Test(
        "the degrees of exact tables with equal rates, beside those with different ones: a power of the table is "
        "the highest of all bodies with its rate",
        partial(_cases, entry.id[:2]),
        faults=_faults,
    )


def _faults(right: Reading) -> Iterator[tuple[str, Reading]]:
    """Those of the ranges: the letter names functions."""
    for place, range_ in enumerate(right.ranges):
        for change, wrong in ends(range_):
            yield change, Reading(right.formula, (*right.ranges[:place], wrong, *right.ranges[place + 1 :]))


def _cases(table: str, reading: Reading) -> Iterator[Case]:
    for number in range(len(_variants(table))):
        exact, true = _tabled(table, number)
        scope = _Rates(exact)
        name, values = scope.shown(table)
        yield Case({"m": exact.m, name: values, "claim": "powers as tabled"}, _all(reading.ranges, scope), true)


def _all(ranges: tuple[Tree, ...], scope: Scope) -> bool:
    """Whether the conditions hold for all values of i and j."""
    if not ranges:
        return True
    first, *rest = ranges
    if not isinstance(first, Progression):
        return holds(first, scope) and _all(tuple(rest), scope)
    results = []
    for value in span(first, scope):
        with scope.binding({latex(first.variable): value}):
            results.append(_all(tuple(rest), scope))
    return all(results)


class _Rates(Scope):
    """The rates of a chain: kappa and gamma."""

    def __init__(self, exact: Exact) -> None:
        super().__init__({"m": exact.m})
        self._values: Mapping[str, Numbers] = {r"\kappa": exact.chain.parameters.kappa, r"\gamma": gammas(exact)}

    def symbol(self, symbol: Symbol) -> Any:
        if symbol.name in self._values and len(symbol.below) == 1:
            (body,) = self.indices(symbol)
            if body in self._values[symbol.name]:
                return self._values[symbol.name][body]
        return super().symbol(symbol)

    def shown(self, table: str) -> tuple[str, tuple[fmpq, ...]]:
        """The parameters that matter to a table."""
        name = "gamma" if table == "T3" else "kappa"
        return name, tuple(value for _, value in sorted(self._values[f"\\{name}"].items()))


@cache
def _variants(table: str) -> tuple[tuple[int, Parameters], ...]:
    """m and parameters."""
    if table == "T2":
        return tuple(
            (
                2 * len(k),
                Parameters(
                    kappa={2 * i - 1: kappa for i, kappa in _each(k).items()},
                    velocity=collision(2 * len(k)).chain.parameters.velocity,
                ),
            )
            for k in _COLLISIONS
        )
    if table == "T3":
        return tuple((len(k), Parameters(kappa=_each(k), inertia=_each(J))) for k, J in _DRIVES)
    return tuple((m, Parameters(kappa={0: _C, **dict.fromkeys(range(1, m), k), m: r})) for m, k, r in _BUILDINGS)


def _each(values: Any) -> dict[int, fmpq]:
    return {i: fmpq(value) for i, value in enumerate(values, 1)}


@cache
def _tabled(table: str, number: int) -> tuple[Exact, bool]:
    """A chain, and whether its highest powers are those of chains with all rates different."""
    m, parameters = _variants(table)[number]
    usual = KINDS[table].tables(m)
    exact = with_parameters(usual, parameters)
    bodies: dict[fmpq, list[fmpq]] = {}
    for rate, other in zip(_of(table, exact), _of(table, usual), strict=True):
        bodies.setdefault(rate, []).append(other)
    places = product("fg", range(1, m + 1), range(1, INTERVALS + 1))
    return exact, all(
        exact.degree(*place, rate, source) == max(usual.degree(*place, other, source) for other in others)
        for place, source, (rate, others) in product(places, exact.responses, bodies.items())
    )


def _of(table: str, exact: Exact) -> tuple[fmpq, ...]:
    """The rates of the bodies, in their order."""
    if table == "T3":
        return tuple(gammas(exact).values())
    kappa = exact.chain.parameters.kappa
    return tuple(2 * kappa[i] for i in sorted(kappa)) if table == "T2" else (2 * kappa[1], fmpq(kappa[exact.m]))
