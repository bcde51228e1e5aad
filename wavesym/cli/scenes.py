"""`wavesym scenes`."""

from __future__ import annotations

import click


@click.command()
@click.argument("name", required=False)
def scenes(name: str | None) -> None:
    """List the built-in scenes, or print one of them as TOML.

    \b
    Example:
      wavesym scenes building_m2
    """
    from wavesym.scene import builtin_names, builtin_text

    if name is not None:
        click.echo(builtin_text(name), nl=False)
        return
    described = builtin_names()
    width = max(map(len, described))
    for each, description in described.items():
        click.echo(f"{each:{width}}  {description}")
