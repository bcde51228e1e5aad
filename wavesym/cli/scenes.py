"""`wavesym scenes`."""

from __future__ import annotations

import click


@click.command()
def scenes() -> None:
    """List the built-in scenes.

    \b
    Example:
      wavesym scenes
    """
    from wavesym.scene import builtin_names

    described = builtin_names()
    width = max(map(len, described))
    for name, description in described.items():
        click.echo(f"{name:{width}}  {description}")
