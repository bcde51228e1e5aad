"""The march in C: strict, its tables as declared, NumPy's values, and within its bound however it is built."""

from __future__ import annotations

import ctypes
import json
import re
import shlex
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq

from tests.support.builds import LANGUAGES, STRICT, needs_binutils, sections
from tests.support.drives import every, exact
from tests.support.generated import files, numpy_text, program_files
from tests.support.marches import asked
from wavesym.numbers.doubles import not_below
from wavesym.numbers.reals import DOUBLE, REALS, SINGLE
from wavesym.programs.making import make
from wavesym.programs.march.evaluator import march
from wavesym.programs.program import Program
from wavesym.programs.request import Request
from wavesym.running.compilation import FLAGS, compile_files, import_text
from wavesym.running.toolchain import at_hand, compiler
from wavesym.scene import Scene, lower
from wavesym.targets import files as written
from wavesym.targets.c.tables import declarations
from wavesym.targets.manifest import CODE_AT_MOST

BUILDS = {"plain": ("-std=c99", "-O0"), "contracted": (*FLAGS, "-march=native", "-ffp-contract=fast")}
SELFTESTS = [(each, real) for each in at_hand() for real in (SINGLE, DOUBLE)]


def scene(system, load=(), until=9, **outputs) -> Scene:
    output = {"until": until, "tolerance": "1e-3", **outputs}
    return Scene(name="made", system=system, load=list(load), output=output)


def building(base) -> Scene:
    system = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": base}
    load = {"times": [0, "1/3", "5/2"], "a": [1, 0, "-1/2"], "b": ["-1/4", "1/2", 0]}
    return scene(system, [load], strain=["1/3", "1+"], velocity=[0, 2], displacement=["1/2", 1])


DRIVE = scene(
    {"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    [{"body": 1, "times": [0, "1/3"], "steps": [1, -2]}, {"body": 3, "times": ["5/2"], "steps": [1]}],
    strain=[0, "1-"],
    velocity=["5/3"],
    displacement=[2],
)
COLLISION = scene(
    {"type": "collision", "m": 4, "kappa": ["1/10", "2"], "velocity": [1, "-1/2"]},
    strain=[0, "1-", 2],
    velocity=["1/2"],
    displacement=[4],
)
SCENES = {"force": building("force"), "ground": building("ground"), "drive": DRIVE, "collision": COLLISION}
EACH = pytest.mark.parametrize("name", [*SCENES, "every"])


def scene_of(name) -> Scene:
    """A named system, or a chain with one of every kind of joint."""
    return SCENES.get(name) or every(3, tolerance="1e-3")


@pytest.mark.quick(1)
@EACH
@pytest.mark.parametrize("how", SELFTESTS, ids=lambda how: "-".join(each.name for each in how))
def test_c_passes_its_self_test(name, how, monkeypatch) -> None:
    compiler, real = how
    monkeypatch.setenv("CC", shlex.join(compiler.command))
    model = lower(scene_of(name))
    with compile_files(program_files(model, march(model, real), "c", tested=True), len(model.probes)) as program:
        assert program.selftest() == 0


@pytest.mark.quick(1)
@EACH
def test_c_is_numpy_and_sample_is_eval(name) -> None:
    model = lower(scene_of(name))
    made = march(model)
    module = import_text(numpy_text(model, made), scene_of(name).name)
    end = made.tau_max
    taus = [0.0, 1 / 3, 0.9999, 1.0, 2.5, 2.4999999999999996, 0.7 * end, np.nextafter(end, 0), end]
    taus += [-1.0, end + 0.1, np.nan]
    with compile_files(program_files(model, made, "c", tested=True), len(model.probes)) as program:
        assert program.selftest() == 0
        assert program.names == module.OUTPUTS
        values = program(taus)
        expected = module.evaluate(taus)
        assert np.isnan(expected[:, 9:]).all()
        sizes = np.nanmax(np.abs(expected), axis=1, keepdims=True)
        # rounding differs, and no more; where a jump is, both stand on the same side of it
        assert (np.isnan(values) == np.isnan(expected)).all()
        assert np.nanmax(np.abs(values - expected) - 1e-13 * sizes) <= 0
        for tau0, dtau, count in ((0.0, end / 900, 901), (end, -0.37, 30), (-1.0, 1.0, 12)):
            status, sampled = program.sample(tau0, dtau, count)
            single = program([tau0 + k * dtau for k in range(count)])
            np.testing.assert_array_equal(sampled, single)
            assert status == int(np.isnan(single).any())


def test_a_window_begins_at_its_first_number_whatever_division_makes_of_it() -> None:
    """In doubles (27/91) / (1/91) is less than 27. A wave of 1 comes there at its instant, and is not there before."""
    parts = [{"motion": "velocity", "name": "a"}, {"rod": "1/91"}, {"joint": True}, {"rod": "90/91"}, "absorbing"]
    places = (27, 54)
    step = [{"at": "a", "times": [0], "steps": [1]}]
    model = lower(scene({"type": "chain", "parts": parts}, step, until=1, velocity=[f"{k}/91" for k in places]))
    arrives = [not_below(fmpq(k, 91)) for k in places]
    assert [int(tau / (1 / 91)) for tau in arrives] == [26, 53]
    with compile_files(program_files(model, march(model), "c"), len(model.probes)) as program:
        at, before = program(arrives), program([np.nextafter(tau, 0) for tau in arrives])
    np.testing.assert_allclose(np.diag(at), 1, rtol=1e-14)
    assert np.abs(np.diag(before)).max() == 0


@dataclass(frozen=True)
class Chain:
    """A scene with one of every kind of joint, its files, and the truth at some instants."""

    scene: Scene
    made: dict[str, str]
    program: Program
    taus: np.ndarray
    true: np.ndarray

    def built(self, flags: tuple[str, ...], folder: Path, text: str = "") -> ctypes.CDLL:
        """A library of its march, or of another `text`."""
        (folder / "every.h").write_text(self.made["every.h"])
        (folder / "every.c").write_text(text or self.made["every.c"])
        compiler().run([*flags, "-fPIC", "-shared", "every.c", "-o", "made.so", "-lm"], folder)
        return ctypes.CDLL(str(folder / "made.so"))


@cache
def chain(precision: str) -> Chain:
    """In a precision."""
    of = every(2, tolerance="0.5")
    model = lower(of)
    made = make(model, Request(evaluator="march", precision=precision))
    taus = asked(model, REALS[precision], 8)
    kind = np.float32 if precision == "single" else np.float64
    return Chain(of, written.files(made, "all"), made, taus.astype(kind), exact(model, taus))


def evaluated(library: ctypes.CDLL, of: Scene, taus: np.ndarray) -> np.ndarray:
    """All outputs, each tau by itself."""
    evaluate = getattr(library, f"{of.name}_eval")
    evaluate.argtypes = [ctypes.c_float if taus.dtype == np.float32 else ctypes.c_double, ctypes.c_void_p]
    out = np.empty((len(taus), len(of.outputs)), taus.dtype)
    for tau, row in zip(taus.tolist(), out, strict=True):
        assert evaluate(tau, row.ctypes.data) == 0
    return out.T.astype(np.float64)


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("language", ["c99", "c++17"])
def test_it_is_strict_c_and_cpp(language: str, precision: str, tmp_path: Path) -> None:
    of = chain(precision)
    library = of.built((*LANGUAGES[language], *STRICT, "-O1"), tmp_path)
    assert hasattr(library, f"{of.scene.name}_eval")


# what compilers make of sizes that they can tell: no state, a body, a block, and named systems
FEW = {
    "none": ["fixed", {"rod": 2, "impedance": 40}, "absorbing"],
    "body": [{"mass": 2, "name": "body"}, {"rod": 2}, "fixed"],
    "block": [{"mass": 2, "spring": 1, "name": "body"}, {"rod": 2}, "fixed"],
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("states", [*FEW, *(pytest.param(name, marks=pytest.mark.slow) for name in SCENES)])
@pytest.mark.parametrize("level", ["-O3", "-O2", "-O1", "-O0", "-Os"])
def test_few_states_are_no_warning(level: str, states: str, tmp_path: Path) -> None:
    if states in FEW:
        load = [{"at": "body", "times": [0, "1/3"], "steps": [1, 2]}] if states != "none" else []
        made = scene({"type": "chain", "parts": FEW[states]}, load, 5, velocity=[1])
    else:
        made = SCENES[states]
    for file, text in files(lower(made), "c", evaluator="march").items():
        (tmp_path / file).write_text(text)
    compiler().run([*LANGUAGES["c99"], *STRICT, level, "-c", "made.c", "-o", "made.o"], tmp_path)
    assert (tmp_path / "made.o").stat().st_size > 0


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("build", "precision"), [("plain", "double"), ("contracted", "double"), ("contracted", "single")]
)
def test_it_is_within_its_bound(build: str, precision: str, tmp_path: Path) -> None:
    of = chain(precision)
    found = evaluated(of.built(BUILDS[build], tmp_path), of.scene, of.taus)
    allowed = np.array([output.bound * output.largest for output in of.program.outputs])
    assert np.all(np.max(np.abs(found - of.true), axis=1) <= allowed)
    assert json.loads(of.made["every.json"])["evaluator"] == "march"


def test_samples_are_values_whichever_way_they_go(tmp_path: Path) -> None:
    """Each window is marched through once, in constant memory; out of range is NaN, and said."""
    of = chain("double")
    library = of.built(FLAGS, tmp_path)
    sample = library.every_sample
    sample.argtypes = [ctypes.c_double, ctypes.c_double, ctypes.c_size_t, ctypes.c_void_p]
    for begin, apart in ((0.0, 1 / 8), (2.0, -1 / 8), (0.1, 0.3)):
        taus = begin + apart * np.arange(13)
        inside = (taus >= 0) & (taus <= 2)
        out = np.empty((9, 13))
        assert sample(begin, apart, 13, out.ctypes.data) == int(not inside.all())
        assert np.array_equal(out[:, inside], evaluated(library, of.scene, taus[inside]))
        assert np.isnan(out[:, ~inside]).all()
    assert sample(0.0, 1.0, 0, None) == 0


def test_numpy_computes_what_the_program_does() -> None:
    """The generated module, bit for bit."""
    of = chain("double")
    module = import_text(of.made["every.py"], "every")
    assert np.array_equal(module.evaluate(of.taus), of.program.evaluate(of.taus))
    assert np.isnan(module.evaluate([-1.0, np.nextafter(2, 3), np.nan])).all()
    assert module.evaluate(np.zeros((2, 0))).shape == (9, 2, 0)


def test_tables_are_declared_as_they_are_written() -> None:
    made = chain("double").made["every.c"]
    known = set(re.findall(r"^static const (int|real) (\w+)\[\]", made, re.MULTILINE))
    items = (item for paragraph in declarations("march/tables.h") for item in paragraph)
    assert known == {(item["type"], item["name"]) for item in items if item["table"]}
    assert not re.search(r"\b(name|NAME)_|tables\.h", made)


@needs_binutils
def test_it_allocates_nothing_and_exports_its_prefix(tmp_path: Path) -> None:
    chain("double").built(FLAGS, tmp_path)
    compiler().run(["-Os", "-c", "every.c", "-o", "every.o"], tmp_path)
    sizes = sections(tmp_path / "every.o")
    assert sizes[".text"] <= CODE_AT_MOST["march"]
    assert not {".data", ".bss"} & sizes.keys()
    listed = subprocess.run(["nm", "-g", "every.o"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    symbols = [line.split() for line in listed.splitlines()]
    exported = {name for *_, kind, name in symbols if kind != "U"}
    assert exported == {f"every_{name}" for name in ("eval", "output_name", "sample")}


BREAKS = {
    "a ring": ("const int turn = steps[number] + 1;", "const int turn = steps[number] + 2;"),
    "a body": ("return q[0] + (last_sum - rows[LOSS] * q[0]);", "return q[0] + last_sum;"),
    "a block": ("x[k] += velocities[count + k];", "x[k] += 2 * velocities[count + k];"),
    "a scatterer": (
        "add(on->sent[other], *factor++, on->arriving[port], SIZE);",
        "add(on->sent[other], -*factor++, on->arriving[port], SIZE);",
    ),
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("what", BREAKS)
def test_what_is_broken_is_seen(what: str, tmp_path: Path) -> None:
    of, (right, wrong) = chain("double"), BREAKS[what]
    assert right in of.made["every.c"]
    library = of.built(FLAGS, tmp_path, of.made["every.c"].replace(right, wrong))
    assert not np.max(np.abs(evaluated(library, of.scene, of.taus) - of.true)) <= 1e-3
