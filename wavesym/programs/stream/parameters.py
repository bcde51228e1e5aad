"""What is streamed where parameters come at run time: the same march over functions of them.

Lengths, speeds and panels stay. What joints make of waves, what is on its way at tau = 0, how strong inputs are and
what outputs weigh are rational functions of the parameters; these stand in place of the tables that follow from them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from flint import fmpq

from wavesym.errors import CostError, UnservedError, WavesymError
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.numbers.ratio import Ratio
from wavesym.numbers.reals import Real
from wavesym.programs.march.plan import HELPS, MarchPlan
from wavesym.programs.march.tables import matrix_size
from wavesym.programs.program import Input, Program
from wavesym.programs.runtime.laws import Function, RuntimeLaws, matrix_laws, matrix_places
from wavesym.programs.runtime.network import RuntimeField, free_network
from wavesym.programs.runtime.plan import free_march
from wavesym.programs.stream.plan import InputForce, StreamPlan, acting_inputs, steps_of
from wavesym.programs.stream.tables import StreamTables, slip_size
from wavesym.programs.tables import firsts

QUICKER = fmpq(10)
"""Panels and the degree are enough for joints that parameters make so many times as fast as the scene's own are."""

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

_ONE = fmpq(1)
_CALM = 4  # radians that springs may swing on a panel: beyond it the elimination is not known to keep its digits
_HIGH = 48  # degrees: no more of them for joints that are only allowed to be quick
_SPARE = 4  # one jump loses so much less than the tolerance


@dataclass(frozen=True)
class FreeStream:
    """`march` and `acting` have functions of the parameters, whose numbers in the scene are those of `fields`."""

    fields: tuple[RuntimeField, ...]
    march: MarchPlan
    acting: tuple[InputForce, ...]

    @property
    def quicker(self) -> fmpq:
        """How many times as fast as those of the scene joints may be."""
        return QUICKER if any(field.positive for field in self.fields) else _ONE


def free_stream(model: Model, names: Sequence[str], inputs: Sequence[Input], real: Real) -> FreeStream:
    """The stream of a model with the parameters `names` at run time.

    WavesymError for a name that the scene does not have, and for loads; UnservedError, CostError as `fields`,
    `free_network` and `march_plan` say.
    """
    if "load" in names:
        raise WavesymError("--runtime: load, but the inputs of a stream are its loads; leave load out")
    free = free_network(model, names, ())
    network = free.network
    if any(point.motion is not None and isinstance(point.velocity, Ratio) for point in network.points):
        raise UnservedError("--runtime: velocity, but a motion prescribes that of an end; leave velocity out")
    march = free_march(model, free, steps_of(inputs), real, HELPS)
    acting = acting_inputs(network, march.loaded_points, inputs, free.factors.load)
    return FreeStream(free.fields, march, tuple(acting))


def refuse_stiff(plan: StreamPlan) -> None:
    """CostError where springs of the scene itself are too stiff for tables in the numbers of the program."""
    angle = nearest(plan.panel) * max(joint.space.swing for joint in plan.march.joints)
    if angle > _CALM:
        raise CostError(
            f"system.parts: springs turn by {angle:.3g} on a panel of {plan.panel}, the limit with --runtime is "
            f"{_CALM} (softer springs, or a stream without it, helps)"
        )


def quick_enough(plan: StreamPlan, quicker: fmpq, degree: int, tolerance: float, real: Real) -> tuple[int, fmpq]:
    """The least degree from one on for the joints of the scene, and if it is not too high `quicker` ones; how quick."""

    def fine(of: StreamPlan) -> bool:
        tables = StreamTables(of, degree, real)
        return max(map(tables.jump_lost, of.march.joints)) <= tolerance / _SPARE

    quick = plan.quicker(quicker)
    while not fine(plan) or (degree < _HIGH and not fine(quick)):
        degree += 1
    return degree, quicker if fine(quick) else fmpq(1)


def with_parameters(program: Program, free: FreeStream, plan: StreamPlan, degree: int, quicker: fmpq) -> Program:
    """With functions for the tables that parameters make, enough for joints so much `quicker` than the scene's."""
    names, joints, laws = ", ".join(field.name for field in free.fields), plan.march.joints, _laws(free)
    answers = firsts(matrix_size(joint.space, degree) for joint in joints)
    slips = firsts(slip_size(joint.space, degree) for joint in joints)
    tables = {name: table for name, table in program.tables.items() if name not in MADE}
    tables |= {"answer": answers, "first_slip": slips}
    tables |= matrix_places(joints)
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
    march = free.march
    spaces = [joint.space for joint in march.joints]
    functions: dict[str, Iterable[Function]] = {
        **matrix_laws(march.joints),
        "weight": (weight for space in spaces for weight in space.weights),
        "initial_state": (value for space in spaces for value in space.initial_state),
        "push": (port.push for space in spaces for port in space.ports),
        "held": (track.initial_value for track in march.tracks),
        "track_impedance": (track.impedance for track in march.tracks),
        "base": (force.base for force in free.acting),
        "strength": (gain for force in free.acting for gain in force.gains),
        "gain": (one.gain for output in march.outputs for one in output.terms),
    }
    return RuntimeLaws(free.fields, {name: tuple(of) for name, of in functions.items()}, ())
