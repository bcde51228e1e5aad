"""Commented scenes to start from, and the same under a record of the user's own."""

from __future__ import annotations

import json
from fractions import Fraction
from importlib.resources import files
from os import PathLike

from wavesym.errors import WavesymError
from wavesym.fields.numbers import decimal_text
from wavesym.records.read import read_record

IN_UNITS = ("frame", "wall", "soil", "drive", "impact", "pile")
DIMENSIONLESS = ("building", "collision")
KINDS = (*IN_UNITS, *DIMENSIONLESS)

_FIRST = files("wavesym.scene") / "first"
_USUAL_UNIT = {"frame": "g", "wall": "g", "soil": "g", "drive": "N*m"}
"""Of the samples of a record whose file does not say it."""
_REPLACED = ("spacing", "samples", "unit", "times", "steps")
_SCHEMA = "#:schema scene.schema.json"
"""For editors: the file that `wavesym schema -o scene.schema.json` writes."""
_CHOICE = "# or record = "


def first_text(kind: str, record: str | PathLike[str] | None = None) -> str:
    """A commented scene to start from.

    Args:
        kind: one of KINDS.
        record: a file of AT2 or CSV that is its load, until it ends.

    Returns:
        TOML.

    Raises:
        WavesymError: for a kind that starts by itself, or has no units, and takes no record.
        SceneError: for a file that is no record.
    """
    text = f"{_SCHEMA}\n{(_FIRST / f'{kind}.toml').read_bytes().decode()}"
    if record is None:
        return text
    if kind not in _USUAL_UNIT:
        *others, last = _USUAL_UNIT
        raise WavesymError(f"--record: a scene of {kind} takes no record; write {', '.join(others)} or {last}")
    found = read_record(record)
    step = found.even()
    lines = [f"record = {json.dumps(found.file)}"]
    if not found.unit:
        lines.append(f'unit = "{_USUAL_UNIT[kind]}"{"":18}# of its samples: the file does not say')
    if step is None:
        lines.append(f'spacing = "0.01 s"{"":14}# of its samples: the file does not say')
        return _replace_samples(text, lines, "")
    begin = found.times[0] if found.times else Fraction(0)
    if kind == "soil" and not found.times and found.samples[0]:
        begin = step
        lines.append(
            f'start = "{decimal_text(step)} {found.clock or "s"}"{"":15}# its first sample is not 0: it rises to it'
        )
    end = begin + (len(found.samples) - 1) * step
    return _replace_samples(text, lines, f"{decimal_text(end)} {found.clock or 's'}")


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
