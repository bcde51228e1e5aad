"""`wavesym run`."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import PATH, SCENE, decimals, is_standard_output_a_file, put, put_notes, refuse_out
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene

DEFAULT_SAMPLES = 1001
MOST_SAMPLES = 10**7


@click.command()
@click.argument("scene", type=SCENE)
@click.option(
    "--samples",
    type=click.IntRange(1, MOST_SAMPLES),
    help=f"How many equally spaced tau on [0, until].  [default: {DEFAULT_SAMPLES}]",
)
@click.option(
    "--at",
    type=PATH,
    metavar="FILE",
    help="File of the tau (with [units]: times) to use instead: one decimal a line, # comments.",
)
@click.option("-o", "out", type=PATH, metavar="OUT.csv", help="Where the values go.  [default: standard output]")
def run(scene: Scene, samples: int | None, at: Path | None, out: Path | None) -> None:
    """Print the histories of the outputs as CSV.

    Print the outputs of a scene as CSV, right to the last bit where that takes no minutes.

    Else they are those of a program, which standard error names with its bound. With [units] in the scene it speaks
    seconds.

    \b
    Example:
      wavesym run collision_m4 --samples 101 -o collision.csv
    """
    if samples is not None and at is not None:
        raise click.UsageError("--samples and --at exclude each other; write one of them", click.get_current_context())
    taus = decimals(at) if at is not None else None

    from wavesym import api
    from wavesym.writing import write_whole

    refuse_out(out)
    with progress(f"run {scene.name}"):
        notes: list[str] = []
        lines = api.run_csv(scene, samples or DEFAULT_SAMPLES, taus, notes.append)
        if out is not None:
            write_whole({out: lines})
    put_notes(scene, notes)
    if out is None:
        with progress(f"run {scene.name}") if is_standard_output_a_file() else nullcontext():
            put(lines)
