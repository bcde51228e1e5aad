"""Generated C built in many ways: what is built, how, and what the result is held against."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec

import numpy as np
import pytest

from tests.support.generated import files
from wavesym.exact.reference import Reference
from wavesym.numbers.doubles import midpoint
from wavesym.programs.choice import choose
from wavesym.running.toolchain import Compiler
from wavesym.scene import Scene, lower

needs_zig = pytest.mark.skipif(not find_spec("ziglang"), reason="no ziglang here; `make check-all` installs it")
needs_binutils = pytest.mark.skipif(not shutil.which("nm") or not shutil.which("size"), reason="no nm, no size here")

STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
EVALUATORS = ("closed", "pieces", "march")
PRECISIONS = ("double", "single")
SOURCES = [(evaluator, precision) for evaluator in EVALUATORS for precision in PRECISIONS]
LANGUAGES = {
    "c99": ("-std=c99", "-Wmissing-prototypes"),
    "c11": ("-std=c11", "-Wmissing-prototypes"),
    "c++17": ("-x", "c++", "-std=c++17"),
}


@dataclass(frozen=True)
class Source:
    """The files of a scene, and the true outputs at some tau: `allowed` is the printed bound of each, absolute."""

    name: str
    made: dict[str, str]
    real: type
    taus: np.ndarray
    true: np.ndarray
    allowed: np.ndarray

    def write(self, folder):
        for file, text in self.made.items():
            (folder / file).write_text(text)

    def missed(self, library):
        """By how much of what is allowed the outputs of a loaded library are wrong, at worst."""
        evaluate = getattr(library, f"{self.name}_eval")
        evaluate.argtypes = [self.real, ctypes.c_void_p]
        found = np.empty((len(self.taus), len(self.allowed)), dtype=self.real)
        for tau, row in zip(self.taus.tolist(), found, strict=True):
            assert evaluate(tau, row.ctypes.data) == 0
        return float(np.max(np.abs(found.T - self.true) / self.allowed[:, np.newaxis]))


def scene(name: str, tolerance: str, until: float = 6) -> Scene:
    """A building whose outputs jump, bend and grow."""
    return Scene(
        name=name,
        system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
        load=[{"times": [0, "1/3", "5/2"], "a": [1, 0, "-1/2"], "b": ["-1/4", "1/2", 0]}],
        output={
            "until": until,
            "tolerance": tolerance,
            "strain": ["1/3", "1+"],
            "velocity": [0, 2],
            "displacement": ["1/2", 1],
        },
    )


@cache
def source(evaluator: str, precision: str) -> Source:
    """What is generated for an evaluator in a precision."""
    name = f"{evaluator}_{precision}"
    made_from = scene(name, "1e-9" if precision == "double" else "1e-2")
    chosen = choose(lower(made_from), evaluator, precision).evaluator
    reference = Reference(lower(made_from))
    dtype = np.float64 if precision == "double" else np.float32
    places = [*np.random.default_rng(1).uniform(0, 6, 200), *range(7), *reference.breakpoints()]
    taus = np.unique(np.array(places, dtype=dtype))
    taus = taus[taus <= 6].astype(np.float64)
    largest = np.array([midpoint(size) for size in reference.largest()])
    return Source(
        name,
        files(lower(made_from), "c", evaluator, precision),
        ctypes.c_double if precision == "double" else ctypes.c_float,
        taus,
        np.array(reference.values(taus.tolist())),
        # the reference is rounded once
        (np.array([output.bound for output in chosen.outputs]) + 2.0**-52) * largest,
    )


def built(source: Source, compiler: Compiler, flags: tuple[str, ...], folder) -> float:
    """Build the library and the self-test with a compiler, run both; the largest error in its printed bound."""
    source.write(folder)
    library, selftest = f"{source.name}.so", f"{source.name}_selftest"
    compiler.run([*flags, "-fPIC", "-shared", f"{source.name}.c", "-o", library, "-lm"], folder)
    compiler.run([*flags, f"{source.name}.c", f"{source.name}_selftest.c", "-o", selftest, "-lm"], folder)
    told = subprocess.run([folder / selftest], capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stdout + told.stderr
    return source.missed(ctypes.CDLL(str(folder / library)))


def sections(path) -> dict[str, int]:
    """Sizes of the sections of an object file, in bytes; empty ones left out."""
    listed = subprocess.run(["size", "-A", os.fspath(path)], capture_output=True, text=True, check=True).stdout
    rows = (line.split() for line in listed.splitlines())
    return {words[0]: int(words[1]) for words in rows if len(words) == 3 and words[1].isdigit() and words[1] != "0"}
