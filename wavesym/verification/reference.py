"""What everything is compared with: the outputs of a model in ball arithmetic, where errors are most likely."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from wavesym.exact.reference import Reference, beginning
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe

T = TypeVar("T", np.float64, np.int_)

_SPREAD, _EVEN = 300, 101
_DIGITS = 12  # binary ones; there are 24, and 7 are of the number of the instant
_GOLDEN = (math.sqrt(5) - 1) / 2


@dataclass(frozen=True)
class KnownOutput:
    """One output: its values at the reference's taus, right to the last bit, and the largest of them."""

    probe: Probe
    values: NDArray[np.float64]

    @cached_property
    def zero(self) -> bool:
        """Whether the output is 0 throughout."""
        return not np.any(self.values)

    @cached_property
    def scale(self) -> float:
        """What errors are relative to: the largest absolute value, or 1 for an output that is 0 throughout."""
        return 1.0 if self.zero else float(np.max(np.abs(self.values)))

    def error(self, values: NDArray[np.float64]) -> float:
        """The largest error of `values`; NaN where one of them is NaN."""
        return float(np.max(np.abs(values - self.values))) / self.scale


@dataclass(frozen=True, eq=False)
class ReferenceOutputs:
    """The outputs of a model at `taus`, doubles in [0, until]; it is the `whole` one, or its beginning.

    `starts` are those of the taus from which on an output may be something else than before. `independent` is the model
    as integrators read it (independent.py); without it they start from the network of programs. `exact` has more
    values, where there are any.
    """

    whole: Model
    model: Model
    until: float
    taus: Sequence[float]
    outputs: tuple[KnownOutput, ...]
    starts: frozenset[float] = frozenset()
    independent: Model | None = None
    exact: Reference | None = None

    @property
    def integration_model(self) -> Model:
        """What integrators start from, as far as it is known."""
        return self.model if self.independent is None else self.independent.shorten(self.model.until)

    @property
    def names(self) -> list[str]:
        """The names of the outputs."""
        return [probe.name for probe in self.whole.probes]

    @property
    def notes(self) -> Sequence[str]:
        """What a reader should know of it."""
        if self.model.until == self.whole.until:
            return []
        return [f"{self.whole.name}: compared to tau = {self.until:g}; exact values of all of it would take too long"]


def known_outputs(model: Model, independent: Model | None = None) -> ReferenceOutputs:
    """A model's outputs at a few hundred spread taus, at every arrival, the doubles beside it, and between any two.

    Of a long horizon the beginning, as far as it can be known in moderate time. `independent`: see `Known`.
    """
    exact = Reference(beginning(model))
    starts = exact.breakpoints()
    taus = sorted(set(_taus(exact.tau_max, starts)))
    outputs = (
        KnownOutput(probe, np.array(values)) for probe, values in zip(model.probes, exact.values(taus), strict=True)
    )
    return ReferenceOutputs(
        model, exact.model, exact.tau_max, taus, tuple(outputs), frozenset(starts), independent, exact
    )


def unknown_outputs(model: Model, independent: Model | None = None) -> ReferenceOutputs:
    """A model whose modes are damped, which balls know nothing of."""
    return ReferenceOutputs(model, model, model.horizon(), (), (), independent=independent)


def spread_taus(until: float) -> list[float]:
    """Instants on [0, until], evenly and on no grid of any evaluator; single precision has them, too."""
    golden = np.array([math.fmod(k * _GOLDEN, 1) * until for k in range(1, _SPREAD + 1)], np.float32)
    return [tau for tau in golden.astype(np.float64).tolist() if tau <= until]


def even_taus(until: float) -> NDArray[np.float64]:
    """Multiples k d <= until of a d so short a number that none of them is rounded, in single precision neither."""
    mantissa, power = math.frexp(until / (_EVEN - 1))
    return np.arange(_EVEN, dtype=np.float64) * math.ldexp(math.floor(mantissa * 2.0**_DIGITS), power - _DIGITS)


def sample_evenly(values: NDArray[T], most: int) -> NDArray[T]:
    """As many of some values as are looked at, evenly spread over their places."""
    count = min(len(values), most)
    return np.asarray(values[np.linspace(0, len(values) - 1, count).round().astype(int)])


def _taus(until: float, starts: Sequence[float]) -> Iterator[float]:
    yield from (0.0, until)
    yield from spread_taus(until)
    yield from even_taus(until).tolist()
    for begin, end in pairwise([0.0, *starts, until]):
        middle = float(np.float32((begin + end) / 2))
        yield middle if begin < middle < end else (begin + end) / 2
    for first in starts:
        for tau in (math.nextafter(first, -math.inf), first, math.nextafter(first, math.inf)):
            if 0 <= tau <= until:
                yield tau
