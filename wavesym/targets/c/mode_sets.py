"""Numbers of modes at run time as C: NAME.h, NAME.c and NAME_selftest.c of modes that are found when they are known."""

from __future__ import annotations

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel, kernels
from wavesym.targets.c.runtime import parameter_fields
from wavesym.targets.c.selftest import selftests
from wavesym.targets.c.tables import program_tables
from wavesym.targets.description import Description, named_loads
from wavesym.targets.literals import c_constants


def files(scene: Description, program: Program) -> dict[str, str]:
    """NAME.h and NAME.c, and the self-test where there are reference values."""
    assert program.laws is not None
    streamed, peaks = bool(program.step), "peaks" in program.parts
    fields = tuple(parameter_fields(program.laws, program.real))
    reading = "stream" if streamed else "peaks" if peaks else "read"
    source = render(
        "c/mode_sets/mode_sets.c.j2",
        scene=scene,
        streamed=streamed,
        fields=fields,
        tables=program_tables("mode_sets/tables.h", scene, program),
        numbers=kernels(scene, "real.h", "vectors.h"),
        kernel=kernels(scene, f"mode_sets/{reading}.c"),
    )
    header = render(
        "c/mode_sets/mode_sets.h.j2",
        scene=scene,
        streamed=streamed,
        peaks=peaks,
        fields=fields,
        constants=c_constants(program.constants, program.real),
        sources=named_loads(program),
        model=kernel("mode_sets/model.h", scene),
        owner=f"{scene.name}_state *state" if streamed else f"{scene.name}_model *model",
    )
    return {f"{scene.name}.h": header, f"{scene.name}.c": source, **selftests(scene, program)}


def sets(scene: Description, program: Program) -> dict[str, str]:
    """The files, with what runs many sets of parameters in NAME.c."""
    made = files(scene, program)
    name = f"{scene.name}.c"
    return {**made, name: f"{made[name]}\n{kernel('mode_sets/sets.c', scene)}\n"}
