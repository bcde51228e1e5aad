"""The paper's data and its adapters: every record judged, in the order of print."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence

from wavesym.papers.entries import Entry, problems
from wavesym.papers.pielorz1979 import (
    cells,
    clocks,
    coefficients,
    conditions,
    constants,
    definitions,
    delays,
    form_constants,
    forms,
    heads,
    loads,
    makeup,
    motion,
    prose,
    rates,
    remarks,
    systems,
)
from wavesym.papers.pielorz1979.bodies import number_of_bodies
from wavesym.papers.pielorz1979.figures import caption_of_figure, end_of_contact, said_of_figure
from wavesym.papers.pielorz1979.transcript import paper
from wavesym.papers.record import Adapter, Record, judge

ADAPTERS: Mapping[str, Adapter] = {
    "base acceleration": loads.base,
    "bodies": number_of_bodies,
    "caption": caption_of_figure,
    "cell": cells.cell,
    "clock": clocks.cell,
    "coefficients": remarks.coefficients,
    "condition": conditions.test,
    "contact": end_of_contact,
    "definition": definitions.definition,
    "delay": delays.test,
    "different rates": rates.rates,
    "factor": remarks.factor,
    "figure": said_of_figure,
    "form": forms.form,
    "form constant": form_constants.definition,
    "function": heads.function,
    "group": remarks.group,
    "inside": motion.inside,
    "interval": forms.interval,
    "kappa": constants.kappa,
    "line": coefficients.coefficient,
    "load without dimensions": constants.load,
    "loads of bodies": loads.bodies,
    "makeup": makeup.makeup,
    "moments": loads.moments,
    "power": remarks.power,
    "range": heads.interval_or_size,
    "rate": form_constants.rate,
    "rest": remarks.rest,
    "sentence": prose.solution,
    "sizes": coefficients.sizes,
    "solution": motion.solution,
    "speed": constants.speed,
    "systems": systems.test,
    "unit of moment": constants.moment_factor,
    "waves": makeup.waves,
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
