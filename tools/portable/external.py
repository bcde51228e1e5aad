"""Programs of others that this room starts."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple


class CommandResult(NamedTuple):
    """How a program ended (None: stopped, since it took too long), and what it printed and complained of."""

    status: int | None
    output: str
    errors: str


def absent(*programs: str) -> list[str]:
    """Those that this machine has not."""
    return [program for program in programs if not shutil.which(program)]


def run_command(command: Sequence[str], folder: Path, seconds: float) -> CommandResult:
    """Run a command in a folder, for so long at most."""
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env=os.environ | {"PWD": os.fspath(folder)},  # which Frama-C believes
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
            timeout=seconds,
        )
    except subprocess.TimeoutExpired:
        return CommandResult(None, "", f"{command[0]}: stopped after {seconds:g} s")
    return CommandResult(done.returncode, done.stdout, done.stderr)


def version(program: str) -> str:
    """What it says of itself, in one line."""
    done = subprocess.run([program, "--version"], capture_output=True, text=True, errors="replace", check=False)
    return next(iter(done.stdout.splitlines()), "of an unknown version").strip()
