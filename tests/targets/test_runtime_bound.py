"""The proved bound of a model: no error is larger, whatever the parameters, and whatever is wrong on the way."""

import ctypes
from fractions import Fraction

import numpy as np
import pytest

import wavesym
from tests.support.builds import LANGUAGES
from tests.support.built_model import BuiltModel, written
from tests.support.faults import BODIES
from tests.targets.test_runtime_c import BUILDING, CASES, DRIVE, drawn, flat, scene_with
from wavesym.running.toolchain import compiler


def in_doubles(given):
    """Bounds take parameters as the doubles that they are."""
    return {name: [float(value) for value in flat({name: values})] for name, values in given.items()}


def exact(given):
    return {name: [value.as_integer_ratio() for value in values] for name, values in given.items()}


def scene_of(scene, given):
    return scene_with(scene, {name: [f"{p}/{q}" for p, q in values] for name, values in exact(given).items()})


def check(made, scene, given):
    """Bounds are no smaller than errors."""
    given = in_doubles(given)
    status, bound = made.bound(*flat(given))
    assert status == 0
    wrong = made.errors(scene_of(scene, given))
    assert np.all(wrong <= bound)
    return bound, wrong


def test_no_error_is_larger(tmp_path):
    scene, numbers = CASES["building"]
    made = BuiltModel(scene, list(numbers), tmp_path)
    for given in drawn(numbers)[1:3]:
        bound, _ = check(made, scene, given)
        assert np.all(bound < 1e-8)
    for numbers, expected in (([np.nan] * 9, 1), ([1, 1e5, 1e5, *[1] * 6], 2)):
        status, bound = made.bound(*numbers)
        assert status == expected
        assert np.isnan(bound).all()


@pytest.mark.slow
@pytest.mark.parametrize("flags", [("-O1",), ("-O3", "-march=native", "-ffp-contract=fast"), ("-O2", "-DPLAIN")])
@pytest.mark.parametrize("case", CASES)
def test_no_error_is_larger_whatever_the_parameters(case, flags, tmp_path):
    scene, numbers = CASES[case]
    flags = tuple(flag.replace("PLAIN", f"{scene.name.upper()}_PLAIN") for flag in flags)
    made = BuiltModel(scene, list(numbers), tmp_path, flags=flags)
    random = np.random.default_rng(7)
    for given in drawn(numbers):
        bound, _ = check(made, scene, given)
        assert np.all(bound[np.isfinite(bound)] < 1e-6)
    for _ in range(6):
        given = {
            name: (10 ** random.uniform(-3, 2, len(choices[0]))).tolist()
            if name in ("kappa", "inertia")
            else choices[0]
            for name, choices in numbers.items()
        }
        if made.build(*flat(given)) != 2:
            check(made, scene, given)


ROUGH, SENT, LOADED, CUT = BODIES[3], BODIES[4], BODIES[6], BODIES[-1]


@pytest.mark.parametrize("case", ["building", pytest.param("drive", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "change", [pytest.param(each, marks=() if each in (BODIES[0], SENT) else pytest.mark.slow) for each in BODIES]
)
def test_what_is_computed_wrong_is_in_the_bound(change, case, tmp_path):
    if case == "building" and change == LOADED:
        pytest.skip("no load acts on one of its bodies")
    scene, numbers = {"building": (BUILDING, CASES["building"][1]), "drive": (DRIVE, CASES["drive"][1])}[case]
    made = BuiltModel(scene, list(numbers), tmp_path, [change])
    bound, wrong = check(made, scene, {name: choices[-1] for name, choices in numbers.items()})
    assert np.max(wrong) > 1e-11
    assert np.all(bound >= wrong)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "changes",
    [
        (ROUGH, ("apart[port] + w->moves[port] *", "apart[port] + 1e-9 * w->moves[port] *")),
        (BODIES[0], ("(magnitude(total_of(&begins[i])", "(0 * magnitude(total_of(&begins[i])")),
        (
            SENT,
            ("larger(apart[port], here)", "larger(apart[port], 0 * here)"),
            ("w->energy += w->length[panel] *", "w->energy += 0 * w->length[panel] *"),
        ),
        (CUT, ("rest += MAGNITUDE(missed)", "rest += 1e-12 * MAGNITUDE(missed)")),
    ],
)
def test_a_mistake_in_the_bound_is_seen(changes, tmp_path):
    assert_refused(changes, "drive", tmp_path)


def assert_refused(changes, case, folder):
    """Errors of spoiled C are larger than its spoiled bound."""
    scene, numbers = CASES[case]
    made = BuiltModel(scene, list(numbers), folder, changes)
    with pytest.raises(AssertionError):
        check(made, scene, {name: choices[0] for name, choices in numbers.items()})


@pytest.mark.slow
def test_waves_that_are_sent_wrong_add_up_at_an_instant(tmp_path):
    assert_refused((SENT, ("w->instant += w->passes[port]", "w->instant += 0 * w->passes[port]")), "building", tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("mistake", [None, ("(magnitude(back) + 2", "(0 * magnitude(back) + 2")])
def test_what_a_body_sends_wrong_goes_on_through_a_joint(mistake, tmp_path):
    """Behind a joint without mass nothing is computed wrong but what arrives there."""
    scene = wavesym.Scene(
        name="passed",
        system={
            "type": "chain",
            "parts": [{"mass": 1, "name": "a"}, {"rod": 1}, {"rod": 1, "impedance": 2}, "absorbing"],
        },
        load=[{"at": "a", "times": [0], "steps": [1]}],
        output={"until": 5, "tolerance": "1e-11", "strain": ["3/2"]},
    )
    made = BuiltModel(scene, ["mass"], tmp_path, [SENT, mistake] if mistake else [SENT])
    status, bound = made.bound(1)
    wrong = made.errors(scene)
    assert status == 0
    assert wrong > 1e-10
    assert (wrong <= bound) == (mistake is None)


@pytest.mark.slow
def test_a_bound_is_relative_to_what_is_certainly_there(tmp_path):
    """Pulled alike from both sides the middle moves by its own little load alone, and what both pulls round stays: it
    may be as large as the motion, whose largest value is then known to be no less than what is seen less that."""
    parts = [
        {"joint": True, "name": "a"},
        {"rod": 1},
        {"mass": 1, "name": "n"},
        {"rod": 1},
        {"joint": True, "name": "b"},
    ]
    scene = wavesym.Scene(
        name="level",
        system={"type": "chain", "parts": parts},
        load=[{"at": at, "times": [0], "steps": [1]} for at in "anb"],
        output={"until": 3, "tolerance": "1e-9", "velocity": ["n"]},
    )
    made = BuiltModel(scene, ["load"], tmp_path)
    relative, absolute = [], []
    for little in 2.0 ** np.arange(-42, -36):
        _, (bound,) = made.bound(1, little, -1)
        _, values = made.sample(0.0, made.until / 300, 301)
        relative.append(bound)
        absolute.append(np.max(np.abs(values)) * (bound / (1 + bound) if np.isfinite(bound) else 1))
    assert np.isinf(relative[0])
    assert max(relative[1:]) > 1 > min(relative) > 0.01
    assert absolute[1:] == pytest.approx([absolute[-1]] * 5, rel=0.01)
    assert absolute[0] < 1.01 * absolute[-1]


STEPS = 150
STEPPED = wavesym.Scene(
    name="stepped",
    system={"type": "chain", "parts": [{"mass": 1, "name": "m"}, {"rod": 1}, "fixed"]},
    load=[{"at": "m", "times": list(range(STEPS)), "steps": [k % 2 + 1 for k in range(STEPS)]}],
    output={"until": STEPS, "tolerance": "1e-6", "velocity": ["m"]},
)
LOADS = """
#include "stepped.c"
int loads(const double *change, double *load, double *error);
int loads(const double *change, double *load, double *error)
{
    static march_state m;
    static errors w;
    int since[STEPPED_FORCES + 1][2] = {{0}}, event = 0;
    for (int k = 0; k < STEPPED_EVENTS; ++k) {
        m.change[k] = change[k];
    }
    start_loads(&w);
    for (int window = 0; window < STEPPED_WINDOWS; ++window) {
        const int first = event;
        event = apply_loads(&m, 1, since, window, event);
        bound_loads(&w, m.change, window, first);
        load[window] = m.force[0][0][0];
        error[window] = w.force[0][0];
    }
    return event;
}
"""


@pytest.mark.parametrize("change", [None, ("w->roundings[f]) + 8;", "w->roundings[f]) + 0;")])
def test_a_load_of_many_steps_is_wrong_by_no_more_than_its_bound(change, tmp_path):
    """Each step but the first is just below half a rounding of the sum, which therefore never grows: all are lost."""
    written(STEPPED, ["load"], tmp_path, [change] if change else [], parts=["bound"])
    (tmp_path / "loads.c").write_text(LOADS)
    compiler().run([*LANGUAGES["c99"], "-O0", "-fPIC", "-shared", "loads.c", "-o", "loads.so"], tmp_path)
    changes = np.array([1.0, *[0.99 * 2.0**-53] * (STEPS - 1)])
    load, error = np.empty(STEPS + 1), np.empty(STEPS + 1)
    places = (ctypes.c_void_p(array.ctypes.data) for array in (changes, load, error))
    assert ctypes.CDLL(str(tmp_path / "loads.so")).loads(*places) == STEPS
    lost = [sum(map(Fraction, changes[: k + 1])) - Fraction(load[k]) for k in range(STEPS)]
    assert lost[-1] > 60 * Fraction(2) ** -52
    assert all(lost[k] <= Fraction(error[k]) for k in range(STEPS)) == (change is None)


PULSE = wavesym.Scene(
    name="pulse",
    system={"type": "chain", "parts": [{"mass": 1, "name": "m"}, {"rod": 1}, "absorbing"]},
    load=[{"at": "m", "times": ["0.999999", "1.000001", "1.000002"], "ramps": [1, -3, 2]}],
    output={"until": "3/2", "tolerance": "1e-13", "velocity": ["m"]},
)
AT = "since_panel[panel * PULSE_PANELS + since[1]]"
CANCELLED = [
    ("(panel < since[1] ? 1 : 0)", "0"),
    (AT, f"({AT} - (panel < since[1] ? window_length : (real)0))"),
]
"""The same, as the windows between less how much earlier a panel starts: small differences of large numbers."""


@pytest.mark.parametrize("changes", [[], CANCELLED], ids=["right", "cancelled"])
def test_the_time_since_a_load_changed_keeps_its_digits(changes, tmp_path):
    """A load of three millionths begins one before a window does: what its time loses is lost for good."""
    made = BuiltModel(PULSE, ["mass"], tmp_path, changes)
    status, bound = made.bound(1)
    assert status == 0
    assert bound < 1e-12
    assert (made.errors(PULSE) <= bound) == (not changes)
