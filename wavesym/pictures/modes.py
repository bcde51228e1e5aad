"""Shapes of modes along the chain, one beside the other."""

from __future__ import annotations

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.results.modes import Modes
from wavesym.results.shapes import line_shapes
from wavesym.systems.station import Lines

MOST = 6  # modes in a picture
_WIDTH, _PANEL = 9.0, 2.0  # inches
_POINTS = 33  # of a rod


def draw(found: Modes, model: Model, lines: Lines) -> Figure:
    """The shapes of the first modes along each line of a chain, in phase and, of complex ones, a quarter later.

    Args:
        found: the modes of the model.
        model: the chain.
        lines: its main line and its branches.

    Raises:
        UnservedError: there are no rods.
    """
    drawn = line_shapes(found.exact[:MOST], found.cut, model, lines, _POINTS)
    figure = Figure(figsize=(_WIDTH, 1.4 + _PANEL * len(drawn)), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    unit = "Hz" if found.time_unit else "per tau"
    figure.suptitle(
        f"{found.name}: shapes of the first {min(len(found), MOST)} modes", x=0.01, ha="left", weight="bold"
    )
    for axes, each in zip(figure.subplots(len(drawn), 1, squeeze=False)[:, 0], drawn, strict=True):
        for row, moved in zip(found.modes, each.moved, strict=False):
            axes.plot(each.x, moved.real, label=f"{row.number}: {row.hz:.4g} {unit}", linewidth=1.3)
        axes.axhline(0, color="0.7", linewidth=0.6, zorder=0)
        axes.set_xlabel(axis_text(each.line, model.length))
        axes.set_ylabel("shape")
        axes.grid(True, color="0.92", linewidth=0.5)
    figure.legend(*axes.get_legend_handles_labels(), fontsize=8, ncols=3, frameon=False, loc="outside lower center")
    return figure
