"""The quantities without dimensions: each put into (4.2), which has to be the motion with it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, given, sides
from wavesym.papers.pielorz1979.motion import NODES, Moving, scopes, solution_cases
from wavesym.papers.pielorz1979.transcript import paper
from wavesym.papers.reader import read_formula
from wavesym.papers.record import Case, Reading, Test
from wavesym.papers.tree import Call, Symbol, Tree, latex


def definition(entry: Entry) -> Test:
    """A quantity without dimensions: put into (4.2), which no other of its name then has a place in."""

    def cases(reading: Reading) -> Iterator[Case]:
        letter, means = sides(reading.formula)
        defining = ((at, _Defining(scope, letter, means)) for at, scope in scopes(given(reading.ranges)))
        yield from solution_cases(reading, _printed_formula("(4.2)"), defining)

    return Test(f"(4.2) with it: {NODES}", cases)


class _Defining(Moving):
    """(4.2) where one letter is what its definition makes of the motion in physical units."""

    def __init__(self, scope: Moving, letter: Tree, means: Tree) -> None:
        super().__init__(scope.motion, scope.units, scope.constants)
        if not isinstance(letter, Symbol):
            raise MeaninglessError(f"{latex(letter)} is no letter to define")
        self.letter, self.means = letter, means

    def at(self, x: Any, tau: Any) -> Mapping[str, Any]:
        known = super().at(x, tau)
        return {name: known[name] for name in known if name != latex(self.letter)}

    def symbol(self, symbol: Symbol) -> Any:
        return self._meaning() if self._defined(symbol) else super().symbol(symbol)

    def call(self, call: Call) -> Any:
        if not self._defined(call.function) or len(call.arguments) != 1:
            return super().call(call)
        return self._meaning(z=self.value(call.arguments[0]))

    def unit(self, function: Symbol) -> Any:
        if not self._defined(function):
            return super().unit(function)
        return self._meaning(U=self.units.U_0)

    def _defined(self, symbol: Symbol) -> bool:
        """Whether it is the letter; MeaninglessError where it is one of its name that stays undefined."""
        if symbol.name == self.letter.name and len(symbol.below) == len(self.letter.below) and symbol != self.letter:
            raise MeaninglessError(f"(4.2) has {latex(symbol)}, and {latex(self.letter)} is defined")
        return symbol == self.letter

    def _meaning(self, **more: Any) -> Any:
        physical = Moving(self.motion, self.units, self.constants)
        physical.bound = {**self.bound, **more}
        return physical.value(self.means)


def _printed_formula(id: str) -> Tree:
    """What another record has as printed."""
    (found,) = (entry for entry in paper().entries() if entry.id == id)
    return read_formula(found.printed)
