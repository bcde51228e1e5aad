"""Parameters at run time of a chain that is written out, as C: the march of its joints, built when they are known."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.program import Program
from wavesym.targets.c.kernel import kernel, kernels
from wavesym.targets.c.runtime import CRuntime, RuntimeTexts, of_program, with_sets, written
from wavesym.targets.description import Description

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
class CRuntimeJoints(CRuntime):
    """templates/c/joints/joints.c.j2; as `CRuntime`, and `arrays` are the laws with how many numbers each has."""

    arrays: tuple[tuple[str, str], ...]


def files(scene: Description, program: Program) -> dict[str, str]:
    """The files of a program, by name."""
    assert program.laws is not None
    texts = RuntimeTexts(
        series=kernel("runtime/series.c", scene),
        kernel=kernels(scene, "joints/joints.c", "joints/march.c", "joints/build.c", "runtime/builds.c"),
        read=kernel("runtime/read.c", scene),
        blocks=kernel("runtime/blocks.c", scene),
        peaks=kernel("runtime/peaks.c", scene),
        gradients=kernels(scene, "joints/slopes.c", "runtime/tangents.c"),
        bound=kernels(scene, "runtime/wrong.c", "joints/bound.c", "runtime/bounds.c"),
        lanes=kernel("runtime/lanes.c", scene),
        batch=kernels(
            scene, "joints/lanes.c", "joints/march.c", "joints/batch.c", "runtime/strands.c", "runtime/batches.c"
        ),
        misfit=kernel("runtime/misfit.c", scene),
    )
    context = CRuntimeJoints(
        **of_program(scene, program, "joints"),
        texts=texts,
        arrays=tuple((name, str(len(functions))) for name, functions in program.laws.functions.items()),
    )
    return written("joints", program, _SIZES, context)


def sets(scene: Description, program: Program) -> dict[str, str]:
    """The files, with what runs many sets of parameters in NAME.c."""
    return with_sets(scene, program, files(scene, program))
