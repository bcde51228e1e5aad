"""Derivatives by parameters in C: those of exact values, and a mistake in them is seen."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import Phase, settings
from hypothesis import given as drawing
from hypothesis import strategies as st

import wavesym
from tests.support.builds import LANGUAGES, STRICT
from tests.support.built_model import BuiltModel
from tests.support.slopes import beyond, slope_of
from tests.targets.test_runtime_c import CASES, DRIVE, flat, scene_with
from tests.targets.test_runtime_extremes import LOAD, STOREYS
from wavesym.running.toolchain import compiler


def steepness(made, scene, given, count=41):
    """The largest error of any derivative relative to its largest value; the truth from differences of exact values."""
    step = made.until / (count - 1)
    names, own = list(given), flat(given)
    status, found = made.tangents(own, 0.0, step, count)
    assert status == 0
    assert np.all(np.isfinite(found))
    assert made.build(*own) == 0
    assert np.array_equal(found[0], made.sample(0.0, step, count)[1])
    tau = np.array([k * step for k in range(count)])
    worst = 0.0
    lane = 0
    for name in names:
        for k, value in enumerate(map(Fraction, given[name])):
            lane += 1
            small = Fraction(1) if name in ("load", "velocity") else value / 10**5
            values = []
            for other in (value + small, value - small):
                changed = [*given[name][:k], other, *given[name][k + 1 :]]
                values.append(wavesym.evaluator(scene_with(scene, given | {name: changed}))(tau))
            true = (values[0] - values[1]) / float(2 * small)
            largest = np.max(np.abs(true), axis=1)
            assert np.all(np.abs(found[lane][largest == 0]) <= 1e-12)
            errors = np.max(np.abs(found[lane] - true), axis=1)
            worst = max(worst, float(np.max(errors[largest > 0] / largest[largest > 0], initial=0.0)))
    return worst


TANGENTS = {
    "building": {"kappa": ["1/4", "3/5", "1/5"], "load": [1, 0, "-1/2", "-1/4", "1/2", 0]},
    "drive": {"kappa": [1, "1/2"], "inertia": [1, 2, 1], "load": [1, -1, "1/3"]},
    "collision": {"kappa": [1, 2], "velocity": [1, -1]},
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", TANGENTS)
def test_derivatives_are_those_of_exact_values(case, tmp_path):
    # velocities that part are no scene, so those here stay in between
    given = TANGENTS[case] | ({"velocity": [2, -2]} if case == "collision" else {})
    made = BuiltModel(CASES[case][0], list(given), tmp_path)
    # differences leave 1e-10 of second order, and about 1e-16/1e-5 of rounding
    assert steepness(made, CASES[case][0], given) < 1e-8


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        ("add_series(slope->rates", "if (0) add_series(slope->rates"),
        ("&slope->push[port], m->waves", "&tangent->error[1], m->waves"),
        ("accumulate(b->sets, b->inverse, &slope", "accumulate(b->sets, b->inverse, b->law"),
    ],
)
def test_a_mistake_in_derivatives_is_seen(change, tmp_path):
    given = {"kappa": [1, "1/2"]}
    made = BuiltModel(DRIVE, ["kappa"], tmp_path, [change])
    assert steepness(made, DRIVE, given) > 1e-6


def beyond_estimates(made, scene, given, lanes):
    """Errors of derivatives over their estimates, the truth from exact values."""
    step, names = made.until / 64, [(name, k) for name, values in given.items() for k in range(len(values))]
    status, found = made.tangents(flat(given), 0.0, step, 65)
    assert status == 0
    assert made.tangent_estimate(0) > 0
    tau = np.arange(65) * step
    for lane in lanes:
        name, place = names[lane - 1]
        own = Fraction(given[name][place])

        def values(number, name=name, place=place):
            changed = [*given[name][:place], number, *given[name][place + 1 :]]
            return wavesym.evaluator(scene_with(scene, given | {name: changed}))(tau)

        true, slack = slope_of(values, own, abs(own) / 128)
        yield beyond(found[lane], true, slack, made.tangent_estimate(lane))


COARSE = ("real share = ", "real share = 1e-3; static const real fine_share = ")
"""At the lowest degree."""


@pytest.mark.quick(1)
@pytest.mark.parametrize("changes", [[], [COARSE]])
def test_errors_of_derivatives_are_in_their_estimates(changes, tmp_path):
    given = {"kappa": ["7/4", "1/2"]}
    scene = DRIVE.with_({"output.until": 4})
    made = BuiltModel(scene, ["kappa"], tmp_path, changes, flags=("-O0", "-Wno-unused-const-variable"))
    assert max(beyond_estimates(made, scene, given, [1, 2] if changes else [1])) < 1
    assert made.tangent_estimate(1) > 1e-6 if changes else made.tangent_estimate(1) < 1e-9
    assert np.isnan([made.tangent_estimate(lane) for lane in (-1, 3)]).all()
    assert made.tangents([-1, 1], 0.0, 1.0, 1)[0] == 1
    assert np.isnan([made.tangent_estimate(lane) for lane in (0, 1, 2)]).all()


@pytest.mark.slow
def test_an_estimate_without_what_is_missed_is_seen(tmp_path):
    given, scene = {"kappa": ["7/4", "1/2"]}, DRIVE.with_({"output.until": 4})
    changes = [COARSE, ("return 6 * missed + ", "return 0 * missed + ")]
    made = BuiltModel(scene, ["kappa"], tmp_path, changes, flags=("-O0", "-Wno-unused-const-variable"))
    assert max(beyond_estimates(made, scene, given, [1, 2])) > 1000


@pytest.mark.slow
@pytest.mark.parametrize("case", TANGENTS)
def test_estimates_of_derivatives_hold_for_drawn_parameters(case, tmp_path_factory):
    runtime = list(TANGENTS[case])
    made = BuiltModel(CASES[case][0], runtime, tmp_path_factory.mktemp(case))
    counts = {name: len(values) for name, values in TANGENTS[case].items()}
    kappas = st.floats(-2, 2).map(lambda power: Fraction(f"{10**power:.3g}"))
    nearly = st.integers(-3, 3).map(lambda steps: 1 + Fraction(steps, 10**6))

    @settings(max_examples=25, deadline=None, phases=[Phase.generate])
    @drawing(data=st.data())
    def hold(data):
        numbers = st.one_of(kappas, nearly)
        drawn = {name: data.draw(st.lists(numbers, min_size=n, max_size=n)) for name, n in counts.items()}
        if case == "collision":  # bodies that part are no scene
            drawn["velocity"] = [2, -2]
        lane = data.draw(st.integers(1, counts[runtime[0]]))
        if made.tangents(flat(drawn), 0.0, 1.0, 1)[0] == 0:
            assert max(beyond_estimates(made, CASES[case][0], drawn, [lane])) < 1

    hold()


LATE = DRIVE.with_({"output": {"until": "7/4", "tolerance": "1e-10", "velocity": [1], "displacement": [0]}})


@pytest.mark.slow
def test_a_derivative_that_no_wave_has_reached_is_exactly_nothing(tmp_path):
    """The one load is at the left end: what is beyond has not come back; values are there."""
    made = BuiltModel(LATE, ["kappa", "load"], tmp_path)
    given = [1, 0.5, 1, 0, 0]
    found = made.tangents(given, 0.0, 0.1, 15)[1]
    assert found[0, 1].any()
    assert not found[2, 1].any()
    assert found[2, 0].any()
    assert max(made.tangent_estimate(lane) for lane in range(6)) < 1e-9
    (tmp_path / "values").mkdir()
    change = ("is_read(slope, changed, output) ||", "is_read(law, since, output) ||")
    made = BuiltModel(LATE, ["kappa", "load"], tmp_path / "values", [change])
    assert made.tangents(given, 0.0, 0.1, 15)[0] == 0
    assert made.tangent_estimate(2) == np.inf


@pytest.mark.slow
def test_one_that_cancels_is_not_claimed(tmp_path):
    """The derivative of a displacement of 1e-30 that is a difference of waves of 1."""
    made = BuiltModel(STOREYS, ["kappa", "load"], tmp_path)
    assert made.tangents([0.25, 0.6, 1e-30, *LOAD], 0.0, 0.2, 101)[0] == 0
    assert made.tangent_estimate(1) == np.inf


@pytest.mark.parametrize("level", ["-O1", "-O2", "-O3"])
def test_no_masses_are_no_warning(level, tmp_path):
    """Of a rod alone no joint has a state: gcc took what a loop over none of them reads for what was never set."""
    system = {"type": "chain", "parts": [{"joint": True, "name": "end"}, {"rod": 1}, "fixed"]}
    load = {"at": "end", "times": [0], "steps": [1]}
    scene = wavesym.Scene(name="bar", system=system, load=[load], output={"until": 2, "velocity": [0]})
    wavesym.generate(scene, tmp_path, runtime=["impedance"], parts=["gradients"])
    as_said = "-ffp-contract=off"  # so that quick tests, too, compile it at this level
    compiler().run([*LANGUAGES["c99"], *STRICT, level, as_said, "-c", "bar.c", "-o", "bar.o"], tmp_path)
    assert (tmp_path / "bar.o").stat().st_size > 0
