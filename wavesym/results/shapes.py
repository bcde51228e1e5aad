"""Shapes of modes along the lines of a chain, inside its rods too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import WavesymError
from wavesym.exact.modes.cuts import Cut
from wavesym.exact.modes.shape import Mode
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End
from wavesym.numbers.doubles import nearest
from wavesym.systems.station import Lines, Station

MOST = 1000  # points of a rod
_STRAIGHT = 1e-9  # radians in which a rod hardly bends


@dataclass(frozen=True)
class LineShapes:
    """How the places of a line move in each mode.

    Attributes:
        line: the name of a branch, "" for the main line.
        x: places from the start of the line, (places,), in the unit of lengths, both ends of each rod among them.
        moved: (modes, places), complex; the largest of a mode anywhere on the chain is 1.
    """

    line: str
    x: NDArray[np.float64]
    displacements: NDArray[np.complex128]


def line_shapes(modes: Sequence[Mode], pieces: Cut, model: Model, lines: Lines, points: int) -> tuple[LineShapes, ...]:
    """The shapes along all lines.

    Args:
        modes: of the model.
        pieces: its network as it was cut for them.
        model: the chain.
        lines: its main line and its branches; those without a rod are left out.
        points: how many of each rod, both ends included, from 2 on.

    Raises:
        UnservedError: there are no rods.
        WavesymError: for a number of points that is none.
    """
    model.network.refuse_rodless("a shape along a line", "leave --points out")
    if not 2 <= points <= MOST:
        raise WavesymError(f"--points: {points} is not from 2 to {MOST}")
    length = float(model.length.size) if model.length else 1.0
    some = {name: stations for name, stations in lines.items() if stations[-1].x}
    found = {name: [_sample_line(mode, pieces, stations, points) for mode in modes] for name, stations in some.items()}
    made = []
    largest = [max((moved[k][1] for moved in found.values()), key=_size) for k in range(len(modes))]
    scales = np.array([moved[np.argmax(np.abs(moved))] or 1.0 for moved in largest])[:, None]
    for name, each in found.items():
        x = each[0][0] if each else np.zeros(0)
        made.append(LineShapes(name, length * x, np.array([moved for _, moved in each]) / scales))
    return tuple(made)


def _size(displacements: NDArray[np.complex128]) -> float:
    return float(np.abs(displacements).max())


def _sample_line(
    mode: Mode, pieces: Cut, stations: tuple[Station, ...], points: int
) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """Places along a line and how far they move."""
    part = np.linspace(0, 1, points)
    places, moves = [], []
    for station, following in pairwise(stations):
        assert station.right is not None  # between two stations there is a bar
        places.append(float(station.x) + part * float(following.x - station.x))
        moves.append(_in_bar(mode, pieces, station.right, part))
    return np.concatenate(places), np.asarray(np.concatenate(moves), np.complex128)


def _in_bar(mode: Mode, pieces: Cut, number: int, part: NDArray[np.float64]) -> NDArray[np.complex128]:
    """(a sin w(T - t) + b sin w t)/sin w T on each piece, whose ends move a and b and which a wave crosses in T."""
    edges = [0.0, *(nearest(place) for place in pieces.places[number]), 1.0]
    moved = np.zeros(len(part), complex)
    for k, (low, high) in enumerate(pairwise(edges)):
        bar = pieces.firsts[number] + k
        a, b = (complex(mode.displacement(End(bar, side))) for side in (0, 1))
        own = float(mode.amplitudes.get(bar, 0.0))
        angle = complex(mode.frequency) * nearest(pieces.network.bars[bar].delay)
        here = (part >= low) & (part <= high)
        t = (part[here] - low) / (high - low)
        if mode.amplitudes and a == 0 and b == 0:
            moved[here] = own * np.sin(angle * t)
        elif abs(angle) < _STRAIGHT:
            moved[here] = a * (1 - t) + b * t
        else:
            moved[here] = (a * np.sin(angle * (1 - t)) + b * np.sin(angle * t)) / np.sin(angle)
    return moved
