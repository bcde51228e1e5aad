"""`wavesym chart`."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import PATH, SCENE, refuse_scene, refuse_unwritable
from wavesym.cli.progress import progress

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
    if not find_spec("matplotlib"):
        raise click.UsageError("matplotlib is not installed: pip install 'wavesym[plot]'", click.get_current_context())

    for path in filter(None, (out, table)):
        refuse_scene(path)
        refuse_unwritable(path)
    with progress(f"chart {scene.name}") as line:
        from wavesym.lab.chart.drawing import draw
        from wavesym.lab.chart.measure import measure, to_csv
        from wavesym.lab.chart.subjects import unsupported_methods
        from wavesym.pictures.saving import picture_format, save
        from wavesym.writing import write_whole

        picture_format(out)  # before the work, not after it
        measured = measure(scene, samples, line.tell)
        save(draw(scene, measured), out)
    for each in unsupported_methods(scene):
        click.echo(f"{scene.name}: left out: {each}", err=True)
    if table is not None:
        write_whole({table: to_csv(measured)})
