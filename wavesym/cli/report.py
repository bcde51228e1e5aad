"""`wavesym report`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from wavesym.cli.parameters import PATH, SCENE, ParameterType, put_notes, refuse_scene, refuse_unwritable
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene


class _Source(ParameterType):
    """A scene, or the folder of a sweep."""

    name = "scene"
    shell_complete = SCENE.shell_complete

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Scene | Path:
        """The folder as a path, of anything else the scene."""
        if isinstance(value, str) and Path(value).is_dir():
            return Path(value)
        return SCENE.convert(value, param, ctx)


@click.command()
@click.argument("scene", type=_Source())
@click.option("-o", "out", type=PATH, metavar="FILE.html", required=True, help="The page.")
def report(scene: Scene | Path, out: Path) -> None:
    """Write one page of HTML about a scene or a sweep.

    Write one page of HTML about a scene: the structure, histories, extremes, and how well all of it is known.

    Of the folder of a sweep it has the worst cases and their scenes, a map, and a table. It needs no network, and is
    complete without script.

    \b
    Example:
      wavesym report building_m2 -o building.html
    """
    if out.suffix.lower() not in (".html", ".htm"):
        raise click.UsageError(f"-o: {out} is not a page; write a name that ends in .html", click.get_current_context())
    refuse_unwritable(out)
    if isinstance(scene, Path):
        from wavesym import api

        api.sweep_report(scene, out)
        return
    refuse_scene(out)
    with progress(f"report {scene.name}"):
        from wavesym import api

        warnings = api.scene_notes(scene)
        api.report(scene, out)
    put_notes(scene, warnings)
