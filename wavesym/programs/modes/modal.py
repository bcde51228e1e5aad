"""A chain as oscillators that do not feel each other, driven by loads, and its outputs as sums of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class ModalSystem:
    """Oscillators n with loads a_j, all at rest at tau = 0; dimensionless.

        y_n'' + 2 damping_n frequency_n y_n' + frequency_n^2 y_n = sum_j pushes[n, j] a_j(tau)
        output_o = sum_n (moved[o, n] y_n + moving[o, n] y_n') + sum_j sum_k direct[o, j, k] I^k a_j

    I^k is the k-th integral from tau = 0, k = 0, 1, 2. `frequency` (modes,), `damping` (modes,), `pushes` (modes,
    loads), `moved` and `moving` (outputs, modes), `direct` (outputs, loads, 3). A frequency may be 0.
    """

    frequency: Numbers
    damping: Numbers
    pushes: Numbers
    moved: Numbers
    moving: Numbers
    direct: Numbers
