"""What parameters at run time are measured beside, and the rows of the benchmark."""

from pathlib import Path

import numpy as np
import pytest

import wavesym
from tools.bench import parameters
from tools.bench.by_hand import SampleGrid, in_c, in_numpy, line
from tools.bench.harness import EVERY, compilers
from wavesym.errors import UnservedError
from wavesym.scene import lower

FOLDER = Path(__file__).parents[2] / "bench"
SCENES = parameters.scenes(FOLDER)


def errors(scene, stride):
    problem = line(lower(scene))
    grid = SampleGrid(problem, 101, stride)
    other = line(lower(scene.with_({"system.kappa": [2] * len(scene.system.kappa)})))
    found = in_c(grid, problem)(problem)()
    by_numpy = in_numpy(grid, [other, problem])
    assert np.allclose(by_numpy[1], found, rtol=0, atol=1e-12 * np.max(np.abs(found)))
    assert np.max(np.abs(by_numpy[0] - found)) > 1e-3
    true = wavesym.evaluator(scene)(np.linspace(0, problem.until, 101))
    return np.max(np.abs(found - true)) / np.max(np.abs(true))


@pytest.mark.slow
def test_what_is_written_by_hand_is_right():
    coarse, fine = (errors(SCENES["building, m = 2, to 20"], stride) for stride in (4, 16))
    assert fine < 1e-5
    assert 3.5 < np.log2(coarse / fine) / 2 < 4.5


def test_what_is_off_the_grid_is_refused():
    problem = line(lower(SCENES["building, m = 2, to 20"]))
    with pytest.raises(UnservedError, match="a strain or velocity on the grid expected"):
        SampleGrid(problem, 101, 1)
    with pytest.raises(UnservedError, match="a whole number from 4 on"):
        SampleGrid(problem, 1000, 1)


@pytest.mark.slow
def test_rows_say_time_and_error(monkeypatch):
    monkeypatch.setattr(parameters, "least", lambda calls, **_: [1.0 for call in calls if call() is not calls])
    monkeypatch.setattr(parameters, "scenes", lambda _: dict(list(SCENES.items())[:1]))
    rows = list(parameters.rows(FOLDER))
    assert all(len(row) == len(parameters.HEAD) for row in rows)
    ours = [row for row in rows if row[1] == "wavesym, C"]
    names = [compiler.name for compiler in compilers()]
    assert [row[2] for row in ours] == 2 * [name for name in names for _ in EVERY]
    for row in ours:
        error, _, bound = map(float, row[6:])
        assert error <= bound < 1e-7
    assert max(float(row[6]) for row in ours[: len(ours) // 2]) < 1e-12
    for name in names:
        theirs = [float(row[6]) for row in rows if row[1].startswith("by hand, C") and row[2] == name]
        assert theirs == sorted(theirs, reverse=True)
