"""C compilers: which there are on this machine, and which of them is used. Decided here and nowhere else."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

from wavesym.errors import WavesymError

_COMMON = ("cc", "gcc", "clang")
_PACKAGE = "ziglang"
"""A compiler that comes as a Python package: for machines that have no other."""


class CompilerError(WavesymError):
    """There is no C compiler, or it does not accept what it was given.

    >>> import wavesym
    >>> scene = wavesym.Scene.from_toml("drive_m1")
    >>> try:
    ...     model = wavesym.model(scene, ["kappa"])
    ... except wavesym.CompilerError:
    ...     model = None  # the extra `compiler` brings one
    """

    status: ClassVar[int] = 1


@dataclass(frozen=True)
class Compiler:
    """A C compiler: what it is called here, and the command that starts it."""

    name: str
    command: tuple[str, ...]

    @property
    def version(self) -> str:
        """What it says of itself, in one line."""
        output = subprocess.run([*self.command, "--version"], capture_output=True, text=True, check=False).stdout
        line = next(iter(output.splitlines()), "of an unknown version")
        return f"{_PACKAGE} {metadata.version(_PACKAGE)}, {line}" if self.name == _PACKAGE else line

    def run(self, arguments: Sequence[str], folder: Path) -> None:
        """Compile in a folder. CompilerError with its first complaint, where it has one."""
        command = [*self.command, *arguments]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", check=False)
        if done.returncode != 0:
            messages = done.stderr.splitlines()
            first = next((line for line in messages if "error" in line), messages[0] if messages else "no message")
            raise CompilerError(f"{self.name} does not accept the C: {first}")


def compiler() -> Compiler:
    """The compiler to use: the environment's CC; or else the first of cc, gcc, clang that there is; or else ziglang.

    CompilerError where there is none.
    """
    chosen = shlex.split(os.environ.get("CC", ""))
    if chosen:
        if not shutil.which(chosen[0]):
            raise CompilerError(f"no C compiler: {chosen[0]} not found, though the environment variable CC names it")
        return Compiler(chosen[0], tuple(chosen))
    for found in at_hand(_COMMON):
        return found
    raise CompilerError(
        f"no C compiler: {', '.join(_COMMON)} not found; install one of them, or name another in the environment "
        f"variable CC, or install one as a Python package: pip install {_PACKAGE} (the extra compiler of wavesym)"
    )


def at_hand(names: Sequence[str] = ("gcc", "clang")) -> list[Compiler]:
    """Those of `names` that are on the PATH, and the one that is a Python package, if it is installed."""
    found = [Compiler(name, (name,)) for name in names if shutil.which(name)]
    if find_spec(_PACKAGE):
        found.append(Compiler(_PACKAGE, (sys.executable, "-m", _PACKAGE, "cc")))
    return found
