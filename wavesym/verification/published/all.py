"""Every claim, judged, in the order of the paper."""

from __future__ import annotations

import re
from functools import cache

from wavesym.verification.published import (
    building_list,
    building_powers,
    clocks,
    collision_powers,
    conditions,
    delays,
    drive_powers,
    figures,
    forms,
    motion,
    prose,
)
from wavesym.verification.published.record import Record, judge

_PARTS = (
    motion,
    conditions,
    clocks,
    delays,
    forms,
    collision_powers,
    drive_powers,
    building_powers,
    building_list,
    prose,
    figures,
)


@cache
def records() -> tuple[Record, ...]:
    """The verdict on everything that the paper prints, in its order."""
    judged = (judge(claim) for part in _PARTS for claim in part.claims())
    return tuple(sorted(judged, key=lambda record: _place(record.id)))


def _place(id: str) -> tuple[int, int]:
    """Where in the paper: numbered formulas by number, tables and lines behind the formula that they follow."""
    if numbered := re.match(r"\((\d+)\.(\d+)\)", id):
        return int(numbered[1]), 10 * int(numbered[2])
    return {"T1": (3, 25), "T2": (4, 81), "T3": (4, 82), "T4": (4, 83), "III": (4, 130)}.get(id.split(".")[0], (5, 0))
