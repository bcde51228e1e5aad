"""What a simulator sees: time, loads, outputs, what is lost, parameters, what is fixed, and one choice; and units."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from flint import fmpq

from wavesym.fields.quantity import base_units
from wavesym.numbers.doubles import nearest, rational
from wavesym.programs.program import Program
from wavesym.programs.runtime.network import RuntimeField
from wavesym.targets.literals import literal


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU, by its value `reference`. `kind` is that of its value, "Real" or "Boolean".

    `start` is empty where it is computed; `dependencies` of an output are references of the inputs that act at once.
    """

    name: str
    causality: str
    variability: str
    about: str
    start: str = ""
    unit: str = ""
    kind: str = "Real"
    dependencies: tuple[int, ...] = ()
    reference: int = 0

    @property
    def initial(self) -> str:
        """How its first value comes about; empty where that is clear."""
        if self.variability == "constant":
            return "exact"
        return "calculated" if self.causality in ("output", "local") else ""

    @property
    def kind3(self) -> str:
        """What FMI 3 calls its kind."""
        return {"Real": "Float64"}.get(self.kind, self.kind)

    @property
    def place(self) -> int:
        """Its number in FMI 2, which counts from 1."""
        return 1 + self.reference

    @property
    def dependency_places(self) -> tuple[int, ...]:
        """Its dependencies, so counted."""
        return tuple(1 + reference for reference in self.dependencies)


def variables(program: Program) -> tuple[Variable, ...]:
    """All of them, in the order of their references, which is that of templates/fmu/model.h.j2."""
    return tuple(replace(one, reference=reference) for reference, one in enumerate(_variables(program)))


def parameters(program: Program) -> tuple[RuntimeField, ...]:
    """What of the model may be set."""
    return program.laws.fields if program.laws else ()


def _variables(program: Program) -> Iterator[Variable]:
    model, stepped = program.provenance.model, program.has_equal_steps
    seconds = "s" if model.clock else ""
    yield Variable("time", "independent", "continuous", "time" if seconds else "time in tau", unit=seconds)
    for source in program.sources:
        name, _, unit = source.partition(" [")
        label = model.labels.sources.get(name) or model.labels.sources[f"{name}:step"]
        about = f"{label}, from the start of a step on, or at its end where linear is true"
        yield Variable(f"load@{name}", "input", "continuous", about, "0.0", unit.removesuffix("]"))
    direct = program.direct or ((),) * len(program.outputs)
    for output, probe, of in zip(program.outputs, model.probes, direct, strict=True):
        about = f"{probe.title}{': ' if probe.title else ''}{probe.quantity} at {output.name.partition('@')[2]}"
        at_once = tuple(1 + j for j in of)
        yield Variable(output.name, "output", "continuous", about, unit=probe.unit, dependencies=at_once)
    if not stepped:
        about = "what inputs that change inside of panels have cost, of the largest wave: an estimate"
        yield Variable("lost", "local", "continuous", about)
    clock = model.clock.seconds if model.clock else fmpq(1)
    if stepped:
        about = "steps are whole multiples of this"
    else:
        about = "inputs that change at its multiples alone cost no accuracy"
    length = program.constants[program.step]
    yield Variable(program.step, "local", "constant", about, f"{nearest(rational(length) * clock):.15g}", seconds)
    settable = parameters(program)
    for name, numbers in model.letters.items():
        for index, value in numbers.items() if name not in {field.name for field in settable} else ():
            about = "what the model was made with; a change takes another one"
            yield Variable(f"{name}_{index}", "local", "constant", about, literal(nearest(value)))
    for field in settable:
        for label, caption, value, given in zip(field.labels, field.captions, field.values, field.units, strict=True):
            about = f"{caption}; may be set until initialization is over"
            yield Variable(label, "parameter", "fixed", about, literal(nearest(value)), given.text)
    about = "whether a load goes in a straight line to its value at the end of a step; else it is held over the step"
    yield Variable("linear", "parameter", "fixed", about, str(stepped).lower(), kind="Boolean")


@dataclass(frozen=True)
class DefinedUnit:
    """A unit as FMI writes it: powers of SI base units that are not 0, and the factor where it is not 1."""

    name: str
    attributes: tuple[tuple[str, str], ...]


def define_units(names: Iterable[str]) -> tuple[DefinedUnit, ...]:
    """The units by these names, each once."""
    return tuple(map(_define_unit, sorted({name for name in names if name})))


def _define_unit(name: str) -> DefinedUnit:
    factor, powers = base_units(name)
    attributes = [(base, str(powers[base])) for base in ("kg", "m", "s", "rad") if powers.get(base)]
    if factor != 1:
        attributes.append(("factor", literal(nearest(rational(factor)))))
    return DefinedUnit(name, tuple(attributes))
