"""`wavesym stability`."""

from __future__ import annotations

from pathlib import Path

import click

from wavesym.cli.parameters import PATH, refuse_unwritable, require_matplotlib
from wavesym.progress import progress


@click.command()
@click.option("-o", "directory", type=PATH, metavar="DIR", required=True, help="Where the pictures and tables go.")
def stability(directory: Path) -> None:
    """Draw where methods fail.

    Error against reflections, gaps of rates, kappa, and at fronts.

    Of chains that are written out: lengths that are nearly equal, springs from soft to stiff, dashpots near the
    impedance, contacts after many events, and where each program refuses.

    Of parameters at run time: what a model says of its error itself.

    Takes about four minutes, and a C compiler; prints the paths of what it wrote.

    \b
    Example:
      wavesym stability -o atlas
    """
    require_matplotlib()
    refuse_unwritable(directory, folder=True)
    with progress("stability") as line:
        from wavesym.lab.stability import atlas

        paths = atlas(directory, line.tell)
    for path in paths:
        click.echo(path)
