"""Other methods on any network: orders away from fronts, faults that are seen, and refusals in one line."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from flint import fmpq

from wavesym.api import evaluator
from wavesym.errors import UnservedError
from wavesym.exact.reference import Reference
from wavesym.lab.chart.subjects import unsupported_methods
from wavesym.methods import characteristics, differences, discrete, elements, laplace
from wavesym.methods.catalogue import METHODS
from wavesym.methods.network_problem import linear_problem
from wavesym.scene import Scene, lower

CHARACTERISTICS = (characteristics.SECOND, characteristics.FOURTH)
REFUSED = dict.fromkeys(CHARACTERISTICS, ("springs and dashpots",))
RESOLUTIONS = {discrete.MODAL: 40, laplace.METHOD: 1000}


def scene(parts, branch=(), load=(), **output):
    system = {"type": "chain", "parts": parts, "branch": list(branch)}
    return Scene(name="scene", system=system, load=list(load), output={"until": 5, **output})


STEP = [{"at": "a", "times": [0, "3/2"], "steps": [1, "-1/2"], "ramps": [0, "1/4"]}]
SCENES = {
    "unequal rods": scene(
        [{"mass": 2, "name": "a"}, {"rod": 1}, {"mass": 1}, {"rod": "1.37", "impedance": 3, "speed": "1.1"}, "fixed"],
        load=STEP,
        strain=["1/2", "2"],
        velocity=["a"],
        displacement=["1/2", "3/2"],
    ),
    "springs and dashpots": scene(
        [
            {"mass": 1, "name": "a", "spring": 2, "dashpot": "1/3"},
            {"spring": 5, "dashpot": "1/2"},
            {"mass": 1, "name": "b"},
            {"rod": 1, "dashpot": "1/4", "spring": 1},
            {"mass": "1/2"},
            {"rod": "3/4"},
            {"joint": True, "dashpot": "1/3", "name": "c"},
        ],
        load=STEP,
        velocity=["a", "b", "c"],
        displacement=["a", "1/2"],
    ),
    "branch with gears": scene(
        [{"mass": 1, "name": "a"}, {"rod": 1}, {"mass": "1/2", "name": "gear"}, {"rod": "3/2"}, {"mass": 1}],
        branch=[{"from": "gear", "name": "side", "ratio": -2, "parts": [{"rod": "1/2"}, {"mass": "1/4"}]}],
        load=STEP,
        strain=["side:0", "1/2"],
        velocity=["side:1/4", "5/2"],
    ),
    "prescribed ends and what is there at the start": scene(
        [
            {"motion": "acceleration", "velocity": "1/2", "name": "a"},
            {"rod": "5/4", "strain": "1/3", "velocity": "1/2"},
            {"mass": 1, "velocity": "-1"},
            {"rod": 1, "strain": "-1/5"},
            "absorbing",
        ],
        load=STEP,
        strain=["1/2", "2"],
        velocity=["5/4"],
        displacement=["1"],
    ),
}


@cache
def truth(name):
    """Samples away from fronts, and the outputs there as parts of their largest value."""
    arrivals = np.array(Reference(lower(SCENES[name])).breakpoints())
    taus = np.linspace(0, 4.9, 491)
    taus = taus[np.min(np.abs(taus[:, np.newaxis] - arrivals), axis=1) > 0.06]
    values = evaluator(SCENES[name])(taus)
    return taus, values, np.max(np.abs(values), axis=1, keepdims=True)


def errors(method, name, resolution, broken=lambda problem: problem):
    taus, values, sizes = truth(name)
    found = method.prepare(broken(method.state(lower(SCENES[name]))), resolution)(taus)
    return np.max(np.abs(found - values) / sizes, axis=1)


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", SCENES)
def test_differences_converge(name):
    """A step divides all delays, so that there may be many more cells than stated."""
    first, last = (np.max(errors(differences.METHOD, name, n)) for n in (250, 1000))
    assert last < 2e-3
    assert math.log(first / last, 4) > 1.6


@pytest.mark.parametrize(
    ("method", "order"), list(zip(CHARACTERISTICS, (1.6, 3.4), strict=True)), ids=["second", "fourth"]
)
@pytest.mark.parametrize("name", [name for name in SCENES if "springs" not in name])
def test_characteristics_converge(name, method, order):
    first, last = (np.max(errors(method, name, n)) for n in (600, 2400))
    assert last < 1e-4
    assert last < 1e-12 or math.log(first / last, 4) > order


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SCENES)
def test_laplace_converges(name):
    first, last = (np.max(errors(laplace.METHOD, name, n)) for n in (400, 2000))
    assert last < 2e-3
    assert math.log(first / last, 5) > 2


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("method", "coarse", "order"),
    [(elements.NEWMARK, 40, 0.8), (discrete.MODAL, 8, 0.7)],
    ids=["Newmark", "modal"],
)
@pytest.mark.parametrize("name", SCENES)
def test_elements_converge_where_nothing_jumps(name, method, coarse, order):
    """Displacements, or what is as smooth."""
    smooth = [k for k, output in enumerate(lower(SCENES[name]).probes) if output.quantity == "displacement"] or [2]
    first, last = (np.max(errors(method, name, n)[smooth]) for n in (coarse, 4 * coarse))
    assert last < 0.08 / coarse
    assert math.log(first / last, 4) > order


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
@pytest.mark.parametrize(
    ("name", "broken"),
    [
        ("unequal rods", lambda problem: replace(problem, delays=problem.delays[::-1])),
        ("springs and dashpots", lambda problem: replace(problem, stiffness=problem.stiffness / 2)),
        ("springs and dashpots", lambda problem: replace(problem, damping=np.diag(np.diag(problem.damping)))),
        ("branch with gears", lambda problem: replace(problem, ratios=abs(problem.ratios))),
        (
            "prescribed ends and what is there at the start",
            lambda problem: replace(problem, start_strain=-problem.start_strain),
        ),
    ],
    ids=["delays", "springs", "links", "gears", "strain"],
)
def test_a_fault_is_seen(method, name, broken, thorough):
    if name in REFUSED.get(method, ()):
        pytest.skip("the method does not take it")
    if not thorough and method is discrete.MODAL and name not in ("unequal rods", "branch with gears"):
        pytest.skip("seconds, which the other scenes do not take")
    resolution = RESOLUTIONS.get(method, 100)
    right, wrong = np.median(errors(method, name, resolution)), np.max(errors(method, name, resolution, broken))
    assert right < 0.05
    assert wrong > 3 * right
    assert wrong > 0.1


LINE = scene(
    [{"mass": 1, "name": "a"}, {"rod": 1}, {"mass": 2}, {"rod": 1, "impedance": 3}, {"rod": 1}, {"mass": 1}],
    load=STEP,
    strain=["1/2"],
    velocity=["1", "5/2"],
    displacement=["a"],
)


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
def test_a_line_of_equal_rods_is_taken_by_all(method, monkeypatch):
    monkeypatch.setitem(SCENES, "line", LINE)
    assert np.median(errors(method, "line", method.resolutions[len(method.resolutions) // 2])) < 0.01


def test_who_does_not_take_a_chain_says_so():
    why = "a spring, or a dashpot between points, is not supported by characteristics; take another method"
    assert list(unsupported_methods(SCENES["springs and dashpots"])) == [
        f"{method.name}: system: {why}" for method in CHARACTERISTICS
    ]


def test_delays_without_a_measure_are_refused_by_grids():
    """A step would be 1/1001 of the longest delay."""
    nearly = scene([{"mass": 1, "name": "a"}, {"rod": 1}, {"mass": 1}, {"rod": "1.001"}], load=STEP, velocity=["a"])
    assert [line.partition(":")[0] for line in unsupported_methods(nearly)] == [
        method.name for method in (*CHARACTERISTICS, differences.METHOD)
    ]
    with pytest.raises(UnservedError, match="a common measure of 1/1e\\+03 of the longest; write lengths"):
        differences.METHOD.state(lower(nearly))


OPEN = {"type": "collision", "m": 4, "kappa": ["1/10", "1/5"], "velocity": [1, "-1/2"], "contacts": "open"}


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
@pytest.mark.parametrize(
    "system",
    [OPEN, {"type": "chain", "parts": [{"rod": 1, "velocity": 1}, "contact", {"rod": 1}]}],
    ids=["named", "own"],
)
def test_none_takes_contacts_that_open(method, system):
    given = Scene(name="scene", system=system, output={"until": 5, "velocity": ["1/2"]})
    with pytest.raises(UnservedError, match=r"the contact at [12] opens and closes"):
        method.state(lower(given))


BUILDING = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "ground"}


def named(system, load, **output):
    return Scene(name="scene", system=system, load=load, output={"until": 5, **output})


def test_characteristics_cut_the_grid_where_a_load_jumps(monkeypatch):
    """Times that no uniform grid has do not cost the order."""
    load = [{"times": ["1/7", "13/3"], "a": [1, "1/2"], "b": [0, "-1/3"]}]
    monkeypatch.setitem(SCENES, "odd", named(BUILDING, load, strain=["1/3"], displacement=[2]))
    first, last = (np.max(errors(characteristics.FOURTH, "odd", n)) for n in (40, 160))
    assert math.log(first / last, 4) > 3.4


@pytest.mark.parametrize("method", CHARACTERISTICS, ids=lambda method: method.name)
@pytest.mark.parametrize("count", [501, 1001, 1501, 457], ids=["on the grid", "half steps", "thirds", "neither"])
def test_characteristics_read_off_the_same_from_any_samples(method, count):
    """Even samples take short cuts; uneven ones, the same and one more, do not."""
    load = [{"times": [0, "5/2"], "a": [1, "1/2"], "b": [0, "-1/3"]}]
    building = named(BUILDING, load, strain=["1/3", "1/2"], velocity=["3/2"], displacement=[1])
    evaluate = method.prepare(method.state(lower(building)), 100)
    taus = np.linspace(0, 5, count)
    np.testing.assert_allclose(evaluate(taus), evaluate(np.append(taus, 5.0))[:, :-1], rtol=0, atol=1e-11)


DRIVE = named(
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
    problem = linear_problem(model.watching(model.probes[:1]))
    values = np.ones((1, 3))
    assert problem.outputs(values, np.arange(3.0)) is values
