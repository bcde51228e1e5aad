"""The loads of a scene: which tables they may be depends on the system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from wavesym.fields.loads import Load
from wavesym.fields.table import Faults, as_list, refusal
from wavesym.records.load import RecordedLoad
from wavesym.systems import SystemTable


def loads(tables: object, system: SystemTable) -> tuple[Load, ...]:
    """The loads on a system. Which keys a table has depends on the system, so pydantic is told here."""
    if isinstance(tables, Sequence) and tables and not system.load_kinds:
        raise refusal(f"{system.no_loads}; leave [[load]] out")
    faults = Faults()
    found = []
    for k, table in enumerate(as_list(tables)):
        with faults.gather(k):
            found.append(_load(table, system))
    faults.refuse()
    damping = getattr(system, "damping", None)
    if damping is None or not damping.acts:
        return tuple(found)
    return tuple(load.without_jump() if isinstance(load, RecordedLoad) else load for load in found)


def _load(table: object, system: SystemTable) -> Load:
    load = _kind(table, system.load_kinds).model_validate(table)
    if refused := system.load_fault(load):
        raise refusal(*refused)
    return load


def _kind(table: object, kinds: Sequence[type[Load]]) -> type[Load]:
    """The kind that has most of the keys that the first, usual one does not have; that one where there are none."""
    keys = table.keys() - kinds[0].model_fields.keys() if isinstance(table, Mapping) else set()
    return max(kinds, key=lambda kind: len(keys & kind.model_fields.keys()))
