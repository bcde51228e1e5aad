"""`wavesym plot --published`: Figs. 6, 7 and 8 of the paper, redrawn, with what section 5 says of them marked.

A number in a panel is that of a statement, text.N in `wavesym verify --published`; it stands at the points that were
measured for it. Below the panels is what was found. All of it comes from `papers.pielorz1979.figures`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from textwrap import wrap

import numpy as np
from flint import fmpq
from matplotlib.figure import Figure

from wavesym.model.model import Model
from wavesym.model.probe import Probe
from wavesym.numbers.doubles import nearest
from wavesym.papers.pielorz1979 import figures as section_5
from wavesym.papers.pielorz1979.figures import FigureStatement, Finding
from wavesym.papers.record import Record, judge, shown
from wavesym.report.histories import Histories, History, histories
from wavesym.report.panels import CHARACTERS, Instant, Mark, PlotPanel, axis_title, stacked
from wavesym.report.saving import save
from wavesym.scene import lower

FIGURES: Mapping[int, tuple[str, ...]] = {
    6: ("strain", "displacement"),
    7: ("strain", "displacement"),
    8: ("velocity", "strain", "displacement"),
}
"""The quantities of each figure, from top to bottom."""

_INDENT = " " * 4


def published(directory: Path, number: int) -> list[Path]:
    """Write the figure `number` into `directory`, as .svg and .png; the paths written. OSError."""
    figure = redrawn(number, judged(number))
    paths = [directory / f"figure_{number}.{suffix}" for suffix in ("svg", "png")]
    for path in paths:
        save(figure, path)
    return paths


def judged(number: int) -> dict[str, Record]:
    """The verdicts on what the paper says of a figure."""
    said = {id for id, statement in section_5.numbered().items() if statement.figure == number}
    said |= {section_5.END} if number == 6 else set()
    return {claim.id: judge(claim) for claim in section_5.claims() if claim.id in said}


def redrawn(number: int, records: Mapping[str, Record]) -> Figure:
    """A figure of the paper under the load of `drawn`, with the verdicts on its statements."""
    load = drawn(number)
    made = histories(lower(section_5.scene(number, load)))
    found = {id: said for id, said in section_5.numbered().items() if said.figure == number}
    panels = [_panel(made, quantity, load, found) for quantity in FIGURES[number]]
    if made.model.labels.loads:
        panels.insert(0, _load(made.model))
    return stacked(
        panels,
        nearest(made.model.until),
        list(_title(number, made.model, load)),
        list(_list(number, load, found, records)),
        [] if made.model.labels.loads else _ends(records[section_5.END]),
    )


def drawn(number: int) -> str:
    """The load that a figure is drawn with: the first of those under which most of its statements are true."""
    said = [statement for statement in section_5.STATEMENTS if statement.figure == number]
    return max(
        section_5.loads(number),
        key=lambda load: sum(statement.true(statement.findings[load].value) for statement in said),
    )


def marks(finding: Finding, text: str, made: Histories, load: str) -> Iterator[Mark]:
    """The spots of a finding, each with the number of its statement."""
    taus = section_5.instants(nearest(made.model.until))
    curves = section_5.curves(int(made.model.name.removeprefix("figure_")), load)
    for spot in finding.spots:
        yield Mark(text, np.array([(taus[point.instant], curves[point.output][point.instant]) for point in spot]))


def _panel(made: Histories, quantity: str, load: str, found: Mapping[str, FigureStatement]) -> PlotPanel:
    own = tuple(history for history in made.outputs if history.output.quantity == quantity)
    noted = [
        mark
        for id, statement in found.items()
        for mark in marks(statement.findings[load], id.removeprefix("text."), made, load)
        if statement.findings[load].spots[0][0].output.startswith(quantity)
    ]
    return PlotPanel(axis_title(made.model, quantity), own, tuple(noted), height=3.6 if len(own) > 4 else 2.9)


def _ends(record: Record) -> list[Instant]:
    """When the collision of Fig. 6 ends, as printed and as computed."""
    number = record.id.removeprefix("text.")
    return [
        Instant(float(record.printed), f"{number}: {record.printed} (printed)", "--"),
        Instant(section_5.contact_end(), f"{number}: contact opens", "-"),
    ]


def _load(model: Model) -> PlotPanel:
    """The load over tau, exactly: steps and ramps, summed. The moments of Fig. 7 are equal: one stands for both."""
    moments = sorted({load.source for load in model.loads} - {"a", "b"})
    acting = [load for load in model.loads if load.source not in moments[1:]]
    times = sorted({load.time for load in acting} | {model.until})

    def value(tau: fmpq, since: fmpq) -> float:
        """At tau, under what has begun by `since`."""
        begun = (load for load in acting if load.time <= since)
        values = (load.weight * (tau - load.time if load.source == "b" else 1) for load in begun)
        return nearest(sum(values, fmpq(0)))

    stretches = tuple(
        np.array([(nearest(low), value(low, low)), (nearest(high), value(high, low))]) for low, high in pairwise(times)
    )
    name = " = ".join(moments) or "acceleration of the base"
    unit = "moment\nin G J\u2080\u2081 \u03b8\u2080 / l" if moments else "load (3.2)\n(dimensionless)"
    return PlotPanel(unit, (History(Probe(name, "load", 1, fmpq(0)), stretches),), height=1.2)


def _title(number: int, model: Model, load: str) -> Iterator[str]:
    values = ", ".join(
        f"{name}_{index} = {value}" for name, numbers in model.felt.items() for index, value in numbers.items()
    )
    yield f"Fig. {number} of the paper, redrawn: {model.labels.system['type']}, m = {model.named.m}; {values}"
    if model.labels.loads:
        yield (
            f"The paper's load curve is not in its text. Drawn: {load}, "
            "the first of the shapes tried under which most of the statements are true."
        )
    yield "Numbers stand where a statement of section 5 was measured; jumps are thin and upright."


def _list(number: int, load: str, found: Mapping[str, FigureStatement], records: Mapping[str, Record]) -> Iterator[str]:
    """The statements, what each was taken to mean, and for which loads it is true."""
    for id, statement in found.items():
        yield f"{id.removeprefix('text.')}  {statement.text}: {records[id].verdict}"
        values = {name: finding.value for name, finding in statement.findings.items()}
        parts = [f"{statement.meaning}; measured: {shown(values[load])}"]
        if len(values) > 1:
            for truth in ("true", "false"):
                those = [f"{name} ({shown(v)})" for name, v in values.items() if statement.true(v) == (truth == "true")]
                parts.append(f"{truth} for {', '.join(those) or 'none of the loads tried'}")
        yield from wrap("; ".join(parts), CHARACTERS, initial_indent=_INDENT, subsequent_indent=_INDENT)
    if number == 6:
        record = records[section_5.END]
        text = f"the collision ends at tau = {record.printed}: {record.verdict}, {record.corrected or record.printed}"
        yield f"{record.id.removeprefix('text.')}  {text}"
        yield from wrap(record.evidence, CHARACTERS, initial_indent=_INDENT, subsequent_indent=_INDENT)
