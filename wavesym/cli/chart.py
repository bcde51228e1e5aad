"""`wavesym chart`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import PATH, SCENE, put_notes, refuse_out, require_matplotlib
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene

SAMPLES = 10001


@click.command()
@click.argument("scene", type=SCENE)
@click.option("-o", "out", type=PATH, metavar="FILE", required=True, help="The picture: .svg, .png or .pdf.")
@click.option("--csv", "table", type=PATH, metavar="FILE", help="Where the numbers go.")
@click.option(
    "--samples",
    type=click.IntRange(101, 10**6),
    default=SAMPLES,
    show_default=True,
    help="How many values of each output are timed.",
)
def chart(scene: Scene, out: Path, table: Path | None, samples: int) -> None:
    """Draw speed against accuracy of all methods.

    Draw speed against accuracy: every evaluator of a scene, and other methods.

    Takes some tens of seconds, and a C api. Methods that do not take the scene are left out, and said to be.

    \b
    Example:
      wavesym chart building_m2 -o chart.svg --csv chart.csv
    """
    require_matplotlib()
    for path in filter(None, (out, table)):
        refuse_out(path)
    with progress(f"chart {scene.name}") as line:
        from wavesym.lab.chart.drawing import draw
        from wavesym.lab.chart.measure import measure, to_csv
        from wavesym.lab.chart.subjects import unsupported_methods
        from wavesym.pictures.saving import picture_format, save
        from wavesym.writing import write_whole

        picture_format(out)  # before the work, not after it
        measured = measure(scene, samples, line.tell)
        save(draw(scene, measured), out)
    put_notes(scene, (f"left out: {each}" for each in unsupported_methods(scene)))
    if table is not None:
        write_whole({table: to_csv(measured)})
