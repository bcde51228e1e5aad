"""`wavesym init`."""

from __future__ import annotations

from pathlib import Path

import click

from wavesym.cli.parameters import OUT, PATH, deliver, refuse_out

KINDS = ("frame", "wall", "soil", "drive", "impact", "pile", "building", "collision")
USUAL = "building"


@click.command()
@click.argument("kind", type=click.Choice(KINDS), default=USUAL, metavar=f"[{'|'.join(KINDS)}]")
@click.option("--record", type=PATH, metavar="FILE", help="An AT2 or CSV file that is its load.")
@OUT
def init(kind: str, record: Path | None, out: Path | None) -> None:
    """Print a scene to start from, with comments.

    A frame, a wall, a column of soil, a drive, an impact of bars or a pile, in SI units; or the paper's building or
    collision, whose numbers have no units.

    \b
    Example:
      wavesym init frame -o frame.toml
    """
    from wavesym.scene.first_scene import first_text

    refuse_out(out)
    deliver(first_text(kind, record), out)
