"""Rivals on chains that are written out: two take any of them, the others say in one line why they do not."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from wavesym.api import evaluator
from wavesym.errors import UnservedError
from wavesym.exact.reference import Reference
from wavesym.lab.chart.subjects import left_out
from wavesym.rivals import characteristics, elements, laplace, modal_elements, modes
from wavesym.rivals.every import RIVALS
from wavesym.rivals.line import stated
from wavesym.scene import Scene, lower

NETWORKS = (elements.RIVAL, modal_elements.RIVAL, laplace.RIVAL)


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
    "told ends and what is there at the start": scene(
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


def errors(rival, name, resolution, broken=lambda problem: problem):
    taus, values, sizes = truth(name)
    found = rival.prepare(broken(rival.states(lower(SCENES[name]))), resolution)(taus)
    return np.max(np.abs(found - values) / sizes, axis=1)


@pytest.mark.parametrize("name", SCENES)
def test_laplace_converges(name):
    first, last = (np.max(errors(laplace.RIVAL, name, n)) for n in (400, 2000))
    assert last < 2e-3
    assert math.log(first / last, 5) > 2


@pytest.mark.parametrize(
    ("rival", "coarse", "order"),
    [(elements.RIVAL, 40, 0.8), (modal_elements.RIVAL, 8, 0.7)],
    ids=["Newmark", "modal"],
)
@pytest.mark.parametrize("name", SCENES)
def test_elements_converge_where_nothing_jumps(name, rival, coarse, order):
    """Displacements, or what is as smooth."""
    smooth = [k for k, output in enumerate(lower(SCENES[name]).probes) if output.quantity == "displacement"] or [2]
    first, last = (np.max(errors(rival, name, n)[smooth]) for n in (coarse, 4 * coarse))
    assert last < 0.08 / coarse
    assert math.log(first / last, 4) > order


@pytest.mark.parametrize("rival", NETWORKS, ids=lambda rival: rival.name)
@pytest.mark.parametrize(
    ("name", "broken"),
    [
        ("unequal rods", lambda problem: replace(problem, delay=problem.delay[::-1])),
        ("springs and dashpots", lambda problem: replace(problem, stiffness=problem.stiffness / 2)),
        ("springs and dashpots", lambda problem: replace(problem, damping=np.diag(np.diag(problem.damping)))),
        ("branch with gears", lambda problem: replace(problem, ratios=abs(problem.ratios))),
        ("told ends and what is there at the start", lambda problem: replace(problem, strain=-problem.strain)),
    ],
    ids=["delays", "springs", "links", "gears", "strain"],
)
def test_a_fault_is_seen(rival, name, broken):
    resolution = {"finite elements, Newmark": 100, "finite elements, modal": 40, "Laplace inversion": 1000}[rival.name]
    right, wrong = np.median(errors(rival, name, resolution)), np.max(errors(rival, name, resolution, broken))
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


@pytest.mark.parametrize("rival", RIVALS, ids=lambda rival: rival.name)
def test_a_line_of_equal_rods_is_taken_by_all(rival, monkeypatch):
    monkeypatch.setitem(SCENES, "line", LINE)
    assert np.median(errors(rival, "line", rival.resolutions[len(rival.resolutions) // 2])) < 0.01


BRAKED = [{"mass": 1, "name": "a"}, {"rod": 1}, {"joint": True, "dashpot": "1/3"}]
WALLED = [{"mass": 1, "name": "a"}, {"rod": 1}, "fixed"]


@pytest.mark.parametrize("parts", [BRAKED, WALLED], ids=["dashpot", "fixed end"])
def test_ends_of_a_line(parts):
    """Characteristics take them. Modes do not, and would be far off with a dashpot."""
    given = lower(scene(parts, load=STEP, velocity=["a"], strain=["1/2"]))
    fourth = characteristics.FOURTH
    taus = np.linspace(0.05, 4.95, 50)
    values = np.array(Reference(given).values(taus.tolist()))
    np.testing.assert_allclose(fourth.prepare(fourth.states(given), 100)(taus), values, rtol=0, atol=1e-7)
    with pytest.raises(UnservedError, match=r"a dashpot given|an end that moves as told given"):
        modes.RIVAL.states(given)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("unequal rods", "a rod of another length or speed than 1"),
        ("springs and dashpots", "a branch or a link"),
        ("branch with gears", "a branch or a link"),
        ("told ends and what is there at the start", "a rod of another length or speed than 1"),
    ],
)
def test_who_does_not_take_a_chain_says_so(name, why):
    refusing = [rival for rival in RIVALS if rival not in NETWORKS]
    for rival in refusing:
        with pytest.raises(UnservedError, match=why):
            rival.states(lower(SCENES[name]))
    assert [line.partition(":")[0] for line in left_out(SCENES[name])] == [rival.name for rival in refusing]


@pytest.mark.parametrize(
    ("parts", "why"),
    [
        ([{"mass": 1, "name": "a", "spring": 1}, {"rod": 1}], "a spring"),
        ([{"mass": 1, "name": "a"}, {"rod": 1, "dashpot": 1}], "a branch or a link|a spring, or a dashpot between"),
        ([{"mass": 1, "name": "a", "velocity": 1}, {"rod": 1}], "a mass that is faster"),
        ([{"mass": 1, "name": "a"}, {"rod": 1, "strain": 1}], "strained at the start"),
    ],
)
def test_what_a_line_does_not_have(parts, why):
    with pytest.raises(UnservedError, match=why):
        stated(lower(scene(parts, velocity=["a"])))


OPEN = {"type": "collision", "m": 4, "kappa": ["1/10", "1/5"], "velocity": [1, "-1/2"], "contacts": "open"}


@pytest.mark.parametrize("rival", RIVALS, ids=lambda rival: rival.name)
@pytest.mark.parametrize(
    "system",
    [OPEN, {"type": "chain", "parts": [{"rod": 1, "velocity": 1}, "contact", {"rod": 1}]}],
    ids=["named", "own"],
)
def test_none_takes_contacts_that_open(rival, system):
    given = Scene(name="scene", system=system, output={"until": 5, "velocity": ["1/2"]})
    with pytest.raises(UnservedError, match="contact that opens and closes"):
        rival.states(lower(given))
