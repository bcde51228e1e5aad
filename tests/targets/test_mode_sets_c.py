"""Numbers of modes that are given at run time, as C: against modes that are proved."""

import ctypes
import subprocess
from dataclasses import replace

import numpy as np
import pytest

import wavesym
from tests.programs.test_modal_systems import PUSH, UNDAMPED
from tests.running.test_model_modes import FRAME, SPRUNG
from tests.support.builds import LANGUAGES, STRICT
from tests.support.fmus import Instance, made, needs_fmpy
from tests.support.modal import building, chain, samples
from wavesym.errors import UnservedError, WavesymError
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.mode_sets.making import ModeSetsTables
from wavesym.programs.mode_sets.parameters import mode_parameters, names_of
from wavesym.programs.modes.evaluator import modes
from wavesym.programs.modes.undamped_modes import UndampedModes
from wavesym.programs.request import Request
from wavesym.running import mode_sets
from wavesym.running.mode_sets import ModalSets
from wavesym.running.native import address, library, struct_size
from wavesym.running.toolchain import compiler
from wavesym.scene import lower
from wavesym.targets.files import files

RNG = np.random.default_rng(2028)
NUMBERS = ["stiffness", "rod_mass", "mass", "damping", "load"]
RAYLEIGH = wavesym.Scene(
    **{**FRAME.model_dump(), "system": {**FRAME.model_dump()["system"], "damping": {"modes": [1, 2], "ratio": "1/20"}}}
)

FIXED = chain(
    ["fixed", {"rod": 1}, {"mass": 1, "name": "n"}, {"rod": 1}, {"mass": 1}, {"rod": 1}, "fixed"],
    [PUSH],
    tolerance="1e-3",
    strain=["0", "1-", "3-"],
    displacement=["n", "3/2"],
    until=6,
)
SPRINGS = chain(
    [
        {"motion": "acceleration", "name": "m"},
        {"spring": 3},
        {"mass": 1, "name": "n"},
        {"spring": 2},
        {"mass": 2},
        {"rod": "1/7", "impedance": 4},
        {"joint": True},
        {"rod": "1/5", "impedance": 2},
        {"mass": 1, "name": "top"},
    ],
    [{"at": "m", "times": [0, 1], "ramps": [1, -2]}],
    tolerance="1e-3",
    relative=["n", "top"],
    acceleration=["top"],
    velocity=["n"],
    until=9,
)
ALIKE = building(["1/20"] * 11, [samples(6)], until=40, tolerance="1e-2", drift=[1, 10], force=[0], acceleration=[10])
MODELS = {
    "springs and rods": SPRINGS,
    "nothing holds it": UNDAMPED["nothing holds it"],
    **UNDAMPED,
    "fixed at both ends": FIXED,
    "ten storeys alike": ALIKE,
}


def parameters_of(model):
    return mode_parameters(model, names_of(model), ())


def drawn_rows(parameters, sets, wide=0.3):
    """The model's own numbers first, then some with each of them changed."""
    own = np.array([float(value) for field in parameters.fields for value in field.values])
    rows = np.tile(own, (sets, 1))
    rows[1:] *= RNG.uniform(1 - wide, 1 + wide, (sets - 1, len(own)))
    return rows


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", MODELS)
def test_sets_are_what_proved_modes_say(name):
    """For chains of all kinds: held, free, with gears, springs and branches, damped or not."""
    parameters = parameters_of(MODELS[name])
    rows, taus = drawn_rows(parameters, 3), np.linspace(0, parameters.model.horizon(), 83)
    found = ModalSets(parameters).responses(rows, taus[::-1].copy())
    for row, _, estimate, _, peaks, values in zip(rows, *found, strict=True):
        proved = modes(parameters.exact(row), DOUBLE)
        largest = np.array([output.largest for output in proved.outputs])
        error = np.abs(values[:, ::-1] - proved.scheme.evaluate(taus)).max(axis=1)
        allowed = (estimate + np.array([output.bound for output in proved.outputs])) * np.abs(peaks[:, ::2]).max(axis=1)
        assert np.all(error <= 1.01 * allowed + 1e-12 * largest)
        fine = np.linspace(0, parameters.model.horizon(), 4001)
        exact = proved.scheme.evaluate(fine)
        assert np.all(peaks[:, 0] <= exact.min(axis=1) + allowed)
        assert np.all(peaks[:, 2] >= exact.max(axis=1) - allowed)


class BuiltModel:
    """What `build` writes of a set: NAME_model as templates/c/mode_sets/model.h has it, of doubles."""

    def __init__(self, parameters, row):
        name, engine = parameters.model.name, ModalSets(parameters)
        c, tables = engine._library(0), ModeSetsTables(parameters)
        room = np.zeros(struct_size(c, "model") // 8)
        given = np.ascontiguousarray(row)
        self.status = getattr(c, f"{name}_build")(room.ctypes.data_as(ctypes.c_void_p), ctypes.c_void_p(address(given)))
        modes, loads, filled = (tables._constants()[key] for key in ("modes", "loads", "filled"))
        rest = iter(room[1:])

        def take(*shape):
            return np.array([next(rest) for _ in range(int(np.prod(shape)))]).reshape(shape)

        self.estimate = take(1)[0]
        self.frequency, self.damping, self.shares = take(modes), take(modes), take(loads, modes)
        take(6 * modes)
        self.displacements, self.velocities = take(modes, filled), take(modes, filled)


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", MODELS)
def test_modes_in_doubles_are_the_proved_ones(name):
    """Frequencies, and what outputs and loads have of each mode, up to its sign."""
    parameters = parameters_of(MODELS[name])
    row = drawn_rows(parameters, 2)[1]
    built = BuiltModel(parameters, row)
    chain_of_row = UndampedModes(parameters.exact(row).to_horizon())
    true = chain_of_row.project(parameters.fewest)
    count = parameters.fewest
    w = true.w[:count, None]
    assert built.frequency[:count] == pytest.approx(true.w[:count], rel=1e-12, abs=1e-12)
    orders = np.array([output.order for output in chain_of_row.outputs])
    shares = built.shares[:, :count]
    outputs = np.where(
        orders == 1,
        built.velocities[:count, : len(orders)],
        built.displacements[:count, : len(orders)] / np.where((orders == 2) & (w > 0), -w * w, 1.0),
    ).T
    assert np.abs(np.abs(shares) - np.abs(true.shares[:, :count])).max() <= 1e-7 * np.abs(true.shares).max()
    signs = np.sign((shares * true.shares[:, :count]).sum(axis=0))
    outputs = np.where((orders[:, None] == 2) & (w.T == 0), signs * true.outputs[:, :count], outputs)  # rigid: not kept
    moved = ~np.array(parameters.zero_outputs)
    assert np.abs(signs * outputs - true.outputs[:, :count])[moved].max() <= 1e-7 * np.abs(true.outputs[moved]).max()


def test_no_frequency_is_lost_where_counting_passes_a_resonance_of_a_bar(monkeypatch):
    """Halving begins at multiples of pi over the delay of a bar, where its ends are held by what is beyond all digits:
    what is found is a zero of what the wave equation asks of this chain, also where products are contracted."""
    monkeypatch.setattr(mode_sets, "FAST", ("-O2", "-march=native", "-ffp-contract=fast"))
    parts = [{"motion": "acceleration", "name": "g"}, {"spring": "1/2"}, {"mass": 1, "name": "a"}, {"rod": "13/10"}]
    parts += [{"mass": 1}, {"spring": 2}, {"mass": "1/10"}]
    push = {"at": "g", "times": [0, 1], "ramps": [1, -2]}
    parameters = parameters_of(chain(parts, [push], tolerance="1e-1", relative=["a"], until=20))
    own = np.array([float(value) for field in parameters.fields for value in field.values])
    names = [field.name for field in parameters.fields for _ in field.values]

    def asked(w, row):
        given = {name: [x for x, other in zip(row, names, strict=True) if other == name] for name in names}
        (rod, first, last), (heavy,), (a, b, c) = given["stiffness"], given["rod_mass"], given["mass"]
        w, z = w[:, None] * [1 - 1e-10, 1 + 1e-10], np.sqrt(rod * heavy)
        x, left, tip = w * np.sqrt(heavy / rod), first - w**2 * a, last - w**2 * c
        right = -(w**2) * b * tip - last * w**2 * c  # times the tip, so that nothing has a pole
        sides, ends = left * right - (z * w) ** 2 * tip, left * tip + right
        return sides * np.sin(x) + z * w * np.cos(x) * ends

    for changed in own * RNG.uniform(0.999, 1.001, (12, len(own))):
        w = BuiltModel(parameters, changed).frequency[: parameters.fewest]
        assert np.all(np.diff(w) > 0)
        below, above = np.sign(asked(w, changed)).T
        assert np.all(below * above <= 0), changed


def test_equal_frequencies_are_known_to_be_loose():
    """Three branches alike have two modes in which the rest is still: which shapes doubles find is open."""
    arms = [[{"spring": 1}, {"mass": 1, "name": f"end_{name}"}] for name in "abc"]
    model = chain(
        ["fixed", {"spring": 1}, {"mass": 1, "name": "n"}],
        [{**PUSH, "at": "end_a"}],
        [{"from": "n", "name": name, "parts": arm} for name, arm in zip("abc", arms, strict=True)],
        displacement=["end_a", "end_b"],
        until=6,
    )
    parameters = parameters_of(model)
    own = np.array([[float(value) for field in parameters.fields for value in field.values]])
    assert ModalSets(parameters).responses(own, np.empty(0)).estimate[0] > 1e-3


def test_an_output_that_symmetry_alone_makes_0_is_not_0_for_all_sets():
    """In the middle of a chain pushed alike from both sides nothing moves, as long as both halves are alike."""
    push = {key: PUSH[key] for key in ("times", "ramps")}
    model = chain(
        [{"mass": 1, "name": "l"}, {"rod": 1}, {"mass": 1, "name": "n"}, {"rod": 1}, {"mass": 1, "name": "r"}],
        [{"at": "l", **push}, {"at": "r", **push, "ramps": [-x for x in PUSH["ramps"]]}],
        displacement=["n", "l"],
        until=6,
    )
    assert UndampedModes(model).zero_outputs == (True, False)
    assert parameters_of(model).zero_outputs == (False, False)


@pytest.mark.slow
def test_sets_that_need_more_modes_get_them():
    """A storey that is 400 times softer needs more modes than the scene has; the others stay what they are."""
    model = wavesym.model(FRAME, NUMBERS)
    own = model.parameters["stiffness"]
    stiffness = own * RNG.uniform(0.5, 2, (4, len(own)))
    few = model.peaks(stiffness=stiffness)
    stiffness[2] = own / 400
    many = model.peaks(stiffness=stiffness)
    assert np.all(many.checks.estimate <= 1e-4)
    assert np.array_equal(many.max[[0, 1, 3]], few.max[[0, 1, 3]])
    engine = model._engine
    row = np.concatenate([stiffness[2], *(model.parameters[name] for name in engine_names(engine)[1:])])
    assert engine._by_modes(0, row[None], np.empty(0)).estimate[0] > 1e-4
    proved = modes(engine.parameters.exact(row), DOUBLE)
    fine = proved.scheme.evaluate(np.linspace(0, model.tau_max, 4001))
    size = np.abs(fine).max(axis=1)
    assert np.all(np.abs(many.max[2] - fine.max(axis=1)) <= 1e-3 * size)


def engine_names(engine):
    return [field.name for field in engine.fields]


def runtime_of(scene):
    return (*names_of(lower(scene)), "load")


def program_files(scene, **options):
    from wavesym.api.programs import program

    return files(program(scene, Request.from_options(**{"runtime": runtime_of(scene), **options}), tested=True))


@pytest.mark.quick(1)
@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize(
    "options", [{"parts": ("peaks",)}, {"stream": True, "runtime": ("stiffness",)}], ids=["read", "stream"]
)
def test_it_compiles_without_warnings(tmp_path, language, options):
    for name, text in program_files(FRAME, **options).items():
        (tmp_path / name).write_text(text)
    compiler().run([*LANGUAGES[language], *STRICT, "-c", "frame.c", "-o", "frame.o"], tmp_path)
    assert (tmp_path / "frame.o").stat().st_size > 0


def selftest_status(folder, texts, scene):
    """What the self-test of a scene's files returns."""
    name = scene.name
    for file, text in texts.items():
        (folder / file).write_text(text)
    compiler().run(["-std=c99", "-O1", f"{name}.c", f"{name}_selftest.c", "-o", "selftest", "-lm"], folder)
    return subprocess.run([folder / "selftest"], check=False).returncode


@pytest.mark.quick(1)
@pytest.mark.parametrize("scene", [RAYLEIGH, SPRUNG, FRAME], ids=["rayleigh", "sprung", "frame"])
def test_its_selftest_passes(tmp_path, scene):
    assert selftest_status(tmp_path, program_files(scene), scene) == 0


STREAMS = pytest.mark.parametrize(
    "scene",
    [FRAME, pytest.param(RAYLEIGH, marks=pytest.mark.slow), pytest.param(SPRUNG, marks=pytest.mark.slow)],
    ids=["frame", "rayleigh", "sprung"],
)


@STREAMS
def test_the_selftest_of_a_stream_passes(tmp_path, scene):
    texts = program_files(scene, runtime=names_of(lower(scene)), stream=True)
    assert selftest_status(tmp_path, texts, scene) == 0


def test_the_selftest_of_a_stream_sees_a_step_that_is_wrong(tmp_path):
    """A load that acts as if it had been there all through a step."""
    texts = program_files(FRAME, runtime=("stiffness",), stream=True)
    held = "slope[j] = (now[j] - s->load[j]) / spacing;"
    assert texts["frame.c"].count(held) == 1
    texts["frame.c"] = texts["frame.c"].replace(held, "s->load[j] = now[j], slope[j] = 0;")
    assert selftest_status(tmp_path, texts, FRAME) == 1


def loaded(scene, **options):
    texts = program_files(scene, **options)
    header = f"{scene.name}.h"
    found = library(texts[f"{scene.name}.c"], mode_sets.FAST, (header, texts[header]))
    getattr(found, f"{scene.name}_error_estimate").restype = ctypes.c_double
    return found


SQUARES = """
#include "sprung.c"
int squares(const sprung_parameters *numbers, double *square, double *wrong);
int squares(const sprung_parameters *numbers, double *square, double *wrong)
{
    static model m;
    static projection p;
    damping_rule rule;
    const int read = find_model(&m, numbers, &p, &rule);
    for (int n = 0; n < FOUND; ++n) {
        square[n] = p.w[n] * p.w[n];
        wrong[n] = p.wrong[n];
    }
    return read ? ROWS : 0;
}
"""


def test_by_rounding_a_square_is_as_wrong_as_the_energy_of_its_mode(tmp_path):
    """Of a mode of mass 1 twice the energies of springs and of masses are w^2 each, as nothing else swings: also
    where one spring is far stiffer than the others, whose energy is what hardly stretches it."""
    for name, text in program_files(SPRUNG).items():
        (tmp_path / name).write_text(text)
    (tmp_path / "squares.c").write_text(SQUARES)
    compiler().run([*LANGUAGES["c99"], "-O0", "-fPIC", "-shared", "squares.c", "-o", "squares.so", "-lm"], tmp_path)
    squares = ctypes.CDLL(str(tmp_path / "squares.so")).squares
    given = wavesym.model(SPRUNG, runtime_of(SPRUNG)).parameters
    for stiff in (1.0, 50.0, 1e6):
        stiffness = np.array(given["stiffness"]) * [1, stiff, 1, 1]
        numbers = np.concatenate([stiffness if name == "stiffness" else given[name] for name in runtime_of(SPRUNG)])
        square, wrong = np.empty(4), np.empty(4)
        rows = squares(*(ctypes.c_void_p(array.ctypes.data) for array in (numbers, square, wrong)))
        assert rows == 4
        spring = np.diag(np.append(stiffness[:-1] + stiffness[1:], stiffness[-1]))
        spring -= np.diag(stiffness[1:], 1) + np.diag(stiffness[1:], -1)
        assert square == pytest.approx(np.linalg.eigvalsh(spring / 2), rel=1e-9)  # all masses are 2
        assert wrong == pytest.approx((4 * rows + 8) * 2.0**-52 * 2 * square, rel=1e-6)


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


@pytest.mark.slow
@pytest.mark.parametrize("scene", [SPRUNG, FRAME], ids=["sprung", "frame"])
def test_a_stream_of_the_scenes_loads_gives_its_histories(scene):
    """Samples in the units that the header names."""
    from wavesym.api.programs import program

    request = Request.from_options(runtime=names_of(lower(scene)), stream=True)
    streamed = program(scene, request)
    texts = files(streamed)
    header = f"{scene.name}.h"
    found = library(texts[f"{scene.name}.c"], mode_sets.FAST, (header, texts[header]))
    lowered = lower(scene)
    parameters = parameters_of(lowered)
    row = drawn_rows(parameters, 2)[1]
    tables = ModeSetsTables(parameters, streamed=True)
    spacing, samples = (
        float(tables.amplitudes.step),
        tables.amplitudes.samples * [float(given.size) for given in tables._inputs],
    )
    room, out = np.zeros(1 << 20, np.uint8), np.zeros(len(lowered.probes))
    state, place = room.ctypes.data_as(ctypes.c_void_p), out.ctypes.data_as(ctypes.c_void_p)
    step = getattr(found, f"{scene.name}_step")
    step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p]
    assert getattr(found, f"{scene.name}_build")(state, row.ctypes.data_as(ctypes.c_void_p)) == 0
    count = int(lowered.horizon() / spacing)
    taus = spacing * np.arange(1, count + 1)
    expected = ModalSets(parameters).responses(row[None], taus[taus <= lowered.horizon()]).values[0].T
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
        (
            {"parts": ("gradients",)},
            UnservedError,
            r"gradients is not supported by modes at run time \(write wavesym.model",
        ),
        ({"precision": "single"}, WavesymError, "--precision: single does not go with --runtime of modes"),
        ({"stream": True, "evaluator": "modes"}, WavesymError, "--runtime: load is no parameter of a stream"),
        ({"evaluator": "march"}, WavesymError, "--evaluator: march does not go with --runtime of modes"),
    ],
)
def test_what_modes_do_not_have_is_refused(options, error, message):
    with pytest.raises(error, match=message):
        program_files(FRAME, **options)


@pytest.mark.slow
def test_the_same_modes_serve_a_finer_tolerance():
    """Values differ from those of a tolerance a hundredth by no more than the estimate."""
    coarse = parameters_of(lower(FRAME))
    fine = parameters_of(replace(coarse.model, tolerance=coarse.model.tolerance / 100))
    rows, taus = drawn_rows(coarse, 4), np.linspace(0, coarse.model.horizon(), 301)
    one, other = (ModalSets(each).responses(rows, taus) for each in (coarse, fine))
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
