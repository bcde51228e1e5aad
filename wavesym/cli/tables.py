"""`wavesym tables`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import PATH, SCENE, put

if TYPE_CHECKING:
    from wavesym.scene import Scene


@click.command()
@click.argument("scene", type=SCENE)
@click.option("--intervals", type=click.IntRange(min=1), help="Of every function; by default those the horizon needs.")
@click.option(
    "--format", type=click.Choice(["csv", "json", "latex"]), default="csv", show_default=True, help="How it is written."
)
@click.option("-o", "out", type=PATH, metavar="FILE", help="Where the table goes.  [default: standard output]")
def tables(scene: Scene, intervals: int | None, format: str, out: Path | None) -> None:
    """Print the exact coefficients of every wave function.

    \b
    Example:
      wavesym tables drive_m1 --intervals 4
    """
    from wavesym.compiler import tables_text
    from wavesym.writing import write_whole

    lines = tables_text(scene, intervals, format)
    if out is None:
        put(lines)
    else:
        write_whole({out: lines})
