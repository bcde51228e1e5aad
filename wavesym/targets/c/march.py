"""The march as C: its operators, nodes, loads and outputs as tables."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel
from wavesym.targets.c.tables import tables_text
from wavesym.targets.description import Description
from wavesym.targets.literals import Lines, c_constants, c_literals, c_tables

_MOST_WINDOWS = 2**31 - 2  # that a common int can count; C names its own largest


@dataclass(frozen=True)
class CMarch:
    """templates/c/march/march.c.j2; the numbers of `points` as lines."""

    scene: Description
    tables: list[str]
    points: Lines
    constants: dict[str, str]
    last_window: str
    numbers: str
    series: str
    kernel: str


@dataclass(frozen=True)
class CStreaming:
    """templates/c/march/march.h.j2.

    `whole` says that all nodes are modelled, `driven` that something is proved for given loads.
    """

    scene: Description
    constants: dict[str, str]
    source_names: str
    last_window: str
    whole: bool
    driven: bool
    state: str


def source(scene: Description, program: Program) -> str:
    """NAME.c."""
    context = CMarch(
        scene=scene,
        tables=tables_text("march/tables.h", c_tables(program.tables, program.real)),
        points=c_literals(program.tables["point"], program.real),
        constants=c_constants(program.constants, program.real),
        last_window=_last_window(program),
        numbers=kernel("real.h", scene),
        series=kernel("series.h", scene),
        kernel=kernel("march/march.c", scene),
    )
    return render("c/march/march.c.j2", context)


def streaming(scene: Description, program: Program) -> str:
    """What NAME.h declares besides: the march window by window."""
    context = CStreaming(
        scene=scene,
        constants=c_constants(program.constants, program.real),
        source_names=", ".join(program.sources) or "none",
        last_window=_last_window(program),
        whole=program.whole,
        driven="windows" in program.constants,
        state=kernel("march/state.h", scene),
    )
    return render("c/march/march.h.j2", context)


def _last_window(program: Program) -> str:
    last = program.constants["last_window"]
    return str(last) if last <= _MOST_WINDOWS else "INT_MAX - 1"
