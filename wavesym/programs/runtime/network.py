"""A model's network as functions: what a scene says becomes symbols, where it is given at run time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.mechanics.parameters import Factors
from wavesym.numbers.ratio import Ring
from wavesym.programs.request import refuse_others
from wavesym.programs.runtime.quiet import drawn
from wavesym.programs.runtime.request import RuntimeField, field_of
from wavesym.programs.runtime.units import unit_of, unit_of_load


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


def free_network(model: Model, names: Sequence[str], amplitudes: Sequence[tuple[str, Applied]]) -> FreeNetwork:
    """The fields that `names` ask for, in the order of the scene: points, then rods, then what links points; those of
    a named system are its own.

    UnservedError for what is not served, WavesymError for a name that the scene does not have.
    """
    network, parameters = model.network, model.parameters
    network.refuse_contacts()
    model.refuse_damping()
    for point in network.points:
        if point.motion is not None and point.velocity != 0:
            raise UnservedError(f"--runtime: the end at {point.place} moves at tau = 0, one at rest expected")
    loaded = amplitudes or any(load.source != "impact" for load in model.loads)
    refuse_others("--runtime", names, [*parameters.numbers, *(["load"] if loaded else [])])
    fields: list[RuntimeField] = []
    sizes: dict[str, fmpq] = {}
    for name, numbers in parameters.numbers.items():
        if name in names:
            unit = unit_of(model, name)
            sizes |= {one.label: unit.size for one in numbers}
            about = [one.about for one in numbers]
            fields.append(field_of(name, [(one.label, one.value, unit) for one in numbers], about))
    if "load" in names:
        fields.append(field_of("load", [(about, load.weight, unit_of_load(model, load)) for about, load in amplitudes]))
    ring = Ring(tuple(sizes))
    free, some = (
        {label: values[label] / size for label, size in sizes.items()} for values in (ring.symbols(), drawn(fields))
    )
    return FreeNetwork(
        tuple(fields),
        ring,
        parameters.network(free),
        replace(model, network=parameters.network(some), preset=None),
        parameters.factors(free) if model.clock else Factors(),
    )
