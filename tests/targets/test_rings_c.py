"""The march of a chain as C: strict, its tables as declared, and within its bound however it is built."""

from __future__ import annotations

import ctypes
import json
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tests.support.builds import LANGUAGES, STRICT, needs_binutils, sections
from tests.support.drives import every, exact, instants
from wavesym.programs.making import make
from wavesym.programs.program import Program
from wavesym.programs.request import Request
from wavesym.running.compiled import FLAGS, imported
from wavesym.running.toolchain import compiler
from wavesym.scene import Scene, lower
from wavesym.targets.files import files
from wavesym.targets.manifest import CODE_AT_MOST

C = Path(__file__).parents[2] / "templates" / "c"
BUILDS = {"plain": ("-std=c99", "-O0"), "contracted": (*FLAGS, "-march=native", "-ffp-contract=fast")}


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
    scene = every(2, tolerance="0.5")
    model = lower(scene)
    made = make(model, Request(evaluator="march", precision=precision))
    taus = instants(model, 8)
    if precision == "single":
        taus = np.unique(taus.astype(np.float32))
        taus = taus[taus <= made.tau_max]
    return Chain(scene, files(made, "all"), made, taus, exact(model, taus.astype(np.float64)))


def evaluated(library: ctypes.CDLL, scene: Scene, taus: np.ndarray) -> np.ndarray:
    """All outputs, each tau by itself."""
    evaluate = getattr(library, f"{scene.name}_eval")
    evaluate.argtypes = [ctypes.c_float if taus.dtype == np.float32 else ctypes.c_double, ctypes.c_void_p]
    out = np.empty((len(taus), len(scene.outputs)), taus.dtype)
    for tau, row in zip(taus.tolist(), out, strict=True):
        assert evaluate(tau, row.ctypes.data) == 0
    return out.T.astype(np.float64)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("language", ["c99", "c++17"])
def test_it_is_strict_c_and_cpp(language: str, precision: str, tmp_path: Path) -> None:
    of = chain(precision)
    library = of.built((*LANGUAGES[language], *STRICT, "-O1"), tmp_path)
    assert hasattr(library, f"{of.scene.name}_eval")


# what compilers make of sizes that they can tell: no state, and one
FEW_STATES = {
    "none": ["fixed", {"rod": 2, "impedance": 40}, "absorbing"],
    "one": [{"mass": 2, "name": "body"}, {"rod": 2}, "fixed"],
}


@pytest.mark.parametrize("states", FEW_STATES)
@pytest.mark.parametrize("level", ["-O0", "-O1", "-O2", "-O3", "-Os"])
def test_few_states_are_no_warning(level: str, states: str, tmp_path: Path) -> None:
    load = [{"at": "body", "times": [0, "1/3"], "steps": [1, 2]}] if states == "one" else []
    system = {"type": "chain", "parts": FEW_STATES[states]}
    scene = Scene(name="few", system=system, load=load, output={"until": 5, "tolerance": 1e-6, "velocity": [1]})
    for file, text in files(make(lower(scene), Request(evaluator="march")), "c").items():
        (tmp_path / file).write_text(text)
    compiler().run([*LANGUAGES["c99"], *STRICT, level, "-c", "few.c", "-o", "few.o"], tmp_path)
    assert (tmp_path / "few.o").stat().st_size > 0


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
    """The generated module, bit for bit; and C to a few bits."""
    of = chain("double")
    module = imported(of.made["every.py"], "every")
    assert np.array_equal(module.evaluate(of.taus), of.program.evaluate(of.taus))
    assert np.isnan(module.evaluate([-1.0, np.nextafter(2, 3), np.nan])).all()
    assert module.evaluate(np.zeros((2, 0))).shape == (9, 2, 0)


def test_tables_are_declared_as_they_are_written() -> None:
    made = chain("double").made["every.c"]
    written = set(re.findall(r"^static const (int|real) (\w+)\[\]", made, re.MULTILINE))
    declared = re.findall(r"^extern const (int|real) (\w+)\[\];", (C / "rings/tables.h").read_text(), re.MULTILINE)
    assert written == set(declared)
    assert not re.search(r"\b(name|NAME)_|tables\.h", made)


@needs_binutils
def test_it_allocates_nothing_and_exports_its_prefix(tmp_path: Path) -> None:
    chain("double").built(FLAGS, tmp_path)
    compiler().run(["-Os", "-c", "every.c", "-o", "every.o"], tmp_path)
    sizes = sections(tmp_path / "every.o")
    assert sizes[".text"] <= CODE_AT_MOST["rings"]
    assert not {".data", ".bss"} & sizes.keys()


def test_a_broken_ring_is_seen(tmp_path: Path) -> None:
    """One window too many in every ring: what is read is not what was written."""
    of, right = chain("double"), "const int turn = steps[number] + 1;"
    assert right in of.made["every.c"]
    library = of.built(FLAGS, tmp_path, of.made["every.c"].replace(right, "const int turn = steps[number] + 2;"))
    assert np.max(np.abs(evaluated(library, of.scene, of.taus) - of.true)) > 1e-3
