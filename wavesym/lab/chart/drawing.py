"""Speed against accuracy, drawn: evaluators of a scene and other methods as curves, errors at fronts and away.

What tells curves apart is their marker and the line's style, so that the chart can be read without colours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from math import isnan
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from wavesym.lab.chart.measure import NEAR, ChartRow, Measurements
from wavesym.pictures.labels import Curve, label
from wavesym.pictures.style import FONT, WIDTH, draw_grid, new_figure, with_style
from wavesym.scene import Scene
from wavesym.systems import Preset, SystemTable

# below half a unit in the last place an error is a matter of luck; no error at all is drawn there too
_LEAST_ERROR = 5e-17
_LARGEST_ERROR = 1.0
_LEFT, _RIGHT, _NAMES, _PANEL, _GAP = 0.85, 0.12, 3.0, 6.0, 1.0  # inches
_LINE, _LETTERS = 0.21, 68  # inches; letters in a line of notes

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


@with_style
def draw(scene: Scene, measured: Measurements) -> Figure:
    """The chart of a scene's measurements; the same bytes from the same numbers when it is written by `save`."""
    curves = _curves(measured.rows)
    panels = [("error_away", f"Away from fronts: more than {NEAR:g} in tau from any arrival")]
    if all(isnan(row.error_at_fronts) for row in measured.rows):
        panels = [("error_away", "Anywhere: nothing jumps")]
    else:
        panels.append(("error_at_fronts", f"At fronts: within {NEAR:g} of an arrival, and at it"))
    notes = wrap(_notes(scene, measured), _LETTERS)
    names = _setup_names(curves, measured)
    above, below = _LINE * (3.2 + len(notes)), _LINE * (1 + len(names))
    height = above + len(panels) * (_PANEL + _GAP) + below + _GAP / 2
    figure = new_figure(height, constrained=False)
    figure.text(0.01, 1 - 0.4 * _LINE / height, _title(scene), weight="bold", va="top")
    figure.text(0.01, 1 - 1.5 * _LINE / height, "\n".join(notes), color="0.3", va="top")
    top = height - above
    for error, where in panels:
        axes = figure.add_axes(_box(_LEFT, top, _PANEL, height))
        _panel(axes, where, curves, measured, error)
        top -= _PANEL + _GAP
    _setup(figure.add_axes(_box(_NAMES, top, below, height)), names, curves, measured.new_parameters)
    return figure


def _box(left: float, top: float, tall: float, height: float) -> tuple[float, float, float, float]:
    """Where axes are in a figure so high, all in inches."""
    return left / WIDTH, (top - tall) / height, (WIDTH - _RIGHT - left) / WIDTH, tall / height


def _title(scene: Scene) -> str:
    return f"{scene.system.type.capitalize()}, {_rods(scene.system)}: time and error"


def _notes(scene: Scene, measured: Measurements) -> str:
    outputs = len(scene.outputs)
    known = (
        f" Errors are known to {measured.reference_bound:.0e}, which is in them." if measured.reference_bound else ""
    )
    return (
        f"{outputs} output{'s' * (outputs > 1)}, tau to "
        f"{float(scene.output.until):g}; {measured.samples} equally spaced samples of each output (a stream: of its "
        f"load), one thread. Lower left is better. Black: wavesym, grey: other methods.{known}"
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
    axes.set_xlabel("largest error / largest value of the output")
    axes.set_ylabel("time a value [ns]")
    axes.set_title(title, loc="left")
    draw_grid(axes, zero=False)
    axes.axhline(measured.floor, color="black", linewidth=0.8, dashes=(1, 2))
    ends = np.geomspace(_LEAST_ERROR, _LARGEST_ERROR, 9)[:, np.newaxis]
    floor = Curve("floor: a straight line of doubles, C", np.insert(ends, 1, measured.floor, axis=1), "black", "normal")
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
    label(axes, named, FONT)


def _setup_names(curves: Sequence[tuple[_Style, list[ChartRow]]], measured: Measurements) -> list[str]:
    """The rows of what a new parameter set costs; first, where there is one, a program that takes it when it runs."""
    first = ["kappa at run time, C"] * (measured.new_parameters is not None)
    return [*first, *(style.name for style, _ in curves)]


def _setup(
    axes: Axes, names: Sequence[str], curves: Sequence[tuple[_Style, list[ChartRow]]], new_parameters: float | None
) -> None:
    """What a new parameter set costs, from the least to the most of a curve's points; at run time with all samples."""
    axes.set(xscale="log", ylim=(len(names) - 0.5, -0.5))
    if new_parameters is not None:
        axes.plot([new_parameters], [0], "*", color="black", markersize=9)
    for place, (style, rows) in enumerate(curves, len(names) - len(curves)):
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
    draw_grid(axes, zero=False)
    axes.set_xlabel("set-up for a new parameter set [s]")
    axes.set_title("Set-up: generate and compile, or fill tables", loc="right")
