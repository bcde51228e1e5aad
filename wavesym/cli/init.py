"""`wavesym init`."""

from __future__ import annotations

import click

SYSTEMS = ["building", "drive", "collision"]


@click.command()
@click.argument("system", type=click.Choice(SYSTEMS), default=SYSTEMS[0])
def init(system: str) -> None:
    """Print a scene to start from, with a comment on every line; building if nothing is said.

    \b
    Example:
      wavesym init drive
    """
    from wavesym.scene import first_text

    click.echo(first_text(system), nl=False)
