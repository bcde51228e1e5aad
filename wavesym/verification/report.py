"""Every check on every output of every scene, as a table of errors and one verdict."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from wavesym.scene import Scene
from wavesym.verification.checks import CHECKS
from wavesym.verification.reference import reference

_LEGEND = (
    "Errors are against ball arithmetic rounded once, relative to the output's largest value.",
    "C and NumPy are to stay within their proved bound; the integration, with 4N steps per unit of tau, within what is",
    "allowed: the difference from the one with 2N, and rounding.",
)

Row = dict[str, str]


def verify(scenes: Iterable[Scene]) -> tuple[str, bool]:
    """A table with a row for every output of every scene, and whether all errors are within what is allowed.

    CompilerError where there is no C compiler, or where it does not accept the generated C.
    """
    rows: list[Row] = []
    notes: list[str] = []
    passed = True
    for scene in scenes:
        truth = reference(scene)
        for output, *outcomes in zip(truth.outputs, *(check(truth) for check in CHECKS), strict=True):
            cells = {column: text for outcome in outcomes for column, text in outcome.cells.items()}
            good = all(outcome.passed for outcome in outcomes)
            rows.append(
                {"scene": scene.name, "output": output.observable.name, **cells, "verdict": "PASS" if good else "FAIL"}
            )
            notes += [outcome.note for outcome in outcomes if outcome.note]
            passed = passed and good
    lines = [*_table(rows), "", *_LEGEND, *dict.fromkeys(notes)]
    return "\n".join(lines) + "\n", passed


def _table(rows: Sequence[Row]) -> list[str]:
    """Aligned columns: names to the left, numbers to the right."""
    columns = list(dict.fromkeys(column for row in rows for column in row))
    grid = [columns, *([row.get(column, "-") for column in columns] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*grid, strict=True)]
    names = ("scene", "output", "verdict")
    return [
        "  ".join(
            cell.ljust(width) if column in names else cell.rjust(width)
            for cell, width, column in zip(line, widths, columns, strict=True)
        ).rstrip()
        for line in grid
    ]
