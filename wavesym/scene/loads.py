"""The loads of a scene: which tables they may be depends on the system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pydantic import ValidationError

from wavesym.fields.loads import Load
from wavesym.fields.table import first_error, listed, wrong
from wavesym.records.load import RecordedLoad
from wavesym.systems import SystemTable


def loads(tables: object, system: SystemTable) -> tuple[Load, ...]:
    """The loads on a system. Which keys a table has depends on the system, so pydantic is told here."""
    if isinstance(tables, Sequence) and tables and not system.load_kinds:
        raise wrong(f"{system.no_loads}; leave [[load]] out")
    found = tuple(_load(table, k, system) for k, table in enumerate(listed(tables)))
    damping = getattr(system, "damping", None)
    if damping is None or not damping.acts:
        return found
    return tuple(load.without_jump() if isinstance(load, RecordedLoad) else load for load in found)


def _load(table: object, k: int, system: SystemTable) -> Load:
    try:
        load = _kind(table, system.load_kinds).model_validate(table)
    except ValidationError as error:
        what, path = first_error(error)
        raise wrong(what, k, *path) from None
    if refused := system.refused(load):
        what, key = refused
        raise wrong(what, k, key)
    return load


def _kind(table: object, kinds: Sequence[type[Load]]) -> type[Load]:
    """The kind that has most of the keys that the first, usual one does not have; that one where there are none."""
    keys = table.keys() - kinds[0].model_fields.keys() if isinstance(table, Mapping) else set()
    return max(kinds, key=lambda kind: len(keys & kind.model_fields.keys()))
