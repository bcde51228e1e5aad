"""The march of a chain as C: strict, its tables as declared, and within its bound however it is built."""

from __future__ import annotations

import ctypes
import json
import re
from pathlib import Path

import numpy as np
import pytest

from tests.support.builds import LANGUAGES, STRICT, needs_binutils, sections
from tests.support.drives import drive, every, exact, instants
from tests.support.generated import files
from wavesym.numbers.reals import REALS
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.running.compiled import FLAGS, imported
from wavesym.running.toolchain import compiler
from wavesym.scene import Scene, lower
from wavesym.targets.manifest import CODE_AT_MOST

C = Path(__file__).parents[2] / "templates" / "c"
BUILDS = {"plain": ("-std=c99", "-O0"), "contracted": (*FLAGS, "-march=native", "-ffp-contract=fast")}


def built(scene: Scene, precision: str, flags: tuple[str, ...], folder: Path) -> ctypes.CDLL:
    """A library of a scene's march."""
    made = files(lower(scene), "c", "march", precision)
    for file, text in made.items():
        (folder / file).write_text(text)
    compiler().run([*flags, "-fPIC", "-shared", f"{scene.name}.c", "-o", "made.so", "-lm"], folder)
    return ctypes.CDLL(str(folder / "made.so"))


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
    scene = every(2, tolerance="0.5")
    built(scene, precision, (*LANGUAGES[language], *STRICT, "-O1"), tmp_path)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("flags", BUILDS.values(), ids=BUILDS)
def test_it_is_within_its_bound(flags: tuple[str, ...], precision: str, tmp_path: Path) -> None:
    scene = every(2, tolerance="0.5")
    model = lower(scene)
    taus = instants(model, 8)
    if precision == "single":
        taus = np.unique(taus.astype(np.float32))
        taus = taus[taus <= model.horizon(REALS["single"])]
    found = evaluated(built(scene, precision, flags, tmp_path), scene, taus)
    true = exact(model, taus.astype(np.float64))
    told = json.loads((tmp_path / "every.json").read_text())
    assert told["evaluator"] == "march"
    made = make(model, Request(evaluator="march", precision=precision))
    allowed = np.array([output.bound * output.largest for output in made.outputs])
    assert np.all(np.max(np.abs(found - true), axis=1) <= allowed)


def test_samples_are_values_whichever_way_they_go(tmp_path: Path) -> None:
    """Each window is marched through once, in constant memory; out of range is NaN, and said."""
    scene = drive(9)
    library = built(scene, "double", FLAGS, tmp_path)
    sample = library.drive_sample
    sample.argtypes = [ctypes.c_double, ctypes.c_double, ctypes.c_size_t, ctypes.c_void_p]
    for begin, apart in ((0.0, 0.25), (9.0, -0.25), (0.1, 0.7)):
        taus = begin + apart * np.arange(13)
        inside = (taus >= 0) & (taus <= 9)
        out = np.empty((5, 13))
        assert sample(begin, apart, 13, out.ctypes.data) == int(not inside.all())
        assert np.array_equal(out[:, inside], evaluated(library, scene, taus[inside]))
        assert np.isnan(out[:, ~inside]).all()
    assert sample(0.0, 1.0, 0, None) == 0


def test_numpy_computes_what_the_program_does() -> None:
    """The generated module, bit for bit; and C to a few bits."""
    model = lower(every(2, tolerance="0.5"))
    made = files(model, "all", "march")
    module = imported(made["every.py"], "every")
    taus = instants(model)
    program = make(model, Request(evaluator="march"))
    assert np.array_equal(module.evaluate(taus), program.evaluate(taus))
    assert np.isnan(module.evaluate([-1.0, np.nextafter(2, 3), np.nan])).all()
    assert module.evaluate(np.zeros((2, 0))).shape == (9, 2, 0)


def test_tables_are_declared_as_they_are_written() -> None:
    made = files(lower(every(2, tolerance="0.5")), "c", "march")["every.c"]
    written = set(re.findall(r"^static const (int|real) (\w+)\[\]", made, re.MULTILINE))
    declared = re.findall(r"^extern const (int|real) (\w+)\[\];", (C / "rings_tables.h").read_text(), re.MULTILINE)
    assert written == set(declared)
    assert not re.search(r"\b(name|NAME)_|_tables\.h", made)


@needs_binutils
def test_it_allocates_nothing_and_exports_its_prefix(tmp_path: Path) -> None:
    scene = every(2, tolerance="0.5")
    built(scene, "double", FLAGS, tmp_path)
    compiler().run(["-Os", "-c", "every.c", "-o", "every.o"], tmp_path)
    sizes = sections(tmp_path / "every.o")
    assert sizes[".text"] <= CODE_AT_MOST["rings"]
    assert not {".data", ".bss"} & sizes.keys()


def test_a_broken_ring_is_seen(tmp_path: Path) -> None:
    """One window less in every ring: what arrives is what has just been sent over it."""
    scene = every(2, tolerance="0.5")
    model = lower(scene)
    taus = instants(model, 8)
    made = files(model, "c", "march")
    right = "const int turn = steps[number] + 1;"
    assert right in made["every.c"]
    (tmp_path / "every.h").write_text(made["every.h"])
    (tmp_path / "every.c").write_text(made["every.c"].replace(right, "const int turn = steps[number] + 2;"))
    compiler().run([*FLAGS, "-fPIC", "-shared", "every.c", "-o", "made.so", "-lm"], tmp_path)
    found = evaluated(ctypes.CDLL(str(tmp_path / "made.so")), scene, taus)
    assert np.max(np.abs(found - exact(model, taus))) > 1e-3
