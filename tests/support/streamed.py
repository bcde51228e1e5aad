"""Streams run beside the exact values of the same scene: loads straight on stretches, told step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesym
from wavesym import api
from wavesym.numbers.doubles import rational
from wavesym.programs.request import Request
from wavesym.running.stream import StreamModel


@dataclass(frozen=True)
class Ran:
    """What came of a stream: at `tau` its outputs (outputs, times), the status of each step and `lost` after it."""

    tau: list[float]
    found: NDArray[np.float64]
    status: list[int]
    lost: list[float]


def knots(jumps: Sequence[Sequence[Fraction]], spacing: Fraction) -> list[dict[str, Any]]:
    """Load tables (without where they act): load j is straight from k spacing to (k + 1) spacing; at k spacing it jumps
    by jumps[j][k] and takes a slope that differs by as much."""
    return [
        {"times": [k * spacing for k in range(len(row))], "steps": list(row), "ramps": [-2 * jump for jump in row]}
        for row in jumps
    ]


def run(
    model: StreamModel,
    jumps: Sequence[Sequence[Fraction]],
    spacing: Fraction,
    until: Fraction,
    step: Fraction,
    **parameters: Any,
) -> Ran:
    """The stream under such loads, in steps of about `step` that end where loads jump."""
    stream = model.start(**parameters)
    now = [Fraction(0)] * len(jumps)
    slope = [Fraction(0)] * len(jumps)
    at, told, tau = Fraction(0), 0.0, []
    columns, status, lost = [], [], []
    for k in range(int(until / spacing)):
        for j, row in enumerate(jumps):
            if k < len(row):
                now[j], slope[j] = now[j] + row[k], slope[j] - 2 * row[k]
        status.append(stream.step(0.0, [float(load) for load in now])[0])
        while at < (k + 1) * spacing:
            then = min(at + step, (k + 1) * spacing)
            now = [load + (then - at) * rise for load, rise in zip(now, slope, strict=True)]
            # the step that a clock of doubles makes
            code, out = stream.step(float(then) - told, [float(load) for load in now])
            at, told = then, float(then)
            if then < (k + 1) * spacing:  # off the jumps
                tau.append(told)
                columns.append(out)
            status.append(code)
            lost.append(stream.lost)
    return Ran(tau, np.array(columns).T, status, lost)


def missed(ran: Ran, scene: wavesym.Scene) -> NDArray[np.float64]:
    """The largest error of each output relative to its largest value."""
    true = wavesym.evaluator(scene)(ran.tau)
    largest = np.max(np.abs(true), axis=1)
    return np.max(np.abs(ran.found - true), axis=1) / np.where(largest > 0, largest, 1)


def built(
    scene: wavesym.Scene,
    precision: str = "double",
    step: Fraction | None = None,
    runtime: Sequence[str] = (),
    room: int | None = None,
) -> StreamModel:
    """The compiled stream of a scene, with `room` for so many breakpoints, or as many as it has by itself; not as fast
    as it can be, which takes long to compile.
    """
    every = None if step is None else rational(step)
    request = Request(precision=precision, stream=True, step=every, runtime=tuple(runtime))
    defined = () if room is None else (f"-D{scene.name.upper()}_BREAKPOINTS={room}",)
    return StreamModel(api.program(scene, request), ("-O1", *defined))
