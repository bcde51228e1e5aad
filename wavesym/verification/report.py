"""Every check on every scene: a table of errors for each check, and one verdict."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from wavesym.scene import Scene
from wavesym.toolchain import compiler
from wavesym.verification.checks import CHECKS
from wavesym.verification.reference import reference

_LEGEND = "Errors are against ball arithmetic rounded once, relative to the output's largest value."

Row = dict[str, str]


def verify(scenes: Iterable[Scene]) -> tuple[str, bool]:
    """For each check a table of what it found in every scene, and whether all errors are within what is allowed.

    CompilerError where there is no C compiler, or where it does not accept the generated C.
    """
    chosen = compiler()
    tables: list[list[Row]] = [[] for _ in CHECKS]
    notes: list[str] = []
    passed = True
    for scene in scenes:
        truth = reference(scene)
        for check, rows in zip(CHECKS, tables, strict=True):
            for outcome in check.run(truth):
                verdict = "PASS" if outcome.passed else "FAIL"
                rows.append({"scene": scene.name, "of": outcome.subject, **outcome.cells, "verdict": verdict})
                notes += [outcome.note] if outcome.note else []
                passed = passed and outcome.passed
    lines = [_LEGEND, f"The C compiler is {chosen.version}.", *dict.fromkeys(notes), ""]
    for check, rows in zip(CHECKS, tables, strict=True):
        lines += [check.title, "", *_table(rows), ""]
    return "\n".join(lines[:-1]) + "\n", passed


def _table(rows: Sequence[Row]) -> list[str]:
    """Aligned columns: names to the left, numbers to the right."""
    columns = [column for column in dict.fromkeys(column for row in rows for column in row) if column != "verdict"]
    columns.append("verdict")  # last, where a row has fewer columns too
    grid = [columns, *([row.get(column, "-") for column in columns] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*grid, strict=True)]
    names = ("scene", "of", "verdict")
    return [
        "  ".join(
            cell.ljust(width) if column in names else cell.rjust(width)
            for cell, width, column in zip(line, widths, columns, strict=True)
        ).rstrip()
        for line in grid
    ]
