"""Which C compiler is used, on machines that have all kinds, only the Python package, or none."""

import os
import shutil
import subprocess
import sys

import pytest

from tests.support.builds import needs_zig
from wavesym.cli import main
from wavesym.running import toolchain
from wavesym.running.native import library
from wavesym.running.toolchain import CompilerError, at_hand, compiler


@pytest.fixture
def bare(monkeypatch, tmp_path):
    """A machine with nothing on its PATH."""
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", os.fspath(tmp_path))
    return tmp_path


@pytest.fixture
def no_package(monkeypatch):
    monkeypatch.setattr(toolchain, "find_spec", lambda name: None)


def test_the_compiler_is_the_users_choice(monkeypatch, tmp_path):
    chosen = tmp_path / "mycc"
    chosen.symlink_to(shutil.which(compiler().command[0]))
    monkeypatch.setenv("CC", f"{chosen} -g")
    assert compiler().command == (str(chosen), "-g")
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(CompilerError, match="no-such-compiler not found"):
        compiler()


def test_the_first_on_the_path_is_taken(bare):
    for name in ("clang", "gcc", "cc"):
        made = bare / name
        made.write_text(f"#!/bin/sh\necho {name} 1.2.3\n")
        made.chmod(0o755)
        assert compiler().command == (name,)
        assert compiler().version == f"{name} 1.2.3"


@needs_zig
def test_without_any_the_python_package_is_taken(bare):
    chosen = compiler()
    assert chosen.command == (sys.executable, "-m", "ziglang", "cc")
    assert chosen.version.startswith("ziglang 0.")
    assert "clang" in chosen.version


@pytest.mark.slow
@needs_zig
def test_it_is_all_that_verify_needs(bare, capsys):
    assert main(["verify", "drive_m1", "--evaluator", "closed"]) == 0
    assert f"The C compiler is {compiler().version}." in capsys.readouterr().out.splitlines()


def test_a_compiler_that_refuses_is_quoted():
    compiler()
    with pytest.raises(CompilerError, match="error") as error:
        library("int f( { return 0; }")
    assert "\n" not in str(error.value)


def test_no_compiler_is_said_in_one_line(bare, no_package, capsys):
    with pytest.raises(CompilerError, match=r"cc, gcc, clang not found.*pip install ziglang"):
        compiler()
    assert main(["verify", "drive_m1", "--stream"]) == 1
    out, told = capsys.readouterr()
    assert out.splitlines()[1].startswith("C was not tried: no C compiler: cc, gcc, clang not found")
    assert told == ""


@pytest.mark.parametrize("each", at_hand(), ids=lambda each: each.name)
def test_every_compiler_at_hand_makes_programs(each, tmp_path):
    (tmp_path / "seven.c").write_text("int main(void) { return 7; }\n")
    each.run(["-std=c99", "-O2", "seven.c", "-o", "seven"], tmp_path)
    assert subprocess.run([tmp_path / "seven"], check=False).returncode == 7
