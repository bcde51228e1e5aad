"""Loads in physical units as loads without: times in tau, values in units of the system."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any

from wavesym.fields.dimensions import DIMENSIONS
from wavesym.fields.numbers import exact
from wavesym.fields.quantity import unit
from wavesym.fields.table import listed, shown, wrong
from wavesym.scene.physical.measured import measured, placed
from wavesym.scene.physical.rewritten import LoadUnit

_VALUES, _SLOPES = ("a", "steps"), ("b", "ramps")


def dimensionless(load: Mapping[str, Any], acting: LoadUnit, seconds: Fraction) -> dict[str, Any]:
    """A load's table. Raises the error of `table.wrong`."""
    table: dict[str, Any] = {}
    for key, value in load.items():
        new = acting.renamed.get(key, key)
        with placed(key):
            if key == "times":
                table[new] = _times(value, seconds)
            elif key in _VALUES:
                table[new] = _all(value, acting.dimension, acting.size)
            elif key in _SLOPES:
                table[new] = _all(value, acting.slope, acting.size / seconds)
            elif key == "spacing":
                table[new] = measured(value, "time", 1) / seconds
            elif key not in ("unit", "samples"):
                table[new] = value
    if "samples" in load:
        table["samples"] = _samples(load, acting)
    elif "unit" in load:
        raise wrong("given without samples, none expected", "unit")
    return {**table, **acting.added}


def _times(value: object, seconds: Fraction) -> list[Fraction]:
    """Times in tau; here they are compared, as messages show them as they were given."""
    values = listed(value)
    times = []
    for k, each in enumerate(values):
        with placed(k):
            times.append(measured(each, "time", 0))
    for k, (before, time) in enumerate(pairwise(times), 1):
        if time <= before:
            raise wrong(f"{shown(values[k])} given, more than the {shown(values[k - 1])} before it expected", k)
    return [time / seconds for time in times]


def _all(value: object, dimension: str, size: Fraction) -> list[Fraction]:
    numbers = []
    for k, each in enumerate(listed(value)):
        with placed(k):
            numbers.append(measured(each, dimension) / size)
    return numbers


def _samples(load: Mapping[str, Any], acting: LoadUnit) -> list[Fraction]:
    """Bare numbers, all in one unit."""
    if load.get("unit") is None:
        example = DIMENSIONS[acting.dimension].example.partition(" ")[2]
        raise wrong(f'missing, the unit of the samples such as "{example}" expected', "unit")
    with placed("unit"):
        factor = unit(load["unit"], acting.dimension) / acting.size
    numbers = []
    for k, each in enumerate(listed(load["samples"])):
        with placed("samples", k):
            numbers.append(exact(each) * factor)
    return numbers
