"""A scene with other parameters: what a program that takes them when it runs is given, and what integrators have then.

The numbers are changed in the network that integrators read (independent.py). Masses, stiffnesses and the like are each
changed by a factor of their own, all velocities by one, and all loads.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from flint import fmpq

from wavesym.errors import WavesymError
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import fraction, nearest
from wavesym.programs.runtime.network import NAMES, RuntimeField, free_network
from wavesym.scene import Scene
from wavesym.scene.lowering import amplitudes
from wavesym.verification.independent import independent_model

_NAMES = (*NAMES, "mass", "dashpot", "spring", "impedance")
_TOGETHER = {"velocity": fmpq(3, 4), "load": fmpq(5, 4)}


def runtime_names(scene: Scene, model: Model) -> tuple[str, ...]:
    """All parameters that can be given at run time; none where no such program serves the scene."""
    found = []
    for name in _NAMES:
        with suppress(WavesymError):
            given = amplitudes(scene) if name == "load" else ()
            free_network(model, (name,), given)
            found.append(name)
    return tuple(found)


def draw_parameters(scene: Scene, model: Model, own: Sequence[RuntimeField]) -> tuple[list[float], Model]:
    """Numbers for all fields, in their order, and the scene with them as integrators read it."""
    factors = {field.name: _factors(field, model) for field in own}
    numbers = [
        nearest(value * factor)
        for field in own
        for value, factor in zip(field.values, factors[field.name], strict=True)
    ]
    listed = {name: of for name, of in factors.items() if hasattr(scene.system, name)}  # others are those of parts
    lists = {
        name: tuple(value * fraction(factor) for value, factor in zip(getattr(scene.system, name), of, strict=True))
        for name, of in listed.items()
    }
    made = independent_model(scene.model_copy(update={"system": scene.system.model_copy(update=lists)}), model)
    labels = {
        label: factor
        for field in own
        if field.name not in listed
        for label, factor in zip(field.labels, factors[field.name], strict=True)
    }
    made = replace(made, network=_with_parameters(made.network, labels))
    if "load" in factors:
        made = replace(made, loads=tuple(replace(load, weight=_TOGETHER["load"] * load.weight) for load in made.loads))
    return numbers, made


def _factors(field: RuntimeField, model: Model) -> list[fmpq]:
    if field.name in _TOGETHER:
        return [_TOGETHER[field.name]] * len(field.values)
    factors = [fmpq(8 + (5 * k + 3) % 7, 10) for k in range(len(field.values))]
    if model.clock and "inertia" in model.parameters.numbers:
        factors[0] = fmpq(1)  # in units the first shaft and the first disc of a drive say what a moment of 1 is
    return factors


def _with_parameters(network: Network, factors: Mapping[str, fmpq]) -> Network:
    """With other numbers: `mass_point_0`, `spring_link_3`; what absorbs a rod's waves has the rod's impedance."""

    def times(part: Any, kind: str, number: int, names: Mapping[str, str]) -> Any:
        found = {key: factors.get(f"{name}_{kind}_{number}", fmpq(1)) for key, name in names.items()}
        return replace(part, **{key: getattr(part, key) * factor for key, factor in found.items()})

    bars = [
        times(bar, "bar", k, {"impedance": "impedance", "velocity": "velocity"}) for k, bar in enumerate(network.bars)
    ]
    held = {"mass": "mass", "damping": "dashpot", "stiffness": "spring", "velocity": "velocity"}
    points = [times(point, "point", k, held) for k, point in enumerate(network.points)]
    for k, point in enumerate(points):
        if point.absorbing:
            (end, *_) = network.ends_at[k]
            points[k] = replace(point, damping=bars[end.bar].impedance)
    between = {"stiffness": "spring", "damping": "dashpot"}
    links = [times(link, "link", k, between) for k, link in enumerate(network.links)]
    return Network(tuple(points), tuple(bars), tuple(links))
