"""What is computed together is what each case is alone: within the bounds of both, whatever the cases are."""

from __future__ import annotations

import random
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `sweep` is not installed")

from wavesym.errors import WavesymError
from wavesym.results.response import Response
from wavesym.results.summary import Summary, summarise
from wavesym.scene import lower
from wavesym.sweeps.batches import batches
from wavesym.sweeps.kinds import kind
from wavesym.sweeps.plan import SweepPlan, plan
from wavesym.sweeps.request import SweepRequest
from wavesym.sweeps.single import instants
from wavesym.sweeps.values import BatchValues
from wavesym.sweeps.work import compute

pytestmark = pytest.mark.slow

DRIVE: dict[str, Any] = {
    "name": "shafts",
    "system": {"type": "drive", "m": 3, "kappa": [1, "1/2", "4/5"], "inertia": [1, 2, "1/2", "3/2"]},
    "load": [{"body": 1, "times": [0, 3], "steps": [1, "-1/2"]}],
    "output": {"until": 20, "tolerance": "1e-6", "strain": [0.5, 1.5, 2.5], "velocity": [0]},
}


def shaken(spacing: str, **system: Any) -> dict[str, Any]:
    return {
        "name": "frame",
        "system": {"type": "building", "m": 2, "kappa": ["1/20", "1/20", "1/25"], "base": "ground", **system},
        "load": [{"spacing": spacing, "record": {"samples": [0, 1]}}],
        "output": {
            "until": 150,
            "tolerance": "1e-5",
            "acceleration": [1, 2],
            "force": [0],
            "drift": [1, 2],
            "relative": [2],
            "displacement": [1],
        },
    }


def planned(fields: Mapping[str, Any]) -> SweepPlan:
    file, request = SweepRequest.read(fields)
    return plan(request, file)


def computed(made: SweepPlan) -> list[tuple[tuple[int, ...], dict[str, Any], str]]:
    """All cases, with their arrays, and how their batch was computed."""
    parts = batches(made, *kind(made))
    found = []
    for batch in range(len(parts)):
        values: BatchValues = compute(made, parts, batch)
        for row, place in enumerate(values.places):
            reason = values.failed.get(place, "")
            found.append(
                (place, {name: array[row] for name, array in values.arrays.items()}, reason or str(values.how))
            )
    return found


def assert_alike(made: SweepPlan, place: tuple[int, ...], found: dict[str, Any]) -> None:
    try:
        alone: Summary = summarise(lower(made.scene(place)))
    except WavesymError:
        assert np.isnan(found["max"]).all()
        return
    for k, output in enumerate(alone.outputs):
        both = (alone.bound + found["bound"]) * abs(output.largest.value)
        for name, peak in (("min", output.min), ("max", output.max)):
            assert abs(found[name][k] - peak.value) <= both, (place, output.name, name)
            if peak.value == 0:  # to the last bit, and not whenever rounding has it
                assert (found[name][k], found[f"tau_{name}"][k]) == (0, peak.at.tau), (place, output.name, name)


def test_sets_of_parameters_are_what_each_is_alone() -> None:
    draw = random.Random(3)
    kappa = sorted({Fraction(draw.randint(1, 400), 100) for _ in range(9)})
    steps = [Fraction(draw.randint(-300, 300), 97) for _ in range(3)]
    made = planned(
        {
            "scene": DRIVE,
            "vary": {"system.kappa[1]": kappa, "output.until": [20, "41/2"], "load[0].steps[1]": [*steps, 0]},
        }
    )
    cases = computed(made)
    assert kind(made) == ("parameters", (True, False, True))
    assert len(cases) == made.cases
    for place, found, how in draw.sample(cases, 10):
        assert "parameters at run time" in how
        assert_alike(made, place, found)
        values = made.scene(place)
        assert values.system.kappa[1] == kappa[place[0]]


BAR: dict[str, Any] = {
    "name": "bar",
    "system": {
        "type": "chain",
        "parts": [
            {"mass": 4, "velocity": 1},
            {"spring": 10, "dashpot": "1/10"},
            {"mass": "1/2"},
            {"rod": 1},
            {"rod": "3/2", "impedance": 2},
            "fixed",
        ],
    },
    "output": {"until": 9, "tolerance": "1e-6", "strain": ["1/2"]},
}
SHAFTS: dict[str, Any] = {
    "name": "shafts",
    "units": {"moment": "kN*m", "velocity": "rpm", "angle": "deg"},
    "system": {
        "type": "drive",
        "shaft": [
            {"length": "4 m", "diameter": "160 mm", "G": "80 GPa", "rho": "7850 kg/m^3"},
            {"length": "4 m", "diameter": "140 mm", "G": "80 GPa", "rho": "7850 kg/m^3"},
        ],
        "disc": [{"inertia": "600 kg*m^2"}, {"inertia": "50 kg*m^2"}, {"inertia": "400 kg*m^2"}],
    },
    "load": [{"body": 1, "times": ["0 s", "0.01 s"], "steps": ["5 kN*m", "-5 kN*m"]}],
    "output": {"until": "0.03 s", "tolerance": "1e-6", "velocity": [0], "force": ["1/2"]},
}


@pytest.mark.parametrize(
    ("scene", "path", "values", "shared"),
    [
        (BAR, "system.parts[0].mass", [Fraction(k, 7) for k in range(1, 10)], True),
        (BAR, "system.parts[1].spring", [*range(1, 9), 50], True),
        (BAR, "system.parts[4].impedance", range(1, 10), True),
        (BAR, "system.parts[4].rod", range(1, 10), False),
        (SHAFTS, "system.disc[1].inertia", [f"{50 + 9 * k} kg*m^2" for k in range(9)], True),
        (SHAFTS, "system.shaft[1].diameter", [f"{90 + 7 * k} mm" for k in range(9)], True),
        (SHAFTS, "system.shaft[1].length", [f"{4 + k} m" for k in range(9)], False),
        (SHAFTS, "load[0].steps[1]", [f"{k} kN*m" for k in range(-3, 6)], True),
        ("collision_m4", "system.velocity[0]", range(1, 10), True),
        ("collision_m4", "output.until", range(1, 10), False),
    ],
)
def test_whatever_is_varied_shares_a_program_where_that_is_right(
    scene: Any, path: str, values: Any, shared: bool
) -> None:
    made = planned({"scene": scene, "vary": {path: list(values)}})
    assert kind(made)[0] == ("parameters" if shared else "single")
    for place, found, how in computed(made)[::4]:
        assert ("parameters at run time" in how) == shared
        assert_alike(made, place, found)


def test_a_case_that_is_unlike_the_others_is_computed_alone() -> None:
    """A mass that is none, and a rod's own velocity: no numbers of the program that the other cases share."""
    masses: list[Any] = [1, 2, 3, 4, 0, 5, 6, 7, 8]
    made = planned({"scene": BAR, "vary": {"system.parts[2].mass": masses}})
    assert kind(made)[0] == "parameters"
    (_, _, how), *_ = cases = computed(made)
    assert "'parameters at run time, errors estimated': 8" in how
    for place, found, _ in cases[3:6]:
        assert_alike(made, place, found)


def test_sets_that_their_program_refuses_are_computed_alone() -> None:
    """Bodies that are far too light for the program, and a number that is none."""
    kappa = ["1/10", "1/5", "3/10", "2/5", "1/2", 1, 2, 100, -1]
    short = {**DRIVE, "output": {**DRIVE["output"], "until": 4}}
    cases = computed(made := planned({"scene": short, "vary": {"system.kappa[0]": kappa}}))
    for place, found, _ in cases[-4:]:
        assert_alike(made, place, found)
    assert "is not positive; write a number above 0" in cases[-1][2]
    assert np.isnan(cases[-1][1]["max"]).all()


def records(folder: Path, draw: np.random.Generator) -> None:
    """Noise, waves, a pulse, nothing but zeros, one that is rough, one that begins late, one that jumps at once."""
    n = 300
    t = np.arange(n) * 0.5
    made = {
        "noise": draw.standard_normal(n),
        "waves": np.sin(0.7 * t) + np.sin(0.11 * t * t / 20),
        "pulse": np.where(np.abs(t - 20) < 2, 1.0, 0.0),
        "still": np.zeros(n),
        "rough": np.where(np.arange(n) % 2, 1.0, -1.0) * (t > 1),
        "late": np.where(t > 120, np.sin(t), 0.0),
    }
    for name, samples in made.items():
        samples[0] = 0
        (folder / f"{name}.csv").write_text("a\n" + "".join(f"{value:.6f}\n" for value in samples))
    (folder / "jumps.csv").write_text("a\n" + "".join(f"{value:.6f}\n" for value in np.cos(t)))


@pytest.mark.parametrize(
    ("spacing", "system"),
    [
        ("1/2", {"damping": "1/20"}),
        ("4.995", {"damping": ["1/20", "3/10"]}),
        ("4.995", {"damping": {"modes": [1, 2], "ratio": 0.03}}),
    ],
)
def test_records_are_what_each_is_alone(tmp_path: Path, spacing: str, system: dict[str, Any]) -> None:
    records(tmp_path, np.random.default_rng(4))
    made = planned({"scene": shaken(spacing, **system), "records": str(tmp_path / "*.csv")})
    assert kind(made)[0] == "recorded"
    cases = computed(made)
    assert len(cases) == made.cases == 7
    assert sum("together" in how for _, _, how in cases) >= 3
    for place, found, _ in cases:
        assert_alike(made, place, found)


@pytest.mark.parametrize("start", ["0", "7/3"])
def test_histories_of_records_are_those_of_each_alone(tmp_path: Path, start: str) -> None:
    """At instants that are no samples; also where a record begins late, with a jump to its first sample."""
    records(tmp_path, np.random.default_rng(6))
    scene = shaken("1/2", damping="1/20")
    scene["load"][0]["start"] = start
    made = planned({"scene": scene, "records": str(tmp_path / "*.csv"), "keep": {"summary": [], "histories": 77}})
    assert kind(made)[0] == "recorded"
    cases = computed(made)
    assert sum("together" in how for _, _, how in cases) >= 3
    for place, found, _ in cases:
        alone = Response(model := lower(made.scene(place)))
        try:
            true = np.array(alone(instants(model, 77)))
        except WavesymError:  # a jump
            assert np.isnan(found["history"]).all()
            continue
        largest = np.abs([[each.min.value, each.max.value] for each in summarise(model).outputs]).max(axis=1)
        both = (alone.error_bound + found["bound"]) * largest[:, None]
        assert np.all(np.abs(found["history"] - true) <= both), place
        assert np.abs(np.diff(true)).max() > 100 * both.max() or not true.any()


def test_thirty_random_cases_are_what_summary_says(tmp_path: Path) -> None:
    draw = random.Random(8)
    np_draw = np.random.default_rng(8)
    t = np.arange(400)
    for k in range(6):
        wave = sum(np.sin(np_draw.uniform(0.02, 1.5) * t + 0.3 * j) for j in range(6)) * t * np.exp(-t / 60)
        wave[0] = 0
        (tmp_path / f"r{k}.csv").write_text("a\n" + "".join(f"{value:.5f}\n" for value in wave))
    sweeps = [
        {
            "scene": shaken("3/7", damping="1/50"),
            "vary": {"system.kappa[1]": [Fraction(draw.randint(2, 40), 100) for _ in range(4)]},
            "records": str(tmp_path / "*.csv"),
        },
        {"scene": DRIVE, "vary": {"system.inertia[2]": [Fraction(draw.randint(20, 400), 101) for _ in range(12)]}},
        {"scene": "collision_m4", "vary": {"output.until": [4, "19/3", 8], "system.kappa[0]": [1, "1/3"]}},
    ]
    checked = 0
    for each in sweeps:
        made = planned(each)
        for place, found, _ in draw.sample(computed(made), min(made.cases, 12)):
            assert_alike(made, place, found)
            checked += 1
    assert checked == 30


def test_a_wrong_peak_would_be_seen() -> None:
    made = planned({"scene": DRIVE, "vary": {"system.kappa[1]": [1, 2]}})
    (place, found, _), *_ = computed(made)
    assert_alike(made, place, found)
    found["max"] = found["max"] * (1 + 1e-5)
    with pytest.raises(AssertionError):
        assert_alike(made, place, found)
