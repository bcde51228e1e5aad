"""What is marched when parameters come at run time: the plan of a march over symbols, and where outputs listen.

Lengths, speeds and the instants of loads stay, so panels, delays and stretches are numbers. What a node makes of waves,
what it starts with, how strong a load is and what an output weighs are rational functions of the parameters.

An output is a sum of waves. Between two cuts of a window, on a section, each of them is one polynomial. Waves that were
sent at the same instant, on panels of the same length, are added up once, to a strand.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import fmpq, fmpq_poly

from wavesym.exact.joints.node_rules import node_rule
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import network_of
from wavesym.mechanics.node import Node, Parameters
from wavesym.numbers.doubles import rational
from wavesym.numbers.ratio import Ring
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.march.plan import Stretch
from wavesym.programs.runtime.line import HeardWave, Plan, panels, plan
from wavesym.programs.runtime.pushes import Push, ordered, told
from wavesym.programs.runtime.quiet import drawn, quiet
from wavesym.programs.runtime.request import RuntimeField
from wavesym.programs.runtime.units import Function, force_kept, load_kept

HELPS = "in tau, to which samples may be interpolated in a scene without units"
"""Beside another spacing, where loads leave too many panels."""


@dataclass(frozen=True)
class StrandTerm:
    """A wave on one of its stretches. `low` and `high` are where, on [-1, 1], its integral begins and ends."""

    heard: int
    wave: HeardWave
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

    @property
    def begin(self) -> fmpq:
        """From when on, in a window, it counts."""
        return max(self.start, fmpq(0))

    @property
    def end(self) -> fmpq:
        """Until when."""
        return min(self.start + 2 * self.half, fmpq(1))


@dataclass(frozen=True)
class RuntimePlan:
    """`plan` has symbols for parameters and no loads; `model` is the scene's own, `loads` are what acts, but for 0.

    Of each output `silent` says whether it is 0 whatever the parameters are.
    """

    model: Model
    plan: Plan
    ring: Ring
    fields: tuple[RuntimeField, ...]
    loads: tuple[Applied, ...]
    pushes: tuple[Push, ...]
    heard: tuple[tuple[int, HeardWave], ...]
    strands: tuple[Strand, ...]
    silent: tuple[bool, ...]

    @property
    def sections(self) -> tuple[fmpq, ...]:
        """Where they begin in a window, and 1."""
        return (*sorted({strand.begin for strand in self.strands} | {fmpq(0)}), fmpq(1))

    def listening(self, section: int, output: int) -> list[int]:
        """The strands that are an output on a section."""
        at = self.sections[section]
        return [n for n, s in enumerate(self.strands) if s.output == output and s.begin <= at < s.end]


def runtime_plan(
    model: Model, given: Sequence[RuntimeField], loads: Sequence[Applied], real: Real = DOUBLE
) -> RuntimePlan:
    """The plan of a model with the fields `given` at run time; each of `loads` has an amplitude.

    CostError as for a march, UnservedError where the samples of a load have an amplitude beside another one.
    """
    ring, free = free_chain(model, given)
    some = _with(model.named, given, drawn(given))
    silent = quiet(replace(model, chain=some, network=network_of(some)), loads, real)
    chosen = [unit.size for field in given if field.name == "load" for unit in field.units]
    units = chosen or [fmpq(1)] * len(loads)
    until = rational(model.horizon(real))
    acting = [[change for change in load.changes if change.time <= until] for load in loads]
    made = replace(
        plan(replace(model, chain=free, network=network_of(free), loads=()), real),
        panels=panels([change.time for changes in acting for change in changes], HELPS),
    )
    kept: list[Any] = [force_kept(model, free) if probe.quantity == "force" else fmpq(1) for probe in model.probes]
    heard = tuple(
        (number, replace(wave, gain=fmpq(0) if silent[number] else wave.gain * kept[number]))
        for number, output in enumerate(made.outputs)
        for wave in output.heard
    )
    return RuntimePlan(
        model,
        made,
        ring,
        tuple(given),
        tuple(
            replace(change, weight=change.weight * (load.weight or 1))
            for load, changes in zip(loads, acting, strict=True)
            for change in changes
        ),
        _pushes(made, model.named, acting, units, load_kept(model, free)),
        heard,
        tuple(_strands(made, heard)),
        tuple(silent),
    )


def free_chain(model: Model, given: Sequence[RuntimeField]) -> tuple[Ring, Chain]:
    """A named chain with symbols for the parameters `given` at run time, which are told in their units."""
    chain = model.named
    symbols = [label for field in given if field.name != "load" for label in field.labels]
    ring = Ring(tuple(symbols))
    return ring, _with(chain, given, ring.symbols())


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


def _pushes(
    made: Plan, own: Chain, acting: Sequence[Sequence[Applied]], units: Sequence[fmpq], kept: Function
) -> tuple[Push, ...]:
    """In the order of time; `own` has the scene's numbers."""
    found = []
    for force, column in enumerate(made.loaded):
        node = made.model.named.nodes[made.first + column]
        rule = node_rule(node)
        powers, size = _unit_loads(own.nodes[made.first + column], node)
        for number, changes in enumerate(acting):
            strength = size * (rule.load / rule.same) * kept / units[number]
            for time, power, weight, anew in told(changes, powers):
                window = int(time.floor())
                panel = next(place for place, panel in enumerate(made.panels) if panel.start == time - window)
                found.append(Push(window, panel, force, power, strength, number, weight, anew))
    return ordered(found)


def _unit_loads(own: Node, node: Node) -> tuple[dict[str, fmpq_poly], Function]:
    """Polynomials in time for each source, and the function that all of them are multiplied by."""
    first = next(k for k, coefficient in enumerate(own.loads[0].coefficients) if coefficient != 0)
    size = own.loads[0].coefficients[first]
    powers = {unit.source: fmpq_poly([coefficient / size for coefficient in unit.coefficients]) for unit in own.loads}
    return powers, node.loads[0].coefficients[first]


def _strands(made: Plan, heard: Sequence[tuple[int, HeardWave]]) -> Iterator[Strand]:
    groups: dict[tuple[fmpq, fmpq, int], list[StrandTerm]] = {}
    for number, (output, wave) in enumerate(heard):
        for stretch in made.stretches(wave.delay):
            half = made.panels[stretch.panel].length / 2
            low, high = max(-stretch.start / half - 1, fmpq(-1)), min((1 - stretch.start) / half - 1, fmpq(1))
            term = StrandTerm(number, wave, stretch, low, high)
            groups.setdefault((stretch.start, half, output), []).append(term)
    # in the order of time, so that integrals go on from stretch to stretch; what is read at the same instants together
    for (start, half, output), terms in sorted(groups.items(), key=lambda group: group[0]):
        yield Strand(output, start, half, tuple(terms))
