"""What a physical scene says, in a line."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_MOST_PARTS, _MOST_NUMBERS = 40, 8


def describe(value: Any) -> str:
    """Tables and lists as text; of long ones how long they are."""
    match value:
        case Mapping():
            return ", ".join(_describe_key(key, each) for key, each in value.items())
        case list():
            parts = [describe(each) for each in value[:_MOST_PARTS]]
            more = [f"... and {len(value) - _MOST_PARTS} more"] if len(value) > _MOST_PARTS else []
            return " | ".join([*parts, *more])
    return str(value)


def _describe_key(key: str, value: Any) -> str:
    if key == "record":
        return f"record of {len(value['samples'])} samples, 0 one step after the last"
    if isinstance(value, list) and not any(isinstance(each, Mapping) for each in value):
        if len(value) > _MOST_NUMBERS:
            return f"{len(value)} {key}"
        return f"{key} {', '.join(map(str, value))}"
    if isinstance(value, Mapping):
        return f"{key} ({describe(value)})"
    return key if value is True else f"{key} {describe(value)}"
