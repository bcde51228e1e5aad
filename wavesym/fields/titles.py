"""Names for people, of loads and of outputs: a line that pictures, pages and the comments of programs show."""

from __future__ import annotations

from wavesym.fields.numbers import LONGEST
from wavesym.fields.table import refusal, show

_UNWRITABLE = ('"', "\\", "/*", "*/", "$")
"""What these names have none of, as they go into comments of programs and into pictures."""


def check_title(value: object, *keys: str) -> str:
    """A name for people. Raises the error of `table.refusal`, which names `keys`."""
    if not isinstance(value, str) or not value.strip() or len(value) > LONGEST or not value.isprintable():
        raise refusal(f"{show(value)} is not a name for people; write a line of at most {LONGEST} characters", *keys)
    if bad := next((each for each in _UNWRITABLE if each in value), ""):
        raise refusal(f"{show(value)} is not a name for people; write a line without {bad}", *keys)
    return value
