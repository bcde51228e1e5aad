"""Lines as they are drawn on paper: the main line of a chain and its branches, each a row of stations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from wavesym.mechanics.network import Network

MAIN = ""
"""The name of the line that is no branch."""


@dataclass(frozen=True)
class Station:
    """A place of a line where parts meet: x from its start, the points there from left to right, the bars beside it."""

    x: Fraction
    points: tuple[int, ...]
    left: int | None
    right: int | None


Lines = Mapping[str, tuple[Station, ...]]
"""The stations of each line by its name."""


def straight(network: Network) -> Lines:
    """The one line of a network whose bars, each of length 1, follow one another."""
    bars = network.bars
    inner = (
        Station(Fraction(n), tuple(dict.fromkeys((bars[n - 1].right, bars[n].left))), n - 1, n)
        for n in range(1, len(bars))
    )
    first = Station(Fraction(0), (bars[0].left,), None, 0)
    last = Station(Fraction(len(bars)), (bars[-1].right,), len(bars) - 1, None)
    return {MAIN: (first, *inner, last)}
