"""How results show themselves: outputs found by name, numbers as people read them, tables as text, CSV and HTML."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

from wavesym.errors import did_you_mean

if TYPE_CHECKING:
    from numpy.typing import NDArray

_WRITTEN_OUT = 1e7
_LARGE = {
    "N": (1e4, 1000, "kN"),
    "N*m": (1e4, 1000, "kN*m"),
    "N\u00b7m": (1e4, 1000, "kN\u00b7m"),
    "Pa": (1e6, 1_000_000, "MPa"),
}
"""Units that are small for structures: from which value on people write which other one, of so many of them."""


def output_number(name: str, outputs: Sequence[str], scene: str) -> int:
    """The number of an output. KeyError, which says which outputs the scene has, where it has none of that name."""
    if name in outputs:
        return outputs.index(name)
    known = f"{', '.join(outputs)}. {did_you_mean(str(name), outputs)}".rstrip(". ")
    raise KeyError(f"{name} is no output of {scene}; there are {known}")


class OutputRows:
    """What has a row of values for each output of a scene: rows[NAME], the names in order, and how many these are."""

    outputs: tuple[str, ...]
    values: NDArray[Any]
    name: str

    def __getitem__(self, name: str) -> NDArray[Any]:
        row: NDArray[Any] = self.values[output_number(name, self.outputs, self.name)]
        return row

    def __iter__(self) -> Iterator[str]:
        return iter(self.outputs)

    def __len__(self) -> int:
        return len(self.outputs)


def html_table(caption: str, heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A paragraph and a table as HTML, of plain texts."""
    head = "".join(f"<th>{escape(name)}</th>" for name in heads)
    body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<p>{escape(caption)}</p><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def align_columns(rows: Sequence[Sequence[str]], left: Container[int] = (0,)) -> list[str]:
    """Rows of a table as lines of text, whose columns are two spaces apart.

    Args:
        rows: of as many cells each, the heads of the columns first where there are any.
        left: the numbers of the columns whose cells begin below each other; those of all others end so.
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if number in left else cell.rjust(width)
            for number, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def csv_line(cells: Iterable[str | float | None]) -> str:
    """A line of CSV: texts as they are, numbers in the shortest decimals that read back to them, nothing for None."""
    return ",".join("" if cell is None else cell if isinstance(cell, str) else repr(cell) for cell in cells) + "\n"


def number_text(value: float, unit: str = "", digits: int = 7) -> str:
    """A number as it is shown to people, with its unit where it has one; below ten million without a power of ten."""
    text = f"{value:.{digits}g}"
    text = f"{float(text):.0f}" if "e+" in text and abs(value) < _WRITTEN_OUT else text
    return f"{text} {unit}".rstrip()


def readable_unit(largest: float, unit: str) -> tuple[int, str]:
    """The unit that people write for values of a size, and how many of the other are one of it.

    >>> readable_unit(5.9e6, "N")
    (1000, 'kN')
    >>> readable_unit(5.9e6, "mm")
    (1, 'mm')
    """
    least, size, readable = _LARGE.get(unit, (float("inf"), 1, unit))
    return (size, readable) if abs(largest) >= least else (1, unit)


def group_thousands(text: str) -> str:
    """A number whose whole part is in groups of three, a narrow space between them, from five figures on."""
    return re.sub(r"(?<![\d.])\d{5,}", lambda whole: f"{int(whole[0]):,}".replace(",", "\u202f"), text)
