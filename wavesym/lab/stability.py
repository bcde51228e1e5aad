"""`wavesym stability`: the atlas of where methods fail, as a picture and a table for each family of curves."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from wavesym.lab.atlas import (
    contacts,
    damping,
    dashpots,
    endurance,
    extremes,
    fronts,
    gaps,
    lengths,
    limits,
    mode_counts,
    reflections,
    refusals,
    runtime,
    spacings,
    stiffness,
)
from wavesym.lab.atlas.drawing import draw
from wavesym.lab.atlas.family import CurveFamily, Progress, to_csv
from wavesym.pictures.saving import save
from wavesym.writing import write_whole

FAMILIES: Mapping[str, Callable[[Progress], CurveFamily]] = {
    "reflections": reflections.family,
    "gaps": gaps.family,
    "kappa": extremes.family,
    "springs": limits.family,
    "fronts": fronts.family,
    "lengths": lengths.family,
    "stiffness": stiffness.family,
    "dashpots": dashpots.family,
    "contacts": contacts.family,
    "refusals": refusals.family,
    "modes": mode_counts.family,
    "damping": damping.family,
    "spacings": spacings.family,
    "runtime_kappa": runtime.by_kappa,
    "runtime_reflections": runtime.by_reflections,
    "march": endurance.family,
}
"""By name, the one that takes longest last."""


def atlas(directory: Path, progress: Progress = lambda _: None) -> list[Path]:
    """Run and draw families of curves into `directory`, NAME.svg and NAME.csv each; the paths written.

    CompilerError where there is no C compiler, OSError.
    """
    written = []
    for number, (name, make) in enumerate(FAMILIES.items(), 1):
        family = make(partial(_told, progress, number))
        picture, table = directory / f"{name}.svg", directory / f"{name}.csv"
        write_whole({table: to_csv(family)})
        save(draw(family), picture)
        written += [picture, table]
    return written


def _told(progress: Progress, number: int, step: str) -> None:
    progress(f"{step}, family {number} of {len(FAMILIES)}")
