"""How results show themselves: outputs found by name, numbers as people read them, tables as notebooks show them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from wavesym.errors import did_you_mean


def output_number(name: str, outputs: Sequence[str], scene: str) -> int:
    """The number of an output. KeyError, which says which outputs the scene has, where it has none of that name."""
    if name in outputs:
        return outputs.index(name)
    known = f"{', '.join(outputs)}. {did_you_mean(str(name), outputs)}".rstrip(". ")
    raise KeyError(f"{name} is no output of {scene}; there are {known}")


def html_table(caption: str, heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A paragraph and a table as HTML, of plain texts."""
    head = "".join(f"<th>{escape(name)}</th>" for name in heads)
    body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<p>{escape(caption)}</p><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def number_text(value: float) -> str:
    """A number as it is shown to people."""
    return f"{value:.7g}"
