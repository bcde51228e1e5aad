"""Modes as C: a stream, one sample of the loads in and all outputs out."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.modes.modal_system import LANES
from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.c import plain
from wavesym.targets.c.kernel import kernel
from wavesym.targets.description import Description, named_loads
from wavesym.targets.literals import c_constants


@dataclass(frozen=True)
class CModesStream:
    """templates/c/modes/modes.h.j2: the loads and their units as text, and as constants."""

    scene: Description
    constants: dict[str, str]
    sources: tuple[tuple[str, str], ...]
    state: str


def source(scene: Description, program: Program) -> str:
    """NAME.c."""
    rows = {name: str(len(program.tables[f"{name}_row"])) for name in ("moved", "moving")}
    return plain.source(scene, program, {"lanes": str(LANES), **rows})


def streaming(scene: Description, program: Program) -> str:
    """What NAME.h declares besides: the stream."""
    context = CModesStream(
        scene=scene,
        constants=c_constants(program.constants, program.real),
        sources=named_loads(program),
        state=kernel("modes/state.h", scene),
    )
    return render("c/modes/modes.h.j2", context)
