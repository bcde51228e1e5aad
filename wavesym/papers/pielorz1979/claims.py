"""Every claim, judged, in the order of the paper."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

from wavesym.papers.pielorz1979 import (
    building_list,
    conditions,
    delays,
    figures,
    forms,
    motion,
    prose,
    table_1_clocks,
    table_2_collision,
    table_3_drive,
    table_4_building,
)
from wavesym.papers.record import Claim, Record, judge

_PARTS = (
    motion,
    conditions,
    table_1_clocks,
    delays,
    forms,
    table_2_collision,
    table_3_drive,
    table_4_building,
    building_list,
    prose,
    figures,
)


def records(watch: Callable[[list[Claim[Any]]], Iterable[Claim[Any]]] = iter) -> tuple[Record, ...]:
    """The verdict on everything that the paper prints, in its order; `watch` goes through it as it is judged."""
    return _judged(watch)


@cache
def _judged(watch: Callable[[list[Claim[Any]]], Iterable[Claim[Any]]]) -> tuple[Record, ...]:
    claims = [claim for part in _PARTS for claim in part.claims()]
    return tuple(sorted(map(judge, watch(claims)), key=lambda record: _place(record.id)))


def _place(id: str) -> tuple[int, int]:
    """Where in the paper: numbered formulas by number, tables and lines behind the formula that they follow."""
    if numbered := re.match(r"\((\d+)\.(\d+)\)", id):
        return int(numbered[1]), 10 * int(numbered[2])
    return {"T1": (3, 25), "T2": (4, 81), "T3": (4, 82), "T4": (4, 83), "III": (4, 130)}.get(id.split(".")[0], (5, 0))
