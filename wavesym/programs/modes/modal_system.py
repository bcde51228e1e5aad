"""A modal system: oscillators that loads drive, its numbers as tables, and one step of it in balls."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from flint import arb, arb_mat, ctx, fmpq

from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import middle, rational
from wavesym.numbers.reals import Real
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.tables import Tables


@dataclass(frozen=True)
class ModalSystem:
    """Oscillators n with loads a_j, all at rest at tau = 0; dimensionless.

        y_n'' + 2 damping_n frequency_n y_n' + frequency_n^2 y_n = sum_j pushes[n, j] a_j(tau)
        output_o = sum_n (displacement_weights[o, n] y_n + velocity_weights[o, n] y_n')
                 + sum_j sum_k direct[o, j, k] I^k a_j

    I^k is the k-th integral from tau = 0, k = 0, 1, 2. `frequency` (modes,), `damping` (modes,), `pushes` (modes,
    loads), `displacement_weights` and `velocity_weights` (outputs, modes), `direct` (outputs, loads, 3). A frequency
    may be 0.
    """

    frequency: Array
    damping: Array
    pushes: Array
    displacement_weights: Array
    velocity_weights: Array
    direct: Array

    def drop_outputs(self, zero: Sequence[bool]) -> ModalSystem:
        """The same with some outputs that are 0."""
        kept = ~np.array(zero)[:, None]
        return replace(
            self,
            displacement_weights=self.displacement_weights * kept,
            velocity_weights=self.velocity_weights * kept,
            direct=self.direct * kept[:, :, None],
        )


_BITS = 400  # of which cancellation takes at most 3 times those of frequency * spacing


@dataclass(frozen=True)
class ModeStep:
    """A mode after a step: (p11 y + p12 v + force0 one0 + force1 one1, p21 y + p22 v + force0 speed0 + force1 speed1).

    force0 and force1 are what acts at the start and at the end of the step; in between it is linear.
    """

    p11: arb
    p12: arb
    p21: arb
    p22: arb
    one0: arb
    one1: arb
    speed0: arb
    speed1: arb


def mode_step(frequency: float, damping: float, spacing: fmpq) -> ModeStep:
    """The step of one mode, exact but for some hundred bits."""
    w, zeta, h = (arb(rational(value)) for value in (frequency, damping, spacing))
    decay, turning = zeta * w, w * w * (1 - zeta * zeta)
    if turning > 0:
        cosine, sine = (turning.sqrt() * h).cos(), (turning.sqrt() * h).sin() / turning.sqrt()
    elif turning < 0:
        cosine, sine = ((-turning).sqrt() * h).cosh(), ((-turning).sqrt() * h).sinh() / (-turning).sqrt()
    else:
        cosine, sine = arb(1), h
    shrunk = (-decay * h).exp()
    p11, p12, p22 = shrunk * (cosine + decay * sine), shrunk * sine, shrunk * (cosine - decay * sine)
    square = w * w
    constant = (1 - p11) / square if frequency else h * h / 2
    ramp = (h - 2 * decay * constant - p12) / square if frequency else h**3 / 6
    return ModeStep(p11, p12, -square * p12, p22, constant - ramp / h, ramp / h, p12 - constant / h, constant / h)


@dataclass(frozen=True)
class Stepper:
    """A system that is stepped by `spacing`, its loads given at the ends of steps."""

    system: ModalSystem
    spacing: fmpq

    @cached_property
    def steps(self) -> list[ModeStep]:
        """Those of the modes."""
        with ctx.workprec(_BITS):
            pairs = zip(self.system.frequency.tolist(), self.system.damping.tolist(), strict=True)
            return [mode_step(frequency, damping, self.spacing) for frequency, damping in pairs]

    def tables(self) -> dict[str, list[fmpq]]:
        """The numbers of all modes by name; those of loads are load by load."""
        pushes = self.system.pushes.T.tolist()
        with ctx.workprec(_BITS):
            turns = {name: [middle(getattr(s, name)) for s in self.steps] for name in ("p11", "p12", "p21", "p22")}
            forced = {
                name: [middle(getattr(s, name) * p) for row in pushes for s, p in zip(self.steps, row, strict=True)]
                for name in ("one0", "one1", "speed0", "speed1")
            }
        return turns | forced

    def outputs(self, loads: Sequence[Sequence[fmpq]]) -> list[list[arb]]:
        """Each output after each step from rest, loads[k][j] being load j at the end of step k (0 before the first)."""
        with ctx.workprec(_BITS):
            h, system = arb(self.spacing), self.system
            count = len(system.pushes.T)
            y = v = [arb(0)] * len(self.steps)
            pushes = [[arb(p) for p in row] for row in system.pushes.tolist()]
            before, once, twice = ([arb(0)] * count for _ in range(3))
            columns: list[list[arb]] = []
            for row in loads:
                now = [arb(value) for value in row]
                force0, force1 = (
                    [sum((p * a for p, a in zip(push, acting, strict=True)), arb(0)) for push in pushes]
                    for acting in (before, now)
                )
                modes = list(zip(self.steps, y, v, force0, force1, strict=True))
                y = [s.p11 * a + s.p12 * b + s.one0 * f + s.one1 * g for s, a, b, f, g in modes]
                v = [s.p21 * a + s.p22 * b + s.speed0 * f + s.speed1 * g for s, a, b, f, g in modes]
                ends = list(zip(before, now, once, twice, strict=True))
                twice = [t + h * o + h * h * (2 * a + b) / 6 for a, b, o, t in ends]
                once = [o + h * (a + b) / 2 for a, b, o, _ in ends]
                columns.append([*y, *v, *(part for load in zip(now, once, twice, strict=True) for part in load)])
                before = now
            weights = [
                [*moved, *moving, *(part for load in direct for part in load)]
                for moved, moving, direct in zip(
                    *(_rows(each) for each in (system.displacement_weights, system.velocity_weights, system.direct)),
                    strict=True,
                )
            ]
            made = arb_mat(weights) * arb_mat(columns).transpose()
            return [[made[o, k] for k in range(len(loads))] for o in range(len(weights))]


def _rows(values: Array) -> list[list[object]]:
    rows: list[list[object]] = values.tolist()
    return rows


LANES = 8
"""Modes and outputs of a stream come in groups of so many, the last one filled up with zeros."""


def scheme_tables(system: ModalSystem, loads: LinearLoads, real: Real) -> Tables:
    """What schemes/modes.py reads."""
    lengths, kind = loads.distinct
    return {
        "frequency": _as(real, system.frequency),
        "damping": _as(real, system.damping),
        "push": _as(real, system.pushes),
        "moved": _as(real, system.displacement_weights),
        "moving": _as(real, system.velocity_weights),
        "direct": _as(real, system.direct),
        "time": real.table(loads.times),
        "length": real.table(lengths),
        "kind": kind,
        "sample": tuple(real.nearest(value) for row in loads.samples for value in row),
        "slope": real.table(loads.slopes),
    }


def stream_tables(stepper: Stepper, real: Real) -> Tables:
    """What templates/c/modes/modes.c reads.

    Of each mode the matrix of a step; of each load for each mode what it does where the step begins and ends. The
    outputs that displacements count in are moved_row[0 ...], with `moved_weight`: LANES of them, mode by mode, then the
    next; so those that velocities count in. What loads and their integrals count is `load_weight`.
    """
    system = stepper.system
    modes, filled = len(system.frequency), padded_count(len(system.frequency))
    made: Tables = {}
    for name, values in stepper.tables().items():
        rows = [values[first : first + modes] for first in range(0, len(values), modes)]
        made[name] = tuple(x for row in rows for x in [*map(real.nearest, row), *[0.0] * (filled - modes)])
    for name, weights in (("moved", system.displacement_weights), ("moving", system.velocity_weights)):
        used = rows_used(weights)
        lanes = np.zeros((padded_count(len(used)), filled))
        lanes[: len(used), :modes] = weights[used]
        made[f"{name}_row"] = tuple(used)
        made[f"{name}_weight"] = _as(real, lanes.reshape(-1, LANES, filled).transpose(0, 2, 1))
    return made | {"load_weight": _as(real, system.direct)}


def rows_used(weights: Array) -> list[int]:
    """The outputs that some mode counts in."""
    rows: list[int] = np.flatnonzero(weights.any(axis=1)).tolist()
    return rows


def padded_count(count: int) -> int:
    """The next multiple of LANES."""
    return -(-count // LANES) * LANES


def _as(real: Real, values: Array) -> tuple[float, ...]:
    rounded: Iterable[float] = values.astype(f"f{real.bytes}").astype(np.float64).ravel().tolist()
    return tuple(rounded)
