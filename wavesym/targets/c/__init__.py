"""C99 that is C++ too: NAME.h, NAME.c and NAME_selftest.c."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from wavesym.errors import UnservedError
from wavesym.programs.program import Program, ReferenceValues, SteppedValues
from wavesym.targets.c.header import header
from wavesym.targets.c.selftest import selftest, stepped_selftest
from wavesym.targets.description import Description
from wavesym.targets.target import Target

# what a stream's bound of errors is for
_UNDER = {"spacing": "under the scene's loads", "panel": "under a step of each load at tau = 0"}

_PLAIN = ("closed", "pieces", "march")
"""Kinds of programs that declare no more in NAME.h than all do; each of the others is a file here."""


class CTarget:
    """C as a target."""

    has_selftest = True

    def files(self, description: Description, program: Program) -> dict[str, str]:
        if program.numpy_only:
            raise UnservedError(program.numpy_only)
        kernel: Any = import_module(f"{__name__}.{'plain' if program.kernel in _PLAIN else program.kernel}")
        if program.laws and (not program.step or program.has_equal_steps):
            files: dict[str, str] = kernel.files(description, program)
            return files
        name = description.name
        more = kernel.streaming(description, program) if program.step else ""
        made = {
            f"{name}.h": header(description, more, under=_UNDER.get(program.step, ""), bounded=program.laws is None),
            f"{name}.c": kernel.source(description, program),
        }
        match program.reference:
            case ReferenceValues():
                made[f"{name}_selftest.c"] = selftest(description, program, program.reference)
            case SteppedValues():
                made[f"{name}_selftest.c"] = stepped_selftest(description, program, program.reference)
        return made


TARGET: Target = CTarget()
