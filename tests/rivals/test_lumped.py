"""Masses on springs: against equations written by hand and solved by SciPy, and against waves where rods weigh little."""

import numpy as np
import pytest
from scipy.linalg import expm

from wavesym.rivals.advice import springs
from wavesym.scene import Scene, lower

FLOOR, ROOF = 0.3, 0.2  # kappa

GROUND = Scene(
    name="ground",
    system={"type": "building", "m": 2, "kappa": [1, "0.3", "0.2"], "base": "ground"},
    load=[{"times": [0, "7/3"], "a": [1, -2], "b": ["1/2", "1/4"]}],
    output={"until": 9, "strain": ["1/4", "1+"], "velocity": [1, "3/2"], "displacement": [0, 2]},
)


def by_hand(weight, taus):
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
    a[2:4, 6] = -np.linalg.solve(m, dragged)
    a[4, 5] = a[5, 6] = a[6, 7] = 1
    start = np.zeros(8)
    start[6:] = 1, 0.5
    later = np.zeros(8)
    later[6:] = -2, 0.25
    rows = []
    for tau in taus:
        x = expm(a * tau) @ start + (expm(a * (tau - 7 / 3)) @ later if tau >= 7 / 3 else 0)
        (u1, u2), (v1, v2), (w1, w2), ground = x[:2], x[2:4], (a @ x)[2:4], x[4:]
        first = u1 + weight * (balance(0.25) @ [ground[2], ground[2] + w1])
        second = u2 - u1 + weight * (balance(0.0) @ [ground[2] + w1, ground[2] + w2])
        rows.append([first, second, ground[1] + v1, ground[1] + (v1 + v2) / 2, ground[0], ground[0] + u2])
    return np.array(rows).T


def balance(place):
    """What a rod's mass strains it, from the accelerations of its ends: integrated, and on the average nothing."""
    x, dx = np.linspace(0, 1, 200_001, retstep=True)
    pushed = np.stack([(np.cumsum(shape) - shape / 2 - shape[0] / 2) * dx for shape in (1 - x, x)])
    return np.array([np.interp(place, x, row) - np.trapezoid(row, dx=dx) for row in pushed])


@pytest.mark.parametrize("weight", [0.0, 1.0])
def test_a_building_is_what_its_equations_say(weight):
    taus, values = springs(lower(GROUND), weight)
    some = np.arange(0, len(taus), 7)
    np.testing.assert_allclose(values[:, some], by_hand(weight, taus[some]), rtol=0, atol=1e-9)
    assert np.max(np.abs(values - by_hand(0.9 * weight + 0.1 * (not weight), taus))) > 1e-2
