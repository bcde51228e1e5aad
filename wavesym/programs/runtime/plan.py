"""What is marched when parameters come at run time: the plan of a march over symbols, and where outputs listen.

Lengths, speeds and the instants of loads stay, so panels, delays and stretches are numbers. What a node makes of waves,
what it starts with, how strong a load is and what an output weighs are rational functions of the parameters.

An output is a sum of waves. Between two cuts of a window, on a section, each of them is one polynomial. Waves that were
sent at the same instant, on panels of the same length, are added up once, to a strand.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import fmpq

from wavesym.exact.node_rules import node_rule
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import network_of
from wavesym.mechanics.node import Parameters
from wavesym.numbers.doubles import rational
from wavesym.numbers.ratio import Ring
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.march.plan import HeardWave, Plan, Stretch, panels, plan
from wavesym.programs.runtime.request import RuntimeField
from wavesym.programs.runtime.units import Function, force_kept, load_kept


@dataclass(frozen=True)
class Push:
    """From panel `panel` of window `window` on, `strength` times amplitude `load` times the `power` of the time since
    acts as load `force` (in the units of a law that is divided by g).
    """

    window: int
    panel: int
    force: int
    power: int
    strength: Function
    load: int


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
    """`plan` has symbols for parameters and no loads; `model` is the scene's own, `loads` have an amplitude each."""

    model: Model
    plan: Plan
    ring: Ring
    fields: tuple[RuntimeField, ...]
    loads: tuple[Applied, ...]
    pushes: tuple[Push, ...]
    heard: tuple[tuple[int, HeardWave], ...]
    strands: tuple[Strand, ...]

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
    """The plan of a model with the fields `given` at run time; CostError as for a march."""
    ring, free = free_chain(model, given)
    chosen = [unit.size for field in given if field.name == "load" for unit in field.units]
    units = chosen or [fmpq(1)] * len(loads)
    acting = [(load.time, number) for number, load in enumerate(loads) if load.time <= rational(model.horizon(real))]
    made = replace(
        plan(replace(model, chain=free, network=network_of(free), loads=()), real),
        panels=panels([time for time, _ in acting]),
    )
    kept: list[Any] = [force_kept(model, free) if probe.quantity == "force" else fmpq(1) for probe in model.probes]
    heard = tuple(
        (number, replace(wave, gain=wave.gain * kept[number]))
        for number, output in enumerate(made.outputs)
        for wave in output.heard
    )
    return RuntimePlan(
        model,
        made,
        ring,
        tuple(given),
        tuple(loads),
        tuple(_pushes(made, loads, [number for _, number in sorted(acting)], units, load_kept(model, free))),
        heard,
        tuple(_strands(made, heard)),
    )


def free_chain(model: Model, given: Sequence[RuntimeField]) -> tuple[Ring, Chain]:
    """A named chain with symbols for the parameters `given` at run time, which are told in their units."""
    chain = model.named
    symbols = [label for field in given if field.name != "load" for label in field.labels]
    ring = Ring(tuple(symbols))
    symbols_of = ring.symbols()
    own = {
        label: symbols_of[label] / unit.size
        for field in given
        if field.name != "load"
        for label, unit in zip(field.labels, field.units, strict=True)
    }

    def numbers(name: str) -> dict[int, Any] | None:
        values: dict[int, Any] | None = getattr(chain.parameters, name)
        return values and {i: own.get(f"{name}_{i}", value) for i, value in values.items()}

    parameters = Parameters(**{name: numbers(name) for name in ("kappa", "inertia", "velocity", "dashpot")})
    return ring, replace(chain, parameters=parameters)


def _pushes(
    made: Plan, loads: Sequence[Applied], acting: Sequence[int], units: Sequence[fmpq], kept: Function
) -> Iterator[Push]:
    places = {panel.start: number for number, panel in enumerate(made.panels)}
    nodes = made.model.named.nodes
    for number in acting:
        load = loads[number]
        window = int(load.time.floor())
        for force, column in enumerate(made.loaded):
            node = nodes[made.first + column]
            rule = node_rule(node)
            for unit in node.loads:
                for power, coefficient in enumerate(unit.coefficients):
                    if unit.source == load.source and coefficient != 0:
                        strength = coefficient * (rule.load / rule.same) * kept / units[number]
                        yield Push(window, places[load.time - window], force, power, strength, number)


def _strands(made: Plan, heard: Sequence[tuple[int, HeardWave]]) -> Iterator[Strand]:
    groups: dict[tuple[int, fmpq, fmpq], list[StrandTerm]] = {}
    for number, (output, wave) in enumerate(heard):
        for stretch in made.stretches(wave.delay):
            half = made.panels[stretch.panel].length / 2
            low, high = max(-stretch.start / half - 1, fmpq(-1)), min((1 - stretch.start) / half - 1, fmpq(1))
            term = StrandTerm(number, wave, stretch, low, high)
            groups.setdefault((output, stretch.start, half), []).append(term)
    # in the order of time, so that integrals go on from stretch to stretch
    for (output, start, half), terms in sorted(groups.items(), key=lambda group: group[0]):
        yield Strand(output, start, half, tuple(terms))
