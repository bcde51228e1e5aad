"""The rates gamma, and what Tables 2 to 4 leave unsaid: their highest powers are those of bodies whose rates differ.

A body that is shaken at its own rate answers with one power more, so that powers of bodies with one rate add up. Where
rates differ the powers of the tables are the highest there can be; for special ones some cancel. The tables are tried
on chains with all rates different, with neighbours equal, and with one twice another.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from itertools import product
from typing import Any

from flint import fmpq

from wavesym.mechanics.node import Parameters
from wavesym.papers.exact_tables import Exact, collision, with_parameters
from wavesym.papers.pielorz1979.forms import EXACT
from wavesym.papers.pielorz1979.tables import EXAMPLE

_ONE, _A, _B, _C = fmpq(1), fmpq(2, 3), fmpq(3, 5), fmpq(5, 7)
_COLLISIONS = (
    (_A, _B),
    (_A, 2 * _A),
    (2 * _A, _A),
    (_A, _B, _B),
    (_A, _A, _B),
    (_A, _B, _C),
    (_ONE, 2 * _ONE, 3 * _ONE),
)
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
_BUILDINGS = ((2, _A, _B), (2, _A, 2 * _A), (3, _A, _B), (3, _A, 2 * _A))  # m, kappa of floors, of the roof
INTERVALS = 9


def _variants(table: str) -> Iterator[tuple[int, Parameters]]:
    """m and parameters."""
    if table == "T2":
        for kappas in _COLLISIONS:
            m = 2 * len(kappas)
            velocity = collision(m).chain.parameters.velocity
            yield m, Parameters(kappa={2 * i + 1: kappa for i, kappa in enumerate(kappas)}, velocity=velocity)
    elif table == "T3":
        for shafts, discs in _DRIVES:
            yield len(shafts), Parameters(kappa=_each(shafts), inertia=_each(discs))
    else:
        for m, floor, roof in _BUILDINGS:
            yield m, Parameters(kappa={0: _C, **dict.fromkeys(range(1, m), floor), m: roof})


def _each(values: Iterable[Any]) -> dict[int, fmpq]:
    return {i: fmpq(value) for i, value in enumerate(values, 1)}


@cache
def chains_of_rates(table: str) -> tuple[tuple[Exact, bool], ...]:
    """Chains with different and with equal rates, and whether no power is higher than where nothing cancels.

    There all rates are different.

    Lower ones there are: of bodies with kappa 1, 2, 3 those of the middle one cancel.
    """
    found = []
    for m, parameters in _variants(table):
        usual = EXACT[EXAMPLE[table]](m)
        exact = with_parameters(usual, parameters)
        bodies: dict[fmpq, set[fmpq]] = {}
        for (_, rate), (_, other) in zip(exact.rates.items(), usual.rates.items(), strict=True):
            bodies.setdefault(rate, set()).add(other)
        functions = product("fg", range(1, m + 1), range(1, INTERVALS + 1))
        same = all(
            exact.degree(*place, rate, source) <= max(usual.degree(*place, other, source) for other in others)
            for place, source, (rate, others) in product(functions, exact.responses, bodies.items())
        )
        found.append((exact, same))
    return tuple(found)
