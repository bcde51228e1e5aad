"""Loads given sample by sample: exact where they change; where there is no room for that, a bound of what is lost.

What is right comes from the exact program of the same scene, whose loads are known in advance.
"""

import json
import re
import subprocess
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq
from hypothesis import Phase, given, reject, settings
from hypothesis import strategies as st

import wavesym
from tests.support import drawn
from tests.support.builds import LANGUAGES, STRICT, needs_binutils, needs_zig, sections
from tests.support.drives import DRIVE, EVERY, small
from tests.support.streamed import built, knots, missed, run
from wavesym import api
from wavesym.cli import main
from wavesym.errors import WavesymError
from wavesym.programs.request import Request
from wavesym.running.toolchain import at_hand, compiler
from wavesym.targets.files import files
from wavesym.targets.manifest import CODE_AT_MOST

PANEL = Fraction(1, 8)
JUMPS = [[Fraction((5 * k * k + 3 * k) % 11 - 5, 4) for k in range(9)], [Fraction(k % 3 - 1) for k in range(6)]]
TOWER = wavesym.Scene(
    name="tower",
    system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
    output={
        "until": 5,
        "tolerance": "1e-12",
        "strain": ["1/4", "1+"],
        "velocity": [0, 2],
        "displacement": [0, "1/2", "7/5"],
        "acceleration": [1],
        "force": ["1-"],
        "drift": [2],
        "relative": [1],
    },
)
GROUND = TOWER.with_({"system.base": "ground", "name": "shaken"})
GEARS = wavesym.Scene(
    name="gears",
    system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    output={
        "until": 5,
        "tolerance": "1e-12",
        "strain": [0, "1/2", "1-"],
        "velocity": [0, 1],
        "displacement": [0, 2],
        "acceleration": [0, 1],
    },
)


def loaded(scene, places, spacing, jumps=JUMPS):
    """The scene under such loads there."""
    tables = knots(jumps[: len(places)], spacing)
    if scene.system.type == "building":
        tables = [{"times": each["times"], "a": each["steps"], "b": each["ramps"]} for each in tables]
    return scene.with_({"load": [place | each for place, each in zip(places, tables, strict=True)]})


def chain(system, places, **output):
    watched = {"until": 5, "tolerance": "1e-12", **output}
    load = [{"at": place, "times": [0], "steps": [1]} for place in places]
    return wavesym.Scene(name="chained", system=system, load=load, output=watched)


def of_chain(system, places, **output):
    return chain(system, places, **output), [{"at": place} for place in places]


CASES = {
    "base force": (TOWER, [{}]),
    "base moves": (GROUND, [{}]),
    "drive": (GEARS, [{"body": 1}, {"body": 2}]),
    "shafts that differ": of_chain(
        DRIVE, ["motor", "end"], strain=["1-", "5/2+"], velocity=["motor", "1/4"], displacement=["end"]
    ),
    "every joint": of_chain(
        EVERY,
        ["ground", "seat"],
        strain=["1-", "1/4", "side:1/2-"],
        velocity=["floor", "hung", "ground", "seat"],
        displacement=["seat", "hung"],
        acceleration=["hung", "floor"],
    ),
    "hung": of_chain(EVERY, ["hung", "gear"], velocity=["floor", "hung", "side:3/2"], displacement=["seat"]),
}


def cases(*quick):
    marked = [case if case in quick else pytest.param(case, marks=pytest.mark.slow) for case in CASES]
    return pytest.mark.parametrize("case", marked)


@cases("drive")
def test_what_is_straight_on_panels_is_exact(case):
    """Loads that jump and bend at edges of panels, in steps that have nothing to do with them."""
    scene = loaded(*CASES[case], PANEL)
    ran = run(built(scene), [row[:] for row in JUMPS[: len(scene.load)]], PANEL, Fraction(5), Fraction(1, 29))
    assert max(ran.status) == 0
    assert np.max(missed(ran, scene)) < 1e-12
    assert ran.lost[-1] < 1e-10  # worst cases of all steps, added up


@pytest.mark.slow
@cases("base force")
def test_a_step_may_be_many_panels_long(case):
    """Loads that jump at whole numbers, and steps to the next one."""
    scene = loaded(*CASES[case], Fraction(1))
    ran = run(built(scene), JUMPS[: len(scene.load)], Fraction(1), Fraction(5), Fraction(5, 8))
    assert max(ran.status) == 0
    assert np.max(missed(ran, scene)) < 1e-12


@cases("drive")
@pytest.mark.parametrize("place", [Fraction(1, 2), pytest.param(Fraction(1, 50), marks=pytest.mark.slow)])
def test_the_alarm_is_given_when_a_kink_is_lost_and_not_before(case, place):
    """A jump inside of a panel, no room for it: lost is no less than what is lost, and what comes before is exact."""
    scene, places = CASES[case]
    until, late = Fraction(3), 9 * PANEL + place * PANEL
    names = ("a", "b") if scene.system.type == "building" else ("steps", "ramps")
    table = {"times": [0, late], names[0]: [1, -2], names[1]: [0, 0]}
    scene = scene.with_({"load": [at | table for at in places]})
    told = []
    for room in (0, None):
        stream = built(scene, room=room).start()
        stream.step(0.0, [1.0] * len(places))
        status, _ = stream.step(float(late), [1.0] * len(places))
        assert status == 0
        assert stream.lost < 1e-10
        status, _ = stream.step(0.0, [-1.0] * len(places))
        tau, found, step = float(late), [], 1 / 97.3  # off the fronts
        taus = []
        while tau + step < until:
            last, out = stream.step(step, [-1.0] * len(places))
            tau += step
            taus.append(tau)
            found.append(out)
        true = wavesym.evaluator(scene)(taus)
        largest = np.max(np.abs(true), axis=1)
        error = np.max(np.max(np.abs(np.array(found).T - true), axis=1) / np.where(largest > 0, largest, 1))
        told.append((status, last, stream.lost, error))
    (at_once, _, lost, error), (_, fine, spare, exact) = told
    assert at_once == 2
    # bounds of all steps, added up with one sign: near an edge as large as in the middle, where more is lost
    most = (3000 if case == "hung" else 350) * (1 if place == Fraction(1, 2) else 10)
    assert 1e-6 < error < lost < most * error
    assert fine == 0
    assert exact < 1e-12
    assert spare < 1e-10


def test_what_is_lost_beyond_the_horizon_is_seen():
    """Fronts grow steep: polynomials that are enough up to the horizon are not for ever."""
    scene = wavesym.Scene.from_toml("drive_m1").with_({"output.until": 6, "output.tolerance": TIGHT, "load": [HELD]})
    model = built(scene)
    stream = model.start()
    stream.step(0.0, [1.0])
    taus = [k + 0.37 for k in range(40)]
    told, found, status, lost = 0.0, [], [], []
    for tau in taus:
        code, out = stream.step(tau - told, [1.0])
        told = tau
        found.append(out)
        status.append(code)
        lost.append(stream.lost)
    true = wavesym.evaluator(scene.with_({"output.until": 40}))(taus)
    error = np.max(np.abs(np.array(found).T - true) / np.max(np.abs(true), axis=1, keepdims=True), axis=0)
    assert max(status[:6]) == 0
    assert status[-1] == 2
    assert error[status.index(2) - 1] < 1e-11
    assert np.all(np.maximum.accumulate(error) <= lost)
    assert lost[-1] < 3000 * np.max(error)


TIGHT = "1e-12"
HELD = {"body": 1, "times": [0], "steps": [1]}
STEPPED = wavesym.Scene.from_toml("drive_m1").with_({"load": [HELD], "output.tolerance": "1e-12", "output.until": 6})


@pytest.mark.parametrize(
    "spacing", ["1/10", pytest.param("3/10", marks=pytest.mark.slow), pytest.param("1/7", marks=pytest.mark.slow)]
)
def test_steps_that_are_known_make_panels(spacing):
    """--step: loads may jump at all multiples of it."""
    every = Fraction(spacing)
    scene = loaded(STEPPED, [{"body": 1}], every)
    ran = run(built(scene, step=every), JUMPS[:1], every, 10 * every, every / 3)
    assert max(ran.status) == 0
    assert np.max(missed(ran, scene)) < 1e-12


def test_a_stream_at_rest_is_the_same_whenever_it_begins():
    """Nothing is counted: after 100 000 panels all rings have gone around, and every bit is as at the start."""
    model = built(STEPPED)
    late, fresh = model.start(), model.start()
    late.step(12500.0, [0.0])
    for k in range(20):
        load = [float(k % 5) - 2]
        one, other = (stream.step(0.3, load) for stream in (late, fresh))
        assert np.array_equal(one[1], other[1])


def test_time_does_not_drift():
    """What 0.1 is as a double adds up, and nothing else."""
    stream, count = built(STEPPED).start(), 20_000
    for _ in range(count):
        stream.step(0.1, [0.0])
    high, low = np.frombuffer(stream.state[:16].tobytes())
    exact = count * Fraction(0.1) % PANEL
    assert abs(Fraction(float(high)) + Fraction(float(low)) - exact) < Fraction(1, 10**25)


def test_what_is_refused_changes_nothing_and_a_copy_goes_on():
    stream = built(STEPPED).start()
    stream.step(0.0, [1.0])
    stream.step(0.77, [2.0])
    before = stream.state.copy()
    for dtau, load in (
        (-0.1, 1.0),
        (np.nan, 1.0),
        (np.inf, 1.0),
        (1e300, 1.0),
        (1e-31, 1.0),
        (0.1, np.nan),
        (0.0, np.inf),
    ):
        status, out = stream.step(dtau, [load])
        assert status == 1
        assert np.isnan(out).all()
        assert np.array_equal(stream.state, before)
    other = stream.copy()
    assert np.array_equal(stream.step(0.4, [0.5])[1], other.step(0.4, [0.5])[1])


@pytest.mark.parametrize("precision", ["single", "double"])
def test_what_rounding_may_do_is_said_where_it_is_more_than_was_asked_for(precision, tmp_path, capsys):
    given = ["generate", "building_m2", "--stream", "--precision", precision, "-o", str(tmp_path)]
    assert main(given) == 0
    line = r"the tolerance (\S+) may be missed: rounding takes (\S+) up to (\S+) of "
    told = re.search(rf"^building_m2: {line}", capsys.readouterr().err, re.M)
    header = (tmp_path / "building_m2.h").read_text()
    errors = re.findall(r"^ \* +(\S+@\S+) +(\d\S*)$", header, re.M)
    name, worst = max(errors, key=lambda row: float(row[1]))
    manifest = json.loads((tmp_path / "building_m2.json").read_text())
    assert (told is not None) == (precision == "single") == ("shortfall" in manifest)
    if told:
        assert (told[2], told[3]) == (name, worst)
        assert f" * Beware: {manifest['shortfall']}.\n" in header
        assert told[0] in f"building_m2: {manifest['shortfall']}"
    assert (float(worst) > 1e-5) == (precision == "single")


@pytest.mark.parametrize("step", ["0", "-1/8", "soon", "1e-400"])
def test_a_step_is_a_positive_number(step, capsys):
    assert main(["generate", "drive_m1", "--stream", "--step", step]) == 2
    assert f"{step} is not a positive time; write a number such as 0.1 or 1/8" in capsys.readouterr().err


@pytest.mark.slow
def test_nothing_is_left_out_as_a_stream_has_no_horizon():
    """What cannot be felt within the horizon is felt later."""
    system = {"type": "drive", "m": 4, "kappa": [1, "1/2", 2, 1], "inertia": [1, 1, 2, 1, 1]}
    output = {"until": 1, "tolerance": "1e-9", "velocity": [0]}
    scene = loaded(wavesym.Scene(name="far", system=system, output=output), [{"body": 1}], Fraction(1))
    ran = run(built(scene), JUMPS[:1], Fraction(1), Fraction(12), Fraction(1, 3))
    assert np.max(missed(ran, scene.with_({"output.until": 12}))) < 1e-6


REFUSED = {
    "bouncing": ({"stream": True}, "chained", "opens and closes"),
    "damped": ({"stream": True}, "damped", "jumps by 1 at tau = 0, and modes support no jump .* or --stream --step"),
    "endless": ({"stream": True}, "endless", r'or, for hours, damping = "0.5 %" under \[system\], say: that'),
    "language": ({"stream": True, "language": "numpy"}, "drive_m1", "--stream makes C, not numpy; write c"),
    "evaluator": ({"stream": True, "evaluator": "pieces"}, "drive_m1", "pieces does not go with --stream; write auto"),
    "runtime": (
        {"stream": True, "runtime": ["load"]},
        "drive_m1",
        "load, but the inputs of a stream are its loads",
    ),
    "step": ({"step": Fraction(1, 8)}, "drive_m1", "0.125 tau is that of a stream"),
    "beyond": ({"stream": True}, "beyond", "output: a stream needs numbers beyond the range of double precision"),
    "nothing left": ({"stream": True}, "weak", "rounding may leave nothing of strain@0.5"),
}
BOUNCING = {"type": "chain", "parts": [{"mass": 1, "velocity": 1, "name": "a"}, "contact", {"rod": 1}, "fixed"]}
SCENES = {
    "chained": wavesym.Scene(name="b", system=BOUNCING, output={"until": 3, "velocity": ["0+"]}),
    "damped": GEARS.with_({"system.damping": 0.05, "load": [HELD]}),
    "endless": STEPPED.with_({"output.until": 10**9}),
    "beyond": STEPPED.with_({"system.kappa": ["1e200"]}),
    "weak": STEPPED.with_({"system.kappa": ["1e-30"], "output.strain": ["0.5"]}),
    "drive_m1": STEPPED,
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_served_is_refused_in_one_line(case, tmp_path):
    options, scene, said = REFUSED[case]
    with pytest.raises(WavesymError, match=said) as refused:
        wavesym.generate(SCENES[scene], tmp_path / "made", **options)
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "made").exists()


def test_a_damped_stream_is_one_of_modes_for_any_loads_at_its_step(tmp_path):
    """As a scene has it whose load has samples so far apart; its own number does not matter."""
    damped = SCENES["damped"].with_({"output.tolerance": "1e-4"})
    step = Request(stream=True, step=fmpq(1, 8))
    rising = {"body": 1, "spacing": "1/8", "samples": [0, 1]}
    made, told = (api.program(scene, step) for scene in (damped, damped.with_({"load": [HELD | {"steps": [-7]}]})))
    known = api.program(damped.with_({"load": [rising]}), Request("modes", stream=True))
    assert made.sources == known.sources == ("M1",)
    assert made.tables == known.tables == told.tables
    assert [output.bound for output in made.outputs] == [output.bound for output in known.outputs]
    header = files(made, "c")["gears.h"]
    assert "#define GEARS_SPACING 0.125" in header
    assert "on [0, TAU_MAX], under a rise of each load within a step." in header
    assert "ERROR_BOUND holds under a rise of each load within a step, up to TAU_MAX; under" in header
    assert files(known, "c")["gears.h"].count("under the scene's loads") == 2


def selftest(folder, name, *flags):
    compiler().run(
        [*LANGUAGES["c99"], *STRICT, "-O2", *flags, f"{name}.c", f"{name}_selftest.c", "-o", "test", "-lm"], folder
    )
    return subprocess.run([folder / "test"], capture_output=True, check=False).returncode


def test_a_stream_says_what_it_is_and_tests_itself(tmp_path):
    """Without loads in the scene all moments are inputs, in the order of the bodies."""
    wavesym.generate(GEARS, tmp_path, stream=True)
    assert selftest(tmp_path, "gears") == 0
    header = (tmp_path / "gears.h").read_text()
    assert "GEARS_LOAD_M1 = 0, /* M1 */" in header
    assert "GEARS_LOAD_M3 = 2 /* M3 */" in header
    assert "_eval(" not in header
    assert "command: wavesym generate gears.toml --stream\n" in header
    assert "proved:" not in header.lower()
    manifest = json.loads((tmp_path / "gears.json").read_text())
    assert (manifest["evaluator"], manifest["panel"], manifest["loads"]) == ("stream", 0.125, ["M1", "M2", "M3"])
    assert manifest["proved"] is False


DIRECT = {
    "base force": {"strain@0", "velocity@0", "velocity@0+"},
    "base moves": set(),
    "drive": {"acceleration@0", "acceleration@1"},
    "shafts that differ": set(),
    "every joint": {"velocity@seat"},
    "hung": set(),
}


@cases()
def test_what_loads_act_on_at_once_is_said(case, tmp_path):
    """By the manifest, and by what a step of 0 changes."""
    scene, places = CASES[case]
    if not scene.load:
        scene = loaded(scene, places, PANEL)
    model = built(scene)
    stream = model.start()
    rest = [0.0] * len(places)
    before = stream.step(0.0, rest)[1]
    changed = {}
    for j, load in enumerate(model.loads):
        other = stream.copy().step(0.0, [*rest[:j], 1.0, *rest[j + 1 :]])[1]
        for name, one, two in zip(model.outputs, before, other, strict=True):
            if one != two:
                changed.setdefault(name, []).append(load)
    wavesym.generate(scene, tmp_path, stream=True)
    said = json.loads((tmp_path / f"{scene.name}.json").read_text())["direct"]
    assert said == changed
    assert set(said) <= DIRECT[case]


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("name", ["building_m2", "drive_equal", "collision_m4", "geared_drive", "damped_building"])
def test_built_in_scenes_test_themselves_in_c_and_cpp(name, precision, tmp_path):
    wavesym.generate(wavesym.Scene.from_toml(name), tmp_path, precision=precision, stream=True)
    scene = wavesym.Scene.from_toml(name)
    request = Request(precision=precision, stream=True)
    assert api.check(scene, tmp_path, request) == ""
    assert "--stream" in api.check(scene.with_({"output.until": 3}), tmp_path, request)
    assert selftest(tmp_path, name) == 0
    assert selftest(tmp_path, name, "-ffp-contract=fast", "-O3") == 0
    for file in (f"{name}.c", f"{name}_selftest.c"):
        compiler().run([*LANGUAGES["c++17"], *STRICT, "-c", file, "-o", f"{file}.o"], tmp_path)
        assert (tmp_path / f"{file}.o").stat().st_size > 0


BREAKS = {
    "what arrives": ("slot_of(state, number, slots[number] - 1)", "slot_of(state, number, slots[number] - 2)"),
    "what arrives later": ("breakpoint, number, entries[number] - 1)", "breakpoint, number, 0)"),
    "a state": ("*x = step_body(on->table, given, *x, velocities);", "step_body(on->table, given, *x, velocities);"),
    "a state inside": ("acting, breakpoint == EDGE ? panel : panel - state->time,", "acting, panel,"),
    "a state later": ("breakpoint < 0 ? panel : panel - state->place[breakpoint]);", "panel);"),
    "a force": ("power[0] += strength[force * LOADS + j] * load[j];", ""),
    "what is sent": (
        "add(sent_wave(state, breakpoint, send[port]), 1, breakpoint == NONE ? instead : more[all], SIZE);",
        "",
    ),
    "what follows": ("    continue_breakpoints(state);\n}", "}"),
    "a place": ("state->place[found] = state->time;", "state->place[found] = 0;"),
    "a jump": ("jump[j] = brief ? load[j] - straight : (real)0;", "jump[j] = 0;"),
    "a ring": ("state->at[k] + 1 : 0", "state->at[k] + 1 : 1"),
    "a ring of windows": ("state->turn[k] + 1 : 0", "state->turn[k] : 0"),
    "an integral": ("state->total[output] += gain[k] * integral_since(state, k, panel);", ""),
    "an integral inside": ("if (as_integral && since > 0) {", "if (as_integral && since > panel) {"),
    "a value inside": ("sum += series(c, since > 0 ? since * scale - 1 : (real)-1);", ""),
    "a step taken": ("dtau >= shortest && dtau <= longest", "dtau == dtau"),
}


@pytest.mark.slow
@pytest.mark.parametrize("fault", BREAKS)
def test_a_broken_stream_is_seen_by_its_selftest(fault, tmp_path):
    """Loads jump inside of panels."""
    wavesym.generate(GEARS.with_({"load": [HELD]}), tmp_path, stream=True)
    source = tmp_path / "gears.c"
    right, wrong = BREAKS[fault]
    assert source.read_text().count(right) == 1
    source.write_text(source.read_text().replace(right, wrong))
    assert selftest(tmp_path, "gears", "-Wno-unused-parameter", "-Wno-unused-function", "-Wno-unused-variable") != 0


@pytest.mark.slow
def test_inputs_count_in_their_units():
    """An acceleration in m/s^2, results in mm: as the scene that has it in advance."""
    text = {
        "units": {"length": "mm"},
        "system": {
            "type": "building",
            "base": "ground",
            "storey": [
                {
                    "count": 3,
                    "height": "3.5 m",
                    "stiffness": "678 MN/m",
                    "column_mass": "10.871 t",
                    "floor_mass": "350 t",
                }
            ],
        },
        "load": [{"times": ["0 s"], "a": ["0.3 g"], "b": ["0 g/s"]}],
        "output": {"until": 9, "tolerance": "1e-11", "displacement": [0, 3], "acceleration": [2], "drift": [1]},
    }
    scene = wavesym.Scene(name="frame", **text)
    model = built(scene)
    assert model.loads == ("a [m/s^2]",)
    stream = model.start()
    stream.step(0.0, [0.3 * 9.80665])
    found = np.array([stream.step(0.31, [0.3 * 9.80665])[1] for _ in range(28)]).T
    true = wavesym.evaluator(scene)([0.31 * k for k in range(1, 29)])
    assert np.max(np.abs(found - true) / np.max(np.abs(true), axis=1, keepdims=True)) < 1e-11


@pytest.mark.slow
def test_single_precision_is_as_good_as_it_can_be():
    scene = loaded(*CASES["drive"], PANEL).with_({"output.tolerance": "1e-5"})
    ran = run(built(scene, "single"), JUMPS, PANEL, Fraction(5), Fraction(1, 32))
    assert max(ran.status) == 0
    assert np.max(missed(ran, scene)) < 1e-5


@needs_binutils
@pytest.mark.slow
@pytest.mark.parametrize("precision", ["double", "single"])
def test_it_allocates_nothing_and_is_small(precision, tmp_path):
    wavesym.generate(STEPPED.with_({"output.tolerance": "1e-5"}), tmp_path, precision=precision, stream=True)
    compiler().run(["-Os", "-c", "drive_m1.c", "-o", "made.o"], tmp_path)
    sizes = sections(tmp_path / "made.o")
    assert sizes[".text"] <= CODE_AT_MOST["stream"]
    assert not {".data", ".bss"} & sizes.keys()


CORTEX = ("-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m4+vfp4d16sp", "-Os", "-fno-sanitize=all", "-I.")


def compact(name, precision, folder):
    """Bytes of code and tables, and of a state, for a Cortex-M4F; and what is called."""
    (zig,) = (each for each in at_hand(()) if each.name == "ziglang")
    wavesym.generate(wavesym.Scene.from_toml(name), folder, precision=precision, stream=True, step=Fraction(1, 8))
    (folder / "math.h").write_text('#define NAN __builtin_nanf("")\n')
    (folder / "state.c").write_text(f'#include "{name}.h"\nchar state[sizeof({name}_state)];\n')
    for file in (name, "state"):
        zig.run([*CORTEX, "-c", f"{file}.c", "-o", f"{file}.o"], folder)
    code = sections(folder / f"{name}.o")
    said = subprocess.run(["nm", "-u", folder / f"{name}.o"], capture_output=True, text=True, check=True).stdout
    size = sum(bytes_ for section, bytes_ in code.items() if re.match(r"\.(text|rodata|ARM)", section))
    return size, sections(folder / "state.o")[".bss"], set(said.split()) - {"U"}


@needs_binutils
@pytest.mark.slow
@needs_zig
def test_the_sizes_on_a_small_machine_are_those_of_the_page(tmp_path):
    page = (Path(__file__).parents[2] / "docs" / "march.md").read_text()
    rows = re.findall(r"^\| (\w+), (double|single) \| (\d+) \| (\d+) \|$", page, re.MULTILINE)
    assert len(rows) == 4
    for name, precision, code, state in rows:
        found, kept, called = compact(name, precision, tmp_path / f"{name}_{precision}")
        assert abs(found - int(code)) <= 0.03 * int(code), (name, precision, found)
        assert kept == int(state), (name, precision)
        if precision == "single":
            assert not [symbol for symbol in called if symbol.startswith("__aeabi_d")]


@pytest.mark.slow
@settings(settings.get_profile("first_failure"), max_examples=12)
@given(st.data())
def test_systems_that_are_drawn(data):
    """Equal and nearly equal parameters, stiff ones, and outputs anywhere."""
    system = data.draw(drawn.systems(kinds=("drive", "building"), largest=4))
    scene = wavesym.Scene(name="drawn", system=system, output=data.draw(drawn.outputs(system, "1e-11")))
    places = [{"body": data.draw(st.integers(1, system["m"] + 1))}] if system["type"] == "drive" else [{}]
    scene = loaded(scene, places, PANEL)
    until = PANEL * int(Fraction(scene.output.until) / PANEL)
    model = built(scene)
    ran = run(model, JUMPS[:1], PANEL, until, Fraction(data.draw(st.integers(1, 11)), 97))
    assert max(ran.status) == 0
    assert np.max(missed(ran, scene)) < 1e-10


@pytest.mark.slow
@settings(settings.get_profile("wavesym"), max_examples=40, phases=[Phase.explicit, Phase.generate])
@given(small(until="3"))
def test_chains_that_are_drawn(table):
    """Rods that differ, springs, gears, prescribed motions; a load where the scene has one, or on the first name."""
    output = table["output"] | {"tolerance": "1e-11"}
    names = [part["name"] for part in table["system"]["parts"] if isinstance(part, dict) and "name" in part]
    places = list(dict.fromkeys(load["at"] for load in table.get("load", ()))) or names[:1]
    try:
        scene = wavesym.Scene(
            name="drawn",
            system=table["system"],
            load=[{"at": place, "times": [0], "steps": [1]} for place in places],
            output=output,
        )
        model = built(scene)
    except WavesymError:  # a name that no load takes; lengths without a common measure
        reject()
    panel = Fraction(model.panel).limit_denominator(10**11)
    jumps = [JUMPS[0]] * len(places)
    scene = loaded(scene, [{"at": place} for place in places], panel, jumps)
    ran = run(model, jumps, panel, panel * int(3 / panel), panel * Fraction(23, 47))
    assert max(ran.status, default=0) == 0
    assert np.max(missed(ran, scene), initial=0) < 1e-11


PULSED = wavesym.Scene(
    name="pulsed",
    system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    load=[{"body": 1, "times": [0], "steps": [1]}, {"body": 3, "times": ["1/3"], "steps": [2]}],
    output={"until": 20, "tolerance": "1e-10", "strain": ["1/2"], "velocity": [2]},
)


@pytest.mark.slow
def test_the_alarm_does_not_wait_for_the_first_wave():
    """At rest so far, a moment jumps inside of a panel and goes back: nothing has been sent, and without room much is
    lost.
    """
    stream = built(PULSED, room=0).start()
    assert stream.step(9 / 64, [0.0, 0.0])[0] == 0
    for dtau, load in ((0.0, 100.0), *[(1 / 512, 0.0)] * 100):
        assert stream.step(dtau, [0.0, load])[0] == 2
    assert stream.lost > 1e-10
    # and it stays, though so much larger a wave follows that what was lost is little beside it
    stream.step(20 * 0.125 - 9 / 64 - 100 / 512, [0.0, 0.0])
    stream.step(0.0, [1e12, 0.0])
    assert stream.step(20.0, [1e12, 0.0])[0] == 2
    assert stream.lost < 1e-8


@pytest.mark.slow
@pytest.mark.parametrize("late", [1e-17, 1e-16])
def test_a_clock_that_is_rounded_raises_no_alarm(late):
    """At rest, a moment jumps so shortly before or after an edge that it cannot matter."""
    stream = built(PULSED).start()
    for dtau in (3 * 0.125 - 0.1, 0.1, late):
        assert stream.step(dtau, [0.0, 0.0])[0] == 0
    for dtau in (0.0, *[0.125] * 20):
        assert stream.step(dtau, [0.0, 100.0])[0] == 0


@pytest.mark.slow
@pytest.mark.parametrize(("precision", "powers"), [("double", (-900, -540, 540)), ("single", (-90, -70, 70))])
def test_what_is_lost_does_not_depend_on_units(precision, powers):
    """Loads that change inside of panels, with no room for that; powers of 2 are exact."""
    made = built(PULSED.with_({"output.tolerance": "1e-4"}), precision, room=0)

    def statuses(power):
        stream = made.start()
        loads = [[0.0, 0.0]] * 3 + [[np.ldexp(k % 3 - 1, power), np.ldexp(1, power)] for k in range(30)]
        told = [stream.step(1e-4 if 3 <= k < 23 else 0.1, load)[0] for k, load in enumerate(loads)]
        return told, stream.lost

    told, lost = statuses(0)
    assert sorted(set(told)) == [0, 2]
    for power in powers:
        scaled, also = statuses(power)
        assert scaled == told
        assert also == pytest.approx(lost, rel=1e-5)


@pytest.mark.slow
def test_an_overflow_is_told_until_init():
    stream = built(PULSED).start()
    for k in range(20):
        stream.step(0.1, [1e307 * (k % 3 - 1), 1e307])
    assert stream.step(0.1, [1.0, 1.0])[0] == 2
    assert stream.step(-1.0, [1.0, 1.0])[0] == 1
    for _ in range(50):
        assert stream.step(0.1, [1.0, 1.0])[0] == 2
