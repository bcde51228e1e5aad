"""`wavesym scenes`."""

from __future__ import annotations

import click


@click.command()
@click.argument("name", required=False)
@click.option("--explicit", is_flag=True, help="Write it out as a chain, part by part; NAME may be any SCENE.")
def scenes(name: str | None, explicit: bool) -> None:
    """List the built-in scenes, or print one of them as TOML.

    \b
    Example:
      wavesym scenes building_m2 --explicit
    """
    from wavesym.scene import Scene, builtin_names, builtin_text

    if name is not None and explicit and (scene := Scene.from_toml(name)).system.type != "chain":
        from wavesym.scene.explicit_text import explicit_text

        click.echo(explicit_text(scene), nl=False)
        return
    if name is not None:
        click.echo(builtin_text(name), nl=False)
        return
    if explicit:
        raise click.UsageError("--explicit given without NAME, the name of a built-in scene expected")
    described = builtin_names()
    width = max(map(len, described))
    for each, description in described.items():
        click.echo(f"{each:{width}}  {description}")
