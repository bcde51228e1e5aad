"""Loads in physical units as loads without: times in tau, values in units of the system."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from os import PathLike
from typing import Any

from pydantic_core import PydanticCustomError

from wavesym.errors import SceneError
from wavesym.fields.dimensions import DIMENSIONS
from wavesym.fields.loads import refuse_falling
from wavesym.fields.numbers import decimal_text, exact
from wavesym.fields.quantity import unit
from wavesym.fields.quantity_fields import read_quantity
from wavesym.fields.table import WrittenDecimal, as_list, key_context, refusal, show
from wavesym.records.record_file import RecordFile, damage_error
from wavesym.records.recording import Recording, read_recording
from wavesym.systems.dimensionless import LoadUnit

_VALUES, _SLOPES = ("a", "steps"), ("b", "ramps")

Acts = Callable[[Mapping[str, Any]], LoadUnit]
"""What a load of these fields acts as."""


def dimensionless(load: Mapping[str, Any], acting: LoadUnit, seconds: Fraction) -> dict[str, Any]:
    """A load's table. Raises the error of `table.refusal`."""
    table: dict[str, Any] = {}
    physical_keys = {"unit", "samples"} | (
        {"record", "start", "column"} if "record" in load else set()
    )  # converted below
    for key, value in load.items():
        new = acting.renames.get(key, key)
        with key_context(key):
            if key == "times":
                table[new] = _times(value, seconds)
            elif key in _VALUES:
                table[new] = _all(value, acting.dimension, acting.size)
            elif key in _SLOPES:
                table[new] = _all(value, acting.slope, acting.size / seconds)
            elif key == "amplitude":
                table[new] = read_quantity(value, acting.dimension) / acting.size
            elif key == "frequency":
                table[new] = read_quantity(value, "frequency", 1) * seconds
            elif key == "duration" or (key == "start" and "shape" in load):
                table[new] = read_quantity(value, "time", int(key == "duration")) / seconds
            elif key == "spacing":
                table[new] = read_quantity(value, "time", 1) / seconds
            elif key not in physical_keys:
                table[new] = value
    if "record" in load:
        table |= _read_record(load, acting, seconds)
    elif "samples" in load:
        table["samples"] = _samples(load, acting)
    elif "unit" in load:
        raise refusal("is that of samples or a record; write these, or leave it out", "unit")
    return {**table, **acting.additions}


def _times(value: object, seconds: Fraction) -> list[Fraction]:
    """Times in tau; here they are compared, as messages show them as they were given."""
    values = as_list(value)
    times = []
    for k, each in enumerate(values):
        with key_context(k):
            times.append(read_quantity(each, "time", 0))
    refuse_falling(times, values)
    return [time / seconds for time in times]


def _all(value: object, dimension: str, size: Fraction) -> list[Fraction]:
    numbers = []
    for k, each in enumerate(as_list(value)):
        with key_context(k):
            numbers.append(read_quantity(each, dimension) / size)
    return numbers


def _samples(load: Mapping[str, Any], acting: LoadUnit) -> list[Fraction]:
    """Bare numbers, all in one unit."""
    factor = _unit(load, acting)
    numbers = []
    for k, each in enumerate(as_list(load["samples"])):
        with key_context("samples", k):
            numbers.append(exact(each) * factor)
    return numbers


def _unit(load: Mapping[str, Any], acting: LoadUnit) -> Fraction:
    """How much a sample of 1 is without units."""
    if load.get("unit") is None:
        example = DIMENSIONS[acting.dimension].example.partition(" ")[2]
        raise refusal(f'missing; write the unit of the samples, such as "{example}"', "unit")
    with key_context("unit"):
        return unit(load["unit"], acting.dimension) / acting.size


def read(load: object, acts: Acts) -> object:
    """A load whose record is what was in its file. Raises the error of `table.refusal`."""
    if not isinstance(load, Mapping) or not isinstance(path := load.get("record"), str | PathLike):
        return load
    dimension, spacing = acts(load).dimension, None
    if "spacing" in load:
        with key_context("spacing"):
            spacing = read_quantity(load["spacing"], "time", 1)
    with key_context("record"):
        try:
            recording = read_recording(
                path, load.get("column"), lambda record: _spacing_in_file(record, dimension, spacing)
            )
        except SceneError as error:
            raise refusal(str(error)) from None
    return {**load, "record": recording}


def _spacing_in_file(record: RecordFile, dimension: str, spacing: Fraction | None) -> Fraction | None:
    """A spacing in the file's unit of time. SceneError where its units are none of a time and of what it acts as."""
    try:
        if record.unit:
            unit(record.unit, dimension)
        clock = _clock(record.clock)
    except PydanticCustomError as error:
        raise damage_error(record.file, record.head, str(error)) from None
    return spacing and spacing / clock


def _read_record(load: Mapping[str, Any], acting: LoadUnit, seconds: Fraction) -> dict[str, Any]:
    """A record without units. What its file says may be said again, but not otherwise."""
    with key_context("record"):
        if not isinstance(load["record"], Recording | Mapping):
            raise refusal(f"{show(load['record'])} is not a path; write that of a file")
        recording = Recording.model_validate(load["record"])  # as it is, or as it was dumped
        clock = _clock(recording.clock)
        size = unit(recording.unit, acting.dimension) / acting.size if recording.unit else None
    factor = _unit(load, acting) if size is None or "unit" in load else size
    if size is not None and size != factor:
        written = show(WrittenDecimal(recording.unit))
        raise refusal(f"{show(load['unit'])}, but the file says {written}; write that, or nothing", "unit")
    made: dict[str, Any] = {"samples": [sample * factor for sample in recording.samples]}
    table: dict[str, Any] = {"record": made}
    for key, least, value in (("spacing", 1, recording.spacing), ("start", 0, recording.start)):
        if value is not None:
            made[key] = value * clock / seconds
        if key in load:
            with key_context(key):
                time = read_quantity(load[key], "time", least)
                if value is not None and time != value * clock:
                    written = f"{decimal_text(value)} {recording.clock or 's'}"
                    raise refusal(f"{show(load[key])}, but the file says {written}; write that, or nothing")
            table[key] = time / seconds
    return table


def _clock(written: str) -> Fraction:
    """A file's unit of time in seconds; one that it does not say is the second."""
    return unit(written or "s", "time")
