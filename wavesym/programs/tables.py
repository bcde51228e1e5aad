"""Flat tables of numbers, as programs have them in every language."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import accumulate
from typing import TypeAlias

Tables: TypeAlias = "dict[str, tuple[float, ...]]"
"""The tables of a program by name: flat, each number as it is written, indices as ints."""


def firsts(counts: Iterable[int]) -> tuple[int, ...]:
    """Where each group starts in a flat table, and where the last one ends."""
    return tuple(accumulate(counts, initial=0))
