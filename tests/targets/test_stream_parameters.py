"""A stream whose parameters come when it starts: held against the exact values of the scene that has them."""

import re
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, reject, settings

import wavesym
from tests.running.test_model_units import CASES as WITH_UNITS
from tests.support.builds import LANGUAGES, STRICT
from tests.support.drives import EVERY, small
from tests.support.streamed import StreamModel, built, missed, run
from tests.targets.test_stream_c import CASES, GEARS, JUMPS, PANEL, loaded, selftest
from wavesym import api
from wavesym.errors import WavesymError
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.request import POSITIVE, Request
from wavesym.programs.runtime.network import NAMES as FIELDS
from wavesym.programs.stream.parameters import QUICKER
from wavesym.programs.stream.plan import inputs_of, stream_plan
from wavesym.programs.stream.tables import StreamTables
from wavesym.running.toolchain import at_hand
from wavesym.scene import lower
from wavesym.scene.lowering import sources as load_sources
from wavesym.targets.files import sources

DRIVEN = loaded(GEARS, [{"body": 1}, {"body": 2}], PANEL)
UNTIL, STEP = Fraction(5), Fraction(1, 29)
NAN = float("nan")
NAMES = ("kappa", "inertia")


def ran(model, scene, **given):
    """The stream under jumps at edges of panels, with parameters, and its largest error in the scene that has them."""
    found = run(model, [row[:] for row in JUMPS[: len(scene.load)]], PANEL, UNTIL, STEP, **given)
    return found, float(np.max(missed(found, scene)))


@pytest.fixture(scope="module")
def program():
    return api.program(DRIVEN, Request(stream=True, runtime=NAMES))


@pytest.fixture(scope="module")
def gears(program):
    return StreamModel(program)


@pytest.mark.quick(1)
@pytest.mark.parametrize("scene", ["building_m2", "geared_drive"])
def test_a_stream_is_the_same_in_whatever_memory_it_is_built(scene):
    model = lower(wavesym.Scene.from_toml(scene))
    names = ("kappa",) if scene == "building_m2" else ("mass", "impedance")
    one = StreamModel(api.program(wavesym.Scene.from_toml(scene), Request(stream=True, runtime=names)))
    found = []
    for byte in (0, 255):
        stream = one.start()
        stream.state[:] = byte
        numbers = np.array([nearest(value) for field in one.fields for value in field.values])
        assert one.built.call("build", stream.state, numbers) == 0
        loads = [1.0] * len(one.loads)
        found.append([stream.step(model.horizon() / 40, loads)[1].tolist() for _ in range(20)] + [stream.lost])
    assert found[0] == found[1]


def test_each_set_is_the_scene_that_has_it(gears):
    """The scene's own; others; and what is refused, which gives NaN and no other status until it is built anew."""
    assert ran(gears, DRIVEN)[1] < 1e-12
    given = {"kappa": [2, 1.5], "inertia": [0.5, 3, 0.75]}
    other = DRIVEN.with_({"system.kappa": [2, "3/2"], "system.inertia": ["1/2", 3, "3/4"]})
    found, error = ran(gears, other, **given)
    assert max(found.status) == 0
    assert error < 1e-12
    assert ran(gears, DRIVEN, **given)[1] > 1e-2
    bad = {1: ([-1, 1], [0, 1], [NAN, 1], [float("inf"), 1]), 2: ([100, 1], [1e300, 1], [1, 1e5])}
    for status, sets in bad.items():
        for kappa in sets:
            stream = gears.start(kappa=kappa)
            assert stream.refused == status
            code, out = stream.step(0.3, [1.0, 0.0])
            assert code == 2
            assert np.all(np.isnan(out))
    assert gears.start(kappa=[1e-300, 1]).refused == 0  # so heavy that nothing moves


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (["load"], "--runtime: load, but the inputs of a stream are its loads"),
        (["velocity"], "--runtime: velocity is unknown; write kappa, inertia or load"),
        (["kappa", "kappa"], "--runtime: kappa stands twice; write it once"),
    ],
)
def test_what_is_no_parameter_is_refused(names, said):
    with pytest.raises(WavesymError, match=said):
        api.program(DRIVEN, Request(stream=True, runtime=tuple(names)))


def test_without_parameters_nothing_is_computed():
    """The tables of a stream that takes none stay those that are proved, and its init returns nothing."""
    made = sources(api.program(DRIVEN, Request(stream=True)), "c")
    text = made["gears.c"] + made["gears.h"]
    assert "void gears_init(gears_state *state);" in text
    assert "static const real matrix[]" in text
    assert "gears_build" not in text
    assert "GEARS_ERROR_BOUND" in text


def test_with_parameters_nothing_is_said_to_be_bounded(program):
    text = sources(program, "c")["gears.h"]
    assert "ERROR_BOUND" not in text
    assert "int gears_build(gears_state *state, const gears_parameters *parameters);" in text


def test_the_tables_are_those_of_balls_but_for_rounding(gears, program):
    """What C computes of the scene's own parameters, beside what is computed in balls and rounded once."""
    model = replace(lower(DRIVEN), endless=True)
    plan = stream_plan(model, inputs_of(model, load_sources(DRIVEN)), DOUBLE, quicker=QUICKER)
    right = StreamTables(plan, int(program.constants["degree"]), DOUBLE).tables()
    begin = sum(len(functions) + 1 for functions in program.laws.functions.values())
    matrix = gears.start().state.view(float)[begin : begin + int(program.constants["answers"])]
    for n, (first, end) in enumerate(pairwise(program.tables["answer"])):
        own = np.array(right["matrix"][right["answer"][n] :][: end - first])
        assert np.max(np.abs(matrix[first:end] - own)) <= 2.0**-50 * np.max(np.abs(own))


def test_no_table_is_called_as_a_parameter_is(program):
    """Tables are macros in C, which would take its name from a field."""
    tables = re.findall(r"^#define (\w+) state->made\.", sources(program, "c")["gears.c"], re.M)
    assert {"drive", "gain", "matrix", "growth"} < set(tables)
    assert not {*tables} & {*POSITIVE, *FIELDS}


GROUND, *PARTS = EVERY["parts"]
RESTING = EVERY | {"parts": [GROUND | {"velocity": 0}, *PARTS]}
OTHERS = {
    "base force": ({"kappa": [0.5, 0.125, 2]}, {"system.kappa": ["1/2", "1/8", 2]}),
    "base moves": ({"kappa": [0.5, 0.125, 2]}, {"system.kappa": ["1/2", "1/8", 2]}),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", OTHERS)
def test_buildings(case):
    scene, (given, change) = loaded(*CASES[case], PANEL), OTHERS[case]
    model = built(scene, runtime=["kappa"])
    found, error = ran(model, scene.with_(change), **given)
    assert max(found.status) == 0
    assert error < 1e-12
    assert ran(model, scene)[1] < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("case", ["every joint", "shafts that differ", "hung"])
def test_chains_with_joints_of_every_kind(case):
    """All that may be a parameter is one, with what it is in the scene."""
    scene, places = CASES[case]
    names = ["mass", "spring", "dashpot", "impedance"]
    if case == "shafts that differ":
        names = ["mass", "impedance"]
    else:  # an end that moves at first is not served
        scene = scene.with_({"system": RESTING})
    scene = loaded(scene, places, PANEL)
    found, error = ran(built(scene, runtime=names), scene)
    assert max(found.status) == 0
    assert error < 1e-12


HELD = {
    "drive": ([15.0], [{"body": 1, "times": ["0 s"], "steps": ["15 N*m"]}]),
    "ground": ([1.5], [{"times": ["0 s"], "a": ["1.5 m/s^2"], "b": ["0 m/s^3"]}]),
    "force": ([1.5], [{"times": ["0 s"], "a": ["1.5 m/s^2"], "b": ["0 m/s^3"]}]),
    "collision": ([], []),
    "chain": ([2000.0], [{"at": "hammer", "times": ["0 s"], "steps": ["2 kN"]}]),
    "storeys": ([1.5], [{"times": ["0 s"], "a": ["1.5 m/s^2"], "b": ["0 m/s^3"]}]),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", WITH_UNITS)
def test_parameters_with_units(case):
    first, other, numbers = WITH_UNITS[case][0]()
    loads, tables = HELD[case]
    given = {name: values for name, values in numbers.items() if name != "load"}
    scenes = [
        wavesym.Scene(**{name: value for name, value in scene.items() if name != "load"}, load=tables)
        for scene in (first, other)
    ]
    stream = built(scenes[0], runtime=list(given)).start(**given)
    assert stream.refused == 0
    stream.step(0.0, loads)
    response = wavesym.evaluator(scenes[1])
    taus, found, told = np.arange(0.37, response.tau_max, 0.37), [], 0.0
    for tau in taus:
        status, out = stream.step(tau - told, loads)
        told = tau
        found.append(out)
        assert status == 0
    true = response(taus)
    assert np.max(np.abs(np.array(found).T - true) / np.max(np.abs(true), axis=1, keepdims=True)) < 1e-11


@pytest.mark.slow
def test_joints_ten_times_as_fast_are_taken(gears):
    """As the header says of the degree; the alarm tells what fronts that grow steep lose then."""
    most = float(QUICKER)
    quick = DRIVEN.with_({"system.kappa": [most, most / 2]})
    stream = gears.start(kappa=[most, most / 2])
    assert stream.refused == 0
    assert stream.step(0.0, [1.0, 0.0])[0] == 0
    found, error = ran(gears, quick, kappa=[most, most / 2])
    assert error < 1e-10
    assert (max(found.status) == 2) == (max(found.lost) > 1e-12)


@pytest.mark.slow
def test_in_single_precision():
    scene = DRIVEN.with_({"output.tolerance": "1e-4"})
    model = built(scene, precision="single", runtime=["kappa"])
    other = scene.with_({"system.kappa": [2, "3/2"]})
    stream = model.start(kappa=[2, 1.5])
    stream.step(0.0, [1.0, 0.0])
    found = [stream.step(0.25, [1.0, 0.0])[1] for _ in range(16)]
    held = [{"body": 1, "times": [0], "steps": [1]}]
    true = wavesym.evaluator(other.with_({"load": held}))(np.arange(1, 17) / 4)
    assert np.max(np.abs(np.array(found).T - true) / np.max(np.abs(true), axis=1, keepdims=True)) < 1e-4


BUILT_IN = {
    "building_m2": ["kappa"],
    "drive_equal": ["kappa", "inertia"],
    "collision_m4": ["kappa", "velocity"],
    "stepped_shaft": ["mass", "dashpot"],
}


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("name", BUILT_IN)
def test_built_in_scenes_test_themselves_in_c_and_cpp(name, precision, tmp_path):
    """With every compiler there is, without a warning; the command in the header makes the same files again."""
    scene, options = wavesym.Scene.from_toml(name), {"stream": True, "runtime": BUILT_IN[name], "precision": precision}
    wavesym.generate(scene, tmp_path, **options)
    request = Request.from_options(**{**options, "runtime": tuple(BUILT_IN[name])})
    assert api.check(scene, tmp_path, request) == ""
    assert f"--stream --runtime {','.join(BUILT_IN[name])}" in (tmp_path / f"{name}.h").read_text()
    assert selftest(tmp_path, name) == 0
    assert selftest(tmp_path, name, "-ffp-contract=fast", "-O3") == 0
    for each in at_hand():
        for language in ("c99", "c++17"):
            each.run([*LANGUAGES[language], *STRICT, "-O2", "-c", f"{name}.c", "-o", "made.o"], tmp_path)
            assert (tmp_path / "made.o").stat().st_size > 0


FAULTS = {
    "what is odd": ("to[points * SIZE + a] += 2 * x[a][k];", "to[points * SIZE + a] += x[a][k];"),
    "an end twice": ("(k == 1 ? (num)(2 * f[i][0]) : f[i][k - 1])", "f[i][k - 1]"),
    "an elimination": ("d[i * n + i] += (real)(2 * k);", "d[i * n + i] += (real)(2 * k + 1);"),
    "a start": ("OF(add_product)(m->start, at_first, n, 1, y);", ""),
    "what passes": ("to[k] = point >= 0 && power == k % SIZE ?", "to[k] = point < 0 && power == k % SIZE ?"),
    "what goes back": ("- (other == port ? (real)1 : (real)0)", ""),
    "a ratio": ("step / ((real)(4 * k) + step * above)", "step / (real)(4 * k)"),
    "a loss": ("table[0][LOSS] = 2 * own * last;", "table[0][LOSS] = 0;"),
    "a drive": ("push[port] *= drive[joint];", ""),
}
OF_SCATTERERS, OF_BODIES = ("what goes back",), ("a ratio", "a loss", "a drive")


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_in_the_tables_is_seen(fault, monkeypatch):
    from wavesym.targets.c import kernel as kernels

    right, wrong = FAULTS[fault]
    case = "base force" if fault in OF_SCATTERERS else "drive" if fault in OF_BODIES else "every joint"
    scene, places = CASES[case]
    names = ["kappa"]
    if case == "every joint":
        scene, names = scene.with_({"system": RESTING}), ["mass", "spring"]
    scene = loaded(scene, places, PANEL)
    counts = []

    def spoiled(file, of, kernel=kernels.kernel):
        text = kernel(file, of)
        counts.append(text.count(right))
        return text.replace(right, wrong)

    monkeypatch.setattr(kernels, "kernel", spoiled)
    with np.errstate(invalid="ignore"):
        found, error = ran(built(scene, runtime=names), scene)
    assert sum(counts) == 1
    assert not error < 1e-9 or max(found.status) > 0


SCALES = {"mass": Fraction(1, 3), "spring": Fraction(2), "dashpot": Fraction(5, 4)}


def scaled(value):
    """A system with all masses, springs and dashpots so many times as large."""
    if isinstance(value, dict):
        return {
            key: Fraction(str(each)) * SCALES[key] if key in SCALES else scaled(each) for key, each in value.items()
        }
    return [scaled(each) for each in value] if isinstance(value, list) else value


@pytest.mark.slow
@settings(settings.get_profile("first_failure"), max_examples=12)
@given(small(until=3))
def test_chains_with_other_parts(table):
    """Beside the stream without parameters, and so with tables from balls, of the chain that has these parts."""
    scene, other = wavesym.Scene(**table), wavesym.Scene(**table | {"system": scaled(table["system"])})
    names = [name for name in SCALES if f"'{name}'" in str(table["system"])]
    assume(names)
    try:
        model, fixed = built(scene, runtime=names), built(other)
    except WavesymError:
        reject()
    changed = {
        field.name: [float(SCALES[field.name] * Fraction(str(value))) for value in field.values]
        for field in model.fields
    }
    ours, theirs = model.start(**changed), fixed.start()
    assert ours.refused == 0
    found = []
    for k in range(40):
        load = [((3 * j + k // 5) % 5 - 2) / 2 for j in range(len(model.loads))]
        ours.step(0.0, load)
        theirs.step(0.0, load)
        found.append([stream.step(fixed.panel, load) for stream in (ours, theirs)])
    statuses, rows = zip(*((pair[0][0], [out for _, out in pair]) for pair in found), strict=True)
    one, two = np.array(rows).transpose(1, 0, 2)
    assume(max(statuses) == 0)
    assert np.max(np.abs(one - two)) <= 1e-11 * np.max(np.abs(two), initial=0.0)
