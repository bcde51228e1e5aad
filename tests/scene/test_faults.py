"""All faults of a scene are shown at once, each with its line."""

from pathlib import Path

import pytest

from wavesym.errors import MOST_FAULTS
from wavesym.scene import Scene, SceneError
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
    assert places(text, tmp_path) == [("system.parts[1].rod", 7), ("system.parts[2].A", 8)]
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
