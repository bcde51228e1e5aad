"""Programs whose C is tables, under what numbers are, above plain C: closed forms, pieces, marches and modes.

And NAME.h, which streams of waves share with them.
"""

from __future__ import annotations

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel, kernels
from wavesym.targets.c.tables import program_tables
from wavesym.targets.description import Description, named_loads
from wavesym.targets.literals import c_constants

_NUMBERS = {"closed": ("closed/library.h", "real.h"), "pieces": ("real.h", "vectors.h")}
_UNDER = {"spacing": "under the scene's loads", "panel": "under a step of each load at tau = 0"}
"""What a stream's bound of errors is for."""


def header(scene: Description, program: Program, more: str = "") -> str:
    """NAME.h: what every program declares, and `more`.

    A stream has no functions of tau; its bound holds `under` certain loads. What takes parameters is not `bounded`.
    """
    return render("c/header.h.j2", scene=scene, more=more, under=_loads_of_bound(program), bounded=program.laws is None)


def _loads_of_bound(program: Program) -> str:
    """Under which loads the bound of a stream holds; "" of what is no stream."""
    if program.step == "spacing" and program.provenance.step is not None:
        return "under a rise of each load within a step"
    return _UNDER.get(program.step, "")


def source(scene: Description, program: Program) -> str:
    """NAME.c."""
    name = program.kernel
    numbers = _NUMBERS.get(name, ("real.h",))
    return render(
        "c/plain.c.j2",
        scene=scene,
        numbers=kernels(scene, *numbers),
        tables=program_tables(f"{name}/tables.h", scene, program),
        kernel=kernels(scene, f"{name}/{name}.c", above=numbers),
    )


def streaming(scene: Description, program: Program) -> str:
    """What NAME.h of modes declares besides: the stream, one sample of the loads in and all outputs out."""
    return render(
        "c/modes/modes.h.j2",
        scene=scene,
        constants=c_constants(program.constants, program.real),
        sources=named_loads(program),
        under=_loads_of_bound(program),
        state=kernel("modes/state.h", scene),
    )
