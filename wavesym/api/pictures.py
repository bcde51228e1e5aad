"""A scene, or what was found of it, as pictures and as one page."""

from __future__ import annotations

from importlib.util import find_spec
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from wavesym.errors import WavesymError, install_command
from wavesym.programs.request import refuse_unknown
from wavesym.scene import Scene, lower

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from wavesym.results.frequency_response import FrequencyResponse
    from wavesym.results.modes import Modes
    from wavesym.results.spectrum import Spectra


def plot(scene: Scene, path: str | PathLike[str] | None = None, kind: str = "history") -> Figure:
    """Draw a scene.

    Args:
        scene: what is drawn.
        path: a file that it is written to as well, as .svg, .png or .pdf.
        kind: "history", the outputs over time; "xt", place x time of all rods; "envelope", the least and greatest along
            the chain; "map", place x time as colours, for long horizons.

    Returns:
        A matplotlib Figure, which a notebook shows.

    Raises:
        SceneError: for another suffix, before the work.
        WavesymError: for another kind, and where matplotlib is not installed.
        ToleranceError, CostError: where nothing could be generated either.

    >>> import wavesym
    >>> figure = wavesym.plot(wavesym.Scene.from_toml("drive_m1"), "drive.svg")
    """
    return plot_with_notes(scene, path, kind)[0]


def plot_with_notes(scene: Scene, path: str | PathLike[str] | None, kind: str) -> tuple[Figure, list[str]]:
    """As `plot`, with what the picture leaves out, line by line."""
    if not find_spec("matplotlib"):
        raise WavesymError(f"matplotlib is not installed: {install_command('plot')}")
    from wavesym.pictures.saving import picture_format, save
    from wavesym.pictures.scene_picture import KINDS, draw

    refuse_unknown("kind", kind, KINDS)
    if path is not None:
        picture_format(Path(path))  # before the work
    figure, notes = draw(scene, lower(scene), kind)
    if path is not None:
        save(figure, Path(path))
    return figure, notes


def plot_modes(scene: Scene, found: Modes, path: Path) -> None:
    """Draw the shapes of modes along the chain. SceneError for a suffix that is no picture's."""
    from wavesym.pictures.result_pictures import draw_modes
    from wavesym.pictures.saving import save

    save(draw_modes(found, lower(scene, in_time=False), scene.system.lines), path)


def plot_frf(scene: Scene, found: FrequencyResponse, path: Path) -> None:
    """Draw amplitudes and phases over frequency. SceneError for a suffix that is no picture's."""
    from wavesym.pictures.result_pictures import draw_frequency_response
    from wavesym.pictures.saving import save

    save(draw_frequency_response(found, lower(scene, in_time=False)), path)


def plot_spectra(found: Spectra, path: Path) -> None:
    """Draw response spectra over the period. SceneError for a suffix that is no picture's."""
    from wavesym.pictures.result_pictures import draw_spectra
    from wavesym.pictures.saving import save

    save(draw_spectra(found), path)


def scene_html(scene: Scene) -> str:
    """A scene as a notebook shows it: a line of what it is, and its structure drawn."""
    from wavesym.pictures.page.structure import structure_html

    return structure_html(repr(scene), lower(scene), scene.system.lines)


def report(scene: Scene, path: str | PathLike[str]) -> None:
    """Write a scene, and what happens in it, as one page of HTML that needs no network.

    Args:
        scene: what is shown.
        path: the file.

    Raises:
        ToleranceError, CostError: where nothing could be generated either.

    >>> import wavesym
    >>> wavesym.report(wavesym.Scene.from_toml("drive_m1"), "drive.html")
    """
    from wavesym.pictures.page.document import page
    from wavesym.writing import write_whole

    write_whole({Path(path): page(scene)})


def record(path: Path, unit: str | None, column: str | None = None, picture: Path | None = None) -> list[str]:
    """What a file of a record has, line by line; drawn too, where there is a path for it.

    Args:
        path: an AT2 or CSV file.
        unit: that of the samples, where the file has none.
        column: that of a CSV with several.
        picture: a file, .svg, .png or .pdf.

    Raises:
        SceneError: for a file that is damaged or has another unit, and for a picture with another suffix.
        WavesymError: for what is no unit.
    """
    from wavesym.documents.record import record_lines

    found, unit, lines = record_lines(path, unit, column)
    if picture is not None:
        from wavesym.pictures.result_pictures import draw_record
        from wavesym.pictures.saving import save

        save(draw_record(found, unit), picture)
    return lines
