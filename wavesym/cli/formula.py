"""`wavesym formula`."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import (
    OUT,
    SCENE,
    Seconds,
    TimeParameter,
    deliver,
    format_option,
    in_unit,
    put_notes,
    refuse_out,
)
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene


@click.command()
@click.argument("scene", type=SCENE)
@click.option("--output", required=True, metavar="NAME", help='Which output, such as "strain@0.5".')
@click.option(
    "--until",
    type=TimeParameter(),
    metavar="T",
    help='An earlier end, in tau; with [units] in that of results, or as "2 ms".',
)
@click.option("--symbolic", is_flag=True, help="Coefficients as functions of the parameters: of the paper's systems.")
@format_option("text", "latex", "sympy", "c", help="How it is written; sympy: one expression in tau, c: a function.")
@OUT
def formula(
    scene: Scene, output: str, until: Fraction | Seconds | None, symbolic: bool, format: str, out: Path | None
) -> None:
    """Print an output as a formula, exact.

    Print an output in closed form: what it gains at each breakpoint, exponentials times powers with exact coefficients,
    in numbers or, with --symbolic, in the letters of the paper.

    \b
    Example:
      wavesym formula drive_m1 --output strain@0 --until 3
    """
    from wavesym import api

    refuse_out(out)
    with progress(f"formula {scene.name}"):
        text = api.formula(scene, output, in_unit(until, scene, "--until", tau=False), format, symbolic=symbolic)
        notes = api.scene_notes(scene, values=False)
    put_notes(scene, notes)
    deliver(text, out)
