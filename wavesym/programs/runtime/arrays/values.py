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
    window, section, t = tables.places(tau[inside])
    for place in np.unique(np.stack([window, section]), axis=1).T:
        here = (window == place[0]) & (section == place[1])
        for output in range(tables.outputs):
            total = np.zeros((lanes, sets, int(here.sum())))
            for strand in tables.strands(int(place[1]), output):
                series = march.series[place[0]][strand]
                u = tables.on(strand, t[here], int(place[0]) % tables.cycle)
                total += np.tensordot(series, chebyshev(u, len(series) - 1), axes=(0, 1))
            found[:, :, output, inside[here]] = np.moveaxis(total, 1, 0)
    found[march.status != 0] = np.nan
    return found
