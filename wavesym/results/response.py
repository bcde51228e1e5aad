"""A scene's outputs as one function of tau, right to the last bit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wavesym.exact.events import events
from wavesym.exact.reference import Reference
from wavesym.model.event import ContactEvent
from wavesym.model.model import Model

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Response:
    """A scene's outputs as one function: the exact tables in ball arithmetic, each value rounded once.

    `outputs` are their names, `tau_max` the end of the horizon; `error_bound` is relative to an output's largest value.
    `events` are what contacts do that open and close, in order of time.
    `wavesym.evaluator` makes it.
    """

    model: Model

    @cached_property
    def _reference(self) -> Reference:
        return Reference(self.model)

    @property
    def outputs(self) -> tuple[str, ...]:
        return tuple(probe.name for probe in self.model.probes)

    @property
    def tau_max(self) -> float:
        return self.model.horizon()

    @property
    def error_bound(self) -> float:
        return 2.0**-53

    @cached_property
    def events(self) -> tuple[ContactEvent, ...]:
        return events(self.model)

    def __call__(self, tau: ArrayLike) -> NDArray[np.float64]:
        """Values at tau (dimensionless): shape (len(outputs), *tau.shape), NaN where tau is out of [0, tau_max]."""
        taus = np.asarray(tau, dtype=np.float64)
        flat = taus.ravel()
        inside = (flat >= 0.0) & (flat <= self.tau_max)
        out = np.full((len(self.outputs), flat.size), np.nan)
        out[:, inside] = self._reference.values(flat[inside].tolist())
        return out.reshape(len(self.outputs), *taus.shape)
