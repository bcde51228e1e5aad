"""`wavesym inspect`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import OUT, SCENE, deliver, format_option, put, refuse_out
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene

STAGES = ["summary", "scene", "model", "laws", "table", "program"]


@click.command()
@click.argument("scene", type=SCENE)
@click.option("--stage", type=click.Choice(STAGES), help="What this stage makes of it.  [default: summary]")
@format_option("text", "json")
@OUT
def inspect(scene: Scene, stage: str | None, format: str, out: Path | None) -> None:
    """Show what each stage makes of a scene.

    Show what the compiler makes of a scene, stage by stage; what would be refused too, and why.

    \b
    Example:
      wavesym inspect building_m2 --stage model
    """
    from wavesym import api

    refuse_out(out)
    if out is not None:
        with progress(f"inspect {scene.name}"):
            text = api.inspect(scene, stage, format)
        deliver(text, out)
        return
    lines = api.inspect_lines(scene, stage, format)
    while True:
        with progress(f"inspect {scene.name}"):
            line = next(lines, None)
        if line is None:
            break
        put(line)
