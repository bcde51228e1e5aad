"""What all programs in NumPy have in common: numbers go in, and outputs at any tau come out."""

import numpy as np
from numpy.typing import ArrayLike

from wavesym.numbers.arrays import Array


class Scheme:
    """Outputs at any tau from 0 to `tau_max`, in `real` numbers, from tables and single numbers.

    Each kind of program has a scheme that reads these, and has the outputs at ascending tau in range.
    """

    outputs: int

    def __init__(
        self, tables: dict[str, tuple[float, ...]], constants: dict[str, float], tau_max: float, real: type[np.float64]
    ) -> None:
        self.tau_max, self.real = tau_max, real
        self._read(tables, constants)

    def _read(self, tables: dict[str, tuple[float, ...]], constants: dict[str, float]) -> None:
        raise NotImplementedError

    def _values(self, tau: Array) -> Array:
        raise NotImplementedError

    def evaluate(self, tau: ArrayLike) -> Array:
        """All outputs at tau, an array or a number: shape (outputs, *tau.shape), NaN where tau is out of range."""
        taus = np.asarray(tau, dtype=self.real)
        flat = taus.ravel()
        order = None if flat.size < 2 or np.all(flat[1:] >= flat[:-1]) else np.argsort(flat, kind="stable")
        ascending = flat if order is None else flat[order]
        inside = slice(np.searchsorted(ascending, 0.0), np.searchsorted(ascending, self.tau_max, side="right"))
        if order is None and 0 < inside.stop - inside.start == flat.size:
            return self._values(flat).reshape(self.outputs, *taus.shape)
        out = np.full((self.outputs, flat.size), np.nan, self.real)
        if inside.start < inside.stop:
            out[:, inside if order is None else order[inside]] = self._values(ascending[inside])
        return out.reshape(self.outputs, *taus.shape)
