"""What a program of parameters at run time has beside its tables: the parameters, and what they make of a chain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from wavesym.programs.runtime.request import RuntimeField
from wavesym.programs.runtime.units import Function


@dataclass(frozen=True)
class RuntimeLaws:
    """`fields` are the parameters; `functions` of them, by the name of an array, are what a march takes: of nodes
    alpha, beta, rate (0 without inertia) and motion, rods, strengths of loads, gains of waves in outputs.

    `amplitudes` are those of the loads where these are no parameters.
    """

    fields: tuple[RuntimeField, ...]
    functions: Mapping[str, tuple[Function, ...]]
    amplitudes: tuple[float, ...]

    @property
    def places(self) -> Mapping[str, tuple[str, int]]:
        """The field, and the place in it, of every symbol."""
        return {label: (field.name, k) for field in self.fields for k, label in enumerate(field.labels)}
