"""The change of wave speeds with which the steps of a stream are whole panels, where a scene lets speeds change.

What travel times and steps have in common may be shorter than any panel should be: loads would then change at ever new
places inside of panels. A scene's `speed_adjustment` says how much of its speed that of a rod may change; travel times
and steps have few panels in common then, and every step costs the same.
"""

from __future__ import annotations

from dataclasses import replace
from math import gcd

from flint import fmpq

from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Bar
from wavesym.mechanics.parameters import SystemParameters
from wavesym.mechanics.travel_times import FINEST as MOST_WINDOWS
from wavesym.mechanics.travel_times import describe_changes
from wavesym.numbers.doubles import common_measure
from wavesym.programs.stream.plan import FINEST, LONGEST, SHORTEST, panels_in_common

_HALF = fmpq(1, 2)
_TRIED = tuple(fmpq(ratio, 200) for ratio in (1, 2, 4, 10, 20, 40))  # 0.5 % to 20 %, all there is
_FEW = 8  # panels of a step, however short
_KEY = "system.speed_adjustment:"  # how notes on it begin


def fit_speeds(model: Model, spacing: fmpq | None) -> Model:
    """The model whose steps are whole panels, few enough, or the same where no speed may change for that.

    Args:
        model: what is streamed.
        spacing: the time between two calls in tau, None where it may be any.

    Returns:
        The model; its labels and notes say how much each speed is changed.
    """
    if spacing is None or not model.speed_adjustment:
        return model
    bars = _fit_bars(model, spacing, model.speed_adjustment)
    return model if bars is None else _with_bars(model, bars, spacing)


def enough_adjustment(model: Model, spacing: fmpq) -> fmpq | None:
    """The least `speed_adjustment` that people write with which steps are few whole panels; None where none is."""
    if model.speed_adjustment is None:
        return None
    return next((ratio for ratio in _TRIED if _fit_bars(model, spacing, ratio) is not None), None)


def _fit_bars(model: Model, spacing: fmpq, most: fmpq) -> tuple[Bar, ...] | None:
    """The rods whose speeds change by so much at most, with fewer panels; None where those are few, or stay as many."""
    before = _panels_of_step(model.network.bars, spacing)
    if before is not None and (before <= _FEW or before * SHORTEST <= spacing):
        return None
    bars = _nearest(model.network_as_written.bars, spacing, most)
    if bars is None:
        return None
    after = _panels_of_step(bars, spacing)
    return bars if after is not None and (before is None or after < before) else None


def _nearest(bars: tuple[Bar, ...], spacing: fmpq, most: fmpq) -> tuple[Bar, ...] | None:
    """The rods with travel times of whole panels, of which a step is the fewest; of those that cost no more than the
    longest panels do, it is those with the least changes.
    """
    if not bars:
        return None
    delays = [bar.delay for bar in bars]
    cheap = (spacing / LONGEST).ceil()
    best: tuple[fmpq, list[fmpq]] | None = None
    for count in range(1, int((spacing / min(FINEST, min(delays) / 8)).floor()) + 1):
        if best is not None and count > cheap:
            break
        panel = spacing / count
        panels = [(delay / panel + _HALF).floor() for delay in delays]
        if not all(panels) or min(panels) > MOST_WINDOWS * gcd(*map(int, panels)):
            continue
        near = [panel * each for each in panels]
        change = max(abs(delay / new - 1) for delay, new in zip(delays, near, strict=True))
        if change <= most and (best is None or change < best[0]):
            best = change, near
    return best and tuple(replace(bar, speed=bar.length / delay) for bar, delay in zip(bars, best[1], strict=True))


def _panels_of_step(bars: tuple[Bar, ...], spacing: fmpq) -> fmpq | None:
    """How many panels a step is, of those that it has in common with travel times; None where they are too short."""
    if not bars:
        return None
    window = common_measure([bar.delay for bar in bars])
    count = panels_in_common(window, spacing)
    return None if count is None else spacing / window * count


def _with_bars(model: Model, bars: tuple[Bar, ...], spacing: fmpq) -> Model:
    """The model with other rods, which says so."""
    written = model.network_as_written
    changes = describe_changes(written.bars, bars)
    length = f"{spacing} tau" if model.clock is None else model.clock.format(spacing)
    note = (
        f"{_KEY} speeds of waves in rods are changed, {changes}, so that a step of {length} and all travel times are "
        "whole panels; impedances are as written"
    )
    labels = replace(
        model.labels,
        system={**model.labels.system, "speeds_changed_by": changes},
        structure_notes=(*(each for each in model.labels.structure_notes if not each.startswith(_KEY)), note),
    )
    preset = model.preset
    if isinstance(preset, SystemParameters):
        preset = replace(preset, speeds=tuple(bar.speed for bar in bars))
    return replace(
        model,
        network=replace(written, bars=bars),
        written_speeds=tuple(bar.speed for bar in written.bars),
        labels=labels,
        preset=preset,
    )
