"""A record as part of a scene: its samples, not the file that they came from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from os import PathLike
from typing import Annotated, Any

from pydantic import Field, PlainSerializer, PlainValidator, ValidationInfo

from wavesym.errors import SceneError
from wavesym.fields.numbers import Exact, Numbers, Positive
from wavesym.fields.table import SceneTable, key_context, refusal, show
from wavesym.records.read import read_record
from wavesym.records.record_file import RecordFile


class Recording(SceneTable):
    """What a file says: samples, and what it has of the time between them, the time of the first, and units."""

    samples: Numbers = Field(description="a list of numbers", min_length=1)
    spacing: Positive | None = None
    start: Exact | None = None
    unit: str = ""
    clock: str = ""


def read_recording(
    path: str | PathLike[str], column: str | None, spacing_in_file: Callable[[RecordFile], Fraction | None]
) -> Recording:
    """What the file at `path` says, with the spacing that a scene gives it in the file's unit of time. SceneError."""
    record = read_record(path, column)
    spacing = spacing_in_file(record)
    even = record.even(spacing)
    return Recording(
        samples=record.samples,
        spacing=even if spacing is None else record.spacing,
        start=record.times[0] if record.times else None,
        unit=record.unit,
        clock=record.clock,
    )


def _recording(value: object, info: ValidationInfo) -> Recording:
    """A record from its file, or as it is dumped."""
    if isinstance(value, Recording):
        return value
    try:
        if isinstance(value, Mapping):
            with key_context():
                return Recording.model_validate(value)
        if isinstance(value, str | PathLike):
            return read_recording(value, info.data.get("column"), lambda _: info.data.get("spacing"))
    except SceneError as error:
        raise refusal(str(error)) from None
    raise refusal(f"{show(value)} is not a path; write that of a file")


def _dump(recording: Recording) -> dict[str, Any]:
    return recording.model_dump(exclude_defaults=True)


Recorded = Annotated[Recording, PlainValidator(_recording), PlainSerializer(_dump, return_type=dict[str, Any])]
"""The path of a file in a scene; a table of what was in it when the scene is dumped."""
