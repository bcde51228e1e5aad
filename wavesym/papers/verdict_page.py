"""`verify --published`: a paper judged, or some records of it, and written as a page."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from difflib import get_close_matches

from wavesym.errors import WavesymError
from wavesym.papers.entries import PaperEntry
from wavesym.papers.pages.document import Findings
from wavesym.papers.pages.formats import FORMATS
from wavesym.papers.pielorz1979 import paper
from wavesym.papers.record import VERDICTS
from wavesym.programs.request import refuse_unknown

MOST_MEANT = 3
"""Names that an unknown one is answered with."""


def requested_entries(entries: Sequence[PaperEntry], names: Iterable[str]) -> tuple[PaperEntry, ...]:
    """The records that `names` ask for, in the order of print; WavesymError for a name that none has.

    A name is an id ("(4.8).5", "III.14", "text.22"), the beginning of some ("4.8", "III", "T3", "T2.g_1"), or a place
    ("section 4", "Table 2"). Brackets round the number of an equation may be left out, and case does not matter.
    """
    wanted: set[str] = set()
    for name in names:
        ids = {entry.id for entry in entries if _means(name, entry)}
        if not ids:
            near = get_close_matches(_bare(name), sorted(_typed_names(entries)), n=MOST_MEANT)
            meant = f". Did you mean {' or '.join(near)}?" if near else ""
            raise WavesymError(f"{name}: no such record, formula or group in the paper{meant}")
        wanted |= ids
    return tuple(entry for entry in entries if entry.id in wanted)


def _means(name: str, entry: PaperEntry) -> bool:
    id, given = _plain(entry.id), _plain(name)
    where, place = entry.where.casefold(), name.strip().casefold()
    return id == given or id.startswith(f"{given}.") or where == place or where.startswith(f"{place},")


def _plain(name: str) -> str:
    return _bare(name).casefold()


def _bare(name: str) -> str:
    """An id without brackets; a line that is written below its number, "(2.4)_5", as "2.4.5"."""
    return re.sub(r"[()]", "", name.strip().replace(")_", ")."))


def _typed_names(entries: Iterable[PaperEntry]) -> set[str]:
    """The ids and their beginnings, as they are typed."""
    known = set()
    for entry in entries:
        parts = _bare(entry.id).split(".")
        known |= {".".join(parts[:size]) for size in range(1, len(parts) + 1)}
    return known


def verdict_page(
    names: Sequence[str],
    format: str,
    reproduce: bool = False,
    watch: Callable[[Sequence[PaperEntry]], Iterable[PaperEntry]] = iter,
    only: Sequence[str] = (),
) -> tuple[str, bool]:
    """The verdicts as a page, and whether everything could be tested.

    Args:
        names: ids of records or groups, none for the whole paper.
        format: one of FORMATS.
        reproduce: whether counterexamples come with a scene.
        watch: goes through the records as they are judged.
        only: verdicts: no other records are shown; as text after the counts of all. Empty for all of them.

    Raises:
        WavesymError: for a name, or a verdict, that there is not.
    """
    for verdict in only:
        refuse_unknown("--only", verdict, VERDICTS)
    data = paper.paper()
    wanted = requested_entries(tuple(data.entries.values()), names) if names else None
    findings = Findings(data, paper.records(wanted, watch), not (names or only), reproduce, frozenset(only))
    return FORMATS[format](findings), findings.are_complete
