"""Places on a chain in physical units: "1.2 m", "1.2 m+", "a:0.3 m" on a branch, or the name of a node."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from wavesym.fields.quantity import si_value
from wavesym.fields.quantity_fields import tidy
from wavesym.fields.table import refusal, show
from wavesym.systems.place import Position

_NAMED = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)(?::(.*))?", re.DOTALL)


@dataclass(frozen=True)
class PlaceInMetres:
    """A length from the start of a line, in m, or the name of a node; -1, 0 or +1 is its side."""

    text: str
    line: str
    x: Fraction | None
    side: int

    @property
    def name(self) -> str:
        """Of a node."""
        return self.line

    def position(self, unit: Fraction) -> Position:
        """As scenes without units have it, called as it is written."""
        return Position(self.text, self.x and self.x / unit if self.x is not None else None, self.side, self.line)

    def dimensionless(self, unit: Fraction) -> str:
        """As text of a scene without units."""
        side = {-1: "-", 0: "", 1: "+"}[self.side]
        if self.x is None:
            return f"{self.line}{side}"
        return f"{self.line}{self.line and ':'}{self.x / unit}{side}"


def place(value: object, lines: Mapping[str, Fraction]) -> PlaceInMetres:
    """A place on one of some lines, with how long each is in m. Raises the error of `table.refusal`."""
    if not isinstance(value, str):
        raise refusal(f'{show(value)} is not a place; write one such as "1.2 m", or the name of a node')
    side = {"-": -1, "+": 1}.get(value[-1:], 0)
    bare = value[:-1] if side else value
    if not (found := _NAMED.fullmatch(bare)):
        return PlaceInMetres(value, "", _place_along_line("", si_value(bare, "length"), value, lines), side)
    if found[2] is None:
        return PlaceInMetres(value, found[1], None, side)
    return PlaceInMetres(value, found[1], _place_along_line(found[1], si_value(found[2], "length"), value, lines), side)


def _place_along_line(line: str, x: Fraction, value: str, lines: Mapping[str, Fraction]) -> Fraction:
    if line in lines and not 0 <= x <= lines[line]:
        raise refusal(f"{show(value)} is not on the chain; write a place from 0 to {tidy(lines[line])} m")
    return x
