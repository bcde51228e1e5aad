"""A stream's plan and a degree as flat tables: what templates/c/stream/stream.c is run from."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from math import factorial, sqrt

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.numbers.doubles import nearest, rational
from wavesym.numbers.reals import Real
from wavesym.programs.flat import firsts
from wavesym.programs.rings.plan import MarchedJoint
from wavesym.programs.rings.tables import RingTables
from wavesym.programs.stream.kinks import kinks, points, transform
from wavesym.programs.stream.plan import StreamPlan

Array = NDArray[np.float64]

# of the sum of what polynomials miss, errors at fronts were seen to be up to about so many times as much
CAUTION = 4
_LONGEST = 10**6  # panels of a step, each of which takes its time
_SHORTEST = fmpq(1, 10**30)  # of steps but 0: no slope of a load is larger than the load times 1e30


class StreamTables:
    """The numbers of a stream at some degree in `real` numbers."""

    def __init__(self, plan: StreamPlan, degree: int, real: Real) -> None:
        self._plan, self._degree, self._real = plan, degree, real
        self._rings = RingTables(plan.rings, degree, real)
        self._joints = plan.rings.joints

    def tables(self) -> dict[str, tuple[float, ...]]:
        """All tables, by name."""
        plan, rings, half = self._plan, self._plan.rings, self._plan.panel / 2
        heard = [one for output in rings.outputs for one in output.heard]
        late = [plan.late(one.delay) for one in heard]
        joints = self._rings.joints()
        spaces = [self._joints[n].space for n in plan.loaded]
        slips = [self.slips(joint) for joint in self._joints]
        laws = [
            [value for matrix in (s.rates, s.pushed, s.shown, s.passed) for value in matrix.entries()] for s in spaces
        ]
        own = self._own()
        instants = [half * (1 + rational(u)) for u in points(self._degree)]
        return {
            "slots": self._slots,
            "first_slot": firsts(self._slots),
            "held": self._real.table(track.held for track in rings.tracks),
            **joints,
            "answer": joints["answer"][: len(self._joints)],
            "first_slip": firsts(map(len, slips)),
            "slip": self._rounded(value for slip in slips for value in slip),
            "loaded": plan.loaded,
            "first_own": firsts(space.points for space in spaces),
            "first_law": firsts(map(len, laws)),
            "law": self._real.table(value for law in laws for value in law),
            "base": self._real.table(force.base for force in plan.acting),
            "strength": self._real.table(gain for force in plan.acting for gain in force.gains),
            "integrated": tuple(int(force.summed) for force in plan.acting),
            "instant": self._real.table(instants),
            "transform": self._rounded(value for row in transform(self._degree) for value in row),
            "kink": self._rounded(
                value * nearest(half) ** order for order, row in enumerate(kinks(self._degree)) for value in row
            ),
            "first_heard": firsts(len(output.heard) for output in rings.outputs),
            "track": tuple(one.track for one in heard),
            "gain": self._real.table(one.gain for one in heard),
            "summed": tuple(int(one.summed) for one in heard),
            "late": tuple(whole for whole, _ in late),
            "rest": self._real.table(rest for _, rest in late),
            "own_point": tuple(own[one.track][0] if one.track in own and one.delay == 0 else -1 for one in heard),
            "own_ratio": self._real.table(own[one.track][1] if one.track in own else fmpq(0) for one in heard),
        }

    def constants(self, tolerance: float) -> dict[str, float]:
        """Single numbers."""
        plan, real = self._plan, self._real
        long = real.nearest(plan.panel)
        spaces = [self._joints[n].space for n in plan.loaded]
        return {
            "degree": self._degree,
            "panels": len(plan.rings.panels),
            "joints": len(self._joints),
            "states": sum(joint.space.states for joint in self._joints),
            "tracks": len(plan.rings.tracks),
            "slot_count": sum(self._slots),
            "loads": len(plan.inputs),
            "forces": len(plan.acting),
            "loaded_count": len(plan.loaded),
            "own_points": sum(space.points for space in spaces),
            "most_states": max(1, *(space.states for space in spaces), 1),
            "most_points": max(1, *(space.points for space in spaces), 1),
            "most_joined": max(joint.space.points for joint in self._joints),
            "terms": self._terms,
            "widest": self._widest,
            "panel": long,
            "panel_low": real.nearest(plan.panel - rational(long)),
            "scale": real.nearest(2 / plan.panel),
            "fastest": real.nearest(rational(self._fastest)),
            "tolerance": real.nearest(rational(tolerance)),
            "shortest": real.nearest(_SHORTEST),
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
        """About the size of what a stream remembers: the rings of waves."""
        return self._real.bytes * sum(self._slots) * (self._degree + 1)

    @property
    def panel_operations(self) -> int:
        """Multiplications with addition when a panel begins and ends: all joints, and what loads did."""
        size, total = self._degree + 1, 0
        for n, joint in enumerate(self._joints):
            space = joint.space
            wide = space.points * size + space.states
            total += wide * (wide + space.points) if space.states else size * len(space.ports) ** 2
            total += size * (size * space.points + len(space.ports)) * (n in self._plan.loaded)
        summed = sum(one.summed for output in self._plan.rings.outputs for one in output.heard)
        return total + 2 * 3 * 4 * size * summed

    @property
    def step_operations(self) -> int:
        """About the same for a step within a panel, in as many parts as it may have; all outputs are read once."""
        size, total = self._degree + 1, 0
        parts = 1 + int(nearest(self._plan.panel) * self._fastest)
        for n in self._plan.loaded:
            space = self._joints[n].space
            total += parts * (self._terms + 1) * (space.states + space.points) ** 2
            total += space.points * size * (self._terms + 1)
        for output in self._plan.rings.outputs:
            total += sum((2 * 4 * 3 if one.summed else 3) * size for one in output.heard)
        return total

    @cached_property
    def _slots(self) -> tuple[int, ...]:
        """Of each track: the panels that are on their way, and the current one."""
        count = len(self._plan.rings.panels)
        return tuple(track.steps * count + 1 for track in self._plan.rings.tracks)

    @cached_property
    def _terms(self) -> int:
        """Powers of a time in which nothing changes by more than exp(1): the rest is below rounding."""
        terms = 4
        while 1 / factorial(terms + 1) > nearest(self._real.roundoff) / 2:
            terms += 1
        return terms

    @property
    def _fastest(self) -> float:
        return max((self._joints[n].space.norm for n in self._plan.loaded), default=0.0)

    @property
    def _widest(self) -> int:
        size = self._degree + 1
        return max(joint.space.points * size + joint.space.states for joint in self._joints)

    def _own(self) -> dict[int, tuple[int, fmpq]]:
        """The tracks that loaded joints send: number of the point among all loaded ones, and ratio."""
        found, first = {}, 0
        for n in self._plan.loaded:
            joint = self._joints[n]
            for port, track in zip(joint.space.ports, joint.sends, strict=True):
                found[track] = first + port.point, port.ratio
            first += joint.space.points
        return found

    def slips(self, joint: MarchedJoint) -> list[float]:
        """What the polynomials of a joint miss, as velocities of its points, from what its matrix takes."""
        if not joint.space.states:
            return []
        missed = self._rings.missed(joint, self._plan.panel)
        weights = np.array([[sqrt(nearest(weight))] for weight in joint.space.weights])
        shown = np.array([[nearest(v) for v in row] for row in joint.space.shown.tolist()])
        rows = CAUTION * shown @ (missed / weights)
        return [float(f"{value:.3g}") for value in rows.ravel().tolist()]

    def _rounded(self, values: Iterable[float]) -> tuple[float, ...]:
        return tuple(self._real.nearest(rational(value)) for value in values)
