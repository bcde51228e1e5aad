"""Momentum and energy: weights from the masses themselves, balances that hold, and that see what is wrong."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings

import wavesym
from tests.support.drawn import scenes
from tests.support.generated import assemble
from wavesym.numbers.doubles import fraction
from wavesym.programs.march.evaluator import march
from wavesym.results.response import Response
from wavesym.scene import Scene, lower
from wavesym.verification import checks
from wavesym.verification.invariants import Balancing
from wavesym.verification.reference import known_outputs

COLLISION = Scene(
    name="scene",
    system={"type": "collision", "m": 6, "kappa": ["1/10", 2, "3/7"], "velocity": [1, 1, "-1/2"]},
    output={"until": 6, "strain": [2]},
)
DRIVE = Scene(
    name="scene",
    system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 3]},
    load=[{"body": 1, "times": [0, "1/3"], "steps": [1, -2]}, {"body": 3, "times": ["10/7"], "steps": [1]}],
    output={"until": 6, "strain": [0]},
)
LOAD = {"times": [0, "5/2", "13/3"], "a": [1, "1/2", 0], "b": [0, "-1/3", "1/7"]}
FORCE, GROUND = (
    Scene(
        name="scene",
        system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": base},
        load=[LOAD],
        output={"until": 6, "strain": [0]},
    )
    for base in ("force", "ground")
)


def again(scene, system=None, **output):
    """The same scene with something else in its system, and other outputs."""
    return Scene(
        name="scene",
        system=scene.system.model_dump() | (system or {}),
        load=[load.model_dump() for load in scene.load],
        output=output or {"until": 6, "strain": [0]},
    )


# of bodies at x = 0, 1, ... and of rods, in units of the first rod's: kappa is a rod's mass in terms of a body's
MASSES = {
    id(COLLISION): ([0, 10, 0, 1 / 2, 0, 7 / 3, 0], [1] * 6),
    id(DRIVE): ([1, 2, 3], [1, 1]),
    id(FORCE): ([0, 5 / 3, 5], [1, 1]),
}
FOUR = pytest.mark.parametrize("scene", [COLLISION, DRIVE, FORCE, GROUND], ids=["impact", "drive", "force", "ground"])


MOST = 30_000


def exactly(scene, until):
    """A scene's books, its values in balls, rounded once, and what that costs."""
    books = Balancing(lower(scene).shorten(fmpq(until)), MOST)
    assert books.balance_times
    response = Response(books.model)
    last = float(books.balance_times[-1])
    return books, response, [2.0**-53 * np.abs(row).max() for row in response(np.linspace(0, last, 401))]


def balances(books, evaluate, errors):
    return books.balances(evaluate, errors)


@pytest.mark.quick(2)
@FOUR
def test_balances_hold_to_the_last_digits(scene):
    for balance in balances(*exactly(scene, 6)):
        assert balance.error <= balance.error_bound < 1e-12


@settings(max_examples=10)
@given(scenes())
def test_balances_hold_in_any_system(scene):
    for balance in balances(*exactly(scene, 3)):
        assert balance.error <= balance.error_bound < 1e-12


def in_rods(scene, tau):
    """Momentum and energy at tau, not inside a load's window, by Gauss's rule along the rods."""
    m = scene.system.m
    bodies, rods = MASSES[id(scene)]
    nodes, rule = np.polynomial.legendre.leggauss(24)
    # fronts are where a load's time says, seen from either end
    parts = {Fraction(tau) - fraction(load.time) for load in lower(scene).loads}
    cuts = sorted({Fraction(0), Fraction(1)} | {part % 1 for part in parts} | {-part % 1 for part in parts})
    places, shares = [], []
    for low, high in pairwise(cuts):
        places += [low + (high - low) * Fraction((node + 1) / 2) for node in nodes.tolist()]
        shares += (float(high - low) * rule / 2).tolist()
    along = [x + place for x in range(m) for place in places]
    wide = again(scene, until=tau + 1, strain=along, velocity=[*along, *range(m + 1)])
    values = wavesym.evaluator(wide)(np.array([float(tau)]))[:, 0]
    strain, velocity, q = np.split(values, [len(along), 2 * len(along)])
    heavy, shares = np.array(bodies), np.outer(rods, shares).ravel()
    return heavy @ q + shares @ velocity, heavy @ q**2 / 2 + shares @ (strain**2 + velocity**2) / 2


def test_a_collision_keeps_what_it_brings_along_the_rods():
    """Bodies and the rods fixed to them come with velocities 1, 1, -1/2; momentum and energy are still that."""
    masses = np.array([10 + 2, 0.5 + 2, 7 / 3 + 2])
    velocities = np.array([1, 1, -0.5])
    for tau in (1, 4):
        momentum, energy = in_rods(COLLISION, tau)
        assert momentum == pytest.approx(masses @ velocities, rel=1e-13)
        assert energy == pytest.approx(masses @ velocities**2 / 2, rel=1e-13)


@pytest.mark.slow
def test_the_impulse_of_the_moments_turns_the_drive():
    """Moments in units of G J_01 / l: 1 from 0, -1 from 1/3 on the first disc, and -1 from 10/7 on the last."""
    for tau in (2, 3):
        momentum, _ = in_rods(DRIVE, tau)
        assert momentum == pytest.approx(tau - 2 * (tau - 1 / 3) - (tau - 10 / 7), rel=1e-13)


def test_the_force_at_the_base_pushes_the_building():
    """kappa_0 dU/dx = a at the base pulls the building back."""
    momentum, _ = in_rods(FORCE, 2)
    assert momentum == pytest.approx(-2 / 0.25, rel=1e-13)


@pytest.mark.quick(1)
@FOUR
def test_another_system_is_seen(scene):
    """The books of one system and the motion of another, whose second kappa is larger by 1e-9."""
    kappa = list(map(Fraction, scene.system.kappa))
    kappa[1] *= 1 + Fraction(1, 10**9)
    other = again(scene, {"kappa": kappa})
    seen, _, errors = exactly(scene, 6)
    assert all(balance.error <= balance.error_bound for balance in balances(*exactly(other, 6)))
    assert all(balance.error > balance.error_bound for balance in balances(seen, exactly(other, 6)[1], errors))


@pytest.mark.quick(2)
@FOUR
def test_a_leak_is_seen(scene):
    """Everything 1e-9 too small."""
    seen, evaluate, errors = exactly(scene, 4)
    _, energy = balances(seen, lambda taus: evaluate(taus) * (1 - 1e-9 * taus), errors)
    assert energy.error > energy.error_bound


@pytest.mark.slow
def test_one_wrong_output_is_seen():
    """Displacements matter to springs alone, which a drive has none of."""
    seen, evaluate, errors = exactly(DRIVE, 4)
    for wrong, probe in enumerate(seen.model.probes):
        if probe.quantity == "displacement":
            continue

        def changed(taus, wrong=wrong):
            values = evaluate(taus)
            values[wrong] *= 1 + 1e-9
            return values

        assert any(balance.error > balance.error_bound for balance in balances(seen, changed, errors))


def test_what_is_not_looked_at_is_said(monkeypatch):
    truth = known_outputs(lower(DRIVE))
    monkeypatch.setattr(checks, "_MOST_VALUES", 2000)
    assert {float(outcome.cells["to"]) < 6 for outcome in checks.invariants(truth)} == {True}
    monkeypatch.setattr(checks, "_MOST_VALUES", 20)
    (outcome,) = checks.invariants(truth)
    assert outcome.passed
    assert "fronts come too often" in outcome.note


@pytest.mark.slow
@FOUR
def test_the_march_keeps_them_for_long(scene):
    books = Balancing(lower(scene).shorten(fmpq(100)), 10 * MOST)
    made = march(books.model.tolerating(fmpq(1, 10**4)))
    evaluate = assemble(made).evaluate
    for balance in balances(books, evaluate, [output.bound * output.largest for output in made.outputs]):
        assert balance.error <= balance.error_bound
        assert balance.error < 1e-9
