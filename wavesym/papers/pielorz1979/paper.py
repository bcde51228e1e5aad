"""The paper's data and its adapters: every record judged, in the order of print."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence

from wavesym.papers.entries import Entry, problems
from wavesym.papers.pielorz1979 import (
    clocks,
    conditions,
    constants,
    definitions,
    delays,
    loads,
    makeup,
    motion,
    systems,
)
from wavesym.papers.pielorz1979.bodies import number_of_bodies
from wavesym.papers.pielorz1979.figures import caption_of_figure, end_of_contact, said_of_figure
from wavesym.papers.pielorz1979.transcript import paper
from wavesym.papers.record import Adapter, Record, judge

ADAPTERS: Mapping[str, Adapter] = {
    "inside": motion.inside,
    "solution": motion.solution,
    "definition": definitions.definition,
    "load without dimensions": constants.load,
    "moments": loads.moments,
    "base acceleration": loads.base,
    "loads of bodies": loads.bodies,
    "clock": clocks.cell,
    "speed": constants.speed,
    "kappa": constants.kappa,
    "unit of moment": constants.moment_factor,
    "makeup": makeup.makeup,
    "waves": makeup.waves,
    "bodies": number_of_bodies,
    "figure": said_of_figure,
    "caption": caption_of_figure,
    "contact": end_of_contact,
    "condition": conditions.test,
    "delay": delays.test,
    "systems": systems.test,
}


def records(
    wanted: Sequence[Entry] | None = None, watch: Callable[[Sequence[Entry]], Iterable[Entry]] = iter
) -> tuple[Record, ...]:
    """The verdict on the `wanted` records, or all; `watch` goes through them as they are judged."""
    unlike = defaultdict(list)
    for id, problem in problems(paper()):
        unlike[id].append(problem)
    entries = paper().entries() if wanted is None else wanted
    return tuple(judge(entry, ADAPTERS[entry.kind](entry), unlike[entry.id]) for entry in watch(entries))
