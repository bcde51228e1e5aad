"""Instants outside a horizon, where nothing is computed: one warning from Python, or an error."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import WavesymError
from wavesym.mechanics.clock import Clock
from wavesym.numbers.doubles import nearest


def check_horizon(tau: NDArray[np.floating[Any]], tau_max: float, *, strict: bool, clock: Clock | None = None) -> None:
    """Say once how many instants have no value.

    Args:
        tau: instants, dimensionless, of any shape.
        tau_max: the end of the horizon, dimensionless.
        strict: whether they are an error.
        clock: that of instants which were given as times.

    Raises:
        WavesymError: where `strict`, for an instant that is NaN or outside [0, tau_max]; else that is a UserWarning.
    """
    outside = tau.size - int(np.count_nonzero((tau >= 0.0) & (tau <= tau_max)))
    if not outside:
        return
    name, unit = ("tau", "") if clock is None else ("times", f" {clock.unit}")
    until = tau_max if clock is None else tau_max * nearest(clock.per_tau)
    what = f"{outside} of {tau.size} {name} are outside 0 to {until:g}{unit}"
    if strict:
        raise WavesymError(f"{name}: {what}, where there are no values; leave them out or raise `until`")
    warnings.warn(f"{what}, where values are nan", UserWarning, stacklevel=3)
