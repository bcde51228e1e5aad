"""C99 that is C++ too: NAME.h, NAME.c and NAME_selftest.c."""

from __future__ import annotations

from wavesym.programs.program import Program
from wavesym.targets.c import closed, march, pieces, rings
from wavesym.targets.c.header import header
from wavesym.targets.c.selftest import selftest
from wavesym.targets.description import Description
from wavesym.targets.target import Target

_SOURCES = {"closed": closed.source, "pieces": pieces.source, "march": march.source, "rings": rings.source}


class CTarget:
    """C as a target."""

    tested = True

    def files(self, description: Description, program: Program) -> dict[str, str]:
        name = description.name
        streaming = march.streaming(description, program) if program.kind == "march" else ""
        made = {
            f"{name}.h": header(description, streaming),
            f"{name}.c": _SOURCES[program.kind](description, program),
        }
        if program.reference:
            made[f"{name}_selftest.c"] = selftest(description, program, program.reference)
        return made


TARGET: Target = CTarget()
