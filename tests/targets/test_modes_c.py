"""A stream in C: it takes samples one by one, gives what NumPy gives, and its self-test sees what is broken."""

import ctypes
import json
import os
import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from flint import fmpq

from tests.support.assembly import exact
from tests.support.builds import LANGUAGES, STRICT
from tests.support.oscillators import evaluator, oscillators, storeys, uniform
from wavesym.mechanics.probe import Probe
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.program import Provenance
from wavesym.running.toolchain import compiler
from wavesym.scene import Scene, lower
from wavesym.targets.files import files

REALS = {"double": DOUBLE, "single": SINGLE}
SAMPLES = [exact((5 * k * k + k) % 23 - 11) / 7 for k in range(1, 90)]
MODEL = lower(Scene.from_toml("drive_m1"))  # for names in headers
NAME = MODEL.name
NEWTONS = -1.5  # of a load of 1


def written(made, folder, proved=True):
    """The files of an evaluator, self-test included."""
    model = MODEL.watching([Probe(output.name, "displacement", 1, fmpq(0)) for output in made.outputs])
    program = replace(made.program(Provenance(model, made.summary)), reference=made.reference(model), proved=proved)
    for file, text in files(program, "all").items():
        (folder / file).write_text(text)
    return program


def selftest(folder, *flags):
    compiler().run(
        [*LANGUAGES["c99"], *STRICT, "-O2", *flags, f"{NAME}.c", f"{NAME}_selftest.c", "-o", "test", "-lm"], folder
    )
    return subprocess.run([folder / "test"], capture_output=True, check=False).returncode


class Stream:
    """A compiled stream: one sample of each load in, all outputs out."""

    def __init__(self, folder, program, *flags):
        compiler().run(
            [*LANGUAGES["c99"], *STRICT, "-O2", *flags, "-fPIC", "-shared", f"{NAME}.c", "-o", "made.so"], folder
        )
        library = ctypes.CDLL(str(folder / "made.so"))
        self.dtype = np.dtype(f"f{program.real.bytes}")
        real = ctypes.c_double if program.real is DOUBLE else ctypes.c_float
        self.init, self._step = (getattr(library, f"{NAME}_{word}") for word in ("init", "step"))
        self._step.argtypes = [ctypes.c_void_p, real, ctypes.c_void_p, ctypes.c_void_p]
        loads, modes = (int(program.constants[name]) for name in ("loads", "modes"))
        self.state = np.full(2 * modes + 3 * loads, np.nan, self.dtype)
        self.spacing, self._outputs = program.constants["spacing"], len(program.outputs)
        self.init(self.state.ctypes.data_as(ctypes.c_void_p))

    def step(self, loads, spacing=None):
        given, out = np.array(loads) * [NEWTONS, *[1] * (len(loads) - 1)], np.empty(self._outputs, self.dtype)
        given = given.astype(self.dtype)
        status = self._step(self.state.ctypes.data, spacing or self.spacing, given.ctypes.data, out.ctypes.data)
        return status, out


@pytest.mark.quick(1)
@pytest.mark.parametrize("precision", REALS)
def test_a_stream_gives_what_numpy_gives(precision, tmp_path):
    system, real = storeys(4, 5, 0.03), REALS[precision]
    made = evaluator(system, uniform([0, *SAMPLES], fmpq(5, 3)), 148.0, real)
    program = written(made, tmp_path)
    assert selftest(tmp_path) == 0
    stream = Stream(tmp_path, program)
    found = np.array([stream.step([float(sample)])[1] for sample in SAMPLES[:88]]).T
    right = program.evaluate([float(time) for time in made.loads.times[1:89]])
    allowed = 2 * made.rounding.errors[:, None]
    assert np.all(np.abs(found - right) <= allowed)
    assert np.all(np.abs(right).max(axis=1) > 100 * allowed[:, 0])


def test_a_stream_takes_loads_of_all_kinds_to_oscillators_of_all_kinds(tmp_path):
    """Rigid motion, damping on both sides of 1; outputs of displacements alone, of velocities, of loads."""
    system = oscillators([0, 0, 0.3, 1, 1, 4, 9], [0, 0.2, 1, 0.1, 1.7, 0, 0.5], loads=2, outputs=3)
    moved, moving = system.displacement_weights * [[1], [0], [0]], system.velocity_weights * [[0], [1], [0]]
    system = replace(system, displacement_weights=moved, velocity_weights=moving)
    times = tuple(fmpq(k, 2) for k in range(60))
    rows = [(fmpq(0), fmpq(0)), *zip(SAMPLES, SAMPLES[::-1], strict=True)][:60]
    made = evaluator(system, LinearLoads(times, tuple(rows), (fmpq(0), fmpq(0))), 29.5)
    program = written(made, tmp_path)
    assert selftest(tmp_path) == 0
    stream = Stream(tmp_path, program)
    found = np.array([stream.step([float(a) for a in row])[1] for row in rows[1:]]).T
    right = program.evaluate([float(time) for time in times[1:]])
    assert np.all(np.abs(found - right) <= 2 * made.rounding.errors[:, None])


def test_what_a_stream_refuses_changes_nothing(tmp_path):
    made = evaluator(storeys(2, 3, 0.05), uniform([0, *SAMPLES], fmpq(1)), 80.0)
    stream = Stream(tmp_path, written(made, tmp_path))
    stream.step([1.0])
    before = stream.state.copy()
    for load, spacing in ((1.0, 2.0), (1.0, 1 - 1e-12), (1.0, np.nan), (np.nan, None), (np.inf, None)):
        status, out = stream.step([load], spacing)
        assert status == 1
        assert np.isnan(out).all()
        assert np.array_equal(stream.state, before)
    assert stream.step([1.0], 1 - 2.0**-53)[0] == 0
    told = [stream.step([10.0**power]) for power in range(280, 309)]  # too much, in the end
    assert {status for status, _ in told} == {0, 2}
    assert all((status == 2) == (not np.isfinite(out).all()) for status, out in told)


@pytest.mark.quick(1)
@pytest.mark.parametrize("precision", REALS)
def test_a_stream_is_strict_cpp_too(precision, tmp_path):
    written(evaluator(storeys(2, 3, 0.05), uniform([0, 1], fmpq(1)), 9.0, REALS[precision]), tmp_path)
    for file in (f"{NAME}.c", f"{NAME}_selftest.c"):
        compiler().run([*LANGUAGES["c++17"], *STRICT, "-c", file, "-o", f"{file}.o"], tmp_path)
        assert (tmp_path / f"{file}.o").stat().st_size > 0


BREAKS = {
    "a turn": ("p21[n] * y +", "p21[n] * y -"),
    "the load at the start": ("y0[n] * before", "y0[n] * now"),
    "the load at the end": ("v1[n] * now", "v0[n] * now"),
    "an integral": ("(before + now) / 2", "now"),
    "a double integral": ("(2 * before + now) / 6", "(before + now) / 4"),
    "a load forgotten": ("state->load[j] = now;", ""),
    "a row": ("out[row[first + lane]] += sum[lane]", "out[row[first]] += sum[lane]"),
    "an init": ("state->twice[j] = 0;", ""),
    "a step taken": ("dtau <= longest", "dtau <= 3 * longest"),
    "a load taken": ("return x - x == 0", "return 1"),
}


@pytest.mark.quick(2)
@pytest.mark.parametrize("fault", BREAKS)
def test_a_broken_stream_is_seen_by_its_selftest(fault, tmp_path):
    written(evaluator(storeys(3, 3, 0.05), uniform([0, *SAMPLES], fmpq(1)), 80.0), tmp_path)
    source = tmp_path / f"{NAME}.c"
    right, wrong = BREAKS[fault]
    assert source.read_text().count(right) == 1
    source.write_text(source.read_text().replace(right, wrong))
    assert selftest(tmp_path, "-Wno-unused-parameter", "-Wno-unused-variable") != 0


@pytest.mark.slow
def test_a_number_that_is_off_is_seen_by_the_selftest(tmp_path):
    """Of every table, in a relative 1e-9."""
    written(evaluator(storeys(3, 3, 0.05), uniform([0, *SAMPLES], fmpq(1)), 80.0), tmp_path)
    source = tmp_path / f"{NAME}.c"
    text = source.read_text()
    assert selftest(tmp_path) == 0
    for name in ("p11", "one1", "speed0", "moving_weight", "load_weight"):
        table = re.search(rf"real {name}\[\] = {{\n(.*?)}};", text, re.DOTALL)
        number = max(re.findall(r"[-\d.e]+", table[1]), key=lambda each: abs(float(each)))
        off = table[0].replace(number, repr(float(number) * (1 + 1e-9)), 1)
        source.write_text(text.replace(table[0], off))
        assert selftest(tmp_path) != 0, name


def test_a_stream_says_what_it_is(tmp_path):
    made = evaluator(storeys(2, 3, 0.05), uniform([0, 1, 0], fmpq(1, 4)), 9.0)
    written(made, tmp_path)
    header = (tmp_path / f"{NAME}.h").read_text()
    assert "_eval(" not in header
    assert "_sample(" not in header
    assert f"#define {NAME.upper()}_SPACING 0.25" in header
    assert "from 0 to the first sample" in header
    assert f"{NAME.upper()}_LOAD_LOAD0 = 0 /* load0 [N] */" in header
    assert "Proved: largest error" in header
    manifest = json.loads((tmp_path / f"{NAME}.json").read_text())
    assert (manifest["evaluator"], manifest["spacing"], manifest["loads"]) == ("modes", 0.25, ["load0 [N]"])
    assert "proved" not in manifest
    written(made, tmp_path, proved=False)
    for file in (f"{NAME}.h", f"{NAME}.py"):
        assert "proved" not in (tmp_path / file).read_text().lower()
    assert json.loads((tmp_path / f"{NAME}.json").read_text())["proved"] is False


SHAKEN = """
name = "shaken"
system = { type = "building", m = 3, kappa = ["1/4", "1/5", "1/6", 1], base = "ground", damping = [0.05, "120 %"] }
load = [{ spacing = "7/3", samples = [0, 1, -2, 0.5] }]
output = { until = 30, tolerance = 1e-4, strain = [0], acceleration = [3] }
"""
OTHER = {"PYTHONHASHSEED": "2", "NPY_DISABLE_CPU_FEATURES": "AVX512F AVX512_SKX", "OPENBLAS_CORETYPE": "Haswell"}


@pytest.mark.slow
def test_a_stream_has_the_same_bytes_on_other_processors(tmp_path):
    (tmp_path / "shaken.toml").write_text(SHAKEN)
    for folder, others in (("one", {"PYTHONHASHSEED": "1"}), ("other", OTHER)):
        command = [sys.executable, "-m", "wavesym", "generate", "shaken.toml", "-o", folder, "--language", "all"]
        subprocess.run(command, cwd=tmp_path, env=os.environ | others, check=True, capture_output=True)
    made = sorted((tmp_path / "one").iterdir())
    assert len(made) == 5
    for file in made:
        assert file.read_bytes() == (tmp_path / "other" / file.name).read_bytes(), file.name
