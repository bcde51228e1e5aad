"""Which records are meant: by their id, that of a group, a section or a table."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

from wavesym.errors import WavesymError
from wavesym.papers.entries import Entry

MOST_MEANT = 3
"""Names that an unknown one is answered with."""


def asked(entries: Sequence[Entry], names: Iterable[str]) -> tuple[Entry, ...]:
    """The records that `names` ask for, in the order of print; WavesymError for a name that none has.

    A name is an id ("(4.8).5", "III.14", "text.22"), the beginning of some ("4.8", "III", "T3", "T2.g_1"), or a place
    ("section 4", "Table 2"). Brackets round the number of an equation may be left out, and case does not matter.
    """
    wanted: set[str] = set()
    for name in names:
        found = {entry.id for entry in entries if _means(name, entry)}
        if not found:
            near = get_close_matches(_bare(name), sorted(_known(entries)), n=MOST_MEANT)
            meant = f". Did you mean {' or '.join(near)}?" if near else ""
            raise WavesymError(f"{name}: no such record, formula or group in the paper{meant}")
        wanted |= found
    return tuple(entry for entry in entries if entry.id in wanted)


def _means(name: str, entry: Entry) -> bool:
    id, given = _plain(entry.id), _plain(name)
    where, place = entry.where.casefold(), name.strip().casefold()
    return id == given or id.startswith(f"{given}.") or where == place or where.startswith(f"{place},")


def _plain(name: str) -> str:
    return _bare(name).casefold()


def _bare(name: str) -> str:
    """An id without brackets; a line that is written below its number, "(2.4)_5", as "2.4.5"."""
    return re.sub(r"[()]", "", name.strip().replace(")_", ")."))


def _known(entries: Iterable[Entry]) -> set[str]:
    """The ids and their beginnings, as they are typed."""
    known = set()
    for entry in entries:
        parts = _bare(entry.id).split(".")
        known |= {".".join(parts[:size]) for size in range(1, len(parts) + 1)}
    return known
