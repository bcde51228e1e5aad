"""Every rival converges to the reference, away from fronts at its own order; and one that is wrong is seen to be."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from wavesym.api import evaluator
from wavesym.exact.reference import Reference
from wavesym.rivals import characteristics, delays, differences, elements, laplace, modes, steps
from wavesym.rivals.every import RIVALS
from wavesym.rivals.line import stated
from wavesym.rivals.network import NetworkProblem
from wavesym.scene import Scene, lower


def scene(system, load=(), **outputs):
    return Scene(name="scene", system=system, load=list(load), output={"until": 6, **outputs})


SCENES = {
    "building": scene(
        {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
        [{"times": [0, "5/2"], "a": [1, "1/2"], "b": [0, "-1/3"]}],
        strain=["1/3", "1/2"],
        velocity=["3/2"],
        displacement=[1],
    ),
    "ground": scene(
        {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "ground"},
        [{"times": [0, "5/2"], "a": [1, "1/2"], "b": [0, "-1/3"]}],
        strain=["1-", "1+"],
        velocity=[0, 2],
        displacement=["3/2"],
    ),
    "drive": scene(
        {"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 2]},
        [{"body": 1, "times": [0, "7/2"], "steps": [1, -2]}, {"body": 2, "times": [1], "steps": [1]}],
        strain=["1/2"],
        velocity=[0],
        displacement=["1/4"],
    ),
    "collision": scene(
        {"type": "collision", "m": 4, "kappa": ["1/10", 2], "velocity": [1, "-1/2"]},
        strain=["1-", "3+"],
        velocity=["1/2", 2],
        displacement=[1],
    ),
}


@cache
def truth(name):
    """Samples away from fronts, and the outputs there as parts of their largest value."""
    arrivals = np.array(Reference(lower(SCENES[name])).breakpoints())
    taus = np.linspace(0, 5.9, 591)  # at 6 a wave may arrive
    taus = taus[np.min(np.abs(taus[:, np.newaxis] - arrivals), axis=1) > 0.08]
    values = evaluator(SCENES[name])(taus)
    return taus, values, np.max(np.abs(values), axis=1, keepdims=True)


def errors(rival, name, resolution, broken=lambda problem: problem):
    """The largest error of each output."""
    taus, values, sizes = truth(name)
    found = rival.prepare(broken(rival.states(lower(SCENES[name]))), resolution)(taus)
    return np.max(np.abs(found - values) / sizes, axis=1)


# rival, a resolution, how much finer the other one is, by what power the error falls at least, and to what
CONVERGE = [
    (characteristics.SECOND, 40, 4, 1.6, 1e-3),
    (characteristics.FOURTH, 40, 4, 3.4, 1e-6),
    (differences.RIVAL, 80, 4, 1.6, 2e-3),
    (modes.RIVAL, 40, 8, 0.6, 2e-2),  # what jumps has coefficients that fall as 1/k
    (laplace.RIVAL, 500, 8, 2.0, 1e-3),
]


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(
    ("rival", "coarse", "finer", "order", "small"), CONVERGE, ids=[row[0].name for row in CONVERGE]
)
def test_order_away_from_fronts(name, rival, coarse, finer, order, small):
    first, last = (np.max(errors(rival, name, n)) for n in (coarse, coarse * finer))
    assert last < small
    assert math.log(first / last, finer) > order


@pytest.mark.parametrize("name", SCENES)
def test_elements_converge_where_nothing_jumps(name):
    """Displacements; of what jumps, Newmark's waves ring all over the chain, and fall with no order to speak of."""
    first, last = (errors(elements.RIVAL, name, n)[-1] for n in (40, 160))
    assert last < 2e-4
    assert math.log(first / last, 4) > 1.2


@pytest.mark.parametrize("name", SCENES)
def test_steps_follow_their_tolerance(name):
    first, last = (np.max(errors(steps.RIVAL, name, tolerance)) for tolerance in (1e-4, 1e-11))
    assert first < 1e-2
    assert last < 1e-8


def test_characteristics_cut_the_grid_where_a_load_jumps():
    """Times that no uniform grid has do not cost the order."""
    SCENES["odd"] = scene(
        {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "ground"},
        [{"times": ["1/7", "13/3"], "a": [1, "1/2"], "b": [0, "-1/3"]}],
        strain=["1/3"],
        displacement=[2],
    )
    first, last = (np.max(errors(characteristics.FOURTH, "odd", n)) for n in (40, 160))
    assert math.log(first / last, 4) > 3.4


@pytest.mark.parametrize("rival", [characteristics.SECOND, characteristics.FOURTH], ids=lambda rival: rival.name)
@pytest.mark.parametrize("count", [601, 1201, 1801, 457], ids=["on the grid", "half steps", "thirds", "neither"])
def test_characteristics_read_off_the_same_from_any_samples(rival, count):
    """Even samples take short cuts; uneven ones, the same and one more, do not."""
    evaluate = rival.prepare(stated(lower(SCENES["building"])), 100)
    taus = np.linspace(0, 6, count)
    np.testing.assert_allclose(evaluate(taus), evaluate(np.append(taus, 6.0))[:, :-1], rtol=0, atol=1e-11)


@pytest.mark.parametrize("rival", RIVALS, ids=lambda rival: rival.name)
def test_a_wrong_sign_at_a_body_is_seen(rival):
    def broken(problem):
        if isinstance(problem, NetworkProblem):
            return replace(problem, ratios=problem.ratios * [[1, -1]])
        alpha = problem.alpha.copy()
        alpha[1] *= -1
        return replace(problem, alpha=alpha)

    resolution = rival.resolutions[len(rival.resolutions) // 2]
    with np.errstate(all="ignore"):
        found = np.max(errors(rival, "drive", resolution, broken))
    assert np.max(errors(rival, "drive", resolution)) < 0.03
    assert not found < 0.1


def test_jitcdde_follows_its_tolerance_where_nothing_jumps():
    pytest.importorskip("jitcdde")
    first, last = (np.max(errors(delays.RIVAL, "drive", tolerance)) for tolerance in (1e-3, 1e-7))
    assert first < 1e-1
    assert last < 1e-4


def test_exact_modes():
    """Of a free bar k pi; with equal discs at its ends, whose middle rests or stretches nothing, two equations."""
    sides = {"alpha": np.array([0.0, 6.0]), "beta": np.array([6.0, 0.0])}
    drive = replace(stated(lower(SCENES["drive"])), inertia=np.ones(2), **sides)
    w = modes.modes(drive, 7).w
    assert w[0] == 0
    np.testing.assert_allclose(w[1::2] * np.tan(w[1::2] / 2), 3, rtol=1e-9)
    np.testing.assert_allclose(w[2::2] / np.tan(w[2::2] / 2), -3, rtol=1e-9)
    bar = replace(drive, inertia=np.zeros(2))
    np.testing.assert_allclose(modes.modes(bar, 5).w, np.arange(5) * math.pi, atol=1e-12)
