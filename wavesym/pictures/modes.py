"""Shapes of modes along the chain, one beside the other."""

from __future__ import annotations

from matplotlib.figure import Figure

from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.pictures.style import draw_grid, new_figure, set_title, with_style
from wavesym.results.modes import Modes
from wavesym.results.shapes import line_shapes
from wavesym.systems.station import Lines

MOST = 6  # modes in a picture
_PANEL = 2.4  # inches
_POINTS = 33  # of a rod


@with_style
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
    figure = new_figure(1.4 + _PANEL * len(drawn))
    unit = "Hz" if found.time_unit else "per tau"
    set_title(figure, f"{found.name}: shapes of the first {min(len(found), MOST)} modes")
    for axes, each in zip(figure.subplots(len(drawn), 1, squeeze=False)[:, 0], drawn, strict=True):
        for row, moved in zip(found.modes, each.displacements, strict=False):
            axes.plot(each.x, moved.real, label=f"{row.number}: {row.hz:.4g} {unit}", linewidth=1.3)
        draw_grid(axes)
        axes.set_xlabel(axis_text(each.line, model.length))
        axes.set_ylabel("shape")
    figure.legend(*axes.get_legend_handles_labels(), ncols=3, frameon=False, loc="outside lower center")
    return figure
