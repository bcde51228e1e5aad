"""Which of a scene's numbers are given at run time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import fmpq

from wavesym.errors import UnservedError, WavesymError
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.programs.runtime.units import ParameterUnit, unit_of, unit_of_load

NAMES = ("kappa", "inertia", "velocity", "load")
POSITIVE = frozenset({"kappa", "inertia"})


@dataclass(frozen=True)
class RuntimeField:
    """A field of the parameters: its name, what each of its numbers is called, what they are in the scene, and in which
    units: those of results, none where a scene has none.
    """

    name: str
    labels: tuple[str, ...]
    values: tuple[fmpq, ...]
    units: tuple[ParameterUnit, ...]

    @property
    def positive(self) -> bool:
        """Whether its numbers have to be."""
        return self.name in POSITIVE


def fields(model: Model, names: Sequence[str], amplitudes: Sequence[tuple[str, Applied]]) -> tuple[RuntimeField, ...]:
    """The fields that `names` ask for, in the order of the scene; `amplitudes` are those of its loads, each with what
    it is called.

    UnservedError for a scene that a march of named systems does not serve, WavesymError for a name that it does not
    have.
    """
    if model.chain is None:
        raise UnservedError("--runtime: chain given, collision, drive or building expected, contacts closed")
    model.refuse_damping()
    there = {
        name: tuple(sorted(numbers.items()))
        for name in NAMES
        if (numbers := getattr(model.chain.parameters, name, None))
    }
    known = [*there, *(["load"] if amplitudes or any(load.source != "impact" for load in model.loads) else [])]
    for place, name in enumerate(names):
        if name not in known:
            raise WavesymError(f"--runtime: {name or 'nothing'} given, {_one_of(known)} expected")
        if name in names[:place]:
            raise WavesymError(f"--runtime: {name} given twice, once expected")
    found = []
    for name, of in there.items():
        if name in names:
            unit = unit_of(model, name)
            found.append(_field(name, [(f"{name}_{i}", value, unit) for i, value in of]))
    if "load" in names:
        found.append(_field("load", [(told, load.weight, unit_of_load(model, load)) for told, load in amplitudes]))
    return tuple(found)


def _field(name: str, numbers: Sequence[tuple[str, fmpq, ParameterUnit]]) -> RuntimeField:
    values = tuple(value * unit.size for _, value, unit in numbers)
    return RuntimeField(name, tuple(label for label, _, _ in numbers), values, tuple(unit for _, _, unit in numbers))


def _one_of(names: Sequence[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} or {last}" if others else last
