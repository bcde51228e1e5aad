"""`verify --published`: a paper judged, or some records of it, and written as a page."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from wavesym.papers.asked import asked
from wavesym.papers.entries import PaperEntry
from wavesym.papers.pages.document import Findings
from wavesym.papers.pages.formats import FORMATS
from wavesym.papers.pielorz1979 import paper
from wavesym.papers.record import VERDICTS
from wavesym.programs.request import refuse_unknown


def published(
    names: Sequence[str],
    format: str,
    reproduce: bool = False,
    watch: Callable[[Sequence[PaperEntry]], Iterable[PaperEntry]] = iter,
    only: str = "",
) -> tuple[str, bool]:
    """The verdicts as a page, and whether everything could be tested.

    Args:
        names: ids of records or groups, none for the whole paper.
        format: one of FORMATS.
        reproduce: whether counterexamples come with a scene.
        watch: goes through the records as they are judged.
        only: a verdict: no other records are shown; as text after the counts of all.

    Raises:
        WavesymError: for a name, or a verdict, that there is not.
    """
    if only:
        refuse_unknown("--only", only, VERDICTS)
    data = paper.paper()
    wanted = asked(tuple(data.entries.values()), names) if names else None
    findings = Findings(data, paper.records(wanted, watch), not (names or only), reproduce, only)
    return FORMATS[format](findings), findings.passed
