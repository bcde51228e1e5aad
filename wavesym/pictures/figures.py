"""`wavesym plot --published`: Figs. 6, 7 and 8 of the paper, redrawn, with what section 5 says of them marked.

A number in a panel is that of a statement, text.N in `wavesym verify --published`; it stands at the points that were
measured for it. What was found stands beside the picture, on a page. All of it comes from
`papers.pielorz1979.figures` and its data.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from wavesym import __version__
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.papers.pielorz1979.figure_scenes import TriedLoad, contact_end, figure, loads
from wavesym.papers.pielorz1979.figures import (
    finding,
    findings,
    is_true,
    meaning,
    printed_end,
    statements,
)
from wavesym.papers.pielorz1979.measures import Finding
from wavesym.papers.pielorz1979.paper import records
from wavesym.papers.pielorz1979.transcript import entries
from wavesym.papers.record import Record, Sentence, format_value
from wavesym.pictures.groups import Mark, PlotPanel, axis_title
from wavesym.pictures.histories import Histories, histories
from wavesym.pictures.loads import load_histories
from wavesym.pictures.panels import Instant, stack_panels
from wavesym.pictures.saving import save
from wavesym.rendering import render
from wavesym.scene import lower
from wavesym.writing import write_whole

FIGURES: Mapping[int, tuple[str, ...]] = {
    6: ("strain", "displacement"),
    7: ("strain", "displacement"),
    8: ("velocity", "strain", "displacement"),
}
"""The quantities of each figure, from top to bottom."""

PAGE = "figures.html"


@dataclass(frozen=True)
class JudgedStatement:
    """What the paper says of a figure, by its number in the picture, the verdict, and what was measured."""

    number: str
    text: str
    verdict: str
    details: tuple[str, ...]


@dataclass(frozen=True)
class JudgedFigure:
    """A figure on the page: its number, how it is drawn, and the verdicts beside it."""

    number: int
    title: str
    notes: tuple[str, ...]
    statements: tuple[JudgedStatement, ...]


def write_figure(directory: Path, number: int) -> list[Path]:
    """Write the figure `number` into `directory`, as .svg and .png; the paths written. OSError."""
    made = redraw_figure(number)
    paths = [directory / f"figure_{number}.{suffix}" for suffix in ("svg", "png")]
    for path in paths:
        save(made, path)
    return paths


def write_page(directory: Path) -> Path:
    """Write the page on which the figures in `directory` stand beside their verdicts; its path. OSError."""
    judged = tuple(map(judged_figure, FIGURES))
    path = directory / PAGE
    write_whole({path: render("html/figures.html.j2", version=__version__, figures=judged)})
    return path


@cache
def figure_verdicts(number: int) -> Mapping[str, Record]:
    """The verdicts on what the paper says of a figure."""
    statements = [e for e in entries().values() if e.subject.get("figure") == number and e.kind != "caption"]
    return {record.id: record for record in records(statements)}


def judged_figure(number: int) -> JudgedFigure:
    """What stands beside a figure."""
    load = best_load(number)
    model = lower(figure(number).scene(load))
    title, *notes = _title(number, model, load)
    ends = (_judged_end(record) for record in figure_verdicts(number).values() if _is_end(record, number))
    return JudgedFigure(number, title, tuple(notes), (*_judged_statements(number, load), *ends))


def redraw_figure(number: int) -> Figure:
    """A figure of the paper under the load of `best_load`, with the numbers of its statements."""
    load = best_load(number)
    made = histories(lower(figure(number).scene(load)))
    panels = [_panel(made, number, quantity, load) for quantity in FIGURES[number]]
    if made.model.labels.loads:
        panels.insert(0, _load(made.model))
    ends = [record for record in figure_verdicts(number).values() if _is_end(record, number)]
    title = [f"Fig. {number} of the paper, redrawn", f"Numbers: what section 5 says; verdicts in {PAGE}"]
    instants = [instant for record in ends for instant in _ends(record)]
    return stack_panels(panels, nearest(made.model.until), title, instants=instants)


def best_load(number: int) -> TriedLoad:
    """The load that a figure is drawn with: the first of those under which most of its statements are true."""
    sentences = statements(number).values()
    return max(loads(number), key=lambda load: sum(is_true(figure(number), load, statement) for statement in sentences))


def marks(number: int, found: Finding, text: str, load: TriedLoad) -> Iterator[Mark]:
    """The spots of a finding, each with the number of its statement."""
    scene = figure(number)
    for spot in found.spots:
        points = ((scene.instants[p.instant], scene.curve(load, p.quantity, p.place)[p.instant]) for p in spot)
        yield Mark(text, np.array(list(points)))


def _panel(made: Histories, number: int, quantity: str, load: TriedLoad) -> PlotPanel:
    own = tuple(history for history in made.outputs if history.output.quantity == quantity)
    noted: list[Mark] = []
    for id, statement in statements(number).items():
        found = finding(figure(number), load, statement)
        if found.spots and found.spots[0][0].quantity == quantity:
            noted += marks(number, found, id.removeprefix("text."), load)
    return PlotPanel(axis_title(made.model, quantity), own, tuple(noted), height=3.6 if len(own) > 4 else 2.9)


def _ends(record: Record) -> list[Instant]:
    """When the collision of Fig. 6 ends, as printed and as computed."""
    number, printed = record.id.removeprefix("text."), printed_end(record.entry)
    return [
        Instant(printed, f"{number}: {printed} (printed)", "--"),
        Instant(float(contact_end(figure(6))), f"{number}: contact opens", "-"),
    ]


def _load(model: Model) -> PlotPanel:
    """The load over tau. The moments of Fig. 7 are equal: one stands for both."""
    first, *others = load_histories(model)
    name = " = ".join(load.name for load in (first, *others))
    moments = model.labels.system["type"] == "drive"
    unit = "moment\nin G J\u2080\u2081 \u03b8\u2080 / l" if moments else "load (3.2)\n(dimensionless)"
    return PlotPanel(unit, (replace(first, output=replace(first.output, name=name)),), height=1.2)


def _title(number: int, model: Model, load: TriedLoad) -> Iterator[str]:
    values = ", ".join(
        f"{name}_{index} = {value}" for name, numbers in model.letters.items() for index, value in numbers.items()
    )
    yield f"Fig. {number} of the paper, redrawn: {model.labels.system['type']}, {model.labels.size}; {values}"
    if model.labels.loads:
        yield (
            f"The paper's load curve is not in its text. Drawn: {load.name}, "
            "the first of the shapes tried under which most of the statements are true."
        )
    yield "Numbers stand where a statement of section 5 was measured; jumps are thin and upright."


def _judged_statements(number: int, load: TriedLoad) -> Iterator[JudgedStatement]:
    """The statements, what each was taken to mean, and for which loads it is true."""
    verdicts = figure_verdicts(number)
    for id, statement in statements(number).items():
        record = verdicts[id]
        text = record.entry.statement
        yield JudgedStatement(
            id.removeprefix("text."), text, record.verdict, tuple(_measurements(number, load, statement))
        )


def _measurements(number: int, load: TriedLoad, statement: Sentence) -> Iterator[str]:
    found = findings(number, statement)
    yield f"{meaning(statement)}; measured: {format_value(finding(figure(number), load, statement).value)}"
    if len(found) > 1:
        for truth in (True, False):
            those = [
                f"{other.name} ({format_value(measured.value)})"
                for other, measured in found
                if is_true(figure(number), other, statement) == truth
            ]
            yield f"{'true' if truth else 'false'} for {', '.join(those) or 'none of the loads tried'}"


def _is_end(record: Record, number: int) -> bool:
    return record.entry.kind == "contact" and record.entry.subject["figure"] == number


def _judged_end(record: Record) -> JudgedStatement:
    text = f"the collision ends at tau = {printed_end(record.entry)}"
    return JudgedStatement(record.id.removeprefix("text."), text, record.verdict, tuple(record.evidence))
