"""A record drawn: its samples, joined by straight lines, with the peak marked."""

from __future__ import annotations

import os

from matplotlib.figure import Figure

from wavesym.documents.record import RecordFacts
from wavesym.numbers.doubles import nearest, rational
from wavesym.pictures.style import MAIN, OTHER, draw_grid, new_figure, set_title, with_style
from wavesym.pictures.units import unit_text
from wavesym.records.record_file import RecordFile

_HEIGHT = 3.4  # inches


@with_style
def draw(record: RecordFile, unit: str) -> Figure:
    """The samples of a file over time, or by their numbers where it does not say when; and the line to 0 after them."""
    facts = RecordFacts(record, unit)
    times = [facts.time(k) for k in range(len(record.samples) + 1)]
    x = [float(k + 1) if time is None else nearest(rational(time)) for k, time in enumerate(times)]
    y = [nearest(rational(sample)) for sample in record.samples]
    figure = new_figure(_HEIGHT)
    axes = figure.add_subplot()
    draw_grid(axes)
    axes.plot(x, [*y, 0.0], color=MAIN, linewidth=0.8)
    axes.plot(x[facts.peak], y[facts.peak], "o", color=OTHER, markersize=4)
    below = y[facts.peak] < 0
    axes.annotate(
        facts.describe_peak(),
        (x[facts.peak], y[facts.peak]),
        xytext=(6, -3 if below else 3),
        textcoords="offset points",
        va="top" if below else "bottom",
    )
    axes.margins(x=0.01, y=0.12)
    set_title(figure, f"{os.path.basename(record.file)}: {record.kind}, {len(record.samples)} samples")
    axes.set_xlabel("number of the sample" if times[0] is None else _axis("time", facts.clock))
    axes.set_ylabel(_axis("sample", unit))
    return figure


def _axis(name: str, unit: str) -> str:
    return f"{name} in {unit_text(unit)}" if unit else name
