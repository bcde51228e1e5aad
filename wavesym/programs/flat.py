"""The numbers of a program are flat tables by name, each number as it will be written.

Indices are ints, all else floats of the program's format. `first_...[g]` is where group g starts in a table, and
`first_...[g + 1]` where it ends.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import accumulate


def firsts(counts: Iterable[int]) -> tuple[int, ...]:
    """Where each group starts in a flat table, and where the last one ends."""
    return tuple(accumulate(counts, initial=0))
