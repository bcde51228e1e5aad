"""Numbers of a model that modes may be given at run time: as an engineer has them, the stiffness and mass of a storey.

    stiffness   of rods, then of springs: N/m with units
    rod_mass    of rods
    mass        of masses
    damping     ratios of modes
    load        factors of records and shapes, sizes of steps and ramps

A wave takes sqrt(rod_mass/stiffness) through a rod: marches cannot vary that, modes can.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from flint import fmpq

from wavesym.mechanics.damping import Damping
from wavesym.mechanics.loads import AppliedLoad, merge_loads
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Bar, Network
from wavesym.mechanics.parameters import ModelParameter, PartParameters, describe_part
from wavesym.numbers.doubles import nearest, rational
from wavesym.programs.mode_sets.modes import ModeSets, enough_modes, generic_zeros
from wavesym.programs.mode_sets.network import Columns, double, stack_networks
from wavesym.programs.modes.loads import Numbers
from wavesym.programs.modes.projection import ModalOutput
from wavesym.programs.modes.undamped import UndampedModes
from wavesym.programs.request import refuse_others
from wavesym.programs.runtime.network import PLAIN, ParameterUnit, RuntimeField, field_of, unit_of_load


@dataclass(frozen=True)
class ModeParameters:
    """A model whose numbers `fields` are given; `amplitudes` are those of its loads where these are among them."""

    model: Model
    fields: tuple[RuntimeField, ...]
    amplitudes: tuple[AppliedLoad, ...]

    @cached_property
    def like(self) -> UndampedModes:
        """The model with its own numbers."""
        return UndampedModes(self.model.to_horizon())

    @cached_property
    def fewest(self) -> int:
        """The modes to begin with. ToleranceError where no number of them is enough."""
        return enough_modes(self.model)

    def numbers(self, given: Numbers) -> dict[str, Numbers]:
        """The numbers of each field without units, (sets, numbers)."""
        ends = np.cumsum([len(field.values) for field in self.fields])
        rows = np.split(given, ends[:-1], axis=1)
        return {
            field.name: part / np.array([nearest(unit.size) for unit in field.units])
            for field, part in zip(self.fields, rows, strict=True)
        }

    def refused(self, given: Numbers) -> Any:
        """The sets with a number that is not finite, or not positive where it has to be."""
        bad = ~np.isfinite(given).all(axis=1)
        for name, part in self.numbers(given).items():
            least = -np.inf if name == "load" else 0.0
            bad |= (part < least if name == "damping" else part <= least).any(axis=1)
        return bad

    def mode_sets(self, given: Numbers) -> ModeSets:
        """The modes of sets of numbers, (sets, numbers), none of which are refused."""
        network = self._columns(self.numbers(given))
        outputs = [
            self._output(network, output, probe.quantity, probe.factor)
            for output, probe in zip(self.like.outputs, self.model.probes, strict=True)
        ]
        drivers = [replace(each, gain=double(each.gain)) for each in self.like.drivers]
        return ModeSets(self.like, network, outputs, drivers, self.zero_outputs, self.fewest)

    @cached_property
    def zero_outputs(self) -> tuple[bool, ...]:
        """The outputs that are 0 whatever the numbers."""
        return generic_zeros(self.like)

    def damping(self, given: Numbers) -> list[Damping | None]:
        """That of each set."""
        own, numbers = self.model.damping, self.numbers(given)
        if "damping" not in numbers:
            return [own] * len(given)
        modes = own.modes if own else None
        return [Damping(tuple(map(rational, row)), modes) for row in numbers["damping"].tolist()]

    def factors(self, given: Numbers) -> Numbers | None:
        """What each of the loads' `amplitudes` is multiplied by, (sets, amplitudes); None where they are not given."""
        return self.numbers(given).get("load")

    def exact(self, given: Numbers) -> Model:
        """The model with one set of numbers, (numbers,), which are exact but for the delay of a rod: a root."""
        numbers = self.numbers(given[None])
        values = {
            label: rational(value)
            for field in self.fields
            for label, value in zip(field.labels, numbers[field.name][0].tolist(), strict=True)
        }
        springs = {f"spring{label.removeprefix('stiffness')}": value for label, value in values.items()}
        network = PartParameters(self.model.network).network({**values, **springs})
        bars = tuple(
            _rod(bar, values.get(f"stiffness_bar_{k}"), values.get(f"rod_mass_bar_{k}"))
            for k, bar in enumerate(network.bars)
        )
        loads = self.model.loads
        if "load" in numbers:
            pairs = zip(self.amplitudes, numbers["load"][0].tolist(), strict=True)
            loads = merge_loads(
                replace(change, weight=change.weight * rational(factor))
                for amplitude, factor in pairs
                for change in amplitude.changes
            )
        return replace(
            self.model,
            network=replace(network, bars=bars),
            loads=loads,
            damping=self.damping(given[None])[0],
            preset=None,
        )

    def _columns(self, numbers: Mapping[str, Numbers]) -> Network:
        """The cut network with columns of numbers."""
        cut, sets = self.like.cut, len(next(iter(numbers.values())))
        labels = {
            label: numbers[field.name][:, k : k + 1] for field in self.fields for k, label in enumerate(field.labels)
        }
        base = stack_networks([cut.network])
        whole: Columns = np.ones((sets, 1))
        bars = []
        for k, bar in enumerate(self.model.network.bars):
            stiffness = labels.get(f"stiffness_bar_{k}", nearest(bar.impedance / bar.delay))
            mass = labels.get(f"rod_mass_bar_{k}", nearest(bar.impedance * bar.delay))
            last = cut.firsts[k] + len(cut.places[k])
            for number in range(cut.firsts[k], last + 1):
                piece = cut.network.bars[number]
                delay = whole * nearest(piece.length / bar.length) * np.sqrt(mass / stiffness)
                length = whole * nearest(piece.length)
                impedance = whole * np.sqrt(mass * stiffness)
                bars.append(replace(base.bars[number], length=length, speed=length / delay, impedance=impedance))
        points = (
            replace(
                point,
                mass=whole * labels.get(f"mass_point_{k}", point.mass),
                stiffness=whole * labels.get(f"stiffness_point_{k}", point.stiffness),
            )
            for k, point in enumerate(base.points)
        )
        links = (
            replace(link, stiffness=whole * labels.get(f"stiffness_link_{k}", link.stiffness))
            for k, link in enumerate(base.links)
        )
        return Network(tuple(points), tuple(bars), tuple(links))

    @staticmethod
    def _output(network: Network, output: ModalOutput, quantity: str, factor: fmpq) -> ModalOutput:
        """An output with columns of weights."""
        points = {point: double(weight) for point, weight in output.points.items()}
        if output.slope is None:
            return replace(output, points=points)
        end = output.slope[1]
        bar = network.bars[end.bar]
        weight = double(factor) * (bar.impedance if quantity == "force" else 1 / bar.speed)
        return replace(output, slope=(weight, end))


def mode_parameters(
    model: Model, names: Sequence[str], amplitudes: Sequence[tuple[str, AppliedLoad]]
) -> ModeParameters:
    """The numbers that `names` ask for, in the order of the scene.

    UnservedError for what modes do not serve, WavesymError for a name that the scene does not have.
    """
    known = {name: numbers for name, numbers in _numbers(model) if numbers}
    refuse_others("runtime", names, [*known, *(["load"] if model.loads else [])])
    fields = [
        field_of(name, [(n.label, n.value, _unit(model, name)) for n in numbers], [n.about for n in numbers])
        for name, numbers in known.items()
        if name in names
    ]
    if "load" in names:
        fields.append(field_of("load", [(about, load.weight, unit_of_load(model, load)) for about, load in amplitudes]))
        return ModeParameters(model, tuple(fields), tuple(load for _, load in amplitudes))
    return ModeParameters(model, tuple(fields), ())


def names_of(model: Model) -> tuple[str, ...]:
    """The fields that a model has, but for its loads."""
    return tuple(name for name, numbers in _numbers(model) if numbers)


def _numbers(model: Model) -> Iterator[tuple[str, list[ModelParameter]]]:
    """All numbers by the name of their field."""
    network = model.network
    parts = PartParameters(network).numbers
    bars = [(k, bar, describe_part(network, "bar", k)) for k, bar in enumerate(network.bars)]
    rods = [ModelParameter(f"stiffness_bar_{k}", b.impedance / b.delay, f"stiffness of {at}") for k, b, at in bars]
    springs = [
        ModelParameter(
            f"stiffness{each.label.removeprefix('spring')}", each.value, f"stiffness{each.about.removeprefix('spring')}"
        )
        for each in parts.get("spring", ())
    ]
    yield "stiffness", rods + springs
    yield "rod_mass", [ModelParameter(f"rod_mass_bar_{k}", b.impedance * b.delay, f"mass of {at}") for k, b, at in bars]
    yield "mass", list(parts.get("mass", ()))
    ratios = model.damping.ratios if model.damping else (fmpq(0),)
    about = "damping ratio" if len(ratios) == 1 else "damping ratio of mode {}"
    yield "damping", [ModelParameter(f"damping_{k}", ratio, about.format(k)) for k, ratio in enumerate(ratios, 1)]


def _unit(model: Model, name: str) -> ParameterUnit:
    """That of the numbers of a field other than `load`; the first rod is what units are made of, if there is one."""
    if model.clock is None or name == "damping":
        return PLAIN
    size, text = model.inputs["spring" if name == "stiffness" else "mass"]
    if not model.network.bars:
        return ParameterUnit(size, text)
    first = model.network.bars[0]
    own = first.impedance / first.delay if name == "stiffness" else first.impedance * first.delay
    return ParameterUnit(size / own, text)


def _rod(bar: Bar, stiffness: fmpq | None, mass: fmpq | None) -> Bar:
    """A rod with another stiffness or mass, as far as they are given."""
    if stiffness is None and mass is None:
        return bar
    k = bar.impedance / bar.delay if stiffness is None else stiffness
    m = bar.impedance * bar.delay if mass is None else mass
    delay, impedance = (rational(float(np.sqrt(nearest(square)))) for square in (m / k, m * k))
    return replace(bar, speed=bar.length / delay, impedance=impedance)
