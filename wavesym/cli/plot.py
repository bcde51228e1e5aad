"""`wavesym plot`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import PATH, SCENE, put_notes, refuse_scene, refuse_unwritable, require_matplotlib
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene


@click.command()
@click.argument("scene", type=SCENE, required=False)
@click.option(
    "--published",
    is_flag=True,
    help="Figs. 6, 7 and 8 of the paper instead, into DIR, and a page of verdicts.",
)
@click.option(
    "--kind",
    type=click.Choice(["history", "xt", "envelope", "map"]),
    default="history",
    show_default=True,
    help="The outputs over time; place x time of all rods; least and greatest along the chain; storey x time.",
)
@click.option("-o", "out", type=PATH, metavar="FILE|DIR", required=True, help="The picture: .svg, .png or .pdf.")
def plot(scene: Scene | None, published: bool, kind: str, out: Path) -> None:
    """Draw the histories of a scene, or all of its chain.

    Draw the histories of a scene's outputs: what jumps is drawn as a jump. Or all of its chain.

    A place x time diagram (xt) is for horizons in which waves can be told apart, a storey x time map for long records.

    With --published, the figures of section 5 of the paper, with what it says of them marked and judged; takes half a
    minute, and prints the paths of what it wrote.

    \b
    Example:
      wavesym plot collision_m4 -o collision.svg
    """
    context = click.get_current_context()
    if published and scene:
        raise click.UsageError("SCENE and --published exclude each other; write one of them", context)
    require_matplotlib()
    if scene:
        refuse_scene(out)
    refuse_unwritable(out, folder=published)
    if scene:
        with progress(f"plot {scene.name}"):
            from wavesym import api

            lines = [*api.scene_notes(scene), *api.plot_with_notes(scene, out, kind)[1]]
        put_notes(scene, lines)
    elif published:
        with progress("plot --published"):
            from wavesym.pictures import figures
        for number in figures.FIGURES:
            with progress(f"plot --published: figure {number}"):
                paths = figures.write_figure(out, number)
            for path in paths:
                click.echo(path)
        with progress("plot --published: page"):
            page = figures.write_page(out)
        click.echo(page)
    else:
        raise click.MissingParameter(ctx=context, param_hint="'SCENE'", param_type="argument")
