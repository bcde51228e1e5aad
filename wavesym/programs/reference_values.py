"""Reference values for a self-test: where it looks, and what is right there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from wavesym.exact.reference import Reference, beginning
from wavesym.mechanics.model import Model
from wavesym.numbers.reals import Real
from wavesym.programs.program import ProgramOutput, ReferenceValues, StreamedValues

_MOST_POINTS = 2000
_MOST_VALUES = 40_000


class Checked(Protocol):
    """What has outputs to check, in numbers of a format, at some tau."""

    @property
    def real(self) -> Real: ...

    @property
    def outputs(self) -> tuple[ProgramOutput, ...]: ...

    @property
    def check_points(self) -> list[float]: ...


@runtime_checkable
class Streamed(Protocol):
    """What is checked as a stream, from its own exact steps."""

    def streamed(self) -> StreamedValues: ...


def reference_values(model: Model, evaluator: Checked) -> ReferenceValues | StreamedValues:
    """At the points that an evaluator wants checked. On very long horizons they cover only the beginning."""
    if isinstance(evaluator, Streamed):
        return evaluator.streamed()
    reference = Reference(beginning(model), evaluator.real)
    most = max(10, min(_MOST_POINTS, _MOST_VALUES // len(evaluator.outputs)))
    taus = _thinned([tau for tau in evaluator.check_points if tau <= reference.tau_max], most)
    return ReferenceValues(tuple(taus), tuple(map(tuple, reference.values(taus))))


def _thinned(points: Sequence[float], most: int) -> Sequence[float]:
    """No more points than a self-test should carry, spread evenly over those there are."""
    step = -(-len(points) // most)
    return [*points[::step], points[-1]] if step > 1 else points
