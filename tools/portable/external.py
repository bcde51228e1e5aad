"""Programs of others that this room starts."""

from __future__ import annotations

import math
import os
import shutil
import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

_WAITS = 6.0
"""How many times as long as it may compute a program may be there: others use the machine, too."""


class CommandResult(NamedTuple):
    """How a program ended (None: stopped, since it took too long), and what it printed and complained of."""

    status: int | None
    output: str
    errors: str


def absent(*programs: str) -> list[str]:
    """Those that this machine has not."""
    return [program for program in programs if not shutil.which(program)]


def run_command(command: Sequence[str], folder: Path, seconds: float) -> CommandResult:
    """Run a command in a folder, for so many seconds of a processor at most: what else runs changes no answer."""
    limited = ["sh", "-c", 'ulimit -t "$0" && exec "$@"', str(math.ceil(seconds)), *command]
    stopped = CommandResult(None, "", f"{command[0]}: stopped after {seconds:g} s")
    try:
        done = subprocess.run(
            limited,
            cwd=folder,
            env=os.environ | {"PWD": os.fspath(folder)},  # which Frama-C believes
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
            timeout=_WAITS * seconds,
        )
    except subprocess.TimeoutExpired:
        return stopped
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return stopped
    return CommandResult(done.returncode, done.stdout, done.stderr)


def version(program: str) -> str:
    """What it says of itself, in one line."""
    done = subprocess.run([program, "--version"], capture_output=True, text=True, errors="replace", check=False)
    return next(iter(done.stdout.splitlines()), "of an unknown version").strip()
