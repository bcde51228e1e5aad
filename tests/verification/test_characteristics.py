"""Direct integration against truths of its own: a solved problem, conservation laws, and the reference."""

import json
import math
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import ceil
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import eval_laguerre

from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import rational
from wavesym.scene import Scene, lower
from wavesym.verification import checks
from wavesym.verification.characteristics import integrate
from wavesym.verification.graph import graph
from wavesym.verification.reference import known

ORACLE = Path(__file__).parents[2].parent / "shared" / "oracles" / "rigid_mass_on_fixed_bar.json"


def at(quantity, x, side=0):
    rod = max(1, ceil(Fraction(x)) + (side > 0))
    return Probe(f"{quantity}@{x}", quantity, rod, rational(Fraction(x)) - (rod - 1))


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


def moved(scene, until, steps):
    return integrate(graph(lower(scene)), until, steps)


def struck(alpha, until, steps):
    """The velocity of a mass on a bar fixed at its other end, after an impulse: the derivative of that under a step of
    force, so 1 + alpha * strain.
    """
    mass = 1 / Fraction(alpha)
    system = {"type": "chain", "parts": [{"mass": mass, "name": "a"}, {"rod": 1}, "fixed"]}
    motion = moved(scene(system, [{"at": "a", "times": [0], "steps": [mass]}], until, strain=[0]), until, steps)
    return lambda taus: 1 + float(alpha) * motion.at(at("strain", 0), taus)


def solution(alpha, taus):
    """Boussinesq's solution in closed form: velocity p(tau) - p(tau - 2)."""

    def p(tau):
        return sum(math.exp(-alpha * w) * eval_laguerre(k, 2 * alpha * w) for k, w in reflections(tau))

    def reflections(tau):
        return [(k, tau - 2 * k) for k in range(int(tau // 2) + 1)] if tau >= 0 else []

    return np.array([p(tau) - p(tau - 2) for tau in taus])


@pytest.mark.parametrize("alpha", [Fraction(1, 4), Fraction(1), Fraction(3)])
def test_a_struck_bar_to_fourth_order(alpha):
    taus = np.random.default_rng(1).uniform(0, 12, 300).tolist()
    exact = solution(float(alpha), taus)
    errors = [np.max(np.abs(struck(alpha, 12, steps)(taus) - exact)) for steps in (32, 64, 128)]
    assert errors[-1] < 3e-6
    assert all(math.log2(coarse / fine) > 3.8 for coarse, fine in pairwise(errors))


@pytest.mark.skipif(not ORACLE.exists(), reason="the shared oracles are not beside the repository")
def test_published_rebounds():
    for row in json.loads(ORACLE.read_text())["rows"]:
        # the ratio is whole in every row, its decimal alpha is not exact
        alpha = Fraction(1, row["mass_ratio_striker_over_bar"])
        end = float(row["contact_duration_c_over_l"])
        before, rebound, after = struck(alpha, 40.0, 64)([end - 1e-3, end, end + 1e-3])
        assert rebound == pytest.approx(float(row["rebound_velocity_over_v0"]), abs=1e-8)
        assert rebound < min(before, after)  # no force any more


@pytest.mark.parametrize("scene", [BUILDING, COLLISION, DRIVE], ids=["building", "collision", "drive"])
def test_fourth_order_against_the_reference(scene):
    truth = known(lower(scene))
    motions = [moved(scene, truth.until, steps) for steps in (32, 64, 128)]
    for output in truth.outputs:
        errors = [output.error(motion.at(output.probe, truth.taus)) for motion in motions]
        assert errors[-1] < 1e-7
        if errors[-1] > motions[-1].roundoff(output.probe) / output.scale:
            assert all(math.log2(coarse / fine) > 3.8 for coarse, fine in pairwise(errors))


def test_a_free_collision_keeps_momentum_and_energy():
    """In units of a rod's mass the body at x weighs 1 / kappa_x; energy is kinetic and elastic."""
    masses = {1: 10.0, 3: 0.5}
    motion = moved(COLLISION, 8, 128)
    found = []
    for tau in (0.0, 0.3, 1.3, 2.7, 4.4, 7.9):
        # waves bend where a front is: between these places Gauss's rule is as good as exact
        front = tau % 1
        cuts = sorted({0.0, front, 1 - front, 1.0})
        nodes, weights = np.polynomial.legendre.leggauss(16)
        momentum = energy = 0.0
        for x, mass in masses.items():
            (q,) = motion.at(at("velocity", x), [tau])
            momentum += mass * q
            energy += mass * q**2 / 2
        for rod in range(4):
            for low, high in pairwise(cuts):
                half = (high - low) / 2
                for node, weight in zip(nodes, weights, strict=True):
                    x = rod + low + half * (1 + node)
                    (v,) = motion.at(at("velocity", x), [tau])
                    (strain,) = motion.at(at("strain", x), [tau])
                    momentum += half * weight * v
                    energy += half * weight * (v**2 + strain**2) / 2
        found.append((momentum, energy))
    assert np.ptp([momentum for momentum, _ in found]) < 1e-8
    assert np.ptp([energy for _, energy in found]) < 1e-8
    assert found[0] == pytest.approx((10 - 0.25 + 2 - 1, 5 + 0.0625 + 1 + 0.25))


def test_a_jump_is_seen_from_the_right_and_nothing_before():
    """A step of acceleration sends -a / kappa_0 up; at x = 1/3 that arrives at no double."""
    load = {"times": ["1/10"], "a": [1], "b": [0]}
    motion = moved(
        scene({"type": "building", "m": 2, "kappa": ["1/4", 1, 1], "base": "force"}, [load], strain=[0]), 3, 16
    )
    front = Fraction(1, 10) + Fraction(1, 3)
    first = float(front) if Fraction(float(front)) >= front else math.nextafter(float(front), 1)
    before, after = motion.at(at("strain", Fraction(1, 3)), [math.nextafter(first, 0), first])
    assert before == 0
    assert after == pytest.approx(4)


def test_what_cannot_be_asked():
    motion = moved(DRIVE, 4.0, 8)
    for tau in (-1.0, 4.5, math.nan):
        with pytest.raises(ValueError, match="outside"):
            motion.at(at("strain", 0), [tau])


numbers = st.sampled_from(["1/3", "1/2", "1/2", "1", "1", "3/4", "2"])
times = st.lists(st.sampled_from(["0", "1/3", "1/2", "1", "7/4", "5/2"]), min_size=1, max_size=3, unique=True)
weights = st.sampled_from([1, -1, "1/2", "-2/3"])


@st.composite
def scenes(draw):
    kind = draw(st.sampled_from(["collision", "drive", "building"]))
    load = {"times": sorted(draw(times), key=Fraction)}
    listed = [draw(weights) for _ in load["times"]]
    if kind == "collision":
        m, loads = 4, []
        system = {"velocity": ["1", draw(st.sampled_from(["1", "0", "-1/2"]))], "kappa": [draw(numbers), draw(numbers)]}
    elif kind == "drive":
        m = draw(st.integers(1, 3))
        system = {"kappa": [draw(numbers) for _ in range(m)], "inertia": [draw(numbers) for _ in range(m + 1)]}
        loads = [load | {"body": draw(st.integers(1, m + 1)), "steps": listed}]
    else:
        m = draw(st.integers(2, 3))
        system = {"kappa": [draw(numbers) for _ in range(m + 1)], "base": draw(st.sampled_from(["force", "ground"]))}
        loads = [load | {"a": listed, "b": [draw(weights) for _ in listed]}]
    return scene(
        {"type": kind, "m": m, **system},
        loads,
        until=draw(st.sampled_from(["4", "11/2"])),
        strain=["1/3", f"{m - 1}-" if m > 1 else 0, m],
        velocity=["2/7", m],
        displacement=[0, "5/8"],
    )


@settings(max_examples=12)
@given(scenes())
def test_agreement_with_the_reference(scene):
    for outcome in checks.integration(known(lower(scene))):
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
    truth = known(lower(scene))
    assert all(outcome.passed for outcome in checks.integration(truth))
    monkeypatch.setattr(checks, "graph", lambda model: graph(replace(model, network=change(model.network))))
    assert not all(outcome.passed for outcome in checks.integration(truth))
