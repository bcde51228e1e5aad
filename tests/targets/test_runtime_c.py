"""Parameters at run time in C: what a scene with these numbers gives, whatever they are, or a status that says why."""

import json
import re
import shutil
import subprocess
from fractions import Fraction

import numpy as np
import pytest

import wavesym
from tests.support.builds import LANGUAGES, STRICT, needs_binutils
from tests.support.built_model import BuiltModel, written
from tests.support.faults import BODIES
from wavesym.cli import main
from wavesym.errors import WavesymError
from wavesym.running.toolchain import compiler

NEARLY = Fraction(1000001, 10**6)
BUILDING = wavesym.Scene(
    name="tower",
    system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
    load=[{"times": [0, "1/3", "5/2"], "a": [1, 0, "-1/2"], "b": ["-1/4", "1/2", 0]}],
    output={
        "until": 7,
        "tolerance": "1e-11",
        "strain": ["1/3", "1+"],
        "velocity": [0, 2],
        "displacement": ["1/2", "7/5"],
        "acceleration": [1],
        "force": ["1-"],
        "drift": [2],
    },
)
GROUND = BUILDING.with_({"system.base": "ground", "name": "shaken"})
DRIVE = wavesym.Scene(
    name="gears",
    system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    load=[{"body": 1, "times": [0, "3/2"], "steps": [1, -1]}, {"body": 3, "times": [1], "ramps": ["1/3"]}],
    output={
        "until": "13/2",
        "tolerance": "1e-11",
        "strain": ["1/4", "1-"],
        "displacement": [0],
        "acceleration": [0, 1],
        "force": ["3/2"],
    },
)
COLLISION = wavesym.Scene(
    name="crash",
    system={"type": "collision", "m": 4, "kappa": [1, 2], "velocity": [1, -1]},
    output={"until": 6, "tolerance": "1e-11", "strain": ["1+", "5/2"], "velocity": [3], "displacement": ["1/3"]},
)
CASES = {
    "building": (
        BUILDING,
        {"kappa": [["1/1000"] * 3, [1, NEARLY, 1], [3, 10, "1/7"], [100, 100, 100]], "load": [[1, 0, "-1/2", 2, 0, 3]]},
    ),
    "ground": (GROUND, {"kappa": [[1, "1/2", NEARLY / 2], [1, 20, 7]]}),
    "drive": (
        DRIVE,
        {"kappa": [[1, 1], [NEARLY, 1], [30, "1/100"]], "inertia": [[1, 1, 1], [2, NEARLY, 7]], "load": [[2, 0, -3]]},
    ),
    "collision": (COLLISION, {"kappa": [[1, 1], ["1/50", 50]], "velocity": [[2, "-1/3"], [1, "1/2"]]}),
}


def scene_with(scene, numbers):
    """The scene with these numbers in the place of its own."""
    changes = {f"system.{name}": values for name, values in numbers.items() if name != "load"}
    if "load" in numbers:
        left = list(numbers["load"])
        for number, load in enumerate(scene.load):
            for name in ("a", "b", "steps", "ramps"):
                if count := len(getattr(load, name, ())):
                    changes[f"load[{number}].{name}"] = [left.pop(0) for _ in range(count)]
    return scene.with_(changes)


def flat(numbers):
    return [Fraction(value) for values in numbers.values() for value in values]


def drawn(cases):
    """Each choice of a field with the first of the others, and the last of all."""
    first = {name: choices[0] for name, choices in cases.items()}
    found = [first | {name: choice} for name, choices in cases.items() for choice in choices]
    return [*found, {name: choices[-1] for name, choices in cases.items()}]


def missed(made, scene, count=181):
    """The largest error of any output relative to its largest value, by samples, and of a few single values."""
    step = made.until / (count - 1)
    status, found = made.sample(0.0, step, count)
    assert status == 0
    tau = np.array([k * step for k in range(count)])
    true = wavesym.evaluator(scene)(tau)
    largest = np.max(np.abs(true), axis=1)
    errors = np.max(np.abs(found - true), axis=1)
    assert np.all(errors[largest == 0] == 0)
    for k in range(0, count, 17):
        assert np.all(np.abs(made.at(tau[k])[1] - found[:, k]) <= 1e-13 * largest)
    return float(np.max(errors[largest > 0] / largest[largest > 0]))


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", CASES)
def test_any_parameters_give_what_their_scene_gives(case, tmp_path):
    scene, numbers = CASES[case]
    made = BuiltModel(scene, list(numbers), tmp_path)
    for given in drawn(numbers):
        assert made.build(*flat(given)) == 0
        assert missed(made, scene_with(scene, given)) <= made.estimate < 1e-8
    # the scene's own numbers to its own tolerance
    own = [value for name in numbers if name != "load" for value in getattr(scene.system, name)]
    loads = [value for load in scene.load for name in ("a", "b", "steps", "ramps") for value in getattr(load, name, ())]
    assert made.build(*own, *(loads if "load" in numbers else [])) == 0
    assert missed(made, scene) <= 1e-11


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "case"),
    [
        (BODIES[0], "building"),
        (("2.0 * p->kappa[1]", "1.999999 * p->kappa[1]"), "building"),
        (("half * (power[1] + 2 * middle * power[2])", "half * (power[1] + middle * power[2])"), "ground"),
        (("total[gain] - low", "total[gain]"), "collision"),
        (("/ p->inertia[2]", "/ p->inertia[1]"), "drive"),
    ],
)
def test_a_mistake_is_seen(change, case, tmp_path):
    scene, numbers = CASES[case]
    if change[0].startswith("/ p->"):
        change = ("/ (p->inertia[2])", "/ (p->inertia[1])")
    made = BuiltModel(scene, list(numbers), tmp_path, [change])
    given = {name: choices[-1] for name, choices in numbers.items()}
    assert made.build(*flat(given)) == 0
    assert missed(made, scene_with(scene, given)) > 10 * made.estimate


SANITIZED = ("-O0", "-fsanitize=undefined,float-cast-overflow", "-fsanitize-undefined-trap-on-error")


def test_a_bad_number_is_refused(tmp_path):
    made = BuiltModel(DRIVE, ["kappa", "inertia", "load"], tmp_path, flags=SANITIZED)
    own = [1, 0.5, 1, 2, 1, 1, -1, 0.3]
    assert made.build(*own) == 0
    for place in range(8):
        for bad in (np.nan, np.inf, -np.inf, *([0.0, -1.0, -0.0] if place < 5 else [])):
            assert made.build(*own[:place], bad, *own[place + 1 :]) == 1
            assert np.isnan(made.estimate)
            status, out = made.at(1.0)
            assert status == 1
            assert np.all(np.isnan(out))
    for huge in (1e308, 1e200, 1e-320):
        for place in range(8):
            extreme = [*own[:place], huge, *own[place + 1 :]]
            status = made.build(*extreme)
            assert status in (0, 1, 2)
            # derivatives may be beyond all numbers where values are not
            assert made.tangents(extreme, 0.0, 1.0, 3)[0] in (status, 1)
    assert made.build(*own) == 0


def test_a_degree_too_low_is_told(tmp_path):
    made = BuiltModel(BUILDING, ["kappa"], tmp_path)
    assert made.build(1, 1e4, 1e4) == 2
    assert np.isnan(made.estimate)
    assert made.sample(0.0, 1.0, 3)[0] == 1
    assert made.build(1, 100, 100) == 0


def test_out_of_range_is_nan(tmp_path, thorough):
    made = BuiltModel(COLLISION, ["kappa"], tmp_path, flags=SANITIZED if thorough else ())
    assert made.build(1, 2) == 0
    for tau in (-1e-300, np.nextafter(6.0, 7.0), np.nan, np.inf, -np.inf):
        status, out = made.at(tau)
        assert status == 1
        assert np.all(np.isnan(out))
    status, backwards = made.sample(7.0, -0.25, 33)
    assert status == 1
    outside = np.array([not 0 <= 7.0 - 0.25 * k <= 6 for k in range(33)])
    assert np.all(np.isnan(backwards) == outside)
    forwards = made.sample(0.0, 0.25, 25)
    assert forwards[0] == 0
    # u comes from blocks here and there from single values
    assert np.allclose(forwards[1], backwards[:, 4:29][:, ::-1], rtol=0, atol=1e-14)
    assert made.sample(0.0, 1.0, 0)[0] == 0
    # steps that double arithmetic has trouble with
    for step in (0.0, 5e-324, -5e-324, 1e308, np.inf, np.nan):
        status, out = made.sample(1.0, step, 40)
        assert status == (not np.isfinite(step) or step > 1)
        assert np.isnan(out[:, 1:]).all() == status


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_it_compiles_without_a_warning(language, tmp_path):
    written(DRIVE, ["kappa", "load"], tmp_path)
    if language == "c++17" and shutil.which("g++") is None:
        pytest.skip("no C++ here")
    for file in ("gears.c", "gears_selftest.c"):
        compiler().run([*LANGUAGES[language], *STRICT, "-c", file, "-o", f"{file}.o"], tmp_path)
        assert (tmp_path / f"{file}.o").stat().st_size > 0


@pytest.mark.slow
@needs_binutils
def test_it_has_its_own_names_alone(tmp_path):
    written(BUILDING, ["kappa"], tmp_path)
    compiler().run([*LANGUAGES["c99"], *STRICT, "-c", "tower.c", "-o", "tower.o"], tmp_path)
    told = subprocess.run(["nm", tmp_path / "tower.o"], capture_output=True, text=True, check=True).stdout
    symbols = [line.split()[-2:] for line in told.splitlines()]
    assert all(name.startswith("tower_") for kind, name in symbols if kind.isupper() and kind != "U")
    # compilers may call these for loops that fill or copy
    assert {name for kind, name in symbols if kind == "U"} <= {"memset", "memcpy", "memmove"}
    assert not [name for kind, name in symbols if kind in "dDbBcC"]


def test_its_selftest_sees_what_is_broken(tmp_path):
    def status(folder, *changes):
        folder.mkdir()
        written(BUILDING, ["kappa"], folder, changes)
        compiler().run([*LANGUAGES["c99"], *STRICT, "tower.c", "tower_selftest.c", "-o", "test", "-lm"], folder)
        return subprocess.run([folder / "test"], capture_output=True, check=False).returncode

    assert status(tmp_path / "right") == 0
    off = "+ series[(size_t)i * size];", "+ series[(size_t)i * size] * 0.999999;"
    assert status(tmp_path / "wrong", off) == 1


@pytest.mark.parametrize(
    ("scene", "runtime", "message"),
    [
        (BUILDING, ["velocity"], "--runtime: velocity is unknown; write kappa or load"),
        (COLLISION, ["load"], "--runtime: load is unknown; write kappa or velocity"),
        (COLLISION, ["kappa", "kappa"], "--runtime: kappa stands twice; write it once"),
        (COLLISION, [""], "--runtime: an empty name is unknown; write kappa or velocity"),
        (
            wavesym.Scene.from_toml("stepped_shaft"),
            ["kappa"],
            "--runtime: kappa is unknown; write mass, dashpot, impedance, velocity or load",
        ),
    ],
)
def test_what_is_not_served_is_refused(scene, runtime, message, tmp_path):
    with pytest.raises(WavesymError, match=message):
        wavesym.generate(scene, tmp_path / "none", runtime=runtime)
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("more", [{"language": "all"}, {"evaluator": "march"}, {"optimize": "size"}])
def test_other_options_are_refused(more, tmp_path):
    with pytest.raises(WavesymError, match=r"go with --runtime|--runtime makes C"):
        wavesym.generate(BUILDING, tmp_path / "none", runtime=["kappa"], **more)


def test_the_command_says_what_a_fine_tolerance_is_taken_as(tmp_path, capsys):
    path = tmp_path / "crash.toml"
    path.write_text(TOML)
    folder = tmp_path / "made"
    asked = ["generate", str(path), "--runtime", "kappa,velocity", "-o", str(folder)]
    assert main(asked) == 0
    told = capsys.readouterr().err
    assert "tolerance 1e-15 taken as 1e-13" in told
    assert "errors are estimated" in told
    header = (folder / "crash.h").read_text()
    assert "--runtime kappa,velocity" in header
    assert not re.search(r"ERROR_BOUND|crash_eval|crash_sample", header)
    manifest = json.loads((folder / "crash.json").read_text())
    assert manifest["runtime"] == {
        "kappa": {"kappa_1": "1", "kappa_3": "2"},
        "velocity": {"velocity_1": "1", "velocity_3": "-1"},
    }
    assert "error_bound" not in manifest
    assert main([*asked, "--check"]) == 0
    assert main([*asked[:2], "-o", str(folder), "--check"]) == 1


TOML = """
name = "crash"
system = { type = "collision", m = 4, kappa = [1, 2], velocity = [1, -1] }
output = { until = 3, tolerance = 1e-15, strain = ["1+"] }
"""
