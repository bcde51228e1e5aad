"""Extremes of outputs as text and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence

from wavesym.results.summary import OutputSummary, Peak, Summary

FORMATS = ("text", "json")


def summary_text(summary: Summary, format: str) -> str:
    """A summary as "text" or "json"."""
    return _json(summary) if format == "json" else "\n".join(_lines(summary)) + "\n"


def _json(summary: Summary) -> str:
    outputs = [
        {
            "name": output.name,
            "unit": output.unit,
            "min": _peak(output.min),
            "max": _peak(output.max),
            "arrival": None if output.arrival is None else output.arrival.shown,
            **({"title": output.title} if output.title else {}),
        }
        for output in summary.outputs
    ]
    return json.dumps({"outputs": outputs, "bound": summary.bound}, indent=2) + "\n"


def _peak(peak: Peak) -> dict[str, float | None]:
    return {"value": peak.value, "tau": peak.at.tau, "time": peak.at.time}


def _lines(summary: Summary) -> Iterable[str]:
    clock = "tau" if summary.time_unit is None else f"time [{summary.time_unit}]"
    yield from _columns(
        [("output", "least", clock, "greatest", clock, "arrives"), *(_row(output) for output in summary.outputs)]
    )
    peaks = [peak for output in summary.outputs for peak in (output.min, output.max)]
    yield ""
    if not all(peak.reached for peak in peaks):
        yield "-  it comes up to this value, and jumps then"
    if (drift := summary.largest_drift) is not None:
        peak, unit = drift.largest, f" {drift.unit}" * bool(drift.unit)
        yield f"largest drift: {drift.label}, {number(peak.value)}{unit} at {number(peak.at.shown)}"
    yield f"{summary.how}: {summary.certain}"


def _row(output: OutputSummary) -> tuple[str, ...]:
    name = f"{output.label} [{output.unit}]" if output.unit else output.label
    arrival = "never" if output.arrival is None else number(output.arrival.shown)
    return (name, *_told(output.min), *_told(output.max), arrival)


def _told(peak: Peak) -> tuple[str, str]:
    return number(peak.value), number(peak.at.shown) + "-" * (not peak.reached)


def number(value: float) -> str:
    """As it is shown to people."""
    return f"{value:.7g}"


def _columns(rows: Sequence[Sequence[str]]) -> Iterable[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for name, *numbers in rows:
        cells = (f"{each:>{width}}" for each, width in zip(numbers, widths[1:], strict=True))
        yield f"{name:{widths[0]}}  " + "  ".join(cells)
