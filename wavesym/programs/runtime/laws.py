"""What a program of parameters at run time has beside its tables: the parameters, and what they make of a chain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from wavesym.numbers.ratio import Ratio
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

    @cached_property
    def slopes(self) -> tuple[tuple[int, str, int, Ratio], ...]:
        """Derivatives that are not 0: the number of the parameter, the name and the place of the function, and it."""
        return tuple(
            (lane, name, k, slope)
            for lane, label in enumerate(self.places)
            for name, functions in self.functions.items()
            for k, function in enumerate(functions)
            if isinstance(function, Ratio) and label in function.ring.names
            for slope in [function.derivative(label)]
            if slope != 0
        )

    @property
    def every(self) -> tuple[Ratio, ...]:
        """All functions but constants."""
        return tuple(one for functions in self.functions.values() for one in functions if isinstance(one, Ratio))

    @property
    def every_slope(self) -> tuple[Ratio, ...]:
        """All derivatives."""
        return tuple(slope for *_, slope in self.slopes)

    @property
    def positive(self) -> frozenset[str]:
        """The symbols of numbers that have to be."""
        return frozenset(label for field in self.fields if field.positive for label in field.labels)
