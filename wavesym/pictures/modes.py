"""Shapes of modes along the chain, one beside the other."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from wavesym.exact.modes.shape import Mode
from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End
from wavesym.results.modes import Modes
from wavesym.systems.station import Lines, Station

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
    model.network.refuse_rodless("a picture of shapes", "take --shapes, which prints them")
    some = list(zip(found.modes, found.exact, strict=True))[:MOST]
    figure = Figure(figsize=(_WIDTH, 1.4 + _PANEL * len(lines)), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    unit = "Hz" if found.time_unit else "per tau"
    figure.suptitle(f"{found.name}: shapes of the first {len(some)} modes", x=0.01, ha="left", weight="bold")
    length = float(model.length.size) if model.length else 1.0
    for axes, (name, stations) in zip(figure.subplots(len(lines), 1, squeeze=False)[:, 0], lines.items(), strict=True):
        for row, mode in some:
            x, moved = _along(mode, stations)
            largest = np.max(np.abs(moved)) or 1.0  # rods may move more than all nodes
            axes.plot(length * x, moved.real / largest, label=f"{row.number}: {row.hz:.4g} {unit}", linewidth=1.3)
        axes.axhline(0, color="0.7", linewidth=0.6, zorder=0)
        axes.set_xlabel(axis_text(name, model.length))
        axes.set_ylabel("shape")
        axes.grid(True, color="0.92", linewidth=0.5)
    figure.legend(*axes.get_legend_handles_labels(), fontsize=8, ncols=3, frameon=False, loc="outside lower center")
    return figure


def _along(mode: Mode, stations: tuple[Station, ...]) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """Places along a line and how far they move."""
    w = complex(mode.frequency)
    places, moves = [], []
    for station, following in pairwise(stations):
        assert station.right is not None  # between two stations there is a bar
        bar = mode.stiffness.network.bars[station.right]
        ends = [complex(mode.at(End(station.right, side))) for side in (0, 1)]
        part = np.linspace(0, 1, _POINTS)
        angle = w * float(bar.delay)
        if abs(angle) < 1e-9:
            moved = ends[0] * (1 - part) + ends[1] * part
        else:
            moved = (ends[0] * np.sin(angle * (1 - part)) + ends[1] * np.sin(angle * part)) / np.sin(angle)
        places.append(float(station.x) + part * float(following.x - station.x))
        moves.append(moved)
    return np.concatenate(places), np.asarray(np.concatenate(moves), np.complex128)
