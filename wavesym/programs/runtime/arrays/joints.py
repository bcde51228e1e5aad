"""The joints of a chain on a window, and their derivatives: what templates/c/joints/march.c does.

With s what acts on the points of a joint, x' = rates x + pushed s and q = shown x + passed s; an end sends ratio q - a.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.runtime.arrays.cone import heard_since
from wavesym.programs.runtime.arrays.laws import ArrayLaws
from wavesym.programs.runtime.arrays.motion import ArrayMotion, WindowTried
from wavesym.programs.runtime.arrays.solver import ArraySolver
from wavesym.programs.runtime.arrays.tables import ArrayTables, Ints
from wavesym.programs.runtime.arrays.tracks import ArrayTracks
from wavesym.programs.runtime.engine import Array


@dataclass(frozen=True)
class _Joint:
    """Where what belongs to a joint is in the tables."""

    tables: ArrayTables
    number: int

    def _range(self, name: str) -> slice:
        first = self.tables.ints(name)
        return slice(int(first[self.number]), int(first[self.number + 1]))

    @cached_property
    def points(self) -> slice:
        return self._range("first_point")

    @cached_property
    def states(self) -> slice:
        return self._range("first_state")

    @cached_property
    def ports(self) -> list[tuple[int, int, float, int, int]]:
        """Of each end its number, its point, how fast that makes it, the track that arrives and that it sends."""
        ports = self._range("first_port")
        names = ("point_of", "arrive", "send")
        point, arrive, send = (self.tables.ints(name)[ports].tolist() for name in names)
        ratio = self.tables["ratio"][ports].tolist()
        return list(zip(range(ports.start, ports.stop), point, ratio, arrive, send, strict=True))

    @cached_property
    def loads(self) -> list[int]:
        found: list[int] = self.tables.ints("force_on")[self.points].tolist()
        return found

    def matrix(self, law: ArrayLaws, name: str) -> Array:
        """Of the laws or of their derivatives: (..., rows, columns, sets)."""
        states, points = (part.stop - part.start for part in (self.states, self.points))
        shape = {
            "rates": (states, states),
            "pushed": (states, points),
            "shown": (points, states),
            "passed": (points, points),
        }
        values = law[name][..., self._range(f"at_{name}"), :]
        return values.reshape(*values.shape[:-2], *shape[name], values.shape[-1])


class ArrayJoints(ArrayMotion[ArrayTracks]):
    """One joint after the other, of all sets."""

    def __init__(self, tables: ArrayTables, law: ArrayLaws, slope: ArrayLaws | None) -> None:
        super().__init__(tables, law, slope, ArrayTracks)
        self._joints = [_Joint(tables, number) for number in range(tables.sizes["joints"])]
        self._mass = tables.ints("is_mass") > 0

    @staticmethod
    def serves(tables: ArrayTables, law: ArrayLaws) -> NDArray[np.bool_]:
        """All."""
        return np.ones(law["push"].shape[1], bool) & (tables.outputs > 0)

    def tabulate(self) -> None:
        """See `ArrayMotion`."""
        self._solvers = [
            [ArraySolver(joint.matrix(self._law, "rates"), half, self.value.degree) for joint in self._joints]
            for half in self._tables["half_length"].tolist()
        ]

    def lengthen(self, degree: int) -> None:
        """See `ArrayMotion`."""
        self.value.lengthen(degree)
        self.tabulate()

    def tried(self, window: int) -> WindowTried:
        """See `ArrayMotion`."""
        law, value = self._law, self.value
        missed, size = np.zeros((2, law["push"].shape[1]))
        self._after = value.state.copy()
        self._moved: dict[tuple[int, int], tuple[Array, Array]] = {}
        for panel, solvers in enumerate(self._solvers):
            for joint, solver in zip(self._joints, solvers, strict=True):
                s = self._acting(joint, value, law, window, panel)
                value.push(s[:-1], panel, joint.loads)
                f = _times(joint.matrix(law, "pushed"), s)
                x, self._after[joint.states] = solver.moved(f, self._after[joint.states])
                q = _times(joint.matrix(law, "shown"), x) + _times(joint.matrix(law, "passed"), s)
                missed += solver.missed(f, x, self._mass[joint.states])
                self._send(joint, value, window, panel, q)
                self._moved[panel, joint.number] = s, x
                size = np.maximum(size, self._largest(joint, value, self._after, window, panel))
        return WindowTried(missed, size)

    def settled(self) -> None:
        """See `ArrayMotion`."""
        self.value.state = self._after
        if self._lanes is not None:
            self._lanes.state = self._lanes_after

    def followed(self, window: int, lanes: ArrayTracks, slope: ArrayLaws) -> WindowTried:
        """See `ArrayMotion`.

        dx' = rates dx + pushed ds + drates x + dpushed s, dq = shown dx + passed ds + dshown x + dpassed s.
        """
        law = self._law
        lanes.lengthen(self.value.degree)
        self._lanes_after = after = lanes.state.copy()
        missed, size = np.zeros((2, after.shape[0], after.shape[2]))
        for panel, solvers in enumerate(self._solvers):
            for joint, solver in zip(self._joints, solvers, strict=True):
                s, x = self._moved[panel, joint.number]
                ds = self._acting(joint, lanes, law, window, panel)
                ds += self._acting(joint, self.value, slope, window, panel)
                lanes.push(ds[:-1], panel, joint.loads)
                f = _times(joint.matrix(law, "pushed"), ds)
                f += _changed(joint.matrix(slope, "pushed"), s) + _changed(joint.matrix(slope, "rates"), x)
                dx, after[:, joint.states] = solver.moved(f, after[:, joint.states])
                missed += solver.missed(f, dx, self._mass[joint.states])
                dq = _times(joint.matrix(law, "shown"), dx) + _times(joint.matrix(law, "passed"), ds)
                dq += _changed(joint.matrix(slope, "shown"), x) + _changed(joint.matrix(slope, "passed"), s)
                self._send(joint, lanes, window, panel, dq)
                size = np.maximum(size, self._largest(joint, lanes, after, window, panel))
        return WindowTried(missed, size)

    def reached(self) -> NDArray[np.bool_]:
        """See `ArrayMotion`."""
        tables, law = self._tables, self._law
        panels = tables.sizes["panels"]
        since = np.full(law["held"].shape, tables.sizes["windows"] * panels)
        for joint in self._joints:
            for port in joint.ports:
                since[port[4]] = self._stirred(joint)
        for joint in len(self._joints) * self._joints:
            for _, _, _, arrive, _ in joint.ports:
                then = since[arrive] + tables.ints("steps")[arrive] * panels
                for _, _, _, _, send in joint.ports:
                    since[send] = np.minimum(since[send], then)
        return heard_since(tables, np.where(law["held"] != 0, -since.max(), since))

    def _stirred(self, joint: _Joint) -> Ints:
        """From which panel on, counted through all windows, something moves at a joint, or acts on it: its own."""
        tables, law = self._tables, self._law
        since = np.full(law["held"].shape[1], tables.sizes["windows"] * tables.sizes["panels"])
        for event in reversed(range(tables.sizes["events"])):
            if tables.ints("event_force")[event] in joint.loads:
                when = tables.ints("event_window")[event] * tables.sizes["panels"] + tables.ints("event_panel")[event]
                since = np.where(law["load"][tables.ints("event_load")[event]] != 0, when, since)
        held = law["held"][[track for port in joint.ports for track in port[3:]]]
        moving = np.any(law["begun"][joint.states] != 0, axis=0) | np.any(held != 0, axis=0)
        return np.where(moving, 0, since)

    def _acting(self, joint: _Joint, of: ArrayTracks, law: ArrayLaws, window: int, panel: int) -> Array:
        """What arriving waves act with on its points: (degree + 2, ..., points, sets), nothing at degree + 1."""
        lanes = law["push"].shape[:-2] or of.state.shape[:-2]
        points = joint.points.stop - joint.points.start
        s = np.zeros((of.degree + 2, *lanes, points, law["push"].shape[-1]))
        for port, point, _, arrive, _ in joint.ports:
            steps = int(self._tables.ints("steps")[arrive])
            wave, push = of.wave(arrive, window, steps, panel), law["push"][..., port, :]
            if wave.ndim < s.ndim - 1:  # a value, times derivatives
                wave = wave[:, None]
            s[:-1, ..., point, :] += push * wave
        return s

    def _largest(self, joint: _Joint, of: ArrayTracks, state: Array, window: int, panel: int) -> Array:
        """The largest velocity, or mean of what it sends."""
        masses = state[..., joint.states, :][..., self._mass[joint.states], :]
        means = [np.abs(of.wave(send, window, 0, panel)[0]) for _, _, _, _, send in joint.ports]
        found: Array = np.maximum(np.max(np.abs(masses), axis=-2, initial=0.0), np.max(means, axis=0, initial=0.0))
        return found

    def _send(self, joint: _Joint, of: ArrayTracks, window: int, panel: int, q: Array) -> None:
        for _, point, ratio, arrive, send in joint.ports:
            steps = int(self._tables.ints("steps")[arrive])
            of.wave(send, window, 0, panel)[:] = ratio * q[:-1, ..., point, :] - of.wave(arrive, window, steps, panel)


def _times(matrix: Array, series: Array) -> Array:
    """Of all sets a matrix times series: (degree, ..., columns, sets) become (degree, ..., rows, sets)."""
    found: Array = np.einsum("ijs,k...js->k...is", matrix, series)
    return found


def _changed(matrix: Array, series: Array) -> Array:
    """Derivatives of a matrix times series of values."""
    found: Array = np.einsum("lijs,kjs->klis", matrix, series)
    return found
