"""The cases of a sweep: how many, which scene each of them is, and a hash of all that goes in."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import prod
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from wavesym import __version__
from wavesym.errors import SceneError
from wavesym.fields.table import faults_of, show
from wavesym.results.link_losses import losing_links, set_unit
from wavesym.results.statistics import LINK_ARRAYS
from wavesym.scene.lowering import lower
from wavesym.scene.paths import replace_at_path, steps
from wavesym.scene.physical.scene import acts
from wavesym.scene.scene import Scene
from wavesym.sweeps.dimension import Column, SweepAxis, count_of, spread
from wavesym.sweeps.record_files import Unreadable, match_files, record_column
from wavesym.sweeps.request import SweepRequest

SCHEMA = 2
MOST = 10_000_000
"""Cases of a sweep."""
_DIMENSIONS = 30  # with outputs and samples as many as an array of NumPy can have
RECORD, CASE, OUTPUT, SAMPLE, LINK = "record", "case", "output", "sample", "link"
"""Names of dimensions."""
_UNCHANGED = ("until", "tolerance")  # fields of the output that make no other outputs


@dataclass(frozen=True)
class SweepPlan:
    """A sweep as it is carried out: cases are numbered from 0, the last dimension fastest.

    `fields` are those of the scene of the first case, plain; `summary` and `histories` say what is kept. `outputs` are
    the names of all outputs that some case has, with their `units`; `time_unit` is None for scenes without units.
    `links` are those whose permanent sets are kept, in `link_unit`.
    """

    name: str
    fields: dict[str, Any]
    dimensions: tuple[SweepAxis, ...]
    summary: tuple[str, ...]
    histories: int | None
    outputs: tuple[str, ...]
    units: tuple[str, ...]
    time_unit: str | None
    links: tuple[str, ...] = ()
    link_unit: str = ""

    @property
    def records(self) -> Column | None:
        """The records, where they are a dimension: the last one."""
        last = self.dimensions[-1]
        return last.columns[0] if last.name == RECORD else None

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(map(len, self.dimensions))

    @property
    def cases(self) -> int:
        return prod(self.shape)

    def place(self, case: int) -> tuple[int, ...]:
        """The index of a case in each dimension."""
        return tuple(int(k) for k in np.unravel_index(case, self.shape))

    def number(self, place: tuple[int, ...]) -> int:
        """The case at a place."""
        return int(np.ravel_multi_index(place, self.shape))

    def labels_at(self, place: tuple[int, ...]) -> dict[str, str]:
        """The values that make a case, by path, as they are written."""
        chosen = zip(self.dimensions, place, strict=True)
        return {column.path: column.labels[k] for dimension, k in chosen for column in dimension.columns}

    def fields_at(self, place: tuple[int, ...]) -> dict[str, Any]:
        """The fields of a case's scene. SceneError where its record cannot be read."""
        fields = self.fields
        for dimension, k in zip(self.dimensions, place, strict=True):
            for column in dimension.columns:
                value = column.values[k]
                if isinstance(value, Unreadable):
                    raise SceneError(value.reason, column.path)
                fields = replace_at_path(fields, column.path, value)
        return fields

    def scene(self, place: tuple[int, ...]) -> Scene:
        """The scene of the case at a place. SceneError where it is none."""
        return Scene(**self.fields_at(place))

    @property
    def first_scene(self) -> dict[str, Any]:
        """The fields of the first case's scene, its record by name."""
        fields = self.fields
        for dimension in self.dimensions:
            for column in dimension.columns:
                if isinstance(column.values[0], dict | Unreadable):
                    fields = replace_at_path(fields, column.path, column.labels[0])
        return fields

    @cached_property
    def sha256(self) -> str:
        """Of all that goes in: scene, values, records by content, what is kept, and the version of wavesym."""
        return _hash(self._content)

    @property
    def _content(self) -> dict[str, Any]:
        columns = [[[column.path, *map(_key, column.values)] for column in d.columns] for d in self.dimensions]
        return {
            "schema_version": SCHEMA,
            "wavesym": __version__,
            "scene": self.fields,
            "vary": columns,
            "keep": {"summary": self.summary, "histories": self.histories},
        }


def _key(value: object) -> object:
    return _hash(value) if isinstance(value, dict) else value


def _hash(value: object) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=str).encode()).hexdigest()


def plan(request: SweepRequest, file: str) -> SweepPlan:
    """What a request comes to. SceneError, which names the `file`, for what is wrong with it."""
    try:
        return _make_plan(request)
    except SceneError as error:
        raise error if error.file != "scene" else SceneError(error.what, error.path, file) from None
    except PydanticCustomError as error:
        raise SceneError(str(error), "scene", file) from None


def _make_plan(request: SweepRequest) -> SweepPlan:
    files = match_files(request.records, request.folder)
    _refuse_many(request, max(len(files), 1))
    base = request.base()
    fields = json.loads(json.dumps(base.model_dump(), default=str))
    columns = [_column(request, base, fields, path) for path in request.vary]
    dimensions = [SweepAxis(column.path, (column,)) for column in columns]
    if request.zip:
        dimensions = [SweepAxis(CASE, tuple(columns))] if columns else []
    if files:
        dimensions.append(SweepAxis(RECORD, (_records(request, base, fields, files),)))
    for dimension in dimensions:
        dimension.refuse_duplicates("vary" if dimension.name == CASE else f"vary.{dimension.name}")
    _refuse_overlap([column.path for dimension in dimensions for column in dimension.columns])
    for dimension in dimensions:
        for column in dimension.columns:
            if not isinstance(column.values[0], Unreadable):
                fields = replace_at_path(fields, column.path, column.values[0])
    watched = _all_outputs(base, fields, dimensions)
    return SweepPlan(
        base.name,
        fields,
        tuple(dimensions),
        request.keep.summary,
        request.keep.histories,
        tuple(watched),
        tuple(watched.values()),
        base.scale.clock.unit if base.scale else None,
        *_links(base, request.keep.summary),
    )


def link_name(where: str, law: str) -> str:
    """What a link is called in a sweep."""
    return f"{law} at {where}"


def _links(base: Scene, summary: tuple[str, ...]) -> tuple[tuple[str, ...], str]:
    """The links whose sets are kept, and the unit of these. SceneError where there is none."""
    if LINK_ARRAYS.keys().isdisjoint(summary):
        return (), ""
    model = lower(base)
    if not (names := tuple(dict.fromkeys(link_name(*each) for each in losing_links(model)))):
        raise SceneError("set, but no link of the scene yields or rubs; write what its outputs have", "keep.summary")
    return names, set_unit(model)


def _refuse_many(request: SweepRequest, records: int) -> None:
    counts = {path: count_of(values) for path, values in request.vary.items()}
    if request.zip and len(set(counts.values())) > 1:
        counts_text = ", ".join(f"{count} of {path}" for path, count in counts.items())
        raise SceneError(f"{counts_text} are run through side by side; write as many values of each", "vary")
    cases = records * (next(iter(counts.values()), 1) if request.zip else prod(counts.values()))
    dimensions = 1 if request.zip else len(counts) + (records > 1)
    if dimensions > _DIMENSIONS:
        most = f"the limit is {_DIMENSIONS}; write zip = true to run fields side by side, in one dimension"
        raise SceneError(f"{dimensions} dimensions, {most}", "vary")
    if cases > MOST:
        raise SceneError(f"{cases} cases, the limit is {MOST}; write fewer values", "vary")


def _column(request: SweepRequest, base: Scene, fields: dict[str, Any], path: str) -> Column:
    """The values of a path, which leads to a field of the scene."""
    at = f"vary.{show(path)}"
    try:
        values = spread(request.vary[path])
        replace_at_path(fields, path, None)
        way = steps(path)
        if len(way) == 1:
            raise SceneError('a whole table; write a field in it, such as "output.until"')
        if way[:1] == ["load"] and way[2:] == ["record"] and all(isinstance(value, str) for value in values):
            files = [each for value in values for each in match_files([str(value)], request.folder)]
            return record_column(
                path, files, request.folder, fields["load"][way[1]], acts(fields) if base.scale else None
            )
        column = Column.from_values(path, values)
    except SceneError as error:
        raise SceneError(error.what, at) from None
    except PydanticCustomError as error:
        what, keys = faults_of(error)[0]
        raise SceneError(what, at + "".join(f".{key}" for key in keys)) from None
    try:
        Scene(**replace_at_path(fields, path, column.values[0]))
    except SceneError as error:
        if error.what.startswith("unknown key") and error.path == path:
            raise SceneError(error.what, at) from None
    return column


def _records(request: SweepRequest, base: Scene, fields: dict[str, Any], files: list[str]) -> Column:
    """The record of the one load that has one."""
    loads = [k for k, load in enumerate(fields["load"]) if isinstance(load, dict) and "record" in load]
    if len(loads) != 1:
        raise SceneError(f"{len(loads)} loads of the scene have a record; write one that has", "records")
    path = f"load[{loads[0]}].record"
    return record_column(path, files, request.folder, fields["load"][loads[0]], acts(fields) if base.scale else None)


def _refuse_overlap(paths: list[str]) -> None:
    for path in paths:
        for other in paths:
            inner, outer = steps(path), steps(other)
            if path != other and inner[: len(outer)] == outer:
                raise SceneError(
                    f"{show(other)} is varied too, and one is part of the other; write fields that lie apart",
                    f"vary.{show(path)}",
                )


def output_units(scene: Scene) -> dict[str, str]:
    """The outputs of a scene, in order, with their units."""
    scale = scene.scale
    return {each.name: scale.unit(each.quantity) if scale else "" for each in scene.outputs}


def _all_outputs(base: Scene, fields: dict[str, Any], dimensions: list[SweepAxis]) -> dict[str, str]:
    """The outputs of all cases, in order, with their units."""
    varied = [dimension for dimension in dimensions if any(map(_makes_outputs, dimension.columns))]
    if not varied:
        return output_units(base)
    watched: dict[str, str] = {}
    for scene in _scenes(fields, varied):
        watched |= {name: unit for name, unit in output_units(scene).items() if name not in watched}
    return watched or output_units(base)


def _makes_outputs(column: Column) -> bool:
    way = steps(column.path)
    return way[0] == "output" and (way[1:2] == [] or way[1] not in _UNCHANGED)


def _scenes(fields: dict[str, Any], dimensions: list[SweepAxis]) -> Iterator[Scene]:
    for place in product(*(range(len(dimension)) for dimension in dimensions)):
        made = fields
        for dimension, k in zip(dimensions, place, strict=True):
            for column in dimension.columns:
                made = replace_at_path(made, column.path, column.values[k])
        try:
            yield Scene(**made)
        except SceneError:
            continue  # the case will fail and say so
