"""The paper's data and its adapters: every record judged, in the order of print."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence

from wavesym.papers.entries import Entry, problems
from wavesym.papers.pielorz1979 import cells, coefficients, definitions, forms, heads, prose, rates, remarks
from wavesym.papers.pielorz1979.transcription import paper
from wavesym.papers.record import Adapter, Record, judge

ADAPTERS: Mapping[str, Adapter] = {
    "cell": cells.cell,
    "coefficients": remarks.coefficients,
    "definition": definitions.definition,
    "different rates": rates.rates,
    "factor": remarks.factor,
    "form": forms.form,
    "function": heads.function,
    "group": remarks.group,
    "interval": forms.interval,
    "line": coefficients.coefficient,
    "power": remarks.power,
    "range": heads.interval_or_size,
    "rate": definitions.rate,
    "rest": remarks.rest,
    "sizes": coefficients.sizes,
    "solution": prose.solution,
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
