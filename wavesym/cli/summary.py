"""`wavesym summary`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import OUT, SCENE, deliver, format_option, put_notes, refuse_out
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene


@click.command()
@click.argument("scene", type=SCENE)
@click.option(
    "--at-samples",
    is_flag=True,
    help="Of the values at the samples of a record, or at 1001 equally spaced tau, not of those between.",
)
@format_option("text", "json")
@OUT
def summary(scene: Scene, at_samples: bool, format: str, out: Path | None) -> None:
    """Print the extremes of each output, and when.

    Tell of each output the least and the greatest value and when it has them, when it first moves, its mean and root
    mean square, and its value at the end.

    \b
    Example:
      wavesym summary building_m2
    """
    from wavesym import api

    refuse_out(out)
    with progress(f"summary {scene.name}"):
        from wavesym.documents.summary import summary_text

        found = api.summary(scene, at_samples=at_samples)
        lines = api.scene_notes(scene)
    if format == "json" and not found.proved:
        lines.append(f"{found.how}: {found.accuracy}")
    if format == "json":
        lines += found.notes
    put_notes(scene, lines)
    deliver(summary_text(found, format), out)
