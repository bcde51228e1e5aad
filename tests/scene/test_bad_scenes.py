"""Every mistake is one line: where it is, what is wrong, what to write."""

from __future__ import annotations

import io
import os
import pickle
import re
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from flint import fmpq

from wavesym.fields import loads as timed_loads
from wavesym.mechanics.network import Link, Point
from wavesym.scene import Scene, SceneError, outputs
from wavesym.scene.lowering import load_names
from wavesym.scene.scene_file import parse_text
from wavesym.systems.contacts import refuse_joined_corners


@pytest.mark.parametrize("source", [None, b"name", 3, ["a"]])
def test_what_is_no_path_is_refused_in_a_line(source: Any) -> None:
    with pytest.raises(SceneError, match=r"is no path and no text; write Scene.from_toml"):
        Scene.from_toml(source)


COLLISION = """name = "good"
[system]
type = "collision"
m = 4
kappa = [0.1, 0.2]
velocity = [1, -0.5]
[output]
until = 10
strain = ["1-"]
"""
DRIVE = """name = "good"
[system]
type = "drive"
m = 2
kappa = [1, 1]
inertia = [1, 1, 1]
[[load]]
body = 3
times = [0, 3]
steps = [1, "-1/2"]
[output]
until = 10
strain = [0.5]
"""
BUILDING = """name = "good"
[system]
type = "building"
m = 2
kappa = ["1/4", "3/5", "1/5"]
base = "force"
[[load]]
times = [0, "5/2"]
a = [1, 0]
b = [0, 1]
[[load]]
spacing = "1/5"
samples = [0, 0.1]
[output]
until = 10
tolerance = 1e-8
strain = [0.5]
velocity = [0.5, 2]
"""
HUGE = "1" + "0" * 4000

MISTAKES = [
    # unknown and missing keys
    (
        DRIVE,
        'name = "good"',
        'name = "good"\ncolour = 1',
        "colour: unknown key; write name, units, system, load, output or report",
    ),
    (
        DRIVE,
        "kappa =",
        "kapa =",
        "system.kapa: unknown key; write type, m, kappa, inertia, damping or speed_adjustment",
    ),
    (DRIVE, "steps", '"st\\neps"', 'load[0]."st\\neps": unknown key; write name, times, body, steps or ramps'),
    (DRIVE, "until", "untl", "output.untl: unknown key"),
    (DRIVE, 'name = "good"', "", "name: missing"),
    (DRIVE, "kappa = [1, 1]", "", "system.kappa: missing; write a list of m positive numbers"),
    (DRIVE, "body = 3", "", "load[0].body: missing; write the number of a body, 1 to m + 1"),
    (DRIVE, "until = 10", "", "output.until: missing"),
    (BUILDING, 'base = "force"', "", 'system.base: missing; write "force" or "ground"'),
    (BUILDING, 'base = "force"', 'base = "rock"', 'system.base: "rock" is not a base; write "force" or "ground"'),
    (BUILDING, "a = [1, 0]\nb = [0, 1]", "", "load[0]: no numbers; write a or b"),
    (BUILDING, '"1/5"\nsamples = [0, 0.1]', '"1/5"', "load[1].samples: missing; write a list of numbers"),
    (BUILDING, "samples = [0, 0.1]", "record = 3", "load[1].record: 3 is not a path"),
    (BUILDING, "samples = [0, 0.1]", 'record = "?"', "load[1].record: "),
    (BUILDING, "samples = [0, 0.1]", 'record = "?"\ncolum = "a"', "load[1].colum: unknown key"),
    (BUILDING, 'spacing = "1/5"', "", "load[1].spacing: missing"),
    (BUILDING, 'spacing = "1/5"', "times = [0]", "load[1].times: unknown key; write name, spacing or samples"),
    (BUILDING, "times = [0,", "body = 1\ntimes = [0,", "load[0].body: unknown key; write name, times, a or b"),
    # the system
    (
        DRIVE,
        '"drive"',
        '"train"',
        'system.type: "train" is not a system; write "collision", "drive", "building" or "chain"',
    ),
    (DRIVE, 'type = "drive"', "", 'system.type: missing; write "collision", "drive", "building" or "chain"'),
    (DRIVE, 'type = "drive"', "type = []", "system.type: a list is not a system"),
    (COLLISION, "m = 4", "m = 5", "system.m: 5 is not an even integer of 4 or more; write one"),
    (COLLISION, "m = 4", "m = 2", "system.m: 2 is not an even integer of 4 or more; write one"),
    (DRIVE, "m = 2", "m = 0", "system.m: 0 is not an integer of 1 or more; write one"),
    (BUILDING, "m = 2", "m = 0", "system.m: 0 is not an integer of 1 or more; write one"),
    (DRIVE, "m = 2", "m = -2", "system.m: -2 is not an integer of 1 or more; write one"),
    (DRIVE, "m = 2", "m = 2.0", "system.m: 2.0 is not an integer; write one without point or quotes, such as 2"),
    (DRIVE, "m = 2", "m = true", "system.m: true is not an integer; write one without point or quotes, such as 2"),
    (DRIVE, "m = 2", 'm = "2"', 'system.m: "2" is not an integer; write one without point or quotes, such as 2'),
    (DRIVE, "kappa = [1, 1]", "kappa = [1]", "system.kappa: 1 numbers; write 2 (m)"),
    (DRIVE, "[1, 1, 1]", "[1, 1]", "system.inertia: 2 numbers; write 3 (m + 1)"),
    (BUILDING, ', "1/5"]', "]", "system.kappa: 2 numbers; write 3 (m + 1)"),
    (COLLISION, "[0.1, 0.2]", "[]", "system.kappa: 0 numbers; write 2 (m/2)"),
    (COLLISION, "[1, -0.5]", "[1, 0, -1]", "system.velocity: 3 numbers; write 2 (m/2)"),
    (COLLISION, "m = 4", "m = 100000000000", "system.kappa: 2 numbers; write 50000000000 (m/2)"),
    (DRIVE, "m = 2", "m = 100000000000", "system.kappa: 2 numbers; write 100000000000 (m)"),
    (BUILDING, "m = 2", "m = 100000000000", "system.kappa: 3 numbers; write 100000000001 (m + 1)"),
    (BUILDING, "m = 2", f"m = {HUGE}", "system.kappa: 3 numbers; write a number of about 4000 digits (m + 1)"),
    (COLLISION, "m = 4", f"m = {HUGE}", "system.kappa: 2 numbers; write a number of about 3999 digits (m/2)"),
    (COLLISION, "m = 4", f"m = {HUGE}1", "system.m: a number of about "),
    (
        COLLISION,
        "[1, -0.5]",
        "[1, 1.5]",
        "system.velocity[1]: 3/2 is more than the 1 on its left, and the bodies would part",
    ),
    (COLLISION, "[0.1, 0.2]", "[0.1, 0]", "system.kappa[1]: 0 is not positive; write a number above 0"),
    (COLLISION, "[0.1, 0.2]", "[-0.1, 0.2]", "system.kappa[0]: -0.1 is not positive; write a number above 0"),
    (DRIVE, "[1, 1, 1]", "[1, 1, -0.0]", "system.inertia[2]: -0.0 is not positive; write a number above 0"),
    (BUILDING, '["1/4"', '["0/4"', 'system.kappa[0]: "0/4" is not positive; write a number above 0'),
    (DRIVE, "kappa = [1, 1]", "kappa = 1", "system.kappa: 1 is not a list; write [ ] around it"),
    (
        DRIVE,
        "kappa = [1, 1]",
        'kappa = "11"',
        'system.kappa: "11" is not a list; write [ ] around it',
    ),
    # numbers
    (DRIVE, "kappa = [1, 1]", "kappa = [1, nan]", "system.kappa[1]: nan is not a number"),
    (DRIVE, "kappa = [1, 1]", "kappa = [inf, 1]", "system.kappa[0]: inf is not a number"),
    (DRIVE, "kappa = [1, 1]", "kappa = [1, 1e400]", "system.kappa[1]: 1e400 is too large or too small"),
    (
        DRIVE,
        "kappa = [1, 1]",
        'kappa = ["1/0", 1]',
        'system.kappa[0]: "1/0" divides by 0; write another denominator',
    ),
    (
        DRIVE,
        "kappa = [1, 1]",
        "kappa = [\"__import__('os')\", 1]",
        "system.kappa[0]: \"__import__('os')\" is not a number",
    ),
    (DRIVE, "kappa = [1, 1]", "kappa = [true, 1]", "system.kappa[0]: true is not a number"),
    (DRIVE, "kappa = [1, 1]", "kappa = [[1], 1]", "system.kappa[0]: a list is not a number"),
    (DRIVE, "kappa = [1, 1]", "kappa = [1979-05-27, 1]", "system.kappa[0]: a value of type date is not a number"),
    (DRIVE, "kappa = [1, 1]", 'kappa = ["\u0661", 1]', 'system.kappa[0]: "\\u0661" is not a number'),
    (DRIVE, "until = 10", "until = nan", "output.until: nan is not a number"),
    # loads
    (COLLISION, "[output]", "[[load]]\nbody = 1\n[output]", "load: a collision has its velocities; leave [[load]] out"),
    (DRIVE, "[[load]]", "[load]", "load: a table is not a list; write [ ] around it"),
    (DRIVE, 'name = "good"', 'name = "good"\nload = 3', "not TOML, "),
    (DRIVE, "body = 3", "body = 0", "load[0].body: 0 is not the number of a body; write 1 to 3"),
    (DRIVE, "body = 3", "body = 4", "load[0].body: 4 is not the number of a body; write 1 to 3"),
    (DRIVE, "body = 3", f"body = {HUGE}", "load[0].body: a number of about "),
    (
        DRIVE,
        "body = 3",
        "body = 1.0",
        "load[0].body: 1.0 is not an integer; write one without point or quotes, such as 2",
    ),
    (DRIVE, "[0, 3]", "[3, 0]", "load[0].times[1]: 0 is not later than the 3 before it; write times in rising order"),
    (DRIVE, "[0, 3]", "[3, 3.0]", "load[0].times[1]: 3 is not later than the 3 before it; write times in rising order"),
    (DRIVE, "[0, 3]", "[-1, 3]", "load[0].times[0]: -1 is before the start; write a time of 0 or later"),
    (DRIVE, "[0, 3]", "[0, 3, nan]", 'load[0].times[2]: nan is not a number; write an integer, a decimal or "p/q"'),
    (DRIVE, "[0, 3]", "[0]", "load[0].steps: 2 numbers for 1 times; write 1, one for each"),
    (BUILDING, "b = [0, 1]", "b = [0]", "load[0].b: 1 numbers for 2 times; write 2, one for each"),
    (BUILDING, '"1/5"\nsamples', "0\nsamples", "load[1].spacing: 0 is not positive; write a number above 0"),
    (BUILDING, "[0, 0.1]", "[]", "load[1].samples: no numbers; write at least 1"),
    (BUILDING, "[0, 0.1]", '[0, "x"]', 'load[1].samples[1]: "x" is not a number'),
    # outputs
    (DRIVE, "until = 10", "until = -1", "output.until: -1 is not positive; write a number above 0"),
    (DRIVE, "until = 10", "until = 0", "output.until: 0 is not positive; write a number above 0"),
    (DRIVE, "until = 10", "until = 1e12", "output.until: 1000000000000 would cost at least 500000000000 intervals"),
    (DRIVE, "until = 10", "until = 1e300", "output.until: a number of about "),
    (BUILDING, "1e-8", "0", "output.tolerance: 0 is not between 0 and 1; write a tolerance such as 1e-10"),
    (BUILDING, "1e-8", "1", "output.tolerance: 1 is not between 0 and 1; write a tolerance such as 1e-10"),
    (
        DRIVE,
        "strain = [0.5]",
        "",
        "output: no positions",
    ),
    (DRIVE, "strain = [0.5]", "strain = []", "output: no positions"),
    (DRIVE, "[0.5]", "[0, 2.5]", "output.strain[1]: 2.5 is not on the chain; write a position from 0 to 2"),
    (DRIVE, "[0.5]", '["-1/2"]', "output.strain[0]: -1/2 is not on the chain; write a position from 0 to 2"),
    (DRIVE, "[0.5]", '["2.0001-"]', "output.strain[0]: 2.0001- is not on the chain; write a position from 0 to 2"),
    (DRIVE, "[0.5]", "[1]", 'output.strain[0]: 1 has two sides, of the body there; write "1-" or "1+"'),
    (BUILDING, "strain = [0.5]", "strain = [1.0]", '"1.0-" or "1.0+"'),
    (COLLISION, '["1-"]', '[2, "3"]', 'output.strain[1]: 3 has two sides, of the body there; write "3-" or "3+"'),
    (DRIVE, "[0.5]", '["1-+"]', 'output.strain[0]: "1-" is not a number'),
    (DRIVE, "[0.5]", '["-"]', 'output.strain[0]: "" is not a number'),
    (DRIVE, "[0.5]", '[0.5, "1/2"]', "output.strain[1]: 1/2 is the same place as 0.5"),
    (DRIVE, "[0.5]", '["1+", "1-", "1.0+"]', "output.strain[2]: 1.0+ is the same place as 1+"),
    (DRIVE, "[0.5]", '[0, "0+"]', "output.strain[1]: 0+ is the same place as 0"),
    (BUILDING, "[0.5, 2]", '["1-", "1+"]', "output.velocity[1]: 1+ is the same place as 1-"),
    # names
    *(
        (DRIVE, '"good"', f'"{name}"', f'name: "{name}" is a keyword of C, C++ or Python; write another name')
        for name in ("int", "lambda", "None", "bitor", "class", "restrict", "constexpr", "typeof", "co_await", "match")
    ),
    *(
        (DRIVE, '"good"', f'"{name}"', "name: ")
        for name in ("", "1st", "_x", "a-b", "a b", "n\u00e4me", "\uff41", "a\\n", "../x", "x" * 64)
    ),
    (DRIVE, '"good"', "1.5", "name: 1.5 is not an identifier"),
    (DRIVE, '"good"', "3", "name: 3 is not an identifier"),
    # not TOML, or not a scene
    (DRIVE, "[output]", "[output", "not TOML, "),
    (DRIVE, "until = 10", "until = 10\nuntil = 11", "not TOML, "),
    (DRIVE, "until = 10", "until = 10\nx = " + "9" * 5000, "an integer has more than 4300 digits; write fewer"),
    (DRIVE, "until = 10", "until = 10\nx = " + "[" * 100000, "tables or lists too deep in one another"),
    (DRIVE, DRIVE, "system = 3", "name: missing"),
    (DRIVE, DRIVE, 'name = "s"\nsystem = 3\noutput = 4', "system: 3 is not a table; write [system]"),
    (DRIVE, DRIVE, "# nothing\n", "name: missing"),
    (DRIVE, DRIVE, " \n", "empty; write a TOML file"),
]


@pytest.mark.parametrize(("good", "old", "new", "expected"), MISTAKES, ids=[m[3][:60] for m in MISTAKES])
def test_a_mistake_is_one_line(tmp_path: Path, good: str, old: str, new: str, expected: str) -> None:
    path = tmp_path / "scene.toml"
    assert good.count(old) >= 1
    path.write_text(good.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(SceneError) as refused:
        Scene.from_toml(path)
    lines = refused.value.lines
    assert all(line.isprintable() and line.startswith(f"{path}: ") for line in lines)
    messages = [line.removeprefix(f"{path}: ") for line in lines]
    assert any(message.startswith(expected) or (expected[0] == '"' and expected in message) for message in messages)
    assert all(len(message) < 300 for message in messages)


@pytest.mark.parametrize("good", [COLLISION, DRIVE, BUILDING])
def test_the_scenes_that_mistakes_are_made_in_are_right(tmp_path: Path, good: str) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(good)
    assert Scene.from_toml(path).name == "good"


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "empty; write a TOML file"),
        (b"\x7fELF\x02\x01\x01\x00\x00\xff\xfe", "byte 9 is not UTF-8; write a TOML file"),
        (b"\x00\x01\x02", "not TOML, "),
        ('name = "b\u00fccher"'.encode("latin-1"), "byte 9 is not UTF-8; write a TOML file"),
        (b'name = "half', "not TOML, "),
    ],
)
def test_a_file_that_is_no_text(tmp_path: Path, content: bytes, expected: str) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    with pytest.raises(SceneError) as refused:
        Scene.from_toml(path)
    assert str(refused.value).startswith(f"{path}: {expected}")
    assert str(refused.value).isprintable()


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"^nowhere.toml: No such file or directory"):
        Scene.from_toml("nowhere.toml")
    with pytest.raises(SceneError, match="Is a directory"):
        Scene.from_toml(tmp_path)
    with pytest.raises(SceneError, match="not a path; "):
        Scene.from_toml("a\0b")
    with pytest.raises(SceneError) as refused:
        Scene.from_toml("two\nlines")
    assert str(refused.value).startswith("two\\nlines: ")


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="no such device here")
def test_an_endless_file_is_refused() -> None:
    with pytest.raises(SceneError, match=r"^/dev/zero: larger than 16 MB"):
        Scene.from_toml("/dev/zero")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_named_pipe_is_refused_before_anybody_waits_for_a_writer(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link.toml").symlink_to("pipe")
    for path in (tmp_path / "pipe", tmp_path / "link.toml"):
        with pytest.raises(SceneError, match=f"^{re.escape(str(path))}: Is a named pipe, .*; write a TOML file, -"):
            Scene.from_toml(path)


@pytest.mark.skipif(not os.path.exists("/dev/fd"), reason="no names of open files here")
def test_a_pipe_that_is_open_is_read() -> None:
    """As a shell gives it in the place of <(...)."""
    out, into = os.pipe()
    try:
        os.write(into, DRIVE.encode())
        os.close(into)
        assert Scene.from_toml(f"/dev/fd/{out}").name == "good"
    finally:
        os.close(out)


def test_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(DRIVE.encode())))
    assert Scene.from_toml("-").name == "good"
    with pytest.raises(SceneError, match=r"^<stdin>: empty"):
        Scene.from_toml("-")
    monkeypatch.setattr(sys, "stdin", None)
    with pytest.raises(SceneError, match=r"^<stdin>: No standard input"):
        Scene.from_toml("-")


def test_from_python_the_file_is_the_scene() -> None:
    with pytest.raises(SceneError, match=r"^scene: name: missing; write an identifier of C\n"):
        Scene()
    with pytest.raises(SceneError, match=r"^scene: self: unknown key"):
        Scene(self=1)
    with pytest.raises(ValueError, match=r"^scene: system: a list is not a table; write \[system\]$"):
        Scene(name="s", system=[], output={"until": 1, "strain": [0]})


def test_the_error_keeps_its_parts_when_pickled() -> None:
    error = pickle.loads(pickle.dumps(SceneError("wrong", "a.b", "f.toml")))
    assert (str(error), error.file, error.path) == ("f.toml: a.b: wrong", "f.toml", "a.b")


def test_a_large_wrong_scene_is_refused_quickly() -> None:
    system = {"type": "building", "m": 2, "kappa": [1, 1, 1], "base": "ground"}
    began = time.process_time()
    with pytest.raises(SceneError, match=r"^scene: load\[0\]\.samples\[0\]: "):
        Scene(name="s", system=system, load=[{"spacing": 1, "samples": ["x"] * 10**6}], output={"until": 1})
    assert time.process_time() - began < 2


LARGE: dict[str, tuple[Callable[[int], str], str]] = {
    "dotted keys": (lambda _: ".".join("a" * 40_000) + " = 1", "line 1: a key of more than 10 parts"),
    "quoted keys": (lambda _: "x = 1\n" + " . ".join(['"a"'] * 20_000) + " = 1", "line 2: a key of more than 10 parts"),
    "dotted headers": (lambda _: "[" + ".".join("a" * 40_000) + "]", "line 1: a key of more than 10 parts"),
    "loads": (lambda n: "[[load]]\nbody = 1\n" * n, "more than 20000 tables"),
    "loads in a line": (lambda n: "load = [" + "{body = 1}," * n + "]", "more than 20000 tables"),
    "values": (lambda n: "[output]\nstrain = [" + "0," * 13 * n + "]", "more than 300000 values"),
    "keys": (lambda n: "".join(f"k{k} = 1\n" for k in range(50_000 + n)), "more than 60000 keys"),
    "lines of dotted keys": (lambda n: "".join(f"a.b.k{k} = 1\n" for k in range(n)), "more than 20000 tables"),
    "lines of quoted keys": (lambda n: "".join(f"'a' . \"b\".k{k} = 1\n" for k in range(n)), "more than 20000 tables"),
    "dotted keys in a line": (lambda n: "a = [" + "{b.c=1}," * n + "]", "more than 20000 tables"),
    "comments": (lambda n: "# a\n" * (1_000_000 + n), "more than 1000000 lines"),
    "quotes": (lambda n: '"\\' * 10 * n, "more than 100000 backslashes"),
    "a long word": (lambda n: "a" * 20 * n, "not TOML, "),
}


@pytest.mark.parametrize(("text", "message"), LARGE.values(), ids=LARGE)
def test_what_would_take_long_to_parse_is_refused_before(tmp_path, text, message, thorough):
    path = tmp_path / "large.toml"
    path.write_text(text(300_000 if thorough else 30_000))
    start = time.process_time()
    with pytest.raises(SceneError) as error:
        Scene.from_toml(path)
    assert time.process_time() - start < 2  # a minute, once
    assert str(error.value).startswith(f"{path}: {message}")
    assert "\n" not in str(error.value)


WIDE = {
    "keys": "".join(f"k{k} = 1\n" for k in range(50_000)),
    "dotted keys": "".join(f"a.b.c.d.e.f.g.h.i.k{k} = 1\n" for k in range(15_000)),
    "parts": "[system]\ntype = 'chain'\nparts = [" + "{rod = 1, foo = 2}," * 10_000 + "]",
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("text", WIDE.values(), ids=WIDE)
def test_as_much_as_is_parsed_is_refused_soon(text):
    """Each of many unknown keys was compared with those that are known, and parsed anew for its line."""
    start = time.process_time()
    with pytest.raises(SceneError, match="unknown key"):
        Scene.from_toml(text)
    assert time.process_time() - start < 4  # 13 s, once; one second where nothing else runs


@pytest.mark.slow
def test_as_many_positions_and_times_as_are_served_are_looked_at_and_no_more(monkeypatch):
    """250 000 positions took 100 s and 2.4 GB, 140 000 times 14 s until every program had refused them."""
    zeros = "[" + "0, " * 50_001 + "]"
    for table, message in {
        f"[output]\nuntil = 1\nstrain = {zeros}\n": "output: 50001 positions, the limit is 5000; write fewer",
        f"[[load]]\nbody = 3\ntimes = {zeros}\n": r"load\[0\].times: 50001 times, the limit is 50000; write",
    }.items():
        text = "".join(part for part in re.split(r"(?=^\[)", DRIVE, flags=re.M) if part.split("\n")[0] not in table)
        start = time.process_time()
        with pytest.raises(SceneError, match=message):
            Scene.from_toml(text + table)
        assert time.process_time() - start < 2
    load = {"body": 2, "times": [0, 1, 2], "steps": [1, 1, 1]}
    three = {"output.strain": [0, 1], "output.velocity": [0], "output.displacement": [], "load": [load]}
    scene = Scene.from_toml("drive_m1")
    monkeypatch.setattr(outputs, "MOST_OUTPUTS", 3)
    monkeypatch.setattr(timed_loads, "MOST_TIMES", 3)
    scene = scene.with_(three)
    with pytest.raises(SceneError, match="output: 4 positions, the limit is 3"):
        scene.with_({"output.displacement": [1]})
    with pytest.raises(SceneError, match="times: 4 times, the limit is 3"):
        scene.with_({"load": [{"body": 2, "times": [0, 1, 2, 3], "steps": [1, 1, 1, 1]}]})


def test_loads_are_numbered_in_one_go():
    """Each of 20 000 loads was counted among all, for 12 s."""
    loads = [SimpleNamespace(label=label) for label in ["step on a", "step on b", *["step on a"] * 50_000]]
    start = time.process_time()
    names = load_names(SimpleNamespace(load=loads))
    assert time.process_time() - start < 1
    assert names[:3] == ("step on a (1)", "step on b", "step on a (2)")
    assert names[-1] == "step on a (50001)"


def test_what_rubs_is_looked_for_once():
    """The friction of each of thousands of joints was looked for among all links, for 6 s."""
    points = [Point(fmpq(1))] * 20_000
    links = [Link(n, n + 1, fmpq(1), friction=fmpq(k == 0)) for k, n in enumerate(range(0, 20_000, 2))]
    start = time.process_time()
    refuse_joined_corners(points, links, {})
    assert time.process_time() - start < 2


def test_decimals_are_no_dotted_keys():
    """As many tables as may be are read, and numbers in them are none."""
    parts = ",".join("{rod = 0.5, impedance = 1.5}" for _ in range(15_000))
    assert len(parse_text("x", f"parts = [{parts}]")["parts"]) == 15_000


@pytest.mark.slow
def test_strings_and_comments_are_not_counted(tmp_path):
    """What looks like deep keys, tables and values there."""
    noise = "a.b.c.d.e.f.g.h.i.j.k.l [[{," * 40_000
    path = tmp_path / "noise.toml"
    path.write_text(DRIVE.replace('name = "good"', f"name = 'good' # {noise}"))
    assert Scene.from_toml(path).name == "good"
    for quoted in (f'"{noise}"', f"'{noise}'", f'"""\n{noise}"""', f"'''\n{noise}'''", f'"\\"{noise}"'):
        path.write_text(DRIVE.replace('"good"', quoted))
        with pytest.raises(SceneError, match=r"^[^ ]*: name: "):
            Scene.from_toml(path)


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ("height = 4,2\n", "numbers have a decimal point: write 4.2"),
        ("height = -4,25 m\n", "numbers have a decimal point: write -4.25"),
        ("parts = [{ rod = 4,2 }]\n", "numbers have a decimal point: write 4.2"),
        ("height = 4.2 m\n", 'a quantity has quotes: write "4.2 m"'),
        ("parts = [{ rod = 4.2 kN/m^2 }]\n", 'a quantity has quotes: write "4.2 kN/m^2"'),
        ('height = "4.2 m\nm = 2\n', 'a text begins and ends with a quote, on one line: write " at its end'),
        ("height = '4.2 m\nm = 2\n", 'a text begins and ends with a quote, on one line: write " at its end'),
        ('height = "4.2 m', 'a text begins and ends with a quote, on one line: write " at its end'),
    ],
)
def test_frequent_slips_in_toml_say_what_to_write(text: str, remedy: str) -> None:
    """And no other fault does: two words behind a number are none of them."""
    with pytest.raises(SceneError) as error:
        Scene.from_toml(text + "\n")
    assert str(error.value).startswith("scene: not TOML, ")
    assert str(error.value).endswith(f"; {remedy}")
    with pytest.raises(SceneError) as error:
        Scene.from_toml("a = 1 # 4,2\nb = 2 3\n")
    assert str(error.value).endswith("(at line 2, column 7)")
