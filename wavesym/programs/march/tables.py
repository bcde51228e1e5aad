"""A plan and a degree as flat tables: what schemes/march.py and templates/c/march/march.c are run from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from flint import fmpq

from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import Real
from wavesym.programs.march.plan import MarchedJoint, MarchPlan, OutputTerm
from wavesym.programs.march.responses import BlockResponse, BodyOperator, block_response, body_operator
from wavesym.programs.march.space import BLOCK, BODY, SCATTERER, JointSpace
from wavesym.programs.tables import Tables, firsts


class MarchTables:
    """The numbers of a march at some degree in `real` numbers."""

    def __init__(self, plan: MarchPlan, degree: int, real: Real) -> None:
        self._plan, self._degree, self._real = plan, degree, real

        self._bodies: dict[tuple[object, ...], BodyOperator] = {}
        self._blocks: dict[tuple[object, ...], BlockResponse] = {}

    def body(self, joint: MarchedJoint, length: fmpq) -> BodyOperator:
        """The operator of a body on panels of some length."""
        if (key := response_key(joint, length)) not in self._bodies:
            self._bodies[key] = body_operator(joint.space.rate * length, self._degree)
        return self._bodies[key]

    def block(self, joint: MarchedJoint, length: fmpq) -> BlockResponse:
        """The response of a block on panels of some length."""
        if (key := response_key(joint, length)) not in self._blocks:
            self._blocks[key] = block_response(joint.space, length, self._degree)
        return self._blocks[key]

    def tables(self, nothing: Sequence[bool]) -> Tables:
        """All tables, by name; `nothing` says of each output whether it is 0 throughout."""
        plan, real = self._plan, self._real
        terms = [() if none else output.terms for output, none in zip(plan.outputs, nothing, strict=True)]
        delays = sorted({one.delay for output in plan.outputs for one in output.terms})
        stretches = [plan.stretches(delay) for delay in delays]
        flat = [stretch for group in stretches for stretch in group]
        begins = [n * plan.step for n in range(plan.cycle[0])]
        starts = [begin + stretch.start for stretch in flat for begin in begins]
        first = {id(group[0]) for group in stretches}
        return {
            "steps": tuple(track.steps for track in plan.tracks),
            "ring": firsts(track.steps + 1 for track in plan.tracks),
            "held": real.table(track.initial_value for track in plan.tracks),
            **self.joints(),
            "half_length": real.table(panel.length / 2 for panel in plan.panels),
            "since": real.table(panel.start - other.start for panel in plan.panels for other in plan.panels),
            "event_window": tuple(event.window for event in plan.events),
            "event_panel": tuple(event.panel for event in plan.events),
            "event_force": tuple(event.force for event in plan.events),
            "event_power": real.table(power for event in plan.events for power in event.powers),
            **term_tables(terms, real),
            "delay": tuple(delays.index(term.delay) for each in terms for term in each),
            "begin": tuple(map(real.not_below, begins)),
            "first_stretch": firsts(map(len, stretches)),
            "from": tuple(real.not_below(max(start, fmpq(0))) for start in starts),
            "start": real.table(starts),
            "excess": real.table(rational(real.nearest(start)) - start for start in starts),
            "low": real.table(-stretch.start if id(stretch) in first else fmpq(0) for stretch in flat),
            "high": real.table(min(plan.panels[s.panel].length, plan.step - s.start) for s in flat),
            "back": tuple(stretch.back for stretch in flat),
            "panel_of": tuple(stretch.panel for stretch in flat),
        }

    def joints(self) -> Tables:
        """Those of the joints and their ports."""
        plan, real = self._plan, self._real
        spaces = [joint.space for joint in plan.joints]
        matrix, where = self._matrices()
        drives = [space.drive for space in spaces]
        pushes = ((drive or 1) * port.push for space, drive in zip(spaces, drives, strict=True) for port in space.ports)
        return {
            **port_tables(plan.joints, real),
            "push": real.table(pushes),
            "law": tuple(space.law for space in spaces),
            "drive": real.table(drives),
            "answer": where,
            "matrix": matrix,
            "initial_state": real.table(value for space in spaces for value in space.initial_state),
        }

    def constants(self) -> dict[str, float]:
        """Single numbers."""
        plan = self._plan
        return {
            **plan_constants(plan, self._real),
            "degree": self._degree,
            "bodies": sum(joint.space.law == BODY for joint in plan.joints),
            "blocks": sum(joint.space.law == BLOCK for joint in plan.joints),
            "events": len(plan.events),
            # where no joint has a state as well: a compiler may look at what is never run then
            "widest": max(
                joint.space.points * (self._degree + 1) + joint.space.states
                if joint.space.law == BLOCK
                else self._degree + 1
                for joint in plan.joints
            ),
            "most_ports": max(len(joint.space.ports) for joint in plan.joints),
        }

    def _matrices(self) -> tuple[tuple[float, ...], tuple[int, ...]]:
        """One after the other, each by columns, and by panel and joint where they start."""
        matrix: list[float] = []
        begins: dict[tuple[object, ...], int] = {}
        where = []
        for panel in self._plan.panels:
            for joint in self._plan.joints:
                key = response_key(joint, panel.length)
                if key not in begins:
                    begins[key] = len(matrix)
                    matrix += map(self._real.nearest, self._matrix(joint, panel.length))
                where.append(begins[key])
        return tuple(matrix), tuple(where)

    def _matrix(self, joint: MarchedJoint, length: fmpq) -> Iterable[fmpq]:
        if joint.space.law == BODY:
            return map(rational, self.body(joint, length).rows)
        if joint.space.law == BLOCK:
            return map(rational, self.block(joint, length).matrix.T.ravel().tolist())
        entries: list[fmpq] = joint.space.scattering.transpose().entries()
        return entries


def plan_constants(plan: MarchPlan, real: Real) -> dict[str, float]:
    """Single numbers of a plan, whose joints may be functions of parameters."""
    cycle, span = plan.cycle
    return {
        "panels": len(plan.panels),
        "joints": len(plan.joints),
        "states": sum(joint.space.states for joint in plan.joints),
        "forces": plan.forces,
        "tracks": len(plan.tracks),
        "slots": sum(track.steps + 1 for track in plan.tracks),
        "cycle": cycle,
        "span": real.nearest(fmpq(span)),
        "step": real.nearest(plan.step),
    }


def port_tables(joints: Sequence[MarchedJoint], real: Real) -> Tables:
    """Where points, states and ports of joints begin, and the ports; joints may be functions of parameters."""
    spaces = [joint.space for joint in joints]
    ports = [port for space in spaces for port in space.ports]
    return {
        "first_point": firsts(space.points for space in spaces),
        "first_state": firsts(space.states for space in spaces),
        "first_port": firsts(len(space.ports) for space in spaces),
        "force_on": tuple(force for joint in joints for force in joint.forces),
        "point_of": tuple(port.point for port in ports),
        "ratio": real.table(port.ratio for port in ports),
        "arrive": tuple(track for joint in joints for track in joint.arrive),
        "send": tuple(track for joint in joints for track in joint.sends),
    }


def term_tables(outputs: Sequence[Sequence[OutputTerm]], real: Real) -> Tables:
    """The terms of outputs, one output after the other."""
    every = [term for terms in outputs for term in terms]
    return {
        "first_term": firsts(map(len, outputs)),
        "track": tuple(term.track for term in every),
        "gain": real.table(term.gain for term in every),
        "summed": tuple(int(term.summed) for term in every),
    }


def response_key(joint: MarchedJoint, length: fmpq) -> tuple[object, ...]:
    """Joints with the same one have the same matrix on panels of this length."""
    law = joint.space.law
    if law == BODY:
        return ("body", str(joint.space.rate * length))
    if law == BLOCK:
        return (*joint.space.key, str(length))
    return tuple(map(str, joint.space.scattering.entries()))


def matrix_size(space: JointSpace, degree: int) -> int:
    """How many numbers the matrix of a joint has."""
    if space.law == SCATTERER:
        return len(space.ports) * (len(space.ports) + space.points)
    if space.law == BODY:
        return 3 * (degree + 1)
    return int((space.points * (degree + 1) + space.states) ** 2)


def table_bytes(plan: MarchPlan, degree: int, real: Real) -> int:
    """The size of the tables that grow: matrices, loads, and where stretches start."""
    sizes = {}
    for joint in plan.joints:
        for panel in plan.panels:
            key = response_key(joint, panel.length)
            sizes[key] = matrix_size(joint.space, degree)
    delays = {term.delay for output in plan.outputs for term in output.terms}
    stretches = sum(len(plan.stretches(delay)) for delay in delays) * 3 + 1
    return real.bytes * (sum(sizes.values()) + 6 * len(plan.events) + plan.cycle[0] * stretches)


def state_bytes(plan: MarchPlan, degree: int, real: Real) -> int:
    """The size of what a march remembers: the rings of waves."""
    slots = sum(track.steps + 1 for track in plan.tracks)
    return real.bytes * slots * len(plan.panels) * (degree + 1)
