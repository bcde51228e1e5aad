"""Numbers of modes that are given at run time, as C: against modes that are proved and against those in NumPy."""

import ctypes
import subprocess
from dataclasses import replace

import numpy as np
import pytest

import wavesym
from tests.programs.test_mode_sets import MODELS
from tests.running.test_model_modes import FRAME, SPRUNG
from tests.support.builds import LANGUAGES, STRICT
from tests.support.fmus import Instance, made, needs_fmpy
from wavesym.errors import UnservedError, WavesymError
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.mode_sets.making import ModeSetsTables
from wavesym.programs.mode_sets.parameters import mode_parameters, names_of
from wavesym.programs.modes.evaluator import modes
from wavesym.programs.request import Request
from wavesym.running.compiled_modes import CompiledModeSets
from wavesym.running.mode_sets import ModalSets
from wavesym.running.native import library
from wavesym.running.toolchain import compiler
from wavesym.scene import lower
from wavesym.targets.files import files

RNG = np.random.default_rng(2028)
NUMBERS = ["stiffness", "rod_mass", "mass", "damping", "load"]
RAYLEIGH = wavesym.Scene(
    **{**FRAME.model_dump(), "system": {**FRAME.model_dump()["system"], "damping": {"modes": [1, 2], "ratio": "1/20"}}}
)


def parameters_of(model):
    return mode_parameters(model, names_of(model), ())


def drawn_rows(parameters, sets, wide=0.3):
    """The model's own numbers first, then some with each of them changed."""
    own = np.array([float(value) for field in parameters.fields for value in field.values])
    rows = np.tile(own, (sets, 1))
    rows[1:] *= RNG.uniform(1 - wide, 1 + wide, (sets - 1, len(own)))
    return rows


@pytest.mark.parametrize("name", MODELS)
def test_sets_are_what_proved_modes_say(name):
    """For chains of all kinds: held, free, with gears, springs and branches, damped or not."""
    parameters = parameters_of(MODELS[name])
    rows, taus = drawn_rows(parameters, 3), np.linspace(0, parameters.model.horizon(), 83)
    found = CompiledModeSets(parameters).responses(rows, taus[::-1].copy())
    for row, estimate, peaks, values in zip(rows, *found, strict=True):
        proved = modes(parameters.exact(row), DOUBLE)
        largest = np.array([output.largest for output in proved.outputs])
        error = np.abs(values[:, ::-1] - proved.scheme.evaluate(taus)).max(axis=1)
        allowed = (estimate + np.array([output.bound for output in proved.outputs])) * np.abs(peaks[:, ::2]).max(axis=1)
        assert np.all(error <= 1.01 * allowed + 1e-12 * largest)
        fine = np.linspace(0, parameters.model.horizon(), 4001)
        exact = proved.scheme.evaluate(fine)
        assert np.all(peaks[:, 0] <= exact.min(axis=1) + allowed)
        assert np.all(peaks[:, 2] >= exact.max(axis=1) - allowed)


@pytest.mark.parametrize("scene", [SPRUNG, FRAME, RAYLEIGH], ids=["sprung", "frame", "rayleigh"])
def test_sets_are_those_of_numpy(scene):
    """With the same modes: values to rounding, extremes and their instants, estimates."""
    lowered = lower(scene)
    parameters = parameters_of(lowered)
    rows = drawn_rows(parameters, 5)
    taus = np.linspace(0, lowered.horizon(), 61)
    found = CompiledModeSets(parameters).responses(rows, taus)
    assert found.estimate.max() < 1
    for row, each in ModalSets(parameters).responses(rows, taus):
        if each.modes != parameters.fewest:
            continue
        size = np.abs(each.values[0]).max(axis=1)
        assert np.abs(found.values[row] - each.histories[0]).max(axis=1) == pytest.approx(
            0 * size, abs=1e-11 * size.max()
        )
        assert np.all(np.abs(found.peaks[row, :, ::2] - each.values[0]) <= 1e-7 * size[:, None])
        assert found.estimate[row] == pytest.approx(each.bounds[0], rel=0.1)


def test_many_sets_are_computed_in_c_and_are_the_same(monkeypatch):
    """Those whose modes are too few for the tolerance are taken by NumPy."""
    model = wavesym.model(FRAME, NUMBERS)
    own = model.parameters["stiffness"]
    stiffness = own * RNG.uniform(0.5, 2, (256, len(own)))
    stiffness[7] = own / 400
    many = model.peaks(stiffness=stiffness)
    monkeypatch.setattr("wavesym.running.mode_sets._WORTH_COMPILING", 10**9)
    few = wavesym.model(FRAME, NUMBERS).peaks(stiffness=stiffness[:16])
    size = np.maximum(np.abs(few.max), np.abs(few.min))
    assert np.all(
        np.abs(many.max[:16] - few.max) <= (many.checks.estimate[:16, None] + few.checks.estimate[:, None]) * size
    )
    assert np.all(many.checks.estimate[:16] <= 1e-4)
    assert np.all(many.checks.status == 0)


def runtime_of(scene):
    return (*names_of(lower(scene)), "load")


def program_files(scene, **options):
    from wavesym.api.programs import program

    return files(program(scene, Request.checked(**{"runtime": runtime_of(scene), **options}), tested=True))


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize(
    "options", [{"parts": ("peaks",)}, {"stream": True, "runtime": ("stiffness",)}], ids=["read", "stream"]
)
def test_it_compiles_without_warnings(tmp_path, language, options):
    for name, text in program_files(FRAME, **options).items():
        (tmp_path / name).write_text(text)
    compiler().run([*LANGUAGES[language], *STRICT, "-c", "frame.c", "-o", "frame.o"], tmp_path)
    assert (tmp_path / "frame.o").stat().st_size > 0


@pytest.mark.parametrize("scene", [SPRUNG, FRAME, RAYLEIGH], ids=["sprung", "frame", "rayleigh"])
def test_its_selftest_passes(tmp_path, scene):
    name = scene.name
    for file, text in program_files(scene).items():
        (tmp_path / file).write_text(text)
    compiler().run(["-std=c99", "-O1", f"{name}.c", f"{name}_selftest.c", "-o", "selftest", "-lm"], tmp_path)
    assert subprocess.run([tmp_path / "selftest"], check=False).returncode == 0


def loaded(scene, **options):
    texts = program_files(scene, **options)
    header = f"{scene.name}.h"
    found = library(texts[f"{scene.name}.c"], header=(header, texts[header]))
    getattr(found, f"{scene.name}_error_estimate").restype = ctypes.c_double
    return found


def test_bad_numbers_are_refused_and_too_few_modes_told():
    frame, model = loaded(FRAME, parts=("peaks",)), wavesym.model(FRAME, NUMBERS)
    own = np.concatenate([model.parameters[name] for name in NUMBERS])
    room, out = np.zeros(1 << 20, np.uint8), np.zeros((len(model.outputs), 4))
    of, place = room.ctypes.data_as(ctypes.c_void_p), out.ctypes.data_as(ctypes.c_void_p)
    at = dict(zip(NUMBERS, np.cumsum([0, *(len(model.parameters[name]) for name in NUMBERS[:-1])]), strict=True))
    for name, value, status in (
        ("stiffness", 0.0, 1),
        ("mass", -1.0, 1),
        ("rod_mass", np.nan, 1),
        ("damping", -0.1, 1),
        ("damping", 0.0, 2),
        ("load", np.inf, 1),
        ("load", -2.0, 0),
        ("stiffness", own[0] / 1e4, 2),
    ):
        row = own.copy()
        row[at[name]] = value
        assert frame.frame_build(of, row.ctypes.data_as(ctypes.c_void_p)) == status, (name, value)
        assert frame.frame_model_peaks(of, place) == (status == 1)
        assert np.isnan(out).any() == (status == 1)
        assert np.isnan(frame.frame_error_estimate(of)) == (status == 1)


@pytest.mark.parametrize("scene", [SPRUNG, FRAME], ids=["sprung", "frame"])
def test_a_stream_of_the_scenes_loads_gives_its_histories(scene):
    """Samples in the units that the header names."""
    from wavesym.api.programs import program

    request = Request.checked(runtime=names_of(lower(scene)), stream=True)
    streamed = program(scene, request)
    texts = files(streamed)
    header = f"{scene.name}.h"
    found = library(texts[f"{scene.name}.c"], header=(header, texts[header]))
    lowered = lower(scene)
    parameters = parameters_of(lowered)
    row = drawn_rows(parameters, 2)[1]
    tables = ModeSetsTables(parameters, streamed=True)
    spacing, samples = (
        float(tables.amplitudes.step),
        tables.amplitudes.samples * [float(size) for size, _ in tables._inputs],
    )
    room, out = np.zeros(1 << 20, np.uint8), np.zeros(len(lowered.probes))
    state, place = room.ctypes.data_as(ctypes.c_void_p), out.ctypes.data_as(ctypes.c_void_p)
    step = getattr(found, f"{scene.name}_step")
    step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p]
    assert getattr(found, f"{scene.name}_build")(state, row.ctypes.data_as(ctypes.c_void_p)) == 0
    count = int(lowered.horizon() / spacing)
    taus = spacing * np.arange(1, count + 1)
    expected = CompiledModeSets(parameters).responses(row[None], taus[taus <= lowered.horizon()]).values[0].T
    size = np.abs(expected).max(axis=0)
    for values, load in zip(expected, samples[1:], strict=False):
        now = np.ascontiguousarray(load)
        assert step(state, spacing, now.ctypes.data, place) == 0
        assert np.all(np.abs(out - values) <= 1e-11 * size)
    assert step(state, 2 * spacing, now.ctypes.data, place) == 1
    assert np.isnan(out).all()


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"parts": ("gradients",)}, UnservedError, "--with: gradients is not supported by modes at run time"),
        ({"precision": "single"}, WavesymError, "--precision: single does not go with --runtime of modes"),
        ({"stream": True, "evaluator": "modes"}, WavesymError, "--runtime: load is no parameter of a stream"),
        ({"evaluator": "march"}, WavesymError, "--evaluator: march does not go with --runtime of modes"),
    ],
)
def test_what_modes_do_not_have_is_refused(options, error, message):
    with pytest.raises(error, match=message):
        program_files(FRAME, **options)


def test_the_same_modes_serve_a_finer_tolerance():
    """Values differ from those of a tolerance a hundredth by no more than the estimate."""
    coarse = parameters_of(lower(FRAME))
    fine = parameters_of(replace(coarse.model, tolerance=coarse.model.tolerance / 100))
    rows, taus = drawn_rows(coarse, 4), np.linspace(0, coarse.model.horizon(), 301)
    one, other = (CompiledModeSets(each).responses(rows, taus) for each in (coarse, fine))
    size = np.abs(other.values).max(axis=2)
    errors = np.abs(one.values - other.values).max(axis=2) / size
    assert np.all(errors <= 1.1 * one.estimate[:, None])
    assert errors.max() > 1e-4 * one.estimate.max()  # and is no fantasy


@needs_fmpy
@pytest.mark.slow
def test_an_fmu_takes_the_numbers_of_modes(tmp_path):
    """A frame that is shaken by its record, with another stiffness and damping."""
    path = made(FRAME, tmp_path, "fmu3", runtime=("stiffness", "damping"))
    instance = Instance(path, tmp_path / "extracted").begin({"stiffness_bar_1": 4.5e8, "damping_1": 0.02})
    names, spacing = [probe.name for probe in lower(FRAME).probes], 0.1
    samples = [0.25, -0.3, 0.2, -0.1, 0, *[0] * 20]
    found = []
    for k, sample in enumerate(samples):
        instance.put({"load@0": sample * 9.80665})
        instance.step(spacing * k, spacing)
        found.append(instance.get(names))
    model = wavesym.model(FRAME, ["stiffness", "damping"])
    own = model.parameters["stiffness"].copy()
    own[1] = 4.5e8
    expected = model.run(times=spacing * np.arange(1, 26), stiffness=own, damping=[0.02]).values[0].T
    size = np.abs(expected).max(axis=0)
    assert np.all(np.abs(np.array(found) - expected) <= 1e-4 * size)
    instance.end()
