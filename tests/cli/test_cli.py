"""The command line: exit statuses, one line for a wrong request, nothing left behind.

What is computed is tested elsewhere; here a stand-in takes the compiler's place where only the command matters.
"""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from flint import fmpq

import wavesym
from wavesym import api
from wavesym.cli import COMMANDS, GROUPS, main
from wavesym.errors import CostError, ToleranceError, install_command
from wavesym.programs.request import Request
from wavesym.scene import builtin_names

SCENE = """name = "mine"
[system]
type = "drive"
m = 1
kappa = [1]
inertia = [1, 2]
[output]
until = 2
strain = [0.5]
"""


class Door(SimpleNamespace):
    """Stands in for `wavesym.api`; keeps what it was asked for."""

    def __init__(self) -> None:
        super().__init__(asked=[], difference="", allowed=True)

    def write(self, scene: object, directory: Path | None, request: Request, *, force: bool) -> tuple[Path, ...]:
        self.asked.append((directory, request, force))
        return (Path("out/mine.c"), Path("out/mine.h"))

    def check(self, scene: object, *options: object) -> str:
        self.asked.append(options)
        return self.difference

    def scene_notes(self, scene: object, *, values: bool = True, step: object = None) -> list[str]:
        return ["a contact opens"]

    def run_csv(self, scene: object, samples: int, at: list[float] | None, tell: Callable[[str], object]) -> list[str]:
        self.asked.append((samples, at))
        tell("a contact opens")
        return ["tau,strain@0.5\n", "0.0,0.0\n"]

    def plot_with_notes(self, scene: object, path: Path, kind: str) -> tuple[None, list[str]]:
        self.asked.append(path)
        return None, ["1 of 2 outputs is drawn"]

    def verify(self, scenes: list[wavesym.Scene], *options: object, stream: bool) -> tuple[str, bool]:
        self.asked.append([scene.name for scene in scenes])
        if any(options) or stream:
            self.asked.append((*options, stream))
        return "errors", self.allowed


@pytest.fixture
def door(monkeypatch: pytest.MonkeyPatch) -> Door:
    stand_in = Door()
    for name in ("write", "check", "scene_notes", "run_csv", "plot_with_notes", "verify"):
        monkeypatch.setattr(api, name, lambda *given, name=name, **named: getattr(stand_in, name)(*given, **named))
    return stand_in


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in ("mine", "lab"):
        Path(f"{name}.toml").write_text(SCENE)
    return tmp_path


def refused(capsys: pytest.CaptureFixture[str], *arguments: str, status: int = 2) -> str:
    """The one line that a request is refused with; nothing is printed or written."""
    before = sorted(Path().rglob("*"))
    assert main(arguments) == status
    out, line = capsys.readouterr()
    assert out == ""
    assert line.count("\n") == 1
    assert line.endswith("\n")
    assert sorted(Path().rglob("*")) == before
    return line[:-1]


def test_help_and_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"wavesym {wavesym.__version__}\n"
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    assert all(f"  {command} " in text for command in COMMANDS)
    assert all(f"\n{group}:\n" in text for group in GROUPS)
    assert max(map(len, text.splitlines())) <= 80
    assert "..." not in text.partition("Commands")[2]
    for same in ([], ["-h"]):
        assert main(same) == 0
        assert capsys.readouterr().out == text
    assert main(["run", "-h"]) == 0


def example(command: str, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """The arguments of the example in a command's help; tests/test_documents.py runs them."""
    assert main([command, "--help"]) == 0
    (line,) = [line.split() for line in capsys.readouterr().out.splitlines() if line.startswith("    wavesym ")]
    assert line[1] == command
    return line[1:]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_an_example(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert example(command, capsys)


def test_scenes_lists_what_is_built_in(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == list(builtin_names())


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["bogus"], "wavesym: No such command 'bogus'."),
        (["--bogus"], "wavesym: No such option"),
        (["run"], "wavesym run: Missing argument 'SCENE'."),
        (["run", "mine.toml", "more"], "wavesym run: Got unexpected extra argument"),
        (["run", "mine.toml", "--samples", "0"], "wavesym run: Invalid value for '--samples': 0 is not in the range"),
        (["run", "mine.toml", "--samples", "1e3"], "wavesym run: Invalid value for '--samples'"),
        (["run", "mine.toml", "--samples", "10000001"], "wavesym run: Invalid value for '--samples'"),
        (
            ["run", "mine.toml", "--samples", "3", "--at", "x"],
            "wavesym run: --samples and --at exclude each other; write one of them",
        ),
        (["tables", "mine.toml", "--intervals", "0"], "wavesym tables: Invalid value for '--intervals'"),
        (
            ["tables", "mine.toml", "--format", "xml"],
            "wavesym tables: Invalid value for '--format': 'xml' is not one of",
        ),
        (["generate", "mine.toml", "--language", "ada"], "wavesym generate: Invalid value for '--language'"),
        (["plot", "mine.toml"], "wavesym plot: Missing option '-o'"),
        (["plot", "-o", "x.svg"], "wavesym plot: Missing argument 'SCENE'"),
        (
            ["plot", "mine.toml", "--published", "-o", "x"],
            "wavesym plot: SCENE and --published exclude each other; write one of them",
        ),
        (["derive", "train"], "wavesym derive: Invalid value for '{collision|drive|building}'"),
        (["derive", "drive", "--m", "x"], "wavesym derive: Invalid value for '--m'"),
        (["derive", "drive", "--m", "0"], "wavesym derive: --m: 0 is not supported; write 1 ... 100"),
    ],
)
def test_wrong_usage(arguments: list[str], expected: str, door: Door, capsys: pytest.CaptureFixture[str]) -> None:
    line = refused(capsys, *arguments)
    assert line.startswith(expected)
    assert line.endswith(" --help)")


@pytest.mark.parametrize("command", ["inspect", "tables", "generate", "run", "verify", "plot"])
def test_a_wrong_scene_is_refused_by_every_command(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("bad.toml").write_text(SCENE.replace("[1, 2]", "[1]"))
    more = ["-o", "mine.svg"] if command == "plot" else []
    expected = "bad.toml: system.inertia: 1 numbers; write 2 (m + 1) (line 6)"
    assert refused(capsys, command, "bad.toml", *more) == expected
    assert refused(capsys, command, "nowhere.toml", *more).startswith("nowhere.toml: No such file or directory")
    assert refused(capsys, command, ".", *more).startswith(".: Is a directory")


def test_generate(door: Door, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", "mine.toml"]) == 0
    assert main(["generate", "mine.toml", "-o", "there", "--language", "all", "--evaluator", "closed"]) == 0
    assert main(["generate", "mine.toml", "--stream", "--step", "1/8", "--package"]) == 0
    assert door.asked == [
        (None, Request(), False),
        (Path("there"), Request("closed", language="all"), False),
        (None, Request(stream=True, step=fmpq(1, 8), package=True), False),
    ]
    assert capsys.readouterr().out.split() == [str(Path("out/mine.c")), str(Path("out/mine.h"))] * 3


def test_generate_check(door: Door, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", "mine.toml", "--check"]) == 0
    assert capsys.readouterr().out == ""
    door.difference = "- old\n+ new\n"
    assert main(["generate", "mine.toml", "--check"]) == 1
    assert capsys.readouterr().out == "- old\n+ new\n"


def test_verify(door: Door, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify"]) == 0
    assert main(["verify", "mine.toml", "drive_m1"]) == 0
    door.allowed = False
    assert main(["verify", "mine.toml"]) == 1
    assert door.asked == [list(builtin_names()), ["mine", "drive_m1"], ["mine"]]
    assert capsys.readouterr() == ("errors\n" * 3, "")
    order = ["verify", "mine.toml", "--evaluator", "march", "--precision", "single", "--runtime", "kappa", "--stream"]
    assert main(order) == 1
    assert door.asked[-2:] == [["mine"], ("march", "single", ("kappa",), True)]


def test_run_puts_values_out_and_warnings_aside(door: Door, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "mine.toml"]) == 0
    assert capsys.readouterr() == ("tau,strain@0.5\n0.0,0.0\n", "mine: a contact opens\n")
    assert main(["run", "mine.toml", "--samples", "7", "-o", "out.csv"]) == 0
    assert capsys.readouterr().out == ""
    assert Path("out.csv").read_bytes() == b"tau,strain@0.5\n0.0,0.0\n"
    assert door.asked == [(1001, None), (7, None)]


def test_plot_says_aside_what_its_picture_leaves_out(door: Door, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plot", "mine.toml", "-o", "mine.svg"]) == 0
    assert door.asked == [Path("mine.svg")]
    assert capsys.readouterr() == ("", "mine: a contact opens\nmine: 1 of 2 outputs is drawn\n")


def test_plot_of_another_kind_of_file(capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(capsys, "plot", "mine.toml", "-o", "mine.txt").endswith("write a name that ends in .svg, .png, .pdf")


def test_plot_without_matplotlib(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("wavesym.cli.parameters.find_spec", lambda name: None)
    assert f"matplotlib is not installed: {install_command('plot')}" in refused(
        capsys, "plot", "mine.toml", "-o", "mine.svg"
    )


def test_run_at_given_times(door: Door) -> None:
    Path("at.txt").write_bytes(b"# times\r\n0\r\n\r\n 0.1 # a tenth\n-1e-3\n+2.50\n")
    assert main(["run", "mine.toml", "--at", "at.txt"]) == 0
    assert door.asked == [(1001, [0.0, 0.1, -0.001, 2.5])]


@pytest.mark.parametrize("wrong", ["nan", "1e400", "1/2", "0x1p3", "1 2", "1,5", "1_0", "__import__('os')", "\u0661"])
def test_run_at_what_is_no_time(wrong: str, door: Door, capsys: pytest.CaptureFixture[str]) -> None:
    Path("at.txt").write_text(f"0\n{wrong}\n", encoding="utf-8")
    line = refused(capsys, "run", "mine.toml", "--at", "at.txt", "-o", "out.csv")
    assert line.startswith("at.txt: line 2: ")
    assert line.endswith(" is not a number; write one such as 0.25")


def test_where_nothing_can_be_written(door: Door, capsys: pytest.CaptureFixture[str]) -> None:
    Path("folder").mkdir()
    door.run_csv = lambda *_: []
    assert refused(capsys, "run", "mine.toml", "-o", "folder") == "folder: Is a directory; write the path of a file"
    assert refused(capsys, "run", "mine.toml", "-o", "mine.toml/out.csv") == "mine.toml/out.csv: Not a directory"
    Path("loop").symlink_to("loop")
    assert refused(capsys, "run", "mine.toml", "-o", "loop") == f"loop: {os.strerror(errno.ELOOP)}"


def test_a_full_disk(door: Door, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    Path("folder").mkdir()
    door.run_csv = lambda *_: []
    assert refused(capsys, "run", "mine.toml", "-o", "folder/out.csv") == "folder/out.csv: No space left on device"


def test_errors_of_the_compiler(door: Door, capsys: pytest.CaptureFixture[str]) -> None:
    def failing(error: Exception) -> object:
        def generate(*_: object, **named: object) -> None:
            raise error

        return generate

    door.write = failing(ToleranceError("11 digits are lost\nfrom tau = 9 on"))
    assert refused(capsys, "generate", "mine.toml", status=1) == "mine.toml: 11 digits are lost from tau = 9 on"
    door.write = failing(CostError("1e12 intervals"))
    assert refused(capsys, "generate", "mine.toml") == "mine.toml: 1e12 intervals"
    door.write = failing(KeyboardInterrupt())  # type: ignore[arg-type]
    assert main(["generate", "mine.toml"]) == 130


def process(*arguments: str, stdin: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    return subprocess.run([sys.executable, "-m", "wavesym", *arguments], input=stdin, capture_output=True, check=False)


def test_as_a_process() -> None:
    done = process("run", "-", stdin=SCENE.replace("until = 2", "until = -2").encode())
    assert done.returncode == 2
    assert done.stderr.decode().splitlines() == [
        "<stdin>: output.until: -2 is not positive; write a number above 0 (line 8)"
    ]
    assert done.stdout == b""
    assert process("run", "-", stdin=b"\xff\xfe").stderr.count(b"\n") == 1


@pytest.mark.skipif(os.name == "nt", reason="pipes break differently there")
def test_a_reader_that_stops_is_met_in_silence() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "wavesym", "scenes"], stdout=writing, stderr=subprocess.PIPE, check=False
        )
    finally:
        os.close(writing)
    assert done.stderr == b""
    assert done.returncode == 1
