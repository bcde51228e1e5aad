"""What a file of a record says, and the decimals in it.

A path in a scene may point to any file. So a message names the place of what is wrong, and quotes numbers at most: text
of a file is shown only where it is the header of a table of numbers.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import lcm

from wavesym.errors import SceneError
from wavesym.fields.numbers import LARGEST_EXPONENT, LONGEST, decimal_text
from wavesym.fields.table import WrittenDecimal, show

# as Fortran writes them, too: .0200, 5., -.1234E-02, 1.5D+00
_DECIMAL = re.compile(r"([+-]?)([0-9]*)(?:\.([0-9]*))?(?:[eEdD]([+-]?[0-9]{1,4}))?")
_LARGEST = Fraction(10) ** LARGEST_EXPONENT
_SMALLEST = 1 / _LARGEST
MOST_SAMPLES = 1_000_000
_NEAR = Fraction(1, 10)  # of a step: times that are written with few digits


@dataclass(frozen=True)
class RecordFile:
    """The samples of a file, exact, and as their `digits` there; `lines` says on which line each of them is.

    What the file does not say is None, or empty: `unit` is that of the samples, `clock` that of times. `times` are
    those of a time column, one for each sample; `spacing` is what a file without one says in its header. `head` is the
    line that says units.
    """

    file: str
    kind: str
    samples: tuple[Fraction, ...]
    digits: tuple[str, ...]
    lines: tuple[int, ...]
    unit: str = ""
    clock: str = ""
    spacing: Fraction | None = None
    times: tuple[Fraction, ...] | None = None
    head: int = 1

    def even(self, spacing: Fraction | None = None) -> Fraction | None:
        """The time between two samples, in the file's unit; None where neither the file nor `spacing` says it.

        Times must be even to the last digit, or where `spacing` says it, as digits allow. SceneError where they are
        not.
        """
        times = self.times
        if times is None:
            return spacing if self.spacing is None else self.spacing
        if spacing is None and len(times) < 2:
            return None
        step = times[1] - times[0] if spacing is None else spacing
        if spacing is None and step > 0 and _in_step(times):
            return step
        for k, (before, time) in enumerate(pairwise(times), 1):
            if (since := time - before) <= 0:
                what = (
                    f"the time {decimal_text(time)} is not later than the {decimal_text(before)} before it; "
                    "write times in rising order"
                )
                raise damage_error(self.file, self.lines[k], what)
            if since == step and spacing is None:  # as up to here
                continue
            expected = times[0] + k * step
            if spacing is None or abs(time - expected) > _NEAR * step:
                what = f"the time {decimal_text(time)} should be {decimal_text(expected)}; write {_even(step, spacing)}"
                raise damage_error(self.file, self.lines[k], what)
        return step


def _in_step(times: Sequence[Fraction]) -> bool:
    """Whether times are as far apart as the first two: in integers, as there may be many."""
    over = lcm(*{time.denominator for time in times})
    ticks = [time.numerator * (over // time.denominator) for time in times]
    first, step = ticks[0], ticks[1] - ticks[0]
    return ticks == list(range(first, first + len(ticks) * step, step))


def _even(step: Fraction, spacing: Fraction | None) -> str:
    if spacing is not None:
        return f"samples {decimal_text(step)} apart, as `spacing` says"
    return f"samples {decimal_text(step)} apart, as the first two; of rounded times `spacing` in the scene says it"


def damage_error(file: str, line: int, what: str) -> SceneError:
    """The error for what is wrong on a line of a file."""
    return SceneError(what, f"line {line}", file)


def decimal(text: str) -> Fraction | None:
    """The number that a file writes; None where it is none, or none of a moderate size."""
    found = _DECIMAL.fullmatch(text) if len(text) <= LONGEST else None
    if not found or not (found[2] or found[3]):
        return None
    whole, part, power = found[2], found[3] or "", int(found[4] or 0)
    if abs(power) > LARGEST_EXPONENT:
        return None
    below = len(part) - power
    number = int(f"{found[1]}{whole}{part}")
    value = Fraction(number, 10**below) if below > 0 else Fraction(number * 10**-below)
    return value if not (number and power) or _SMALLEST <= abs(value) <= _LARGEST else None


def bare(text: str) -> str:
    """What a file says, for a message."""
    return show(WrittenDecimal(text))
