"""What quick runs compile, kept from run to run: the same C, arguments, compiler and processor make the same file."""

from __future__ import annotations

import os
import platform
import shutil
import time
from collections.abc import Callable, Sequence
from hashlib import sha256
from pathlib import Path

from wavesym.running.toolchain import Compiler

_KEPT = 3 * 86_400.0  # seconds since a file was last of use
_CPUINFO = Path("/proc/cpuinfo")


class KeptBuilds:
    """A folder of files that `compiler` made, shared by the workers of a run. What others compile is not kept."""

    def __init__(self, folder: Path, compiler: Compiler) -> None:
        self.folder, self.compiler = folder, compiler
        self.program = _program(compiler)
        lines = _CPUINFO.read_text(encoding="utf-8").splitlines() if _CPUINFO.exists() else [platform.processor()]
        processor = next((line for line in lines if line.startswith(("flags", "Features"))), lines[0])
        self.identity = repr((compiler.command, self.program, compiler.version, platform.machine(), processor))
        for file in folder.iterdir():
            if time.time() - file.stat().st_mtime > _KEPT:
                file.unlink(missing_ok=True)

    def run(
        self, run: Callable[[Compiler, Sequence[str], Path], None], by: Compiler, arguments: Sequence[str], folder: Path
    ) -> None:
        """Make the file after -o: copy it where it is kept, otherwise compile it by `run`.

        All files of the folder count as read. What reads or writes elsewhere, or writes anything else, is not kept.
        """
        outside = any("/" in argument for argument in arguments)
        if "-o" not in arguments or outside or by != self.compiler or _program(by) != self.program:
            run(by, arguments, folder)
            return
        made = folder / arguments[list(arguments).index("-o") + 1]
        made.unlink(missing_ok=True)  # a library that is loaded keeps its pages
        before = _files(folder)
        key = sha256(repr((self.identity, list(arguments))).encode())
        for file in before:
            key.update(repr((os.fspath(file.relative_to(folder)), file.stat().st_size)).encode())
            key.update(file.read_bytes())
        kept = self.folder / key.hexdigest()
        if kept.exists():
            shutil.copy(kept, made)
            os.utime(kept)
            return
        run(by, arguments, folder)
        if set(_files(folder)) == {*before, made}:
            ours = kept.with_suffix(f".{os.getpid()}")
            shutil.copy(made, ours)
            ours.replace(kept)


def _program(compiler: Compiler) -> str:
    found = shutil.which(compiler.command[0])
    return os.path.realpath(found) if found else ""


def _files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())
