"""Which of a scene's numbers are given at run time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import fmpq

from wavesym.programs.request import POSITIVE
from wavesym.programs.runtime.units import ParameterUnit

NAMES = ("kappa", "inertia", "velocity", "load")


@dataclass(frozen=True)
class RuntimeField:
    """A field of the parameters: its name, what each of its numbers is called, what they are in the scene, in which
    units (those of results, none where a scene has none), and what each is for people.
    """

    name: str
    labels: tuple[str, ...]
    values: tuple[fmpq, ...]
    units: tuple[ParameterUnit, ...]
    told: tuple[str, ...]

    @property
    def positive(self) -> bool:
        """Whether its numbers have to be."""
        return self.name in POSITIVE


def field_of(name: str, numbers: Sequence[tuple[str, fmpq, ParameterUnit]], told: Sequence[str] = ()) -> RuntimeField:
    """A field of numbers, each with its label and unit; `told` says what each is, where labels do not."""
    labels, values, units = zip(*numbers, strict=True)
    sized = tuple(value * unit.size for value, unit in zip(values, units, strict=True))
    return RuntimeField(name, labels, sized, units, tuple(told) or labels)
