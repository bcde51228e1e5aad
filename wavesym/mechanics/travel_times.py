"""Travel times of rods with a common measure: those that have one already, or the nearest that do.

Waves are computed window by window, and a window is a common measure of all travel times T_i (docs/march.md). Those
that were measured have none that is long enough. k_i h has, with whole k_i: it is off by |k_i h/T_i - 1|, and the h
for which the largest of these is least is 2/(min k_i/T_i + max k_i/T_i). The method of characteristics adjusts wave
speeds likewise (Wylie and Streeter, Fluid Transients, "wave speed adjustment").
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from decimal import ROUND_CEILING, Context, Decimal
from fractions import Fraction

from flint import fmpq

from wavesym.errors import MeasureError
from wavesym.mechanics.network import Bar
from wavesym.numbers.doubles import common_measure, fraction, nearest, rational

FINEST = 64
"""The shortest travel time is no more windows than that."""

_LITTLE = fmpq(1, 200)  # of a speed: as much is less than anyone knows of it
_CHEAP = 16  # windows to the shortest travel time
_MOST_NAMED = 6  # changes of speeds, one by one
_KEPT = fmpq(9, 10)  # of what speeds may change
_DIGITS = Context(prec=2, rounding=ROUND_CEILING)


def step_of(delays: Sequence[fmpq], *, or_pieces: bool = True) -> fmpq:
    """The greatest common measure of travel times. MeasureError where the shortest is more than 64 of it.

    `or_pieces` says whether pieces could be made instead, which need none.
    """
    step = common_measure(delays)
    if step * FINEST < (shortest := min(delays)):
        few = ", ".join(map(str, sorted(set(delays))[:3])) + (", ..." if len(set(delays)) > 3 else "")
        helps = f'speed_adjustment = "{percent(max(_LITTLE, _nearest(delays, _LITTLE)[0]))}"'
        or_else = ", or pieces, help" if or_pieces else " helps"
        raise MeasureError(
            f"system.parts: delays {few} have the common measure {step}, {float(shortest / step):.3g} to the "
            f"shortest, the limit in a march is {FINEST} ({helps} under [system]{or_else})",
            helps,
        )
    return step


def what_adjusts(bars: Sequence[Bar]) -> str:
    """What gives travel times a common measure; "" where they have one that is long enough, or there are no rods."""
    try:
        if bars:
            step_of([bar.delay for bar in bars])
    except MeasureError as error:
        return f"{error.helps} under [system]"
    return ""


def adjust_speeds(bars: Sequence[Bar], most: fmpq) -> tuple[Bar, ...]:
    """The same rods with a common measure of travel times, their lengths and impedances kept.

    Args:
        bars: rods of a network.
        most: how much of its speed that of a rod may change.

    Returns:
        The rods, changed by no more than 0.5 % where few windows are enough for that, whatever `most` allows;
        unchanged where they have a common measure already.

    Raises:
        MeasureError: where no common measure is so near; it says which is.
    """
    delays = [bar.delay for bar in bars]
    if not bars or common_measure(delays) * FINEST >= min(delays):
        return tuple(bars)
    change, near = _nearest(delays, most)
    if change > most:
        helps = f'"{percent(change)}"'
        raise MeasureError(f"too little for travel times with a common measure; write {helps} or more", helps)
    return tuple(replace(bar, speed=bar.length / delay) for bar, delay in zip(bars, near, strict=True))


def describe_changes(before: Sequence[Bar], after: Sequence[Bar]) -> str:
    """By how much each speed is changed, for people: of many different ones the least and the greatest."""
    rods: dict[str, list[int]] = {}
    for number, (old, new) in enumerate(zip(before, after, strict=True), 1):
        change = new.speed / old.speed - 1
        rods.setdefault(f"{'-' if change < 0 else '+'}{percent(abs(change))}" if change else "0 %", []).append(number)
    if len(rods) == 1:
        return f"all by {next(iter(rods))}"
    if len(rods) > _MOST_NAMED or len(before) > _MOST_NAMED**2:
        changes = [new.speed / old.speed - 1 for old, new in zip(before, after, strict=True)]
        low, high = (f"{'-' if change < 0 else '+'}{percent(abs(change))}" for change in (min(changes), max(changes)))
        return f"each by {low} to {high}"
    return ", ".join(
        f"rod{'s' * (len(of) > 1)} {' and '.join(map(str, of))} by {change}" for change, of in rods.items()
    )


def speed_change(before: Sequence[Bar], after: Sequence[Bar]) -> fmpq:
    """The largest change of a speed, in parts of it."""
    return max((abs(new.speed / old.speed - 1) for old, new in zip(before, after, strict=True)), default=fmpq(0))


def percent(ratio: fmpq) -> str:
    """A small ratio in percent, rounded up to two digits."""
    number = _DIGITS.create_decimal(Decimal(nearest(100 * ratio))).normalize()
    return f"{number:f} %"


def _nearest(delays: Sequence[fmpq], most: fmpq) -> tuple[fmpq, list[fmpq]]:
    """The fewest windows for which speeds change by 0.5 % or less (by `most`, if that is less).

    Where so few as are cheap do not get there, it is the least change of these, if `most` allows it; else the fewest
    for which `most` does, else the least change of all. The first number is a change that is enough, with what is
    spared for a window that is a simple fraction: after as many of them as its denominator instants are whole numbers
    again.
    """
    little = min(most, _LITTLE)
    best: tuple[fmpq, list[int], fmpq, fmpq] | None = None
    for parts in range(1, FINEST + 1):
        counts = [math.floor(fraction(delay * parts / min(delays)) + Fraction(1, 2)) for delay in delays]
        least, largest = min(rates := [delay / count for count, delay in zip(counts, delays, strict=True)]), max(rates)
        needed = (largest - least) / (largest + least) / _KEPT
        if best is None or needed < best[0]:
            best = needed, counts, least, largest
        if best[0] <= (little if parts < _CHEAP else most):
            break
    assert best is not None  # there is a window
    needed, counts, least, largest = best
    allowed = max(little, needed)
    step = rational(_simplest(fraction(largest / (1 + allowed)), fraction(least / (1 - allowed))))
    return needed, [count * step for count in counts]


def _simplest(low: Fraction, high: Fraction) -> Fraction:
    """The fraction of the smallest denominator from `low` to `high`, both positive."""
    whole = math.ceil(low)
    if whole <= high:
        return Fraction(whole)
    floor = whole - 1
    return floor + 1 / _simplest(1 / (high - floor), 1 / (low - floor))
