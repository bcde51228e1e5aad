"""What happens along a chain: its motion, and its strain or drift, at many places through the whole horizon.

The scene is asked for other outputs than its own, so that places, units and programs are those of any scene.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

import numpy as np

from wavesym.mechanics.length import LengthUnit, in_unit, place_text
from wavesym.mechanics.model import Model
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.numbers.arrays import Array
from wavesym.pictures.histories import Histories, histories
from wavesym.pictures.reduction import columns_of, extremes_between
from wavesym.pictures.timescale import Timescale
from wavesym.pictures.units import unit_text
from wavesym.programs.program import Program
from wavesym.results.presentation import number_text
from wavesym.scene import Scene
from wavesym.scene.lowering import probes
from wavesym.scene.outputs import Output, observables
from wavesym.systems.place import Place, position_of
from wavesym.systems.station import Station

_PLACES, _FINEST = 64, 8  # of all rods together; parts of a rod
_CLIPPED = 0.995  # of all cells, those whose colours tell them apart


@dataclass(frozen=True)
class Spot:
    """A place as it is `written` in a scene without units, and `told`, in the scene's own unit as are `x` along its
    line and what it stands for, [low, high]."""

    position: str
    label: str
    x: float
    low: float
    high: float


@dataclass(frozen=True)
class Band:
    """A quantity along one line: `values[place, instant]`, NaN where they are the formal continuation of a contact."""

    line: str
    spots: tuple[Spot, ...]
    values: Array

    def tick_labels(self, most: int, first: int = 1) -> list[tuple[float, str]]:
        """Its places with their numbers, at most so many."""
        return [(spot.x, str(k)) for k, spot in enumerate(self.spots, first)][:: -(-len(self.spots) // most)]


@dataclass(frozen=True)
class LineHistories:
    """A quantity along all lines of a chain, at `taus`, by a program. `length` is the unit of places."""

    quantity: str
    unit: str
    taus: Array
    bands: tuple[Band, ...]
    program: Program
    length: LengthUnit | None = None

    @property
    def storeys(self) -> bool:
        """Whether there is one value for each rod, not a curve along it."""
        return self.quantity == "drift"


def line_histories(scene: Scene, model: Model, program: Program | None = None) -> tuple[LineHistories, ...]:
    """Motion, then strain or drift, of all of a scene's chain.

    Args:
        scene: whose chain it is.
        model: the same, lowered.
        program: one that has the outputs of `observed`, where there is one already.

    Raises:
        CostError, ToleranceError: as for such outputs.
    """
    places = {quantity: _places(scene, quantity) for quantity in _quantities(scene)}
    made = histories(chain_outputs(scene, model), program=program)
    length = _length(scene)
    return tuple(
        replace(_quantity_histories(made, quantity, lines), length=length) for quantity, lines in places.items()
    )


def chain_outputs(scene: Scene, model: Model) -> Model:
    """The model of a scene with the outputs that tell what happens along its chain."""
    written = {
        quantity: [spot.position for _, spots in _places(scene, quantity) for spot in spots]
        for quantity in _quantities(scene)
    }
    # numbers stay as they are: written out, those that come from units may be longer than a scene's text may be
    output = Output.model_validate({"until": scene.output.until, "tolerance": scene.output.tolerance, **written})
    return model.watching(probes(scene, observables(output, scene.system, scene.load)))


def _quantities(scene: Scene) -> tuple[str, str]:
    """What tells most of a system: of a building floors and storeys, of what its own start moves velocities."""
    system = scene.system
    if system.type == "building":
        return "relative" if system.choices["base"] == "ground" else "displacement", "drift"
    return "displacement" if scene.load else "velocity", "strain"


def _places(scene: Scene, quantity: str) -> list[tuple[str, tuple[Spot, ...]]]:
    """The places of each line."""
    lines = {name: stations for name, stations in scene.system.lines.items() if stations[-1].x}
    rods = sum(1 for stations in lines.values() for _ in pairwise(stations))
    parts = 1 if scene.system.type == "building" else max(1, min(_FINEST, _PLACES // rods))
    make = {"drift": _drifts, "strain": _strains}.get(quantity, _motions)
    length = _length(scene)
    return [(name, _distinct(scene, quantity, make(name, stations, parts, length))) for name, stations in lines.items()]


def _length(scene: Scene) -> LengthUnit | None:
    """The unit that places are told in."""
    return scene.physical.length if scene.physical else None


def _distinct(scene: Scene, quantity: str, spots: Iterable[Spot]) -> tuple[Spot, ...]:
    """Of two sides of a place that are the same the first, which stands for what both do."""
    found: list[Spot] = []
    last: Place | None = None
    for spot in spots:
        place = scene.system.locate(position_of(spot.position), quantity, scene.load)
        if place == last:
            found[-1] = replace(found[-1], high=spot.high)
        else:
            found.append(spot)
        last = place
    return tuple(found)


def _drifts(line: str, stations: tuple[Station, ...], _: int, length: LengthUnit | None) -> Iterator[Spot]:
    """Of each rod."""
    for k, (one, other) in enumerate(pairwise(stations), 1):
        low, high = in_unit(one.x, length), in_unit(other.x, length)
        yield Spot(place_text(Fraction(k), line), place_text(Fraction(k), line), (low + high) / 2, low, high)


def _strains(line: str, stations: tuple[Station, ...], parts: int, length: LengthUnit | None) -> Iterator[Spot]:
    """In each rod from end to end."""
    for one, other in pairwise(stations):
        step = (other.x - one.x) / parts
        for k in range(parts + 1):
            x, side = one.x + k * step, {0: "+", parts: "-"}.get(k, "")
            ends = (in_unit(each, length) for each in (x, max(one.x, x - step / 2), min(other.x, x + step / 2)))
            yield Spot(place_text(x, line, side), place_text(x, line, side, length), *ends)


def _motions(line: str, stations: tuple[Station, ...], parts: int, length: LengthUnit | None) -> Iterator[Spot]:
    """At each station, on both sides of what may part there, and between."""
    places = [(stations[0].x, "+" if len(stations[0].points) > 1 else "")]
    for one, other in pairwise(stations):
        step = (other.x - one.x) / parts
        places += [(one.x + k * step, "") for k in range(1, parts)]
        places += [(other.x, side) for side in (("-", "+") if len(other.points) > 1 else ("",))]
    xs = [in_unit(x, length) for x, _ in places]
    for k, (x, side) in enumerate(places):
        low, high = xs[max(k - 1, 0)], xs[min(k + 1, len(xs) - 1)]
        label = place_text(x, line, side, length)
        yield Spot(place_text(x, line, side), label, xs[k], (low + xs[k]) / 2, (xs[k] + high) / 2)


def _quantity_histories(made: Histories, quantity: str, lines: list[tuple[str, tuple[Spot, ...]]]) -> LineHistories:
    assert made.program is not None  # histories have one
    own = [history for history in made.outputs if history.output.quantity == quantity]
    taus = own[0].points[:, 0]
    rows = np.array([np.where(taus <= history.formal, history.points[:, 1], np.nan) for history in own])
    cuts = np.cumsum([len(spots) for _, spots in lines])[:-1]
    bands = (Band(*line, values) for line, values in zip(lines, np.split(rows, cuts), strict=True))
    return LineHistories(quantity, own[0].output.unit, taus, tuple(bands), made.program)


def cells(along: LineHistories, band: Band, columns: int) -> Array:
    """The value of the largest size in each of so many columns of time, (places, columns); NaN where it is formal."""
    until = float(along.taus[-1])
    column = np.minimum(columns_of(along.taus, until, columns), columns - 1)
    starts = np.flatnonzero(np.diff(column, prepend=-1))
    ends = np.append(starts[1:], len(column))
    found = np.full((len(band.spots), columns), np.nan)
    for row, values in zip(found, band.values, strict=True):
        known = np.nan_to_num(values)
        low, high = (known[place] for place in extremes_between(known, starts, ends))
        row[column[starts]] = np.where(np.isnan(values[starts]), np.nan, np.where(high >= -low, high, low))
    return _fill_gaps(found)


def _fill_gaps(found: Array) -> Array:
    """Columns without an instant are as the one before."""
    there = ~np.isnan(found).all(axis=0)
    last = np.maximum.accumulate(np.where(there, np.arange(found.shape[1]), 0))
    return found[:, last]


def limit(parts: list[Array]) -> float:
    """The value of the strongest colour: what all but the largest few cells stay within."""
    sizes = np.abs(np.concatenate([part[~np.isnan(part)] for part in parts]))
    return float(np.quantile(sizes, _CLIPPED)) or float(np.max(sizes)) or 1.0


# the least and the greatest


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


def envelope(band: Band) -> tuple[Array, Array]:
    """The least and the greatest value at each place, (places,)."""
    return np.nanmin(band.values, axis=1), np.nanmax(band.values, axis=1)
