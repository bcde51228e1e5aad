"""Numbers as text: the shortest decimal that reads back to the same double."""

from __future__ import annotations

from collections.abc import Iterable
from textwrap import wrap


def literal(value: float) -> str:
    """A double as C, Python and JSON write it. ValueError for what is not finite."""
    if value - value != 0.0:
        raise ValueError(f"{value} is no literal")
    return repr(value)


def lines(items: Iterable[str], width: int = 116) -> tuple[str, ...]:
    """Literals joined by commas, in lines of at most `width`; a lone 0 for none, as C has no empty array."""
    return tuple(wrap(", ".join(items) or "0", width))
