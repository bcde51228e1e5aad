"""AT2, the format of the PEER ground motion database: three lines of text, one that counts, then the samples.

The fourth line is `NPTS=  1559, DT=   .0200 SEC`, or bare numbers, `1559   .0200   NPTS, DT`. DT is in seconds where
no unit stands behind it; MSEC and the like are read, any other word is refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction

from wavesym.records.record_file import MOST_SAMPLES, RecordFile, bare, damage_error, decimal

_HEADER = 4
_NAMED = re.compile(r"NPTS *= *([0-9]+)[ ,]+DT *= *([+-]?[0-9.]+(?:[eEdD][+-]?[0-9]+)?)(.*)", re.IGNORECASE)
_BARE = re.compile(r"([0-9]+)[ ,]+([+-]?[0-9.]+(?:[eEdD][+-]?[0-9]+)?)((?:[ ,].*)?)")
_COUNTS = re.compile(r"\b(?:NPTS|DT)\b", re.IGNORECASE)
_NAMES = re.compile(r"[ ,]*NPTS *, *DT\b", re.IGNORECASE)  # what bare numbers are
_CLOCKS = {
    **dict.fromkeys(("", "S", "SEC", "SECS", "SECOND", "SECONDS"), Fraction(1)),
    **dict.fromkeys(("MS", "MSEC", "MSECS", "MILLISECOND", "MILLISECONDS"), Fraction(1, 1000)),
}
_UNITS = re.compile(r"UNITS? +OF +([A-Z/^*0-9]+)(?: *[(\[] *([A-Z/^*0-9]+) *[)\]])?", re.IGNORECASE)
_SECONDS = re.compile(r"/(?:SEC|S)(/(?:SEC|S)|(?:\^|\*\*)?2)?")
_KNOWN = {"G": "g", "GAL": "Gal", "GALS": "Gal", "MM": "mm", "CM": "cm", "M": "m"}


def is_at2(lines: Sequence[str]) -> bool:
    """Whether the fourth line says so."""
    return len(lines) >= _HEADER and "NPTS" in lines[_HEADER - 1].upper()


def at2(file: str, lines: Sequence[str]) -> RecordFile:
    """The samples of an AT2 file. SceneError, which names the line."""
    count, step = _read_counts(file, lines)
    written: list[str] = []
    samples: list[Fraction] = []
    places: list[int] = []
    for number, line in enumerate(lines[_HEADER:], _HEADER + 1):
        for place, word in enumerate(line.split(), 1):
            value = decimal(word)
            if value is None:
                raise damage_error(file, number, f"word {place} is no decimal; write numbers alone")
            if len(samples) == count:
                raise damage_error(
                    file, number, f"more numbers than the {count} of NPTS on line {_HEADER}; write as many"
                )
            samples.append(value)
            written.append(word)
            places.append(number)
    if len(samples) < count:
        what = f"the file ends after {len(samples)} numbers of the {count} of NPTS on line {_HEADER}; write all of them"
        raise damage_error(file, places[-1] if places else _HEADER, what)
    unit, head = _read_unit(file, lines[: _HEADER - 1])
    return RecordFile(
        file, "AT2", tuple(samples), tuple(written), tuple(places), unit, clock="s", spacing=step, head=head
    )


def _read_unit(file: str, lines: Sequence[str]) -> tuple[str, int]:
    """The unit of samples that lines of text say, and on which; "" where they say none that is known.

    Raises:
        SceneError: they say two.
    """
    found = [
        (unit, number)
        for number, line in enumerate(lines, 1)
        for words in _UNITS.findall(line)
        for unit in map(_unit, words)
        if unit
    ]
    for unit, number in found:
        if unit != found[0][0]:
            raise damage_error(file, number, f"the samples have two units, {found[0][0]} and {unit}; write one of them")
    return found[0] if found else ("", len(lines))


def _unit(word: str) -> str:
    """As scenes write it: "cm/s^2" of CM/SEC/SEC."""
    length, per, time = word.upper().partition("/")
    seconds = _SECONDS.fullmatch(per + time)
    if not per or (seconds and length in ("MM", "CM", "M")):
        return _KNOWN.get(length, "") + (f"/s{'^2' * bool(seconds[1])}" if seconds else "")
    return ""


def _read_counts(file: str, lines: Sequence[str]) -> tuple[int, Fraction]:
    """How many samples, and how far apart."""
    expected = "no NPTS and DT; write them as in NPTS=  1559, DT=   .0200 SEC"
    if len(lines) < _HEADER:
        raise damage_error(file, len(lines), f"the file ends, three lines of text and one with {expected}")
    line = lines[_HEADER - 1].strip()
    found = _NAMED.fullmatch(line) or _BARE.fullmatch(line)
    step = decimal(found[2]) if found else None
    if found is None or step is None:
        raise damage_error(file, _HEADER, expected)
    if step <= 0:
        raise damage_error(file, _HEADER, f"DT = {bare(found[2])} is not positive; write more than 0")
    if not found[1].strip("0"):
        raise damage_error(file, _HEADER, "NPTS = 0 is no record; write at least 1")
    if again := _COUNTS.search(_NAMES.sub("", found[3])):
        raise damage_error(file, _HEADER, f"{again[0].upper()} stands twice; write it once")
    clock = _clock(file, found[3])
    if len(found[1]) > 9 or int(found[1]) > MOST_SAMPLES:
        raise damage_error(file, _HEADER, f"NPTS = {bare(found[1])} is too many; write at most {MOST_SAMPLES}")
    return int(found[1]), step * clock


def _clock(file: str, words: str) -> Fraction:
    """How many seconds the unit behind DT is. What stands apart from it by a comma is no unit."""
    word = _NAMES.sub("", words).split(",")[0].strip(" .()[]")
    if (clock := _CLOCKS.get(word.upper())) is None:
        raise damage_error(file, _HEADER, "the unit behind DT is not known; write SEC or MSEC")
    return clock
