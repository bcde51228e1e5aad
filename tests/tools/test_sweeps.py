"""What is measured of sweeps is sweeps that are done, and what they are compared with is right."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `sweep` is not installed")

from tools.bench import many_sets, sweeps
from tools.bench.by_hand import SampleGrid, line, peaks_in_c, peaks_in_numpy
from wavesym.results.summary import summarise
from wavesym.scene import lower

DRIVE = sweeps.drive()
pytestmark = pytest.mark.slow


def test_sweeps_are_measured_that_fail_nowhere(tmp_path: Path) -> None:
    """Nothing is asserted of the time itself."""
    sweeps.inputs(tmp_path, records=3, samples=300)
    for text in (sweeps.FRAMES.format(structures=2), sweeps.SHAFTS.format(sets=9)):
        assert all(float(each) > 0 for each in sweeps.run_sweep(tmp_path, text))


def test_what_a_batch_costs_and_what_memory_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeps, "RECORDS", 3)
    monkeypatch.setattr(sweeps, "GROWING", (2, 3))
    rows = list(sweeps.growth())
    assert [cases for cases, *_ in rows] == ["20", "30"]
    assert all(float(each) > 0 for _, *told in rows for each in told)
    assert all(float(told.split()[0]) > 0 for _, told in sweeps.overheads())


def test_programs_by_hand_find_the_peaks_that_the_exact_response_has() -> None:
    """In C and in NumPy alike; with twice the steps about eight times better, as a parabola's top is."""
    scenes = many_sets.varied_scenes(DRIVE, 4)
    true = np.array([[(o.min.value, o.max.value) for o in summarise(lower(each)).outputs] for each in scenes])
    kappa = np.array([many_sets.kappa_of(each) for each in scenes])
    assert many_sets._worst(many_sets.best_known(DRIVE, kappa), true) < 1e-11
    problems = [line(lower(each)) for each in scenes]
    errors = []
    for steps in (64, 256):
        grid = SampleGrid(problems[0], 40 * steps + 1, 1)
        found = peaks_in_c(grid, problems)()
        assert np.allclose(peaks_in_numpy(grid, problems), found, rtol=0, atol=1e-12 * np.abs(true).max())
        errors.append(many_sets._worst(found, true))
    assert errors[1] < min(errors[0] / 8, 1e-5)


def test_many_sets_have_rows_at_equal_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(many_sets, "SETS", 5)
    monkeypatch.setattr(many_sets, "MANY", 20)
    rows = list(many_sets.rows(DRIVE))
    errors = [float(error) for *_, error in rows if error]
    assert len(errors) == 3
    assert max(errors) <= 1e-6
    assert [sets for sets, *_ in rows] == ["5"] * 4 + ["20"] * 3
