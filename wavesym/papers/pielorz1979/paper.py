"""The paper's data and its adapters: every record judged, in the order of print."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence

from wavesym.papers.entries import WHOLE, PaperEntry, problems
from wavesym.papers.pielorz1979 import coefficients
from wavesym.papers.pielorz1979.equations import GROUPS, equation, solution
from wavesym.papers.pielorz1979.figures import caption_of_figure, end_of_contact, figure_statement
from wavesym.papers.pielorz1979.solutions import SOLUTIONS
from wavesym.papers.pielorz1979.statements import STATEMENTS
from wavesym.papers.pielorz1979.tables import TESTS
from wavesym.papers.pielorz1979.transcript import paper as paper
from wavesym.papers.pielorz1979.transcript import patterns
from wavesym.papers.record import Adapter, Record, Test, judge
from wavesym.papers.sentences import sentence_test


def _cell(entry: PaperEntry) -> Test:
    """A cell of a table; those of Table 1 are equations."""
    return equation(entry) if entry.id.startswith("T1.") else TESTS["cell"](entry)


ADAPTERS: Mapping[str, Adapter] = {
    **dict.fromkeys(GROUPS, equation),
    **TESTS,
    "caption": caption_of_figure,
    "cell": _cell,
    "contact": end_of_contact,
    "figure": figure_statement,
    "line": coefficients.coefficient,
    "sentence": sentence_test(patterns(), {**STATEMENTS, **SOLUTIONS}),
    "sizes": coefficients.sizes,
    "solution": solution,
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
