"""Speed against accuracy, drawn: evaluators of a scene and other methods as curves, errors at fronts and away.

What tells curves apart is their marker and the line's style, so that the chart can be read without colours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from math import isnan

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from wavesym.lab.chart.measure import NEAR, ChartRow, Measurements
from wavesym.pictures.labels import Curve, label
from wavesym.scene import Scene
from wavesym.systems import Preset, SystemTable

# below half a unit in the last place an error is a matter of luck; no error at all is drawn there too
_LEAST_ERROR = 5e-17
_LARGEST_ERROR = 1.0
_SIZE = (13.0, 12.5)  # inches
_FONT = 8.0

_OURS = {"closed": "s", "pieces": "o", "modes": "H", "march": "D", "ball reference": "*"}
_DASHES = {("C", "double"): "-", ("NumPy", "double"): "--", ("C", "single"): "-.", ("NumPy", "single"): ":"}
_OTHERS = (
    ("^", "--"),
    ("v", "-"),
    ("<", "--"),
    (">", "--"),
    ("P", "-."),
    ("X", "-."),
    ("h", ":"),
    ("p", ":"),
    ("d", "--"),
)


@dataclass(frozen=True)
class _Style:
    """How a curve looks, and what it is called."""

    name: str
    marker: str
    dashes: str
    ours: bool

    @property
    def color(self) -> str:
        return "black" if self.ours else "0.42"


def draw(scene: Scene, measured: Measurements) -> Figure:
    """The chart of a scene's measurements; the same bytes from the same numbers when it is written by `save`."""
    with mpl.rc_context({"font.size": _FONT, "font.family": "DejaVu Sans"}):
        figure = Figure(figsize=_SIZE, dpi=100)
        FigureCanvasAgg(figure)
        grid = figure.add_gridspec(
            2, 2, height_ratios=(2.6, 1), left=0.065, right=0.985, top=0.92, bottom=0.05, hspace=0.2, wspace=0.06
        )
        curves = _curves(measured.rows)
        figure.suptitle(_title(scene, measured), x=0.065, ha="left", fontsize=_FONT + 3)
        if all(isnan(row.error_at_fronts) for row in measured.rows):
            away, where = figure.add_subplot(grid[0, :]), "anywhere: nothing jumps"
        else:
            away, fronts = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
            where = f"away from fronts: more than {NEAR:g} in tau from any arrival"
            _panel(fronts, f"at fronts: within {NEAR:g} of an arrival, and at it", curves, measured, "error_at_fronts")
            fronts.tick_params(labelleft=False)
        _panel(away, where, curves, measured, "error_away")
        away.set_ylabel("time per value / ns")
        _setup(figure.add_subplot(grid[1, :]), curves, measured.new_parameters)
    return figure


def _title(scene: Scene, measured: Measurements) -> str:
    parts = scene.system
    outputs = len(scene.outputs)
    known = (
        f" Errors are known to {measured.reference_bound:.0e}, which is in them." if measured.reference_bound else ""
    )
    return (
        f"{scene.name}: {parts.type}, {_rods(parts)}, "
        f"{outputs} output{'s' * (outputs > 1)}, tau to {float(scene.output.until):g}\n"
        f"Speed against accuracy, {measured.samples} equally spaced samples of each output (a stream: of its load). "
        f"One thread; lower left is better.\nBlack: wavesym, grey: other methods.{known}"
    )


def _rods(system: SystemTable) -> str:
    return f"m = {system.m}" if isinstance(system, Preset) else f"{len(system.drawing.bars)} rods"


def _curves(rows: Sequence[ChartRow]) -> list[tuple[_Style, list[ChartRow]]]:
    """The points of each curve, and how it is drawn: wavesym's first, else in the order of the measurements."""
    grouped: dict[tuple[str, str, str], list[ChartRow]] = {}
    for row in sorted(rows, key=lambda row: row.kind != "wavesym"):
        grouped.setdefault((row.name, row.language, row.precision), []).append(row)
    others = cycle(_OTHERS)
    curves = []
    for (name, language, precision), points in grouped.items():
        ours = points[0].kind == "wavesym"
        marker, dashes = (_OURS.get(name, "o"), _DASHES.get((language, precision), "-")) if ours else next(others)
        shown = f"{name}, {language}" + (", single" if precision == "single" else "")
        curves.append((_Style(shown, marker, dashes, ours), points))
    return curves


def _panel(
    axes: Axes, title: str, curves: Sequence[tuple[_Style, list[ChartRow]]], measured: Measurements, error: str
) -> None:
    axes.set(xscale="log", yscale="log", xlim=(_LEAST_ERROR / 2, _LARGEST_ERROR * 3))
    times = [row.ns_per_value for row in measured.rows]
    axes.set_ylim(measured.floor / 2.5, max(times, default=1.0) * 3)
    axes.set_xlabel("largest error / largest value of the output (dimensionless)")
    axes.set_title(title, fontsize=_FONT + 1, loc="left")
    axes.grid(True, which="major", color="0.9", linewidth=0.5)
    axes.axhline(measured.floor, color="black", linewidth=0.8, dashes=(1, 2))
    ends = np.geomspace(_LEAST_ERROR, _LARGEST_ERROR, 9)[:, np.newaxis]
    floor = Curve(
        "floor: writing a straight line of doubles, C", np.insert(ends, 1, measured.floor, axis=1), "black", "normal"
    )
    named = [floor]
    for style, rows in curves:
        # a stream says nothing at fronts; what has no digit right has no place
        places = [(getattr(row, error), row.ns_per_value) for row in rows if not isnan(getattr(row, error))]
        if not places:
            continue
        points = np.array([(np.clip(wrong, _LEAST_ERROR, _LARGEST_ERROR), time) for wrong, time in places])
        axes.plot(
            points[:, 0],
            points[:, 1],
            color=style.color,
            marker=style.marker,
            linestyle=style.dashes,
            markersize=5,
            linewidth=1.6 if style.ours else 1.0,
            markerfacecolor=style.color if style.ours else "white",
            zorder=3 if style.ours else 2,
        )
        named.append(Curve(style.name, points, "black" if style.ours else "0.25", "bold" if style.ours else "normal"))
    label(axes, named, _FONT)


def _setup(axes: Axes, curves: Sequence[tuple[_Style, list[ChartRow]]], new_parameters: float | None) -> None:
    """What a new parameter set costs, from the least to the most of a curve's points. First, where there is one, what
    a program costs that takes parameters when it runs: all of its samples are in that.
    """
    before = 0 if new_parameters is None else 1
    axes.set(xscale="log", ylim=(len(curves) + before - 0.5, -0.5))
    names = [style.name for style, _ in curves]
    if new_parameters is not None:
        axes.plot([new_parameters], [0], "*", color="black", markersize=9)
        names = ["kappa at run time, C, with all samples", *names]
    for place, (style, rows) in enumerate(curves, before):
        seconds = [row.setup_seconds for row in rows]
        axes.plot([min(seconds), max(seconds)], [place, place], color=style.color, linewidth=1)
        axes.plot(
            seconds,
            [place] * len(seconds),
            style.marker,
            color=style.color,
            markersize=5,
            markerfacecolor=style.color if style.ours else "white",
        )
    axes.set_yticks(range(len(names)), names)
    axes.tick_params(axis="y", length=0)
    axes.grid(True, color="0.9", linewidth=0.5)
    axes.set_xlabel("set-up for a new parameter set / s")
    axes.set_title(
        "set-up, apart from the times above: wavesym generates and compiles or imports code, others fill tables",
        fontsize=_FONT + 1,
        loc="left",
    )
    # its names need room on the left, which the panels above do not
    box = axes.get_position()
    axes.set_position((0.2, box.y0, box.x1 - 0.2, box.height))
