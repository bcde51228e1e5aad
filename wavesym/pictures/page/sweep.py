"""A sweep as one page of HTML: what was varied, the worst cases and their scenes, pictures, a table."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wavesym.errors import printable
from wavesym.pictures.page.page_tables import PageTable
from wavesym.pictures.page.plots import PagePicture
from wavesym.pictures.page.svg import element
from wavesym.pictures.page.sweep_pictures import SweepOutput, output_picture, outputs_of
from wavesym.rendering import render
from wavesym.sweeps.results import StoredAxis, SweepResults, results

# what keeps the page small
_OUTPUTS = 8
_ROWS, _CELLS = 250, 2500  # of the table
_REASONS = 50
_SCENE = 5000  # characters


@dataclass(frozen=True)
class WorstCase:
    """A case that is shown whole: its number, its values and the fields of its scene."""

    number: int
    values: tuple[tuple[str, str], ...]
    scene: str


@dataclass(frozen=True)
class SweepPage:
    """What the template shows."""

    name: str
    facts: tuple[tuple[str, str], ...]
    worst: PageTable
    pictures: tuple[PagePicture, ...]
    notes: tuple[str, ...]
    cases: PageTable
    failures: PageTable
    scenes: tuple[WorstCase, ...]
    folder: str
    version: str
    sha256: str


def sweep_page(folder: Path) -> str:
    """The page of the sweep in a folder, done or not. WavesymError where there is none."""
    found = results(folder)
    outputs = outputs_of(found, _OUTPUTS)
    drawn = (output_picture(f"output-{k}", output, found) for k, output in enumerate(outputs))
    extremes = [extreme for output in outputs for extreme in _extremes(output)]
    page = SweepPage(
        name=found.name,
        facts=tuple(_facts(found)),
        worst=_worst(outputs),
        pictures=tuple(filter(None, drawn)),
        notes=tuple(_notes(found, outputs)),
        cases=_cases(found, outputs, set(extremes)),
        failures=_failure_table(found),
        scenes=tuple(_worst_case(found, case) for case in sorted(set(extremes))),
        folder=folder.resolve().name,
        version=found.manifest.wavesym,
        sha256=found.manifest.sha256,
    )
    return render("html/sweep.html.j2", sweep=page)


def _facts(found: SweepResults) -> Iterator[tuple[str, str]]:
    status = found.status
    yield "Cases", f"{status.cases}: {status.done} done, {status.failed} failed, {status.left} left"
    for dimension in found.dimensions:
        yield from _variation_rows(dimension)
    if not np.isnan(found.bound):
        yield "Error", f"at most {found.bound:.2g} of an output's largest value: {_accuracy_note(found)}"


def _variation_rows(dimension: StoredAxis) -> Iterator[tuple[str, str]]:
    for column in dimension.columns:
        ends = (
            column.format(0)
            if len(dimension) == 1
            else f"from {column.format(0)} to {column.format(len(dimension) - 1)}"
        )
        yield column.path, f"{len(dimension)} {'value' if len(dimension) == 1 else 'values'}, {ends}"


def _accuracy_note(found: SweepResults) -> str:
    return {
        "parameters": "an estimate, as parameters came at run time",
        "structures": "an estimate, as modes are those of doubles",
        "recorded": "of values; extremes between samples are an estimate",
    }.get(found.manifest.computed.kind, "of values; wavesym summary says of a scene whether it is proved")


def _extremes(output: SweepOutput) -> tuple[int, ...]:
    """The cases with the least and the greatest value; none where no case is done."""
    if not np.isfinite(output.size).any():
        return ()
    return int(np.nanargmin(output.least)), int(np.nanargmax(output.greatest))


def _worst(outputs: list[SweepOutput]) -> PageTable:
    rows = []
    for output in outputs:
        for case, values in zip(_extremes(output), (output.least, output.greatest), strict=False):
            rows += [f"{values.flat[case]:.6g}", _link(case)]
    with_extremes = [output for output in outputs if _extremes(output)]
    lines = zip(*[iter(rows)] * 4, strict=True)
    return PageTable(
        ("Output", "Least", "in", "Greatest", "in"),
        tuple((_output_label(output), *line) for output, line in zip(with_extremes, lines, strict=True)),
        (),
    )


def _link(case: int) -> str:
    return element("a", f"case {case}", href=f"#case-{case}")


def _output_label(output: SweepOutput) -> str:
    return f"{output.name}, {output.unit}" if output.unit else output.name


def _notes(found: SweepResults, outputs: list[SweepOutput]) -> Iterator[str]:
    if not outputs:
        yield "Neither min nor max was kept, so that there is nothing to draw"
    elif len(found.outputs) > _OUTPUTS:
        yield f"The first {_OUTPUTS} of {len(found.outputs)} outputs are shown; wavesym sweep --table has all"
    yield from (f"{note[:1].upper()}{note[1:]}" for note in found.status.notes)
    if found.status.left:
        yield f"{found.status.left} cases are left: this page shows what was done when it was made"


def _cases(found: SweepResults, outputs: list[SweepOutput], linked: set[int]) -> PageTable:
    """The worst cases, those that are shown whole linked: outputs are compared in parts of their largest value."""
    paths = [column.path for dimension in found.dimensions for column in dimension.columns]
    head = (
        "Case",
        *paths,
        *(f"{_output_label(output)}, {what}" for output in outputs for what in ("least", "greatest")),
    )
    most = min(_ROWS, _CELLS // len(head), found.status.cases)
    rows = []
    for case in _worst_first(outputs)[:most]:
        values = (f"{side.flat[case]:.6g}" for output in outputs for side in (output.least, output.greatest))
        texts = (value.replace("nan", "\u2013") for value in values)
        rows.append((_link(case) if case in linked else str(case), *found.labels_at(case).values(), *texts))
    note = f"{len(rows)} of {found.status.cases} cases, the worst first; wavesym sweep --table writes all"
    return PageTable(head, tuple(rows), (note,))


def _worst_first(outputs: list[SweepOutput]) -> list[int]:
    """Cases by their largest size of any output, in parts of that output's largest; those without values last."""
    if not outputs:
        return []
    parts = [output.size.ravel() / (np.fmax.reduce(output.size, axis=None) or 1.0) for output in outputs]
    return [int(case) for case in np.argsort(-np.fmax.reduce(parts), kind="stable")]


def _failure_table(found: SweepResults) -> PageTable:
    """Why cases failed."""
    reasons = found.status.reasons
    rows = tuple(
        (str(each["case"]), printable(", ".join(f"{path} = {value}" for path, value in values.items())), each["reason"])
        for each in reasons[:_REASONS]
        for values in (each["values"],)
    )
    notes = (f"The first {_REASONS} of {len(reasons)}; wavesym sweep --status has all",)
    return PageTable(("Case", "Values", "Reason"), rows, notes if len(reasons) > _REASONS else ())


def _worst_case(found: SweepResults, case: int) -> WorstCase:
    scene = json.dumps(found.scene(case), indent=1)
    if len(scene) > _SCENE:
        scene = f"{scene[:_SCENE]}\n... and {len(scene) - _SCENE} characters more, left out to keep the page small"
    return WorstCase(case, tuple(found.labels_at(case).items()), scene)
