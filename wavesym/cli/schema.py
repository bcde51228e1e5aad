"""`wavesym schema`."""

from __future__ import annotations

from pathlib import Path

import click

from wavesym.cli.parameters import OUT, deliver, refuse_out


@click.command()
@OUT
def schema(out: Path | None) -> None:
    """Print the JSON schema of scenes, for editors.

    An editor that knows it completes the keys of a scene, explains them and marks those that there are not. The first
    line of what `wavesym init` prints names the file.

    \b
    Example:
      wavesym schema -o scene.schema.json
    """
    from wavesym.scene.schema import scene_schema

    refuse_out(out)
    deliver(scene_schema(), out)
