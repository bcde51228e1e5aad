"""What a user asks of a sweep: a scene, its fields that are varied, records, and what to keep of each case."""

from __future__ import annotations

import os
from collections.abc import Mapping
from os import PathLike
from typing import Annotated, Any, Self

from pydantic import (
    BeforeValidator,
    Field,
    PlainValidator,
    PrivateAttr,
    ValidationError,
    field_validator,
    model_validator,
)

from wavesym.errors import SceneError
from wavesym.fields.numbers import Integer
from wavesym.fields.table import SceneTable, as_list, key_context, refusal, scene_error, show
from wavesym.reading import read_text
from wavesym.results.statistics import ARRAYS, LINK_ARRAYS, RUNTIME_ARRAYS, wrong_statistic
from wavesym.scene.key_lines import key_lines, line_of
from wavesym.scene.scene import Scene
from wavesym.scene.scene_file import builtin_names, parse_text

MOST_SAMPLES = 1_000_000
_FORM = "a file of TOML that describes a sweep"


class Span(SceneTable):
    """`count` values from one number to another, evenly or, where it is `log`, in equal ratios; with a unit or not."""

    first: Any = Field(alias="from", description="a number")
    last: Any = Field(alias="to", description="a number")
    count: Integer = Field(description="how many values")
    log: bool = False

    @field_validator("count")
    @classmethod
    def _check_count(cls, count: int) -> int:
        if count < 1:
            raise refusal(f"{count} values; write at least 1")
        return count


def _values(value: object) -> Span | tuple[object, ...]:
    """A list, or a table of a span."""
    if isinstance(value, Span):
        return value
    if isinstance(value, Mapping):
        with key_context():
            return Span.model_validate(value)
    if isinstance(value, str) or not hasattr(value, "__len__"):
        raise refusal(f"{show(value)} is not a list of values; write one, or a table with from, to and count")
    values = as_list(value if isinstance(value, list | tuple) else list(value))  # type: ignore[call-overload]
    if not values:
        raise refusal("no values; write at least 1")
    return values


Values = Annotated[Span | tuple[object, ...], PlainValidator(_values)]


class KeepTable(SceneTable):
    """What is kept of each case: extremes of its outputs, and their values at so many equally spaced times."""

    summary: tuple[str, ...] = RUNTIME_ARRAYS
    histories: Integer | None = None

    @field_validator("summary", mode="before")
    @classmethod
    def _check_names(cls, value: object) -> tuple[object, ...]:
        names = as_list(value)
        if wrong := wrong_statistic(names, (*ARRAYS, *LINK_ARRAYS)):
            raise refusal(*wrong)
        return names

    @field_validator("histories")
    @classmethod
    def _samples(cls, count: int | None) -> int | None:
        if count is not None and not 2 <= count <= MOST_SAMPLES:
            raise refusal(f"{count} samples; write 2 to {MOST_SAMPLES}")
        return count

    @model_validator(mode="after")
    def _require_results(self) -> Self:
        if not self.summary and self.histories is None:
            raise refusal("keeps nothing; write a summary or histories")
        return self


def _keep(value: object) -> object:
    """Its keys are said where there is no table, as in keep = ["max"]."""
    if not isinstance(value, Mapping | KeepTable):
        example = 'write it below [keep], as summary = ["min", "max"] and histories = 100, or leave it out'
        raise refusal(f"{show(value)} is not a table of summary and histories; {example}")
    return value


def _texts(value: object) -> tuple[str, ...]:
    """A text, or a list of texts."""
    texts = []
    for k, each in enumerate((value,) if isinstance(value, str | PathLike) else as_list(value)):
        if not isinstance(each, str | PathLike):
            raise refusal(f"{show(each)} is not a path; write that of a file (* stands for any characters)", k)
        texts.append(str(os.fspath(each)))
    if not texts:
        raise refusal("no path; write at least 1")
    return tuple(texts)


class SweepRequest(SceneTable):
    """A sweep as a user writes it.

    `vary` has the paths of fields in the order of their dimensions: all values with all others, or, where they are
    to `zip`, the k-th value of each in case k.
    """

    scene: Any = Field(description="the path of a scene")
    records: Annotated[tuple[str, ...], PlainValidator(_texts)] = ()
    zip: bool = False
    vary: dict[str, Values] = Field(default_factory=dict)
    keep: Annotated[KeepTable, BeforeValidator(_keep)] = KeepTable()

    _folder: str = PrivateAttr(default="")

    @model_validator(mode="before")
    @classmethod
    def _move_zip(cls, value: object) -> object:
        """`zip` may stand among the fields that it is about: no field of a scene is called so."""
        if isinstance(value, Mapping) and isinstance(vary := value.get("vary"), Mapping) and "zip" in vary:
            rest = {path: values for path, values in vary.items() if path != "zip"}
            return {**value, "vary": rest, "zip": vary["zip"]}
        return value

    @field_validator("zip", mode="before")
    @classmethod
    def _check_zip(cls, value: object) -> object:
        if not isinstance(value, bool):
            raise refusal(f"{show(value)} is not a truth value; write true or false")
        return value

    @model_validator(mode="after")
    def _require_variation(self) -> Self:
        if not self.vary and not self.records:
            raise refusal("nothing is varied; write a table [vary], or records")
        return self

    @property
    def folder(self) -> str:
        """Where its paths count from."""
        return self._folder

    @classmethod
    def read(cls, source: str | PathLike[str] | Mapping[str, Any]) -> tuple[str, Self]:
        """What messages call it, and the request: from a file, or from the same fields. Raises SceneError."""
        if isinstance(source, Mapping):
            file, text, folder, fields = "sweep", "", "", dict(source)
        else:
            file, text = read_text(source, _FORM)
            folder, fields = os.path.dirname(os.fspath(source)), parse_text(file, text)
        if "system" in fields and "scene" not in fields:
            raise SceneError('this is a scene, not a sweep; write `scene = "PATH"`, and what to `[vary]`', file=file)
        try:
            request = cls.model_validate(fields)
        except ValidationError as error:
            lines = key_lines(text)
            raise scene_error(error).in_file(file, lambda path: line_of(path, lines)) from None
        request._folder = folder
        return file, request

    def base(self) -> Scene:
        """The scene that cases are made of. SceneError names its file."""
        scene = self._read_base()
        scene.refuse_without_output()
        return scene

    def _read_base(self) -> Scene:
        if isinstance(self.scene, Scene):
            return self.scene
        if isinstance(self.scene, Mapping):
            return Scene(**self.scene)
        if not isinstance(self.scene, str | PathLike):
            raise refusal(f"{show(self.scene)} is not a scene; write the path of one, or the name of a built-in one")
        path = os.fspath(self.scene)
        return Scene.from_toml(path if path in builtin_names() else os.path.join(self.folder, path))
