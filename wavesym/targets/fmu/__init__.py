"""A stream for simulators: its C, what FMI 2.0 or 3.0 calls it by, and the description of its variables."""

from __future__ import annotations

from flint import fmpq

from wavesym.numbers.doubles import nearest, rational
from wavesym.programs.program import Program
from wavesym.rendering import render, text_of
from wavesym.targets import c
from wavesym.targets.description import Description
from wavesym.targets.fmu.variables import define_units, parameters, variables
from wavesym.targets.literals import literal


def fmu_files(scene: Description, program: Program, version: str) -> dict[str, str]:
    """Text by place in the file that a simulator reads: sources and descriptions."""
    number, name = version.removeprefix("fmu"), scene.name
    compiled = (f"fmi{number}.c", f"{name}.c")
    sources = {file: text for file, text in c.files(scene, program).items() if not file.endswith("_selftest.c")}
    sources["model.h"] = _model(scene, program)
    for file in (f"fmi{number}.c", f"fmi{number}.h", "simulation.h"):
        sources[file] = text_of(f"fmu/{file}")
    if version == "fmu3":
        sources["buildDescription.xml"] = render("fmu/buildDescription.xml.j2", scene=scene, files=compiled)
        described = _description(scene, program, "fmu/modelDescription3.xml.j2")
    else:  # which has the files to compile as well
        described = _description(scene, program, "fmu/modelDescription2.xml.j2", files=compiled)
    return {"modelDescription.xml": described, **{f"sources/{file}": text for file, text in sorted(sources.items())}}


def _model(scene: Description, program: Program) -> str:
    """What a simulator has to know of a stream; times in tau, as C writes them."""
    found = variables(program)
    return render(
        "fmu/model.h.j2",
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


def _description(scene: Description, program: Program, template: str, **files: tuple[str, ...]) -> str:
    """Variables in the order of their references; times of the simulator."""
    model = program.provenance.model
    found = variables(program)
    return render(
        template,
        scene=scene,
        about=f"{scene.model[0]}. {scene.units.replace('Time is tau, of which one', 'One tau')}",
        variables=found,
        units=define_units(one.unit for one in found),
        stepped=program.has_equal_steps,
        stop=_time(program, model.until),
        step=_time(program, panel(program)),
        **files,
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
