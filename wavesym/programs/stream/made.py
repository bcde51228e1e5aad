"""Of a stream's tables those that parameters make when they come at run time: where they are, and the functions."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain
from typing import Any

from flint import fmpq_mat

from wavesym.programs.flat import firsts
from wavesym.programs.march.plan import MarchedJoint
from wavesym.programs.march.space import BODY
from wavesym.programs.march.tables import matrix_size
from wavesym.programs.runtime.laws import RuntimeLaws
from wavesym.programs.runtime.units import Function
from wavesym.programs.stream.free import FreeStream
from wavesym.programs.stream.plan import StreamPlan
from wavesym.programs.stream.quick import CALM, rows_of

MADE = ("held", "root_impedance", "state_gain", "matrix", "drive", "begun", "push", "slip", "base", "strength", "gain")
"""The tables that are computed."""
LAWS = ("rates", "pushed", "shown", "passed")
"""The matrices of joints that they follow from."""


def laws_of(free: FreeStream) -> RuntimeLaws:
    """The functions of the parameters from which all of `MADE` follow, as templates/c/stream/made.c takes them."""
    rings = free.rings
    spaces = [joint.space for joint in rings.joints]
    functions: dict[str, Iterable[Function]] = {
        **{name: [value for space in spaces for value in _flat(getattr(space, name))] for name in LAWS},
        "weight": (weight for space in spaces for weight in space.weights),
        "begun": (value for space in spaces for value in space.begun),
        "push": (port.push for space in spaces for port in space.ports),
        "held": (track.held for track in rings.tracks),
        "track_impedance": (track.impedance for track in rings.tracks),
        "base": (force.base for force in free.acting),
        "strength": (gain for force in free.acting for gain in force.gains),
        "gain": (one.gain for output in rings.outputs for one in output.heard),
    }
    return RuntimeLaws(free.fields, {name: tuple(of) for name, of in functions.items()}, ())


def places(free: FreeStream, plan: StreamPlan, degree: int) -> dict[str, tuple[float, ...]]:
    """Where in them what belongs to a joint begins, and which of its states are velocities."""
    joints = plan.rings.joints
    return {
        "answer": firsts(matrix_size(joint.space, degree) for joint in joints),
        "first_slip": firsts(_slip_size(joint, degree) for joint in joints),
        **{f"at_{name}": firsts(len(_flat(getattr(joint.space, name))) for joint in joints) for name in LAWS},
        "is_mass": tuple(
            int(n < rows.masses) for rows in map(rows_of, free.rings.joints) if rows for n in range(len(rows.weights))
        ),
    }


def sizes(plan: StreamPlan, degree: int) -> dict[str, float]:
    """How many numbers of them there are."""
    joints = plan.rings.joints
    return {
        "answers": sum(matrix_size(joint.space, degree) for joint in joints),
        "slips": sum(_slip_size(joint, degree) for joint in joints),
        "calm": CALM,
        "tracks": len(plan.rings.tracks),
    }


def _flat(matrix: Any) -> list[Any]:
    """The entries of a matrix, or of rows, by rows."""
    return list(matrix.entries() if isinstance(matrix, fmpq_mat) else chain.from_iterable(matrix))


def _slip_size(joint: MarchedJoint, degree: int) -> int:
    space = joint.space
    return 1 if space.law == BODY else space.states * (space.points * (degree + 1) + space.states)
