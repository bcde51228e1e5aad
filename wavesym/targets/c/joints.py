"""Parameters at run time of a chain that is written out, as C: the march of its joints, built when they are known."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.program import Program, ReferenceValues
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel, kernels
from wavesym.targets.c.runtime import (
    LIMITS,
    CRuntimeField,
    CRuntimeHeader,
    assigned,
    load_lane,
    multiplied,
    parameter_fields,
    runtime_selftest,
    slopes,
)
from wavesym.targets.description import Description
from wavesym.targets.literals import Lines, c_constants, c_literals, c_tables

_SIZES = (
    "windows",
    "strands",
    "degree",
    "panels",
    "joints",
    "points",
    "states",
    "squares",
    "widest",
    "ports",
    "tracks",
    "slots",
    "forces",
    "heard",
    "events",
    "lanes",
    "groups",
)


@dataclass(frozen=True)
class CRuntimeJoints:
    """templates/c/joints/joints.c.j2; as `CRuntime`, and `arrays` are the laws with how many numbers each has."""

    scene: Description
    fields: tuple[CRuntimeField, ...]
    arrays: tuple[tuple[str, str], ...]
    products: Lines
    laws: tuple[tuple[str, str], ...]
    slope_products: Lines
    slopes: tuple[tuple[str, tuple[tuple[str, str], ...]], ...]
    load_lane: str
    tables: dict[str, Lines]
    constants: dict[str, str]
    amplitudes: Lines
    largest: str
    least: str
    loads: str
    numbers: str
    series: str
    joints: str
    march: str
    build: str
    read: str
    bound: str
    lanes: str
    march_in_lanes: str
    batch: str
    misfit: str


def files(scene: Description, program: Program) -> dict[str, str]:
    """The files of a program, by name."""
    laws, real = program.laws, program.real
    assert laws is not None
    fields = tuple(parameter_fields(laws, real))
    constants = c_constants(program.constants, real)
    own = not any(field.name == "load" for field in fields)
    march = kernel("joints/march.c", scene)
    header = CRuntimeHeader(
        scene=scene,
        fields=fields,
        sizes=tuple((name.upper(), constants[name]) for name in _SIZES),
        model=kernel("joints/model.h", scene),
        batch=kernels(scene, "runtime/wide.h", "joints/batch.h", "runtime/data.h"),
    )
    context = CRuntimeJoints(
        scene=scene,
        fields=fields,
        arrays=tuple((name, str(len(functions))) for name, functions in laws.functions.items()),
        products=multiplied(laws, laws.every, real),
        laws=tuple(assigned(laws, laws.functions, real)),
        slope_products=multiplied(laws, laws.every_slope, real),
        slopes=tuple(slopes(laws, real)),
        load_lane=load_lane(laws),
        tables=c_tables(program.tables, real),
        constants=constants,
        amplitudes=c_literals(laws.amplitudes or (0.0,), real) if own else (),
        largest=f"{LIMITS[real.name]}_MAX",
        least=f"{LIMITS[real.name]}_MIN",
        loads="amplitude" if own else "p->load",
        numbers=kernel("real.h", scene),
        series=kernel("runtime/series.c", scene),
        joints=kernel("joints/joints.c", scene),
        march=march,
        build=kernels(scene, "joints/build.c", "runtime/builds.c"),
        read=kernel("runtime/read.c", scene),
        bound=kernels(scene, "runtime/wrong.c", "joints/bound.c", "runtime/bounds.c"),
        lanes=kernel("runtime/lanes.c", scene),
        march_in_lanes=f"{kernel('joints/lanes.c', scene)}\n\n{march}",
        batch=kernels(scene, "joints/batch.c", "runtime/batches.c"),
        misfit=kernel("runtime/misfit.c", scene),
    )
    made = {
        f"{scene.name}.h": render("c/runtime/runtime.h.j2", header),
        f"{scene.name}.c": render("c/joints/joints.c.j2", context),
    }
    if isinstance(program.reference, ReferenceValues):
        made[f"{scene.name}_selftest.c"] = runtime_selftest(scene, program, program.reference)
    return made


def sets(scene: Description, program: Program) -> dict[str, str]:
    """The files, with what runs many sets of parameters in NAME.c."""
    made = files(scene, program)
    name = f"{scene.name}.c"
    more = kernels(scene, "runtime/peaks.c", "runtime/sets.c", "runtime/sets_batch.c", "runtime/sets_bounds.c")
    return made | {name: f"{made[name]}\n{more}\n"}
