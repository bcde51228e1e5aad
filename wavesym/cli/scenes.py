"""`wavesym scenes`."""

from __future__ import annotations

from pathlib import Path

import click

from wavesym.cli.parameters import OUT, deliver, refuse_out


@click.command()
@click.argument("name", required=False)
@click.option("--explicit", is_flag=True, help="Write it out as a chain, part by part; NAME may be any SCENE.")
@OUT
def scenes(name: str | None, explicit: bool, out: Path | None) -> None:
    """List the built-in scenes, or print one of them as TOML.

    \b
    Example:
      wavesym scenes building_m2 --explicit
    """
    from wavesym.results.presentation import align_columns
    from wavesym.scene import Scene, builtin_names, builtin_text
    from wavesym.scene.explicit_text import explicit_text

    if explicit and name is None:
        raise click.UsageError("--explicit: of no scene; write the NAME of a built-in one before it")
    refuse_out(out)
    if name is not None:
        scene = Scene.from_toml(name) if explicit else None
        if scene is None or (name in builtin_names() and scene.system.type == "chain"):
            deliver(builtin_text(name), out)
        else:
            deliver(explicit_text(scene), out)
        return
    described = builtin_names()
    deliver("".join(f"{line}\n" for line in align_columns(list(described.items()), left=(0, 1))), out)
