"""Streams under the loads of a scene, as its user would feed them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
from flint import fmpq

from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import fraction, nearest
from wavesym.programs.program import Program
from wavesym.programs.request import SIMULATORS
from wavesym.running.co_simulation import CoSimulation, compile_fmu
from wavesym.running.compilation import CompiledLibrary, CompiledStream
from wavesym.scene import Scene
from wavesym.verification.independent import changes
from wavesym.verification.outcome import ProgramValues
from wavesym.verification.reference import ReferenceOutputs, sample_evenly

_CLEAR = 1e-6  # outputs are looked at so far from fronts and from changes of loads, and no closer together
_MOST_LOOKED = 300
_CLOSE = 1e-9  # instants of samples that are the same
_MIXED = "loads jump after tau = 0 and go in straight lines, and an FMU either holds them over a step or does not"


def run_streams(
    scene: Scene, known: ReferenceOutputs, program: Program, built: CompiledLibrary, started: ProgramValues
) -> Iterator[ProgramValues]:
    """The stream in C, and as the FMUs that simulators take, where its numbers are doubles.

    Streams of waves step to some of the taus of `started`, which has no values yet, those of modes to multiples of
    their spacing.
    """
    feed = LoadFeed(scene, known.whole, program.sources)
    own = [nearest(value) for field in program.laws.fields for value in field.values] if program.laws else None

    def step(language: str, stream: CompiledStream | CoSimulation) -> ProgramValues:
        lost, found = 0.0, replace(started, name=f"{started.name}, {language}")
        if program.has_equal_steps:
            taus, values = _step_modes(known, program, feed, stream)
            found = replace(found, close=_CLOSE)
        else:
            taus, values = _step_waves(known, feed, stream, started.taus)
            lost = stream.lost
            found = replace(found, bounds=[lost] * len(found.bounds))
        wrong = f"{known.whole.name}: {found.name}: a step returns {stream.status}, lost is {lost:.1e}"
        return replace(found, taus=taus, values=values, note=wrong if stream.status else found.note)

    yield step("C", built.stream(own))
    for version in SIMULATORS if program.real.bytes == 8 else ():
        language = f"FMI {version[-1]}"
        if feed.jumps and feed.slopes:
            yield replace(started, name=f"{started.name}, {language}", refusal=_MIXED)
            continue
        with compile_fmu(program, version, linear=feed.slopes) as simulation:
            yield step(language, simulation)


def _step_waves(
    known: ReferenceOutputs, feed: LoadFeed, stream: CompiledStream | CoSimulation, taus: Array
) -> tuple[Array, Array]:
    """A stream of waves: some of the taus, and the outputs there.

    It steps to every change of a load; one that jumps does so in a step of its own.
    """
    fronts = np.array([*known.starts, *map(float, feed.times)])
    apart = np.array([tau for tau in taus if np.min(np.abs(fronts - tau), initial=np.inf) > _CLEAR])
    chosen = sample_evenly(apart[np.diff(apart, prepend=0.0) > _CLEAR], _MOST_LOOKED)
    stops = [Fraction(tau) for tau in chosen.tolist()]
    looked, columns, before = set(stops), [], 0.0
    for tau, loads, jumps in feed.loads_at_stops(stops, everywhere=True):
        column = stream.step(0.0 if jumps else float(tau) - before, loads)
        before = float(tau)
        if tau in looked:
            columns.append(column)
    return chosen, np.array(columns).T


def _step_modes(
    known: ReferenceOutputs, program: Program, feed: LoadFeed, stream: CompiledStream | CoSimulation
) -> tuple[Array, Array]:
    """A stream of modes: some multiples of its spacing after the first change of a load, and the outputs there."""
    step = Fraction(program.constants["spacing"])
    if (spacing := known.whole.spacing) and abs(fraction(spacing) / step - 1) < _CLEAR:
        step = fraction(spacing)  # as it is, and not as a double has it
    first = feed.times[0] % step if feed.times else Fraction(0)
    stops = [first + k * step for k in range(1, int((fraction(known.model.until) - first) / step) + 1)]
    columns = [stream.step(program.constants["spacing"], loads) for _, loads, _ in feed.loads_at_stops(stops)]
    some = sample_evenly(np.arange(len(stops)), _MOST_LOOKED)
    return np.array([float(stop) for stop in stops])[some], np.array(columns).T[:, some]


class LoadFeed:
    """The loads of a scene as a stream takes them, in the units that stand with their names.

    `times` are those at which one changes, `jumps` is whether one jumps after tau = 0, and
    `slopes` whether one goes in a line that is not level.
    """

    def __init__(self, scene: Scene, model: Model, names: Sequence[str]) -> None:
        bare = [name.partition(" [")[0] for name in names]
        self._rows = len(names)
        self._changes: dict[Fraction, list[tuple[int, Fraction, Fraction]]] = {}
        for load in scene.load:
            called = [source.removesuffix(kind) for source, kind in zip(load.sources, (":step", ":ramp"), strict=True)]
            row = next(bare.index(name) for name in called if name in bare)
            size, _ = next((model.inputs[source] for source in load.sources if source in model.inputs), (fmpq(1), ""))
            for time, jump, slope in changes(load):
                if jump or slope:
                    self._changes.setdefault(time, []).append((row, fraction(size) * jump, fraction(size) * slope))
        self.times = sorted(self._changes)
        self.jumps = any(jump for time, here in self._changes.items() if time for _, jump, _ in here)
        self.slopes = any(slope for here in self._changes.values() for _, _, slope in here)

    def loads_at_stops(
        self, stops: Sequence[Fraction], *, everywhere: bool = False
    ) -> Iterator[tuple[Fraction, list[float], bool]]:
        """The loads at each stop, or wherever they change, too; after that as they are once they have jumped there."""
        now, loads, slopes = Fraction(0), [Fraction(0)] * self._rows, [Fraction(0)] * self._rows
        required = set(stops)
        for then in sorted({*(time for time in self.times if stops and time <= stops[-1]), *stops}):
            loads, now = [load + (then - now) * slope for load, slope in zip(loads, slopes, strict=True)], then
            if then in required or (everywhere and then > 0):
                yield then, [float(load) for load in loads], False
            here = self._changes.get(then, ())
            for row, jump, slope in here:
                loads[row], slopes[row] = loads[row] + jump, slopes[row] + slope
            if everywhere and any(jump for _, jump, _ in here):
                yield then, [float(load) for load in loads], True
