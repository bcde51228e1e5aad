"""The least and the greatest of what happens along a chain, as numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from wavesym.mechanics.model import Model
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.pictures.histories import Points
from wavesym.pictures.line_histories import Band, LineHistories
from wavesym.pictures.timescale import Timescale
from wavesym.pictures.units import unit_text
from wavesym.results.presentation import number_text


@dataclass(frozen=True)
class BandExtreme:
    """The least or greatest value of a band: where and when; `place` is how one says it."""

    place: str
    unit: str
    x: float
    tau: float
    value: float

    def describe(self, scale: Timescale) -> str:
        """In a line."""
        value = number_text(self.value, unit_text(self.unit), 4)
        return f"{value} {self.place}, {scale.format(self.tau)}"


def extremes(found: LineHistories, band: Band) -> Iterator[BandExtreme]:
    """The greatest and the least value."""
    for place, instant in (
        np.unravel_index(find(band.values), band.values.shape) for find in (np.nanargmax, np.nanargmin)
    ):
        spot = band.spots[place]
        where = f"in storey {place + 1}" if found.storeys else f"at x = {spot.label}"
        tau, value = float(found.taus[instant]), float(band.values[place, instant])
        yield BandExtreme(where, found.unit, spot.x, tau, value)


def line_name(model: Model, found: LineHistories, band: Band) -> str:
    """What a quantity of a line is called."""
    return f"{QUANTITIES[found.quantity].in_words_of(model.labels.kind).phrase}{band.line and ' of branch '}{band.line}"


def describe_extremes(found: LineHistories, band: Band, scale: Timescale) -> str:
    """The greatest and the least value in words."""
    return " ".join(
        f"{word}: {each.describe(scale)}."
        for word, each in zip(("Greatest", "Least"), extremes(found, band), strict=True)
    )


def envelope(band: Band) -> tuple[Points, Points]:
    """The least and the greatest value at each place, (places,)."""
    return np.nanmin(band.values, axis=1), np.nanmax(band.values, axis=1)
