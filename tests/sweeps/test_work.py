"""What a case gives is the same to the last bit, whoever computes it and whichever cases beside it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `sweep` is not installed")

from tests.sweeps.test_shared import DRIVE, planned, records, shaken
from wavesym.sweeps import batches as module
from wavesym.sweeps import work
from wavesym.sweeps.batches import batches
from wavesym.sweeps.kinds import kind
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.work import compute

Cases = dict[tuple[int, ...], tuple[Any, ...]]


def cases(made: SweepPlan, parts: int | None = None) -> Cases:
    """All that is kept of each case, to the bit, and why it failed; with so many of a batch at a time."""
    of = batches(made, *kind(made))
    found: Cases = {}
    for batch in range(len(of)):
        places = of.places(batch)
        size = parts or len(places)
        for first in range(0, len(places), size):
            values = compute(made, of, batch, places[first : first + size] if parts else None)
            for row, place in enumerate(values.places):
                bits = {name: array[row].tobytes() for name, array in values.arrays.items()}
                found[place] = bits, values.failed.get(place)
    return found


def smooth(folder: Path, count: int) -> None:
    """Records that modes serve, of several sizes and roughnesses."""
    draw, t = np.random.default_rng(5), np.arange(40)
    for k in range(count):
        wave = np.sin(draw.uniform(0.05, 1.5) * t) * t * np.exp(-t / draw.uniform(4, 20))
        (folder / f"r{k:03}.csv").write_text("a\n" + "".join(f"{value:.5f}\n" for value in wave))


def test_records_give_what_they_give_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_GROUP", 4)
    smooth(tmp_path, 11)
    scene = shaken("1", damping="1/20") | {"output": {"until": 45, "tolerance": "1e-4", "drift": [1], "force": [0]}}
    made = planned({"scene": scene, "records": str(tmp_path / "*.csv")})
    assert kind(made)[0] == "recorded"
    whole = cases(made)
    assert len({bits["max"] for bits, _ in whole.values()}) == 11
    assert cases(made, 1) == cases(made, 3) == whole
    monkeypatch.setattr(module, "_RECORDS", 8)  # in a batch
    assert len(batches(made, *kind(made))) == 2
    assert cases(made) == whole


SETS = {
    "scene": {**DRIVE, "output": {**DRIVE["output"], "until": 5}},
    "vary": {"system.kappa[1]": {"from": "1/10", "to": 9, "count": 150}},
}


def test_cases_that_cannot_be_computed_together_are_computed_alone_and_that_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def mistaken(*_: object) -> None:
        raise TypeError("a mistake")

    made = planned(SETS | {"vary": {"system.kappa[1]": ["1/2", 1]}})
    monkeypatch.setattr(work, "parameters", mistaken)
    monkeypatch.setattr(work, "structure_cases", mistaken)
    of = replace(batches(made, *kind(made)), kind="parameters")
    with pytest.warns(RuntimeWarning, match="one by one, as together they fail: TypeError: a mistake"):
        values = compute(made, of, 0)
    assert not values.failed
    assert np.all(np.isfinite(values.arrays["max"]))


@pytest.mark.slow
@pytest.mark.parametrize("compiler", [True, False])
def test_sets_of_parameters_give_what_they_give_alone(monkeypatch: pytest.MonkeyPatch, compiler: bool) -> None:
    """In C, whose lanes share degrees, and in NumPy; also those that no program serves."""
    if not compiler:
        from wavesym.running import sets
        from wavesym.running.toolchain import CompilerError

        def none() -> None:
            raise CompilerError("none")

        monkeypatch.setattr(sets, "compiler", none)
    made = planned(SETS)
    assert kind(made)[0] == "parameters"
    whole = cases(made)
    assert cases(made, 37) == whole
    some = {place: compute(made, batches(made, *kind(made)), 1, [place]) for place in [(64,), (101,), (127,)]}
    for place, values in some.items():
        assert {name: array[0].tobytes() for name, array in values.arrays.items()} == whole[place][0]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_rough_and_jumping_records_give_what_they_give_alone(tmp_path: Path, seed: int) -> None:
    """Those that modes do not serve are computed alone in any case."""
    records(tmp_path, np.random.default_rng(seed))
    made = planned({"scene": shaken("1/2", damping="1/20"), "records": str(tmp_path / "*.csv")})
    whole = cases(made)
    assert cases(made, 1) == cases(made, 2) == whole
