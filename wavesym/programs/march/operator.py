"""What a body does to a wave on a panel, as three short tables; computed in balls, rounded once.

On a panel of length h, u in [-1, 1], a body obeys q' + rate q = rate p, where p = (alpha a + beta b + load)/g. With
q and p as Chebyshev series of degree d, integrated once in coefficient space, this reads for k = 1 ... d

    q_k + x_k (q_(k-1) - q_(k+1)) = x_k (p_(k-1) - p_(k+1)),        x_k = rate h / (4 k),

where q_0 and p_0 count twice and what is beyond d is 0; and sum (-1)^k q_k is the velocity at the start. Eliminated
from k = d down, as in Miller's algorithm,

    y_k = e_k (p_(k-1) - p_(k+1) + y_(k+1)),    q_k = y_k - e_k q_(k-1),    e_k = x_k / (1 + x_k e_(k+1)),

so that 0 < e_k < 1 (they are ratios of Bessel functions I_k / I_(k-1)) and nothing grows. The velocities at both ends
are then sums over y, known before q is:

    q_0 = (1 - slack) (start - sum_k first_k y_k),        end = (1 - loss) q_0 + sum_k last_k y_k.

Where bodies are heavy, slack and loss are small: rounded as they are, they leave no trace in 100 000 windows.

The polynomial misses the equation by the one term that does not fit, x_(d+1) (q_d - p_d) T_(d+1): the `leak`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from flint import arb, ctx, fmpq
from numpy.typing import NDArray

from wavesym.numbers.doubles import midpoint

Array = NDArray[np.float64]

_BITS = 300


@dataclass(frozen=True)
class PanelOperator:
    """The tables of a rate on a panel; `ratio[k]`, `first[k]` and `last[k]` for k = 0 ... degree, entry 0 unused (0).

    All dimensionless. `step` is rate times the panel's length; `leak` is x_(degree + 1).
    """

    step: float
    ratio: tuple[float, ...]
    first: tuple[float, ...]
    last: tuple[float, ...]
    slack: float
    loss: float
    leak: float


def operator(step: fmpq, degree: int) -> PanelOperator:
    """The operator of bodies with rate * length = `step` > 0 on series of `degree`, each number rounded once."""
    with ctx.workprec(_BITS):
        x = [arb(step) / (4 * k) if k else arb(0) for k in range(degree + 2)]
        ratio = [arb(0)] * (degree + 2)
        first = [arb(0)] * (degree + 2)
        last = [arb(0)] * (degree + 2)
        for k in range(degree, 0, -1):
            ratio[k] = x[k] / (1 + x[k] * ratio[k + 1])
            first[k] = (-1) ** k - ratio[k + 1] * first[k + 1]
            last[k] = 1 - ratio[k + 1] * last[k + 1]
        doubled = 2 * ratio[1]
        return PanelOperator(
            step=midpoint(arb(step)),
            ratio=tuple(map(midpoint, ratio[:-1])),
            first=tuple(map(midpoint, first[:-1])),
            last=tuple(map(midpoint, last[:-1])),
            slack=midpoint(-doubled * first[1] / (1 - doubled * first[1])),
            loss=midpoint(doubled * last[1]),
            leak=midpoint(x[degree + 1]),
        )


class Sweeps:
    """The recurrences of some operators on arrays, each as a scan: log2(degree) steps instead of degree.

    `down(v)` solves w_k = v_k + e_k w_(k+1), `up(v)` solves w_k = v_k - e_k w_(k-1), along the last axis, for rows of
    coefficients 0 ... degree that belong to the operators in order (the axis before).
    """

    def __init__(self, ratio: Array) -> None:
        self._down = _strides(ratio, backwards=True)
        self._up = _strides(-ratio, backwards=False)

    @property
    def levels(self) -> int:
        """Into how many additions an input goes at most, less one."""
        return max(len(self._down), len(self._up))

    def down(self, values: Array) -> Array:
        """From the last coefficient to the first."""
        result = values.copy()
        for stride, products in self._down:
            result[..., :-stride] += products * result[..., stride:]
        return result

    def up(self, values: Array) -> Array:
        """From the first coefficient to the last."""
        result = values.copy()
        for stride, products in self._up:
            result[..., stride:] += products * result[..., :-stride]
        return result


NEGLIGIBLE = 2.0**-100
"""Products of ratios below it are left out of a scan: all of them together are far below one rounding."""


def _strides(factor: Array, *, backwards: bool) -> list[tuple[int, Array]]:
    """For stride 1, 2, 4 ... the products of as many factors; none where they are too small to matter."""
    result = []
    stride, products = 1, factor
    while stride < factor.shape[-1] and np.max(np.abs(products), initial=0.0) > NEGLIGIBLE:
        longer = np.zeros_like(products)
        if backwards:
            result.append((stride, products[..., :-stride].copy()))
            longer[..., :-stride] = products[..., :-stride] * products[..., stride:]
        else:
            result.append((stride, products[..., stride:].copy()))
            longer[..., stride:] = products[..., stride:] * products[..., :-stride]
        stride, products = 2 * stride, longer
    return result
