"""Where an output is: what systems make of the positions that users write."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, Self

from wavesym.fields.numbers import exact, number_text
from wavesym.fields.table import check_keys
from wavesym.fields.titles import check_title


class Position(NamedTuple):
    """A place as its `text` says: x (in rod lengths, or along a line) or a name, and its side.

    -1 is the left one, +1 the right one, 0 where none is said. The `title` is what people are shown for it, if any.
    """

    text: str
    x: Fraction | None
    side: int
    name: str = ""
    title: str = ""


class PlaceInUnits(str):
    """A place in rod lengths, with the `text` that a scene with units has for it."""

    text: str

    def __new__(cls, text: str, written: str) -> Self:
        place = super().__new__(cls, text)
        place.text = written
        return place

    def __reduce__(self) -> tuple[type[Self], tuple[str, str]]:
        return type(self), (str(self), self.text)


_NAMED = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)(?::(.*))?")


def read_titled_place(value: Mapping[str, object]) -> tuple[object, str]:
    """The place and the name for people of an output that is a table. Raises the error of `table.refusal`."""
    check_keys(value, at="a place", name="a name for people")
    return value["at"], check_title(value["name"], "name")


def position_of(value: object) -> Position:
    """A position as TOML or Python has it: a number, text such as "1/2+", "hammer" or "branch:1-", or a table.

    A table has such a place as `at`, and a `name` for people.
    """
    if isinstance(value, Position):
        return value
    if isinstance(value, Mapping):
        place, title = read_titled_place(value)
        return position_of(place)._replace(title=title)
    if isinstance(value, PlaceInUnits):
        return position_of(str(value))._replace(text=value.text)
    text = number_text(value)
    if text is None:
        return Position(str(exact(value)), exact(value), 0)
    side = {"-": -1, "+": 1}.get(text[-1:], 0)
    bare = text[:-1] if side else value
    shown_as = str(value) if isinstance(value, str) else text
    if isinstance(bare, str) and (found := _NAMED.fullmatch(bare)):
        return Position(shown_as, None if found[2] is None else exact(found[2]), side, found[1])
    return Position(shown_as, exact(bare), side)


@dataclass(frozen=True)
class Place:
    """A place that is there: `part` of rod number `rod` (from 1) from its left end, or a point without a rod.

    `x` and `side` as they matter: two positions with the same are the same. `line` is the branch, if any.
    """

    x: Fraction
    side: int
    line: str
    rod: int
    part: Fraction
    point: int | None = None


class MisplacedError(ValueError):
    """A position that is not there, or not one: what was expected, as a user reads it."""
