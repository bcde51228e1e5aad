"""`wavesym schema`."""

from __future__ import annotations

from pathlib import Path

import click

from wavesym.cli.parameters import PATH, put, refuse_unwritable


@click.command()
@click.option("-o", "out", type=PATH, metavar="FILE", help="Where it goes.  [default: standard output]")
def schema(out: Path | None) -> None:
    """Print the JSON schema of scenes, for editors.

    An editor that knows it completes the keys of a scene, explains them and marks those that there are not. The first
    line of what `wavesym init` prints names the file.

    \b
    Example:
      wavesym schema -o scene.schema.json
    """
    from wavesym.scene.schema import scene_schema
    from wavesym.writing import write_whole

    if out is None:
        put(scene_schema())
        return
    refuse_unwritable(out)
    write_whole({out: scene_schema()})
