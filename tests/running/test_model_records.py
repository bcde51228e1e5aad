"""Records among the loads of many sets: times their factor they are what the scene has, whatever kappa is."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import wavesym
from wavesym.errors import SpacingError, UnservedError
from wavesym.programs.march import plan
from wavesym.programs.request import Request
from wavesym.programs.runtime.making import runtime_program
from wavesym.running import sets
from wavesym.scene.lowering import amplitudes, lower

SAMPLES = ["1/3", 1, "-3/2", 0, "1/7", 2, -1, "1/2"]
SHAKEN = wavesym.Scene(
    name="shaken",
    system={"type": "building", "m": 2, "kappa": [1, "3/5", "1/5"], "base": "ground"},
    load=[{"spacing": "2/3", "samples": SAMPLES}],
    output={"until": 6, "tolerance": "1e-11", "drift": [1], "acceleration": [2], "displacement": [1]},
)
PULLED = SHAKEN.with_({"system.base": "force", "load": [{"spacing": 2, "samples": SAMPLES[:4]}]})
TURNED = wavesym.Scene(
    name="turned",
    system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    load=[
        {"body": 1, "spacing": "1/16", "samples": SAMPLES * 4},
        {"body": 3, "record": {"samples": SAMPLES}, "spacing": "3/4", "start": "3/2", "scale": "1/2"},
        {"body": 2, "times": [1, 2], "steps": [1, -1]},
    ],
    output={"until": 5, "tolerance": "1e-11", "strain": ["1/2", "3/2"], "velocity": [1], "acceleration": [0]},
)
LINKED = wavesym.Scene(
    name="linked",
    system={
        "type": "chain",
        "parts": [
            {"motion": "acceleration", "name": "ground"},
            {"rod": 1, "impedance": 2},
            {"mass": 1, "name": "disc", "dashpot": "1/8"},
            {"rod": "3/2", "impedance": "1/2"},
            {"mass": "1/3", "name": "end"},
        ],
    },
    load=[
        {"at": "ground", "spacing": "3/4", "samples": SAMPLES},
        {"at": "disc", "spacing": "1/8", "samples": SAMPLES * 3},
        {"at": "end", "times": [1, 2], "steps": [1, -1]},
    ],
    output={"until": 5, "tolerance": "1e-11", "strain": ["1/2", 2], "velocity": [1], "displacement": ["5/2"]},
)
# what changes at run time, by path in the scene, and as it is given
CHANGED = {
    "shaken": ({"system.kappa": [2, 0.25, 0.75]}, {"kappa": [2, 0.25, 0.75]}),
    "turned": ({"system.kappa": [0.25, 30]}, {"kappa": [0.25, 30]}),
    "linked": ({"system.parts[2].mass": 4, "system.parts[4].mass": 0.25}, {"mass": [4, 0.25]}),
}
TAU = np.linspace(0, 5, 41)


@pytest.fixture(autouse=True)
def sooner(monkeypatch):
    """Compiled sooner."""
    monkeypatch.setattr(sets, "FAST", ("-O1",))


def times(scene, factors):
    """The scene with what changes, each load times its factor, and these as numbers of the field `load`."""
    own, others = CHANGED[scene.name]
    changes, given = dict(own), []
    for number, (load, factor) in enumerate(zip(scene.load, factors, strict=True)):
        steps = getattr(load, "steps", ())
        if hasattr(load, "record"):
            changes[f"load[{number}].scale"] = load.scale * factor
        else:
            name = "steps" if steps else "samples"
            changes[f"load[{number}].{name}"] = [factor * value for value in getattr(load, name)]
        given += [float(factor * value) for value in steps] or [float(factor)]
    return scene.with_(changes), others | {"load": given}


def check(model, scene, factors):
    """Values and derivatives."""
    scaled, given = times(scene, factors)
    true = wavesym.evaluator(scaled)(TAU)
    slopes = model.gradients(TAU, **given)
    wrong = np.max(np.abs(slopes.values[0] - true), axis=1) / np.max(np.abs(true), axis=1)
    assert np.max(wrong) <= slopes.checks.estimate[0] < 1e-10
    # values are linear in the factors
    summed = np.tensordot(given["load"], slopes.by["load"][0], 1)
    assert np.max(np.abs(summed - slopes.values[0])) < 1e-11 * np.max(np.abs(summed))
    return given, wrong


@pytest.mark.quick(1)
@pytest.mark.parametrize("scene", [SHAKEN, LINKED, pytest.param(TURNED, marks=pytest.mark.slow)])
def test_a_record_counts_times_its_factor(scene):
    factors = [Fraction(-2), Fraction(1, 2), Fraction(3)][: len(scene.load)]
    model = wavesym.model(scene, runtime=[*CHANGED[scene.name][1], "load"])
    assert model.labels["load"][0].startswith("factor of the ")
    assert model.parameters["load"][0] == 1
    check(model, scene, factors)


@pytest.mark.slow
@pytest.mark.parametrize("scene", [SHAKEN, PULLED, TURNED, LINKED], ids=["ground", "force", "drive", "chain"])
@pytest.mark.parametrize("chosen", [[], ["load"]])
def test_a_record_within_bounds(scene, chosen):
    model = wavesym.model(scene, runtime=[*CHANGED[scene.name][1], *chosen])
    if not chosen:
        scaled, given = times(scene, [1] * len(scene.load))
        true = wavesym.evaluator(scaled)(TAU)
        del given["load"]
        found = model.values(TAU, **given)[0]
        wrong = np.max(np.abs(found - true), axis=1) / np.max(np.abs(true), axis=1)
    else:
        given, wrong = check(model, scene, [Fraction(5, 2)] * len(scene.load))
    assert np.all(wrong <= model.bounds(**given)[0])
    assert np.max(model.bounds(**given)) < 1e-7
    # and beside other sets
    data = model.values(TAU, **given)[0]
    both = {name: np.array([numbers, 2 * np.array(numbers)]) for name, numbers in given.items()}
    same, other = model.misfit(TAU, data)(**both)
    assert same < 1e-20 * np.sum(data**2) < other


@pytest.mark.slow
@pytest.mark.parametrize("scene", [SHAKEN, LINKED])
def test_samples_that_only_add_up_are_seen(scene):
    program = runtime_program(lower(scene), Request(runtime=("load",)), amplitudes(scene))
    added = replace(
        program, tables=program.tables | {"event_power": tuple(k % 3 for k in program.tables["event_power"])}
    )
    true = wavesym.evaluator(scene)(TAU)
    numbers = np.concatenate([field.values for field in program.laws.fields]).astype(float)[None]
    right, wrong = (sets.CompiledSets(each).values(numbers, TAU).values[0, 0] - true for each in (program, added))
    assert np.max(np.abs(right)) < 1e-11 < 0.1 < np.max(np.abs(wrong))


MANY = {"load[0].spacing": "0.3017"}
BESIDE = {"load": [{"spacing": "2/3", "samples": SAMPLES}, {"times": [1], "a": [1]}]}


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        (
            MANY,
            "load: times at a spacing of 0.3017 leave 8 different remainders of the step 1, the limit in a march is 7",
        ),
        (BESIDE, "--runtime: load where samples act beside another load on the same body is not supported"),
    ],
)
def test_records_that_are_refused(changes, expected, monkeypatch):
    monkeypatch.setattr(plan, "MOST_PANELS", 7)
    with pytest.raises((SpacingError, UnservedError)) as refused:
        wavesym.model(SHAKEN.with_(changes), runtime=["kappa", "load"])
    assert str(refused.value).startswith(expected)


@pytest.mark.slow
def test_the_factor_of_a_record_has_no_unit():
    storeys = {"count": 2, "height": "3.5 m", "stiffness": "277 MN/m", "column_mass": "11 t", "floor_mass": "350 t"}
    scene = wavesym.Scene(
        name="frame",
        units={},
        system={"type": "building", "base": "ground", "storey": [storeys]},
        load=[{"spacing": "0.1 s", "samples": [0, 0.3, -0.3, 0], "unit": "g"}],
        output={"until": "0.5 s", "tolerance": 1e-9, "drift": [1]},
    )
    model = wavesym.model(scene, runtime=["load"])
    assert model.units["load"] == ("",)
    true = wavesym.evaluator(scene.with_({"load[0].samples": [0, 0.6, -0.6, 0]}))
    times = np.linspace(0, 0.5, 21)
    assert model.values(times, load=[2])[0] == pytest.approx(true(times), rel=1e-9, abs=1e-12)
