"""What is marched of a chain when parameters come at run time: the plan of a march with rings, over functions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import fmpq, fmpq_poly

from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import Real
from wavesym.programs.march.plan import MarchPlan, OutputTerm, Stretch, march_plan, moved_by
from wavesym.programs.march.space import joint_rows
from wavesym.programs.runtime.joints.network import FreeNetwork
from wavesym.programs.runtime.plan import HELPS
from wavesym.programs.runtime.pushes import Push, ordered, told
from wavesym.programs.runtime.quiet import quiet


@dataclass(frozen=True)
class JointTerm:
    """A wave on one of its stretches. `low` and `high` are where, on [-1, 1], its integral begins and ends."""

    heard: int
    wave: OutputTerm
    stretch: Stretch
    low: fmpq
    high: fmpq


@dataclass(frozen=True)
class JointStrand:
    """What of an output is one polynomial in t - start on a part of every window; `half` that panel's length."""

    output: int
    start: fmpq
    half: fmpq
    terms: tuple[JointTerm, ...]


@dataclass(frozen=True)
class JointsPlan:
    """`plan` has joints that are functions, and no loads that matter; `own` is that of the scene's numbers.

    Of each output `silent` says whether it is 0 whatever the parameters are.
    """

    model: Model
    plan: MarchPlan
    own: MarchPlan
    free: FreeNetwork
    pushes: tuple[Push, ...]
    heard: tuple[tuple[int, Any], ...]
    strands: tuple[JointStrand, ...]
    silent: tuple[bool, ...]

    @property
    def sections(self) -> tuple[fmpq, ...]:
        """Where they begin in a window, and its end."""
        return (*sorted({max(strand.start, fmpq(0)) for strand in self.strands} | {fmpq(0)}), self.plan.step)

    def listening(self, section: int, output: int) -> list[int]:
        """The strands that are an output on a section."""
        at = self.sections[section]
        return [n for n, s in enumerate(self.strands) if s.output == output and s.start <= at < s.start + 2 * s.half]


def joints_plan(model: Model, free: FreeNetwork, loads: Sequence[Applied], real: Real) -> JointsPlan:
    """The plan of a chain; each of `loads` has an amplitude. CostError as for a march, UnservedError as `ordered`."""
    until = rational(model.horizon(real))
    acting = [[change for change in load.changes if change.time <= until] for load in loads]
    # as if each weighed 1, so that none of them is left out
    changes = {(change.time, change.source) for load in acting for change in load}
    felt = tuple(Applied(source, time, fmpq(1)) for time, source in sorted(changes))
    own = march_plan(replace(model, loads=felt), real)
    plan = march_plan(replace(model, network=free.network, loads=felt), real, joint_rows, HELPS)
    silent = quiet(replace(model, network=free.some), loads, real)
    heard = tuple(
        (number, replace(wave, gain=fmpq(0)) if silent[number] else wave)
        for number, output in enumerate(plan.outputs)
        for wave in output.heard
    )
    chosen = [unit.size for field in free.fields if field.name == "load" for unit in field.units]
    pushes = ordered(_pushes(plan, model, acting, chosen or [fmpq(1)] * len(loads)))
    return JointsPlan(model, plan, own, free, pushes, heard, tuple(_strands(plan, heard)), tuple(silent))


def _pushes(
    plan: MarchPlan, model: Model, acting: Sequence[Sequence[Applied]], sizes: Sequence[fmpq]
) -> Iterator[Push]:
    places = {panel.start: number for number, panel in enumerate(plan.panels)}
    for force, point in enumerate(model.network.points[k] for k in plan.pushed):
        powers = {unit.source: fmpq_poly(list(moved_by(point, unit))) for unit in point.loads}
        for number, changes in enumerate(acting):
            for time, power, weight, anew in told(changes, powers):
                window = int((time / plan.step).floor())
                panel = places[time - window * plan.step]
                yield Push(window, panel, force, power, 1 / sizes[number], number, weight, anew)


def _strands(plan: MarchPlan, heard: Sequence[tuple[int, OutputTerm]]) -> Iterator[JointStrand]:
    groups: dict[tuple[fmpq, fmpq, int], list[JointTerm]] = {}
    for number, (output, wave) in enumerate(heard):
        for stretch in plan.stretches(wave.delay):
            half = plan.panels[stretch.panel].length / 2
            low = max(-stretch.start / half - 1, fmpq(-1))
            high = min((plan.step - stretch.start) / half - 1, fmpq(1))
            groups.setdefault((stretch.start, half, output), []).append(JointTerm(number, wave, stretch, low, high))
    # in the order of time, so that integrals go on from stretch to stretch; what is read at the same instants together
    for (start, half, output), terms in sorted(groups.items(), key=lambda group: group[0]):
        yield JointStrand(output, start, half, tuple(terms))
