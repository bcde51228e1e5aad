"""The loads of a model as records, each a sum of hats at a regular spacing, and a rest that is marched as it is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from flint import fmpq

from wavesym.errors import SpacingError
from wavesym.mechanics.loads import AppliedLoad, merge_loads
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import common_measure, rational
from wavesym.programs.march.plan import readable

_MOST = 100_000  # samples of a record
_FEW = 4  # instants that are marched as they are

_ZERO = fmpq(0)


@dataclass(frozen=True)
class RecordLoad:
    """sum over i of samples[i] hat(tau - begin - i spacing) of the load whose unit ramp is `ramp`."""

    ramp: str
    begin: fmpq
    spacing: fmpq
    samples: tuple[fmpq, ...]

    @property
    def hat(self) -> tuple[AppliedLoad, ...]:
        """A load that is 0 at tau = 0, 1 at `spacing` and 0 from twice that on."""
        return tuple(
            AppliedLoad(self.ramp, k * self.spacing, weight / self.spacing) for k, weight in enumerate((1, -2, 1))
        )


@dataclass(frozen=True)
class SplitLoads:
    """`rest` and `records` are the loads of a model together."""

    rest: tuple[AppliedLoad, ...]
    records: tuple[RecordLoad, ...]


def split(model: Model) -> SplitLoads:
    """The loads of a model. A record is one that changes at many instants; its jumps belong to the rest.

    SpacingError for one of too many samples on the horizon.
    """
    until = rational(model.horizon())
    rest, records = list(model.loads_until(until)), []
    for step, ramp in _pairs(model):
        own = [load for load in rest if load.source in (step, ramp)]
        if len({load.time for load in own}) < _FEW:
            continue
        record, jumps = _record(step, ramp, own, until)
        rest = [load for load in rest if load.source not in (step, ramp)] + jumps
        records.append(record)
    return SplitLoads(merge_loads(rest), tuple(records))


def rest_of(model: Model) -> Model:
    """The model under the rest of its loads."""
    return replace(model, loads=split(model).rest)


def still(model: Model, load: RecordLoad) -> Model:
    """The model at rest until one hat acts."""
    network = replace(
        model.network,
        points=tuple(replace(point, velocity=_ZERO) for point in model.network.points),
        bars=tuple(replace(bar, velocity=_ZERO, strain=_ZERO) for bar in model.network.bars),
    )
    return replace(model, preset=None, network=network, loads=load.hat, spacing=None)


def _record(step: str, ramp: str, loads: Sequence[AppliedLoad], until: fmpq) -> tuple[RecordLoad, list[AppliedLoad]]:
    """A record that does not jump, and what it differs by: at each jump that, which goes back to 0 within a spacing."""
    times = sorted({load.time for load in loads})
    begin = times[0]
    spacing = common_measure(after - before for before, after in pairwise(times))
    if (count := int(((until - begin) / spacing).floor()) + 2) > _MOST:
        raise SpacingError(
            f"load: {step.removesuffix(':step')} has {count} samples on the horizon at a spacing of "
            f"{readable(spacing)}, the limit in a march of one hat is {_MOST} (modes, instants with a larger "
            "common measure, or a shorter horizon, help)"
        )
    jumps, bends = ({load.time: load.weight for load in loads if load.source == source} for source in (step, ramp))
    samples = []
    value = slope = _ZERO
    for k in range(count):
        slope += bends.get(begin + k * spacing, _ZERO)
        value += jumps.get(begin + k * spacing, _ZERO) + slope * spacing
        samples.append(value)
    back: list[AppliedLoad] = []
    for time, jump in jumps.items():
        down = jump / spacing
        back += [AppliedLoad(step, time, jump), AppliedLoad(ramp, time, -down), AppliedLoad(ramp, time + spacing, down)]
    return RecordLoad(ramp, begin, spacing, tuple(samples)), back


def _pairs(model: Model) -> Iterator[tuple[str, str]]:
    """The names of a unit step and its ramp, for each load that acts."""
    acting = {load.source for load in model.loads}
    for point in model.network.points:
        by_powers = sorted(point.loads, key=lambda load: len(load.coefficients))
        for step, ramp in zip(by_powers[::2], by_powers[1::2], strict=False):
            if acting & {step.source, ramp.source}:
                yield step.source, ramp.source
