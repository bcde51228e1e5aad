"""The paper's data and its adapters: every record judged, in the order of print."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence

from wavesym.papers.entries import WHOLE, PaperEntry, problems
from wavesym.papers.pielorz1979 import (
    cells,
    clocks,
    coefficients,
    conditions,
    constants,
    delays,
    forms,
    heads,
    motion,
    prose,
    rates,
    remarks,
    statements,
)
from wavesym.papers.pielorz1979.figures import caption_of_figure, end_of_contact, said_of_figure
from wavesym.papers.pielorz1979.transcript import paper as paper
from wavesym.papers.record import Adapter, Record, Test, judge


def _cell(entry: PaperEntry) -> Test:
    """A cell of a table, of Table 1 by its column."""
    if not entry.id.startswith("T1."):
        return cells.cell(entry)
    return {"c_f^2": constants.speed, "S": motion.bodies}.get(entry.about["column"], clocks.cell)(entry)


ADAPTERS: Mapping[str, Adapter] = {
    "base acceleration": motion.base,
    "bodies": statements.statement,
    "caption": caption_of_figure,
    "cell": _cell,
    "coefficients": remarks.coefficients,
    "condition": conditions.test,
    "contact": end_of_contact,
    "definition": motion.definition,
    "delay": delays.test,
    "factor": remarks.factor,
    "figure": said_of_figure,
    "form": forms.form,
    "form constant": cells.definition,
    "function": heads.function,
    "group": remarks.group,
    "heaviside": remarks.heaviside,
    "inside": motion.inside,
    "interval": heads.interval,
    "kappa": constants.kappa,
    "line": coefficients.coefficient,
    "load without dimensions": constants.load,
    "makeup": statements.statement,
    "moments": motion.moments,
    "power": remarks.power,
    "range": heads.interval_or_size,
    "rate": rates.rate,
    "rest": remarks.rest,
    "sentence": prose.solution,
    "sizes": coefficients.sizes,
    "solution": motion.solution,
    "systems": statements.statement,
    "unit of moment": constants.moment_factor,
    "waves": statements.statement,
}


def records(
    wanted: Sequence[PaperEntry] | None = None, watch: Callable[[Sequence[PaperEntry]], Iterable[PaperEntry]] = iter
) -> tuple[Record, ...]:
    """The verdict on the `wanted` records, or all; `watch` goes through them as they are judged.

    Where the data as a whole do not fit the source, no verdict counts.
    """
    unlike = defaultdict(list)
    for id, problem in problems(paper()):
        unlike[id].append(problem)
    entries = paper().entries.values() if wanted is None else wanted
    return tuple(
        judge(entry, ADAPTERS[entry.kind](entry), [*unlike[WHOLE], *unlike[entry.id]])
        for entry in watch(tuple(entries))
    )
