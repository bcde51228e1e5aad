"""Series at given instants."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from wavesym.programs.runtime.arrays.march import ArrayMarch
from wavesym.programs.runtime.arrays.tables import ArrayTables
from wavesym.programs.runtime.engine import Array


def chebyshev(u: Array, degree: int) -> Array:
    """T_0 ... T_degree at u: of shape (*u.shape, degree + 1)."""
    return chebvander(u, degree).astype(np.float64, copy=False)


def array_values(tables: ArrayTables, march: ArrayMarch, tau: Array) -> Array:
    """Of shape (sets, 1 + lanes, outputs, times); NaN out of range, and for sets that are refused."""
    lanes, sets = march.series[0].shape[2:]
    found = np.full((sets, lanes, tables.outputs, len(tau)), np.nan)
    inside = np.flatnonzero((tau >= 0) & (tau <= tables.tau_max))
    window = tau[inside].astype(np.int64)
    t = tau[inside] - window
    section = np.searchsorted(tables["from"][1:-1], t, side="right")
    for place in np.unique(np.stack([window, section]), axis=1).T:
        here = (window == place[0]) & (section == place[1])
        for output in range(tables.outputs):
            total = np.zeros((lanes, sets, int(here.sum())))
            for strand in tables.strands(int(place[1]), output):
                series = march.series[place[0]][strand]
                weights = chebyshev(tables.on(strand, t[here]), len(series) - 1)
                total += np.tensordot(series, weights, axes=(0, 1))
            found[:, :, output, inside[here]] = np.moveaxis(total, 1, 0)
    found[march.status != 0] = np.nan
    return found
