"""Ways to pictures and pages: of a scene, and of a record."""

from __future__ import annotations

import re
from pathlib import Path

from wavesym.errors import SceneError, WavesymError
from wavesym.fields.table import shown
from wavesym.scene import Scene, lower
from wavesym.writing import write_whole

_UNIT = re.compile(r"[A-Za-z\u00b5\u03bc%][A-Za-z0-9_*/^%-]{0,40}")


def plot(scene: Scene, path: Path, kind: str = "history") -> list[str]:
    """Draw a scene as .svg, .png or .pdf; what the picture leaves out, line by line.

    `kind`: "history", the outputs over time; "xt", place x time of all rods; "envelope", the least and greatest along
    the chain; "map", place x time as colours, for long horizons. SceneError for another suffix, before the work;
    ToleranceError, CostError where nothing could be generated either.
    """
    from wavesym.report.saving import picture_format, save

    picture_format(path)
    if kind == "xt":
        from wavesym.report import xt

        save(xt.draw(lower(scene), scene.system.lines, scene.physical), path)
        return []
    if kind in ("envelope", "map"):
        from wavesym.report import envelope, heatmap
        from wavesym.report.along import along

        found = along(scene)
        if kind == "envelope":
            save(envelope.draw(lower(scene), found), path)
        else:
            from wavesym.report.loads import load_histories

            model = lower(scene)
            save(heatmap.draw(model, found, load_histories(model, scene.scale)), path)
        return []
    from wavesym.report.groups import notes
    from wavesym.report.histories import histories
    from wavesym.report.loads import load_histories
    from wavesym.report.panels import draw

    model = lower(scene)
    made = histories(model)
    save(draw(made, load_histories(model, scene.scale)), path)
    return notes(made)


def report(scene: Scene, path: Path) -> None:
    """Write a scene, and what happens in it, as one page of HTML.

    ToleranceError, CostError where nothing could be generated either.
    """
    from wavesym.report.page.document import page

    write_whole({path: page(scene)})


def record(path: Path, unit: str | None, column: str | None = None, picture: Path | None = None) -> list[str]:
    """What a file of a record says, line by line; drawn too, where there is a path for it.

    `unit` is that of the samples where the file says none, `column` that of a CSV with several. SceneError for a file
    that is damaged or says another unit, and for a picture with another suffix; WavesymError for what is no unit.
    """
    from wavesym.documents.record import facts
    from wavesym.records.read import read_record

    if unit is not None and not _UNIT.fullmatch(unit):
        raise WavesymError(f"--unit: {shown(unit)} given, a unit such as g or m/s^2 expected")
    said = read_record(path, column)
    if unit is not None and said.unit not in ("", unit):
        raise SceneError(f"--unit {unit} given, {said.unit} expected, as in the file, or none", file=said.file)
    lines = facts(said, unit or said.unit)
    if picture is not None:
        from wavesym.report.record import draw
        from wavesym.report.saving import picture_format, save

        picture_format(picture)
        save(draw(said, unit or said.unit), picture)
    return lines
