"""The closed form in NumPy."""

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.programs.schemes.scheme import Scheme


class ClosedScheme(Scheme):
    """The closed form: from tau = start on, with w = (tau - start) + excess, an output contains a pulse,

    sum over its families of exp(-rate*w) * (coefficient[0] + coefficient[1]*w + ...).
    """

    def _read(self, tables: dict[str, tuple[float, ...]], constants: dict[str, float]) -> None:
        self._first_pulse, self._first_family, self._first_power = (
            [int(place) for place in tables[name]] for name in ("first_pulse", "first_family", "first_power")
        )
        self._start, self._excess, self._rate, self._coefficient = (
            np.array(tables[name], self.real) for name in ("start", "excess", "rate", "coefficient")
        )
        self.outputs = len(self._first_pulse) - 1

    def _values(self, tau: Array) -> Array:
        out = np.zeros((self.outputs, tau.size), self.real)
        for row, first, end in zip(out, self._first_pulse, self._first_pulse[1:], strict=False):
            for pulse in range(first, end):
                late = slice(np.searchsorted(tau, self._start[pulse]), None)
                w = (tau[late] - self._start[pulse]) + self._excess[pulse]
                for family in range(self._first_family[pulse], self._first_family[pulse + 1]):
                    powers = self._coefficient[self._first_power[family] : self._first_power[family + 1]]
                    polynomial = np.full(w.shape, powers[-1], self.real)
                    for coefficient in powers[-2::-1]:
                        polynomial = polynomial * w + coefficient
                    row[late] += polynomial * np.exp(-(self._rate[family] * w))
        return out
