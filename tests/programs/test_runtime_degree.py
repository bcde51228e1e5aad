"""The degree of parameters at run time: the first whose march misses nothing from the start on, however it is found."""

from dataclasses import fields, replace

import numpy as np
import pytest
from flint import fmpq
from wavesym.programs.runtime.line import plan
from wavesym.programs.runtime.run import Run, Since

from tests.support.shaken import SAMPLES, shaken
from wavesym import Scene, model
from wavesym.errors import CostError
from wavesym.programs.march.plan import Panel
from wavesym.programs.runtime import degree as choosing
from wavesym.programs.runtime.degree import LEAST, raised
from wavesym.scene import lower

# found among 600 drawn scenes: going on from window 27 degree 27 seems enough, from the start on 33 is needed
NARROW = Scene(
    name="narrow",
    system={
        "type": "drive",
        "m": 3,
        "kappa": ["711/10000", "161/5000", "8393/400"],
        "inertia": ["15067/1250", "10357/2000", "7111/5000", "195601/5000"],
    },
    load=[{"body": 1, "times": [0, "5/4"], "steps": [1, -1]}],
    output={"until": "323/7", "tolerance": "1e-6", "velocity": ["1/2"]},
)
SHAKEN = shaken(SAMPLES, "3/4", until=20)
STIFF = lower(
    Scene(
        name="stiff",
        system={"type": "building", "m": 2, "kappa": [1, 60, "1/3"], "base": "ground"},
        load=[{"spacing": "3/4", "samples": SAMPLES}],
        output={"until": 18, "drift": [1]},
    )
)


def marched(prepared, degree):
    """What each window misses of the largest wave so far: rate h/(4 (d + 1)) |q_d - p_d| of all bodies and panels."""
    missed, sizes = [], [0.0]
    for block in Run(prepared, degree).blocks():
        for n in range(len(block.after)):
            total = 0.0
            for p, panel in enumerate(prepared.panels):
                for c, node in enumerate(prepared.junctions):
                    if node.rate is not None:
                        total += float(node.rate * panel.length) / (4 * (degree + 1)) * abs(block.excess[n, p, c])
            waves = np.abs(block.after[n, :2, :, 1:-1, 0])
            sizes.append(max(sizes[-1], np.max(waves), np.max(np.abs(block.ends[n]))))
            missed.append(total / sizes[-1] if total else 0.0)
    return np.array(missed)


@pytest.mark.parametrize(
    ("model", "allowed"),
    [(lower(NARROW), 1e-6 / (24 * 47)), (STIFF, 1e-13), (STIFF, 1e-5)],
    ids=["narrow", "stiff", "roughly"],
)
def test_it_is_the_first_degree_that_misses_nothing_from_the_start(model, allowed):
    prepared = plan(model)
    expected = LEAST
    while np.max(missed := marched(prepared, expected)) > allowed:
        found = choosing._first_missed(Run(prepared, expected), allowed, None, 0.0)
        assert found
        assert found[0].window == np.argmax(missed > allowed)
        expected = raised(expected)
    assert choosing._enough(prepared, LEAST, allowed) == expected > LEAST


def test_going_on_alone_finds_less():
    """Why the degree is tried from the start."""
    prepared, allowed, degree = plan(lower(NARROW)), 1e-6 / (24 * 47), LEAST
    missed = choosing._first_missed(Run(prepared, degree), allowed, None, 0.0)
    while missed:
        degree = raised(degree)
        missed = choosing._first_missed(Run(prepared, degree), allowed, *missed)
    assert degree < choosing._enough(prepared, LEAST, allowed)


@pytest.mark.parametrize("window", [1, 7, 19])
def test_a_march_goes_on_as_if_it_had_not_been_left(window):
    """At the same degree to the last bit; loads between their events included."""
    prepared = plan(SHAKEN)
    (whole,) = Run(prepared, 12).blocks()
    since = Since(window, whole.before[window], whole.starts[window, 0])
    parts = list(Run(prepared, 12).blocks(since, 4))
    assert [len(part.ends) for part in parts[:-1]] == [4] * (len(parts) - 1)
    for of in fields(whole):
        rest = np.concatenate([getattr(part, of.name) for part in parts])
        np.testing.assert_array_equal(rest, getattr(whole, of.name)[window:])


def test_a_march_that_goes_on_at_a_higher_degree_misses_what_was_left_out_alone():
    """Where the lower degree has missed nothing there is hardly a difference."""
    prepared = plan(SHAKEN)
    (low,), (high,) = Run(prepared, 40).blocks(), Run(prepared, 60).blocks()
    (on,) = Run(prepared, 60).blocks(Since(9, low.before[9], low.starts[9, 0]))
    np.testing.assert_allclose(on.ends, high.ends[9:], rtol=0, atol=1e-12 * np.max(np.abs(high.ends)))


def test_panels_of_any_lengths_are_marched_one_after_the_other():
    """q'/rate + q = p with p constant on each panel: the solution is known."""
    tenth = fmpq(1, 10)
    panels = Panel(fmpq(0), tenth), Panel(tenth, 4 * tenth), Panel(5 * tenth, 5 * tenth)
    prepared = replace(plan(SHAKEN), panels=panels)
    run = Run(prepared, 30)
    rng = np.random.default_rng(3)
    p = np.zeros((2, len(prepared.panels), len(prepared.junctions), 31))
    p[..., 0] = rng.uniform(-1, 1, p.shape[:-1])
    start = rng.uniform(-1, 1, p.shape[:1] + p.shape[2:3])
    q, starts, ends = run.moved(p, start)
    now = start.copy()
    for k, panel in enumerate(prepared.panels):
        np.testing.assert_allclose(starts[:, k], now, rtol=0, atol=1e-13)
        for c, node in enumerate(prepared.junctions):
            if node.rate is not None:
                decay = np.exp(-float(node.rate * panel.length))
                now[:, c] = p[:, k, c, 0] + (now[:, c] - p[:, k, c, 0]) * decay
                np.testing.assert_allclose(np.sum(q[:, k, c], axis=-1), now[:, c], rtol=0, atol=1e-13)
        np.testing.assert_allclose(ends[:, k], now, rtol=0, atol=1e-13)


def test_whose_rates_are_too_much_is_said(monkeypatch):
    monkeypatch.setattr(choosing, "_HIGHEST", 40)
    with pytest.raises(CostError, match=r"^output.until: rates to 100 for kappa up to 100 need polynomials of degree"):
        model(Scene.from_toml("drive_m1"), ["kappa"])
