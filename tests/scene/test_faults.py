"""All faults of a scene are shown at once, each with its line."""

from pathlib import Path

import pytest

from wavesym.errors import MOST_FAULTS
from wavesym.scene import Scene, SceneError
from wavesym.scene.first_scene import first_text
from wavesym.scene.key_lines import key_lines, line_of

FAULTY = """name = "bad"
colour = 3

[system]
type = "building"
m = 2
kappa = [
  1,
  -1,   # no
  2,
]
base = "rock"
"ex tra" = 1

[[load]]
times = [0]
a = [1]

[[load]]
times = [1, 0]
a = [1, 2]

[output]
untill = 20
strain = [0, "x=#["]
"""


def places(text: str, folder: Path) -> list[tuple[str, int]]:
    """The paths and lines of all faults of a scene."""
    path = folder / "bad.toml"
    path.write_text(text)
    with pytest.raises(SceneError) as refused:
        Scene.from_toml(path)
    every = [refused.value, *refused.value.others]
    assert [str(each) for each in every[1:]] == refused.value.lines[1:]
    assert all(line.endswith(f" (line {each.line})") for line, each in zip(refused.value.lines, every, strict=True))
    return [(each.path, each.line) for each in every]


def test_faults_come_in_the_order_of_the_file(tmp_path: Path) -> None:
    """What depends on a fault, as loads do on a wrong system, waits."""
    assert places(FAULTY, tmp_path) == [
        ("colour", 2),
        ("system.kappa[1]", 9),
        ("system.base", 12),
        ('system."ex tra"', 13),
        ("output.untill", 24),
        ("output.strain[1]", 25),
    ]
    better = FAULTY.replace("-1,", "1,").replace('"rock"', '"force"').replace('"ex tra" = 1\n', "")
    loads = [("colour", 2), ("load[1].times[1]", 19), ("output.untill", 23), ("output.strain[1]", 24)]
    assert places(better, tmp_path) == loads
    right = better.replace("colour = 3\n", "").replace("[1, 0]", "[1, 2]").replace("untill", "until")
    assert places(right.replace("x=#[", "1"), tmp_path) == [("output.strain[1]", 23)]


def test_faults_of_scenes_with_units(tmp_path: Path) -> None:
    text = """name = "bar"
units = {}
[system]
type = "chain"
parts = [
  { mass = "1 kg*m", name = "hammer" },
  { rod = "1 s", E = "210 GPa", rho = "7850 kg/m^3", A = "8 m^2" },
  { rod = "1 m", E = "210 GPa", rho = "7850 kg/m^3", A = "8 m" },
]
[[load]]
at = "hammer"
times = ["0 s"]
steps = ["1 N"]
[output]
until = "1 ms"
velocity = ["hammer"]
"""
    assert places(text, tmp_path) == [
        ("system.parts[0].mass", 6),
        ("system.parts[1].rod", 7),
        ("system.parts[2].A", 8),
    ]
    for old, new in {"1 s": "1 m", "8 m": "8 m^2", "1 kg*m": "1 kg", "1 N": "1 m", "1 ms": "1 m^3"}.items():
        text = text.replace(f'"{old}"', f'"{new}"')
    assert places(text, tmp_path) == [("load[0].steps[0]", 13), ("output.until", 15)]


def test_of_many_faults_the_first_are_shown() -> None:
    with pytest.raises(SceneError) as refused:
        Scene(name="s", system={"type": "drive"}, output={"until": 1}, **{f"k{k}": k for k in range(30)})
    count = 1 + len(refused.value.others)
    assert count > 30
    assert len(refused.value.lines) == MOST_FAULTS + 1
    assert refused.value.lines[-1] == f"scene: and {count - MOST_FAULTS} more faults"


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("a = 1\nb.c = 2\n", {"a": 1, "b": 2, "b.c": 2}),
        ("[[x]]\n[x.y]\nz = 1\n\n[[x]]\n", {"x": 1, "x[0]": 1, "x[0].y": 2, "x[0].y.z": 3, "x[1]": 5}),
        (
            'a = """\n[b]\n"""\nc = [1, # ]\n [2,\n{d = "}"}]]',
            {"a": 1, "c": 4, "c[0]": 4, "c[1]": 5, "c[1][0]": 5, "c[1][1]": 6, "c[1][1].d": 6},
        ),
        ("'a.b' = 0.5\n\"c d\".e = 1979-05-27 07:32:00", {'"a.b"': 1, '"c d"': 2, '"c d".e': 2}),
        ("a = '''\\''' # '''\n# b = 1\nd = {}\nf = []\n", {"a": 1, "d": 3, "f": 4}),
        ('a = """"x\n"""""\nb = 1', {"a": 1, "b": 3}),
    ],
)
def test_where_keys_stand(text: str, lines: dict[str, int]) -> None:
    assert key_lines(text) == {**lines}


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("a", 1),
        ("a.b", 1),
        ("a[0]", 2),
        ("a[0].b", 2),
        ('a[0]."b c"', 3),
        ('a[0]."b c".d[3]', 3),
        ("", 0),
        ("b.c[1]", 0),
    ],
)
def test_what_is_missing_is_on_the_line_of_its_table(path: str, line: int) -> None:
    assert line_of(path, {"a": 1, "a[0]": 2, 'a[0]."b c"': 3}) == line


IN_UNITS = """name = "seven"
[units]
pressure = "MPa"
force = "kNN"
[system]
type = "chain"
parts = [
  { motion = "acceleration", name = "base" },
  { rod = "4 m", A = "1 m^2", G = "3 MPa", rho = "1700 kg/m^3" },
  { mass = "12 kN", name = "top" },
]
[[load]]
at = "ground"
spacing = "0.1 s"
samples = [0, 1]
unit = "g"
[output]
until = "1 kg"
velocityy = ["top"]
displacement = ["9 m"]
"""


def test_one_wrong_unit_of_results_hides_nothing(tmp_path: Path) -> None:
    """Loads and places hang on the system: where it is wrong they wait, and nothing else does."""
    assert places(IN_UNITS, tmp_path) == [
        ("units.pressure", 3),
        ("system.parts[1].G", 9),
        ("system.parts[2].mass", 10),
        ("output.velocityy", 19),
    ]
    sound = IN_UNITS.replace("G = ", "E = ").replace("12 kN", "12 kg")
    assert places(sound, tmp_path) == [
        ("units.pressure", 3),
        ("units.force", 4),
        ("load[0].at", 13),
        ("output.until", 18),
        ("output.velocityy", 19),
        ("output.displacement[0]", 20),
    ]


def test_a_load_at_no_node_is_told_so_and_not_that_its_unit_is_wrong(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(IN_UNITS.replace("G = ", "E = ").replace("12 kN", "12 kg"))
    with pytest.raises(SceneError) as refused:
        Scene.from_toml(path)
    (line,) = [line for line in refused.value.lines if "load[0]" in line]
    assert 'load[0].at: "ground" is not a node; write "base", "top", or a place such as "1.2 m"' in line


@pytest.mark.parametrize("kind", ["frame", "wall", "soil", "drive", "impact", "pile"])
def test_units_that_were_forgotten_are_named(kind: str) -> None:
    text = first_text(kind)
    head, _, tail = text.partition("[units]")
    without = head + tail[tail.index("[system]") :]
    with pytest.raises(SceneError) as refused:
        Scene.from_toml(without)
    assert refused.value.path == "units"
    assert "has a unit; write the line [units] before [system]" in refused.value.what
    Scene.from_toml(text)


def test_a_mass_at_the_end_of_a_chain_needs_no_free_end() -> None:
    parts = [{"rod": 1}, {"mass": 1}, "free"]
    with pytest.raises(SceneError, match='or leave "free" out, as a chain may end with a node'):
        Scene(name="end", system={"type": "chain", "parts": parts}, output={"until": 1, "velocity": ["1"]})
    Scene(name="end", system={"type": "chain", "parts": parts[:-1]}, output={"until": 1, "velocity": ["1"]})


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        ("output.moment", [0], "output.moment: unknown key; write force, which is a moment in shafts"),
        ("units.pressure", "MPa", "units.pressure: unknown key; write stress"),
    ],
)
def test_what_people_look_for_is_answered_with_what_there_is(path: str, value: object, said: str) -> None:
    table, key = path.split(".")
    parts = [{"rod": "1 m", "speed": "5000 m/s", "impedance": "1 kN*s/m"}, "fixed"]
    fields = {
        "units": {},
        "output": {"until": "1 ms", "velocity": ["0 m"]},
        "system": {"type": "chain", "parts": parts},
    }
    fields[table] = fields[table] | {key: value}
    with pytest.raises(SceneError) as caught:
        Scene(name="bar", **fields)
    assert said in str(caught.value)
