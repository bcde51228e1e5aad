"""The joints of a chain on a window, and their derivatives: what templates/c/joints/march.c does.

With s what acts on the points of a joint, x' = rates x + pushed s and q = shown x + passed s; an end sends ratio q - a.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.runtime.arrays.cone import Bools, heard_since
from wavesym.programs.runtime.arrays.laws import ArrayLaws
from wavesym.programs.runtime.arrays.motion import ArrayMotion, WindowTried
from wavesym.programs.runtime.arrays.solver import ArraySolver
from wavesym.programs.runtime.arrays.tables import ArrayTables, Ints
from wavesym.programs.runtime.arrays.tracks import ArrayTracks
from wavesym.programs.runtime.engine import Array

_MATRICES = ("rates", "pushed", "shown", "passed")


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
                self.acts = np.maximum(self.acts, self._acting_more(joint, slope, x[0], s[0]))
                dq = _times(joint.matrix(law, "shown"), dx) + _times(joint.matrix(law, "passed"), ds)
                dq += _changed(joint.matrix(slope, "shown"), x) + _changed(joint.matrix(slope, "passed"), s)
                self._send(joint, lanes, window, panel, dq)
                size = np.maximum(size, self._largest(joint, lanes, after, window, panel))
        return WindowTried(missed, size)

    def reached(self) -> NDArray[np.bool_]:
        """See `ArrayMotion`."""
        tables, law = self._tables, self._law
        loads = law["load"][tables.ints("event_load")] != 0
        since = self._since([self._stirred(joint, law, loads) for joint in self._joints])
        found = [heard_since(tables, np.where(law["held"] != 0, -since.max(), since))]
        for lane in range(0 if self._slope is None else len(self._slope["push"])):
            found.append(self._changed_at(lane, since, found[0]))
        return np.array(found)

    def _changed_at(self, lane: int, since: Ints, values: Bools) -> Bools:
        """The same of the derivatives in a lane, where values are sent since these panels, and reach outputs."""
        tables, law, of = self._tables, self._law, {name: each[lane] for name, each in (self._slope or {}).items()}
        load, strength = (tables.ints(f"event_{name}") for name in ("load", "strength"))
        loads = (law["load"][load] != 0) & (of["strength"][strength] != 0)
        loads |= (of["load"][load] != 0) & (law["strength"][strength] != 0)
        begun = []
        for joint in self._joints:
            steps = tables.ints("steps") * tables.sizes["panels"]
            arrives = [since[arrive] + steps[arrive] for _, _, _, arrive, _ in joint.ports]
            moves = np.min([self._stirred(joint, law, law["load"][load] != 0), *arrives], axis=0)
            turned = np.any([np.any(joint.matrix(of, name) != 0, axis=(0, 1)) for name in _MATRICES], axis=0)
            turned |= np.any([of["push"][port] != 0 for port, *_ in joint.ports], axis=0)
            begun.append(np.minimum(self._stirred(joint, of, loads), np.where(turned, moves, self._never)))
        changed = self._since(begun)
        found = heard_since(tables, np.where(of["held"] != 0, -changed.max(), changed))
        weighs = tables.weights(of["gain"]) > 0
        return found | weighs & values

    @property
    def _never(self) -> int:
        return self._tables.sizes["windows"] * self._tables.sizes["panels"]

    def _since(self, begun: list[Ints]) -> Ints:
        """From which panel on something is sent into each track, from when joints have something of their own."""
        tables = self._tables
        since = np.full((len(tables.ints("steps")), begun[0].shape[0]), self._never)
        for joint, own in zip(self._joints, begun, strict=True):
            for port in joint.ports:
                since[port[4]] = own
        for joint in len(self._joints) * self._joints:
            for _, _, _, arrive, _ in joint.ports:
                then = since[arrive] + tables.ints("steps")[arrive] * tables.sizes["panels"]
                for _, _, _, _, send in joint.ports:
                    since[send] = np.minimum(since[send], then)
        return since

    def _stirred(self, joint: _Joint, law: ArrayLaws, loads: Bools) -> Ints:
        """From which panel on, counted through all windows, something moves at a joint, or acts on it: its own. `loads`
        says which events act.
        """
        tables = self._tables
        since = np.full(loads.shape[1], self._never)
        for event in reversed(range(tables.sizes["events"])):
            if tables.ints("event_force")[event] in joint.loads:
                when = tables.ints("event_window")[event] * tables.sizes["panels"] + tables.ints("event_panel")[event]
                since = np.where(loads[event], when, since)
        held = law["held"][[track for port in joint.ports for track in port[3:]]]
        moving = np.any(law["begun"][joint.states] != 0, axis=0) | np.any(held != 0, axis=0)
        return np.where(moving, 0, since)

    def felt(self, slope: ArrayLaws) -> Array:
        """See `ArrayMotion`: in velocities, where a spring is longer by a velocity times a window."""
        law = self._law
        most = np.zeros((len(slope["push"]), law["push"].shape[1]))
        for joint in self._joints:
            points, of = joint.points.stop - joint.points.start, {name: joint.matrix(law, name) for name in _MATRICES}
            slopes = {name: np.abs(joint.matrix(slope, name)) for name in _MATRICES}
            acts, more = np.zeros((points, most.shape[1])), np.zeros((len(most), points, most.shape[1]))
            for port, point, *_ in joint.ports:
                acts[point] += np.abs(law["push"][port])
                more[:, point] += np.abs(slope["push"][:, port])
            length = np.where(self._mass[joint.states], 1.0, self._tables.step)
            pull = np.einsum("lijs,j->lis", slopes["rates"], length) + np.einsum("lijs,js->lis", slopes["pushed"], acts)
            pull += np.einsum("ijs,ljs->lis", np.abs(of["pushed"]), more)
            sums = np.einsum("ijs,ljs->lis", np.abs(of["shown"]), pull * self._felt_for(joint))
            sums += np.einsum("lijs,j->lis", slopes["shown"], length)
            sums += np.einsum("lijs,js->lis", slopes["passed"], acts)
            sums += np.einsum("ijs,ljs->lis", np.abs(of["passed"]), more)
            most = np.maximum(most, np.max(sums, axis=1, initial=0.0))
        return most

    def _felt_for(self, joint: _Joint) -> Array:
        """For how long what acts on states is felt on a window: (states, sets). A mass in a dashpot or between bars
        forgets it before long.
        """
        own = np.abs(np.einsum("iis->is", joint.matrix(self._law, "rates")))
        found: Array = 1 / np.maximum(own, 1 / self._tables.step)
        return found

    def _acting_more(self, joint: _Joint, slope: ArrayLaws, x: Array, s: Array) -> Array:
        """The largest of what acts on derivatives of a joint as its laws change, before it cancels."""
        sums = np.einsum("lijs,js->lis", np.abs(joint.matrix(slope, "rates")), np.abs(x))
        sums += np.einsum("lijs,js->lis", np.abs(joint.matrix(slope, "pushed")), np.abs(s))
        found: Array = np.max(sums * self._felt_for(joint), axis=1, initial=0.0)
        return found

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
