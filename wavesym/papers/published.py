"""`verify --published`: a paper judged, or some records of it, and written as a page."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from wavesym.papers.asked import asked
from wavesym.papers.entries import Entry
from wavesym.papers.pages import as_json, html, latex, markdown, text
from wavesym.papers.pages.findings import Findings
from wavesym.papers.pielorz1979 import paper, particulars

_PAGES: Mapping[str, Callable[[Findings], str]] = {
    "text": text.page,
    "json": as_json.page,
    "markdown": markdown.page,
    "html": html.page,
    "latex": latex.page,
}
FORMATS = tuple(_PAGES)


def published(
    names: Sequence[str],
    format: str,
    reproduce: bool = False,
    watch: Callable[[Sequence[Entry]], Iterable[Entry]] = iter,
) -> tuple[str, bool]:
    """The verdicts as a page, and whether everything could be tested.

    `names` are ids of records or groups, none for the whole paper; WavesymError for one that there is not. `watch`
    goes through the records as they are judged.
    """
    wanted = asked(paper.paper().entries(), names) if names else None
    passages = () if names else paper.paper().passages
    findings = Findings(particulars.about(), paper.records(wanted, watch), passages, reproduce)
    return _PAGES[format](findings), findings.passed
