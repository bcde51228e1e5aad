"""Completion in the shell, by the protocol that the shells speak with the program."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete

from wavesym.cli import COMMANDS, cli, main
from wavesym.scene import builtin_names


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for file in ("mine.toml", "[1].toml", "notes.txt", "scenes/drive_long.toml"):
        Path(file).parent.mkdir(exist_ok=True)
        Path(file).touch()


def completed(*words: str) -> dict[str, str]:
    """What the last, unfinished word may become, and as what: plain text, or a file or dir that the shell completes."""
    found = ShellComplete(cli, {}, "wavesym", "_WAVESYM_COMPLETE").get_completions(list(words[:-1]), words[-1])
    return {item.value: item.type for item in found}


def plain(*words: str) -> list[str]:
    return [value for value, kind in completed(*words).items() if kind == "plain"]


def test_commands_and_options() -> None:
    assert plain("") == list(COMMANDS)
    assert plain("st") == ["stability"]
    assert plain("run", "--s") == ["--samples"]
    assert plain("generate", "--evaluator", "") == ["auto", "closed", "pieces", "march", "modes"]
    assert completed("plot", "mine.toml", "-o", "out") == {"out": "file"}


@pytest.mark.parametrize("command", ["tables", "generate", "run", "verify", "plot", "chart", "derive"])
def test_scenes(command: str) -> None:
    systems = ["collision", "drive", "building"] if command == "derive" else []
    assert plain(command, "") == [*builtin_names(), "[1].toml", "mine.toml", *systems]
    assert plain(command, "drive_") == ["drive_equal", "drive_m1"]
    assert plain(command, "scenes/dr") == ["scenes/drive_long.toml"]
    assert plain(command, "[") == ["[1].toml"]
    assert plain(command, "nothing") == []
    assert next(iter(completed(command, "sc").items())) == ("sc", "dir")  # bash forgets what comes before one


def test_verify_takes_more_than_one() -> None:
    assert plain("verify", "drive_m1", "mi") == ["mine.toml"]


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_the_program_gives_each_shell_its_functions(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    assert f"_WAVESYM_COMPLETE={shell}_complete" in capsys.readouterr().out


def test_in_bash() -> None:
    script = """
        eval "$(wavesym completion bash)"
        compopt() { :; }  # which bash allows only while someone types
        COMP_WORDS=(wavesym run mi); COMP_CWORD=2
        _wavesym_completion wavesym
        complete -p wavesym
        echo "${COMPREPLY[@]}"
    """
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    done = subprocess.run(
        ["bash", "-c", script], env=os.environ | {"PATH": path}, capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines() == ["complete -o nosort -F _wavesym_completion wavesym", "mine.toml"]
    assert done.stderr == ""
