"""The files of a program, in the languages asked for, and the manifest.

Only this file talks to the folders of languages: a new one is a folder beside it, and a name in __init__.py.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

from wavesym.errors import WavesymError
from wavesym.programs.program import Program
from wavesym.targets import TARGETS
from wavesym.targets.description import describe
from wavesym.targets.manifest import manifest

_C_HEADERS = """assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg
stdatomic stdbit stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar
wctype"""
MARKS = (b": made by wavesym", b'"generator": "wavesym"')


def is_ours(path: Path) -> bool:
    """Whether a file says in its first lines that wavesym wrote it."""
    with path.open("rb") as file:
        start = file.read(1000)
    return any(mark in start for mark in MARKS)


def files(program: Program, language: str = "c", *, packaged: bool = False) -> dict[str, str]:
    """What `generate` writes of a program, by file name: sources in a language, or in "all", and the manifest.

    `packaged` C comes with what builds, tests and installs it.
    """
    description = describe(program)
    made = {f"{description.name}.json": manifest(description, program)}
    for name in TARGETS if language == "all" else (language,):
        made |= _target(name).files(description, program)
    if packaged:
        from wavesym.targets.package import package

        made |= package(description, program)
    return dict(sorted(made.items()))


def refuse_shadows(name: str, language: str) -> None:
    """WavesymError for a name whose files would take the place of a module of Python, or of a header of C."""
    if language in ("numpy", "all") and name in sys.stdlib_module_names:
        what = f"{name}.py, which would take the place of a module of Python's own"
    elif language in ("c", "all") and name.lower() in _C_HEADERS.split():  # some file systems do not tell capitals
        what = f"{name}.h, which would take the place of <{name.lower()}.h>"
    else:
        return
    raise WavesymError(f'name: "{name}" makes {what}; write another name, such as "{name}_scene"')


def sources(program: Program, language: str) -> dict[str, str]:
    """The sources alone."""
    made: dict[str, str] = _target(language).files(describe(program), program)
    return made


def runtime_sets(program: Program, parts: tuple[str, ...]) -> dict[str, str]:
    """The C of a program whose parameters come at run time, for many sets of them in one call: these parts of it."""
    kernel = import_module(f"wavesym.targets.c.{program.kernel}")
    made: dict[str, str] = kernel.sets(describe(program), replace(program, parts=parts))
    return made


def fmu_files(program: Program, version: str) -> dict[str, str]:
    """What is text in the file of a stream for simulators, by its place there; the manifest too."""
    description = describe(program)
    made: dict[str, str] = _target("fmu").fmu_files(description, program, version)
    return made | {f"resources/{description.name}.json": manifest(description, program)}


def has_selftest(language: str) -> bool:
    """Whether a self-test is among the files of a language, or of "all"."""
    return any(_target(name).HAS_SELFTEST for name in (TARGETS if language == "all" else (language,)))


def _target(name: str) -> Any:
    """A language: a module with `files` of a description and a program, and whether a self-test is among them."""
    return import_module(f"wavesym.targets.{name}")
