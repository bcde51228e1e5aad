"""What a check finds: solutions refined until they tell their own error, rows of a table, and whether all is right."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.results.presentation import align_columns
from wavesym.verification.reference import ReferenceOutputs

FINE = 1e-6
"""Integrations are refined until their own bound is as small as this, as long as that does not take too long."""

LOOSE = 1e-2
"""An integration that may be more wrong than this part of an output's largest value does not judge it."""

# what would be wrong has so many times twice as many steps before it is
_DOUBTED = 3

REFUSED = "refused"
"""The cell of what was not tried."""


@dataclass(frozen=True)
class IntegratedOutput:
    """An output as an integration has it: `values` at `taus`, none wrong by more than `error_bound`.

    Its instants may keep `clear` of fronts.
    """

    taus: Sequence[float]
    values: Array
    error_bound: float
    clear: bool = False

    @property
    def size(self) -> float:
        """The largest absolute value."""
        return float(np.max(np.abs(self.values), initial=0.0))

    @property
    def steepest(self) -> float:
        """How fast it changes, at most."""
        apart = np.diff(self.taus)  # the last of them may be the horizon twice
        return float(np.max(np.abs(np.diff(self.values)[apart > 0] / apart[apart > 0]), initial=0.0))

    @property
    def judges(self) -> bool:
        """Whether it is exact enough to judge the output by; what is 0 throughout has to be 0 but for rounding."""
        return len(self.values) > 0 and self.error_bound <= LOOSE * (self.size or 1.0)


Integrals = Sequence[IntegratedOutput | None]
"""What integrations have of each output."""


@dataclass(frozen=True)
class ProgramValues:
    """A program in a language, run: its values, (outputs, n), at `taus`, or as much as `late` beside them.

    `sizes` are the largest values of outputs, and `bounds` what it states of its errors relative to these. One that
    has other parameters than the scene is compared with `integrals` alone. Instants that are as `close` are the same.
    A `note` says what is wrong with it already, `refused` why it was not run.
    """

    name: str
    taus: Array
    values: Array
    sizes: Sequence[float]
    bounds: Sequence[float]
    late: float = 0.0
    note: str = ""
    integrals: Integrals = ()
    close: float = 0.0
    refusal: str = ""


@dataclass(frozen=True)
class Outcome:
    """What a check found for a subject, an output or another: cells by column, and whether all is as it may be.

    `note` is for what does not fit into a column, `integral` for programs to be compared with. It may be not `decided`.
    """

    subject: str
    cells: Mapping[str, str]
    passed: bool
    note: str = ""
    integral: IntegratedOutput | None = None
    decided: bool = True

    @property
    def verdict(self) -> str:
        """As the last column has it."""
        if not self.passed:
            return "FAIL"
        return "PASS" if self.decided and REFUSED not in self.cells.values() else "-"


@dataclass(frozen=True)
class Check:
    """A check, and what stands over the table of its outcomes."""

    title: str
    run: Callable[[ReferenceOutputs], Sequence[Outcome]]


@dataclass(frozen=True)
class Solution:
    """An output as one integration has it: values at instants, and what rounding may have added, absolute."""

    values: Array
    rounding: float = 0.0


@dataclass(frozen=True)
class Truth:
    """The true values of an output at some instants, and what errors are relative to."""

    values: Array
    scale: float


Rule = Literal["plain", "extrapolated", "smeared", "wandering", "late"]
"""How errors fall: at least as the step does; as a series in its square; so but where fronts bend, as the step to the
power 2/3; in two halvings by a half; or not even that, as steps are late by a part of themselves that is another one on
each grid."""


@dataclass(frozen=True)
class Refinement:
    """Errors at N, 2N and 4N, that of what is best, and what it may be: `method_error`, which is what lies between
    solutions, and rounding.

    `values` are the best ones. Errors are relative to `scale`; without a truth they are differences from the best.
    """

    errors: tuple[float, ...]
    best: float
    method_error: float
    rounding: float
    values: Array
    scale: float

    @classmethod
    def compare(cls, solutions: Sequence[Solution], truth: Truth | None, rule: Rule) -> Refinement:
        """Compare an output with N, 2N and 4N steps.

        Args:
            solutions: the three.
            truth: what is known of it at the same instants; else errors are relative to the largest value.
            rule: how errors of the method fall.
        """
        coarse, half, quarter = (each.values for each in solutions)
        size = truth.scale if truth else float(np.max(np.abs(quarter), initial=0.0)) or 1.0

        def largest(difference: Array) -> float:
            return float(np.max(np.abs(difference), initial=0.0)) / size

        best, between = quarter, largest(quarter - half)
        if rule in ("extrapolated", "smeared"):
            best = quarter + (quarter - half) / 3
            between = largest(best - half - (half - coarse) / 3)
        elif rule in ("wandering", "late"):
            between += largest(half - coarse)
        if rule in ("smeared", "late"):
            between *= 2
        right = truth.values if truth else best
        errors = tuple(largest(values - right) for values in (coarse, half, quarter))
        return cls(errors, largest(best - right), between, solutions[-1].rounding / size, best, size)

    @property
    def error_bound(self) -> float:
        """What the best error may be."""
        return self.method_error + self.rounding

    @property
    def is_right(self) -> bool:
        """Whether it is; never where something is NaN."""
        return self.best <= self.error_bound

    def cells(self, steps: int) -> Mapping[str, str]:
        """The columns of a table, N = `steps`; the order is observed where errors are more than rounding."""
        seen = [error for error in self.errors if error > self.rounding]
        order = f"{math.log2(seen[-2] / seen[-1]):.1f}" if len(seen) > 1 else "-"
        cells = dict(zip(("at N", "at 2N", "at 4N"), map(format_error, self.errors), strict=True))
        best = {} if self.best == self.errors[-1] else {"extrapolated": format_error(self.best)}
        return {"N": str(steps), **cells, "order": order, **best, "allowed": format_error(self.error_bound)}


@dataclass(frozen=True)
class Integration:
    """An integration: `solve` gives every output with so many times the coarsest number of steps, `coarsest`.

    It is refined as long as `is_affordable` says so of that. `instants` are those of each output's values. What happens
    at corners may be `late` by so much with N steps: where events do not converge, a difference of grids is no bound.
    Nor is it where events have missed instants of all grids alike, by `front_offset` in all.
    """

    name: str
    coarsest: int
    solve: Callable[[int], Sequence[Solution]]
    is_affordable: Callable[[int], bool]
    rule: Rule
    instants: Sequence[Sequence[float]]
    clear: bool = False
    late: float = 0.0
    front_offset: float = 0.0

    def refine(self, truths: Sequence[Truth | None]) -> tuple[int, list[Refinement]]:
        """N, and all outputs with N, 2N and 4N steps, compared with their values and scales where these are known."""
        finer, doubted = 1, 0
        solved = [self.solve(finer * k) for k in (1, 2, 4)]
        while True:
            outputs = zip(truths, zip(*solved, strict=True), strict=True)
            found = [Refinement.compare(each, truth, self.rule) for truth, each in outputs]
            fine = all(each.method_error <= FINE for each in found)
            # what would be wrong is looked at more closely: solutions may agree as none resolves what decays fast
            doubted += fine
            settled = fine and (all(each.is_right for each in found) or doubted > _DOUBTED)
            if settled or not self.is_affordable(8 * finer):
                return self.coarsest * finer, found
            finer *= 2
            solved = [*solved[1:], self.solve(4 * finer)]

    def outcomes(
        self, scene: str, names: Sequence[str], truths: Sequence[Truth | None], cells: Mapping[str, str]
    ) -> list[Outcome]:
        """A row for each output; where there is no truth, one is right that is exact enough to judge others."""
        steps, refined = self.refine(truths)
        outcomes = []
        for name, truth, taus, each in zip(names, truths, self.instants, refined, strict=True):
            is_still = truth is not None and not np.any(truth.values) and each.best <= each.rounding
            values = np.zeros_like(each.values) if is_still else each.values  # 0, but for rounding
            integral = IntegratedOutput(taus, values, each.error_bound * each.scale, self.clear)
            note = "" if each.method_error <= FINE else too_coarse(scene, self.name)
            right = integral.judges if truth is None else each.is_right
            lag = integral.steepest * self.late * self.coarsest / (4 * steps)
            error, unseen = each.best * each.scale, integral.steepest * self.front_offset
            agreed = each.method_error <= FINE and not error <= integral.error_bound + unseen
            decided = right or agreed or not error <= integral.error_bound + lag
            if not decided:
                integral = replace(integral, error_bound=integral.error_bound + lag)
                note = f"{scene}: the {self.name} does not decide {name}, as what happens at corners comes a step late"
            outcomes.append(
                Outcome(name, {**cells, **each.cells(steps)}, right or not decided, note, integral, decided)
            )
        return outcomes


def refused_outcomes(known: ReferenceOutputs, column: str, why: str) -> list[Outcome]:
    """A row for each output that says that it was not tried, and why."""
    return [Outcome(probe.name, {column: REFUSED}, True, f"{known.whole.name}: {why}") for probe in known.whole.probes]


def too_coarse(scene: str, what: str) -> str:
    """What is said of something that is less exact than all should be."""
    return f"{scene}: the {what} is too coarse to tell errors below {FINE:.0e}"


def format_error(error: float) -> str:
    """An error as a cell of a table."""
    return f"{error:.1e}" if error else "0"


Row = dict[str, str]


def table(rows: Sequence[Row], names: Sequence[str]) -> list[str]:
    """Lines of aligned columns: `names` to the left, numbers to the right, and "verdict" last."""
    columns = [column for column in dict.fromkeys(column for row in rows for column in row) if column != "verdict"]
    columns.append("verdict")  # last, where a row has fewer columns too
    grid = [columns, *([row.get(column, "-") for column in columns] for row in rows)]
    return align_columns(grid, [number for number, column in enumerate(columns) if column in names])
