"""Every check on every scene: a table of errors for each check, and one verdict."""

from __future__ import annotations

from collections.abc import Iterable

from wavesym.mechanics.model import Model
from wavesym.running.toolchain import compiler
from wavesym.verification.checks import CHECKS
from wavesym.verification.columns import Row, table
from wavesym.verification.damped import damped
from wavesym.verification.reference import known, unknown

_LEGEND = "Errors are against ball arithmetic rounded once, relative to the output's largest value."


def verify(models: Iterable[Model]) -> tuple[str, bool]:
    """For each check a table of what it found for every model, and whether all errors are within what is allowed.

    CompilerError where there is no C compiler, or where it does not accept the generated C.
    """
    chosen = compiler()
    tables: list[list[Row]] = [[] for _ in CHECKS]
    notes: list[str] = []
    passed = True
    for model in models:
        truth = known(model) if model.damping is None else unknown(model)
        notes += truth.notes
        for check, rows in zip(CHECKS, tables, strict=True):
            for outcome in check.run(truth) if truth.outputs or check.run is damped else ():
                verdict = "PASS" if outcome.passed else "FAIL"
                rows.append({"scene": model.name, "of": outcome.subject, **outcome.cells, "verdict": verdict})
                notes += [outcome.note] if outcome.note else []
                passed = passed and outcome.passed
    lines = [_LEGEND, f"The C compiler is {chosen.version}.", *dict.fromkeys(notes), ""]
    for check, rows in zip(CHECKS, tables, strict=True):
        if rows:
            lines += [check.title, "", *table(rows, ("scene", "of", "verdict")), ""]
    return "\n".join(lines[:-1]) + "\n", passed
