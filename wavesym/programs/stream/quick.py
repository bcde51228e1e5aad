"""How quick parameters may make the joints of a stream: the degree for that, and when springs are too stiff for it."""

from __future__ import annotations

from math import sqrt
from typing import Any, cast

from flint import fmpq

from wavesym.errors import CostError
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import Real
from wavesym.programs.march.plan import MarchedJoint
from wavesym.programs.march.space import JointRows
from wavesym.programs.stream.free import FreeStream
from wavesym.programs.stream.plan import StreamPlan
from wavesym.programs.stream.tables import StreamTables

CALM = 4
"""By what angle springs may turn on a panel: beyond it the elimination is not known to keep its digits."""

_HIGH = 48  # degrees: no more of them for joints that are only allowed to be quick
_SPARE = 4  # one jump loses so much less than the tolerance


def refuse_stiff(plan: StreamPlan) -> None:
    """CostError where springs of the scene itself are too stiff for tables in the numbers of the program."""
    angle = nearest(plan.panel) * max(joint.space.swing for joint in plan.rings.joints)
    if angle > CALM:
        raise CostError(
            f"system.parts: springs turn by {angle:.3g} on a panel of {plan.panel}, at most {CALM} expected with "
            "--runtime (softer springs, or a stream without it, helps)"
        )


def quick_enough(free: FreeStream, plan: StreamPlan, degree: int, tolerance: float, real: Real) -> tuple[int, fmpq]:
    """The least degree from one on for the scene's joints, and, if it is not too high, for quicker ones; how quick."""

    def fine(of: StreamPlan) -> bool:
        tables = StreamTables(of, degree, real)
        pairs = zip(of.rings.joints, free.rings.joints, strict=True)
        return max(step_lost(joint, rows_of(made), of.panel, tables) for joint, made in pairs) <= tolerance / _SPARE

    quick = plan.quicker(free.quicker)
    while not fine(plan) or (degree < _HIGH and not fine(quick)):
        degree += 1
    return degree, free.quicker if fine(quick) else fmpq(1)


def step_lost(joint: MarchedJoint, rows: JointRows | None, panel: fmpq, tables: StreamTables) -> float:
    """What part of the energy that comes polynomials lose at most where all waves and bodies, at rest so far, jump to
    1; a root; as templates/c/stream/made.c has it.
    """
    space = joint.space
    if rows is None or not space.states:
        return 0.0
    energy = panel * sum((port.impedance for port in space.ports), fmpq(0))
    energy += sum(space.weights[: rows.masses], fmpq(0)) / 2
    lost = tables.jump_missed(joint, rows.masses)
    return lost / sqrt(nearest(energy)) if lost else 0.0


def rows_of(joint: MarchedJoint) -> JointRows | None:
    """None where a load is read."""
    return rows if isinstance(rows := cast(Any, joint.space), JointRows) else None
