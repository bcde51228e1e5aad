"""A stream whose parameters come at run time: the degree for them, and functions in place of tables that they make."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import chain
from typing import Any

from flint import fmpq, fmpq_mat

from wavesym.errors import CostError
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import Real
from wavesym.programs.flat import firsts
from wavesym.programs.march.tables import matrix_size
from wavesym.programs.program import Program
from wavesym.programs.runtime.laws import Function, RuntimeLaws
from wavesym.programs.stream.free import FreeStream
from wavesym.programs.stream.plan import StreamPlan
from wavesym.programs.stream.tables import StreamTables, slip_size

MADE = (
    "held",
    "root_impedance",
    "state_gain",
    "matrix",
    "drive",
    "initial_state",
    "push",
    "slip",
    "base",
    "strength",
    "gain",
)
"""The tables that `build` computes."""

_CALM = 4  # radians that springs may swing on a panel: beyond it the elimination is not known to keep its digits
_LAWS = ("rates", "pushed", "shown", "passed")  # the matrices of joints
_HIGH = 48  # degrees: no more of them for joints that are only allowed to be quick
_SPARE = 4  # one jump loses so much less than the tolerance


def refuse_stiff(plan: StreamPlan) -> None:
    """CostError where springs of the scene itself are too stiff for tables in the numbers of the program."""
    angle = nearest(plan.panel) * max(joint.space.swing for joint in plan.rings.joints)
    if angle > _CALM:
        raise CostError(
            f"system.parts: springs turn by {angle:.3g} on a panel of {plan.panel}, at most {_CALM} expected with "
            "--runtime (softer springs, or a stream without it, helps)"
        )


def quick_enough(plan: StreamPlan, quicker: fmpq, degree: int, tolerance: float, real: Real) -> tuple[int, fmpq]:
    """The least degree from one on for the joints of the scene, and if it is not too high `quicker` ones; how quick."""

    def fine(of: StreamPlan) -> bool:
        tables = StreamTables(of, degree, real)
        return max(map(tables.jump_lost, of.rings.joints)) <= tolerance / _SPARE

    quick = plan.quicker(quicker)
    while not fine(plan) or (degree < _HIGH and not fine(quick)):
        degree += 1
    return degree, quicker if fine(quick) else fmpq(1)


def with_parameters(program: Program, free: FreeStream, plan: StreamPlan, degree: int, quicker: fmpq) -> Program:
    """With functions for the tables that parameters make, enough for joints so much `quicker` than the scene's."""
    names, joints, laws = ", ".join(field.name for field in free.fields), plan.rings.joints, _laws(free)
    answers = firsts(matrix_size(joint.space, degree) for joint in joints)
    slips = firsts(slip_size(joint.space, degree) for joint in joints)
    tables = {name: table for name, table in program.tables.items() if name not in MADE}
    tables |= {"answer": answers, "first_slip": slips}
    tables |= {f"at_{law}": firsts(len(_flat(getattr(joint.space, law))) for joint in joints) for law in _LAWS}
    kept = sum(map(len, laws.functions.values())) + answers[-1] + slips[-1]
    also = f" and for joints {quicker} times as fast" if quicker != 1 else ""
    kib = -(-kept * program.real.bytes // 1024)
    reason = f"{names} at run time, {kib} KiB more, enough for the scene's own{also}; errors are estimated"
    return replace(
        program,
        tables=tables,
        constants=program.constants | {"answers": answers[-1], "slips": slips[-1], "calm": _CALM},
        bytes=sum((4 if isinstance(v, int) else program.real.bytes) for row in tables.values() for v in row),
        provenance=replace(program.provenance, reason=f"{program.provenance.reason}; {reason}"),
        laws=laws,
    )


def _laws(free: FreeStream) -> RuntimeLaws:
    """The functions of the parameters from which all of `MADE` follow, as templates/c/stream/made.c takes them."""
    rings = free.rings
    spaces = [joint.space for joint in rings.joints]
    functions: dict[str, Iterable[Function]] = {
        **{law: [value for space in spaces for value in _flat(getattr(space, law))] for law in _LAWS},
        "weight": (weight for space in spaces for weight in space.weights),
        "initial_state": (value for space in spaces for value in space.begun),
        "push": (port.push for space in spaces for port in space.ports),
        "held": (track.held for track in rings.tracks),
        "track_impedance": (track.impedance for track in rings.tracks),
        "base": (force.base for force in free.acting),
        "strength": (gain for force in free.acting for gain in force.gains),
        "gain": (one.gain for output in rings.outputs for one in output.heard),
    }
    return RuntimeLaws(free.fields, {name: tuple(of) for name, of in functions.items()}, ())


def _flat(matrix: Any) -> list[Any]:
    """The entries of a matrix, or of rows, by rows."""
    return list(matrix.entries() if isinstance(matrix, fmpq_mat) else chain.from_iterable(matrix))
