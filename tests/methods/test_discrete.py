"""Masses on springs, against equations that are written by hand and solved by SciPy."""

from dataclasses import replace

import numpy as np
import pytest
from flint import fmpq
from scipy.integrate import trapezoid
from scipy.linalg import expm, sqrtm

from wavesym.mechanics.damping import Damping
from wavesym.methods.advice import springs
from wavesym.methods.discrete import DiscreteModel
from wavesym.methods.elements import Elements
from wavesym.methods.network_problem import linear_problem
from wavesym.numbers.doubles import rational
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower

FLOOR, ROOF = 0.3, 0.2  # kappa

GROUND = Scene(
    name="ground",
    system={"type": "building", "m": 2, "kappa": [1, "0.3", "0.2"], "base": "ground"},
    load=[{"times": [0, "7/3"], "a": [1, -2], "b": ["1/2", "1/4"]}],
    output={"until": 9, "strain": ["1/4", "1+"], "velocity": [1, "3/2"], "displacement": [0, 2]},
)


def by_hand(weight, taus, ratio=0.0):
    """Two floors of mass 1/kappa on rods of mass `weight`, ground acceleration 1 + tau/2, then -2 + (tau - 7/3)/4 more.

    The unknowns are the floors' displacements relative to the ground, their velocities, and the ground's displacement,
    velocity, acceleration and its rate.
    """
    m = np.diag([1 / FLOOR, 1 / ROOF]) + weight * np.array([[2 / 3, 1 / 6], [1 / 6, 1 / 3]])
    k = np.array([[2.0, -1.0], [-1.0, 1.0]])
    dragged = np.array([1 / FLOOR + weight, 1 / ROOF + weight / 2])
    a = np.zeros((8, 8))
    a[:2, 2:4] = np.eye(2)
    a[2:4, :2] = -np.linalg.solve(m, k)
    a[2:4, 2:4] = -2 * ratio * sqrtm(np.linalg.solve(m, k))  # the same ratio for each mode
    a[2:4, 6] = -np.linalg.solve(m, dragged)
    a[4, 5] = a[5, 6] = a[6, 7] = 1
    start = np.zeros(8)
    start[6:] = 1, 0.5
    later = np.zeros(8)
    later[6:] = -2, 0.25
    rows = []
    for tau in taus:
        x = expm(a * tau) @ start + (expm(a * (tau - 7 / 3)) @ later if tau >= 7 / 3 else 0)
        (u1, u2), (v1, v2), ground = x[:2], x[2:4], x[4:]
        # what damps a mode pushes all along the rods, as their mass does
        w1, w2 = (a @ x)[2:4] - a[2:4, 2:4] @ x[2:4]
        first = u1 + weight * (balance(0.25) @ [ground[2], ground[2] + w1])
        second = u2 - u1 + weight * (balance(0.0) @ [ground[2] + w1, ground[2] + w2])
        rows.append([first, second, ground[1] + v1, ground[1] + (v1 + v2) / 2, ground[0], ground[0] + u2])
    return np.array(rows).T


def balance(place):
    """What a rod's mass strains it, from the accelerations of its ends: integrated, and on the average nothing."""
    x, dx = np.linspace(0, 1, 20_001, retstep=True)
    pushed = np.stack([(np.cumsum(shape) - shape / 2 - shape[0] / 2) * dx for shape in (1 - x, x)])
    return np.array([np.interp(place, x, row) - trapezoid(row, dx=dx) for row in pushed])


@pytest.mark.parametrize("weight", [0.0, 1.0])
def test_a_building_is_what_its_equations_say(weight):
    taus, values = springs(lower(GROUND), weight)
    some = np.arange(0, len(taus), 11)
    np.testing.assert_allclose(values[:, some], by_hand(weight, taus[some]), rtol=0, atol=1e-9)
    assert np.max(np.abs(values[:, some] - by_hand(abs(weight - 0.1), taus[some]))) > 1e-2


@pytest.mark.parametrize("ratio", [0.05, 1.0, 1.5])
def test_modes_are_damped_relative_to_the_ground(ratio):
    taus, values = springs(replace(lower(GROUND), damping=Damping((rational(ratio),))), 1.0)
    some = np.arange(0, len(taus), 11)
    np.testing.assert_allclose(values[:, some], by_hand(1.0, taus[some], ratio), rtol=0, atol=1e-9)
    assert np.max(np.abs(values[:, some] - by_hand(1.0, taus[some], 0.9 * ratio))) > 1e-3


def test_elements_come_to_what_damped_modes_are():
    """Errors fall with the square of the elements' length; where that is taken off, little is left."""
    scene = Scene(
        name="frame",
        system={"type": "building", "m": 4, "kappa": ["1/20"] * 5, "base": "ground", "damping": ["1/20", "1/50"]},
        load=[{"spacing": "5.1", "samples": [f"{k * np.sin(k / 3) * np.exp(-k / 20):.6f}" for k in range(80)]}],
        output={"until": 400, "acceleration": [1, 4], "force": [0], "drift": [2], "relative": [4]},
    )
    model = lower(scene).tolerating(fmpq(1, 10**7))
    problem = linear_problem(model)

    def elements(count):
        return DiscreteModel(Elements(problem, np.full(4, count))).outputs(5.1)

    (taus, coarse), (_, fine), (_, finer) = (elements(count) for count in (4, 8, 16))
    right = make(model, Request(evaluator="modes")).evaluate(taus)
    sizes = np.max(np.abs(right), axis=1, keepdims=True)
    first, second = (np.max(np.abs(values - right) / sizes) for values in (coarse, fine))
    assert 2.5 < first / second < 4.5
    assert np.max(np.abs((4 * finer - fine) / 3 - right) / sizes) < 1e-6
    light = replace(model, damping=Damping((fmpq(1, 21),)))
    wrong = make(light, Request(evaluator="modes")).evaluate(taus)
    assert np.max(np.abs(wrong - right) / sizes) > 1e-3


@pytest.mark.parametrize(("end", "gone"), [("fixed", 0.0), ("absorbing", 0.5)])
def test_what_has_no_mass_follows_at_once(end, gone):
    """Springs of stiffness 1 and 2 in a row, pushed by 1: against a wall, or a dashpot of 2."""
    parts = [{"joint": True, "name": "a"}, {"rod": 1}, {"rod": 1, "impedance": 2}, end]
    output = {"until": 6, "strain": ["1-", "1+"], "velocity": ["2"], "displacement": ["a", "3/2"]}
    load = [{"at": "a", "times": [0], "steps": [1]}]
    scene = Scene(name="scene", system={"type": "chain", "parts": parts}, load=load, output=output)
    taus, (left, right, velocity, first, inside) = springs(lower(scene), 0.0)
    for found, true in (
        (left, -1),
        (right, -1 / 2),
        (velocity, gone),
        (first, 3 / 2 + gone * taus),
        (inside, 1 / 4 + gone * taus),
    ):
        np.testing.assert_allclose(found, np.broadcast_to(true, taus.shape), rtol=0, atol=1e-12)
