"""What Tables 2, 3 and 4 have in common: cells that are formulas for a highest power or for the end of a range.

A cell is tested in its row, the other cells as they should be, against the degrees of the exact tables; a power below 0
says that there is no such term.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from wavesym.papers.record import Case, Claim, Slip, Slipped


@dataclass(frozen=True)
class Index:
    """The variables of a cell; those that a table does not have are 0."""

    m: int
    n: int
    i: int
    j: int = 0
    r: int = 0
    l: int = 0  # noqa: E741 - the paper's letter

    @property
    def r_0(self) -> int:
        """1 for even i, 0 for odd i."""
        return 1 - self.i % 2

    @property
    def r_1(self) -> int:
        """0 for even i, 1 for odd i."""
        return self.i % 2


Formula = Callable[[Index], Fraction | int]
Formulas = Mapping[str, Formula]


@dataclass(frozen=True)
class Cell:
    """A formula beside its literal text; where that is wrong, what is right."""

    text: str
    formula: Formula
    slip: Slip[Formula] | None = None

    @property
    def right(self) -> Formula:
        return self.slip.reading if self.slip else self.formula


def wrong(kind: Slipped, text: str, formula: Formula, corrected: str, right: Formula, note: str) -> Cell:
    """A cell that does not hold as transcribed."""
    return Cell(text, formula, Slip(kind, corrected, right, note))


def cell_claim(
    id: str, where: str, cell: Cell, ranges: str, against: str, cases: Callable[[Formula], Iterable[Case]]
) -> Claim[Formula]:
    """The claim of a cell; one more and one less are its faults."""
    return Claim(
        id,
        where,
        cell.text,
        ranges,
        against,
        cases,
        cell.formula,
        {"one more": shifted(cell.right, 1), "one less": shifted(cell.right, -1)},
        cell.slip,
    )


def shifted(formula: Formula, by: int) -> Formula:
    """The formula plus a number."""
    return lambda index: formula(index) + by


def half(twice: int) -> Fraction:
    """A half, which is whole where a formula is right."""
    return Fraction(twice, 2)


def present(power: Fraction | int) -> Fraction | int:
    """A highest power, -1 for all that say that there is no such term."""
    return max(power, -1)
