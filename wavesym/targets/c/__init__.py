"""C99 that is C++ too: NAME.h, NAME.c and NAME_selftest.c."""

from __future__ import annotations

from wavesym.errors import UnservedError
from wavesym.programs.program import Program, ReferenceValues, SteppedValues, StreamedValues
from wavesym.targets.c import closed, joints, march, modes, pieces, rings, runtime, stream
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
    "stream": stream.source,
}
_AT_RUN_TIME = {"runtime": runtime.files, "joints": joints.files}
_MORE = {"march": march.streaming, "modes": modes.streaming, "stream": stream.streaming}

# what a stream's bound of errors is for
_UNDER = {"modes": "under the scene's loads", "stream": "under a step of each load at tau = 0"}


class CTarget:
    """C as a target."""

    tested = True

    def files(self, description: Description, program: Program) -> dict[str, str]:
        if program.numpy_only:
            raise UnservedError(program.numpy_only)
        if program.kind in _AT_RUN_TIME:
            return _AT_RUN_TIME[program.kind](description, program)
        name = description.name
        more = _MORE[program.kind](description, program) if program.kind in _MORE else ""
        made = {
            f"{name}.h": header(description, more, under=_UNDER.get(program.kind, ""), bounded=program.laws is None),
            f"{name}.c": _SOURCES[program.kind](description, program),
        }
        match program.reference:
            case ReferenceValues():
                made[f"{name}_selftest.c"] = selftest(description, program, program.reference)
            case StreamedValues():
                made[f"{name}_selftest.c"] = modes.selftest(description, program, program.reference)
            case SteppedValues():
                made[f"{name}_selftest.c"] = stream.selftest(description, program, program.reference)
        return made


TARGET: Target = CTarget()
