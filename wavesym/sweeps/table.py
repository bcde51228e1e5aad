"""The summary of a sweep as a table, a row for each case: CSV or Parquet, some thousand rows at a time."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Mapping
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from wavesym.errors import WavesymError, printable
from wavesym.sweeps.plan import CASE
from wavesym.sweeps.results import SweepResults, results
from wavesym.sweeps.store import require_packages
from wavesym.writing import write_whole

_ROWS = 4096
_FORMULAS = tuple("=+-@\t\r\uff1d\uff0b\uff0d\uff20")
_NUMBER = re.compile(r"[+-]?[0-9]+(\.[0-9]+)?")
_TIMES = {"tau_min": "time_min", "tau_max": "time_max", "arrival": "arrival_time"}
_PER_TAU = "time_per_tau"
Columns = dict[str, Any]


def write_table(folder: Path, path: Path) -> None:
    """Write the table of the sweep in a folder. WavesymError for a suffix that is neither .csv nor .parquet.

    Columns are the values that were varied, by path, and of each output NAME.min, NAME.max, NAME.tau_min, NAME.tau_max,
    as far as they were kept; of scenes with units the same as times, NAME.time_min [s], NAME.time_max [s], in the unit
    of time of results; of links LINK.set, with their unit. What there is no value of is empty.
    Parquet has the units of all columns in the metadata of fields ("unit"); CSV has none for it.
    """
    if path.suffix not in (".csv", ".parquet"):
        raise WavesymError(f"--table: {path} is not a table; write a file .csv or .parquet")
    if path.suffix == ".parquet":
        require_packages("pyarrow")
    found = results(folder)
    blocks = _columns(found)
    if path.suffix == ".csv":
        write_whole({path: _csv(blocks)})
    else:
        _parquet(blocks, path, _units(found))


def _columns(found: SweepResults) -> Iterator[Columns]:
    """The columns of a sweep's arrays, block of rows by block."""
    varied = [
        (axis, column.path if dimension.name == CASE else dimension.name, np.array(column.coordinate))
        for axis, dimension in enumerate(found.dimensions)
        for column in dimension.columns
    ]
    for part in _slabs(found.shape):
        counts = tuple(each.stop - each.start for each in part)
        place = np.unravel_index(np.arange(prod(counts)), counts)
        made: Columns = {name: values[part[axis]][place[axis]] for axis, name, values in varied}
        values = {name: found.array(name, part).reshape(len(place[0]), -1) for name in found.statistics}
        if found.time_unit:
            per_tau = found.array(_PER_TAU, part).reshape(-1, 1)
            times = {f"{_TIMES[name]} [{found.time_unit}]": values[name] * per_tau for name in _TIMES if name in values}
            values |= times
        for k, output in enumerate(found.outputs):
            made |= {f"{output}.{name}": values[name][:, k] for name in values}
        for name in found.link_statistics:
            each = found.array(name, part).reshape(len(place[0]), -1)
            units = found.manifest.links.items()
            made |= {f"{link}.{name}{unit and f' [{unit}]'}": each[:, k] for k, (link, unit) in enumerate(units)}
        yield made


def _units(found: SweepResults) -> dict[str, str]:
    """The units of columns whose names do not say them."""
    varied = {
        column.path if dimension.name == CASE else dimension.name: column.unit
        for dimension in found.dimensions
        for column in dimension.columns
    }
    values = [name for name in found.statistics if name not in _TIMES]
    return varied | {f"{output}.{name}": unit for output, unit in found.outputs.items() for name in values}


def _slabs(shape: tuple[int, ...]) -> Iterator[tuple[slice, ...]]:
    """Consecutive cases: the last dimensions whole, as far as they are few enough, and a part of the one before."""
    inner, axis = 1, len(shape)
    while axis and inner * shape[axis - 1] <= _ROWS:
        axis -= 1
        inner *= shape[axis]
    whole = tuple(slice(0, n) for n in shape[axis:])
    if not axis:
        yield whole
        return
    step = max(_ROWS // inner, 1)
    for place in np.ndindex(*shape[: axis - 1]):
        before = tuple(slice(k, k + 1) for k in place)
        for first in range(0, shape[axis - 1], step):
            yield (*before, slice(first, min(first + step, shape[axis - 1])), *whole)


def _csv(blocks: Iterator[Columns]) -> Iterator[str]:
    """Numbers in the shortest decimals that read back to them; nothing where there is none."""
    for number, block in enumerate(blocks):
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        if not number:
            writer.writerow(map(_text, block))
        columns = ([_cell(each) for each in column.tolist()] for column in block.values())
        writer.writerows(zip(*columns, strict=True))
        yield text.getvalue()


def _cell(value: object) -> str:
    if isinstance(value, float):
        return "" if value != value else repr(value)
    return _text(str(value))


def _text(text: str) -> str:
    """A text that a spreadsheet shows and does not compute: an apostrophe goes before what begins like a formula."""
    shown = printable(text)  # in one line
    return f"'{shown}" if text.startswith(_FORMULAS) and not _NUMBER.fullmatch(text) else shown


def _parquet(blocks: Iterator[Columns], path: Path, units: Mapping[str, str]) -> None:
    """With the units of columns in the metadata of their fields."""
    import pyarrow
    from pyarrow import parquet

    draft = path.with_name(f".{path.name}.part")
    writer = None
    try:
        for block in blocks:
            columns = {name: pyarrow.array(column.tolist()) for name, column in block.items()}
            noted = {name: {"unit": unit} for name, unit in units.items() if unit}
            fields = [pyarrow.field(name, each.type, metadata=noted.get(name)) for name, each in columns.items()]
            table = pyarrow.table(list(columns.values()), schema=pyarrow.schema(fields))
            writer = writer or parquet.ParquetWriter(draft, table.schema)
            writer.write_table(table)
        if writer:
            writer.close()
            draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)
