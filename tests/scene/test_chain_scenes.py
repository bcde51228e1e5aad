"""Wrong scenes of chains: one line each that says what is wrong and what was expected, never a traceback."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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
    ('from = "gear"', 'from = "wheel"', 'system.branch[0].from: "wheel" given, the name of a node before it expected'),
    ('from = "gear"', 'from = "far"', 'system.branch[0].from: "far" given, the name of a node before it expected'),
    ('from = "gear"\n', "", "system.branch[0].from: missing, the name of a node expected"),
    ('name = "a"', 'name = "gear"', 'system.branch[0].name: "gear" given, a name that is not taken expected'),
    ('name = "a"', 'name = "1a"', 'system.branch[0].name: "1a" given, a name expected'),
    ("ratio = 2", "ratio = 0", "system.branch[0].ratio: 0 given, a ratio other than 0 expected"),
    ("ratio = 2", "ratio = nan", "system.branch[0].ratio: nan given, a number expected"),
    ("ratio = 2", "turns = 2", "system.branch[0].turns: unknown key"),
    (
        "parts = [{ rod = 1, imp",
        "parts = [{ mass = 1 }, { rod = 1, imp",
        "system.branch[0].parts[0]: a node given first",
    ),
    (
        '"1/2" }, { mass = 1, name = "far" }]',
        '"1/2" }, { spring = 1 }]',
        "system.branch[0].parts: a spring or dashpot given",
    ),
    (
        'impedance = "1/2" }',
        'impedance = "1/2", velocity = 1 }',
        "system.parts[4].velocity: missing, the velocity of a mass between rods of two velocities expected",
    ),
    # parts that cannot stand where they are
    (ROD, "{ mass = 1 }, { rod = 1 }, { spring = 3 }", "system.parts[1]: a node given beside another"),
    (ROD, '{ rod = 1 }, "joint", { joint = true }, { spring = 3 }', "system.parts[3]: a node given beside another"),
    (ROD, '{ rod = 1 }, "fixed", { spring = 3 }', "system.parts[2]: an end given between other parts"),
    (ROD, '{ rod = 1 }, "free", { spring = 3 }', "system.parts[2]: an end given between other parts"),
    (ROD, '{ rod = 1 }, "absorbing", { spring = 3 }', "system.parts[2]: an end given between other parts"),
    (ROD, '{ rod = 1 }, { motion = "velocity" }, { spring = 3 }', "system.parts[2]: an end given between other parts"),
    (', "fixed"]', ", { spring = 1 }]", "system.parts: a spring or dashpot given at an end"),
    (', "fixed"]', ', { spring = 1 }, "absorbing"]', 'system.parts[7]: "absorbing" given, a rod beside it expected'),
    (ROD, "{ rod = 1 }, { spring = 3 }, { spring = 3 }", "system.parts[3]: a joint without mass, rod or dashpot given"),
    (
        ROD,
        "{ rod = 1 }, { spring = 3 }, { joint = true }, { dashpot = 1 }, { joint = true }, { spring = 1 }",
        "system.parts[3]: a joint without mass, rod or dashpot given",
    ),
    # contacts
    ("mass = 4, name", "contact = 0 }, { mass = 4, name", "system.parts[0]: a contact given at an end, something for"),
    (', "fixed"]', ', "contact"]', "system.parts[6]: a contact given at an end, something for it to touch expected"),
    (', "fixed"]', ', "contact", "free"]', 'system.parts[7]: "free" given beside a contact, a rod, a mass, "fixed" or'),
    (
        ROD,
        '{ rod = 1 }, { contact = "-1/2" }',
        'system.parts[2].contact: "-1/2" given, a number of at least 0 expected',
    ),
    (ROD, "{ rod = 1 }, { contact = 0, name = 1 }", "system.parts[2].name: unknown key, contact"),
    (ROD, '{ rod = 1 }, "contact", "contact"', "system.parts[3]: a contact beside a contact given"),
    (ROD, '{ rod = 1 }, "contact", { spring = 1 }', "system.parts[3]: a side of a contact given that no mass"),
    (ROD, '{ rod = 1 }, { spring = 1 }, "contact"', "system.parts[3]: a side of a contact given that no mass"),
    (ROD, '"contact", { mass = 1 }, { rod = 1 }', "system.parts[1]: a contact between two rigid parts given"),
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
    (ROD, '{ rod = 1 }, "contact", { joint = true }, { spring = 1 }', "system.parts[3]: a side of a contact given"),
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
    (ROD, "{ rod = 0 }", "system.parts[1].rod: 0 given, a positive number expected"),
    (ROD, "{ rod = -1 }", "system.parts[1].rod: -1 given, a positive number expected"),
    (ROD, '{ rod = "one" }', 'system.parts[1].rod: "one" given, a number expected'),
    (ROD, "{ rod = 1e301 }", "system.parts[1].rod: 1e301 given, an exponent"),
    (ROD, "{ rod = 1, impedance = 0 }", "system.parts[1].impedance: 0 given, a positive number expected"),
    (ROD, "{ rod = 1, speed = -1 }", "system.parts[1].speed: -1 given, a positive number expected"),
    (ROD, "{ rod = 1, dashpot = -1 }", "system.parts[1].dashpot: -1 given, a number of at least 0 expected"),
    (ROD, "{ rod = 1, mass = 1 }", "system.parts[1].mass: unknown key"),
    (ROD, "{ rod = 1, stiffness = 1 }", "system.parts[1].stiffness: unknown key"),
    (ROD, '{ rod = 1, name = "a b" }', 'system.parts[1].name: "a b" given, a name expected'),
    (ROD, "{ rod = 1 }, { spring = -3 }", "system.parts[2].spring: -3 given, a number of at least 0 expected"),
    (ROD, "{ rod = 1 }, { spring = 0 }", "system.parts[2]: 0 given, a spring or a dashpot above 0 expected"),
    (ROD, "{ rod = 1 }, { dashpot = 0 }", "system.parts[2]: 0 given, a spring or a dashpot above 0 expected"),
    (ROD, '{ rod = 1 }, { spring = 1, name = "s" }', "system.parts[2].name: unknown key"),
    (ROD, "{ rod = 1 }, {}", "system.parts[2]: no kind given, rod, mass, joint, motion, contact, spring or"),
    (ROD, "{ rod = 1 }, { nothing = 1 }", "system.parts[2]: no kind given"),
    (ROD, '{ rod = 1 }, "wall"', 'system.parts[2]: "wall" given, free, fixed, absorbing, joint, contact or a table'),
    (ROD, "{ rod = 1 }, 3", "system.parts[2]: 3 given, a table, or one of"),
    (ROD, "{ rod = 1 }, [1]", "system.parts[2]: a list given, a table, or one of"),
    (ROD, "{ rod = 1 }, { joint = false }, { rod = 1 }", "system.parts[2].joint: false given, true expected"),
    (ROD, '{ rod = 1, name = "r" }, { rod = 2, name = "r" }', 'system.parts[2].name: "r" given, a name that is'),
    ("mass = 4", "mass = 0", "system.parts[0].mass: 0 given, a positive number expected"),
    ("mass = 4", "mass = true", "system.parts[0].mass: true given, a number expected"),
    ("mass = 4", "mass = 4, spring = -1", "system.parts[0].spring: -1 given, a number of at least 0 expected"),
    ("mass = 4, name", "motion = 4, name", 'system.parts[0].motion: 4 given, "velocity" or "acceleration" expected'),
    ('name = "gear" }', 'name = "hammer" }', 'system.parts[4].name: "hammer" given, a name that is not taken expected'),
    ('name = "far" }', 'name = "gear" }', 'system.branch[0].parts[1].name: "gear" given, a name that is not taken'),
    ('name = "far" }', 'name = "a" }', 'system.branch[0].parts[1].name: "a" given, a name that is not taken expected'),
    (
        ROD,
        "{ rod = 1, velocity = 1 }, { mass = 1 }",
        "system.parts[2].velocity: missing, the velocity of a mass between",
    ),
    # loads
    ('at = "hammer"', 'at = "1/2"', 'load[0].at: "1/2" given, the name or place of a node expected'),
    ('at = "hammer"', 'at = "nobody"', 'load[0].at: "nobody" given, a place or the name of a node or branch expected'),
    ('at = "hammer"', 'at = "7/2"', 'load[0].at: "7/2" given, a node that can move expected (a "fixed" end cannot)'),
    ('at = "hammer"', 'at = "9"', 'load[0].at: "9" given, a place from 0 to 7/2 expected'),
    ('at = "hammer"', 'at = "a:9"', 'load[0].at: "a:9" given, a place from 0 to 1 expected'),
    ('at = "hammer"', 'at = "a:x"', 'load[0].at: "x" given, a number expected'),
    ('at = "hammer"', 'at = "a"', "load[0].at"),
    ('at = "hammer"', 'at = "1"', 'load[0].at: "1" given, a side there expected: "1-" or "1+"'),
    ('at = "hammer"\n', "", "load[0].at: missing, the name or place of a node expected"),
    ("steps = [1, -1]", "steps = [1]", "load[0].steps: 1 numbers given, 2 expected (as many as times)"),
    ("steps = [1, -1]", "", "load[0]: no numbers given, steps or ramps expected"),
    ("steps = [1, -1]", "a = [1, -1]", "load[0].a: unknown key"),
    # outputs
    ('["1/2"]', '["4"]', "output.strain[0]: 4 given, a place from 0 to 7/2 expected"),
    ('["1/2"]', '["a:-1"]', "output.strain[0]: a:-1 given, a place from 0 to 1 expected"),
    ('["1/2"]', '["b:1"]', "output.strain[0]: b:1 given, a place or the name of a node or branch expected"),
    ('["1/2"]', '["5/2"]', 'output.strain[0]: 5/2 given, a side there expected: "5/2-" or "5/2+"'),
    ('["1/2"]', '["1"]', 'output.strain[0]: 1 given, a side there expected: "1-" or "1+"'),
    ('["1/2"]', '["gear"]', 'output.strain[0]: gear given, a side there expected: "gear-" or "gear+"'),
    ('["hammer"]', '["1"]', 'output.velocity[0]: 1 given, a side there expected: "1-" or "1+"'),
    ('["hammer"]', '["hammer", "0"]', "output.velocity[1]: 0 given, another place than hammer expected"),
    ('["hammer"]', '["hammer", "hammer"]', "output.velocity[1]: hammer given, another place than hammer expected"),
    ('["hammer"]', '["gear", "5/2+"]', "output.velocity[1]: 5/2+ given, another place than gear expected"),
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
    for parts in ([], ["free"], [{"mass": 1}], [{"mass": 1}, {"spring": 1}, {"mass": 1}]):
        with pytest.raises(SceneError, match=r"^scene: system\.parts: no rod given, at least 1 expected$"):
            Scene(name="s", system={"type": "chain", "parts": parts}, output=output)
    with pytest.raises(SceneError, match=r"^scene: system\.parts: missing, a list of parts expected$"):
        Scene(name="s", system={"type": "chain"}, output=output)
    with pytest.raises(SceneError, match=r"^scene: system\.parts: "):
        Scene(name="s", system={"type": "chain", "parts": "fixed"}, output=output)


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
    assert (line or "right").isprintable()
    assert len(line) < 400
