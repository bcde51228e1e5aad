"""Loads in physical units as loads without: times in tau, values in units of the system."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from os import PathLike
from typing import Any

from wavesym.errors import SceneError
from wavesym.fields.dimensions import DIMENSIONS
from wavesym.fields.numbers import exact
from wavesym.fields.quantity import unit
from wavesym.fields.table import listed, shown, wrong
from wavesym.records.recording import Recording, recorded
from wavesym.scene.physical.measured import measured, placed, tidy
from wavesym.scene.physical.rewritten import LoadUnit

_VALUES, _SLOPES = ("a", "steps"), ("b", "ramps")
_MOST_TOLD = 8


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
            elif key not in ("unit", "samples", "record", "start", "column"):
                table[new] = value
    if "record" in load:
        table |= _recorded(load, acting, seconds)
    elif "samples" in load:
        table["samples"] = _samples(load, acting)
    elif "unit" in load:
        raise wrong("given without samples or a record, none expected", "unit")
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
    factor = _unit(load, acting)
    numbers = []
    for k, each in enumerate(listed(load["samples"])):
        with placed("samples", k):
            numbers.append(exact(each) * factor)
    return numbers


def _unit(load: Mapping[str, Any], acting: LoadUnit) -> Fraction:
    """How much a sample of 1 is without units."""
    if load.get("unit") is None:
        example = DIMENSIONS[acting.dimension].example.partition(" ")[2]
        raise wrong(f'missing, the unit of the samples such as "{example}" expected', "unit")
    with placed("unit"):
        return unit(load["unit"], acting.dimension) / acting.size


def read(load: object) -> object:
    """A load whose record is what was in its file, as it is dumped. Raises the error of `table.wrong`."""
    if not isinstance(load, Mapping) or not isinstance(path := load.get("record"), str | PathLike):
        return load
    spacing = None
    if "spacing" in load:
        with placed("spacing"):
            spacing = measured(load["spacing"], "time", 1)
    with placed("record"):
        try:
            recording = recorded(path, load.get("column"), spacing)
        except SceneError as error:
            raise wrong(str(error)) from None
    return {**load, "record": recording.model_dump(exclude_defaults=True)}


def _recorded(load: Mapping[str, Any], acting: LoadUnit, seconds: Fraction) -> dict[str, Any]:
    """A record without units. What its file says is not said again; times without a unit are in seconds."""
    with placed("record"):
        recording = Recording.model_validate(load["record"])
        clock = unit(recording.clock or "s", "time")
    for key, said in (("spacing", recording.spacing), ("start", recording.start), ("unit", recording.unit)):
        if said and key in load:
            told = said if isinstance(said, str) else f"{tidy(said)} {recording.clock or 's'}"
            raise wrong(f"{shown(load[key])} given, none expected (the file says {told})", key)
    if recording.unit:
        with placed("record"):
            factor = unit(recording.unit, acting.dimension) / acting.size
    else:
        factor = _unit(load, acting)
    made: dict[str, Any] = {"samples": [sample * factor for sample in recording.samples]}
    for key, said in (("spacing", recording.spacing), ("start", recording.start)):
        if said is not None:
            made[key] = said * clock / seconds
    table: dict[str, Any] = {"record": made}
    if "start" in load:
        with placed("start"):
            table["start"] = measured(load["start"], "time") / seconds
    return table


def told(load: Mapping[str, Any]) -> str:
    """A load as it was said, in a line; of a long list how long it is."""
    words = []
    for key, value in load.items():
        if key == "record":
            words.append(f"record of {len(value['samples'])} samples")
        elif isinstance(value, list):
            words.append(f"{key} {', '.join(map(str, value))}" if len(value) <= _MOST_TOLD else f"{len(value)} {key}")
        else:
            words.append(f"{key} {value}")
    return ", ".join(words)
