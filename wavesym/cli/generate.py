"""`wavesym generate`."""

from __future__ import annotations

import json
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from wavesym.cli.parameters import (
    NAMES,
    PATH,
    SCENE,
    ParameterType,
    TimeParameter,
    in_unit,
    put,
    put_notes,
    scene_argument,
)
from wavesym.programs.request import AIMS, EVALUATORS, LANGUAGES, PRECISIONS, SIMULATORS, Request
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene

FINEST = {"double": Fraction(1, 10**13), "single": Fraction(1, 10**5)}  # of tolerances at run time


class PositiveParameter(ParameterType):
    """A positive number, exact: a decimal, or p/q; `form` says so, with an example."""

    name = "number"

    def __init__(self, form: str) -> None:
        self.form = form

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Fraction:
        """The number."""
        from wavesym.fields.numbers import exact

        try:
            number = exact(value)
        except ValueError:
            number = Fraction(0)
        if number <= 0:
            self.fail(f"{value} is not {self.form}", param, ctx)
        return number


KAPPA = PositiveParameter("a positive number; write one such as 5 or 1/2")


@click.command()
@click.argument("scene", type=SCENE)
@click.option("-o", "directory", type=PATH, metavar="DIR", help="Where the files go.  [default: ./NAME of the scene]")
@click.option(
    "--language", type=click.Choice(LANGUAGES), default="c", show_default=True, help="Which languages to write."
)
@click.option(
    "--evaluator", type=click.Choice(EVALUATORS), default="auto", show_default=True, help="How outputs are computed."
)
@click.option(
    "--precision", type=click.Choice(PRECISIONS), default="double", show_default=True, help="Type of all numbers."
)
@click.option(
    "--optimize",
    type=click.Choice(AIMS),
    help="What is best, of programs that will do.  [default: speed; for single precision size]",
)
@click.option(
    "--runtime",
    type=NAMES,
    default=(),
    metavar="LIST",
    help="Parameters that come at run time, with commas between: of kappa, inertia, velocity and load; of a chain that "
    "is written out mass, dashpot, spring, impedance, velocity and load; of modes stiffness, rod_mass, mass, damping "
    "and load. A stream takes them when it starts, all but load.",
)
@click.option(
    "--with",
    "parts",
    type=NAMES,
    default=(),
    metavar="LIST",
    help="What that C has besides values and the estimate of their errors, with commas between: of peaks, gradients, "
    "batch, misfit (which brings batch) and bound.",
)
@click.option(
    "--kappa-max",
    type=KAPPA,
    metavar="X",
    help="The largest kappa that it is made for, of a chain the largest rate of a joint: memory grows with its root.  "
    "[default: ten times the scene's]",
)
@click.option("--stream", is_flag=True, help="Take the loads sample by sample, from a controller, without end.")
@click.option(
    "--step",
    type=TimeParameter(),
    metavar="DTAU",
    help='For a stream whose steps all begin at multiples of this, in tau, as 1/8; with [units] also as "0.25 ms".',
)
@click.option("--package", is_flag=True, help="Add what builds, tests and installs C: CMake, ctest, pkg-config.")
@click.option("--target", type=click.Choice(SIMULATORS), help="Make one file, NAME.fmu, a stream for simulators.")
@click.option("--force", is_flag=True, help="Replace files that wavesym did not write, too.")
@click.option("--check", "only_check", is_flag=True, help="Write nothing; print a diff and exit 1 where files differ.")
def generate(
    scene: Scene,
    directory: Path | None,
    force: bool,
    only_check: bool,
    **options: Any,  # as `Request` has them
) -> int:
    """Write C, NumPy or an FMU that evaluates a scene.

    Write source files that evaluate a scene; print their paths, and on standard error why this evaluator.

    \b
    Example:
      wavesym generate building_m2 -o building --language all
    """
    from wavesym import api

    if only_check and (target := options["target"]):
        raise click.UsageError(
            f"--check: binaries of --target {target} differ by compiler and cannot be compared; leave --target out"
        )
    options["step"] = in_unit(options["step"], scene, "--step", tau=True)
    request = Request.from_options(**options)
    if only_check:
        with progress(f"check {scene.name}"):
            difference = api.check(scene, directory, request, scene_argument())
        if difference:
            put(difference)
        return 1 if difference else 0
    with progress(f"generate {scene.name}"):
        written = api.write(scene, directory, request, force=force)
    for path in written:
        click.echo(path)
    put_notes(scene, _notes(scene, request, written))
    return 0


def _notes(scene: Scene, request: Request, written: tuple[Path, ...]) -> Iterator[str]:
    """What to know of what was written."""
    from wavesym import api

    if request.target:
        yield from api.fmu_notes(written[0])
    if request.runtime and scene.tolerance < (finest := FINEST[request.precision]):
        yield f"tolerance {float(scene.tolerance):g} taken as {float(finest):.0e} at run time"
    yield from api.scene_notes(scene, values=not request.stream, step=request.step)
    for manifest in (path for path in written if path.suffix == ".json"):
        content = json.loads(manifest.read_text(encoding="utf-8"))
        yield from (str(content[key]) for key in ("reason", "shortfall") if key in content)
        if content.get("evaluator") == "modes" and request.language != "numpy" and not request.stream:
            name = scene.name
            yield (
                f"its C is a stream: {name}_step takes the loads sample by sample, {name.upper()}_SPACING apart, and "
                f"there is no {name}_eval; --language numpy has the loads of the scene in it"
            )
