"""The march of one hat of each record as an evaluator: any spacing, in three panels a window.

What a record does is the sum of what its hats do, and these do the same, one spacing after the other. So one hat is
marched for each load, by the march (../march); what is no record is marched beside it. docs/march.md has
the proof of the bound: that of a hat's march times the sum of the absolute samples, and what the sum loses.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from flint import fmpq

from wavesym.errors import SpacingError
from wavesym.mechanics.loads import AppliedLoad, merge_loads
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import common_measure, in_order, nearest, rational, relative
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.form import Form
from wavesym.programs.march.bound import Verdict
from wavesym.programs.march.evaluator import March, first_degree, judge_march, refuse_long
from wavesym.programs.march.plan import march_plan, readable
from wavesym.programs.program import Program, ProgramOutput, Provenance
from wavesym.programs.schemes import names_read
from wavesym.programs.schemes.hats import HatScheme, ShiftedHats
from wavesym.programs.schemes.march import MarchScheme
from wavesym.programs.tables import Tables, firsts
from wavesym.progress import warn_long

_MOST = 100_000  # samples of a record
_FEW = 4  # instants that are marched as they are

_LONG, _SECONDS = 10.0, 1.5e-7  # seconds that are announced, and about those of all marches for an operation of one

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
        if len(in_order(load.time for load in own)) < _FEW:
            continue
        record, jumps = _record(step, ramp, own, until)
        rest = [load for load in rest if load.source not in (step, ramp)] + jumps
        records.append(record)
    return SplitLoads(merge_loads(rest), tuple(records))


def rest_of(model: Model) -> Model:
    """The model under the rest of its loads."""
    return replace(model, loads=split(model).rest)


def under_jumps(program: Program, model: Model) -> Model:
    """A model under the loads by which a program's outputs may jump: records that are added up hat by hat do not."""
    return rest_of(model) if program.hats else model


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
    times = in_order(load.time for load in loads)
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


_UNIT = 2.0**-53
_PER_SPACING = 4  # instants at which an output's largest value is looked for
_MARGIN = 1.01  # what is of second order in the roundoff


@dataclass(frozen=True)
class HatMarch(Form):
    """`marches` of the rest, where there is `rest` (1, else 0), and of one hat of each of the `records`.

    `refusal` says why the loads are not marched as they are.
    """

    KERNEL = "hats"

    marches: tuple[March, ...]
    rest: int
    records: tuple[RecordLoad, ...]
    refusal: str
    tau_max: float
    outputs: tuple[ProgramOutput, ...] = ()
    real: Real = DOUBLE  # instants between samples need all of it

    @property
    def degree(self) -> int:
        """The largest of its polynomials."""
        return max(march.degree for march in self.marches)

    @cached_property
    def tables(self) -> Tables:
        """The numbers of its program: those of each march, and the records."""
        samples = [record.samples for record in self.records]
        made = {f"{k}.{name}": march.tables[name] for k, march in enumerate(self.marches) for name in self._names[0]}
        return made | {
            "spacing": tuple(part for record in self.records for part in _parts(record.spacing)),
            "begin_at": tuple(part for record in self.records for part in _parts(record.begin)),
            "first_sample": firsts(map(len, samples)),
            "sample": tuple(nearest(value) for of in samples for value in of),
        }

    @cached_property
    def constants(self) -> dict[str, float]:
        """Its single numbers: how many marches are of no record, and are in all, and those of each."""
        of = {f"{k}.{name}": march.constants[name] for k, march in enumerate(self.marches) for name in self._names[1]}
        return {"rest": self.rest, "marches": len(self.marches), **of}

    @cached_property
    def _names(self) -> tuple[list[str], list[str]]:
        """The tables and the single numbers that a march is read from."""
        march = self.marches[0]
        return names_read(MarchScheme, march.tables, march.constants, self.tau_max)

    @cached_property
    def scheme(self) -> HatScheme:
        """Its values in NumPy."""
        return HatScheme(self.tables, self.constants, self.tau_max, np.float64)

    @property
    def bytes(self) -> int:
        """The size of the tables that grow."""
        return sum(march.bytes for march in self.marches) + 8 * sum(len(record.samples) for record in self.records)

    @property
    def work(self) -> float:
        """About how many operations a window takes."""
        return sum(march.work for march in self.marches)

    @property
    def total_work(self) -> float:
        """The same of all windows."""
        return sum(march.total_work for march in self.marches)

    @property
    def summary(self) -> str:
        """What it is, in a few words."""
        count = max(len(record.samples) for record in self.records)
        return f"march of one hat, degree {self.degree}, for {count} samples, bound {self.error_bound:g}"

    def shortfall(self, tolerance: fmpq) -> str:
        """Why it does not meet a tolerance."""
        name, bound = self.worst.name, self.worst.bound
        if not bound < 1:
            return f"march: its error may be as large as {name} itself"
        return f"march: hats added up leave a bound of {bound:g} to tau = {self.tau_max:g} for {name}"

    def program(self, provenance: Provenance, **more: Any) -> Program:
        """Its program, which is NumPy alone, and why."""
        return super().program(provenance, numpy_only=self.refusal, hats=True, **more)


def hat_march(model: Model, refusal: str = "") -> HatMarch | None:
    """The march of one hat of each record; None where no load is a record, or the rest fits into no window either.

    Args:
        model: dimensionless, its records at any spacing.
        refusal: why the loads are not marched as they are.

    Raises:
        SpacingError: for a record of too many samples.
        UnservedError, CostError: as of a march.
    """
    parts = split(model)
    if not parts.records:
        return None
    moving = [bar.velocity or bar.strain for bar in model.network.bars] + [p.velocity for p in model.network.points]
    remaining = replace(model, loads=parts.rest)
    try:
        if {load.source for load in parts.rest} & {step for step, _ in _pairs(model)}:
            _warn_of_jump(remaining)
        rest = [judge_march(remaining)] if parts.rest or any(moving) else []
    except SpacingError:
        return None
    hats = [judge_march(still(model, record)) for record in parts.records]
    made = HatMarch(tuple(march for march, _ in (*rest, *hats)), len(rest), parts.records, refusal, hats[0][0].tau_max)
    parted = [np.array([verdict.errors, verdict.heights]) for _, verdict in rest]
    parted += [_superpose(record, *hat) for record, hat in zip(parts.records, hats, strict=True)]
    errors, heights = sum(parted, np.zeros((2, len(model.probes))))
    errors = _MARGIN * (errors + len(parted) * _UNIT * heights)
    spacing = nearest(min(record.spacing for record in parts.records))
    sizes = np.abs(made.scheme.evaluate(made.scheme.evenly(spacing / _PER_SPACING))).max(axis=1)
    largest = np.where(errors > 0, np.maximum(sizes - errors, 0.0), 0.0)
    return replace(
        made,
        outputs=tuple(
            ProgramOutput(probe.name, relative(error, size), size, incidental=probe.incidental)
            for probe, error, size in zip(model.probes, errors.tolist(), largest.tolist(), strict=True)
        ),
    )


def _warn_of_jump(model: Model) -> None:
    """A line, where a march takes long, with what would let modes serve. Raises as a march."""
    plan = march_plan(model, DOUBLE)
    degree = first_degree(plan, DOUBLE)
    refuse_long(plan, degree, 0.0, DOUBLE)
    if (seconds := March(plan, degree, DOUBLE, (), plan.tau_max).total_work * _SECONDS) > _LONG:
        warn_long(
            f"a march hat by hat may take {seconds:.0f} s of a processor, as a load jumps: modes, which are sooner, "
            "take one that does not (of a record whose first sample is not 0 write `start`, one spacing)"
        )


def _superpose(record: RecordLoad, march: March, hat: Verdict) -> Array:
    """Of what hats add up to the largest error and what values do not exceed: (2, outputs)."""
    samples = np.abs([nearest(value) for value in record.samples])
    count, plan = len(samples), march.plan
    total, spread = float(samples.sum()), float(np.sqrt(count * np.square(samples).sum()))
    spacing, span = nearest(record.spacing), plan.cycle[1]
    late = ShiftedHats.NEAR * march.tau_max + 4 * _UNIT * (spacing + span)
    # what the error of a hat changes by so much later, in parts of itself
    bent = 2 * min(2.0, late * 2 * hat.smooth**2 / plan.shortest)
    errors, heights, slopes = (np.array(each) for each in (hat.errors, hat.heights, hat.slopes))
    levels = np.log2(4 * count)
    added = _UNIT * (total * (count + 2) + spread * (24 * levels + 16)) * heights
    silent = errors == 0
    lost = 64 * count * np.where(silent, 0.0, 5e-324)
    return np.array([total * ((1 + bent) * errors + late * slopes) + added + lost, total * heights])


def _parts(value: fmpq) -> tuple[float, float]:
    """An exact number as the sum of two doubles."""
    high = nearest(value)
    return high, nearest(value - rational(high))
