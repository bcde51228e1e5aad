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
    from wavesym.scene.explicit_text import explicit_text

    if explicit and name is None:
        raise click.UsageError("--explicit: of no scene; write the NAME of a built-in one before it")
    if name is not None:
        scene = Scene.from_toml(name) if explicit else None
        if scene is None or (name in builtin_names() and scene.system.type == "chain"):
            click.echo(builtin_text(name), nl=False)
        else:
            click.echo(explicit_text(scene), nl=False)
        return
    described = builtin_names()
    width = max(map(len, described))
    for each, description in described.items():
        click.echo(f"{each:{width}}  {description}")
