"""Commented scenes to start from, and the same under a record of the user's own."""

from __future__ import annotations

import json
from fractions import Fraction
from importlib.resources import files
from os import PathLike
from typing import NamedTuple

from pydantic_core import PydanticCustomError

from wavesym.errors import SceneError, WavesymError
from wavesym.fields import quantity
from wavesym.fields.dimensions import with_article
from wavesym.fields.numbers import decimal_text
from wavesym.fields.table import show
from wavesym.records.read import read_record
from wavesym.records.record_file import RecordFile

IN_UNITS = ("frame", "wall", "soil", "drive", "impact", "pile")
DIMENSIONLESS = ("building", "collision")
KINDS = (*IN_UNITS, *DIMENSIONLESS)

_FIRST = files("wavesym.scene") / "first"
_USUAL_UNIT = {"frame": "g", "wall": "g", "soil": "g", "drive": "N*m"}
"""Of the samples of a record whose file does not say it."""
_SAMPLES = {"g": "acceleration", "N*m": "moment"}
_REPLACED = ("spacing", "samples", "unit", "times", "steps")
_SCHEMA = "#:schema scene.schema.json"
"""For editors: the file that `wavesym schema -o scene.schema.json` writes."""
_CHOICE = "# or record = "


class FirstScene(NamedTuple):
    """A scene to start from, and what was assumed of its record, as lines for whoever wrote none of it."""

    text: str
    assumptions: tuple[str, ...] = ()


def first_text(kind: str) -> str:
    """A commented scene to start from, in TOML; `kind` is one of KINDS."""
    return first_scene(kind).text


def first_scene(kind: str, record: str | PathLike[str] | None = None, unit: str | None = None) -> FirstScene:
    """A commented scene to start from.

    Args:
        kind: one of KINDS.
        record: a file of AT2 or CSV that is its load, until it ends.
        unit: that of the record's samples, where the file does not say it; None for what is usual.

    Returns:
        TOML, and a line for each thing that neither the file nor `unit` says.

    Raises:
        WavesymError: for a kind that starts by itself, or has no units, and takes no record, and for a unit without a
            record, or of something else.
        SceneError: for a file that is no record, or says another unit.
    """
    text = f"{_SCHEMA}\n{(_FIRST / f'{kind}.toml').read_bytes().decode()}"
    if record is None and unit is not None:
        raise WavesymError(f"--unit: {show(unit)} is that of a record; write --record FILE too")
    if record is None:
        return FirstScene(text)
    if kind not in _USUAL_UNIT:
        *others, last = _USUAL_UNIT
        raise WavesymError(f"--record: a scene of {kind} takes no record; write {', '.join(others)} or {last}")
    found = read_record(record)
    step = found.even()
    lines = [f"record = {json.dumps(found.file)}"]
    assumptions: list[str] = []
    _refuse_unit(kind, found, unit)
    if not found.unit:
        comment = "of its samples" if unit else "of its samples: assumed, the file does not say"
        lines.append(f"{f'unit = {json.dumps(unit or _USUAL_UNIT[kind])}':31} # {comment}")
    if not found.unit and unit is None:
        other = "m/s^2" if _USUAL_UNIT[kind] == "g" else "kN*m"
        assumptions.append(
            f'{found.file} does not say the unit of its samples: "{_USUAL_UNIT[kind]}" is assumed; '
            f"write --unit {other} where that is it"
        )
    if step is None:
        lines.append(f'spacing = "0.01 s"{"":14}# of its samples: assumed, the file does not say')
        assumptions.append(
            f'{found.file} does not say the time between its samples: "0.01 s" is assumed; '
            "write another `spacing` in the scene where that is it"
        )
        return FirstScene(_replace_samples(text, lines, ""), tuple(assumptions))
    begin = found.times[0] if found.times else Fraction(0)
    if kind == "soil" and not found.times and found.samples[0]:
        begin = step
        lines.append(
            f'start = "{decimal_text(step)} {found.clock or "s"}"{"":15}# its first sample is not 0: it rises to it'
        )
    end = begin + (len(found.samples) - 1) * step
    replaced = _replace_samples(text, lines, f"{decimal_text(end)} {found.clock or 's'}")
    return FirstScene(replaced, tuple(assumptions))


def _refuse_unit(kind: str, record: RecordFile, written: str | None) -> None:
    """WavesymError for what is no unit of what the load of a kind is; SceneError for such a file, or another unit."""
    needed = _SAMPLES[_USUAL_UNIT[kind]]
    try:
        size = quantity.unit(written, needed) if written is not None else None
    except PydanticCustomError as error:
        raise WavesymError(f"--unit: {error}") from None
    try:
        other = quantity.unit(record.unit, needed) if record.unit else size
    except PydanticCustomError as error:
        meant = quantity.likely_unit(record.unit)
        if meant == record.unit and not quantity.is_unit(record.unit):
            raise SceneError(f"the unit of its samples: {error}", file=record.file) from None
        hint = f". Did you mean {meant}?" if meant != record.unit else ""
        what = f"samples in {record.unit}; the load of a {kind} is {with_article(needed)}{hint}"
        raise SceneError(what, file=record.file) from None
    if size is not None and size != other:
        raise SceneError(f"--unit {written} is not that of the file; write {record.unit}, or none", file=record.file)


def _replace_samples(text: str, record: list[str], until: str) -> str:
    """A scene with lines of a record in place of its own samples, until a time."""
    made: list[str] = []
    within = False
    for line in text.splitlines():
        key = line.partition("=")[0].strip()
        within = line.startswith("[[load]]") or (within and not line.startswith("["))
        if within and key in _REPLACED:
            continue
        if within and line.startswith(_CHOICE):
            made += record
        elif key == "until" and until:
            made.append(f"{f'until = {json.dumps(until)}':31} # the last instant: the end of the record")
        else:
            made.append(line)
    return "\n".join(made) + "\n"
