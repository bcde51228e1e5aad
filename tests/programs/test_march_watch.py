"""What the generator sees of an output: what the program gives there, and nothing from beyond the horizon."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import inf

import numpy as np
import pytest
from flint import fmpq

from tests.support.generated import assemble, program_files
from tests.support.truth import Truth
from wavesym.errors import ToleranceError
from wavesym.programs.choice import choose
from wavesym.programs.march import run as running
from wavesym.programs.march.evaluator import marched
from wavesym.programs.march.plan import MarchPanel, Stretch
from wavesym.programs.march.run import LEFT, RIGHT, Run
from wavesym.programs.march.sampler import OutputSampler
from wavesym.running.compiled import compiled
from wavesym.scene import Scene, lower

LOAD = {"times": ["1/3", "5/2"], "a": [1, "-1/2"], "b": ["-1/4", 0]}
PLACES = [0, "1/3", "1/2", 1, "8/5", 2]


def building(until, load=LOAD, **outputs):
    outputs = outputs or dict.fromkeys(("strain", "velocity", "displacement"), PLACES)
    if "strain" in outputs:
        outputs |= {"strain": [f"{x}-" if x == 1 else x for x in outputs["strain"]]}
    return Scene(
        name="made",
        system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
        load=[load],
        output={"until": until, "tolerance": "1e-3", **outputs},
    )


def program(scene, made):
    return assemble(made).evaluate


@pytest.mark.parametrize("until", [3, "29/8"])
def test_the_generator_sees_what_the_program_gives(until):
    scene = building(until)
    made = marched(lower(scene))
    (block,) = Run(made.plan, made.degree).blocks()
    values = [OutputSampler(made.plan, output, made.degree).values(block) for output in made.plan.outputs]
    windows = np.arange(made.plan.windows)[:, np.newaxis]
    taus = windows + np.linspace(0, np.minimum(1, made.tau_max - windows[:, 0]), 17).T
    # at the end of a window it sees what was there before a jump, the program what comes after it
    inner = taus - np.where(taus == windows + 1, 1e-14, 0)
    expected = program(scene, made)(inner)
    sizes = np.max(np.abs(expected), axis=(1, 2), keepdims=True)
    np.testing.assert_allclose(values / sizes, expected / sizes, rtol=0, atol=1e-12)


def test_a_front_counts_from_its_own_instant_on():
    """At every sixteenth of a window one front or none: before it all is still."""
    for start in (Fraction(1, 16), Fraction(5, 16), Fraction(15, 16)):
        scene = building(3, {"times": [start], "a": [1], "b": [0]}, strain=[0, "1/2"], velocity=["1/4"])
        made = marched(lower(scene))
        (block,) = Run(made.plan, made.degree).blocks()
        for output, x in zip(made.plan.outputs, (0, 0.5, 0.25), strict=True):
            seen = OutputSampler(made.plan, output, made.degree).values(block).ravel()
            points = np.concatenate([n + np.linspace(0, 1, 17) for n in range(3)] + [np.full(17, 3.0)])
            assert (seen[points < start + x] == 0).all()
            # the end of a window belongs to it
            later = (points >= start + x) & ~((points == float(start + x)) & (points % 1 == 0))
            assert (np.abs(seen[later][:8]) > 0.1).all()


def test_a_displacement_is_summed_up_from_block_to_block(monkeypatch):
    made = marched(lower(building("29/8")))
    outputs = made.plan.outputs
    (whole,) = Run(made.plan, made.degree).blocks()
    monkeypatch.setattr(running, "_BLOCK", 1)
    watches = [OutputSampler(made.plan, output, made.degree) for output in outputs]
    parts = [[watch.values(block) for watch in watches] for block in Run(made.plan, made.degree).blocks()]
    expected = [OutputSampler(made.plan, output, made.degree).values(whole) for output in outputs]
    np.testing.assert_allclose(np.concatenate(parts, axis=1), expected, rtol=0, atol=1e-13)


def test_sizes_are_those_of_both_waves_on_the_larger_panel():
    made = marched(lower(building("29/8")))
    (block,) = Run(made.plan, made.degree).blocks()
    weights = np.arange(1.0, made.degree + 2)
    assert len(made.plan.panels) == 3
    for output in made.plan.outputs:
        right, left = output.heard
        expected = [
            max(
                weights @ np.abs(waves[n, RIGHT, p, right.column + 1])
                + weights @ np.abs(waves[n, LEFT, p, left.column + 1])
                for waves in (block.before, block.after)
                for p in range(3)
            )
            for n in range(made.plan.windows)
        ]
        sampler = OutputSampler(made.plan, output, made.degree)
        np.testing.assert_allclose(sampler.size(block, weights, summed=right.summed), expected, rtol=1e-14)
        assert not np.any(sampler.size(block, weights, summed=not right.summed))


def drive(until, time=0, tolerance="1e-10"):
    return Scene(
        name="made",
        system={"type": "drive", "m": 3, "kappa": [1, 1, 1], "inertia": [1, 1, 1, 1]},
        load=[{"body": 1, "times": [time], "steps": [1]}],
        output={"until": until, "tolerance": tolerance, "velocity": [3]},
    )


@pytest.mark.parametrize("until", ["3.1", "3.01", "3.001", "3.000001"])
@pytest.mark.parametrize("evaluator", ["march", "auto"])
def test_what_has_just_arrived_is_within_its_bound(until, evaluator):
    check_arrived(drive(until), evaluator, "numpy")
    if until == "3.01":
        check_arrived(drive(until), evaluator, "c")


@pytest.mark.parametrize("start", [60, pytest.param(30000, marks=pytest.mark.slow)])
def test_what_has_just_arrived_after_a_long_time_is_too(start):
    try:
        check_arrived(drive(f"{start + 3}.001", start, "1e-6"), "auto", "numpy")
    except ToleranceError as refused:
        assert "may be as large as" in str(refused)  # noqa: PT017, the other outcome that is right


def check_arrived(scene, evaluator, language):
    """The error is no more than the bound of the largest true value."""
    made = marched(lower(scene)) if evaluator == "march" else choose(lower(scene)).evaluator
    until = Fraction(made.tau_max)
    truth = Truth(scene, until)
    largest, above = truth.largest(0, until)
    assert made.outputs[0].largest <= float(above)
    (arrival,) = [tau for tau in truth.arrivals(0) if tau < until]
    taus = [float(arrival + (until - arrival) * Fraction(k, 64)) for k in range(65)]
    if made.error_bound == inf:  # nothing is printed
        return
    (values,) = values_of(scene, made, taus, language)
    errors = [
        abs(truth.value(0, Fraction(tau)) - exact(value)) for tau, value in zip(taus, values.tolist(), strict=True)
    ]
    assert max(map(float, errors)) <= made.error_bound * float(largest)


def values_of(scene, made, taus, language):
    if language == "numpy":
        return assemble(made).evaluate(np.array(taus))
    sources = program_files(lower(scene), made, "c")
    sources[f"{scene.name}_selftest.c"] = "int main(void)\n{\n    return 0;\n}\n"
    with compiled(sources, 1) as run:
        return run(taus)


@pytest.mark.parametrize(
    ("delay", "panels", "expected"),
    [
        (0, [0], [(0, 0, 0)]),
        (1, [0], [(0, 1, 0)]),
        ("1/4", [0], [("-3/4", 1, 0), ("1/4", 0, 0)]),
        (0, [0, "1/3"], [(0, 0, 0), ("1/3", 0, 1)]),
        (1, [0, "1/3"], [(0, 1, 0), ("1/3", 1, 1)]),
        ("2/3", [0, "1/3"], [(0, 1, 1), ("2/3", 0, 0)]),
        ("1/2", [0, "1/3"], [("-1/6", 1, 1), ("1/2", 0, 0), ("5/6", 0, 1)]),
        ("1/6", [0, "1/3"], [("-1/2", 1, 1), ("1/6", 0, 0), ("1/2", 0, 1)]),
        ("5/6", [0, "1/3"], [("-1/6", 1, 0), ("1/6", 1, 1), ("5/6", 0, 0)]),
    ],
)
def test_stretches_cover_the_window_once(delay, panels, expected):
    cuts = [*map(exact, panels), fmpq(1)]
    made = replace(
        marched(lower(building(1))).plan,
        panels=tuple(MarchPanel(low, high - low) for low, high in pairwise(cuts)),
    )
    assert made.stretches(exact(delay)) == tuple(Stretch(exact(start), back, p) for start, back, p in expected)


def exact(number):
    return fmpq(*Fraction(number).as_integer_ratio())
