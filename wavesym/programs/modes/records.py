"""Histories of modes by matrices: at instants that lie alike in all panels, and of many records through one structure.

A value s after the start of a panel is linear in the states and loads there. What it takes of them depends on s alone,
so that thousands of panels of one length share it, and the functions of every mode are computed once.

Many records are taken in blocks of samples, each block one product of matrices. Values in a block are linear in the
state of the modes where it begins and in the samples of the loads in it. What they take of them is computed once for a
structure, and holds for all blocks of all records. What loads and their integrals do themselves is summed up as it is
in a single run.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import ceil, factorial, isqrt

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.modal_system import ModalSystem, scheme_tables
from wavesym.programs.modes.stepping import SteppedModes
from wavesym.programs.program import Program

_KEPT = 128  # matrices: as many as panels of a few lengths have places


class Panels(SteppedModes):
    """The panels of a program of modes."""

    @classmethod
    def from_program(cls, program: Program) -> Panels:
        """Those of a program in double precision."""
        return cls(program.tables, program.constants, program.tau_max, np.float64)

    def sample(self, step: float) -> tuple[Array, Array]:
        """Instants no more than `step` apart, each panel in an even number of equal parts, and the outputs there."""
        starts = self._time[self._time < self.tau_max]
        last = len(starts) - 1
        lengths = self._length[self._kind[: last + 1]] if len(self._time) > 1 else np.empty(0)
        lengths = np.append(lengths[:last], self.tau_max - starts[-1])  # the last one ends with the horizon
        counts = [2 * ceil(length / (2 * step)) for length in lengths.tolist()]
        edges = np.cumsum([0, *counts])
        taus = np.empty(edges[-1] + 1)
        out = np.empty((self.outputs, edges[-1] + 1))
        kinds, kind = np.unique(lengths, return_inverse=True)
        reads = lru_cache(_KEPT)(lambda s: self.reads(np.array([s]))[0])
        for first in range(0, last + 1, self.BLOCK):
            panels = np.arange(first, min(first + self.BLOCK, last + 1))
            states = self.states(first // self.BLOCK, int(panels[-1])).reshape(len(panels), -1)
            loads = self.load[:, panels].transpose(1, 0, 2).reshape(len(panels), -1)
            for k, length in enumerate(kinds.tolist()):
                chosen = panels[kind[panels] == k]
                if not len(chosen):
                    continue
                count = counts[chosen[0]]
                if len(chosen) == 1:  # shares its matrices with none: the rest, long after the last load
                    at = edges[chosen[0]] + np.arange(count)
                    taus[at] = starts[chosen[0]] + length * np.arange(count) / count
                    out[:, at] = self.evaluate(taus[at])
                    continue
                known = np.hstack([states[chosen - first], loads[chosen - first]])
                for part in range(count):
                    s = length * part / count
                    at = edges[chosen] + part
                    taus[at] = starts[chosen] + s
                    out[:, at] = (known @ reads(s)).T
        taus[-1], out[:, -1] = self.tau_max, self.evaluate(self.tau_max)
        return taus, out

    def turns(self, s: Array) -> tuple[Array, ...]:
        """What modes do in the times s: see `ModesScheme`."""
        return self._mode_functions(s)

    def reads(self, s: Array) -> Array:
        """What outputs take of displacements, velocities, and of each load's slope, value and integrals, s later.

        (times, 2 modes + 4 loads, outputs).
        """
        p11, p12, p21, p22, one, two = (each[:, :, None] for each in self._mode_functions(s))
        moved, moving, push = self._moved, self._moving, self._push
        rows = [p11 * moved + p21 * moving, p12 * moved + p22 * moving]
        for k, (pushed, speed) in enumerate(((two, one), (one, p12))):
            rows.append(push @ (pushed * moved + speed * moving) + self._direct_part(k, s))
        made: Array = np.concatenate([*rows, self._direct_part(2, s), self._direct_part(3, s)], axis=1)
        return made

    def _direct_part(self, part: int, s: Array) -> Array:
        """Of a slope (0), a load (1) or its integrals (2, 3), itself and integrated on: (times, loads, outputs)."""
        orders = ((k, k + 1 - part) for k in range(3))
        parts = [(s**order / factorial(order))[:, None, None] * self._direct[k] for k, order in orders if order >= 0]
        return np.asarray(sum(parts))


_LONGEST = 16  # steps of a block: with more of them products take longer, with fewer what goes block by block
_MOST = 1 << 22  # numbers of a matrix
Places = NDArray[np.intp]


@dataclass(frozen=True)
class RecordResponse:
    """A system under loads whose samples are `spacing` apart in tau, the first of them 0, and straight in between.

    Samples are (records, n, loads). Outputs are known `parts` times a step, from the first instant after the start on.
    """

    system: ModalSystem
    spacing: float
    parts: int = 1

    @cached_property
    def _panels(self) -> Panels:
        """One step, for what it takes of a state and of loads."""
        loads = self.system.pushes.shape[1]
        rest = (fmpq(0),) * loads
        step = LinearLoads((fmpq(0), fmpq(1)), (rest, rest), rest)
        tables = scheme_tables(self.system, step, DOUBLE)
        return Panels(tables, {"loads": loads}, 1.0, np.float64)

    @property
    def _modes(self) -> int:
        return len(self.system.frequency)

    @cached_property
    def steps(self) -> int:
        """Of a block."""
        loads, rows = self.system.pushes.shape[1], 2 * self._modes
        width = (rows + _LONGEST * loads) * self.parts * len(self.system.direct)
        fits: int = min(_MOST // width, isqrt(_MOST // (rows * loads)))
        return max(4, min(_LONGEST, fits))

    @cached_property
    def _step(self) -> tuple[Array, Array]:
        """(2, 2, modes) turns displacement and velocity; (2, 2, loads, modes) is what the load where a step begins, and
        where it ends, adds to both."""
        h = self.spacing
        p11, p12, p21, p22, one, two = (each[0] for each in self._panels.turns(np.array([h])))
        pushes = self.system.pushes.T
        end = np.stack([pushes * two / h, pushes * one / h])
        begin = np.stack([pushes * one, pushes * p12]) - end
        return np.array([[p11, p12], [p21, p22]]), np.stack([begin, end])

    @cached_property
    def _matrices(self) -> tuple[Array, Array]:
        """What the values in a block take of the state at its start and of the samples, (2 modes + (steps + 1) loads,
        outputs * parts * steps), and what the state at its end takes of the samples, ((steps + 1) loads, 2 modes)."""
        count, modes, (turn, push) = self.steps, self._modes, self._step
        loads, outputs = push.shape[2], len(self.system.direct)
        # the state after each step, of one sample that is 1
        states = np.zeros((count + 1, (count + 1) * loads, 2, modes))
        for k in range(count):
            np.einsum("abm,rbm->ram", turn, states[k], out=states[k + 1])
            at = k * loads
            states[k + 1, at : at + loads] += push[0].transpose(1, 0, 2)
            states[k + 1, at + loads : at + 2 * loads] += push[1].transpose(1, 0, 2)
        starts = states[:count].transpose(1, 0, 2, 3).reshape(-1, 2 * modes)
        values = np.empty((2 * modes + states.shape[1], outputs, self.parts, count))
        for part, reads in enumerate(self._panels.reads(self._parts)):
            of_state = reads[: 2 * modes].reshape(2, modes, outputs)
            turned = np.einsum("kabm,amo->bmok", self._powers, of_state)
            values[: 2 * modes, :, part] = turned.reshape(2 * modes, outputs, count)
            values[2 * modes :, :, part] = (starts @ reads[: 2 * modes]).reshape(-1, count, outputs).transpose(0, 2, 1)
            slope, value = reads[2 * modes :][: 2 * loads].reshape(2, loads, outputs)
            for k in range(count):
                at = 2 * modes + k * loads
                values[at : at + loads, :, part, k] += value - slope / self.spacing
                values[at + loads : at + 2 * loads, :, part, k] += slope / self.spacing
        return values.reshape(len(values), -1), states[count].reshape(-1, 2 * modes)

    @property
    def _parts(self) -> Array:
        """The instants of a step, after its start."""
        return self.spacing * np.arange(1, self.parts + 1) / self.parts

    def block_states(self, samples: Array) -> Array:
        """Displacements and velocities of the modes where blocks begin, and the samples in them: (records, blocks,
        2 modes + (steps + 1) loads)."""
        records, n, loads = samples.shape
        blocks = max(1, -(-(n - 1) // self.steps))
        padded = np.zeros((records, blocks * self.steps + 1, loads))
        padded[:, :n] = samples
        at = np.arange(blocks)[:, None] * self.steps + np.arange(self.steps + 1)
        known = np.zeros((records, blocks, 2 * self._modes + (self.steps + 1) * loads))
        known[:, :, 2 * self._modes :] = padded[:, at].reshape(records, blocks, -1)
        _, ends = self._matrices
        added = (known[:, :, 2 * self._modes :] @ ends).reshape(records, blocks, 2, self._modes)
        last = np.einsum("abm,bcm->acm", self._step[0], self._powers[-1])
        state = np.zeros((records, 2, self._modes))
        for block in range(blocks - 1):
            state = last[:, 0] * state[:, None, 0] + last[:, 1] * state[:, None, 1] + added[:, block]
            known[:, block + 1, : 2 * self._modes] = state.reshape(records, -1)
        return known

    def in_blocks(self, known: Array, samples: Array, room: Array | None = None) -> Array:
        """All outputs: (records, blocks, outputs, parts, steps), also after the last sample; of records `known`.

        They are in `room` where that is given: an array of that many numbers.
        """
        records, blocks, numbers = known.shape
        shape = records, blocks, len(self.system.direct), self.parts, self.steps
        matrix = self._matrices[0]
        out = None if room is None else room.reshape(records * blocks, -1)
        made = np.matmul(known.reshape(-1, numbers), matrix, out=out).reshape(shape)
        if self._has_sums:
            self._add_sums(made, samples)
        return made

    def respond(self, samples: Array) -> Array:
        """All outputs in the order of time: (records, instants, outputs)."""
        records, n, _ = samples.shape
        made = self.in_blocks(self.block_states(samples), samples)
        instants = made.transpose(0, 1, 4, 3, 2).reshape(records, -1, len(self.system.direct))
        return instants[:, : (n - 1) * self.parts]

    @property
    def _has_sums(self) -> bool:
        """Whether integrals of loads count in outputs."""
        return bool(self.system.direct[:, :, 1:].any())

    def _integrals(self, samples: Array) -> Array:
        """The two integrals of loads at the samples: (2, records, n, loads)."""
        h, now, then = self.spacing, samples[:, :-1], samples[:, 1:]
        made = np.zeros((2, *samples.shape))
        made[0, :, 1:] = np.cumsum(h * (now + then) / 2, axis=1)
        made[1, :, 1:] = np.cumsum(h * made[0, :, :-1] + h * h * (2 * now + then) / 6, axis=1)
        return made

    def _add_sums(self, values: Array, samples: Array) -> None:
        """Add to values in blocks what the integrals up to the start of a step count in them."""
        records, n, loads = samples.shape
        padded = np.zeros((2, records, values.shape[1] * self.steps, loads))
        padded[:, :, : n - 1] = self._integrals(samples)[:, :, :-1]
        once, twice = padded.reshape(2, records, -1, self.steps, loads)
        for part, reads in enumerate(self._panels.reads(self._parts)):
            first, second = reads[-2 * loads :].reshape(2, loads, -1)
            values[:, :, :, part] += (once @ first + twice @ second).transpose(0, 1, 3, 2)

    def step_states(self, samples: Array, known: Array, record: Places, step: Places) -> Array:
        """What is known where a `step` of a `record` begins: (cases, 2 modes + 4 loads), to be multiplied with `reads`.

        `known` is that of the samples.
        """
        count, loads, modes = self.steps, samples.shape[2], self._modes
        block, since = step // count, step % count
        # of the samples of the block up to this step the last `count` + 1, those before the block 0
        padded = np.concatenate([np.zeros((len(samples), count, loads)), samples], axis=1)
        window = padded[record[:, None], step[:, None] + np.arange(count + 1)]
        window[np.arange(count + 1) < count - since[:, None]] = 0.0
        first = window[np.arange(len(step)), count - since]
        state = known[record, block, : 2 * modes].reshape(-1, 2, modes)
        moved = np.einsum("cabm,cbm->cam", self._powers[since], state).reshape(len(step), 2 * modes)
        moved += window.reshape(len(step), -1) @ self._matrices[1]
        # the sample with which the block begins ends no step of it
        moved -= np.einsum("cj,ckj->ck", first, self._lead[since])
        now, then = samples[record, step], samples[record, step + 1]
        sums = self._integrals(samples)[:, record, step] if self._has_sums else np.zeros((2, *now.shape))
        return np.hstack([moved, (then - now) / self.spacing, now, *sums])

    def reads(self, s: Array) -> Array:
        """What outputs take of `inside`, the times s after the start of a step: (times, 2 modes + 4 loads, outputs)."""
        return self._panels.reads(s)

    def value_at(self, known: Array, s: Array, output: Places) -> Array:
        """One `output` of each row of `inside`, s after the start of its step: (cases,)."""
        modes, loads, system = self._modes, self.system.pushes.shape[1], self.system
        y, v = known[:, :modes], known[:, modes : 2 * modes]
        slope, value, once, twice = known[:, 2 * modes :].reshape(len(known), 4, loads).transpose(1, 0, 2)
        p11, p12, p21, p22, one, two = self._panels.turns(s)
        start, ramp = value @ system.pushes.T, slope @ system.pushes.T
        made = np.einsum("cm,cm->c", p11 * y + p12 * v + one * start + two * ramp, system.displacement_weights[output])
        made += np.einsum("cm,cm->c", p21 * y + p22 * v + p12 * start + one * ramp, system.velocity_weights[output])
        w = s[:, None]
        load, sum_, double = value + w * slope, value + w / 2 * slope, value + w / 3 * slope
        for k, part in enumerate((load, once + w * sum_, twice + w * (once + w / 2 * double))):
            made += np.einsum("cj,cj->c", part, system.direct[output, :, k])
        return np.asarray(made)

    @cached_property
    def _powers(self) -> Array:
        """What k steps make of a state, for all k of a block: (steps, 2, 2, modes)."""
        turn, _ = self._step
        made = np.zeros((self.steps, 2, 2, self._modes))
        made[0, 0, 0] = made[0, 1, 1] = 1.0
        for k in range(1, self.steps):
            np.einsum("abm,bcm->acm", turn, made[k - 1], out=made[k])
        return made

    @cached_property
    def _lead(self) -> Array:
        """What a sample adds to a step that ends with it, k steps later: (steps, 2 modes, loads)."""
        _, push = self._step
        return np.asarray(np.einsum("kabm,bjm->kamj", self._powers, push[1])).reshape(self.steps, 2 * self._modes, -1)
