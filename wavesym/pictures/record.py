"""A record drawn: its samples, joined by straight lines, with the peak marked."""

from __future__ import annotations

import os

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from wavesym.documents.record import RecordFacts
from wavesym.numbers.doubles import nearest, rational
from wavesym.pictures.panels import FONT
from wavesym.records.record_file import RecordFile

_SIZE = (11.0, 3.6)  # inches


def draw(said: RecordFile, unit: str) -> Figure:
    """The samples of a file over time, or by their numbers where it does not say when; and the line to 0 after them."""
    told = RecordFacts(said, unit)
    times = [told.time(k) for k in range(len(said.samples) + 1)]
    x = [float(k + 1) if time is None else nearest(rational(time)) for k, time in enumerate(times)]
    y = [nearest(rational(sample)) for sample in said.samples]
    with mpl.rc_context({"font.size": FONT, "font.family": "DejaVu Sans"}):
        figure = Figure(figsize=_SIZE, dpi=100, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        axes.axhline(0, color="#999999", linewidth=0.6)
        axes.plot(x, [*y, 0.0], color="#1f4e9c", linewidth=0.8)
        axes.plot(x[told.peak], y[told.peak], "o", color="#d0692b", markersize=4)
        below = y[told.peak] < 0
        axes.annotate(
            told.peaked(),
            (x[told.peak], y[told.peak]),
            xytext=(6, -3 if below else 3),
            textcoords="offset points",
            va="top" if below else "bottom",
        )
        axes.margins(x=0.01, y=0.12)
        axes.set_title(
            f"{os.path.basename(said.file)}: {said.kind}, {len(said.samples)} samples", loc="left", weight="bold"
        )
        axes.set_xlabel("number of the sample" if times[0] is None else _axis("time", told.clock))
        axes.set_ylabel(_axis("sample", unit))
    return figure


def _axis(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name
