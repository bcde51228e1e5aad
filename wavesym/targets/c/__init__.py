"""C99 that is C++ too: NAME.h, NAME.c and NAME_selftest.c."""

from __future__ import annotations

from wavesym.programs.program import Program, ReferenceValues, StreamedValues
from wavesym.targets.c import closed, joints, march, modes, pieces, rings, runtime
from wavesym.targets.c.header import header
from wavesym.targets.c.selftest import selftest
from wavesym.targets.description import Description
from wavesym.targets.target import Target

_SOURCES = {
    "closed": closed.source,
    "pieces": pieces.source,
    "march": march.source,
    "rings": rings.source,
    "modes": modes.source,
}
_AT_RUN_TIME = {"runtime": runtime.files, "joints": joints.files}
_MORE = {"march": march.streaming, "modes": modes.streaming}


class CTarget:
    """C as a target."""

    tested = True

    def files(self, description: Description, program: Program) -> dict[str, str]:
        if program.kind in _AT_RUN_TIME:
            return _AT_RUN_TIME[program.kind](description, program)
        name = description.name
        more = _MORE[program.kind](description, program) if program.kind in _MORE else ""
        made = {
            f"{name}.h": header(description, more, stream=program.kind == "modes"),
            f"{name}.c": _SOURCES[program.kind](description, program),
        }
        match program.reference:
            case ReferenceValues():
                made[f"{name}_selftest.c"] = selftest(description, program, program.reference)
            case StreamedValues():
                made[f"{name}_selftest.c"] = modes.selftest(description, program, program.reference)
        return made


TARGET: Target = CTarget()
