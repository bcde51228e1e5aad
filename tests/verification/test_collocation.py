"""Collocation between fronts against truths of its own: a solved problem, published numbers, and the reference."""

import json
import math
from dataclasses import replace
from fractions import Fraction
from math import ceil
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from scipy.special import eval_laguerre

from tests.support.drawn import scenes
from wavesym.mechanics.gauge import Gauge
from wavesym.numbers.doubles import rational
from wavesym.scene import Scene, lower
from wavesym.verification import integrations
from wavesym.verification.collocation import integrate
from wavesym.verification.problem import corner_problem
from wavesym.verification.reference import known_outputs

ORACLE = Path(__file__).parents[2].parent / "shared" / "oracles" / "rigid_mass_on_fixed_bar.json"


def at(quantity, x, side=0):
    rod = max(1, ceil(Fraction(x)) + (side > 0))
    return Gauge(quantity, rod, rational(Fraction(x)) - (rod - 1))


def scene(system, load=(), until=8, **outputs):
    return Scene(name="scene", system=system, load=list(load), output={"until": until, **outputs})


BUILDING = scene(
    {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "ground"},
    [{"times": [0, "5/2", "13/3"], "a": [1, "1/2", 0], "b": [0, "-1/3", "1/7"]}],
    strain=["1/3", "1-", "1+"],
    velocity=[1, "9/7"],
    displacement=["2/3", 2],
)
COLLISION = scene(
    {"type": "collision", "m": 4, "kappa": ["1/10", "2"], "velocity": [1, "-1/2"]},
    strain=["1-", "1+", 2],
    velocity=["1/2", 3],
    displacement=[4],
)
DRIVE = scene(
    {"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    [{"body": 1, "times": [0, "1/3"], "steps": [1, -2]}, {"body": 3, "times": ["10/7"], "steps": [1]}],
    strain=["1-", "1+", "3/2"],
    velocity=["1/2", 2],
    displacement=[0],
)


def moved(scene, until, points):
    return integrate(corner_problem(lower(scene)), until, points)


def struck(alpha, until, points):
    """The velocity of a mass on a bar fixed at its other end, after an impulse: the derivative of that under a step of
    force, so 1 + alpha * strain.
    """
    mass = 1 / Fraction(alpha)
    system = {"type": "chain", "parts": [{"mass": mass, "name": "a"}, {"rod": 1}, "fixed"]}
    motion = moved(scene(system, [{"at": "a", "times": [0], "steps": [mass]}], until, strain=[0]), until, points)
    return lambda taus: 1 + float(alpha) * motion.evaluate(at("strain", 0), taus)


def solution(alpha, taus):
    """Boussinesq's solution in closed form: velocity p(tau) - p(tau - 2)."""

    def p(tau):
        return sum(math.exp(-alpha * w) * eval_laguerre(k, 2 * alpha * w) for k, w in reflections(tau))

    def reflections(tau):
        return [(k, tau - 2 * k) for k in range(int(tau // 2) + 1)] if tau >= 0 else []

    return np.array([p(tau) - p(tau - 2) for tau in taus])


@pytest.mark.parametrize("alpha", [Fraction(1, 4), Fraction(1), Fraction(3)])
def test_a_struck_bar_to_rounding(alpha):
    taus = np.random.default_rng(1).uniform(0, 12, 300).tolist()
    exact = solution(float(alpha), taus)
    errors = [np.max(np.abs(struck(alpha, 12, points)(taus) - exact)) for points in (4, 8, 16)]
    assert errors[-1] < 1e-12
    assert errors[1] < 1e-3 * errors[0]


@pytest.mark.skipif(not ORACLE.exists(), reason="the shared oracles are not beside the repository")
def test_published_rebounds():
    for row in json.loads(ORACLE.read_text())["rows"]:
        # the ratio is whole in every row, its decimal alpha is not exact
        alpha = Fraction(1, row["mass_ratio_striker_over_bar"])
        end = float(row["contact_duration_c_over_l"])
        before, rebound, after = struck(alpha, 40.0, 16)([end - 1e-3, end, end + 1e-3])
        assert rebound == pytest.approx(float(row["rebound_velocity_over_v0"]), abs=1e-8)
        assert rebound < min(before, after)  # no force any more


@pytest.mark.slow
def test_delays_without_a_common_measure_and_long_horizons_are_no_trouble():
    """Against twice as many points, and a record of many samples, whose panels end at each."""
    parts = [{"mass": 1, "name": "hammer"}, {"rod": 1}, {"rod": "1.414213562"}, {"mass": 2, "name": "anvil"}]
    load = [{"at": "hammer", "spacing": "0.37", "samples": [0, 3, 1, -4, 1, -5, 9, 2, -6, 5, 3, -5, 0]}]
    output = {"until": 12, "velocity": ["anvil", "1/2"], "strain": ["1-", "1+"]}
    made = lower(Scene(name="scene", system={"type": "chain", "parts": parts}, load=load, output=output))
    outcomes = integrations.collocation(known_outputs(made))
    assert all(outcome.passed and float(outcome.cells["at 4N"]) < 1e-12 for outcome in outcomes)


def test_a_jump_is_seen_from_the_right_and_nothing_before():
    """A step of acceleration sends -a / kappa_0 up; at x = 1/3 that arrives at no double."""
    load = {"times": ["1/10"], "a": [1], "b": [0]}
    motion = moved(
        scene({"type": "building", "m": 2, "kappa": ["1/4", 1, 1], "base": "force"}, [load], strain=[0]), 3, 8
    )
    front = Fraction(1, 10) + Fraction(1, 3)
    first = float(front) if Fraction(float(front)) >= front else math.nextafter(float(front), 1)
    before, after = motion.evaluate(at("strain", Fraction(1, 3)), [math.nextafter(first, 0), first])
    assert before == 0
    assert after == pytest.approx(4)


def test_what_cannot_be_asked():
    motion = moved(DRIVE, 4.0, 8)
    for tau in (-1.0, 4.5, math.nan):
        with pytest.raises(ValueError, match="outside"):
            motion.evaluate(at("strain", 0), [tau])


@settings(max_examples=12)
@given(scenes())
def test_agreement_with_the_reference(scene):
    truth = known_outputs(lower(scene))
    for outcome in (*integrations.collocation(truth), *integrations.midpoints(truth)):
        assert outcome.passed, outcome


def changed(kind, number, **changes):
    """A network with a changed point or bar; a change is a function of what stands there."""

    def change(network):
        listed = list(getattr(network, kind))
        one = listed[number]
        listed[number] = replace(one, **{name: of(getattr(one, name)) for name, of in changes.items()})
        return replace(network, **{kind: tuple(listed)})

    return change


def turned(loads):
    return tuple(replace(load, coefficients=tuple(-c for c in load.coefficients)) for load in loads)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("scene", "change"),
    [
        (DRIVE, changed("bars", 1, impedance=lambda z: z * fmpq(1001, 1000))),
        (DRIVE, changed("points", 1, mass=lambda mass: mass * fmpq(1001, 1000))),
        (DRIVE, changed("points", 2, loads=turned)),
        (BUILDING, changed("points", 0, velocity=lambda v: v + fmpq(1, 1000))),
        (BUILDING, changed("points", 2, damping=lambda damping: fmpq(1, 1000))),
        (COLLISION, changed("points", 2, mass=lambda mass: fmpq(1))),
        (COLLISION, changed("bars", 3, velocity=lambda v: fmpq(0))),
    ],
)
def test_a_wrong_network_is_caught(scene, change, monkeypatch):
    truth = known_outputs(lower(scene))
    assert all(outcome.passed for outcome in integrations.collocation(truth))
    wrong = corner_problem(replace(lower(scene), network=change(lower(scene).network)))
    monkeypatch.setattr(integrations, "corner_problem", lambda model: wrong)
    truth = known_outputs(lower(scene))
    assert not all(outcome.passed for outcome in integrations.collocation(truth))
