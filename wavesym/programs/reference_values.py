"""Reference values for a self-test: where it looks, and what is right there."""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpq

from wavesym.exact.reference import Reference, beginning
from wavesym.mechanics.model import Model
from wavesym.numbers.reals import Real
from wavesym.programs.program import ReferenceValues

_MOST_POINTS = 2000
_MOST_VALUES = 40_000


def reference_values(model: Model, real: Real, check_points: Sequence[float]) -> ReferenceValues:
    """The outputs of a model at some of its check points.

    Args:
        model: with the loads and parameters that are tested.
        real: the numbers of the program.
        check_points: tau, ascending. On very long horizons they cover only the beginning.
    """
    reference = Reference(beginning(model), real)
    most = max(10, min(_MOST_POINTS, _MOST_VALUES // len(model.probes)))
    taus = _thin_out([tau for tau in check_points if tau <= reference.tau_max], most)
    return ReferenceValues(tuple(taus), tuple(map(tuple, reference.values(taus))))


def leap(k: int, j: int) -> fmpq:
    """Numbers from -1 to 1 that differ much from one sample k to the next, and from load j to load."""
    return fmpq((7 * k * k + 3 * k + 5 * j) % 17 - 8, 8)


def _thin_out(points: Sequence[float], most: int) -> Sequence[float]:
    """No more points than a self-test should carry, spread evenly over those there are."""
    step = -(-len(points) // most)
    return [*points[::step], points[-1]] if step > 1 else points
