"""`wavesym spectrum`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wavesym.cli.parameters import PATH, RATIO, SCENE, deliver, is_drawn, put_notes, refuse_out
from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.scene import Scene


@click.command()
@click.argument("scene", type=SCENE)
@click.option(
    "--damping",
    type=RATIO,
    default=0.05,
    show_default=True,
    help="Ratio of the oscillators' damping, below 1; 5% is 0.05.",
)
@click.option("-o", "out", type=PATH, metavar="FILE|PICTURE", help="Where it goes; .svg, .png, .pdf: drawn.")
def spectrum(scene: Scene, damping: float, out: Path | None) -> None:
    """Print response spectra of accelerations as CSV.

    Print the response spectra of the outputs of quantity acceleration, as CSV: pseudo-accelerations over the period.

    \b
    Example:
      wavesym spectrum lab.toml --damping 0.02 -o floors.svg
    """
    drawn = is_drawn(out, (".csv",))
    refuse_out(out)
    with progress(f"spectrum {scene.name}"):
        from wavesym import api

        found = api.spectrum(scene, damping)
        if drawn and out is not None:
            api.plot_spectra(found, out)
        notes = api.spectrum_notes(scene, found)
    put_notes(scene, notes)
    if not drawn:
        deliver("".join(found.csv()), out)
