"""What of a scene may surprise whoever wrote it: how it was read, and what damps it in time; a line for each."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from flint import fmpq

from wavesym.fields.loads import Load
from wavesym.fields.numbers import decimal_text
from wavesym.fields.shapes import ShapedLoad
from wavesym.mechanics.damping import Damping
from wavesym.mechanics.network import Network
from wavesym.mechanics.travel_times import percent, speed_change
from wavesym.numbers.doubles import fraction, nearest, rational
from wavesym.records.load import RecordedLoad
from wavesym.scene.scene import Scene
from wavesym.systems import ExplicitChain

_MOST_NAMED = 5  # rods
_USUAL_DAMPING = fmpq(1, 5)  # of critical; above it a ratio is more often a slip than meant


def structure_notes(scene: Scene, damping: Damping | None) -> tuple[str, ...]:
    """How a structure was read, where that may surprise, whatever acts on it and for how long.

    Args:
        scene: what the user wrote.
        damping: that of its modes, where it is any.
    """
    return (*_damping_notes(damping), *_speed_notes(scene))


def time_notes(scene: Scene) -> tuple[str, ...]:
    """How loads and the horizon of a scene were read, where that may surprise: of no interest for its frequencies."""
    return (*_horizon_notes(scene), *_record_notes(scene), *_shape_notes(scene))


def _horizon_notes(scene: Scene) -> Iterator[str]:
    """A line where a scene with units says a horizon of tau: whoever writes a number may have meant seconds."""
    until = scene.physical.fields_in_units.get("output", {}).get("until") if scene.physical else None
    if until is not None and scene.scale and re.fullmatch(r"[\d./eE+-]+", written := str(until).strip()):
        horizon = scene.scale.clock.format(rational(scene.output.until))
        yield f'output.until: {written} is taken as tau, {horizon}; write "{written} s" if seconds are meant'


def _damping_notes(damping: Damping | None) -> Iterator[str]:
    """A line where a mode has more damping than structures have."""
    if damping and (largest := max(damping.ratios)) > _USUAL_DAMPING:
        yield f"system.damping: {nearest(100 * largest):g} % of critical; structures have some percent"


def changed_speeds(scene: Scene) -> str:
    """By how much waves in rods are faster or slower than was written, at most; empty where they are not."""
    if not isinstance(system := scene.system, ExplicitChain) or not system.speed_adjustment:
        return ""
    change = speed_change(system.drawing_as_written.bars, system.drawing.bars)
    return f"{percent(change)} or less" if change else ""


def written_speeds(scene: Scene) -> tuple[fmpq, ...]:
    """The speeds of waves as they were written, where they are changed; else none."""
    if not isinstance(system := scene.system, ExplicitChain) or not changed_speeds(scene):
        return ()
    return tuple(bar.speed for bar in system.drawing_as_written.bars)


def _speed_notes(scene: Scene) -> Iterator[str]:
    """A line where speeds are not those that were written."""
    if change := changed_speeds(scene):
        yield (
            f"system.speed_adjustment: speeds of waves are changed by {change}, so that travel times have a common "
            "measure; impedances are as written"
        )


def _record_notes(scene: Scene) -> Iterator[str]:
    """A line for each record that begins later, so that it does not jump."""
    for k, load in enumerate(scene.load):
        if isinstance(load, RecordedLoad) and load.is_delayed:
            later = spacing_text(scene, load)
            instead = (
                f'write start = "{later}", which says the same, or a later one'
                if load.record.start is None
                else "put samples of 0 before it in the file for another start"
            )
            yield (
                f"load[{k}].record: the first sample is not 0, and modes take no jump: the load rises to it from 0 in "
                f"a straight line over one spacing, so that the record begins {later} later; {instead} (without "
                "damping it jumps)"
            )


_USUAL = "; none is written, so output.tolerance is {:g}, which few samples meet: a smaller one takes more and longer"


def _shape_notes(scene: Scene) -> Iterator[str]:
    """A line for each load that has a shape: as what it acts."""
    for k, load in enumerate(scene.load):
        if isinstance(load, ShapedLoad):
            usual = "" if scene.tolerance == scene.output.tolerance else _USUAL.format(float(scene.tolerance))
            yield f"load[{k}]: {load.shape} {load.sampling}, one every {spacing_text(scene, load)}{usual}"


def damping_in_time(scene: Scene, network: Network) -> str:
    """What to write in place of losses for motions in time: damping, or beside dashpots a dashpot in each rod.

    A rod of stiffness k = Z/T with a dashpot c between its ends loses as one with the loss c w/k at the frequency w,
    the first of a column that is held at one end: a quarter of a turn while a wave goes through.
    """
    losses = [bar for bar in network.bars if bar.loss != 0]
    if network.takes_modal_damping:
        ratio = decimal_text(fraction(max(bar.loss for bar in losses)) / 2)
        return f"for these write damping = {ratio} under [system] in its place"
    turn = math.pi / 2 / nearest(sum((bar.delay for bar in network.bars), fmpq(0)))
    size, unit = scene.scale.parts["dashpot"] if scene.scale else (1, "")
    rods: list[str] = []
    for number, bar in enumerate(network.bars, 1):
        if bar.loss != 0 and len(rods) < _MOST_NAMED:
            dashpot = float(f"{nearest(bar.loss * bar.impedance / bar.delay) / turn * float(size):.3g}")
            written = f'"{dashpot:.15g} {unit}"' if unit else f"{dashpot:.15g}"
            rods.append(f"dashpot = {written} in {bar.name or f'rod {number}'}")
    others = ", ..." if len(losses) > len(rods) else ""
    when = f"{turn / math.tau / float(scene.scale.seconds):.3g} Hz" if scene.scale else f"{turn:.3g} rad per tau"
    return (
        f"for these write in its place {', '.join(rods)}{others} (they lose as much at {when}, more above; in thin "
        "rods), or multiply the spectrum of a record by `frf`, as in docs/tutorials/soil.md"
    )


def spacing_text(scene: Scene, load: Load) -> str:
    """How far the samples of a load are apart, with its unit."""
    assert load.step is not None  # as it has samples
    return scene.scale.clock.format(rational(load.step)) if scene.scale else str(load.step)
