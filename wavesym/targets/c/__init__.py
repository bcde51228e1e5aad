"""C99 that is C++ too: NAME.h, NAME.c and NAME_selftest.c."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from wavesym.errors import UnservedError
from wavesym.programs.program import Program, ReferenceValues, SteppedValues, StreamedValues
from wavesym.targets.c.header import header
from wavesym.targets.c.selftest import selftest
from wavesym.targets.description import Description
from wavesym.targets.target import Target

_STREAMING = ("modes", "stream")

# what a stream's bound of errors is for
_UNDER = {"modes": "under the scene's loads", "stream": "under a step of each load at tau = 0"}


class CTarget:
    """C as a target."""

    tested = True

    def files(self, description: Description, program: Program) -> dict[str, str]:
        if program.numpy_only:
            raise UnservedError(program.numpy_only)
        kind: Any = import_module(f"{__name__}.{program.kind}")  # of the kinds that there are only this one
        if program.laws and program.kind == "runtime":
            files: dict[str, str] = kind.files(description, program)
            return files
        name = description.name
        more = kind.streaming(description, program) if program.kind in _STREAMING else ""
        made = {
            f"{name}.h": header(description, more, under=_UNDER.get(program.kind, ""), bounded=program.laws is None),
            f"{name}.c": kind.source(description, program),
        }
        match program.reference:
            case ReferenceValues():
                made[f"{name}_selftest.c"] = selftest(description, program, program.reference)
            case StreamedValues() | SteppedValues():
                made[f"{name}_selftest.c"] = kind.selftest(description, program, program.reference)
        return made


TARGET: Target = CTarget()
