"""`wavesym init`."""

from __future__ import annotations

from pathlib import Path

import click

from wavesym.cli.parameters import OUT, PATH, deliver, refuse_out
from wavesym.errors import printable

KINDS = ("frame", "wall", "soil", "drive", "impact", "pile", "building", "collision")
USUAL = "building"


@click.command()
@click.argument("kind", type=click.Choice(KINDS), default=USUAL, metavar=f"[{'|'.join(KINDS)}]")
@click.option("--record", type=PATH, metavar="FILE", help="An AT2 or CSV file that is its load.")
@click.option("--unit", metavar="U", help="The unit of its samples, such as g or m/s^2, where the file says none.")
@OUT
def init(kind: str, record: Path | None, unit: str | None, out: Path | None) -> None:
    """Print a scene to start from, with comments.

    A frame, a wall, a column of soil, a drive, an impact of bars or a pile, in SI units; or the paper's building or
    collision, whose numbers have no units. Where the file of a record names no unit, --unit does; without it a line on
    standard error says which one was assumed.

    \b
    Example:
      wavesym init frame --record ground.csv --unit m/s^2 -o frame.toml
    """
    from wavesym.scene.first_scene import first_scene

    refuse_out(out)
    first = first_scene(kind, record, unit)
    deliver(first.text, out)
    for assumption in first.assumptions:
        click.echo(f"init: {printable(assumption)}", err=True)
