"""`wavesym tables`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import (
    PATH,
    SCENE,
    format_option,
    fragment_option,
    put,
    put_notes,
    refuse_out,
    written_format,
)
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene


def _refuse_m(context: click.Context, _: click.Parameter, m: str | None) -> None:
    """Say what to write in the place of --m, which `derive` has."""
    if m is not None:
        scenes = "write a scene, such as drive_equal, or what `wavesym init drive` prints"
        raise click.UsageError(f"--m: a table is that of a scene, which has its own m; {scenes}", context)


@click.command()
@click.argument("scene", type=SCENE)
@click.option(
    "--intervals",
    type=click.IntRange(min=1),
    help="How many of every function.  [default: those that the horizon needs]",
)
@click.option("--m", hidden=True, is_eager=True, expose_value=False, callback=_refuse_m)
@format_option("csv", "json", "latex")
@click.option(
    "--symbolic",
    is_flag=True,
    help="Rational functions of kappa_i, r_i = J_i/J_(i+1), u_i = v_(i-1) - v_(i+1); equal parameters are one symbol.",
)
@fragment_option
@click.option("-o", "out", type=PATH, metavar="FILE", help="Where the table goes.  [default: standard output]")
def tables(scene: Scene, intervals: int | None, format: str, symbolic: bool, fragment: bool, out: Path | None) -> None:
    """Print the exact coefficients of every wave function.

    \b
    Example:
      wavesym tables building_m2 --intervals 4 --symbolic
    """
    from wavesym import api
    from wavesym.documents.tables import table_lines
    from wavesym.writing import write_whole

    written = written_format(format, fragment)
    refuse_out(out)
    equations: list[str] = []
    with progress(f"tables {scene.name}"):
        if symbolic:
            equations, lines = api.symbolic_tables(scene, intervals, written)
        else:
            lines = table_lines(api.table(scene, intervals), scene.name, written)
        if out is not None:
            write_whole({out: lines})
        notes = api.scene_notes(scene, values=False)
    put_notes(scene, notes)
    for equation in equations:
        click.echo(equation, err=True)
    if out is None:
        put(lines)
