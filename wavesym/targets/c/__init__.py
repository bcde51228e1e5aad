"""C99 that is C++ too: NAME.h, NAME.c and NAME_selftest.c."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from wavesym.errors import UnservedError
from wavesym.programs.program import Program
from wavesym.targets.c.plain import header
from wavesym.targets.c.selftest import selftests
from wavesym.targets.description import Description

HAS_SELFTEST = True

_PLAIN = ("closed", "pieces", "march", "modes")
"""Kernels whose tables stand above plain C, in plain.py; each of the others is a file here."""


def files(description: Description, program: Program) -> dict[str, str]:
    """The sources of a program, by name. UnservedError for one that is NumPy alone."""
    if program.numpy_only:
        raise UnservedError(program.numpy_only)
    kernel: Any = import_module(f"{__name__}.{'plain' if program.kernel in _PLAIN else program.kernel}")
    if program.laws and (not program.step or program.has_equal_steps):
        made: dict[str, str] = kernel.files(description, program)
        return made
    name = description.name
    return {
        f"{name}.h": header(description, program, kernel.streaming(description, program) if program.step else ""),
        f"{name}.c": kernel.source(description, program),
        **selftests(description, program),
    }
