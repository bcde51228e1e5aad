"""Numbers of a model that modes may be given at run time: as an engineer has them, the stiffness and mass of a storey.

    stiffness   of rods, then of springs: N/m with units
    rod_mass    of rods
    mass        of masses
    damping     ratios of modes
    load        factors of records and shapes, sizes of steps and ramps

A wave takes sqrt(rod_mass/stiffness) through a rod: marches cannot vary that, modes can.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import count
from math import ceil

import numpy as np
from flint import fmpq

from wavesym.errors import CostError, UnservedError
from wavesym.mechanics.damping import Damping
from wavesym.mechanics.loads import AppliedLoad, AppliedRecord, merge_loads
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Bar, Network
from wavesym.mechanics.parameters import ModelParameter, PartParameters, describe_part
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest, rational
from wavesym.programs.modes.loads import Roughness, linear_loads, sampled_roughness
from wavesym.programs.modes.truncation import truncate
from wavesym.programs.modes.undamped_modes import UndampedModes
from wavesym.programs.request import OF_MODES, alternatives
from wavesym.programs.runtime.network import PLAIN, ParameterUnit, RuntimeField, runtime_fields

_MORE = 1.1  # times as many modes as one set of numbers needs


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
        """As many modes as the model needs for its tolerance, and some more for others like it.

        UnservedError, ToleranceError as for `modal_system`.
        """
        return min(int(_MORE * truncate(self.like).count) + 1, self.like.most)

    def numbers(self, given: Array) -> dict[str, Array]:
        """The numbers of each field without units, (sets, numbers)."""
        ends = np.cumsum([len(field.values) for field in self.fields])
        rows = np.split(given, ends[:-1], axis=1)
        return {
            field.name: part / np.array([nearest(unit.size) for unit in field.units])
            for field, part in zip(self.fields, rows, strict=True)
        }

    @cached_property
    def zero_outputs(self) -> tuple[bool, ...]:
        """The outputs that are 0 whatever the numbers: with the model's own, and with others that do not fit."""
        own = self.like.zero_outputs
        if not any(own):
            return own
        other = UndampedModes(replace(self.model, network=_draw_network(self.model.network), preset=None))
        return tuple(a and b for a, b in zip(own, other.zero_outputs, strict=True))

    def exact(self, given: Array) -> Model:
        """The model with one set of numbers, (numbers,), which are exact but for the delay of a rod: a root."""
        numbers, damping = self.numbers(given[None]), self.model.damping
        if "damping" in numbers:
            ratios = tuple(map(rational, numbers["damping"][0].tolist()))
            damping = Damping(ratios, damping.modes if damping else None)
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
            damping=damping,
            preset=None,
        )


def mode_parameters(
    model: Model, names: Sequence[str], amplitudes: Sequence[tuple[str, AppliedLoad]]
) -> ModeParameters:
    """The numbers that `names` ask for, in the order of the scene.

    UnservedError for what modes do not serve, WavesymError for a name that the scene does not have.
    """
    _refuse_dashpots(model)
    _refuse_jumps(model, names)
    numbers = {name: every for name, every in _numbers(model) if every}
    fields = runtime_fields(model, names, numbers, _unit, amplitudes)
    return ModeParameters(model, fields, tuple(load for _, load in amplitudes) if "load" in names else ())


def _refuse_dashpots(model: Model) -> None:
    """UnservedError for dashpots, which says who takes their numbers: of those that the scene has."""
    network = model.network
    points = [point for point in network.points if point.damping != 0 and point.motion is None]
    points += [network.points[link.left] for link in network.links if link.damping != 0]
    if points:
        remedy = "write a sweep, which computes each case alone"
        if network.bars:
            known = [name for name, numbers in model.parameters.numbers.items() if numbers and name not in OF_MODES]
            remedy = f"take {alternatives([*known, *(['load'] if model.loads else [])])}, of a march, or {remedy}"
        raise UnservedError(
            f"runtime: numbers of modes beside the dashpot or absorbing end at {points[0].label} are "
            f"not supported ({remedy})"
        )


def _refuse_jumps(model: Model, names: Sequence[str]) -> None:
    """UnservedError for loads that jump, which says what a march takes instead of numbers that modes alone have."""
    if OF_MODES.keys().isdisjoint(names):
        return
    try:
        _ = UndampedModes(model.to_horizon()).loads
    except UnservedError as error:
        if model.damping is not None or not model.network.bars:
            raise
        others = alternatives([*model.parameters.numbers, "load"])
        raise UnservedError(f"{error}; under a jump take {others} at run time, or a sweep") from None


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


def _draw_network(network: Network) -> Network:
    """A network of the same pattern with other numbers, which do not fit one another."""
    factors = (fmpq(10 * k * k + 3, 7 * k + 1) for k in count(1))
    return Network(
        tuple(replace(p, mass=p.mass * next(factors), stiffness=p.stiffness * next(factors)) for p in network.points),
        tuple(replace(b, impedance=b.impedance * next(factors), speed=b.speed * next(factors)) for b in network.bars),
        tuple(replace(link, stiffness=link.stiffness * next(factors)) for link in network.links),
    )


_FEWEST_SAMPLES, _MOST_SAMPLES = 500, 1 << 20


@dataclass(frozen=True)
class SampledAmplitudes:
    """`samples` (n, amplitudes), the first of them 0 at tau = 0, `step` apart; of each which of the drivers `loads` it
    is of, and its roughness, of samples that are 1 apart."""

    step: fmpq
    samples: Array
    loads: tuple[int, ...]
    rough: tuple[Roughness, ...]


def sampled_amplitudes(parameters: ModeParameters, *, streamed: bool = False) -> SampledAmplitudes:
    """Those of a model up to its horizon: as a stream takes them, or so often that extremes are seen.

    CostError where they are too many.
    """
    like, model = parameters.like, parameters.model
    step = like.loads.spacing(model.until, model.spacing)
    step /= 1 if streamed else ceil(nearest(_FEWEST_SAMPLES * step / model.until))
    count = ceil(model.horizon() / nearest(step)) + 2
    if count > _MOST_SAMPLES:
        raise CostError(
            f"load: {count} samples, {nearest(step):g} apart in tau, the limit is {_MOST_SAMPLES} (times with a larger "
            "common measure, or a shorter horizon, help)"
        )
    every: Sequence[AppliedLoad] = parameters.amplitudes or [
        AppliedRecord(pair[1] or pair[0], fmpq(0), fmpq(1), tuple(x for x in model.loads if x.source in pair))
        for pair in like.sources
    ]
    samples, loads = np.zeros((count, len(every))), []
    for column, amplitude in zip(samples.T, every, strict=True):
        acting = linear_loads(amplitude.changes, like.sources, like.model.until, like.model.describe_step)
        loads.append(next(j for j, pair in enumerate(like.sources) if amplitude.source in pair))
        column[:] = acting.sample(step, count)[:, loads[-1]]
    return SampledAmplitudes(step, samples, tuple(loads), tuple(map(sampled_roughness, samples.T)))
