"""Extremes of outputs as text and as JSON."""

from __future__ import annotations

import json

from wavesym.results.statistics import STATISTICS, OutputSummary, Statistic
from wavesym.results.summary import Summary


def summary_text(summary: Summary, format: str) -> str:
    """A summary as "text" or "json"."""
    return _json(summary) if format == "json" else f"{summary}\n"


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
    shapes = [each._asdict() for each in summary.labels.shapes] if summary.labels else []
    lines = {"shapes": shapes} if shapes else {}
    return json.dumps({"outputs": outputs, **lost, "bound": summary.bound, **lines}, indent=2) + "\n"


def _statistic(statistic: Statistic, output: OutputSummary) -> float | dict[str, float | None] | None:
    """A value, an instant (null where there is none), or a value with its instant."""
    at = statistic.when(output) if statistic.when is not None else None
    if statistic.value is None:
        return None if at is None else at.in_scene_time
    value = statistic.value(output)
    return value if at is None else {"value": value, "tau": at.tau, "time": at.time}
