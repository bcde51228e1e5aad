"""Damped structures side by side are what each is alone: within the bounds of both, whatever is varied."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `sweep` is not installed")

from wavesym.sweeps import shared_modes
from wavesym.sweeps.batches import batches
from wavesym.sweeps.kinds import kind
from wavesym.sweeps.plan import SweepPlan, plan
from wavesym.sweeps.request import SweepRequest
from wavesym.sweeps.single import single
from wavesym.sweeps.work import compute

STOREY = {"height": "3.5 m", "stiffness": "600 MN/m", "column_mass": "10 t", "floor_mass": "350 t"}
FRAME: dict[str, Any] = {
    "name": "frame",
    "units": {"length": "mm"},
    "system": {"type": "building", "base": "ground", "damping": "1/20", "storey": [{**STOREY, "count": 2}, STOREY]},
    "load": [{"spacing": "0.1 s", "samples": ["0", "1/4", "-3/10", "1/5", "-1/10", 0], "unit": "g"}],
    "output": {
        "until": "2 s",
        "tolerance": "1e-3",
        "drift": [1, 3],
        "acceleration": [3],
        "relative": [3],
        "force": [0],
        "strain": ["1-"],
        "velocity": [2],
    },
}
NUMBERS = {
    "system.storey[0].stiffness": ["500 MN/m", "600 MN/m", "711 MN/m"],
    "system.storey[1].floor_mass": ["250 t", "300 t"],
    "system.damping": ["0.02", "0.05"],
    "load[0].scale": ["0.5", "1.5"],
}
LOADS = [
    {"spacing": "0.1 s", "unit": "g", "record": {"samples": ["1/9", "1/4", "-3/10", "1/5", "-1/10", 0]}},
    {"shape": "sine", "amplitude": "0.2 g", "frequency": "2 Hz"},
]
AMPLITUDES = {"load[1].amplitude": ["0.1 g", "0.3 g"], "load[0].scale": [2, 1], "system.damping": ["0.02", "0.05"]}
COLUMNS = {
    "system.storey[0].height": ["3 m", "3.5 m", "4 m"],
    "system.storey[1].column_mass": ["9 t", "11 t", "14 t"],
}


def planned(scene: Mapping[str, Any], vary: Mapping[str, Any], **more: Any) -> SweepPlan:
    file, request = SweepRequest.read({"scene": scene, "vary": vary, **more})
    return plan(request, file)


def whole(made: SweepPlan) -> dict[tuple[int, ...], dict[str, Any]]:
    """What is kept of all cases."""
    every = batches(made, *kind(made))
    found: dict[tuple[int, ...], dict[str, Any]] = {}
    for batch in range(len(every)):
        values = compute(made, every, batch)
        assert not values.failed
        for k, place in enumerate(values.places):
            found[place] = {name: array[k] for name, array in values.arrays.items()}
    return found


def assert_as_alone(made: SweepPlan, found: Mapping[tuple[int, ...], Mapping[str, Any]], every: int) -> None:
    """Extremes and histories of some cases, one of `every`, are those of their scenes alone, within both bounds."""
    for place, case in list(found.items())[::every]:
        alone = single(made, made.scene(place)).arrays
        size = np.maximum(np.abs(alone["min"]), np.abs(alone["max"]))
        allowed = (case["bound"] + alone["bound"]) * size
        assert np.all(np.abs(case["min"] - alone["min"]) <= allowed)
        assert np.all(np.abs(case["max"] - alone["max"]) <= allowed)
        when, other = (each["tau_max"] * each["time_per_tau"] for each in (case, alone))
        assert when == pytest.approx(other, abs=0.02)
        if "history" in case:
            assert np.all(np.abs(case["history"] - alone["history"]) <= allowed[:, None])


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("load", "vary"),
    [(LOADS[:1], NUMBERS), (LOADS, AMPLITUDES), (FRAME["load"], COLUMNS)],
    ids=["numbers of modes", "multiples of loads", "anything else"],
)
def test_cases_side_by_side_are_what_they_are_alone(load: list[Any], vary: Mapping[str, Any], thorough: bool) -> None:
    made = planned({**FRAME, "load": load}, vary, keep={"histories": 21})
    assert kind(made)[0] == "structures"
    first = shared_modes._first_structure(made)
    assert first is not None
    assert (first.lanes is not None) is (vary is not COLUMNS)
    found = whole(made)
    assert len({case["max"].tobytes() for case in found.values()}) == len(found)
    assert_as_alone(made, found, 3 if thorough else 11)


@pytest.mark.slow
def test_a_case_alone_has_the_same_bits() -> None:
    made = planned(FRAME, COLUMNS)
    every, place = batches(made, *kind(made)), (1, 2)
    alone = compute(made, every, 0, [place])
    assert {name: array[0].tobytes() for name, array in alone.arrays.items()} == {
        name: np.asarray(values).tobytes() for name, values in whole(made)[place].items()
    }


@pytest.mark.slow
def test_structures_without_units_and_of_other_shapes_share_what_they_can() -> None:
    """A spring, a mass on it, and whether another mass stands on top."""
    top = [{"spring": 3}, {"mass": "1/2"}]
    parts = [
        [{"motion": "acceleration", "name": "g"}, {"spring": 4}, {"mass": m, "name": "n"}, *more]
        for m in (1, "3/2", 2, "5/2")
        for more in ([], top)
    ]
    scene = {
        "name": "stack",
        "system": {"type": "chain", "damping": "1/20", "parts": parts[0]},
        "load": [{"at": "g", "spacing": "1/2", "samples": [0, 1, -1, 0]}],
        "output": {"until": 9, "tolerance": "1e-5", "relative": ["n"], "acceleration": ["n"]},
    }
    made = planned(scene, {"system.parts": parts})
    assert kind(made)[0] == "structures"
    found = whole(made)
    for place, case in found.items():
        alone = single(made, made.scene(place)).arrays
        size = np.maximum(np.abs(alone["min"]), np.abs(alone["max"]))
        searched = 1e-8  # of tops between samples
        assert np.all(np.abs(case["max"] - alone["max"]) <= (case["bound"] + alone["bound"] + searched) * size)


def test_a_case_that_is_wrong_says_why_and_the_others_go_on() -> None:
    masses = [*(f"{k} t" for k in range(300, 308)), "-1 t"]
    made = planned(FRAME, {"system.storey[1].floor_mass": masses})
    values = compute(made, batches(made, *kind(made)), 0)
    assert list(values.failed) == [(8,)]
    assert np.isfinite(values.arrays["max"][:8]).all()
    assert list(values.how) == ["modes of many structures together, errors estimated"]


@pytest.mark.parametrize(
    ("scene", "vary"),
    [
        ({**FRAME, "system": {**FRAME["system"], "damping": 0}}, NUMBERS["system.storey[0].stiffness"]),
        ({**FRAME, "output": {**FRAME["output"], "tolerance": "1e-9"}}, NUMBERS["system.storey[0].stiffness"]),
    ],
    ids=["undamped", "more modes than are worth it"],
)
def test_what_modes_do_not_serve_is_left_to_others(scene: Mapping[str, Any], vary: list[str]) -> None:
    made = planned(scene, {"system.storey[0].stiffness": vary, "system.storey[1].floor_mass": ["1 t", "2 t", "3 t"]})
    assert kind(made)[0] != "structures"


def test_loads_that_are_varied_are_not_shared() -> None:
    made = planned(FRAME, {"load[0].spacing": [f"0.{k} s" for k in range(1, 10)]})
    assert kind(made)[0] == "single"
