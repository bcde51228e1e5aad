"""Wrong scenes of chains: one line each that says what is wrong and what to write, never a traceback."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import wavesym
from tests.support.chains import chains
from wavesym.errors import SceneError, WavesymError
from wavesym.exact.reference import Reference
from wavesym.scene import Scene, lower

GOOD = """name = "good"
[system]
type = "chain"
parts = [{ mass = 4, name = "hammer" }, { rod = 1 }, { spring = 3 }, { rod = "3/2", impedance = 2 },
    { mass = "1/2", name = "gear" }, { rod = 1 }, "fixed"]
[[system.branch]]
from = "gear"
name = "a"
ratio = 2
parts = [{ rod = 1, impedance = "1/2" }, { mass = 1, name = "far" }]
[[load]]
at = "hammer"
times = [0, 2]
steps = [1, -1]
[output]
until = 4
velocity = ["hammer"]
strain = ["1/2"]
"""

ROD = "{ rod = 1 }, { spring = 3 }"
MISTAKES = [
    # branches
    (
        'from = "gear"',
        'from = "wheel"',
        'system.branch[0].from: "wheel" is not a node before it; write the name of one',
    ),
    ('from = "gear"', 'from = "far"', 'system.branch[0].from: "far" is not a node before it; write the name of one'),
    ('from = "gear"\n', "", "system.branch[0].from: missing; write the name of a node"),
    ('name = "a"', 'name = "gear"', 'system.branch[0].name: "gear" is taken; write another name'),
    ('name = "a"', 'name = "1a"', 'system.branch[0].name: "1a" is not a name'),
    ("ratio = 2", "ratio = 0", "system.branch[0].ratio: 0 is no ratio; write another number"),
    ("ratio = 2", "ratio = nan", "system.branch[0].ratio: nan is not a number"),
    ("ratio = 2", "turns = 2", "system.branch[0].turns: unknown key"),
    (
        "parts = [{ rod = 1, imp",
        "parts = [{ mass = 1, velocity = 1 }, { rod = 1, imp",
        "system.branch[0].parts[0].velocity: what stands first in a branch is part of its node, and has the velocity "
        "of that; leave it out",
    ),
    (
        '"1/2" }, { mass = 1, name = "far" }]',
        '"1/2" }, { spring = 1 }]',
        "system.branch[0].parts: a spring or dashpot at an end; write something for it to hold",
    ),
    (
        'impedance = "1/2" }',
        'impedance = "1/2", velocity = 1 }',
        "system.parts[4].velocity: missing, and the rods beside this mass have two velocities; write that of the mass",
    ),
    # parts that cannot stand where they are
    (
        ROD,
        "{ mass = 1 }, { rod = 1 }, { spring = 3 }",
        "system.parts[1]: a node beside another; write a rod, a spring or a dashpot between them",
    ),
    (
        ROD,
        '{ rod = 1 }, "joint", { joint = true }, { spring = 3 }',
        "system.parts[3]: a node beside another; write a rod, a spring or a dashpot between them",
    ),
    (
        ROD,
        '{ rod = 1 }, "fixed", { spring = 3 }',
        "system.parts[2]: an end between other parts; write a mass or a joint",
    ),
    (
        ROD,
        '{ rod = 1 }, "free", { spring = 3 }',
        "system.parts[2]: an end between other parts; write a mass or a joint",
    ),
    (
        ROD,
        '{ rod = 1 }, "absorbing", { spring = 3 }',
        "system.parts[2]: an end between other parts; write a mass or a joint",
    ),
    (
        ROD,
        '{ rod = 1 }, { motion = "velocity" }, { spring = 3 }',
        "system.parts[2]: an end between other parts; write a mass or a joint",
    ),
    (', "fixed"]', ", { spring = 1 }]", "system.parts: a spring or dashpot at an end; write something for it to hold"),
    (
        ', "fixed"]',
        ', { spring = 1 }, "absorbing"]',
        'system.parts[7]: "absorbing" without a rod; write a rod beside it',
    ),
    (
        ROD,
        "{ rod = 1 }, { spring = 3 }, { spring = 3 }",
        "system.parts[3]: a joint without mass, rod or dashpot; write one of these at it",
    ),
    (
        ROD,
        "{ rod = 1 }, { spring = 3 }, { joint = true }, { dashpot = 1 }, { joint = true }, { spring = 1 }",
        "system.parts[3]: a joint without mass, rod or dashpot; write one of these at it",
    ),
    # contacts
    (
        "mass = 4, name",
        "contact = 0 }, { mass = 4, name",
        "system.parts[0]: a contact at an end; write something for it to touch",
    ),
    (', "fixed"]', ', "contact"]', "system.parts[6]: a contact at an end; write something for it to touch"),
    (
        ', "fixed"]',
        ', "contact", "free"]',
        'system.parts[7]: "free" beside a contact; write a rod, a mass, "fixed" or a motion',
    ),
    (
        ROD,
        '{ rod = 1 }, { contact = "-1/2" }',
        'system.parts[2].contact: "-1/2" is negative; write a number of 0 or more',
    ),
    (ROD, "{ rod = 1 }, { contact = 0, name = 1 }", "system.parts[2].name: unknown key; write contact"),
    (
        ROD,
        '{ rod = 1 }, { contact = 0, restitution = "1/2" }',
        "system.parts[2].restitution: unknown key; leave it out: it is no law of waves, how fast a rod rebounds "
        "follows from what travels in it",
    ),
    (
        ROD,
        "{ rod = 1 }, { spring = 1, yield = 1, J = 2 }",
        "system.parts[2].J: unknown key; write dashpot = c; Smith's damping J v R is a product and no such law, "
        "c = J R stands for it",
    ),
    (
        'type = "chain"',
        'type = "chain"\ninitial = "at rest"',
        'system.initial: "at rest" is not a start; write "static"',
    ),
    ("mass = 4, name", "mass = 4, ground = 3, name", "system.parts[0].ground: 3 is not a table; write { spring = K }"),
    (
        "mass = 4, name",
        "mass = 4, ground = { mass = 1 }, name",
        "system.parts[0].ground.mass: unknown key; write breakaway, dashpot, friction, gap, only, preload, spring",
    ),
    (
        "mass = 4, name",
        "mass = 4, spring = 1, ground = { spring = 1 }, name",
        "system.parts[0].ground.spring: stands beside ground, too; leave one of them out",
    ),
    (
        ROD,
        '{ rod = 1 }, "contact", "contact"',
        "system.parts[3]: a contact beside a contact; write a rod or a mass between them",
    ),
    (
        ROD,
        '{ rod = 1 }, "contact", { spring = 1 }',
        "system.parts[3]: no mass, rod or dashpot holds a side of a contact",
    ),
    (
        ROD,
        '{ rod = 1 }, { spring = 1 }, "contact"',
        "system.parts[3]: no mass, rod or dashpot holds a side of a contact",
    ),
    (
        ROD,
        '"contact", { mass = 1 }, { rod = 1 }',
        "system.parts[1]: a contact between two rigid parts",
    ),
    (
        "mass = 4, name",
        'motion = "velocity" }, "contact", { mass = 4, name',
        "system.parts[1]: a contact between two rigid",
    ),
    (
        'name = "gear" }, { rod = 1 }',
        'name = "gear" }, "contact"',
        "system.parts[5]: a contact between two rigid parts",
    ),
    (
        ROD,
        '"contact", { joint = true, dashpot = 1 }, "contact", { mass = 1 }, { rod = 1 }',
        "system.parts[3]: a contact b",
    ),
    (
        ROD,
        '{ rod = 1 }, "contact", { joint = true }, { spring = 1 }',
        "system.parts[3]: no mass, rod or dashpot holds a side of a contact",
    ),
    (
        "parts = [{ rod = 1, imp",
        'parts = ["contact", { mass = 1 }, { rod = 1, imp',
        "system.branch[0].parts[0]: a contact b",
    ),
    (
        'parts = [{ rod = 1, impedance = "1/2" }, { mass = 1, name = "far" }]',
        "parts = []",
        "system.branch[0].parts: no rod, ",
    ),
    # parts themselves
    (ROD, "{ rod = 0 }", "system.parts[1].rod: 0 is not positive; write a number above 0"),
    (ROD, "{ rod = -1 }", "system.parts[1].rod: -1 is not positive; write a number above 0"),
    (ROD, '{ rod = "one" }', 'system.parts[1].rod: "one" is not a number'),
    (
        ROD,
        "{ rod = 1e301 }",
        "system.parts[1].rod: 1e301 is too large or too small; write an exponent from -300 to 300",
    ),
    (ROD, "{ rod = 1, impedance = 0 }", "system.parts[1].impedance: 0 is not positive; write a number above 0"),
    (ROD, "{ rod = 1, speed = -1 }", "system.parts[1].speed: -1 is not positive; write a number above 0"),
    (ROD, "{ rod = 1, dashpot = -1 }", "system.parts[1].dashpot: -1 is negative; write a number of 0 or more"),
    (ROD, "{ rod = 1, mass = 1 }", "system.parts[1].mass: unknown key"),
    (ROD, "{ rod = 1, stiffness = 1 }", "system.parts[1].stiffness: unknown key"),
    (ROD, '{ rod = 1, name = "a b" }', 'system.parts[1].name: "a b" is not a name'),
    (ROD, "{ rod = 1 }, { spring = -3 }", "system.parts[2].spring: -3 is negative; write a number of 0 or more"),
    (
        ROD,
        "{ rod = 1 }, { spring = 0 }",
        "system.parts[2]: 0 holds nothing; write a spring, a dashpot or friction above 0",
    ),
    (
        ROD,
        "{ rod = 1 }, { dashpot = 0 }",
        "system.parts[2]: 0 holds nothing; write a spring, a dashpot or friction above 0",
    ),
    (ROD, '{ rod = 1 }, { spring = 1, name = "s" }', "system.parts[2].name: unknown key"),
    (ROD, "{ rod = 1 }, {}", "system.parts[2]: not a part"),
    (ROD, "{ rod = 1 }, { nothing = 1 }", "system.parts[2]: not a part"),
    (ROD, '{ rod = 1 }, "wall"', 'system.parts[2]: "wall" is not a part'),
    (ROD, "{ rod = 1 }, 3", "system.parts[2]: 3 is not a part"),
    (ROD, "{ rod = 1 }, [1]", "system.parts[2]: a list is not a part"),
    (
        ROD,
        "{ rod = 1 }, { joint = false }, { rod = 1 }",
        "system.parts[2].joint: false is not true; write true, or leave it out",
    ),
    (ROD, '{ rod = 1, name = "r" }, { rod = 2, name = "r" }', 'system.parts[2].name: "r" is taken; write another name'),
    ("mass = 4", "mass = 0", "system.parts[0].mass: 0 is not positive; write a number above 0"),
    ("mass = 4", "mass = true", "system.parts[0].mass: true is not a number"),
    ("mass = 4", "mass = 4, spring = -1", "system.parts[0].spring: -1 is negative; write a number of 0 or more"),
    (
        "mass = 4, name",
        "motion = 4, name",
        'system.parts[0].motion: 4 is not a motion; write "velocity" or "acceleration"',
    ),
    ('name = "gear" }', 'name = "hammer" }', 'system.parts[4].name: "hammer" is taken; write another name'),
    ('name = "far" }', 'name = "gear" }', 'system.branch[0].parts[1].name: "gear" is taken; write another name'),
    ('name = "far" }', 'name = "a" }', 'system.branch[0].parts[1].name: "a" is taken; write another name'),
    (
        ROD,
        "{ rod = 1, velocity = 1 }, { mass = 1 }",
        "system.parts[2].velocity: missing, and the rods beside this mass have two velocities",
    ),
    # loads
    ('at = "hammer"', 'at = "1/2"', 'load[0].at: "1/2" is not a node; write the name or place of one'),
    (
        'at = "hammer"',
        'at = "nobody"',
        'load[0].at: "nobody" is not a place; write one, or the name of a node or branch',
    ),
    ('at = "hammer"', 'at = "7/2"', 'load[0].at: "7/2" is a "fixed" end, which cannot move; write a node that can'),
    ('at = "hammer"', 'at = "9"', 'load[0].at: "9" is not on the chain; write a place from 0 to 7/2'),
    ('at = "hammer"', 'at = "a:9"', 'load[0].at: "a:9" is not on the chain; write a place from 0 to 1'),
    ('at = "hammer"', 'at = "a:x"', 'load[0].at: "x" is not a number'),
    ('at = "hammer"', 'at = "a"', "load[0].at"),
    ('at = "hammer"', 'at = "1"', 'load[0].at: "1" has two sides; write "1-" or "1+"'),
    ('at = "hammer"\n', "", "load[0].at: missing; write the name or place of a node"),
    ("steps = [1, -1]", "steps = [1]", "load[0].steps: 1 numbers for 2 times; write 2, one for each"),
    ("steps = [1, -1]", "", "load[0]: no numbers; write steps or ramps"),
    ("steps = [1, -1]", "a = [1, -1]", "load[0].a: unknown key"),
    # outputs
    ('["1/2"]', '["4"]', "output.strain[0]: 4 is not on the chain; write a place from 0 to 7/2"),
    ('["1/2"]', '["a:-1"]', "output.strain[0]: a:-1 is not on the chain; write a place from 0 to 1"),
    ('["1/2"]', '["b:1"]', "output.strain[0]: b:1 is not a place; write one, or the name of a node or branch"),
    ('["1/2"]', '["5/2"]', 'output.strain[0]: 5/2 has two sides; write "5/2-" or "5/2+"'),
    ('["1/2"]', '["1"]', 'output.strain[0]: 1 has two sides; write "1-" or "1+"'),
    ('["1/2"]', '["gear"]', 'output.strain[0]: gear has two sides; write "gear-" or "gear+"'),
    ('["hammer"]', '["1"]', 'output.velocity[0]: 1 has two sides; write "1-" or "1+"'),
    ('["hammer"]', '["hammer", "0"]', "output.velocity[1]: 0 is the same place as hammer"),
    ('["hammer"]', '["hammer", "hammer"]', "output.velocity[1]: hammer is the same place as hammer"),
    ('["hammer"]', '["gear", "5/2+"]', "output.velocity[1]: 5/2+ is the same place as gear"),
]


@pytest.mark.parametrize(("old", "new", "expected"), MISTAKES, ids=[f"{m[1][:30]}-{k}" for k, m in enumerate(MISTAKES)])
def test_a_mistake_is_one_line(tmp_path: Path, old: str, new: str, expected: str) -> None:
    path = tmp_path / "scene.toml"
    assert old in GOOD
    path.write_text(GOOD.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(SceneError) as refused:
        Scene.from_toml(path)
    line = str(refused.value)
    message = line.removeprefix(f"{path}: ")
    assert message.startswith(expected)
    assert line.isprintable()
    assert len(message) < 300


def test_the_scene_that_mistakes_are_made_in_is_right(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(GOOD)
    assert Scene.from_toml(path).name == "good"


def test_a_mass_moves_as_its_rods_do_those_of_branches_too() -> None:
    """At 3, with a branch that turns -2 times as fast: nothing is left to happen at tau = 0."""
    rods, branch = [{"rod": 1, "velocity": v} for v in (3, -6)], {"from": "gear", "name": "side", "ratio": -2}
    system = {"type": "chain", "parts": [rods[0], {"mass": 1, "name": "gear"}]}
    system["branch"] = [branch | {"parts": rods[1:]}]
    scene = Scene(name="s", system=system, output={"until": 2, "velocity": ["gear", "side:1"], "strain": ["side:1/2"]})
    assert [list(row) for row in Reference(lower(scene)).values([0.0, 1.5])] == [[0, 0], [3, 3], [-6, -6]]


def test_no_rod_and_no_parts() -> None:
    output = {"until": 1, "velocity": [0]}
    for parts in ([], ["free"], [{"mass": 1}]):
        with pytest.raises(SceneError, match=r"^scene: system\.parts: no rod, spring or dashpot; write at least one$"):
            Scene(name="s", system={"type": "chain", "parts": parts}, output=output)
    with pytest.raises(SceneError, match=r"^scene: system\.parts: missing; write a list of parts$"):
        Scene(name="s", system={"type": "chain"}, output=output)
    with pytest.raises(SceneError, match=r"^scene: system\.parts: "):
        Scene(name="s", system={"type": "chain", "parts": "fixed"}, output=output)


def test_branches_alone_may_have_what_stands_between_nodes(tmp_path: Path) -> None:
    """A mass and a rod that turns twice as fast are a mass at the end of a rod four times as stiff; a page too."""
    held = {"mass": 1, "name": "hub"}
    branch = {"from": "hub", "name": "arm", "ratio": 2, "parts": [{"rod": 1, "name": "r"}, "fixed"]}
    load = [{"at": "hub", "times": [0], "steps": [1]}]
    output = {"until": 5, "displacement": ["hub"]}
    branched = Scene(name="s", system={"type": "chain", "parts": [held], "branch": [branch]}, load=load, output=output)
    line = {"type": "chain", "parts": [held, {"rod": 1, "impedance": 4}, "fixed"]}
    found, expected = (
        wavesym.run(scene, samples=11)["displacement@hub"]
        for scene in (branched, Scene(name="s", system=line, load=load, output=output))
    )
    assert found == pytest.approx(expected, rel=1e-13)
    w = np.array([mode.omega for mode in wavesym.modes(branched, count=5)])
    assert np.cos(w) * 4 - w * np.sin(w) == pytest.approx(np.zeros(5), abs=1e-13)
    wavesym.report(branched, tmp_path / "page.html")
    assert "every rod of the branch arm" in (tmp_path / "page.html").read_text()


@pytest.mark.parametrize(
    ("parts", "why"),
    [
        ([{"mass": 1}], "no rod, spring or dashpot; write at least one"),
        (["contact", {"mass": 1}], "contacts alone; write a rod, a spring or a dashpot, too"),
    ],
)
def test_branches_of_bare_masses_or_contacts_are_none(parts: list[Any], why: str) -> None:
    system = {"type": "chain", "parts": [{"mass": 1, "name": "hub"}]}
    system["branch"] = [{"from": "hub", "name": "b", "parts": parts}]
    with pytest.raises(SceneError, match=rf"^scene: system\.parts: {why}$"):
        Scene(name="s", system=system, output={"until": 1, "velocity": ["hub"]})


NUMBER = st.sampled_from([0, 1, -1, "1/2", "1e-300", "1e300", 2.5, True, None, "x", "1/0", [], 10**400])
KEYS = ["rod", "mass", "joint", "motion", "spring", "dashpot", "impedance", "speed", "velocity", "contact", "name", "x"]
TABLE = st.dictionaries(st.sampled_from(KEYS), st.one_of(NUMBER, st.sampled_from(["velocity", "n0"])), max_size=3)
MARK = st.sampled_from(["free", "fixed", "joint", "absorbing", "contact", "wall", 3, None, ["rod"]])
LINK = st.sampled_from([{"spring": 1}, {"dashpot": 1}, {"spring": 1, "dashpot": "1/2"}])
NODE = st.sampled_from([{"mass": 1}, {"joint": True}, {"joint": True, "spring": 1}, {"motion": "velocity"}])
PLACE = st.sampled_from(["n0", "n0-", "b0", "side:0", "side:0+", "side:1", "0", "1", "1-", "5/2", "1/2", "x", "", 1])


@st.composite
def spoilt(draw) -> dict[str, Any]:
    """A chain of which one thing or another is changed: a part more or less, a key, a place."""
    table = copy.deepcopy(draw(chains("3/2")))
    lines = [table["system"]["parts"], *(branch["parts"] for branch in table["system"].get("branch", ()))]
    for _ in range(draw(st.integers(1, 2))):
        parts = draw(st.sampled_from(lines))
        k = draw(st.integers(0, len(parts)))
        match draw(st.sampled_from(["less", "more", "more", "key", "turn", "ratio", "at", "place"])):
            case "less":
                del parts[k : k + 1]
            case "more":
                parts.insert(k, copy.deepcopy(draw(st.one_of(LINK, NODE, LINK, NODE, MARK, TABLE))))
            case "key" if k < len(parts) and isinstance(parts[k], dict):
                parts[k] |= draw(TABLE)
            case "turn":
                parts.reverse()
            case "ratio" if len(lines) > 1:
                table["system"]["branch"][0]["ratio"] = draw(NUMBER)
            case "at":
                table["load"].append({"at": draw(PLACE), "times": [0], "steps": [1]})
            case _:
                table["output"][draw(st.sampled_from(["velocity", "strain", "displacement"]))] = [draw(PLACE)]
    return table


@settings(max_examples=40)
@given(spoilt())
def test_whatever_is_drawn_is_right_or_one_line(table: dict[str, Any]) -> None:
    """And what is right can be solved, or says why not."""
    line = ""
    try:
        Reference(lower(Scene(**table))).values([0.0, 0.75, 1.5])
    except WavesymError as error:
        line = str(error)
    assert all(each.isprintable() and len(each) < 400 for each in line.split("\n"))


@pytest.mark.parametrize("units", [{}, {"units": {}}])
def test_a_table_of_the_ground_means_what_its_keys_do(units: dict[str, Any]) -> None:
    """Of a mass and of a joint."""
    law = {"spring": "3 N/m", "yield": "0.25 N"} if units else {"spring": 3, "yield": "1/4"}
    mass, moves = ("2 kg", "1 m/s") if units else (2, 1)
    link = {"spring": "1 N/m", "dashpot": "1 N*s/m"} if units else {"spring": 1, "dashpot": 1}

    def scene(at_mass: dict[str, Any], at_joint: dict[str, Any]) -> Scene:
        parts = [{"mass": mass, "velocity": moves, "name": "a", **at_mass}, link, {"joint": True, **at_joint}, link]
        system = {"type": "chain", "parts": [*parts, "fixed"]}
        return Scene(name="held", system=system, output={"until": "5 s" if units else 5, "velocity": ["a"]}, **units)

    spring = {"spring": law["spring"]}
    one, other = scene({"ground": law}, {"ground": spring}), scene(law, spring)
    np.testing.assert_array_equal(wavesym.run(one, samples=5).values, wavesym.run(other, samples=5).values)
    assert np.ptp(wavesym.run(one, samples=5).values) > 0
    assert lower(one).network == lower(other).network


def test_a_path_through_ground_leads_to_what_is_written_there() -> None:
    parts = [{"mass": 1, "name": "a", "ground": {"spring": 2}}, {"rod": 1}, {"mass": 2}]
    scene = Scene(name="held", system={"type": "chain", "parts": parts}, output={"until": 1, "velocity": ["a"]})
    other = scene.with_({"system.parts[0].ground.spring": 3})
    assert lower(other).network.points[0].stiffness == 3
