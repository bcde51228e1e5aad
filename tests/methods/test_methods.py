"""Every method converges to the reference, away from fronts at its own order; and one that is wrong is seen to be."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from flint import fmpq

from wavesym.api import evaluator
from wavesym.exact.reference import Reference
from wavesym.methods import characteristics, differences, elements, laplace
from wavesym.methods.catalogue import METHODS
from wavesym.methods.network_problem import problem_of
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


def errors(method, name, resolution, broken=lambda problem: problem):
    """The largest error of each output."""
    taus, values, sizes = truth(name)
    found = method.prepare(broken(method.state(lower(SCENES[name]))), resolution)(taus)
    return np.max(np.abs(found - values) / sizes, axis=1)


# method, a resolution, how much finer the other one is, by what power the error falls at least, and to what
CONVERGE = [
    (characteristics.SECOND, 40, 4, 1.6, 1e-3),
    (characteristics.FOURTH, 40, 4, 3.4, 1e-6),
    (differences.METHOD, 80, 4, 1.6, 2e-3),
    (laplace.METHOD, 500, 8, 2.0, 1e-3),
]


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(
    ("method", "coarse", "finer", "order", "small"), CONVERGE, ids=[row[0].name for row in CONVERGE]
)
def test_order_away_from_fronts(name, method, coarse, finer, order, small):
    first, last = (np.max(errors(method, name, n)) for n in (coarse, coarse * finer))
    assert last < small
    assert math.log(first / last, finer) > order


@pytest.mark.parametrize("name", SCENES)
def test_elements_converge_where_nothing_jumps(name):
    """Displacements; of what jumps, Newmark's waves ring all over the chain, and fall with no order to speak of."""
    first, last = (errors(elements.NEWMARK, name, n)[-1] for n in (40, 160))
    assert last < 2e-4
    assert math.log(first / last, 4) > 1.2


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


@pytest.mark.parametrize("method", [characteristics.SECOND, characteristics.FOURTH], ids=lambda method: method.name)
@pytest.mark.parametrize("count", [601, 1201, 1801, 457], ids=["on the grid", "half steps", "thirds", "neither"])
def test_characteristics_read_off_the_same_from_any_samples(method, count):
    """Even samples take short cuts; uneven ones, the same and one more, do not."""
    evaluate = method.prepare(method.state(lower(SCENES["building"])), 100)
    taus = np.linspace(0, 6, count)
    np.testing.assert_allclose(evaluate(taus), evaluate(np.append(taus, 6.0))[:, :-1], rtol=0, atol=1e-11)


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
def test_a_wrong_sign_at_a_body_is_seen(method):
    def broken(problem):
        return replace(problem, ratios=problem.ratios * [[1, -1]])

    resolution = method.resolutions[len(method.resolutions) // 2]
    with np.errstate(all="ignore"):
        found = np.max(errors(method, "drive", resolution, broken))
    assert np.max(errors(method, "drive", resolution)) < 0.03
    assert not found < 0.1


DRIVE = scene(
    {"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, "1/2"]},
    [{"body": 2, "times": [0, "1/2"], "steps": [1, "-1/2"]}],
    velocity=[1],
    acceleration=[1, 2],
    force=["1/2"],
    drift=[2],
)


@pytest.mark.parametrize(
    ("method", "resolution", "allowed"),
    [(characteristics.FOURTH, 100, 1e-6), (differences.METHOD, 300, 1e-3), (elements.NEWMARK, 160, 5e-2)],
    ids=["characteristics", "differences", "elements"],
)
def test_outputs_are_sums_of_what_methods_solve_for(method, resolution, allowed):
    """Away from fronts, where all of them are as good as they are; times factors, as in physical scenes."""
    model = lower(DRIVE)
    model = model.watching(replace(probe, factor=fmpq(10**k)) for k, probe in enumerate(model.probes))
    reference = Reference(model)
    taus = np.linspace(0.1, 4.9, 97)
    taus = taus[np.min(np.abs(taus[:, np.newaxis] - np.array(reference.breakpoints())), axis=1) > 0.1]
    exact = np.array(reference.values(taus.tolist()))
    problem = method.state(model)
    assert not problem.reads_outputs
    found = method.prepare(problem, resolution)(taus)
    assert np.all(np.abs(found - exact) <= allowed * np.max(np.abs(exact), axis=1, keepdims=True))


def test_what_is_read_as_it_is_costs_nothing_more():
    model = lower(DRIVE)
    problem = problem_of(model.watching(model.probes[:1]))
    values = np.ones((1, 3))
    assert problem.outputs(values, np.arange(3.0)) is values
