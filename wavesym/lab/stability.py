"""`wavesym stability`: the atlas of where methods fail, as a picture and a table for each family of curves."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from wavesym.lab.atlas import chains, evaluators, modal, other_methods, runtime
from wavesym.lab.atlas.drawing import draw
from wavesym.lab.atlas.family import CurveFamily, Progress, to_csv
from wavesym.pictures.saving import save
from wavesym.writing import write_whole

FAMILIES: Mapping[str, Callable[[Progress], CurveFamily]] = {
    "reflections": evaluators.reflections,
    "gaps": evaluators.gaps,
    "kappa": evaluators.kappa,
    "springs": other_methods.springs,
    "fronts": other_methods.fronts,
    "lengths": evaluators.lengths,
    "stiffness": evaluators.stiffness,
    "dashpots": evaluators.dashpots,
    "contacts": chains.contacts,
    "refusals": chains.refusals,
    "modes": modal.mode_counts,
    "damping": modal.damping,
    "spacings": modal.spacings,
    "runtime_kappa": runtime.by_kappa,
    "runtime_reflections": runtime.by_reflections,
}
"""The families by name."""


def atlas(directory: Path, progress: Progress = lambda _: None) -> list[Path]:
    """Run and draw families of curves into `directory`, NAME.svg and NAME.csv each; the paths written.

    CompilerError where there is no C compiler, OSError.
    """
    written = []
    for number, (name, make) in enumerate(FAMILIES.items(), 1):
        family = make(partial(_report, progress, number))
        picture, table = directory / f"{name}.svg", directory / f"{name}.csv"
        write_whole({table: to_csv(family)})
        save(draw(family), picture)
        written += [picture, table]
    return written


def _report(progress: Progress, number: int, step: str) -> None:
    progress(f"{step}, family {number} of {len(FAMILIES)}")
