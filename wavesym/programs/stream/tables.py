"""A stream's plan and a degree as flat tables: what templates/c/stream/stream.c is run from."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from math import sqrt

import numpy as np
from flint import fmpq

from wavesym.numbers.doubles import nearest, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.march.evaluator import step_multiplications
from wavesym.programs.march.losses import block_loss
from wavesym.programs.march.plan import MarchedJoint
from wavesym.programs.march.space import BLOCK, BODY, SHOWN, JointSpace
from wavesym.programs.march.tables import MarchTables, term_tables
from wavesym.programs.stream.interpolation import kinks, points, transform
from wavesym.programs.stream.plan import StreamPlan
from wavesym.programs.tables import Tables, firsts

_OF_HORIZON = ("events", "slots", "cycle", "span", "step")  # constants of a march that a stream has not
_LONGEST = 10**6  # panels of a step, each of which takes its time
_SHORTEST = fmpq(1, 10**30)  # of steps but 0
_SPARE = 4  # breakpoints that are given up take so much less than the tolerance
_ABOVE = 1 + 1e-6  # a margin for rounding


class StreamTables:
    """The numbers of a stream at some degree in `real` numbers."""

    def __init__(self, plan: StreamPlan, degree: int, real: Real) -> None:
        self._plan, self._degree, self._real = plan, degree, real
        self._march = MarchTables(plan.march, degree, real)
        self._joints = plan.march.joints

    def tables(self) -> Tables:
        """All tables, by name."""
        plan, march, panel = self._plan, self._plan.march, self._plan.panel
        half = nearest(panel / 2)
        terms = [term for output in march.outputs for term in output.terms]
        late = [plan.late(term.delay) for term in terms]
        joints = self._march.joints()
        slips = [self.slips(joint) for joint in self._joints]
        spaces = [joint.space for joint in self._joints]
        shown = {joint.sends[0]: joint.forces[0] for joint in self._joints if joint.space is SHOWN}
        weights = [self._weight(track) for track in range(len(march.tracks))]
        return {
            "slots": self._slots,
            "first_slot": firsts(self._slots),
            "entries": self._entries,
            "first_entry": firsts(self._entries),
            "held": self._real.table(track.initial_value for track in march.tracks),
            "root_impedance": self._round(root for root, _ in weights),
            "state_gain": self._round(gain for _, gain in weights),
            **joints,
            "answer": joints["answer"][: len(self._joints)],
            "moves_with": tuple(point for space in spaces for point in space.moves_with),
            "first_stretch": firsts(space.states * space.points for space in spaces),
            "lengthening": self._real.table(value for space in spaces for value in space.lengthening.entries()),
            "first_slip": firsts(map(len, slips)),
            "slip": self._round(value for slip in slips for value in slip),
            "loaded": plan.loaded,
            "base": self._real.table(force.base for force in plan.acting),
            "strength": self._real.table(gain for force in plan.acting for gain in force.gains),
            "integrated": tuple(int(force.summed) for force in plan.acting),
            "instant": self._real.table(panel / 2 * (1 + rational(u)) for u in points(self._degree)),
            "transform": self._round(value for row in transform(self._degree) for value in row),
            "kink": tuple(
                self._round_up(value * half ** (order + power))
                for order, errors in enumerate(kinks(self._degree))
                for value, power in zip(errors, (0.0, 0.5), strict=True)
            ),
            **term_tables([output.terms for output in march.outputs], self._real),
            "late": tuple(whole for whole, _ in late),
            "rest": self._real.table(rest for _, rest in late),
            "shown_force": tuple(shown.get(term.track, -1) for term in terms),
        }

    def constants(self, tolerance: float) -> dict[str, float]:
        """Single numbers."""
        plan, real = self._plan, self._real
        long, length = real.nearest(plan.panel), nearest(plan.panel)
        exponent = 20 if real is DOUBLE else 10
        return {
            **{name: value for name, value in self._march.constants().items() if name not in _OF_HORIZON},
            "slot_count": sum(self._slots),
            "entry_count": sum(self._entries),
            "breakpoints": plan.breakpoints,
            "deepest": max(track.steps for track in plan.march.tracks),
            "loads": len(plan.inputs),
            "loaded": len(plan.loaded),
            "loaded_ports": sum(len(self._joints[n].space.ports) for n in plan.loaded),
            "most_states": max(1, *(joint.space.states for joint in self._joints), 1),
            "panel": long,
            "panel_low": real.nearest(plan.panel - rational(long)),
            "scale": real.nearest(2 / plan.panel),
            "step_length": real.nearest(plan.march.step),
            "tolerance": real.nearest(rational(tolerance)),
            "share": self._round_up(tolerance * self._share),
            "rough": self._round_up((sqrt(2) - 1) / sqrt(length)),
            "steep": self._round_up((sqrt(2) - 1) / length),
            "growth": self._round_up(self._growth),
            "root_panel": self._round_up(sqrt(length)),
            "least": real.nearest(real.roundoff / 8),
            "nearest": real.nearest(plan.panel / 2 ** (2 * exponent if real is DOUBLE else 20)),
            "rounding": real.nearest(2 * real.roundoff),
            "shortest": real.nearest(_SHORTEST),
            "shortest_ramp": real.nearest(plan.panel / 2**exponent),
            "longest": real.nearest(_LONGEST * plan.panel),
            "operations": self.panel_operations,
            "step_operations": self.step_operations,
        }

    @property
    def bytes(self) -> int:
        """The size of all tables, an index taken as four bytes."""
        return sum((4 if isinstance(v, int) else self._real.bytes) for row in self.tables().values() for v in row)

    @property
    def state_bytes(self) -> int:
        """About the size of what a stream remembers: the waves on their way."""
        waves = sum(self._slots) + self._plan.breakpoints * sum(self._entries)
        return self._real.bytes * waves * (self._degree + 1)

    @property
    def panel_operations(self) -> int:
        """Multiplications with addition when a panel begins and ends; without integrals as many for each breakpoint."""
        size = self._degree + 1
        summed = sum(one.summed for output in self._plan.march.outputs for one in output.terms)
        total = 2 * 3 * 4 * size * summed
        total += sum(step_multiplications(joint.space, self._degree) for joint in self._joints)
        total += sum(len(self.slips(joint)) for joint in self._joints)
        return total

    @property
    def step_operations(self) -> int:
        """About the same for a step that begins at the edge of a panel: loads change, and all outputs are read."""
        size, total = self._degree + 1, 0
        for n in self._plan.loaded:
            joint, space = self._joints[n], self._joints[n].space
            wide = space.points * size + space.states
            total += 3 * space.points * wide if space.law == BLOCK else step_multiplications(space, self._degree)
            total += len(self.slips(joint)) + size * (space.states + len(space.ports))
        for output in self._plan.march.outputs:
            total += sum((2 * 4 * 3 if one.summed else 3) * size for one in output.terms)
        return total

    @cached_property
    def _slots(self) -> tuple[int, ...]:
        """Of each track: the panels that are on their way, and the current one."""
        count = len(self._plan.march.panels)
        return tuple(track.steps * count + 1 for track in self._plan.march.tracks)

    @cached_property
    def _entries(self) -> tuple[int, ...]:
        """Of each track: the windows that are on their way, and the current one."""
        return tuple(track.steps + 1 for track in self._plan.march.tracks)

    @property
    def _growth(self) -> float:
        """How steep errors that are smooth can become in a window, where the root of their energy is 1."""
        rate = self._plan.march.norm
        return rate * (sqrt(2 * rate * nearest(self._plan.march.step)) + 2)

    @property
    def _share(self) -> float:
        """What may be lost at once in a tau so that the bound stays at a part of 1 to the horizon (docs/march.md)."""
        panel, step, until = (nearest(each) for each in (self._plan.panel, self._plan.march.step, self._until))
        later = 1.5 * sqrt(panel / step) + sqrt(3 * panel * self._growth * (until / step + 1))
        return 1 / (_SPARE * (1 + later) * until)

    @property
    def _until(self) -> fmpq:
        return self._plan.march.model.until

    def _weight(self, track: int) -> tuple[float, float]:
        """What an error counts for on a track: as a wave, and (one over) what the state of the joint adds."""
        march = self._plan.march
        if impedance := march.tracks[track].impedance:
            return sqrt(nearest(impedance)), 0.0
        for joint in self._joints:
            for port, send in zip(joint.space.ports, joint.sends, strict=True):
                if send == track and joint.space is not SHOWN:
                    return _weight_at(joint, port.point)
        return 0.0, 0.0

    def slips(self, joint: MarchedJoint) -> list[float]:
        """What the polynomials of a joint miss, as roots of energies, from what its matrix takes."""
        if not joint.space.states:
            return []
        panel = self._plan.panel
        turned = nearest(panel) * joint.space.norm
        rows = (
            np.array([self._march.body(joint, panel).leak * sqrt(nearest(joint.space.weights[0]))])
            if joint.space.law == BODY
            else self._march.block(joint, panel).truncation_error.ravel()
        )
        rows = block_loss(turned) * rows
        return [float(f"{value * 1.01:.3g}") for value in rows.tolist()]

    def jump_lost(self, joint: MarchedJoint) -> float:
        """What part of the energy that comes polynomials lose at most where all waves and masses, at rest so far, jump
        to 1; a root; as templates/c/stream/made.c has it.
        """
        space, size, slips = joint.space, self._degree + 1, np.array(self.slips(joint))
        if not space.states:
            return 0.0
        masses = [point >= 0 for point in space.moves_with]
        pushes = [abs(nearest(port.push)) for port in space.ports]
        if space.law == BODY:
            operator, acting = self._march.body(joint, self._plan.panel), nearest(space.drive) * sum(pushes)
            lost = slips[0] * (abs(operator.highest(acting, 0.0)) + abs(operator.highest(0.0, 1.0)))
        else:
            jumps = np.zeros(space.points * size + space.states)
            for port, push in zip(space.ports, pushes, strict=True):
                jumps[port.point * size] += push
            jumps[space.points * size :] = masses
            lost = np.sum(np.abs(slips.reshape(space.states, -1)) @ jumps)
        energy = self._plan.panel * sum((port.impedance for port in space.ports), fmpq(0))
        energy += sum((weight for weight, mass in zip(space.weights, masses, strict=True) if mass), fmpq(0)) / 2
        return float(lost) / sqrt(nearest(energy)) if lost else 0.0

    def _round(self, values: Iterable[float]) -> tuple[float, ...]:
        return tuple(self._real.nearest(rational(value)) for value in values)

    def _round_up(self, value: float) -> float:
        """A number that is a little larger, the same one on every machine."""
        return self._real.nearest(rational(float(f"{value * (1 + 1e-4):.5g}")))


def _weight_at(joint: MarchedJoint, point: int) -> tuple[float, float]:
    """Of the velocity of a point: a rod there says it, as half of the sum of its waves; else it follows from the state
    and from what arrives at other points.
    """
    space = joint.space
    roots = [sqrt(nearest(port.impedance)) for port in space.ports]
    at_hand = [
        nearest(port.ratio) * root / 2 for port, root in zip(space.ports, roots, strict=True) if port.point == point
    ]
    if carried := max(at_hand, default=0.0):
        return carried, 0.0
    shown = [
        abs(nearest(space.state_velocities[point, a])) / sqrt(nearest(weight)) for a, weight in enumerate(space.weights)
    ]
    moved = 1.4143 * sum(shown)
    passing = sum(
        abs(nearest(space.feedthrough[point, port.point] * port.push)) / root
        for port, root in zip(space.ports, roots, strict=True)
        if root
    )
    return 1 / (passing + (moved or 1.0)), moved


def slip_size(space: JointSpace, degree: int) -> int:
    """How many numbers say what the polynomials of a joint miss."""
    return 1 if space.law == BODY else space.states * (space.points * (degree + 1) + space.states)
