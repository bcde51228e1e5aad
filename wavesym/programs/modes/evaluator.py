"""Modes as an evaluator: any spacing and horizon of loads that do not jump, with damping or without."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from flint import fmpq

from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import midpoint, nearest, rational, relative
from wavesym.numbers.reals import Real
from wavesym.programs.form import Form, leap
from wavesym.programs.modes.complex_modes import ComplexModes
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.modal_system import (
    LANES,
    ModalSystem,
    Stepper,
    padded_count,
    rows_used,
    scheme_tables,
    stream_tables,
)
from wavesym.programs.modes.rounding import RoundingErrors, rounding_errors
from wavesym.programs.modes.stepping import SteppedModes
from wavesym.programs.modes.truncation import ModalModel, ModalModes, truncate
from wavesym.programs.modes.undamped_modes import UndampedModes
from wavesym.programs.program import Input, Program, ProgramOutput, Provenance, SteppedRow, SteppedValues
from wavesym.programs.tables import Tables

_CHECKED = 40  # samples of a self-test
_ULPS = 8  # by which a step may differ from the spacing


@dataclass(frozen=True)
class ModesEvaluator(Form):
    """A modal system under loads, stepped exactly in `real` numbers; a stream takes steps of `spacing`.

    A stream takes the loads as `inputs`, in units of their own.
    """

    KERNEL = "modes"

    system: ModalSystem
    loads: LinearLoads
    spacing: fmpq
    real: Real
    tau_max: float
    inputs: tuple[Input, ...]
    outputs: tuple[ProgramOutput, ...] = ()

    @cached_property
    def scheme(self) -> SteppedModes:
        """Its values in NumPy."""
        tables = scheme_tables(self.system, self.loads, self.real)
        return SteppedModes(tables, self.constants, self.tau_max, np.dtype(f"f{self.real.bytes}").type)

    @cached_property
    def rounding(self) -> RoundingErrors:
        """What rounding does to the values, and how large they are."""
        return rounding_errors(self.system, self.loads, self.scheme, self.tau_max, self.real)

    @cached_property
    def _stepper(self) -> Stepper:
        """The system under loads in units of their own."""
        sizes = np.array([nearest(given.size) for given in self.inputs])
        system = replace(self.system, pushes=self.system.pushes / sizes, direct=self.system.direct / sizes[:, None])
        return Stepper(system, self.spacing)

    @cached_property
    def tables(self) -> Tables:
        """The numbers of its program, in NumPy and as a stream."""
        stream = stream_tables(self._stepper, self.real)
        return scheme_tables(self.system, self.loads, self.real) | stream

    @property
    def constants(self) -> dict[str, float]:
        """Its single numbers. A step that is not between the shortest and the longest is refused."""
        spacing = nearest(self.spacing)
        off = _ULPS * 2 * nearest(self.real.roundoff)
        return {
            "loads": len(self.inputs),
            "modes": padded_count(len(self.system.frequency)),
            "lanes": LANES,
            "moved": len(rows_used(self.system.displacement_weights)),
            "moving": len(rows_used(self.system.velocity_weights)),
            "spacing": self.real.nearest(self.spacing),
            "shortest": self.real.nearest(rational(spacing * (1 - off))),
            "longest": self.real.nearest(rational(spacing * (1 + off))),
        }

    @property
    def bytes(self) -> int:
        """The size of the tables of a stream."""
        rows = sum(
            padded_count(len(rows_used(weights)))
            for weights in (self.system.displacement_weights, self.system.velocity_weights)
        )
        numbers = padded_count(len(self.system.frequency)) * (4 + 4 * len(self.inputs) + rows) + self.system.direct.size
        return self.real.bytes * numbers

    @property
    def work(self) -> float:
        """About how many operations a step takes."""
        return 2.0 * self.bytes / self.real.bytes

    @property
    def summary(self) -> str:
        """What it is, in a few words."""
        return f"modes, {len(self.system.frequency)} of them, bound {self.error_bound:g}"

    def shortfall(self, tolerance: fmpq) -> str:
        """Why it does not meet a tolerance."""
        return f"modes: {len(self.system.frequency)} modes leave a bound of {self.worst.bound:g} for {self.worst.name}"

    def program(self, provenance: Provenance, **more: Any) -> Program:
        """Its program, in NumPy and as a stream."""
        sources = tuple(given.label for given in self.inputs)
        return super().program(provenance, sources=sources, step="spacing", **more)

    def reference(self, model: Model) -> SteppedValues:
        """For the self-test of a stream: loads up to the largest of the scene's that leap, and what comes of them."""
        largest, sizes = self.loads.largest or fmpq(1), [given.size for given in self.inputs]
        given = [
            tuple(self.real.nearest(size * largest * leap(k, j)) for j, size in enumerate(sizes))
            for k in range(1, _CHECKED + 1)
        ]
        exact = [tuple(map(rational, row)) for row in given]
        plain = [tuple(value / size for value, size in zip(row, sizes, strict=True)) for row in exact]
        rest = (fmpq(0),) * len(sizes)
        times = tuple(self.spacing * k for k in range(_CHECKED + 1))
        loads = LinearLoads(times, (rest, *plain), rest)
        same = replace(self, loads=loads, tau_max=self.real.not_below(times[-1]))
        values = zip(*(map(midpoint, row) for row in self._stepper.outputs(exact)), strict=True)
        step = self.real.nearest(self.spacing)
        return SteppedValues(
            tuple(SteppedRow(step, row, after) for row, after in zip(given, values, strict=True)),
            tuple(same.rounding.errors.tolist()),
        )


def driven_inputs(model: Model, sources: Sequence[tuple[str, str]]) -> tuple[Input, ...]:
    """The loads of a stream, each a pair of a step and a ramp."""
    plain = fmpq(1), ""
    return tuple(
        Input(step or ramp.removesuffix(":ramp"), *model.inputs.get(step or ramp, plain)) for step, ramp in sources
    )


def modal_model(model: Model) -> ModalModel[Any]:
    """A model as modes, until its last double or later: with dashpots these have complex frequencies."""
    model.refuse_polynomials()
    model = model.to_horizon()
    return ComplexModes(model) if model.network.loses else UndampedModes(model)


def modal_system(model: Model) -> ModalModes:
    """The first modes of a model, as many as leave out at most half of its tolerance: see `truncated`."""
    return truncate(modal_model(model))


def modes(model: Model, real: Real) -> ModesEvaluator:
    """The modes of a model, whatever rounding does to them.

    Args:
        model: dimensionless, at rest at tau = 0, with its tolerance.
        real: the numbers of the program.

    Raises:
        UnservedError: for what has no modes, and for loads that jump.
        ToleranceError: where too many modes would be needed.
        OverflowError: where numbers would be beyond those of the format.
    """
    made = modal_system(model.to_horizon(real))
    spacing = made.loads.spacing(model.until, model.spacing)
    inputs = driven_inputs(model, made.sources)
    evaluator = ModesEvaluator(made.system, made.loads, spacing, real, model.horizon(real), inputs)
    totals = made.errors + evaluator.rounding.errors
    outputs = tuple(
        ProgramOutput(probe.name, relative(error, size), size, incidental=probe.incidental)
        for probe, error, size in zip(model.probes, totals.tolist(), made.largest.tolist(), strict=True)
    )
    return replace(evaluator, outputs=outputs)
