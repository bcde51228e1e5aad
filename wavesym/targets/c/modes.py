"""Modes as C: a stream, one sample of the loads in and all outputs out."""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb

from wavesym.numbers.doubles import bound
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.modes.modal_system import LANES
from wavesym.programs.program import Program, StreamedValues
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel
from wavesym.targets.c.tables import tables_text
from wavesym.targets.description import Description, constants
from wavesym.targets.literals import Lines, c_constants, c_literals, c_tables


@dataclass(frozen=True)
class CModes:
    """templates/c/modes/modes.c.j2."""

    scene: Description
    tables: list[str]
    constants: dict[str, str]
    moved: str
    moving: str
    lanes: str
    numbers: str
    kernel: str


@dataclass(frozen=True)
class CModesStream:
    """templates/c/modes/modes.h.j2: the loads and their units as text, and as constants."""

    scene: Description
    constants: dict[str, str]
    sources: tuple[tuple[str, str], ...]
    state: str


@dataclass(frozen=True)
class CModesSelfTest:
    """templates/c/modes/selftest.c.j2: `expected` by output, then by sample; doubles whatever the program's type is."""

    scene: Description
    count: str
    tables: dict[str, Lines]


def source(scene: Description, program: Program) -> str:
    """NAME.c."""
    context = CModes(
        scene=scene,
        tables=tables_text("modes/tables.h", c_tables(program.tables, program.real), {"LANES": str(LANES)}),
        constants=c_constants(program.constants, program.real),
        moved=str(len(program.tables["moved_row"])),
        moving=str(len(program.tables["moving_row"])),
        lanes=str(LANES),
        numbers=kernel("real.h", scene),
        kernel=kernel("modes/modes.c", scene),
    )
    return render("c/modes/modes.c.j2", context)


def streaming(scene: Description, program: Program) -> str:
    """What NAME.h declares besides: the stream."""
    names = [f"load@{source.partition(' ')[0]}" for source in program.sources]
    context = CModesStream(
        scene=scene,
        constants=c_constants(program.constants, program.real),
        sources=tuple(zip(program.sources, constants(names), strict=True)),
        state=kernel("modes/state.h", scene),
    )
    return render("c/modes/modes.h.j2", context)


def selftest(scene: Description, program: Program, reference: StreamedValues) -> str:
    """The program that holds a stream against reference values."""
    rows = zip(reference.errors, reference.values, strict=True)
    # the reference is rounded once; two digits are the same on every machine
    allowed = [bound(arb(error + 2.0**-52 * max(map(abs, row)))) for error, row in rows]
    context = CModesSelfTest(
        scene=scene,
        count=str(len(reference.loads)),
        tables={
            "loads": c_literals((value for row in reference.loads for value in row), program.real),
            "expected": c_literals((value for row in reference.values for value in row), DOUBLE),
            "allowed": c_literals(allowed, DOUBLE),
        },
    )
    return render("c/modes/selftest.c.j2", context)
