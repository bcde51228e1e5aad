"""What is marched when parameters come at run time: the plan of a march over functions, and where outputs listen.

Lengths, speeds and the instants of loads stay, so panels, delays and stretches are numbers. What a joint makes of
waves, what it starts with, how strong a load is and what an output weighs are rational functions of the parameters.

An output is a sum of waves. Between two cuts of a window, on a section, each of them is one polynomial. Waves that were
sent at the same instant, on panels of the same length, are added up once, to a strand.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import fmpq, fmpq_poly

from wavesym.mechanics.loads import Applied, merged
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Point
from wavesym.numbers.doubles import rational
from wavesym.numbers.ratio import Ratio
from wavesym.numbers.reals import Real
from wavesym.programs.march.plan import MarchPlan, OutputTerm, Stretch, march_plan, moved_by
from wavesym.programs.march.space import joint_rows
from wavesym.programs.runtime.network import FreeNetwork
from wavesym.programs.runtime.pushes import Push, ordered, told
from wavesym.programs.runtime.quiet import quiet
from wavesym.programs.runtime.units import Function

HELPS = "in tau, to which samples may be interpolated in a scene without units"
"""Beside another spacing, where loads leave too many panels."""


@dataclass(frozen=True)
class StrandTerm:
    """A wave on one of its stretches. `low` and `high` are where, on [-1, 1], its integral begins and ends."""

    heard: int
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


@dataclass(frozen=True)
class RuntimePlan:
    """`plan` has joints that are functions, and no loads that matter; `own` is that of the scene's numbers.

    Of each output `silent` says whether it is 0 whatever the parameters are.
    """

    model: Model
    plan: MarchPlan
    own: MarchPlan
    free: FreeNetwork
    pushes: tuple[Push, ...]
    heard: tuple[tuple[int, Any], ...]
    strands: tuple[Strand, ...]
    silent: tuple[bool, ...]

    @property
    def sections(self) -> tuple[fmpq, ...]:
        """Where they begin in a window, and its end."""
        return (*sorted({max(strand.start, fmpq(0)) for strand in self.strands} | {fmpq(0)}), self.plan.step)

    def listening(self, section: int, output: int) -> list[int]:
        """The strands that are an output on a section."""
        at = self.sections[section]
        return [n for n, s in enumerate(self.strands) if s.output == output and s.start <= at < s.start + 2 * s.half]


def runtime_plan(model: Model, free: FreeNetwork, loads: Sequence[Applied], real: Real) -> RuntimePlan:
    """The plan of a chain; each of `loads` has an amplitude. CostError as for a march, UnservedError as `ordered`."""
    until = rational(model.horizon(real))
    acting = [[change for change in load.changes if change.time <= until] for load in loads]
    # as if each weighed 1, so that none of them is left out
    changes = {(change.time, change.source) for load in acting for change in load}
    felt = tuple(Applied(source, time, fmpq(1)) for time, source in sorted(changes))
    # which points loads act on is all that counts of them here
    points = zip(free.network.points, model.network.points, strict=True)
    network = replace(free.network, points=tuple(replace(point, loads=own.loads) for point, own in points))
    plan = march_plan(replace(model, network=network, loads=felt), real, joint_rows, HELPS)
    # in the scene each counts as it says, or, where that is 0, once
    known = (
        replace(change, weight=change.weight * (load.weight or 1))
        for load, changes in zip(loads, acting, strict=True)
        for change in changes
    )
    own = march_plan(replace(model, loads=merged(known)), real, helps=HELPS)
    silent = quiet(free.some, loads, real)
    kept: list[Any] = [free.factors.force if probe.quantity == "force" else fmpq(1) for probe in model.probes]
    heard = tuple(
        (number, replace(wave, gain=fmpq(0) if silent[number] else wave.gain * kept[number]))
        for number, output in enumerate(plan.outputs)
        for wave in output.heard
    )
    chosen = [unit.size for field in free.fields if field.name == "load" for unit in field.units]
    pushes = ordered(_pushes(plan, free, acting, chosen or [fmpq(1)] * len(loads)))
    return RuntimePlan(model, plan, own, free, pushes, heard, tuple(_strands(plan, heard)), tuple(silent))


def _pushes(
    plan: MarchPlan, free: FreeNetwork, acting: Sequence[Sequence[Applied]], sizes: Sequence[fmpq]
) -> Iterator[Push]:
    places = {panel.start: number for number, panel in enumerate(plan.panels)}
    for force, number in enumerate(plan.pushed):
        powers, size = _unit_loads(plan.model.network.points[number], free.network.points[number])
        for load, changes in enumerate(acting):
            for time, power, weight, anew in told(changes, powers):
                window = int((time / plan.step).floor())
                panel = places[time - window * plan.step]
                yield Push(window, panel, force, power, size * free.factors.load / sizes[load], load, weight, anew)


def _unit_loads(own: Point, free: Point) -> tuple[dict[str, fmpq_poly], Function]:
    """Polynomials in time for each source, and the function that all of them are multiplied by."""
    powers = {unit.source: fmpq_poly(list(moved_by(own, unit))) for unit in own.loads}
    first = moved_by(free, free.loads[0])
    size = next(coefficient for coefficient in first if coefficient != 0)
    if not isinstance(size, Ratio):
        return powers, fmpq(1)
    known = next(coefficient for coefficient in moved_by(own, own.loads[0]) if coefficient != 0)
    return {source: power / known for source, power in powers.items()}, size


def _strands(plan: MarchPlan, heard: Sequence[tuple[int, OutputTerm]]) -> Iterator[Strand]:
    groups: dict[tuple[fmpq, fmpq, int], list[StrandTerm]] = {}
    for number, (output, wave) in enumerate(heard):
        for stretch in plan.stretches(wave.delay):
            half = plan.panels[stretch.panel].length / 2
            low = max(-stretch.start / half - 1, fmpq(-1))
            high = min((plan.step - stretch.start) / half - 1, fmpq(1))
            groups.setdefault((stretch.start, half, output), []).append(StrandTerm(number, wave, stretch, low, high))
    # in the order of time, so that integrals go on from stretch to stretch; what is read at the same instants together
    for (start, half, output), terms in sorted(groups.items(), key=lambda group: group[0]):
        yield Strand(output, start, half, tuple(terms))
