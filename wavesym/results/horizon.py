"""Instants outside a horizon, where nothing is computed: one warning from Python, or an error."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import WavesymError


def check_horizon(tau: NDArray[np.floating[Any]], tau_max: float, *, strict: bool) -> None:
    """Say once how many instants have no value.

    Args:
        tau: instants, dimensionless, of any shape.
        tau_max: the end of the horizon, dimensionless.
        strict: whether they are an error.

    Raises:
        WavesymError: where `strict`, for an instant that is NaN or outside [0, tau_max]; else that is a UserWarning.
    """
    outside = tau.size - int(np.count_nonzero((tau >= 0.0) & (tau <= tau_max)))
    if not outside:
        return
    what = f"{outside} of {tau.size} tau are outside 0 to {tau_max:g}"
    if strict:
        raise WavesymError(f"tau: {what}, where there are no values; leave them out or raise `until`")
    warnings.warn(f"{what}, where values are nan", UserWarning, stacklevel=3)
