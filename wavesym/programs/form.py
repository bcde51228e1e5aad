"""A form: what one evaluator makes of a model, with its bounds, its program, and reference values for a self-test."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

from flint import fmpq

from wavesym.exact.reference import Reference, beginning
from wavesym.mechanics.model import Model
from wavesym.numbers.reals import Real
from wavesym.programs.program import BoundedOutputs, Program, Provenance, ReferenceValues, SteppedValues
from wavesym.programs.tables import Tables

_MOST_POINTS = 2000
_MOST_VALUES = 40_000


def reference_values(model: Model, real: Real, check_points: Sequence[float]) -> ReferenceValues:
    """The outputs of a model at some of its check points.

    Args:
        model: with the loads and parameters that are tested.
        real: the numbers of the program.
        check_points: tau, ascending. On very long horizons they cover only the beginning.
    """
    reference = Reference(beginning(model), real)
    most = max(10, min(_MOST_POINTS, _MOST_VALUES // len(model.probes)))
    taus = [tau for tau in check_points if tau <= reference.tau_max]
    if (step := -(-len(taus) // most)) > 1:  # no more than a self-test should carry, spread evenly
        taus = [*taus[::step], taus[-1]]
    return ReferenceValues(tuple(taus), tuple(map(tuple, reference.values(taus))))


def leap(k: int, j: int) -> fmpq:
    """Numbers from -1 to 1 that differ much from one sample k to the next, and from load j to load."""
    return fmpq((7 * k * k + 3 * k + 5 * j) % 17 - 8, 8)


class Form(BoundedOutputs, ABC):
    """Outputs of a model on [0, tau_max] in `real` numbers, whatever their bounds; `KERNEL` runs its tables."""

    KERNEL: ClassVar[str]
    real: Real
    tau_max: float

    @property
    @abstractmethod
    def tables(self) -> Tables:
        """The numbers of its program, flat, by name."""

    @property
    @abstractmethod
    def constants(self) -> dict[str, float]:
        """Its single numbers."""

    @property
    @abstractmethod
    def bytes(self) -> int:
        """The size of the tables that grow, in C."""

    @property
    @abstractmethod
    def work(self) -> float:
        """About how many operations a value takes."""

    @property
    @abstractmethod
    def summary(self) -> str:
        """What it is, in a few words."""

    @abstractmethod
    def shortfall(self, tolerance: fmpq) -> str:
        """Why it does not meet a tolerance."""

    @property
    def check_points(self) -> list[float]:
        """Where a self-test looks, ascending."""
        return [0.0]

    def program(self, provenance: Provenance, **more: Any) -> Program:
        """Its program; `more` are fields that not all have."""
        numbers = self.tables, self.constants, self.bytes
        return Program(self.KERNEL, self.real, self.tau_max, self.outputs, *numbers, provenance, **more)

    def reference(self, model: Model) -> ReferenceValues | SteppedValues:
        """What is right, for a self-test."""
        return reference_values(model, self.real, self.check_points)
