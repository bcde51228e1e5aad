"""An FMU: one file of sources, descriptions and what the C compiles to, for as many machines as compilers know.

The zig compiler, which comes as the Python package ziglang, links for all of them, on Linux for any glibc from 2.17 on.
Without it the machine's own compiler does for that machine.
"""

from __future__ import annotations

import io
import json
import platform
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

from wavesym.programs.program import Program
from wavesym.running.toolchain import Compiler, at_hand, compiler
from wavesym.targets.files import fmu_files

_FLAGS = ("-std=c99", "-O2", "-shared", "-fvisibility=hidden")
_FIRST = "modelDescription.xml"


@dataclass(frozen=True)
class Machine:
    """One that binaries are for: its folder in FMI 2 and in FMI 3, how libraries end, and zig's name for it."""

    fmi2: str
    fmi3: str
    suffix: str
    zig: str

    def folder(self, version: str) -> str:
        """Where its binaries are in an FMU."""
        return self.fmi2 if version == "fmu2" else self.fmi3


MACHINES = (
    Machine("linux64", "x86_64-linux", ".so", "x86_64-linux-gnu.2.17"),
    Machine("aarch64-linux", "aarch64-linux", ".so", "aarch64-linux-gnu.2.17"),
    Machine("win64", "x86_64-windows", ".dll", "x86_64-windows-gnu"),
)
_OWN = Machine("darwin64", f"{platform.machine()}-darwin", ".dylib", "")  # what else a host may be


def fmu(program: Program, version: str) -> bytes:
    """The file's bytes, times in it fixed. CompilerError where there is no compiler at all."""
    texts = fmu_files(program, version)
    name = program.provenance.model.name
    content: dict[str, bytes] = {place: text.encode() for place, text in texts.items()}
    with TemporaryDirectory() as made:
        folder = Path(made)
        for place, text in texts.items():
            if place.startswith("sources/"):
                (folder / Path(place).name).write_text(text, encoding="utf-8", newline="\n")
        for machine, built_by, flags in _builds():
            library = f"{name}{machine.suffix}"
            built_by.run([*_FLAGS, *flags, f"fmi{version[-1]}.c", f"{name}.c", "-o", library], folder)
            content[f"binaries/{machine.folder(version)}/{library}"] = (folder / library).read_bytes()
    return _pack(content)


def describe_fmu(path: Path) -> list[str]:
    """What to know of an FMU: for which machines it has binaries, what would make more, why this stream, and by how
    much it may miss the tolerance.
    """
    with ZipFile(path) as archive:
        machines = [place.split("/")[1] for place in archive.namelist() if place.startswith("binaries/")]
        manifest = json.loads(archive.read(f"resources/{path.stem}.json"))
    more = "" if len(machines) == len(MACHINES) else "; pip install ziglang helps to have linux64, aarch64 and win64"
    return [
        f"binaries for {', '.join(machines)}{more}",
        *(manifest[key] for key in ("reason", "shortfall") if key in manifest),
    ]


def _builds() -> Iterator[tuple[Machine, Compiler, tuple[str, ...]]]:
    for zig in at_hand(()):
        for machine in MACHINES:
            position = () if machine.suffix == ".dll" else ("-fPIC", "-lm")
            yield machine, zig, ("-target", machine.zig, "-fno-sanitize=undefined", "-s", *position)
        return
    position = () if sys.platform == "win32" else ("-fPIC", "-lm")
    yield _host(), compiler(), position


def _host() -> Machine:
    """The machine that this runs on."""
    name = {"AMD64": "x86_64", "arm64": "aarch64", "ARM64": "aarch64"}.get(platform.machine(), platform.machine())
    system = {"win32": "windows", "darwin": "darwin"}.get(sys.platform, "linux")
    known = {machine.fmi3: machine for machine in MACHINES}
    other = _OWN if system == "darwin" else Machine(f"{name}-{system}", f"{name}-{system}", ".so", "")
    return known.get(f"{name}-{system}", other)


def _pack(content: Mapping[str, bytes]) -> bytes:
    """As a zip file. The description comes first and as it stands: by its first lines it is known who made the file."""
    file = io.BytesIO()
    with ZipFile(file, "w") as archive:
        for place in sorted(content, key=lambda place: (place != _FIRST, place)):
            entry = ZipInfo(place, (1980, 1, 1, 0, 0, 0))
            entry.create_system, entry.external_attr = 3, 0o644 << 16
            entry.compress_type = ZIP_STORED if place == _FIRST else ZIP_DEFLATED
            archive.writestr(entry, content[place])
    return file.getvalue()
