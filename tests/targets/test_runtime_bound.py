"""The proved bound of a model: no error is larger, whatever the parameters, and whatever is wrong on the way."""

import numpy as np
import pytest

import wavesym
from tests.support.built_model import BuiltModel
from tests.targets.test_runtime_c import BUILDING, CASES, DRIVE, drawn, flat, scene_with


def errors(made, scene, count=301):
    """Of each output the largest error relative to its largest value; below, by no more than what samples miss."""
    step = made.until / (count - 1)
    _, found = made.sample(0.0, step, count)
    true = wavesym.evaluator(scene)(np.array([k * step for k in range(count)]))
    largest = np.max(np.abs(true), axis=1)
    wrong = np.max(np.abs(found - true), axis=1)
    assert np.all(wrong[largest == 0] == 0)
    return wrong / np.where(largest > 0, largest, 1)


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
    wrong = errors(made, scene_of(scene, given))
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


# what is computed wrong, so that errors are far above rounding: what is sent is judged, not how it was found
WRONG = [
    ("const real begun = 2 * ratio[1]", "const real begun = 1.9999999 * ratio[1]"),
    ("first[k] = (real)(k % 2 ? -1 : 1)", "first[k] = (real)(k % 2 ? -1.0000001 : 1)"),
    ("last[k] = 1 - ratio", "last[k] = 1.0000001 - ratio"),
    ("y[j] = q[j][k] - ratio", "y[j] = q[j][k] * (k == 3 ? 1.0000001 : 1) - ratio"),
    ("right[k] = sent[k] - b[k];", "right[k] = sent[k] - (k == 1 ? 1.0000001 : 1) * b[k];"),
    ("p[k] = alpha * a[k] + beta * b[k];", "p[k] = alpha * a[k] + (k == 0 ? 1.0000001 : 1) * beta * b[k];"),
    ("[LEAK] * magnitude(q[j]", "[LEAK] * 0 * magnitude(q[j]"),
]
ROUGH, CUT = WRONG[3], WRONG[-1]


@pytest.mark.parametrize("case", ["building", pytest.param("drive", marks=pytest.mark.slow)])
@pytest.mark.parametrize("change", [WRONG[0], *(pytest.param(change, marks=pytest.mark.slow) for change in WRONG[1:])])
def test_what_is_computed_wrong_is_in_the_bound(change, case, tmp_path):
    scene, numbers = {"building": (BUILDING, CASES["building"][1]), "drive": (DRIVE, CASES["drive"][1])}[case]
    made = BuiltModel(scene, list(numbers), tmp_path, [change])
    bound, wrong = check(made, scene, {name: choices[-1] for name, choices in numbers.items()})
    assert np.max(wrong) > 1e-11
    assert np.all(bound >= wrong)


@pytest.mark.parametrize(
    "changes",
    [
        (
            ROUGH,
            ("*energy += moved_by * (2 *", "*energy += 1e-9 * moved_by * (2 *"),
            ("w->energy += w->mass[node] * magnitude(", "w->energy += 1e-9 * magnitude("),
        ),
        (ROUGH, ("const real velocity = w->energy / w->mass[node];", "const real velocity = 0;")),
        (CUT, ("missed += MAGNITUDE(rest) +", "missed += 0 * MAGNITUDE(rest) +")),
        (CUT, ("moved_by * (2 * missed +", "moved_by * (1e-9 * missed +")),
    ],
)
def test_a_mistake_in_the_bound_is_seen(changes, tmp_path):
    made = BuiltModel(DRIVE, list(CASES["drive"][1]), tmp_path, changes)
    with pytest.raises(AssertionError):
        check(made, DRIVE, {name: choices[0] for name, choices in CASES["drive"][1].items()})
