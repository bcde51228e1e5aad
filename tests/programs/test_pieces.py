"""Pieces: their waves against the exact tables, their bound against balls, and no more modelled than is needed."""

import re

import numpy as np
import pytest
from flint import arb, ctx, fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

import wavesym
from tests.support.drawn import scenes
from tests.support.generated import files, numpy_text
from wavesym.errors import CostError, ToleranceError
from wavesym.exact.motion import Motion
from wavesym.exact.reference import Reference
from wavesym.exact.tables.ball import Balls, segments
from wavesym.exact.tables.signal import signals
from wavesym.numbers.doubles import rational
from wavesym.programs import pieces
from wavesym.programs.choice import attempt, choose
from wavesym.running.compilation import compile_files, import_text
from wavesym.scene import lower

SCENES = {
    "B": {
        "system": {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
        "load": [{"times": [0], "a": [1], "b": [0]}],
        "output": {"until": 20, "strain": ["1/2", "3/2"], "velocity": ["1/2", "3/2"]},
    },
    "D": {
        "system": {"type": "drive", "m": 3, "kappa": [1, 1, 1], "inertia": [1, 1, 1, 1]},
        "load": [{"body": 1, "times": [0], "steps": [1]}, {"body": 4, "times": [3], "steps": ["1/2"]}],
        "output": {"until": 40, "strain": ["1/2", "3/2", "5/2"]},
    },
    "C": {
        "system": {"type": "collision", "m": 4, "kappa": ["1/10", "1/5"], "velocity": [1, "-1/2"]},
        "output": {"until": 10, "strain": [2]},
    },
}


def scene(name, tolerance="1e-14"):
    fields = SCENES[name]
    return wavesym.Scene(name=name, **{**fields, "output": {**fields["output"], "tolerance": tolerance}})


@settings(max_examples=25, deadline=None)
@given(scenes(), st.randoms(use_true_random=False))
def test_waves_on_windows_and_exact_tables_agree_to_30_digits(drawn, random):
    until = rational(lower(drawn).horizon())
    motion = Motion(lower(drawn), until)
    with ctx.workprec(512):
        for signal, place in zip(signals(lower(drawn)), motion.probes, strict=True):
            tables, windows = Balls(segments(signal, ctx.prec)), Balls(motion.segments(place, ctx.prec))
            largest = tables.largest(until)
            size = largest if largest > 0 else arb(1)  # 0 by symmetry, which balls on windows do not know
            for _ in range(10):
                tau = rational(random.uniform(0, float(until)))
                difference = tables.evaluate(tau) - windows.evaluate(tau)
                assert difference.contains(0)
                assert difference.rad() <= size * arb(fmpq(1, 10**30))


@settings(max_examples=12, deadline=None)
@given(
    scenes(),
    # the last of them is below what single precision can have: refused, and its bound must hold all the same
    st.sampled_from([("double", "1e-10"), ("single", "1e-5"), ("single", "1e-9")]),
    st.randoms(use_true_random=False),
)
def test_no_error_is_above_the_bound(drawn, asked, random):
    precision, tolerance = asked
    drawn = drawn.with_({"output.tolerance": tolerance})
    tried = attempt(lower(drawn), "pieces", precision, asked=True)
    form = tried.form
    assert form
    assert bool(tried.refusal) == (rational(min(form.error_bound, 2.0)) > lower(drawn).tolerance)
    taus = sorted(
        {form.real.nearest(rational(random.uniform(0, form.tau_max))) for _ in range(60)} | set(form.check_points)
    )
    reference = Reference(lower(drawn))
    expected = np.array(reference.values(taus))
    found = import_text(numpy_text(lower(drawn), form), "drawn").evaluate(np.array(taus))
    for output, size, row, true in zip(form.outputs, reference.largest(), found, expected, strict=True):
        # the reference itself is rounded; `size` is a lower bound that the proof did not use
        assert np.abs(row - true).max() <= (output.bound + 2.0**-53) * max(float(size.mid()), np.abs(true).max()), (
            output
        )


@pytest.mark.quick(1)
@pytest.mark.parametrize("count", [2000, pytest.param(100_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", SCENES)
def test_the_bound_is_met_and_is_near_the_error(name, count):
    """Three scenes at 1e-14: the proved bound holds at random tau and all edges, and is at most 50 times the error."""
    chosen = scene(name)
    made = files(lower(chosen), "all", "pieces")
    module = import_text(made[f"{name}.py"], name)
    assert module.ERROR_BOUND <= 1e-14
    form = choose(lower(chosen), "pieces").evaluator
    taus = np.sort(np.concatenate([np.random.default_rng(7).uniform(0, form.tau_max, count), form.check_points]))
    expected = np.array(Reference(lower(chosen)).values(taus.tolist()))
    with compile_files(made, len(form.outputs)) as program:
        values = program(taus.tolist())
        assert program.selftest() == 0
        _, sampled = program.sample(0.0, form.tau_max / 1000, 1001)
    largest = np.abs(expected).max(axis=1, keepdims=True)
    worst = (np.abs(values - expected) / largest).max()
    assert worst <= module.ERROR_BOUND * (1 + 1e-2)  # the sampled largest value may be a little low
    assert 50 * worst >= module.ERROR_BOUND
    steps = [k * (form.tau_max / 1000) for k in range(1001)]
    with compile_files(made, len(form.outputs)) as program:
        np.testing.assert_array_equal(np.isnan(sampled), np.isnan(program(steps)))
        np.testing.assert_allclose(sampled, program(steps), rtol=0, atol=2 * module.ERROR_BOUND * largest.max())


def test_a_changed_coefficient_fails_the_self_test(thorough):
    made = files(lower(scene("C")), "c", "pieces")
    table = re.search(r"coefficient\[\] = \{(.*?)\};", made["C.c"], re.DOTALL)
    numbers = [n for n in re.findall(r"-?\d\.\d+(?:e-?\d+)?", table[1]) if abs(float(n)) > 0.5]
    for number in numbers[:: len(numbers) // (5 if thorough else 2)]:
        wrong = made["C.c"].replace(number, repr(float(number) * (1 + 1e-9)), 1)
        with compile_files({**made, "C.c": wrong}, 1) as program:
            assert program.selftest() == 1, number


def test_sample_keeps_to_the_rules_out_of_range():
    made = files(lower(scene("B", "1e-8")), "c", "pieces")
    with compile_files(made, 4) as program:
        assert program.sample(0.0, 1.0, 0)[0] == 0
        for tau0, step, count in (
            (-3.0, 0.01, 3000),
            (25.0, -0.007, 4000),
            (5.0, 0.0, 50),
            (0.0, 7.0, 10),
            (1e300, -1e300, 3),
        ):
            status, values = program.sample(tau0, step, count)
            taus = [tau0 + k * step for k in range(count)]
            inside = np.array([0 <= tau <= 20 for tau in taus])
            assert status == int(not inside.all())
            assert np.isnan(values[:, ~inside]).all()
            np.testing.assert_allclose(values[:, inside], program([t for t in taus if 0 <= t <= 20]), rtol=0, atol=1e-6)
        assert program.sample(float("nan"), 1.0, 3)[0] == 1


def chain_of(m):
    system = {
        "type": "collision",
        "m": m,
        "kappa": ["1/10", "1/5"] * (m // 4),
        "velocity": [1, -1] + [-1] * (m // 2 - 2),
    }
    return wavesym.Scene(name="cone", system=system, output={"until": 10, "strain": ["3+", 4, "5-"]})


@pytest.mark.slow
def test_what_is_outside_the_light_cone_is_not_modelled():
    """1000 rods, watched near one end until tau = 10, make the same files as 16."""
    for kind in ("auto", "closed"):
        of_few, of_many, of_less = (sources(chain_of(m), kind) for m in (16, 1000, 12))
        assert of_many == of_few
        assert of_few != of_less


def sources(scene, kind):
    """All files but the manifest, and without the line of the header that has the hash of the scene."""
    made = files(lower(scene), "all", kind)
    return {
        name: re.sub(r"^#define CONE_SCENE_SHA256 .*\n", "", text, flags=re.MULTILINE)
        for name, text in made.items()
        if not name.endswith(".json")
    }


def test_auto_takes_what_meets_the_tolerance_and_says_why():
    name, _, reason, _ = choose(lower(scene("D")))
    assert name == "pieces"
    assert re.fullmatch(
        r"closed: loses (all|\d+) digits after tau = .*; pieces, degree \d+\.\.\d+, \d+ KiB, bound .*", reason
    )
    with pytest.raises(ToleranceError, match="cannot be met"):
        choose(lower(scene("D", "1e-17")))


@pytest.mark.slow
def test_tables_scale_with_the_tolerance():
    sizes = [
        choose(lower(scene("B", tolerance)), "pieces", "single", optimize="size").evaluator.bytes
        for tolerance in ("1e-2", "1e-4", "1e-6")
    ]
    assert sizes == sorted(sizes)
    assert sizes[-1] < choose(lower(scene("B")), "pieces").evaluator.bytes / 4


@pytest.mark.slow
def test_pieces_that_would_take_minutes_are_refused():
    """Many reflections of light bodies need more bits than can be had in time; auto then takes the march."""
    system = {"type": "drive", "m": 1, "kappa": [5], "inertia": [1, 1]}
    load = [{"body": 1, "times": [0], "steps": [1]}]
    output = {"until": 800, "tolerance": "1e-5", "strain": ["1/2"]}
    heavy = wavesym.Scene(name="heavy", system=system, load=load, output=output)
    with pytest.raises(CostError, match=r"[0-9]+ bits would be needed for pieces to tau = 800, the limit is 1024"):
        choose(lower(heavy), "pieces")
    assert choose(lower(heavy)).name == "march"


def test_an_output_that_cancels_throughout_is_nothing():
    """In the middle of what is symmetric waves arrive, and no number of bits tells that they add up to 0."""
    symmetric = wavesym.Scene(
        name="symmetric",
        system={"type": "collision", "m": 6, "kappa": ["1/2", "1/2", "1/2"], "velocity": [1, 0, -1]},
        output={"until": 3, "tolerance": "1e-10", "strain": ["3-"], "velocity": ["3-"]},
    )
    form = choose(lower(symmetric), "pieces").evaluator
    assert [output.largest > 0 for output in form.outputs] == [True, False]
    assert not any(c for grid in form.grids for piece in grid.powers for c in piece[grid.outputs.index(1)])


def test_more_pieces_than_can_be_fitted_soon_are_refused(monkeypatch):
    monkeypatch.setattr(pieces, "_MOST_WORK", 128 * 100)
    choose(lower(short(places=1)), "pieces")
    with pytest.raises(CostError, match="pieces would be fitted"):
        choose(lower(short(places=10)), "pieces")


def short(places):
    return wavesym.Scene(
        name="brief",
        system={"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 1]},
        load=[{"body": 1, "times": [0], "steps": [1]}],
        output={"until": 10, "tolerance": "1e-6", "strain": [f"{k + 1}/{places + 1}" for k in range(places)]},
    )
