"""Extremes of several scenes as arrays, in the form in which xarray has them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.util import find_spec
from typing import Any

import numpy as np

from wavesym.results.summary import OutputSummary, Summary

_COLUMNS: dict[str, Callable[[OutputSummary], float]] = {
    "min": lambda output: output.min.value,
    "max": lambda output: output.max.value,
    "tau_min": lambda output: output.min.at.tau,
    "tau_max": lambda output: output.max.at.tau,
    "arrival": lambda output: np.nan if output.arrival is None else output.arrival.tau,
}


def table_of_peaks(summaries: Sequence[Summary], several: bool) -> Any:
    """Each column over (case, output), or of one scene over (output): an xarray.Dataset, or a dict of arrays."""
    names = list(dict.fromkeys(output.name for summary in summaries for output in summary.outputs))
    place = {name: k for k, name in enumerate(names)}
    columns = {}
    for column, value in _COLUMNS.items():
        columns[column] = np.full((len(summaries), len(names)), np.nan)
        for row, summary in zip(columns[column], summaries, strict=True):
            for output in summary.outputs:
                row[place[output.name]] = value(output)
    labels = {"case": np.array([summary.name for summary in summaries]), "output": np.array(names)}
    if not several:
        del labels["case"]
        columns = {column: values[0] for column, values in columns.items()}
    if not find_spec("xarray"):
        return labels | columns
    import xarray

    dimensions = tuple(labels)
    return xarray.Dataset({column: (dimensions, values) for column, values in columns.items()}, labels)
