"""`wavesym verify`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import SCENE, put

if TYPE_CHECKING:
    from wavesym.scene import Scene


@click.command()
@click.argument("scenes", type=SCENE, nargs=-1, metavar="[SCENE]...")
def verify(scenes: tuple[Scene, ...]) -> int:
    """Compare evaluators with direct integration; exit 1 where one is out of tolerance.

    Without SCENE, all built-in scenes.

    \b
    Example:
      wavesym verify collision_m4 drive_m1
    """
    from wavesym import compiler
    from wavesym.scene import Scene, builtin_names

    table, allowed = compiler.verify(scenes or [Scene.from_toml(name) for name in builtin_names()])
    put(table)
    return 0 if allowed else 1
