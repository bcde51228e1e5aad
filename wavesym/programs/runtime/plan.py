"""What is marched when parameters come at run time: the plan of a march over functions, the changes
of its loads, and which waves outputs are sums of.

Lengths, speeds and the instants of loads stay, so panels, delays and stretches are numbers. What a joint makes of
waves, what it starts with, how strong a load is and what an output weighs are rational functions of the parameters.

An output is a sum of waves. Between two cuts of a window, on a section, each of them is one polynomial. Waves that were
sent at the same instant, on panels of the same length, are added up once, to a strand.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import Any, NamedTuple

from flint import fmpq, fmpq_poly

from wavesym.errors import UnservedError
from wavesym.exact.arrivals import identically_zero
from wavesym.mechanics.loads import AppliedLoad, AppliedRecord, merge_loads
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Point
from wavesym.numbers.doubles import rational
from wavesym.numbers.ratio import Ratio
from wavesym.numbers.reals import Real
from wavesym.programs.march.plan import MarchPlan, OutputTerm, Stretch, load_events, march_plan, unit_action
from wavesym.programs.march.space import joint_rows
from wavesym.programs.runtime.laws import Function
from wavesym.programs.runtime.network import FreeNetwork, drawn_number
from wavesym.programs.tables import firsts

HELPS = "in tau, to which samples may be interpolated in a scene without units"
"""Beside another spacing, where loads leave too many panels."""


@dataclass(frozen=True)
class AmplitudeEvent:
    """A change of a load: from panel `panel` of window `window` on, `strength` and `weight` times amplitude `load`
    times the `power` of the time since acts as load `force` (in the units of a law that is divided by g): added to what
    acts there, or, where it `replaces` that, in its place.
    """

    window: int
    panel: int
    force: int
    power: int
    strength: Function
    load: int
    weight: fmpq = field(default_factory=lambda: fmpq(1))
    replaces: bool = False


@dataclass(frozen=True)
class StrandTerm:
    """A wave, the output term of this `number`, on one of its stretches. `low` and `high` are where, on [-1, 1], its
    integral begins and ends.
    """

    number: int
    wave: OutputTerm
    stretch: Stretch
    low: fmpq
    high: fmpq


@dataclass(frozen=True)
class Strand:
    """What of an output is one polynomial in t - start on a part of every window; `half` that panel's length."""

    output: int
    start: fmpq
    half: fmpq
    terms: tuple[StrandTerm, ...]


class SharedReading(NamedTuple):
    """So many strands from one on, each of another output; `more` where one before is of these outputs, too."""

    strand: int
    strands: int
    more: bool


@dataclass(frozen=True)
class RuntimePlan:
    """`plan` has joints that are functions, and no loads that matter; `usual` are those of the scene's numbers: where
    loads that are 0 count once, and, where there are any, as they are.

    `output_terms` are the waves in outputs, each with the number of its output; `is_zero` says of each output whether
    it is 0 whatever the parameters are.
    """

    model: Model
    plan: MarchPlan
    usual: tuple[MarchPlan, ...]
    free: FreeNetwork
    events: tuple[AmplitudeEvent, ...]
    output_terms: tuple[tuple[int, Any], ...]
    strands: tuple[Strand, ...]
    is_zero: tuple[bool, ...]

    @property
    def own(self) -> MarchPlan:
        """That of the scene's numbers, with all loads."""
        return self.usual[0]

    @property
    def sections(self) -> tuple[fmpq, ...]:
        """Where they begin in a window, and its end."""
        return (*sorted({max(strand.start, fmpq(0)) for strand in self.strands} | {fmpq(0)}), self.plan.step)

    def strands_of(self, section: int, output: int) -> list[int]:
        """The strands that are an output on a section."""
        at = self.sections[section]
        return [n for n, s in enumerate(self.strands) if s.output == output and s.start <= at < s.start + 2 * s.half]


def runtime_plan(model: Model, free: FreeNetwork, loads: Sequence[AppliedLoad], real: Real) -> RuntimePlan:
    """The plan of a chain; each of `loads` has an amplitude.

    CostError as for a march, UnservedError as `ordered_events`.
    """
    until = rational(model.horizon(real))
    acting = [[change for change in load.changes if change.time <= until] for load in loads]
    # as if each weighed 1, so that none of them is left out
    changes = {(change.time, change.source) for load in acting for change in load}
    units = tuple(AppliedLoad(source, time, fmpq(1)) for time, source in sorted(changes))
    plan = free_march(model, free, units, real, HELPS)

    def scene_march(instead_of_0: int) -> MarchPlan:
        """As the scene says, in which each counts as it says, or, where that is 0, as another number."""
        weighed = (
            replace(change, weight=change.weight * (load.weight or instead_of_0))
            for load, changes in zip(loads, acting, strict=True)
            for change in changes
        )
        return march_plan(replace(model, loads=merge_loads(weighed)), real, helps=HELPS, or_pieces=False)

    own = scene_march(1)
    usual = (own, scene_march(0)) if any(load.weight == 0 for load in loads) else (own,)
    is_zero = zero_outputs(free.some, loads, real)
    output_terms = tuple(
        (number, replace(wave, gain=fmpq(0)) if is_zero[number] else wave)
        for number, output in enumerate(plan.outputs)
        for wave in output.terms
    )
    chosen = [unit.size for field in free.fields if field.name == "load" for unit in field.units]
    events = ordered_events(_events(plan, free, acting, chosen or [fmpq(1)] * len(loads)))
    strands = tuple(_strands(plan, output_terms))
    return RuntimePlan(model, plan, usual, free, events, output_terms, strands, tuple(is_zero))


def free_march(model: Model, free: FreeNetwork, loads: tuple[AppliedLoad, ...], real: Real, helps: str) -> MarchPlan:
    """The plan of a march whose laws and gains are functions; where `loads` act is all that counts of them here."""
    points = zip(free.network.points, model.network.points, strict=True)
    network = replace(free.network, points=tuple(replace(point, loads=own.loads) for point, own in points))
    plan = march_plan(replace(model, network=network, loads=loads), real, joint_rows, helps, or_pieces=False)
    forces = [probe.computed_quantity == "force" for probe in model.probes]
    factors: list[Any] = [free.factors.force if force else fmpq(1) for force in forces]
    outputs = (
        replace(output, terms=tuple(replace(one, gain=one.gain * factor) for one in output.terms))
        for output, factor in zip(plan.outputs, factors, strict=True)
    )
    return replace(plan, outputs=tuple(outputs))


def _events(
    plan: MarchPlan, free: FreeNetwork, acting: Sequence[Sequence[AppliedLoad]], sizes: Sequence[fmpq]
) -> Iterator[AmplitudeEvent]:
    """At each change of a load all that acts is said again, so that nothing adds up."""
    for force, number in enumerate(plan.loaded_points):
        powers, size = _unit_loads(plan.model.network.points[number], free.network.points[number])
        gains: dict[tuple[fmpq, int], fmpq_poly] = defaultdict(fmpq_poly)
        for load, changes in enumerate(acting):
            for change in changes:
                gains[change.time, load] += change.weight * powers.get(change.source, fmpq_poly())
        begun: set[int] = set()
        for event in load_events(gains, (panel.start for panel in plan.panels), plan.step):
            strength = size * free.factors.load / sizes[event.force]
            terms = [(power, weight) for power, weight in enumerate(event.powers) if weight] or [(0, fmpq(0))]
            for place, (power, weight) in enumerate(terms):
                replaces = event.force in begun and place == 0
                yield AmplitudeEvent(event.window, event.panel, force, power, strength, event.force, weight, replaces)
            begun.add(event.force)


def _unit_loads(own: Point, free: Point) -> tuple[dict[str, fmpq_poly], Function]:
    """Polynomials in time for each source, and the function that all of them are multiplied by."""
    powers = {unit.source: fmpq_poly(list(unit_action(own, unit))) for unit in own.loads}
    first = unit_action(free, free.loads[0])
    size = next(coefficient for coefficient in first if coefficient != 0)
    if not isinstance(size, Ratio):
        return powers, fmpq(1)
    known = next(coefficient for coefficient in unit_action(own, own.loads[0]) if coefficient != 0)
    return {source: power / known for source, power in powers.items()}, size


def _strands(plan: MarchPlan, output_terms: Sequence[tuple[int, OutputTerm]]) -> Iterator[Strand]:
    groups: dict[tuple[fmpq, fmpq, int], list[StrandTerm]] = {}
    for number, (output, wave) in enumerate(output_terms):
        for stretch in plan.stretches(wave.delay):
            half = plan.panels[stretch.panel].length / 2
            low = max(-stretch.start / half - 1, fmpq(-1))
            high = min((plan.step - stretch.start) / half - 1, fmpq(1))
            groups.setdefault((stretch.start, half, output), []).append(StrandTerm(number, wave, stretch, low, high))
    # in the order of time, so that integrals go on from stretch to stretch; what is read at the same instants together
    for (start, half, output), terms in sorted(groups.items(), key=lambda group: group[0]):
        yield Strand(output, start, half, tuple(terms))


def as_one_load(model: Model) -> list[AppliedLoad]:
    """All loads of a model, none of which has an amplitude of its own."""
    loads = tuple(load for load in model.loads if load.source != "impact")
    return [AppliedRecord(loads[0].source, loads[0].time, fmpq(1), loads)] if loads else []


def ordered_events(events: Iterable[AmplitudeEvent]) -> tuple[AmplitudeEvent, ...]:
    """In the order of time. UnservedError where samples, which replace each other, have an amplitude beside another."""
    found = tuple(sorted(events, key=lambda event: (event.window, event.panel)))
    for force in {event.force for event in found if event.replaces}:
        if len({event.load for event in found if event.force == force}) > 1:
            raise UnservedError(
                "--runtime: load where samples act beside another load on the same body is not supported; add up "
                "the samples, or leave load out"
            )
    return found


def zero_outputs(model: Model, loads: Sequence[AppliedLoad], real: Real) -> list[bool]:
    """Whether each output of a model that has the numbers drawn is 0 up to the horizon, whatever `loads` amount to.

    Of each source the first is enough: others do the same later.
    """
    until = rational(model.horizon(real))
    first: dict[str, fmpq] = {}
    for change in (change for load in loads for change in load.changes if change.time <= until):
        first[change.source] = min(change.time, first.get(change.source, until))
    acting = (AppliedLoad(source, time, drawn_number(source)) for source, time in first.items())
    return identically_zero(replace(model, loads=tuple(sorted(acting, key=lambda load: load.time))), until)


def shared_readings(strands: Sequence[Strand], numbers: Sequence[int]) -> Iterator[SharedReading]:
    """Those of a section, whose strands have these numbers, in order: those at the same instants follow each other, so
    that all share the T_k(u) there.
    """
    outputs: set[int] = set()
    instants = []
    for number in numbers:
        strand = strands[number]
        instants.append((strand.start, strand.half, strand.output in outputs))
        outputs.add(strand.output)
    for (*_, more), group in groupby(zip(instants, numbers, strict=True), key=lambda each: each[0]):
        together = [number for _, number in group]
        yield SharedReading(together[0], len(together), more)


def reading_tables(
    strands: Sequence[Strand], sections: Sequence[Sequence[Sequence[int]]]
) -> dict[str, tuple[int, ...]]:
    """Tables of the readings of all sections, of which each is the strands of every output."""
    found = [
        list(shared_readings(strands, sorted(number for output in outputs for number in output)))
        for outputs in sections
    ]
    every = [reading for section in found for reading in section]
    return {
        "strand_output": tuple(strand.output for strand in strands),
        "first_reading": firsts(map(len, found)),
        "reading_strand": tuple(reading.strand for reading in every),
        "reading_strands": tuple(reading.strands for reading in every),
        "reading_more": tuple(int(reading.more) for reading in every),
    }
