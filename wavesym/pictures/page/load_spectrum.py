"""Response spectra of what shakes a building, and of what it makes of that, with its own periods in them."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10

import numpy as np

from wavesym.errors import WavesymError
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.pictures.histories import History
from wavesym.pictures.page.frame import Frame, PlotAxis
from wavesym.pictures.page.plots import BELOW, LEFT, RIGHT, TOP, WIDTH, PagePicture, csv_address, picture, spot
from wavesym.pictures.page.svg import line, polyline, text
from wavesym.pictures.timescale import Timescale
from wavesym.pictures.units import unit_text
from wavesym.programs.program import Program
from wavesym.results.spectrum import line_spectrum, spectra

_DAMPING = 0.05  # where modes of the structure have no one ratio: what codes take
_BEYOND, _PER_DECADE = 4.0, 100  # how far the periods go beyond those of the structure; how many there are
_STEPS = 50_000  # at most, of the shortest period: 16 for each
_HEIGHT = 220.0  # pixels


def load_spectrum(
    model: Model, loads: Sequence[History], periods: Sequence[float], scale: Timescale
) -> PagePicture | None:
    """Pseudo-acceleration over period of the acceleration of a base.

    Args:
        model: what is shaken.
        loads: what acts on it.
        periods: its longest, in the time of results.
        scale: how time is told.

    Returns:
        The picture; None where no acceleration shakes it, or it has no periods.
    """
    shaken = model.labels.system["type"] == "building" or any(
        point.motion == "acceleration" for point in model.network.points
    )
    if len(loads) != 1 or not periods or not shaken:
        return None
    load, until = loads[0], nearest(model.until) * scale.per_tau
    shortest = max(min(periods) / _BEYOND, 16 * until / _STEPS)
    longest = max(max(periods) * _BEYOND, 2 * shortest)
    curve = np.geomspace(shortest, longest, int(_PER_DECADE * log10(longest / shortest)) + 2)
    own = np.array(sorted(periods))
    every = np.union1d(curve, own)
    damping = _ratio(model)
    lines = [stretch * [scale.per_tau, 1.0] for stretch in load.stretches]
    values = line_spectrum(lines, every, damping)
    title = f"Response spectrum of the load, damping {100 * damping:.3g} %"
    return _picture("spectrum", title, every, values, own, load.output.unit, scale)


def floor_spectrum(
    model: Model, program: Program | None, periods: Sequence[float], scale: Timescale
) -> PagePicture | None:
    """The same of the last output of quantity acceleration, a roof's where floors are listed from below.

    Args:
        model: the scene's.
        program: has its outputs.
        periods: the longest of the structure, in the time of results.
        scale: how time is told.

    Returns:
        The picture; None where there is no such output, or the horizon is too short.
    """
    accelerations = [probe for probe in model.probes if probe.quantity == "acceleration"]
    if program is None or not accelerations or (model.clock.unit if model.clock else "") != scale.unit:
        return None
    damping, probe = _ratio(model), accelerations[-1]
    try:
        found = spectra(model.watching([probe]), damping, program)
    except WavesymError:
        return None
    own = np.array([each for each in periods if found.periods[0] <= each <= found.periods[-1]])
    title = f"{probe.label}: response spectrum, damping {100 * damping:.3g} %"
    return _picture("floor", title, found.periods, found.values[0], own, probe.unit, scale)


def _picture(
    key: str, title: str, periods: Array, values: Array, own: Array, unit: str, scale: Timescale
) -> PagePicture:
    x = PlotAxis(log10(periods[0]), log10(periods[-1]), LEFT, WIDTH - RIGHT)
    above = 12 * (len(own) + 1)  # a row for the name of each period
    y = PlotAxis(0.0, _HEIGHT / (_HEIGHT - above) * float(values.max()) or 1.0, TOP + _HEIGHT, TOP)
    time = scale.unit or "tau"
    frame = Frame(
        x,
        y,
        f"period in {time}",
        f"pseudo-acceleration{unit and chr(10) + 'in '}{unit_text(unit)}",
        x_places=_decades(periods[0], periods[-1]),
    )
    marks, words = [], []
    for number, period in enumerate(sorted(own, reverse=True), 1):
        value = float(np.interp(period, periods, values))
        at, top = x.pixel(log10(period)), TOP + 12 * (len(own) - number)  # below the names of those to the left
        marks += [line(at, top + 2, at, TOP + _HEIGHT, "period"), spot(at, y.pixel(value))]
        marks.append(text(at + 5, top + 12, f"T{number} = {period:.3g} {time}", "start", class_="halo"))
        words.append(f"{value:.4g}{unit and ' '}{unit_text(unit)} at T{number} = {period:.3g} {time}")
    points = [(x.pixel(log10(t)), y.pixel(v)) for t, v in zip(periods.tolist(), values.tolist(), strict=True)]
    markup = picture(
        key,
        title,
        f"At the periods of the structure: {', '.join(words)}." if words else "Over the period.",
        TOP + _HEIGHT + BELOW,
        frame.draw(),
        polyline(points, "spectrum"),
        *marks,
    )
    name = f"{'floor ' if key == 'floor' else ''}pseudo-acceleration{unit and ' in '}{unit_text(unit)}"
    return PagePicture(title, markup, ((0, name, csv_address((f"period in {time}", name), periods, values)),))


def _ratio(model: Model) -> float:
    """The damping ratio of the modes of a structure, if there is one for all."""
    damping = model.damping
    single = damping is not None and damping.acts and damping.modes is None and len(damping.ratios) == 1
    return nearest(damping.ratios[0]) if damping is not None and single else _DAMPING


def _decades(low: float, high: float) -> list[tuple[float, str]]:
    """1, 2 and 5 of each decade between two periods, where they stand on a logarithmic axis."""
    first, last = (floor(log10(each)) for each in (low, high))
    numbers = [digit * 10.0**power for power in range(first, last + 1) for digit in (1, 2, 5)]
    return [(log10(each), f"{each:.3g}") for each in numbers if low <= each <= high]
