"""What stands under (4.10): the rates gamma_i of (4.11), and L_0, r_0, r_1, which Table 3 is written in."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import product
from typing import Any

from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, items, sides, span
from wavesym.papers.exact_tables import INTERVALS as TABULATED
from wavesym.papers.exact_tables import Exact, drive
from wavesym.papers.pielorz1979 import limits
from wavesym.papers.pielorz1979.forms import (
    Definitions,
    Form,
    FormScope,
    corrected,
    defined,
    form_cases,
    known,
    moved,
    only,
    rates,
    read_definitions,
)
from wavesym.papers.pielorz1979.transcript import entry as transcribed
from wavesym.papers.pielorz1979.transcript import paper
from wavesym.papers.reader import read_formula
from wavesym.papers.record import Case, Reading, Test, case
from wavesym.papers.tree import Symbol, Tree, latex


class RateScope(Scope):
    """kappa and J of a drive."""

    def __init__(self, exact: Exact) -> None:
        super().__init__({"m": exact.m})
        self._parameters = exact.chain.parameters

    def symbol(self, symbol: Symbol) -> Any:
        """kappa_i or J_i."""
        values = {r"\kappa": self._parameters.kappa, "J": self._parameters.inertia}.get(symbol.name)
        if values is None or len(symbol.below) != 1:
            return super().symbol(symbol)
        return known(values, self.indices(symbol)[0], symbol.name)


def rate(entry: Entry) -> Test:
    """Adapter: gamma_i; the formulas of (4.11) together give every one once."""
    others = [corrected(other) for other in paper().entries() if other.kind == "rate" and other.id != entry.id]
    return Test(
        "the rates of the discs by their derived node laws, m = 1 ... 5",
        lambda reading: _rate_cases(reading, others),
    )


def _rate_cases(reading: Reading, others: Iterable[Reading]) -> Iterator[Case]:
    for m in range(1, 6):
        exact = drive(m)
        scope = RateScope(exact)
        true = rates(exact)
        parameters = {"kappa": dict(exact.chain.parameters.kappa), "J": dict(exact.chain.parameters.inertia)}
        given = [number for other in (reading, *others) for number, _ in _rates_given(other, scope)]
        yield Case({"m": m, "claim": "the gamma that are given"}, sorted(given), sorted(true))
        for number, value in _rates_given(reading, scope):
            yield case({"m": m, "i": number, **parameters}, value, true.get(number))


def _rates_given(reading: Reading, scope: RateScope) -> list[tuple[int, Callable[[], Any]]]:
    """The number of every gamma, and what makes its value; once where the left index has no i, else for every i."""
    found = []
    for equation in items(reading.formula):
        left, right = sides(equation)
        if not isinstance(left, Symbol) or left.name != r"\gamma" or len(left.below) != 1:
            raise MeaninglessError(f"{latex(left)} is no gamma")
        plain = _means(left, scope)
        for place in [{}] if plain else [{"i": i} for i in span(only("i", reading.ranges), scope)]:
            with scope.binding(place):
                found.append((scope.indices(left)[0], _later(scope, place, right)))
    return found


def _means(left: Symbol, scope: RateScope) -> bool:
    try:
        scope.indices(left)
    except MeaninglessError:
        return False
    return True


def _later(scope: RateScope, place: Mapping[str, int], tree: Tree) -> Callable[[], Any]:
    def value() -> Any:
        with scope.binding(place):
            return scope.value(tree)

    return value


def definition(entry: Entry) -> Test:
    """Adapter: L_0, r_0 and r_1, by what Table 3 makes of them."""
    form = Form.of("II", corrected(transcribed("(4.10)")))

    def cases(reading: Reading) -> Iterator[Case]:
        told = {**read_definitions(), **defined(reading)}
        if len(told) > len(read_definitions()):
            raise MeaninglessError(f"{latex(reading.formula)} defines what is used nowhere")
        if entry.id == "(4.10).L_0":
            yield from form_cases(form, told)
        else:
            yield from _moment_cases(form, told)

    against = "the motion, by (4.10)" if entry.id == "(4.10).L_0" else "the moments that act in a half, by exact tables"
    return Test(against, cases)


def _moment_cases(form: Form, told: Definitions) -> Iterator[Case]:
    """r from s_1 to R_2 counts the moments that act in a half, each once."""
    for m in range(1, 6):
        driven = moved("II", m)
        for half, (letter, rod) in product(limits.HALVES, limits.functions("II", m)):
            scope = FormScope(form, driven, letter, told)
            at = {"m": m, "half": half, "function": f"{letter}_{rod}", "claim": "moments s"}
            true = acting(driven.exact, half, letter, rod)
            yield case(at, lambda: tuple(s for _, s in moments(scope, half, rod)), true)  # noqa: B023


def moments(scope: FormScope, half: str, rod: int, parts: tuple[int, ...] = (1, 2)) -> list[tuple[int, int]]:
    """The r and s that Table 3 has in a half, in the order of their parts alpha."""
    found = []
    for alpha in parts:
        with scope.binding({"n": 0, "half": half, "i": rod, limits.ALPHA: alpha}):
            first, last = (scope.whole(read_formula(rf"{end}_\alpha")) for end in "sR")
            for r in range(first, last + 1):
                with scope.binding({"r": r}):
                    found.append((r, scope.whole(read_formula("s"))))
    return found


def acting(exact: Exact, half: str, letter: str, rod: int) -> tuple[int, ...]:
    """The moments that change a function in some interval of a half, in their order."""
    numbers = range(1 if half == "even" else 2, TABULATED["II"] + 1, 2)
    return tuple(
        s for s in range(1, exact.m + 2) if any(exact.increment(f"M{s}", letter, rod, number) for number in numbers)
    )
