"""A model's network as functions: what a scene says becomes symbols, where it is given at run time.

kappa is a ratio of masses. Loads and velocities are given in the units of results, inertias and the numbers of a
chain's parts in SI base units. In collisions and buildings rods stay, so that kappa changes bodies; in a drive discs
have inertias of their own, so that kappa changes shafts. The time that a wave takes through a rod stays everywhere, and
so does a load: 5 N*m are 5 N*m.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.loads import AppliedLoad, AppliedRecord
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.mechanics.parameters import Factors, ModelParameter
from wavesym.numbers.ratio import Ring
from wavesym.programs.request import OF_MODES, POSITIVE, refuse_others, why_constant

NAMES = ("kappa", "inertia", "velocity", "load")


@dataclass(frozen=True)
class ParameterUnit:
    """`size` is what a dimensionless 1 is in the unit."""

    size: fmpq
    text: str


PLAIN = ParameterUnit(fmpq(1), "")


@dataclass(frozen=True)
class RuntimeField:
    """A field of the parameters: its name, what each of its numbers is called, what they are in the scene, in which
    units (those of results, none where a scene has none), and what each is for people.
    """

    name: str
    labels: tuple[str, ...]
    values: tuple[fmpq, ...]
    units: tuple[ParameterUnit, ...]
    captions: tuple[str, ...]

    @property
    def positive(self) -> bool:
        """Whether its numbers have to be."""
        return self.name in POSITIVE


@dataclass(frozen=True)
class FreeNetwork:
    """`network` has functions of the ring's symbols, `fields` their numbers; `some` is the model with numbers
    drawn.

    Loads act `factors.load` times as much, and forces that are read are `factors.force` times as large, as the network
    says.
    """

    fields: tuple[RuntimeField, ...]
    ring: Ring
    network: Network
    some: Model
    factors: Factors


def free_network(model: Model, names: Sequence[str], amplitudes: Sequence[tuple[str, AppliedLoad]]) -> FreeNetwork:
    """The fields that `names` ask for, in the order of the scene: points, then rods, then what links points; those of
    a named system are its own.

    UnservedError for what is not served, WavesymError for a name that the scene does not have.
    """
    network, parameters = model.network, model.parameters
    network.refuse_corners()
    network.refuse_dead_loads()
    for name in OF_MODES.keys() & names:
        raise UnservedError(
            f"--runtime: {name} {OF_MODES[name]}, which no march supports (modes do: write --evaluator modes)"
        )
    if model.damping is not None:
        raise UnservedError("system.damping: supported by modes only (write --evaluator modes, or auto)")
    for point in network.points:
        if point.motion is not None and point.velocity != 0:
            raise UnservedError(
                f"--runtime: the end at {point.place} moves at tau = 0, which is not supported; write one at rest"
            )
    fields = runtime_fields(model, names, parameters.numbers, unit_of, amplitudes)
    sizes = {
        label: unit.size
        for field in fields
        for label, unit in zip(field.labels, field.units, strict=True)
        if field.name != "load"
    }
    ring = Ring(tuple(sizes))
    free, some = (
        {label: values[label] / size for label, size in sizes.items()}
        for values in (ring.symbols(), {label: drawn_number(label) for field in fields for label in field.labels})
    )
    return FreeNetwork(
        fields,
        ring,
        parameters.network(free),
        replace(model, network=parameters.network(some), preset=None),
        parameters.factors(free) if model.clock else Factors(),
    )


def runtime_fields(
    model: Model,
    names: Sequence[str],
    numbers: Mapping[str, Sequence[ModelParameter]],
    unit: Callable[[Model, str], ParameterUnit],
    amplitudes: Sequence[tuple[str, AppliedLoad]],
) -> tuple[RuntimeField, ...]:
    """The fields that are requested, in the order of the scene.

    Args:
        names: of fields.
        numbers: all that can be given, dimensionless, by the name of their field.
        unit: that of a field.
        amplitudes: those of loads, each with what it is called.

    Raises:
        WavesymError: for a name that is none of these, and one that stands twice.
    """
    loaded = amplitudes or any(load.source != "impact" for load in model.loads)
    refuse_others("--runtime", names, [*numbers, *(["load"] if loaded else [])], why_constant)
    chosen = {
        name: [(each.label, each.value, unit(model, name), each.about) for each in every]
        for name, every in numbers.items()
        if name in names
    }
    if "load" in names:
        chosen["load"] = [(about, load.weight, unit_of_load(model, load), about) for about, load in amplitudes]
    fields = []
    for name, rows in chosen.items():
        labels, values, units, captions = zip(*rows, strict=True)
        sized = tuple(value * each.size for value, each in zip(values, units, strict=True))
        fields.append(RuntimeField(name, labels, sized, units, captions))
    return tuple(fields)


def unit_of(model: Model, name: str) -> ParameterUnit:
    """That of the numbers of a field other than `load`."""
    return ParameterUnit(*model.inputs[name]) if name in model.inputs else PLAIN


def unit_of_load(model: Model, load: AppliedLoad) -> ParameterUnit:
    """That of an amplitude: of a step, or of a ramp per unit of time; the factor of a record has none."""
    if model.clock is None or isinstance(load, AppliedRecord):
        return PLAIN
    size, text = model.inputs[load.source]
    unit = next(unit for point in model.network.points for unit in point.loads if unit.source == load.source)
    if not unit.is_ramp:
        return ParameterUnit(size, text)
    return ParameterUnit(size / model.clock.per_tau, f"{text}/{model.clock.unit}")


def drawn_number(label: str) -> fmpq:
    """A positive number that depends on a label alone: what is 0 with it is 0 with all, but for a chance of 2**-60."""
    return fmpq(int(sha256(label.encode()).hexdigest()[:16], 16) + 1, 1 << 62)
