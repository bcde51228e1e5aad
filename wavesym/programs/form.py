"""A form: what one evaluator makes of a model, with its bounds, and the program of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

from flint import fmpq

from wavesym.mechanics.model import Model
from wavesym.numbers.reals import Real
from wavesym.programs.program import BoundedOutputs, Program, Provenance, ReferenceValues, SteppedValues
from wavesym.programs.reference_values import reference_values


class Form(BoundedOutputs, ABC):
    """Outputs of a model on [0, tau_max] in `real` numbers, whatever their bounds; `KERNEL` runs its tables."""

    KERNEL: ClassVar[str]
    real: Real
    tau_max: float

    @property
    @abstractmethod
    def tables(self) -> dict[str, tuple[float, ...]]:
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
