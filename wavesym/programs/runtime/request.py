"""Which of a scene's numbers are given at run time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import fmpq

from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.programs.request import refuse_others
from wavesym.programs.runtime.units import ParameterUnit, unit_of, unit_of_load

NAMES = ("kappa", "inertia", "velocity", "load")
POSITIVE = frozenset({"kappa", "inertia", "mass", "dashpot", "spring", "impedance"})


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


def system_fields(
    model: Model, names: Sequence[str], amplitudes: Sequence[tuple[str, Applied]]
) -> tuple[RuntimeField, ...]:
    """The fields that `names` ask for of a named system, in its order.

    `amplitudes` are those of its loads, each with what it is called.

    WavesymError for a name that it does not have.
    """
    chain = model.named
    there = {
        name: tuple(sorted(numbers.items())) for name in NAMES if (numbers := getattr(chain.parameters, name, None))
    }
    known = [*there, *(["load"] if amplitudes or any(load.source != "impact" for load in model.loads) else [])]
    refuse_others("--runtime", names, known)
    found = []
    for name, of in there.items():
        if name in names:
            unit = unit_of(model, name)
            found.append(field_of(name, [(f"{name}_{i}", value, unit) for i, value in of]))
    if "load" in names:
        found.append(field_of("load", [(told, load.weight, unit_of_load(model, load)) for told, load in amplitudes]))
    return tuple(found)


def field_of(name: str, numbers: Sequence[tuple[str, fmpq, ParameterUnit]], told: Sequence[str] = ()) -> RuntimeField:
    """A field of numbers, each with its label and unit; `told` says what each is, where labels do not."""
    labels, values, units = zip(*numbers, strict=True)
    sized = tuple(value * unit.size for value, unit in zip(values, units, strict=True))
    return RuntimeField(name, labels, sized, units, tuple(told) or labels)
