"""Modal systems of chains with dashpots: against exact waves, and what is left out, proved."""

import subprocess
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from tests.programs.test_modal_systems import PUSH, SYMMETRIC, both, rounding, values
from tests.support.drives import exact
from tests.support.modal import chain
from wavesym.errors import ToleranceError, UnservedError
from wavesym.exact.modes.damped_spectrum import DampedSpectrum
from wavesym.programs.making import make
from wavesym.programs.modes import complex_modes
from wavesym.programs.modes.complex_modes import ComplexModes
from wavesym.programs.modes.evaluator import modal_system
from wavesym.programs.modes.truncation import ModalModes
from wavesym.programs.request import Request
from wavesym.running.toolchain import compiler
from wavesym.targets.files import files

SHAKEN = {"at": "m", "times": [0, "7/3", "5/2"], "ramps": [1, -3, 2]}
GROUND = {"motion": "acceleration", "name": "m"}
WATCHED = {"velocity": ["n"], "displacement": ["n"], "acceleration": ["n"], "until": 8, "tolerance": "1e-2"}

LOSING = {
    "held": chain(
        ["fixed", {"rod": 1}, {"mass": 1, "name": "n", "dashpot": "1/2"}, {"rod": 1}, {"mass": 2, "dashpot": "1/5"}],
        [PUSH],
        **{**WATCHED, "velocity": ["n", "3/2"], "strain": ["0", "1+", "1/2"]},
    ),
    "on moving ground, dashpots across and to the ground": chain(
        [GROUND, {"rod": 1, "dashpot": "1/3"}, {"mass": 1, "name": "n"}, {"rod": "1.3"}, {"mass": 2, "dashpot": "1/5"}],
        [SHAKEN],
        **WATCHED,
        force=["0+"],
        drift=[1, 2],
        relative=["n"],
    ),
    "two loads, creeping": chain(
        [GROUND, {"rod": 1}, {"mass": "1/2", "name": "n", "dashpot": 7}, {"rod": 1}, {"mass": 2, "name": "e"}],
        [SHAKEN, {**PUSH, "times": [0, "1/3", "2/3"], "at": "e"}],
        **WATCHED,
        strain=["0"],
    ),
    "a dashpot between bars, gears": chain(
        [
            "fixed",
            {"rod": 1},
            {"mass": 1, "name": "n"},
            {"dashpot": 2, "spring": 1},
            {"mass": 1},
            {"rod": "1/2"},
            "free",
        ],
        [PUSH],
        [
            {
                "from": "n",
                "name": "a",
                "ratio": -2,
                "parts": [{"rod": "1/3"}, {"mass": "1/2", "spring": 1, "dashpot": 2}],
            }
        ],
        **WATCHED,
        strain=["0", "a:0"],
    ),
    "bars that vibrate between points at rest": chain(
        ["fixed", {"rod": 1}, {"mass": 1, "name": "n", "dashpot": "1/2"}, {"rod": 1}, "fixed"],
        [PUSH],
        **WATCHED,
        strain=["0"],
    ),
    "pushed where there is no mass": chain(
        ["fixed", {"rod": 1}, {"joint": True, "name": "e", "dashpot": 3}, {"rod": "1/2"}, {"mass": 1, "name": "n"}],
        [{**PUSH, "at": "e"}],
        **{**WATCHED, "tolerance": "1/10", "displacement": ["e"]},
        strain=["0"],
    ),
    # they were refused: two frequencies meet
    **{
        f"equal branches {how}": chain(
            ["fixed", {"rod": 1}, {"mass": 1, "name": "n", "dashpot": "1/3"}, {"rod": "1/2"}, {"mass": 1}],
            [{**PUSH, "at": "a:1"}],
            [{"from": "n", "name": name, "parts": [{"rod": 1}, {"mass": 1, "dashpot": tip}]} for name in "abc"],
            **{**WATCHED, "velocity": ["n", "a:1", "b:1"], "until": 3, "tolerance": "1/10"},
        )
        for how, tip in (("with dashpots", "1/20"), ("that swing for ever", 0))
    },
}
LONG = [name for name in LOSING if name not in ("held", "equal branches that swing for ever")]


def with_modes(model, count):
    """The first `count` modes, and what the others can add."""
    built = ComplexModes(model)
    known = built.project(count)
    errors, rest = built.errors(known, count), np.zeros(count)
    return ModalModes(built.system(known, count), built.sources, built.loads, errors, errors, known.w, rest)


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] if n in LONG else []) for n in LOSING])
def test_outputs_are_those_of_waves_but_for_what_is_left_out(name):
    """With few modes and with enough errors are within the bound, which meets the tolerance."""
    model = LOSING[name]
    taus = np.linspace(0, model.horizon(), 61)
    right = exact(model, taus)
    made = modal_system(model)
    assert np.all(made.bounds <= float(model.tolerance))
    assert np.all(made.largest <= 1.1 * np.abs(right).max(axis=1))
    for few in (made, with_modes(model, 10)):
        error = np.abs(values(model, few, taus) - right).max(axis=1)
        assert np.all(error <= few.errors + rounding(model, few))


def test_a_bound_can_fail():
    """It is no more than 40 times what is wrong; what is 2 % of one mode more is more than it allows."""
    model = LOSING["held"]
    taus = np.linspace(0, model.horizon(), 61)
    right = exact(model, taus)
    made = with_modes(model, 30)
    error = np.abs(values(model, made, taus) - right).max(axis=1)
    assert np.all(error <= made.errors)
    assert np.all(made.errors <= 40 * error)
    moved, moving = made.system.displacement_weights.copy(), made.system.velocity_weights.copy()
    moved[:, 0] *= 1.02
    moving[:, 0] *= 1.02
    other = replace(made, system=replace(made.system, displacement_weights=moved, velocity_weights=moving))
    assert np.all(np.abs(values(model, other, taus) - right).max(axis=1) > made.errors)


def test_a_mode_that_is_missed_makes_the_bound_worse_not_wrong(monkeypatch):
    model = LOSING["held"]
    taus = np.linspace(0, model.horizon(), 61)
    right, whole = exact(model, taus), with_modes(model, 30)
    every = DampedSpectrum.first

    def but_one(spectrum, count):
        return [mode for k, mode in enumerate(every(spectrum, count)) if k != 4]

    monkeypatch.setattr(DampedSpectrum, "first", but_one)
    made = with_modes(model, 29)
    error = np.abs(values(model, made, taus) - right).max(axis=1)
    assert np.all(error <= made.errors)
    assert np.all(made.errors > 1.5 * whole.errors)
    assert np.any(error > whole.errors)


@pytest.mark.slow
def test_slow_modes_taken_away_in_balls_are_what_doubles_make_of_them(monkeypatch):
    """Of one bound both are above the error; the first is the sharper one, by far where masses are heavy."""
    parts = [
        GROUND,
        {"rod": 1, "dashpot": "1/2"},
        {"mass": 30},
        {"rod": 1},
        {"mass": 30, "name": "n", "dashpot": "1/4"},
    ]
    model = chain(parts, [{**SHAKEN, "ramps": [1, -3, 1]}], **{**WATCHED, "until": 20})
    sharp = with_modes(model, 120).errors
    monkeypatch.setattr("wavesym.programs.modes.dissipation._SLOW", 0)
    rough = with_modes(model, 120).errors
    assert np.all(sharp <= 1.000001 * rough)
    assert sharp[1] < 1e-2 * rough[1]


@pytest.mark.slow
@settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_drawn_chains_with_dashpots_are_within_the_bound(data):
    """Masses and dashpots far apart and equal, absorbing nearly; on ground that moves, or held."""
    number = st.sampled_from(["1/10", "1/3", "1", "10", "7/5", "1001/1000"])
    parts, names = [data.draw(st.sampled_from([GROUND, "fixed"]))], []
    for k in range(data.draw(st.integers(1, 3))):
        rod = {"rod": data.draw(st.sampled_from(["1", "1/2", "3/4"])), "impedance": data.draw(number)}
        node = {"name": f"n{k}", **data.draw(st.sampled_from([{"mass": "1"}, {"mass": "3"}, {"joint": True}]))}
        for part in (rod, node):
            if data.draw(st.booleans()):
                part["dashpot"] = data.draw(number)
        parts += [rod, node]
        names.append(node["name"])
    loads = [{**PUSH, "at": data.draw(st.sampled_from(names))}]
    if parts[0] is GROUND:
        loads.append(SHAKEN)
    model = chain(parts, loads, velocity=names[-1:], displacement=names[:1], strain=["0"], until=5, tolerance="1/10")
    assume(model.network.loses)
    taus = np.linspace(0, 5, 41)
    try:
        complex_modes.refuse_absorbing(model.network)
    except UnservedError:
        assume(False)
    made = with_modes(model, 40)
    error = np.abs(values(model, made, taus) - exact(model, taus)).max(axis=1)
    assert np.all(error <= made.errors + rounding(model, made))


def test_several_loads_share_the_modes():
    """Two oscillators for each mode at most, whatever their number."""
    model = LOSING["two loads, creeping"]
    made = with_modes(model, 12)
    assert 12 <= len(made.system.frequency) <= 24
    assert np.any(made.system.damping == 1)


def test_what_dashpots_leave_no_modes_of_is_refused():
    """In one line that names the place, and what serves it."""
    end = {"joint": True, "name": "end", "dashpot": "2/3"}
    swallowing = chain(["fixed", {"rod": 1, "impedance": "2/3"}, end], [{**PUSH, "at": "end"}])
    with pytest.raises(
        UnservedError,
        match=r"^system: dashpots as large as the impedance at end return nothing.*pieces or march",
    ):
        modal_system(swallowing)
    between = [
        "fixed",
        {"rod": 1},
        {"joint": True, "name": "n"},
        {"dashpot": "1/2"},
        {"joint": True},
        {"rod": 1},
        {"mass": 1},
    ]
    with pytest.raises(UnservedError, match="dashpots as large as the impedance at n"):
        modal_system(chain(between, [PUSH]))
    floating = chain([{"mass": 1, "name": "n", "dashpot": 1}, {"rod": 1}, {"mass": 1}], [PUSH])
    with pytest.raises(UnservedError, match="dashpots alone, or nothing, hold the chain"):
        modal_system(floating)


def test_places_beside_dashpots_across_rods_are_refused():
    parts = ["fixed", {"rod": 1, "dashpot": "1/3"}, {"mass": 1, "name": "n"}, {"rod": 1}, {"mass": 1}]
    with pytest.raises(
        UnservedError, match=r"^output: velocity@1/2 is inside a rod with a spring or dashpot beside it"
    ):
        modal_system(chain(parts, [PUSH], velocity=["1/2"]))


@pytest.mark.slow
def test_what_nearly_swallows_waves_is_refused_with_numbers():
    end = {"joint": True, "name": "n", "dashpot": "1000001/1000000"}
    model = chain(["fixed", {"rod": 1}, end], [PUSH], velocity=["n"], tolerance="1e-9")
    with pytest.raises(ToleranceError, match=r"1e-09 cannot be met.* \(modes: \d+ modes, the most taken"):
        modal_system(model)


def test_outputs_that_are_0_by_symmetry_are_exactly_0():
    parts = ["fixed" if part == "free" else part for part in SYMMETRIC]
    parts = [{**part, "dashpot": "1/3"} if isinstance(part, dict) and "mass" in part else part for part in parts]
    model = chain(parts, both(-1), velocity=["c", "l"], until=9, tolerance="1/10")
    made = modal_system(model)
    assert (made.bounds > 0).tolist() == [False, True]
    assert not values(model, made, np.linspace(0, 9, 19))[0].any()


@pytest.mark.slow
def test_programs_are_made_of_it(tmp_path):
    """C passes its self-test, of which dashpots in one mode more or less would make a failure."""
    model = LOSING["on moving ground, dashpots across and to the ground"]
    program = make(model, Request(evaluator="modes"), tested=True)
    made = files(program, "all")
    for name, text in made.items():
        (tmp_path / name).write_text(text)
    compiler().run(["-std=c99", "-O2", f"{model.name}.c", f"{model.name}_selftest.c", "-o", "test", "-lm"], tmp_path)
    assert subprocess.run([tmp_path / "test"], capture_output=True, check=False).returncode == 0
    taus = np.linspace(0, 8, 33)
    right = exact(model, taus)
    assert np.all(np.abs(program.evaluate(taus) - right).max(axis=1) <= 1e-2 * np.abs(right).max(axis=1))


def test_what_hardly_moves_keeps_its_digits():
    """A dashpot a million times the impedance: the static shape and a creeping mode have 1e6 as much in common."""
    end = {"joint": True, "name": "n", "dashpot": "1e6"}
    model = chain(["fixed", {"rod": 1}, end], [PUSH], displacement=["n"], until=6, tolerance="1e-2")
    taus = np.linspace(0, 6, 31)
    right, made = exact(model, taus), modal_system(model)
    error = np.abs(values(model, made, taus) - right).max(axis=1)
    assert np.all(error <= made.errors + rounding(model, made))
    assert np.all(made.errors < 1e-9 * np.abs(right).max(axis=1))
