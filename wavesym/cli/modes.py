"""`wavesym modes`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import PATH, SceneParameter, format_option, is_drawn, put, put_notes, refuse_out
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene

COUNT = 10


@click.command()
@click.argument("scene", type=SceneParameter(needs_output=False))
@click.option("--count", type=click.IntRange(min=1), help=f"How many modes.  [default: {COUNT}]")
@click.option("--below", type=float, metavar="F", help="All below a frequency, in Hz; without [units] in rad per tau.")
@click.option(
    "--range",
    "ranges",
    multiple=True,
    metavar="PATH=A..B",
    help="The range of each frequency where a mass, spring, modulus or density goes from A to B; any number.",
)
@click.option("--shapes", is_flag=True, help="How far each node moves, too.")
@click.option("--points", type=click.IntRange(min=2), help="Shapes at so many points of each rod; as json or csv.")
@format_option("text", "json", "csv")
@click.option("-o", "out", type=PATH, metavar="FILE|PICTURE", help="Where it goes; .svg, .png, .pdf: shapes, drawn.")
def modes(
    scene: Scene,
    count: int | None,
    below: float | None,
    ranges: tuple[str, ...],
    shapes: bool,
    points: int | None,
    format: str,
    out: Path | None,
) -> None:
    """Print the frequencies of a chain, none missed.

    Each with its damping ratio, its period, and what of the mass moves with the supports. A scene needs neither loads
    nor outputs for it; dashpots and absorbing ends make frequencies complex.

    \b
    Example:
      wavesym modes building_m2 --count 3
    """
    from wavesym import api
    from wavesym.results.mode_ranges import read_box
    from wavesym.writing import write_whole

    context = click.get_current_context()
    if count is not None and below is not None:
        raise click.UsageError("--count and --below exclude each other; write one of them", context)
    drawn = is_drawn(out, (".txt", ".json", ".csv"))
    if ranges and (below is not None or shapes or drawn):
        raise click.UsageError("--range excludes --below, --shapes and a picture; write one of them", context)
    if points is not None and (format == "text" or ranges):
        raise click.UsageError("--points: shapes along rods are tables; write --format json or csv", context)
    refuse_out(out)
    with progress(f"modes {scene.name}"):
        if ranges:
            box = api.modes(scene, count or COUNT, ranges=read_box(ranges))
            text, notes = {"text": box.text, "json": box.json, "csv": box.csv}[format](), box.notes
        else:
            found = api.modes(scene, count or COUNT, below, points=points)
            text, notes = {"text": found.text, "json": found.json, "csv": found.csv}[format](shapes=shapes), found.notes
        if drawn and out is not None:
            api.plot_modes(scene, found, out)
        elif out is not None:
            write_whole({out: text})
    put_notes(scene, notes)
    if out is None or drawn:
        put(text)
