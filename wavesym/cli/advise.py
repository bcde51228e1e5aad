"""`wavesym advise`."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import OUT, SCENE, deliver, format_option, put_notes, refuse_out
from wavesym.errors import WavesymError
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene


@click.command()
@click.argument("scene", type=SCENE)
@click.option(
    "--tolerance",
    type=float,
    default=0.01,
    show_default=True,
    metavar="T",
    help="What histories may differ by, in parts of the largest value of each output.",
)
@format_option("text", "json")
@OUT
def advise(scene: Scene, tolerance: float, format: str, out: Path | None) -> None:
    """Say which model is enough: springs or waves.

    Say which model is enough: masses on springs, rods with consistent mass, or waves.

    All three are computed over the scene's own horizon, and their outputs compared.

    \b
    Example:
      wavesym advise drive_m1
    """
    from wavesym import api

    refuse_out(out)
    with progress(f"advise {scene.name}"):
        found = api.advise(scene, tolerance)
    with suppress(WavesymError):  # when contacts open may be dear to know, or not be known
        put_notes(scene, api.scene_notes(scene))
    deliver(found.json() if format == "json" else found.text(), out)
