"""`wavesym frf`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import PATH, SCENE, decimals, format_option, is_drawn, put, put_notes, refuse_out
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene

POINTS = 400


@click.command()
@click.argument("scene", type=SCENE)
@click.option("--load", metavar="NAME|NUMBER", help="Which load: its node, or its number in the scene from 0 on.")
@click.option(
    "--from",
    "low",
    type=float,
    metavar="F",
    help="The first frequency, in Hz; without [units] in rad per tau.  [default: 1/400 of the last]",
)
@click.option("--to", "high", type=float, metavar="F", help="The last one.  [default: that of the fifth mode]")
@click.option("--points", type=click.IntRange(min=2), help=f"How many, equally spaced.  [default: {POINTS}]")
@click.option("--at", type=PATH, metavar="FILE", help="File of frequencies to use instead: one decimal a line.")
@click.option(
    "--peaks", is_flag=True, help="The greatest amplitude of each output in the band, enclosed, in their place."
)
@click.option(
    "--range",
    "ranges",
    multiple=True,
    metavar="PATH=A..B",
    help="The least and greatest amplitudes where a mass, spring or dashpot goes from A to B; any number.",
)
@format_option("csv", "json")
@click.option("-o", "out", type=PATH, metavar="FILE|PICTURE", help="Where it goes; .svg, .png, .pdf: drawn.")
def frf(
    scene: Scene,
    load: str | None,
    low: float | None,
    high: float | None,
    points: int | None,
    at: Path | None,
    peaks: bool,
    ranges: tuple[str, ...],
    format: str,
    out: Path | None,
) -> None:
    """Print frequency responses: amplitudes of outputs under a load.

    Print the complex amplitudes of the outputs under one unit of a load exp(+i w t), over frequency; with --peaks the
    greatest of each output between --from and --to. All are proved.

    \b
    Example:
      wavesym frf building_m2 --to 5 --points 11
    """
    from wavesym import api
    from wavesym.results.mode_ranges import read_box
    from wavesym.writing import write_whole

    context = click.get_current_context()
    if at is not None and not low is high is points is None:
        raise click.UsageError("--at excludes --from, --to and --points; write one or the other", context)
    drawn = is_drawn(out, (".csv", ".json"))
    if ranges and (peaks or drawn):
        raise click.UsageError("--range excludes --peaks and a picture; write one of them", context)
    refuse_out(out)
    with progress(f"frf {scene.name}"):
        frequencies = decimals(at) if at is not None else None
        few = 2 if peaks and not drawn else POINTS
        if ranges:
            box = read_box(ranges)
            over = api.frf(scene, frequencies, load, low=low, high=high, points=points or few, ranges=box)
            text = over.json() if format == "json" else "".join(over.csv())
            notes = over.notes
        else:
            found = api.frf(scene, frequencies, load, low=low, high=high, points=points or few)
            table = found.peaks() if peaks else found
            text = table.json() if format == "json" else "".join(table.csv())
            notes = (*found.notes, *table.notes) if peaks else found.notes
        if drawn and out is not None:
            api.plot_frf(scene, found, out)
        elif out is not None:
            write_whole({out: text})
    put_notes(scene, notes)
    if out is None or (drawn and peaks):
        put(text)
