"""Peaks of many sets of parameters beside programs that are written by hand for the scene, at equal error.

Those get a grid as coarse as the tolerance lets them have, and parameters as they need them; compiling is apart.
Errors are those of the worst output of the worst set, of its largest value, against a program of a tolerance far below,
whose extremes are the true ones where these are known, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import partial

import numpy as np

from tools.bench.by_hand import Line, SampleGrid, line, peaks_in_c, peaks_in_numpy
from wavesym.lab.timing import medians
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.runtime.making import sets_program
from wavesym.running.model import RuntimeModel, compiled_model
from wavesym.scene import Scene, lower

SETS, MANY = 200, 100_000
FIRST, LAST = Fraction(1, 20), Fraction(1, 2)
"""Of the second kappa, which is varied."""
_STEPS = (64, 96, 128, 192, 256, 384, 512, 768, 1024)  # of programs by hand, in a unit of tau
_FAR_BELOW = "1e-12"
_GROUP = 25  # sets that NumPy takes at once: waves of more of them do not fit into any cache
Peaks = Callable[[], Array]


def varied_scenes(scene: Scene, sets: int) -> list[Scene]:
    """The scenes of a sweep."""
    values = (FIRST + (LAST - FIRST) * Fraction(k, sets - 1) for k in range(sets))
    return [scene.with_({"system.kappa[1]": str(value)}) for value in values]


def kappa_of(scene: Scene) -> list[float]:
    """As a program takes them."""
    return [nearest(one.value) for one in lower(scene).parameters.numbers["kappa"]]


def rows(scene: Scene) -> Iterator[Sequence[str]]:
    """How many sets, way, seconds, sets a second, error."""
    scenes = varied_scenes(scene, SETS)
    model, kappa = _model(scene), np.array([kappa_of(one) for one in scenes])
    true = best_known(scene, kappa)
    repeated = np.tile(kappa, (MANY // SETS, 1))
    problems = [line(lower(one)) for one in scenes]
    tolerance = nearest(lower(scene).tolerance)
    ways: dict[str, Peaks] = {"wavesym, C": partial(_ours, model, kappa)}
    for name, way in (("by hand, C", _in_c), ("by hand, NumPy, all at once", _in_numpy)):
        steps, call = _as_good(way, problems, true, tolerance)
        ways[f"{name}, {steps} steps a unit"] = call
    building = partial(model.check, kappa=kappa)
    *seconds, built = medians([*ways.values(), building], rounds=5, patience=5.0)
    for (name, call), each in zip(ways.items(), seconds, strict=True):
        yield f"{SETS}", name, f"{each:.4f}", f"{SETS / each:.0f}", f"{_worst(call(), true):.1e}"
    yield f"{SETS}", "wavesym, coefficients and estimates alone", f"{built:.4f}", f"{SETS / built:.0f}", ""
    (ours,) = medians([partial(_ours, model, repeated)], rounds=1)
    yield f"{MANY}", "wavesym, C", f"{ours:.2f}", f"{MANY / ours:.0f}", ""
    for name, each in list(zip(ways, seconds, strict=True))[1:]:
        yield f"{MANY}", f"{name} (from {SETS})", f"{each * MANY / SETS:.2f}", f"{SETS / each:.0f}", ""


def _model(scene: Scene) -> RuntimeModel:
    return compiled_model(sets_program(lower(scene), ["kappa"]))


def best_known(scene: Scene, kappa: Array) -> Array:
    """Peaks of many sets, (sets, outputs, 2)."""
    return _ours(_model(scene.with_({"output.tolerance": _FAR_BELOW})), kappa)


def _worst(found: Array, true: Array) -> float:
    return float(np.max(np.abs(found - true) / np.abs(true).max(axis=2, keepdims=True)))


def _ours(model: RuntimeModel, kappa: Array) -> Array:
    found = model.peaks(kappa=kappa)
    return np.stack([found.min, found.max], axis=2)


def _as_good(
    way: Callable[[SampleGrid, Sequence[Line]], Peaks],
    problems: Sequence[Line],
    true: Array,
    tolerance: float,
) -> tuple[int, Peaks]:
    """The fewest steps in a unit of tau with which a program by hand keeps the tolerance, or the most; and its call."""
    for steps in _STEPS:
        grid = SampleGrid(problems[0], round(steps * problems[0].until) + 1, 1)
        call = way(grid, problems)
        if _worst(call(), true) <= tolerance:
            break
    return steps, call


def _in_c(grid: SampleGrid, problems: Sequence[Line]) -> Peaks:
    return peaks_in_c(grid, problems)


def _in_numpy(grid: SampleGrid, problems: Sequence[Line]) -> Peaks:
    groups = [problems[k : k + _GROUP] for k in range(0, len(problems), _GROUP)]
    return lambda: np.concatenate([peaks_in_numpy(grid, group) for group in groups])
