"""The closed form in NumPy."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


class ClosedScheme:
    """The closed form: from tau = start on, with w = (tau - start) + excess, an output contains a pulse,

        sum over its families of exp(-rate*w) * (coefficient[0] + coefficient[1]*w + ...).

    The pulses of output o are first_pulse[o] ... first_pulse[o + 1] - 1; so on for families, powers.
    """

    TABLES = ("first_pulse", "start", "excess", "first_family", "rate", "first_power", "coefficient")
    CONSTANTS = ()

    def __init__(
        self,
        tables: dict[str, tuple[float, ...]],
        constants: dict[str, float],
        tau_max: float,
        real: type[np.float64],
    ) -> None:
        self._tau_max, self._real = tau_max, real
        self._first_pulse, self._first_family, self._first_power = (
            [int(place) for place in tables[name]] for name in ("first_pulse", "first_family", "first_power")
        )
        self._start, self._excess, self._rate, self._coefficient = (
            np.array(tables[name], real) for name in ("start", "excess", "rate", "coefficient")
        )

    def evaluate(self, tau: ArrayLike) -> NDArray[np.float64]:
        """All outputs at tau, an array or a number: shape (outputs, *tau.shape), NaN where tau is out of range."""
        taus = np.asarray(tau, dtype=self._real)
        flat = taus.ravel()
        outputs = len(self._first_pulse) - 1
        out = np.zeros((outputs, flat.size), self._real)
        inside = (flat >= 0.0) & (flat <= self._tau_max)
        for row, first, end in zip(out, self._first_pulse, self._first_pulse[1:], strict=False):
            for pulse in range(first, end):
                late = inside & (flat >= self._start[pulse])
                w = (flat[late] - self._start[pulse]) + self._excess[pulse]
                for family in range(self._first_family[pulse], self._first_family[pulse + 1]):
                    powers = self._coefficient[self._first_power[family] : self._first_power[family + 1]]
                    polynomial = np.full(w.shape, powers[-1], self._real)
                    for coefficient in powers[-2::-1]:
                        polynomial = polynomial * w + coefficient
                    row[late] += polynomial * np.exp(-(self._rate[family] * w))
        out[:, ~inside] = np.nan
        return out.reshape(outputs, *taus.shape)
