"""What is 0 throughout is found, and nothing else is: against the exact solution."""

from fractions import Fraction

import pytest

from tests.support.truth import Truth
from wavesym.exact import arrivals
from wavesym.exact.arrivals import identically_zero
from wavesym.numbers.doubles import rational
from wavesym.scene import Scene, lower

SHAFT = {"type": "drive", "m": 1, "kappa": ["3/7"], "inertia": [1, 1]}
TWO = {"type": "drive", "m": 2, "kappa": ["3/7", "1/7"], "inertia": [1, 3, 1]}
BARS = {"type": "collision", "m": 4, "kappa": ["3/7", "3/7"], "velocity": [1, -1]}
UNEQUAL = {"type": "collision", "m": 4, "kappa": ["3/7", "2/7"], "velocity": [1, "1/2"]}
TOWER = {"type": "building", "m": 2, "kappa": [1, "1/2", "1/3"]}


def step(body, *times, weight=1):
    return {"body": body, "times": times, "steps": [weight] * len(times)}


def found(made):
    model = lower(made)
    return identically_zero(model, rational(model.horizon()))


def scene(system, load, until, **outputs):
    return Scene(name="made", system=system, load=load, output={"until": until, "tolerance": "1e-3", **outputs})


CASES = {
    # a jump at the end of the horizon is seen, a motion or a turn that begins there is not
    "disc": (SHAFT, [step(1, 0)], ["1/2", 1, "3/2"], {"velocity": [0, "1/2", 1], "strain": ["1/2"]}),
    "late": (SHAFT, [step(1, "1/3")], ["1/3", "5/6", "4/3", "3/2"], {"velocity": ["1/2", 1], "strain": ["1/2", 0]}),
    "pushed": (
        TOWER | {"base": "force"},
        [{"times": ["1/2"], "a": [1], "b": [0]}],
        ["1/2", "3/4", 1, "3/2", "5/2", 3],
        {"strain": [0, "1/4", "1/2", "1-", "1+"], "velocity": ["1/4", 1], "displacement": ["1/2", 1]},
    ),
    "ramp": (TOWER | {"base": "force"}, [{"times": [0], "a": [0], "b": [1]}], ["1/2", 1], {"strain": [0, "1/2", "1-"]}),
    "ground": (TOWER | {"base": "ground"}, [{"times": [0], "a": [1], "b": [0]}], [1, 2], {"velocity": [0, 1, 2]}),
    "bend": (TOWER | {"base": "ground"}, [{"times": [0], "a": [0], "b": [1]}], [1, 2], {"velocity": [0, 1, 2]}),
    # equal moments turn both ends against each other
    "symmetric": (TWO, [step(1, 0), step(3, 0)], [1, 3], {"velocity": [1, "1/2"], "displacement": [1], "strain": [1]}),
    # and meet where they arrive at once, sent on different panels
    "panels": (
        SHAFT,
        [step(1, 0), step(2, "1/3")],
        ["2/3", 1, "5/4", "4/3", 2],
        {"velocity": ["2/3"], "strain": ["2/3"]},
    ),
    "against": (
        SHAFT,
        [step(1, 0), step(2, "1/3", weight=-1)],
        ["2/3", 1, "5/4"],
        {"velocity": ["2/3"], "strain": ["2/3"]},
    ),
    "nothing": (SHAFT, [step(1, 0), step(1, 0, weight=-1)], [3], {"velocity": [0]}),
    "short": (SHAFT, [step(1, 0), step(1, "1/2", weight=-1)], [1, "3/2"], {"velocity": [0, 1]}),
    # a wave that has passed by is still there
    "bars": (BARS, [], ["1/2", 1, 4], {"strain": [0, 2, "3/2", "1-"], "velocity": [2, "3/2"], "displacement": [2]}),
    "unequal": (UNEQUAL, [], [1, 4], {"strain": [0, 4, 2, "1-"], "velocity": [0, 2], "displacement": [0, 2]}),
    "apart": (
        UNEQUAL | {"velocity": [0, "-1/2"]},
        [],
        [1, 2],
        {"velocity": [0, 1, "3/2"], "displacement": [1], "strain": ["1-"]},
    ),
}


def sided(case):
    system, load, untils, outputs = case
    if system["type"] == "drive" and 1 in outputs.get("strain", ()) and system["m"] > 1:
        outputs = outputs | {"strain": ["1-"]}
    return system, load, untils, outputs


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_what_is_zero_is_told_from_what_is_small(case):
    system, load, untils, outputs = sided(case)
    for until in untils:
        made = scene(system, load, until, **outputs)
        truth = Truth(made, Fraction(lower(made).horizon()))
        expected = [truth.largest(o, truth.until)[1] == 0 for o in range(len(made.outputs))]
        assert found(made) == expected, (until, made.outputs)


def test_some_of_it_is_zero_and_some_is_not():
    """Of each case, so that the comparison can fail."""
    counted = {True: 0, False: 0}
    for case in CASES.values():
        system, load, untils, outputs = sided(case)
        for until in untils:
            for answer in found(scene(system, load, until, **outputs)):
                counted[answer] += 1
    assert min(counted.values()) > 20


def test_an_instant_is_not_missed_by_the_number_that_is_drawn(monkeypatch):
    made = scene(SHAFT, [step(1, 0), step(2, "1/3")], 2, velocity=["2/3"], strain=["2/3"])
    answers = found(made)
    for drawn in (3, 10**30 + 7):
        monkeypatch.setattr(arrivals, "_T", drawn)
        assert found(made) == answers


@pytest.mark.parametrize(("end", "outputs"), [("free", (True, False, False)), ("joint", (False, False, False))])
def test_what_a_free_end_bears_is_followed_nowhere(
    end: str, outputs: tuple[bool, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is 0 whatever moves, also where bars are strained at first; not where a load acts, or beside the end."""
    parts = [
        {"mass": 1},
        {"rod": 1, "strain": 1},
        {"rod": 2, "velocity": 1},
        {"joint": True} if end == "joint" else end,
    ]
    load = [{"at": "0", "times": [0], "steps": [1]}]
    load += [{"at": "3", "times": [0], "steps": [1]}] if end == "joint" else []
    made = Scene(
        name="bars",
        system={"type": "chain", "parts": parts},
        load=load,
        output={"until": 40, "strain": ["3", "2999/1000", "1-"]},
    )
    model = lower(made)
    by_fronts = [first is None for first in arrivals.arrivals(model, model.until)]
    assert (found(made), tuple(by_fronts)) == (list(outputs), outputs)
    free = model.watching(model.probes[:1])
    monkeypatch.setattr(arrivals, "arrivals", lambda *_: pytest.fail("fronts are followed"))
    if end == "free":
        assert identically_zero(free, model.until) == [True]
