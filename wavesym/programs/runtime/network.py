"""A model's network as functions: what a scene says becomes symbols, where it is given at run time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network, network_of
from wavesym.mechanics.node import Parameters
from wavesym.numbers.ratio import Ring
from wavesym.programs.request import refuse_others
from wavesym.programs.runtime.quiet import drawn
from wavesym.programs.runtime.request import RuntimeField, field_of, system_fields
from wavesym.programs.runtime.units import Function, force_kept, load_kept, unit_of, unit_of_load

_ONE = fmpq(1)

Numbers = dict[tuple[str, int], fmpq]
"""By what has it, a "point", "bar" or "link", and its number."""


@dataclass(frozen=True)
class FreeNetwork:
    """`network` has functions of the ring's symbols, `fields` their numbers; `some` is the model with numbers
    drawn.

    Loads act `load_kept` times as much, and forces that are read are `force_kept` times as large, as the network says.
    """

    fields: tuple[RuntimeField, ...]
    ring: Ring
    network: Network
    some: Model
    load_kept: Function = _ONE
    force_kept: Function = _ONE


def free_network(model: Model, names: Sequence[str], amplitudes: Sequence[tuple[str, Applied]]) -> FreeNetwork:
    """The fields that `names` ask for, in the order of the scene: points, then rods, then what links points; those of
    a named system are its own.

    UnservedError for what is not served, WavesymError for a name that the scene does not have.
    """
    network = model.network
    network.refuse_contacts()
    model.refuse_damping()
    if model.chain is not None:
        return _free_system(model, names, amplitudes)
    for point in network.points:
        if point.motion is not None and point.velocity != 0:
            raise UnservedError(f"--runtime: the end at {point.place} moves at tau = 0, one at rest expected")
    there = {name: numbers for name, of in _KINDS.items() if (numbers := dict(of(network)))}
    known = [*there, *(["load"] if amplitudes or model.loads else [])]
    refuse_others("--runtime", names, known)
    fields: list[RuntimeField] = []
    symbols: dict[tuple[str, str, int], tuple[str, fmpq]] = {}
    for name in there:
        if name in names:
            labels = {key: f"{name}_{kind}_{number}" for key in there[name] for kind, number in [key]}
            unit = unit_of(model, name)
            symbols |= {(name, *key): (label, unit.size) for key, label in labels.items()}
            fields.append(
                field_of(
                    name,
                    [(labels[key], value, unit) for key, value in there[name].items()],
                    tuple(f"{name} of {_told(network, *key)}" for key in there[name]),
                )
            )
    if "load" in names:
        fields.append(field_of("load", [(told, load.weight, unit_of_load(model, load)) for told, load in amplitudes]))
    ring = Ring(tuple(label for label, _ in symbols.values()))
    made, some = (
        _freed(network, {key: values[label] / size for key, (label, size) in symbols.items()})
        for values in (ring.symbols(), drawn(fields))
    )
    return FreeNetwork(tuple(fields), ring, made, replace(model, network=some))


def _free_system(model: Model, names: Sequence[str], amplitudes: Sequence[tuple[str, Applied]]) -> FreeNetwork:
    """The same of a named system, whose parameters are those of the paper."""
    given = system_fields(model, names, amplitudes)
    ring = Ring(tuple(label for field in given if field.name != "load" for label in field.labels))
    free, some = (_with(model.named, given, values) for values in (ring.symbols(), drawn(given)))
    return FreeNetwork(
        given,
        ring,
        network_of(free),
        replace(model, chain=some, network=network_of(some)),
        load_kept(model, free),
        force_kept(model, free),
    )


def _with(chain: Chain, given: Sequence[RuntimeField], values: Mapping[str, Any]) -> Chain:
    """The chain with these values of the parameters, in their units."""
    own = {
        label: values[label] / unit.size
        for field in given
        if field.name != "load"
        for label, unit in zip(field.labels, field.units, strict=True)
    }

    def numbers(name: str) -> dict[int, Any] | None:
        values: dict[int, Any] | None = getattr(chain.parameters, name)
        return values and {i: own.get(f"{name}_{i}", value) for i, value in values.items()}

    names = ("kappa", "inertia", "velocity", "dashpot")
    return replace(chain, parameters=Parameters(**{name: numbers(name) for name in names}))


def _masses(network: Network) -> Iterator[tuple[tuple[str, int], fmpq]]:
    for number, point in enumerate(network.points):
        if point.mass != 0:
            yield ("point", number), point.mass


def _dashpots(network: Network) -> Iterator[tuple[tuple[str, int], fmpq]]:
    for number, point in enumerate(network.points):
        if point.damping != 0 and not point.absorbing:
            yield ("point", number), point.damping
    for number, link in enumerate(network.links):
        if link.damping != 0:
            yield ("link", number), link.damping


def _springs(network: Network) -> Iterator[tuple[tuple[str, int], fmpq]]:
    for number, point in enumerate(network.points):
        if point.stiffness != 0:
            yield ("point", number), point.stiffness
    for number, link in enumerate(network.links):
        if link.stiffness != 0:
            yield ("link", number), link.stiffness


def _impedances(network: Network) -> Iterator[tuple[tuple[str, int], fmpq]]:
    return ((("bar", number), bar.impedance) for number, bar in enumerate(network.bars))


def _velocities(network: Network) -> Iterator[tuple[tuple[str, int], fmpq]]:
    """Of rods and masses, each its own."""
    for number, point in enumerate(network.points):
        if point.mass != 0:
            yield ("point", number), point.velocity
    for number, bar in enumerate(network.bars):
        yield ("bar", number), bar.velocity


_KINDS: dict[str, Callable[[Network], Iterator[tuple[tuple[str, int], fmpq]]]] = {
    "mass": _masses,
    "dashpot": _dashpots,
    "spring": _springs,
    "impedance": _impedances,
    "velocity": _velocities,
}


def _freed(network: Network, symbols: dict[tuple[str, str, int], Any]) -> Network:
    """With symbols where there are some; what absorbs a rod's waves has its impedance."""
    bars = tuple(
        replace(
            bar,
            impedance=symbols.get(("impedance", "bar", k), bar.impedance),
            velocity=symbols.get(("velocity", "bar", k), bar.velocity),
        )
        for k, bar in enumerate(network.bars)
    )
    points = []
    for k, point in enumerate(network.points):
        damping = symbols.get(("dashpot", "point", k), point.damping)
        if point.absorbing:
            damping = bars[network.ends_at[k][0].bar].impedance
        points.append(
            replace(
                point,
                mass=symbols.get(("mass", "point", k), point.mass),
                damping=damping,
                stiffness=symbols.get(("spring", "point", k), point.stiffness),
                velocity=symbols.get(("velocity", "point", k), point.velocity),
            )
        )
    links = tuple(
        replace(
            link,
            stiffness=symbols.get(("spring", "link", k), link.stiffness),
            damping=symbols.get(("dashpot", "link", k), link.damping),
        )
        for k, link in enumerate(network.links)
    )
    return Network(tuple(points), bars, links)


def without(network: Network, names: Sequence[str]) -> Network:
    """A network with 0 in the place of every number of some fields."""
    places = [(name, *key) for name in names if name in _KINDS for key, _ in _KINDS[name](network)]
    return _freed(network, dict.fromkeys(places, fmpq(0)))


def _told(network: Network, kind: str, number: int) -> str:
    """What a number belongs to."""
    if kind == "point":
        return _point(network, number)
    if kind == "bar":
        bar = network.bars[number]
        return f"rod {number + 1}{bar.name and ', '}{bar.name}"
    link = network.links[number]
    return f"what links {_point(network, link.left)} and {_point(network, link.right)}"


def _point(network: Network, number: int) -> str:
    point = network.points[number]
    return f"{point.name or 'the node'} at {point.place}"
