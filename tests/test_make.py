"""The Makefile: each target installs what it needs and no more, and `make demo` tells what to do next."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.test_documents import ROOT, assert_spelt

MAKE = shutil.which("make")
pytestmark = pytest.mark.skipif(MAKE is None, reason="no make here")


@pytest.fixture
def fresh(tmp_path: Path) -> Path:
    """The files that an installation depends on, and nothing installed."""
    for name in ("Makefile", "pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, tmp_path)
    return tmp_path


def commands(folder: Path, target: str, programs: tuple[str, ...] = ()) -> str:
    """What make would run on a machine that has these programs."""
    there = folder / "bin"
    there.mkdir(exist_ok=True)
    for program in programs:
        (there / program).write_text("#!/bin/sh\n")
        (there / program).chmod(0o755)
    assert MAKE
    done = subprocess.run(
        [MAKE, "--dry-run", target], cwd=folder, env={"PATH": str(there)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def extras(text: str) -> list[str]:
    """What of the project is installed, in order; every time with the versions that are known to work."""
    installs = [line for line in text.splitlines() if " pip install " in line]
    assert all(" -c constraints.txt " in line and " --quiet " in line for line in installs)
    return [found for line in installs for found in re.findall(r"'\.\[(.*)\]'", line)]


@pytest.mark.parametrize("compiler", ["cc", "gcc", "clang"])
def test_a_machine_with_a_compiler_gets_none(compiler: str, fresh: Path) -> None:
    for target in ("install", "demo", "generated", "bench"):
        assert extras(commands(fresh, target, (compiler,))) == ["plot"]


def test_a_machine_without_a_compiler_gets_one(fresh: Path) -> None:
    assert extras(commands(fresh, "install")) == ["plot,compiler"]


@pytest.mark.parametrize(
    ("target", "added"),
    [("test", ["test"]), ("lint", ["lint"]), ("check-all", ["lint", "test", "check"]), ("mutants", ["test"])],
)
def test_tests_and_linters_add_what_they_need(target: str, added: list[str], fresh: Path) -> None:
    assert extras(commands(fresh, target, ("cc",))) == ["plot", *added]


def test_nothing_is_installed_twice(fresh: Path) -> None:
    (fresh / ".venv").mkdir()
    for name in (".installed", ".test", ".lint", ".check"):
        (fresh / ".venv" / name).touch()
    for target in ("install", "test", "lint", "check-all"):
        assert extras(commands(fresh, target)) == []


def test_the_demo_prints_what_matters_in_15_lines(fresh: Path) -> None:
    printed = commands(fresh, "demo", ("cc",))
    examples = re.findall(r"for scene in (.*); do", printed)[0].split()
    lines = len(re.findall(r"^echo '", printed, re.MULTILINE)) + len(examples)
    assert 10 < lines <= 15
    assert "wavesym verify $scene -o" in printed, "what is printed for an example is read from all that was compared"


def test_the_demo_ends_with_what_to_do_next(fresh: Path) -> None:
    _, next_steps = commands(fresh, "demo", ("cc",)).split("What to do next")
    steps = re.findall(r"echo '   (.*?)  ", next_steps)
    assert len(steps) == 4
    for step in steps:
        program, *rest = shlex.split(step)
        if rest:
            assert_spelt([program.removeprefix(".venv/bin/"), *rest])
        else:
            assert (ROOT / program).is_file()
