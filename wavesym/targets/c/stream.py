"""Loads at run time as C: a stream of waves, whatever the steps."""

from __future__ import annotations

from dataclasses import replace

from wavesym.programs.program import Program
from wavesym.programs.stream.parameters import MADE
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel, kernels
from wavesym.targets.c.runtime import LIMITS, CRuntimeField, assignments, parameter_fields, product_lines
from wavesym.targets.c.tables import program_tables
from wavesym.targets.description import Description, named_loads
from wavesym.targets.literals import c_constants, c_literal

_NUMBERS = ("real.h", "apart.h")
_SERIES = ("root.h", "series.h", "joint.c")
"""What stands above the names of tables in a state."""


def source(scene: Description, program: Program) -> str:
    """NAME.c.

    With parameters at run time `laws` are assigned, each with its expression, to `functions`, arrays of so many
    numbers; `made_tables` are the tables that `build` computes, in the state. Without parameters these are empty.
    """
    laws = program.laws
    made = (*MADE, "growth") if laws else ()
    known = replace(program, constants={name: of for name, of in program.constants.items() if name not in made})
    return render(
        "c/stream/stream.c.j2",
        scene=scene,
        tables=program_tables("stream/tables.h", scene, known),
        numbers=kernels(scene, *_NUMBERS),
        series=kernels(scene, *_SERIES, above=_NUMBERS),
        kernel=kernels(scene, "stream/made.c" if laws else "stream/stream.c", above=_SERIES),
        fields=_fields(program),
        functions=tuple((name, str(len(of))) for name, of in laws.functions.items()) if laws else (),
        made_tables=made,
        products=product_lines(laws, laws.every, program.real) if laws else (),
        laws=tuple(assignments(laws, laws.functions, program.real)) if laws else (),
        terms=str(len(laws.functions["gain"])) if laws else "",
        calm=str(program.constants["calm"]) if laws else "",
        largest=f"{LIMITS[program.real.name]}_MAX",
        least=f"{LIMITS[program.real.name]}_MIN",
    )


def streaming(scene: Description, program: Program) -> str:
    """What NAME.h declares besides: the stream."""
    return render(
        "c/stream/stream.h.j2",
        scene=scene,
        constants=c_constants(program.constants, program.real),
        step=c_literal(program.real.nearest(step), program.real) if (step := program.provenance.step) else "",
        sources=named_loads(program),
        direct=tuple(
            (output.name, ", ".join(program.sources[j] for j in of))
            for output, of in zip(program.outputs, program.direct, strict=True)
            if of
        ),
        fields=_fields(program),
        arrays=_arrays(program),
        state=kernel("stream/state.h", scene),
    )


def _fields(program: Program) -> tuple[CRuntimeField, ...]:
    """The parameters that come at run time."""
    return tuple(parameter_fields(program.laws, program.real)) if program.laws else ()


def _arrays(program: Program) -> tuple[tuple[str, str], ...]:
    """What they make, with how many numbers each has."""
    if not program.laws:
        return ()
    made = {name: len(functions) for name, functions in program.laws.functions.items()}
    tracks = program.constants["tracks"]
    more = {"matrix": program.constants["answers"], "slip": program.constants["slips"]}
    more |= {"drive": program.constants["joints"], "root_impedance": tracks, "state_gain": tracks}
    return tuple((name, str(count)) for name, count in (made | more).items())
