"""Damping of modes in scenes: what may be said, what is refused, and who serves it."""

import json
from fractions import Fraction

import pytest
from flint import fmpq

import wavesym
from tests.support.modal import building, chain, samples
from wavesym import api
from wavesym.errors import SceneError, UnservedError
from wavesym.mechanics.damping import Damping
from wavesym.results.response import Response
from wavesym.scene import Scene, lower

PARTS = ["fixed", {"rod": 1}, {"mass": 1, "name": "n"}]


def scene(damping, kind="building"):
    system = {"type": "building", "m": 2, "kappa": [1, 1, 1], "base": "ground"}
    if kind == "drive":
        system = {"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 1]}
    if kind == "chain":
        system = {"type": "chain", "parts": PARTS}
    if damping is not None:
        system["damping"] = damping
    return Scene(name="a", system=system, load=[], output={"until": 3, "velocity": [1]})


@pytest.mark.parametrize("kind", ["building", "drive", "chain"])
@pytest.mark.parametrize(
    ("damping", "ratios", "modes"),
    [
        ("0.05", ["1/20"], None),
        (0.05, ["1/20"], None),
        ("5 %", ["1/20"], None),
        ("5 percent", ["1/20"], None),
        ("5%", ["1/20"], None),
        (1, ["1"], None),
        ("150 %", ["3/2"], None),
        (["1/3 %", 0.5], ["1/300", "1/2"], None),
        ({"modes": [3, 1], "ratio": "5 %"}, ["1/20"], (1, 3)),
        ([0, "0.05", 1], ["0", "1/20", "1"], None),
        ({"modes": [3, 1], "ratio": "0.05"}, ["1/20"], (1, 3)),
    ],
)
def test_damping_is_a_ratio_a_list_or_that_of_rayleigh(kind, damping, ratios, modes):
    made = scene(damping, kind)
    expected = Damping(tuple(fmpq(*Fraction(ratio).as_integer_ratio()) for ratio in ratios), modes)
    assert lower(made).damping == expected
    again = Scene(**json.loads(json.dumps(made.model_dump(mode="json"))))
    assert lower(again).damping == expected
    assert lower(again).labels == lower(made).labels
    assert lower(made).labels.system["damping"]


@pytest.mark.parametrize(
    ("damping", "percent"), [(0.2, None), ("20 %", None), (0.25, "25"), ("500 %", "500"), ([0.01, 0.3], "30")]
)
def test_more_damping_than_structures_have_is_said(damping, percent):
    notes = lower(scene(damping)).labels.notes
    line = f"system.damping: {percent} % of critical; structures have some percent"
    assert notes == (() if percent is None else (line,))


def test_no_damping_is_no_key_and_damping_of_0_is_none():
    assert "damping" not in scene(None).model_dump()["system"]
    assert lower(scene(0)).damping is None
    assert lower(scene(None)).labels.sha256 != lower(scene(0)).labels.sha256


@pytest.mark.parametrize(
    ("damping", "message"),
    [
        (-0.05, "system.damping: -0.05 is negative; write a ratio of 0 or more"),
        ("1e160", 'system.damping: "1e160" is too large a ratio; write 1000000000 or less'),
        (5, 'system.damping: 5 is above critical damping; write "5 %" or "500 %", whichever is meant'),
        ("3/2", 'system.damping: "3/2" is above critical damping; write "1.5 %" or "150 %", whichever is meant'),
        ([0.1, 2], 'system.damping[1]: 2 is above critical damping; write "2 %" or "200 %", whichever is meant'),
        (
            {"modes": [1, 2], "ratio": 5},
            'system.damping.ratio: 5 is above critical damping; write "5 %" or "500 %", whichever is meant',
        ),
        ("-5 %", 'system.damping: "-5 %" is negative; write a ratio of 0 or more'),
        ("%", 'system.damping: "%" is not a number; write an integer, a decimal or "p/q"'),
        ("5 %%", 'system.damping: "5 %%" is not a number; write an integer, a decimal or "p/q"'),
        ([0.1, -1], "system.damping[1]: -1 is negative; write a ratio of 0 or more"),
        ([], "system.damping: 0 ratios; write 1 to 1000 of them"),
        (True, 'system.damping: true is not a number; write an integer, a decimal or "p/q"'),
        ({"modes": [1, 3]}, "system.damping.ratio: missing; write a ratio"),
        ({"ratio": 0.1}, "system.damping.modes: missing; write the numbers of two modes"),
        (
            {"modes": [1, 3], "ratios": 0.1},
            'system.damping.ratios: unknown key; write modes or ratio. Did you mean "ratio"?',
        ),
        ({"modes": [1], "ratio": 0.1}, "system.damping.modes: a list is not a list of two modes; write [1, 3]"),
        ({"modes": [1, 1], "ratio": 0.1}, "system.damping.modes: 1 stands twice; write two modes such as [1, 3]"),
        (
            {"modes": [0, 1], "ratio": 0.1},
            "system.damping.modes[0]: 0 is not the number of a mode; write an integer from 1 to 1000",
        ),
        ({"modes": [1, 2], "ratio": -1}, "system.damping.ratio: -1 is negative; write a ratio of 0 or more"),
    ],
)
def test_what_is_no_damping_is_refused_in_one_line(damping, message):
    with pytest.raises(SceneError) as caught:
        scene(damping)
    assert str(caught.value) == f"scene: {message}"


@pytest.mark.parametrize(
    ("parts", "other"),
    [
        (["fixed", {"rod": 1}, {"mass": 1, "dashpot": 1, "name": "n"}], "a dashpot or an absorbing end at n"),
        (["fixed", {"rod": 1}, "absorbing"], "a dashpot or an absorbing end at 1"),
        (["fixed", {"rod": 1, "dashpot": 2}, {"mass": 1}], "a dashpot"),
        (["fixed", {"rod": 1}, "contact", {"rod": 1}, "fixed"], "a contact"),
    ],
)
def test_dampers_at_places_are_refused_with_it(parts, other):
    with pytest.raises(SceneError) as caught:
        chain(parts, system={"damping": "0.05"}, velocity=["0"])
    assert str(caught.value) == (
        f"scene: system.damping: stands beside {other}; write one of them, or in place of a ratio a dashpot in each rod"
    )


def test_a_collision_has_none():
    system = {"type": "collision", "m": 4, "kappa": [1, 1], "velocity": [1, 0], "damping": 0.1}
    with pytest.raises(SceneError, match=r"^scene: system\.damping: unknown key"):
        Scene(name="a", system=system, output={"until": 1, "velocity": [1]})


@pytest.mark.parametrize("evaluator", ["closed", "pieces", "march"])
@pytest.mark.parametrize("kind", ["building", "drive", "chain"])
def test_programs_of_waves_refuse_it(tmp_path, kind, evaluator):
    with pytest.raises(
        UnservedError, match=r"^system.damping: supported by modes only \(write --evaluator modes, or leave it out\)$"
    ):
        wavesym.generate(scene("0.05", kind), tmp_path / "a", evaluator=evaluator)
    assert not (tmp_path / "a").exists()


def test_what_computes_waves_refuses_it(tmp_path):
    damped = scene("0.05")
    for wanted in (
        lambda: wavesym.tables(damped),
        lambda: api.symbolic_tables(damped, 1, "csv"),
        lambda: api.derive(damped, None),
        lambda: api.walks(damped, None, 1),
    ):
        with pytest.raises(UnservedError, match=r"^system.damping: supported by modes only"):
            wanted()
    assert "system.damping: supported by modes only" in api.inspect(damped, "table")


def test_inspect_states_the_ratios_of_all_modes():
    """Rayleigh's pair has what was asked for, the others what the two make of them."""
    said = json.loads(api.inspect(scene({"modes": [1, 3], "ratio": "0.05"}), "model", "json"))
    rows = said["modes"]
    w, ratios = ([row[name] for row in rows] for name in ("frequency", "damping"))
    assert ratios[0] == pytest.approx(0.05)
    assert ratios[2] == pytest.approx(0.05)
    a, b = 0.1 * w[0] * w[2] / (w[0] + w[2]), 0.1 / (w[0] + w[2])
    assert ratios == pytest.approx([a / (2 * each) + b * each / 2 for each in w])
    listed = api.inspect(scene(["0.05", "0.02"]), "model")
    assert "all higher ones have 0.02" in listed
    assert "modes" not in json.loads(api.inspect(scene(None), "model", "json"))


def test_a_building_may_have_one_storey():
    """What it does is what the chain does that it is: a bar under a mass."""
    load = samples(5)
    one = building(["1", "3/5"], [load], strain=["0"], displacement=[1], until=6)
    parts = [{"motion": "acceleration", "name": "g"}, {"rod": 1}, {"mass": "5/3"}]
    same = chain(parts, [{"at": "g", **load}], strain=["0"], velocity=[1], displacement=[1], until=6)
    taus = [0.5, 1, 2.3, 4.7, 6]
    values = [Response(model)(taus) for model in (one, same)]
    assert values[0] == pytest.approx(values[1], rel=1e-15)
