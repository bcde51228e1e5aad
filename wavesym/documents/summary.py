"""Extremes of outputs as text and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable

from wavesym.mechanics.probe import with_unit
from wavesym.results.presentation import align_columns, number_text
from wavesym.results.statistics import STATISTICS, OutputSummary, Statistic, cells, headings
from wavesym.results.summary import Summary


def summary_text(summary: Summary, format: str) -> str:
    """A summary as "text" or "json"."""
    return _json(summary) if format == "json" else "\n".join(_lines(summary)) + "\n"


def _json(summary: Summary) -> str:
    outputs = [
        {
            "name": output.name,
            "unit": output.unit,
            **{each.name: _statistic(each, output) for each in STATISTICS},
            **({"title": output.title} if output.title else {}),
        }
        for output in summary.outputs
    ]
    links = [
        {
            "place": link.place,
            "law": link.law,
            "between": link.between,
            "set": link.set._asdict(),
            "dissipated": link.dissipated._asdict(),
        }
        for link in summary.links or ()
    ]
    lost = {"links": links} if links else {}
    return json.dumps({"outputs": outputs, **lost, "bound": summary.bound}, indent=2) + "\n"


def _statistic(statistic: Statistic, output: OutputSummary) -> float | dict[str, float | None] | None:
    """A value, an instant (null where there is none), or a value with its instant."""
    at = statistic.when(output) if statistic.when is not None else None
    if statistic.value is None:
        return None if at is None else at.in_scene_time
    value = statistic.value(output)
    return value if at is None else {"value": value, "tau": at.tau, "time": at.time}


def _lines(summary: Summary) -> Iterable[str]:
    clock = "tau" if summary.time_unit is None else f"time [{summary.time_unit}]"
    yield from align_columns([("output", *headings(clock)), *(_row(output) for output in summary.outputs)])
    peaks = [peak for output in summary.outputs for peak in (output.min, output.max)]
    yield ""
    if not all(peak.reached for peak in peaks):
        yield "-  it comes up to this value, and jumps then"
    if (drift := summary.largest_drift) is not None:
        peak, when = drift.largest, number_text(drift.largest.at.in_scene_time, summary.time_unit or "")
        yield f"largest drift: {drift.label}, {number_text(peak.value, drift.unit)} at {when}"
    if summary.drifts_cost_too_much:
        yield "the largest drift would cost too much (drifts as outputs help)"
    yield from map(str, summary.links or ())
    if summary.links is None:
        yield "sets and what is dissipated would cost too much (a shorter horizon helps)"
    yield f"{summary.how}: {summary.accuracy}"


def _row(output: OutputSummary) -> tuple[str, ...]:
    return (with_unit(output.label, output.unit), *cells(output, "-"))
