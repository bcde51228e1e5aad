"""`[report]`: the title block of a page, which changes nothing that is computed."""

from __future__ import annotations

from typing import Annotated

from pydantic import PlainValidator

from wavesym.fields.table import SceneTable, refusal, show

_LONGEST = 200  # characters


def _line(value: object) -> str:
    if not isinstance(value, str) or not 0 < len(value) <= _LONGEST or not value.isprintable():
        raise refusal(f"{show(value)} is not a line of text; write up to {_LONGEST} characters in quotes")
    return value


Line = Annotated[str, PlainValidator(_line, json_schema_input_type=str)]


class ReportTable(SceneTable):
    """Who made a report of what, and when; all of it as text."""

    project: Line | None = None
    author: Line | None = None
    date: Line | None = None

    @property
    def credit(self) -> str:
        """The author and the date in a line."""
        return ", ".join(filter(None, (self.author, self.date)))
