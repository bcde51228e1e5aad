"""Links with corners: events and time of each example, cost as slips grow, explicit steps for the same answers, C.

The explicit steps are central differences with return mapping, in NumPy, as `verify` takes them: they are halved until
the worst output is within an error of its largest value, at instants away from fronts. Where that takes too many steps,
their number is what errors that fall with the order seen from the first of them to the last would need.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from time import process_time

import numpy as np

import wavesym
from tools.bench.harness import CALLS, SAMPLES, many
from wavesym.exact.contacts.events import events
from wavesym.exact.contacts.schedule import outcome
from wavesym.exact.reference import Reference
from wavesym.lab.timing import least
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.programs.making import make
from wavesym.running.native import FAST
from wavesym.scene import Scene, lower
from wavesym.targets.files import files
from wavesym.verification.independent import independent_model
from wavesym.verification.integrations import Start, coarsest_start
from wavesym.verification.midpoint import MidpointGrid
from wavesym.verification.reference import known_outputs
from wavesym.verification.return_mapping import REACH, ReturnMapping

HEAD = ("example", "events", "s to find them", "s of `run`", "bytes of C", "C, ns a double", "bound")
GROWTH_HEAD = ("slips", "events", "s to find them", "ms an event")
STEPS_HEAD = ("example", "within", "steps", "s", "order", "events by wavesym, s")
TARGETS, SLIPS = (1e-3, 1e-6), (10, 100, 1000)
_MOST = 1e9  # points that all steps of one grid move


def rows(folder: Path) -> Iterator[Sequence[str]]:
    """Events of each example in a folder and the time that they take, that of a run, and its C."""
    for each in _examples(folder):
        found, seconds = _find_events(lower(each))
        begin = process_time()
        wavesym.run(each)
        ran = process_time() - begin
        program = make(lower(each))
        made = files(program)
        double = least([many(each, made, FAST)])[0] / (CALLS * SAMPLES * len(each.outputs))
        size = sum(len(made[f"{each.name}.{kind}"].encode()) for kind in "ch")
        bound = max(output.bound for output in program.outputs)
        yield each.name, f"{found}", f"{seconds:.2f}", f"{ran:.2f}", f"{size}", f"{1e9 * double:.2f}", f"{bound:.1e}"


def growth_rows() -> Iterator[Sequence[str]]:
    """A block that slips once each time that its load turns."""
    for slips in SLIPS:
        found, seconds = _find_events(lower(block(slips)))
        yield f"{slips}", f"{found}", f"{seconds:.2f}", f"{1e3 * seconds / found:.1f}"


def block(slips: int) -> Scene:
    """A damped block on a spring, held by friction; its load of 3 turns so often, and each time it slips and sticks."""
    held = {"mass": 1, "velocity": 0, "friction": 1, "dashpot": "9/10", "name": "block"}
    steps = [3, *(6 * (-1) ** k for k in range(1, slips))]
    load = {"at": "block", "times": [5 * k for k in range(slips)], "steps": steps}
    output = {"until": 5 * slips, "tolerance": 1e-9, "displacement": ["block"]}
    parts = ["fixed", {"spring": 1}, held]
    return Scene(name="block", system={"type": "chain", "parts": parts}, load=[load], output=output)


def steps_rows(folder: Path) -> Iterator[Sequence[str]]:
    """What explicit steps need for the outputs of each example that has rods."""
    for each in _examples(folder):
        model = lower(each)
        known = known_outputs(model, independent_model(each, model))
        start = coarsest_start(known, REACH)
        if isinstance(start, str) or not start.grid.problem.delays:
            continue
        taken = list(_refine(start, model, np.array([output.scale for output in known.outputs])))
        _, seconds = _find_events(model)
        for target in TARGETS:
            yield each.name, f"{target:.0e}", *_reckon(taken, target), f"{seconds:.2f}"


def _refine(start: Start, model: Model, sizes: Array) -> Iterator[tuple[int, float, float]]:
    """Steps, seconds and the error of ever finer grids, until it is small enough or there are too many."""
    grid, problem, finer = start.grid, start.grid.problem, 1
    instants = np.unique(np.concatenate(start.instants))
    off_fronts = np.array([np.isin(instants, own) for own in start.instants])
    taus = np.array([grid.tau(k) for k in instants.tolist()])
    true = np.array(Reference(model).values(taus.tolist()))
    error = math.inf
    while error > min(TARGETS) and _points_moved(fine := grid.finer(finer), start.until) <= _MOST:
        begin = process_time()
        readings, _ = fine.integrate(finer * instants, ReturnMapping)
        seconds = process_time() - begin
        off = off_fronts * np.abs(np.array(problem.outputs(readings, taus)) - true)
        error = float(np.max(np.max(off, axis=1) / sizes))
        yield int(start.until / float(fine.step)), seconds, error
        finer *= 2


def _points_moved(grid: MidpointGrid, until: float) -> float:
    """How many points of bars all steps move."""
    return until / float(grid.step) * float(sum(grid.problem.delays) / grid.step)


def _reckon(taken: Sequence[tuple[int, float, float]], target: float) -> tuple[str, str, str]:
    """Steps and seconds within a target, and the order that is seen; reckoned where no grid is fine enough."""
    (first, _, coarse), (last, _, fine) = taken[0], taken[-1]
    order = math.log(coarse / fine) / math.log(last / first)
    for steps, seconds, error in taken:
        if error <= target:
            return f"{steps}", f"{seconds:.3f}", f"{order:.1f}"
    more = (taken[-1][2] / target) ** (1 / order)  # each step moves so many more points
    return f"{last * more:.1e} (reckoned)", f"{taken[-1][1] * more * more:.1e} (reckoned)", f"{order:.1f}"


def _examples(folder: Path) -> list[Scene]:
    return [Scene.from_toml(path) for path in sorted(folder.glob("*.toml"))]


def _find_events(model: Model) -> tuple[int, float]:
    """How many there are, and the seconds that it takes to find them all."""
    outcome.cache_clear()
    begin = process_time()
    return len(events(model)), process_time() - begin
