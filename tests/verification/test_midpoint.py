"""The midpoint rule: exact where it should be, sharp at fronts, of the order it claims, and able to say no."""

from dataclasses import replace
from fractions import Fraction
from functools import reduce

import numpy as np
import pytest
from flint import fmpq
from scipy.special import eval_laguerre

from tests.verification.test_collocation import changed
from wavesym.exact.reference import Reference
from wavesym.scene import Scene, lower
from wavesym.verification import integrations
from wavesym.verification.midpoint import MidpointGrid
from wavesym.verification.problem import corner_problem
from wavesym.verification.reference import known_outputs


def building(load, until=6, base="ground", **outputs):
    system = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": base}
    return Scene(name="scene", system=system, load=[load], output={"until": until, **outputs})


ALL_KINDS = {"strain": ["1/3", "1-", "1+", 0, 2], "velocity": [0, 1, "9/7"], "displacement": ["2/3", 2]}
BUILDING = building({"times": [0, "5/2", "13/3"], "a": [1, "1/2", 0], "b": [0, "-1/3", "1/7"]}, **ALL_KINDS)
FORCE = building({"times": [0, "5/2"], "a": [1, "1/2"], "b": [0, "-1/3"]}, base="force", **ALL_KINDS)
COLLISION = Scene(
    name="scene",
    system={"type": "collision", "m": 4, "kappa": ["1/10", "2"], "velocity": [1, "-1/2"]},
    output={"until": 7, "strain": ["1-", "1+", 2], "velocity": ["1/2", 3], "displacement": [4]},
)
DRIVE = Scene(
    name="scene",
    system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    load=[{"body": 1, "times": [0, "1/3"], "steps": [1, -2]}, {"body": 3, "times": ["10/7"], "steps": [1]}],
    output={"until": 7, "strain": ["1/2", "1-", 2], "velocity": [1, "5/4"], "displacement": [0]},
)
LITTLE = 1 + fmpq(1, 10**5)


def weakened(loads):
    return tuple(replace(load, coefficients=tuple(c * LITTLE for c in load.coefficients)) for load in loads)


FOUR = pytest.mark.parametrize("scene", [BUILDING, FORCE, COLLISION, DRIVE], ids=["ground", "force", "impact", "drive"])


def with_cells(model, cells):
    """A grid with so many cells in a rod of length 1."""
    return MidpointGrid(corner_problem(model), Fraction(1, cells))


def common_instants(grid, until):
    """Those off the fronts of all outputs."""
    return reduce(np.intersect1d, grid.instants(until))


@pytest.mark.quick(1)
@FOUR
def test_what_is_extrapolated_is_of_order_four(scene):
    assert all(outcome.passed for outcome in integrations.midpoints(known_outputs(lower(scene))))
    first = integrations._grid(lower(scene))
    instants = common_instants(first, 6.0)
    truth = np.array(Reference(lower(scene)).values([first.tau(k) for k in instants.tolist()]))
    n, n2, n4 = (first.finer(times).integrate(times * instants)[0] for times in (1, 2, 4))
    coarse, fine = (np.abs(b + (b - a) / 3 - truth).max(axis=1) for a, b in ((n, n2), (n2, n4)))
    seen = fine > 1e-10
    np.testing.assert_allclose(np.log2(coarse[seen] / fine[seen]), 4, atol=0.5)


def test_a_struck_bar():
    """A mass on a bar fixed at its other end, after an impulse: Boussinesq's solution, by Laguerre functions."""
    alpha, until = 1.0, 8

    def displacement(tau):
        """The response to a unit step of force is the integral of the velocity after an impulse."""
        w = tau - 2 * np.arange(int(tau // 2) + 1)
        return sum(np.exp(-alpha * each) * eval_laguerre(k, 2 * alpha * each) for k, each in enumerate(w))

    system = {"type": "chain", "parts": [{"mass": 1, "name": "a"}, {"rod": 1}, "fixed"]}
    load = {"at": "a", "times": [0], "steps": [1]}
    model = lower(Scene(name="bar", system=system, load=[load], output={"until": until, "strain": [0]}))
    found = []
    for cells in (20, 40, 80):
        instants = common_instants(with_cells(model, 20), until) * (cells // 20)
        # (2.4) of the mass: its acceleration is 1 + alpha dU/dx under a step, so its velocity after an impulse
        velocity = 1 + alpha * with_cells(model, cells).integrate(instants)[0][0]
        exact = [displacement(k / cells) - (displacement(k / cells - 2) if k >= 2 * cells else 0) for k in instants]
        found.append(np.abs(velocity - exact).max())
    assert found[-1] < 2e-3
    np.testing.assert_allclose(np.log2(np.array(found[:-1]) / found[1:]), 2, atol=0.1)


def test_a_front_is_as_sharp_as_it_is():
    """A step of force at the base sends a step of strain up: one cell before it nothing, one cell after it all."""
    scene = building({"times": [0], "a": [1], "b": [0]}, base="force", strain=["1/2"], velocity=["1/2"], until=1)
    for cells in (16, 64):
        half = cells // 2
        around = np.array([half - 1, half + 1])
        strain, velocity = with_cells(lower(scene), cells).integrate(around)[0]
        np.testing.assert_allclose(strain, [0, 4], atol=1e-12)
        np.testing.assert_allclose(velocity, [0, -4], atol=1e-12)
        assert half not in set(common_instants(with_cells(lower(scene), cells), 1.0))
        assert {*around} <= set(common_instants(with_cells(lower(scene), cells), 1.0))


def test_fronts_off_the_grid_are_kept_away_from_and_allowed_for():
    scene = building({"times": ["517/1009"], "a": [1], "b": [0]}, base="force", strain=["1/2"], velocity=[1], until=5)
    first = integrations._grid(lower(scene))
    assert not first.is_aligned
    for instants, distance in zip(first.instants(5.0), (0.5, 1), strict=True):  # of what is read from the base
        fronts = 517 / 1009 + distance + np.arange(-1, 5)
        taus = [first.tau(k) for k in instants.tolist()]
        assert np.abs(np.subtract.outer(taus, fronts)).min() >= float(first.step)
    for outcome in integrations.midpoints(known_outputs(lower(scene))):
        assert outcome.passed
        assert "extrapolated" not in outcome.cells


def test_places_off_the_grid_are_read_off_lines():
    scene = building(
        {"times": [0], "a": [1], "b": [0]}, strain=["0.1234"], velocity=["0.4321"], displacement=["1.9877"]
    )
    for outcome in integrations.midpoints(known_outputs(lower(scene))):
        assert outcome.passed
        assert float(outcome.cells["at 4N"]) < 1e-7
        assert "extrapolated" not in outcome.cells


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("scene", "change"),
    [
        pytest.param(DRIVE, changed("bars", 1, impedance=lambda z: z * LITTLE), id="impedance"),
        pytest.param(DRIVE, changed("points", 1, mass=lambda mass: -mass), id="sign"),
        pytest.param(COLLISION, changed("points", 2, mass=lambda mass: LITTLE - 1), id="contact"),
        pytest.param(COLLISION, changed("bars", 3, velocity=lambda v: v * LITTLE), id="velocity"),
        pytest.param(BUILDING, changed("points", 2, mass=lambda mass: mass * LITTLE), id="mass"),
        pytest.param(FORCE, changed("points", 0, loads=weakened), id="load"),
    ],
)
def test_a_wrong_network_is_caught(scene, change, monkeypatch):
    truth = known_outputs(lower(scene))
    assert all(outcome.passed for outcome in integrations.midpoints(truth))
    monkeypatch.setattr(
        integrations, "corner_problem", lambda model: corner_problem(replace(model, network=change(model.network)))
    )
    assert not all(outcome.passed for outcome in integrations.midpoints(replace(truth)))  # solved anew


def test_what_would_take_too_long_is_said(monkeypatch):
    truth = known_outputs(lower(DRIVE))
    monkeypatch.setattr(integrations, "MOST_MOVED", 5e6)
    shorter = integrations.midpoints(truth)
    assert all(outcome.passed and float(outcome.cells["to"]) < 7 for outcome in shorter)
    monkeypatch.setattr("wavesym.verification.outcome.FINE", 1e-12)
    assert all("too coarse to tell errors below 1e-12" in outcome.note for outcome in integrations.midpoints(truth))
    monkeypatch.setattr(integrations, "MOST_MOVED", 1e3)
    refused = integrations.midpoints(replace(truth))
    assert all(outcome.passed and "too long" in outcome.note for outcome in refused)
    assert {outcome.cells["to"] for outcome in refused} == {"refused"}


def test_delays_of_no_common_measure_are_many_steps():
    """The step is a measure of 1e-17, and of each delay there were more steps than an integer takes."""
    steel, aluminium = {"A": "2 cm^2", "E": "200 GPa", "rho": "7800 kg/m^3"}, {"E": "70 GPa", "rho": "2700 kg/m^3"}
    system = {
        "type": "chain",
        "parts": [
            {"rod": "1 m", **steel, "velocity": "10 m/s"},
            {"contact": "1 mm"},
            {"joint": True, "name": "in"},
            {"rod": "2 m", **steel},
            {"rod": "1 m", "A": "1 cm^2", **aluminium},
            {"mass": "0.1 kg", "name": "out", "velocity": "0 m/s", "friction": "500 N"},
        ],
    }
    output = {"until": "1.5 ms", "tolerance": "1e-6", "velocity": ["out"]}
    model = lower(Scene(name="bars", system=system, units={"time": "ms"}, output=output))
    assert all("to" in outcome.cells for outcome in integrations.midpoints(known_outputs(model)))
