"""`wavesym stability`."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

import click

from wavesym.cli.parameters import PATH


@click.command()
@click.option("-o", "directory", type=PATH, metavar="DIR", required=True, help="Where the pictures and tables go.")
def stability(directory: Path) -> None:
    """Run and draw where methods fail: error against reflections, gaps of rates, kappa, degree, and at fronts.

    Takes two or three minutes, and a C compiler; prints the paths of what it wrote.

    \b
    Example:
      wavesym stability -o atlas
    """
    if not find_spec("matplotlib"):
        raise click.UsageError("matplotlib is not installed: pip install 'wavesym[plot]'", click.get_current_context())

    from wavesym.report.stability import atlas

    paths = atlas(directory, progress=_tell)
    _tell("")
    for path in paths:
        click.echo(path)


def _tell(what: str) -> None:
    """What is computed at present, on a terminal."""
    if sys.stderr.isatty():
        click.echo(f"\r\x1b[K{what}", nl=False, err=True)
