"""Streams run beside the exact values of the same scene: loads straight on stretches, told step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import wavesym
from wavesym import api
from wavesym.numbers.doubles import nearest, rational
from wavesym.programs.program import Program
from wavesym.programs.request import Request
from wavesym.running.compilation import CompiledStream, compile_files
from wavesym.targets.files import sources


class StreamModel:
    """The compiled stream of a program; `start` gives as many of it as are wanted."""

    def __init__(self, program: Program, flags: Sequence[str] = ("-O1",)) -> None:
        real = np.float64 if program.real.bytes == 8 else np.float32
        with compile_files(sources(program, "c"), len(program.outputs), real, ("-std=c99", *flags)) as built:
            self.built = built  # once loaded it stays, though the files go
        self.outputs = tuple(output.name for output in program.outputs)
        self.loads = program.sources
        self.fields = program.laws.fields if program.laws else ()
        self.panel = program.constants["panel"]

    def start(self, **given: ArrayLike) -> Stream:
        """A stream at tau = 0, its loads 0, with the parameters `given` by field and those of the scene for others."""
        rows = [np.ravel(given.get(field.name, [*map(nearest, field.values)])) for field in self.fields]
        return Stream(self.built.stream(np.concatenate(rows) if rows else None))


class Stream:
    """A stream: the status of each step, beside its outputs."""

    def __init__(self, compiled: CompiledStream) -> None:
        self.compiled, self.state, self.refused = compiled, compiled.state, compiled.refused

    def step(self, dtau: float, loads: ArrayLike) -> tuple[int, NDArray[np.float64]]:
        """The status, and all outputs, after dtau."""
        self.compiled.status = 0
        out = self.compiled.step(dtau, loads)
        return self.compiled.status, out

    @property
    def lost(self) -> float:
        """What it says that polynomials have lost."""
        return self.compiled.lost

    def copy(self) -> Stream:
        """Another one that goes on from here."""
        return Stream(CompiledStream(self.compiled.program, self.state.copy()))


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
