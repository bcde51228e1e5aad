"""A stream for simulators: its C, what FMI 2.0 or 3.0 calls it by, and the description of its variables."""

from __future__ import annotations

from dataclasses import dataclass

from flint import fmpq

from wavesym.numbers.doubles import nearest, rational
from wavesym.programs.program import Program
from wavesym.rendering import render, text_of
from wavesym.targets import c
from wavesym.targets.description import Description
from wavesym.targets.fmu.variables import DefinedUnit, Variable, define_units, parameters, variables
from wavesym.targets.literals import literal


@dataclass(frozen=True)
class FmuModel:
    """templates/fmu/model.h.j2: times in tau, as C writes them; `stepped` streams go on in equal steps.

    `positive` says of each of the `parameters` whether it has to be: "1" or "0".
    """

    scene: Description
    seconds: str
    inputs: str
    direct: str
    linear: str
    stepped: str
    constants: tuple[str, ...]
    parameters: tuple[Variable, ...]
    positive: tuple[str, ...]
    step: str
    longest: str


@dataclass(frozen=True)
class FmuDescription:
    """templates/fmu/modelDescription3.xml.j2: variables in the order of their references; times of the simulator.

    `about` says in a sentence what the model is and what time is.
    """

    scene: Description
    about: str
    variables: tuple[Variable, ...]
    units: tuple[DefinedUnit, ...]
    stepped: bool
    stop: str
    step: str


@dataclass(frozen=True)
class FmuSourced(FmuDescription):
    """templates/fmu/modelDescription2.xml.j2, which has the `files` to compile as well."""

    files: tuple[str, ...]


@dataclass(frozen=True)
class FmuBuild:
    """templates/fmu/buildDescription.xml.j2."""

    scene: Description
    files: tuple[str, ...]


def fmu_files(scene: Description, program: Program, version: str) -> dict[str, str]:
    """Text by place in the file that a simulator reads: sources and descriptions."""
    number, name = version.removeprefix("fmu"), scene.name
    compiled = (f"fmi{number}.c", f"{name}.c")
    sources = {file: text for file, text in c.files(scene, program).items() if not file.endswith("_selftest.c")}
    sources["model.h"] = render("fmu/model.h.j2", _model(scene, program))
    for file in (f"fmi{number}.c", f"fmi{number}.h", "simulation.h"):
        sources[file] = text_of(f"fmu/{file}")
    context = _description(scene, program)
    if version == "fmu3":
        sources["buildDescription.xml"] = render("fmu/buildDescription.xml.j2", FmuBuild(scene, compiled))
    else:
        context = FmuSourced(**vars(context), files=compiled)
    described = render(f"fmu/modelDescription{number}.xml.j2", context)
    return {"modelDescription.xml": described, **{f"sources/{file}": text for file, text in sorted(sources.items())}}


def _model(scene: Description, program: Program) -> FmuModel:
    found = variables(program)
    return FmuModel(
        scene=scene,
        seconds=scene.seconds or "1.0",
        inputs=str(len(program.sources)),
        direct=str(int(any(program.direct))),
        linear=str(int(program.has_equal_steps)),
        stepped=str(int(program.has_equal_steps)),
        constants=tuple(one.start for one in found if one.variability == "constant"),
        parameters=tuple(one for one in found if one.causality == "parameter" and one.kind == "Real"),
        positive=tuple(str(int(field.positive)) for field in parameters(program) for _ in field.values),
        step=literal(program.constants[program.step]),
        longest=literal(program.constants.get("longest", 0.0)),
    )


def _description(scene: Description, program: Program) -> FmuDescription:
    model = program.provenance.model
    found = variables(program)
    return FmuDescription(
        scene=scene,
        about=f"{scene.model[0]}. {scene.units.replace('Time is tau, of which one', 'One tau')}",
        variables=found,
        units=define_units(one.unit for one in found),
        stepped=program.has_equal_steps,
        stop=_time(program, model.until),
        step=_time(program, panel(program)),
    )


def panel(program: Program) -> fmpq:
    """How long a panel of a stream is, or its step where all are equal, in tau."""
    constants = program.constants
    if program.has_equal_steps:
        return rational(constants["spacing"])
    return rational(constants["panel"]) + rational(constants["panel_low"])


def _time(program: Program, tau: fmpq) -> str:
    """A tau as simulators count time, without the last digit, which is that of rounding."""
    clock = program.provenance.model.clock
    return f"{nearest(tau * clock.seconds if clock else tau):.15g}"
