"""Many records through one structure: blocks of samples at a time, each block one product of matrices.

Values in a block are linear in the state of the modes where it begins and in the samples of the loads in it. What they
take of them is computed once for a structure, and holds for all blocks of all records. What loads and their integrals
do themselves is summed up as it is in a single run.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import isqrt

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.numbers.reals import DOUBLE
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.modal import ModalSystem, Numbers
from wavesym.programs.modes.panels import Panels
from wavesym.programs.modes.tables import scheme_tables

_LONGEST = 64  # steps of a block
_MOST = 1 << 22  # numbers of a matrix
Places = NDArray[np.intp]


@dataclass(frozen=True)
class RecordValues:
    """What records do, `parts` instants a step, from the first one after the start on: `values` (records, instants,
    outputs); `states` (records, blocks, 2 modes) are displacements and velocities where blocks begin."""

    values: Numbers
    states: Numbers


@dataclass(frozen=True)
class RecordResponse:
    """A system under loads whose samples are `spacing` apart in tau, the first of them 0, and straight in between."""

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
    def _step(self) -> tuple[Numbers, Numbers]:
        """(2, 2, modes) turns displacement and velocity; (2, 2, loads, modes) is what the load where a step begins, and
        where it ends, adds to both."""
        h = self.spacing
        p11, p12, p21, p22, one, two = (each[0] for each in self._panels.turns(np.array([h])))
        pushes = self.system.pushes.T
        end = np.stack([pushes * two / h, pushes * one / h])
        begin = np.stack([pushes * one, pushes * p12]) - end
        return np.array([[p11, p12], [p21, p22]]), np.stack([begin, end])

    @cached_property
    def _matrices(self) -> tuple[Numbers, Numbers]:
        """What the values in a block take of the state at its start and of the samples, (2 modes + (steps + 1) loads,
        steps * parts * outputs), and what the state at its end takes of the samples, ((steps + 1) loads, 2 modes)."""
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
        values = np.empty((2 * modes + states.shape[1], count, self.parts, outputs))
        for part, reads in enumerate(self._panels.reads(self._parts)):
            of_state = reads[: 2 * modes].reshape(2, modes, outputs)
            turned = np.einsum("kabm,amo->bmko", self._powers, of_state)
            values[: 2 * modes, :, part] = turned.reshape(2 * modes, count, outputs)
            values[2 * modes :, :, part] = (starts @ reads[: 2 * modes]).reshape(-1, count, outputs)
            slope, value = reads[2 * modes :][: 2 * loads].reshape(2, loads, outputs)
            for k in range(count):
                at = 2 * modes + k * loads
                values[at : at + loads, k, part] += value - slope / self.spacing
                values[at + loads : at + 2 * loads, k, part] += slope / self.spacing
        return values.reshape(len(values), -1), states[count].reshape(-1, 2 * modes)

    @property
    def _parts(self) -> Numbers:
        """The instants of a step, after its start."""
        return self.spacing * np.arange(1, self.parts + 1) / self.parts

    def respond(self, samples: Numbers) -> RecordValues:
        """All outputs under records whose `samples` are (records, n), or (records, n, loads); n - 1 steps."""
        given = np.asarray(samples, dtype=np.float64)
        given = given.reshape(*given.shape[:2], -1)
        records, n, loads = given.shape
        blocks = max(1, -(-(n - 1) // self.steps))
        padded = np.zeros((records, blocks * self.steps + 1, loads))
        padded[:, :n] = given
        at = np.arange(blocks)[:, None] * self.steps + np.arange(self.steps + 1)
        known = np.zeros((records, blocks, 2 * self._modes + (self.steps + 1) * loads))
        known[:, :, 2 * self._modes :] = padded[:, at].reshape(records, blocks, -1)
        states = known[:, :, : 2 * self._modes]
        values, ends = self._matrices
        added = (known[:, :, 2 * self._modes :] @ ends).reshape(records, blocks, 2, self._modes)
        last = np.einsum("abm,bcm->acm", self._step[0], self._powers[-1])
        state = np.zeros((records, 2, self._modes))
        for block in range(blocks - 1):
            state = np.einsum("abm,rbm->ram", last, state) + added[:, block]
            states[:, block + 1] = state.reshape(records, -1)
        made = (known.reshape(records * blocks, -1) @ values).reshape(records, -1, len(self.system.direct))
        made = made[:, : (n - 1) * self.parts]
        if self._summing:
            made += self._sums(given)
        return RecordValues(made, states.copy())

    @property
    def _summing(self) -> bool:
        """Whether integrals of loads count in outputs."""
        return bool(self.system.direct[:, :, 1:].any())

    def _integrals(self, samples: Numbers) -> Numbers:
        """The two integrals of loads at the samples: (2, records, n, loads)."""
        h, now, then = self.spacing, samples[:, :-1], samples[:, 1:]
        made = np.zeros((2, *samples.shape))
        made[0, :, 1:] = np.cumsum(h * (now + then) / 2, axis=1)
        made[1, :, 1:] = np.cumsum(h * made[0, :, :-1] + h * h * (2 * now + then) / 6, axis=1)
        return made

    def _sums(self, samples: Numbers) -> Numbers:
        """What the integrals up to the start of its step count in each value: (records, instants, outputs)."""
        once, twice = self._integrals(samples)[:, :, :-1]
        records, steps, loads = once.shape
        made = np.empty((records, steps, self.parts, len(self.system.direct)))
        for part, reads in enumerate(self._panels.reads(self._parts)):
            first, second = reads[-2 * loads :].reshape(2, loads, -1)
            made[:, :, part] = once @ first + twice @ second
        return made.reshape(records, steps * self.parts, -1)

    def inside(self, samples: Numbers, states: Numbers, record: Places, step: Places) -> Numbers:
        """What is known where a `step` of a `record` begins: (cases, 2 modes + 4 loads), to be multiplied with `reads`.

        `samples` are (records, n, loads), `states` those of `respond`.
        """
        count, loads, modes = self.steps, samples.shape[2], self._modes
        block, since = step // count, step % count
        # of the samples of the block up to this step the last `count` + 1, those before the block 0
        padded = np.concatenate([np.zeros((len(samples), count, loads)), samples], axis=1)
        window = padded[record[:, None], step[:, None] + np.arange(count + 1)]
        window[np.arange(count + 1) < count - since[:, None]] = 0.0
        first = window[np.arange(len(step)), count - since]
        state = states[record, block].reshape(-1, 2, modes)
        known = np.einsum("cabm,cbm->cam", self._powers[since], state).reshape(len(step), 2 * modes)
        known += window.reshape(len(step), -1) @ self._matrices[1]
        # the sample with which the block begins ends no step of it
        known -= np.einsum("cj,ckj->ck", first, self._lead[since])
        now, then = samples[record, step], samples[record, step + 1]
        sums = self._integrals(samples)[:, record, step] if self._summing else np.zeros((2, *now.shape))
        return np.hstack([known, (then - now) / self.spacing, now, *sums])

    def reads(self, s: Numbers) -> Numbers:
        """What outputs take of `inside`, the times s after the start of a step: (times, 2 modes + 4 loads, outputs)."""
        return self._panels.reads(s)

    def at(self, known: Numbers, s: Numbers, output: Places) -> Numbers:
        """One `output` of each row of `inside`, s after the start of its step: (cases,)."""
        modes, loads, system = self._modes, self.system.pushes.shape[1], self.system
        y, v = known[:, :modes], known[:, modes : 2 * modes]
        slope, value, once, twice = known[:, 2 * modes :].reshape(len(known), 4, loads).transpose(1, 0, 2)
        p11, p12, p21, p22, one, two = self._panels.turns(s)
        start, ramp = value @ system.pushes.T, slope @ system.pushes.T
        made = np.einsum("cm,cm->c", p11 * y + p12 * v + one * start + two * ramp, system.moved[output])
        made += np.einsum("cm,cm->c", p21 * y + p22 * v + p12 * start + one * ramp, system.moving[output])
        w = s[:, None]
        load, sum_, double = value + w * slope, value + w / 2 * slope, value + w / 3 * slope
        for k, part in enumerate((load, once + w * sum_, twice + w * (once + w / 2 * double))):
            made += np.einsum("cj,cj->c", part, system.direct[output, :, k])
        return np.asarray(made)

    @cached_property
    def _powers(self) -> Numbers:
        """What k steps make of a state, for all k of a block: (steps, 2, 2, modes)."""
        turn, _ = self._step
        made = np.zeros((self.steps, 2, 2, self._modes))
        made[0, 0, 0] = made[0, 1, 1] = 1.0
        for k in range(1, self.steps):
            np.einsum("abm,bcm->acm", turn, made[k - 1], out=made[k])
        return made

    @cached_property
    def _lead(self) -> Numbers:
        """What a sample adds to a step that ends with it, k steps later: (steps, 2 modes, loads)."""
        _, push = self._step
        return np.asarray(np.einsum("kabm,bjm->kamj", self._powers, push[1])).reshape(self.steps, 2 * self._modes, -1)
