"""What errors are measured from: values right to the last bit, or the modes that prove most."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesym.errors import CostError, ToleranceError
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import midpoint, rational
from wavesym.programs.making import make
from wavesym.programs.program import Program
from wavesym.programs.request import Request

_TIGHTEST = tuple(Fraction(1, 10**digits) for digits in range(12, 0, -1))


@dataclass(frozen=True)
class Standard:
    """`values` of all outputs (outputs, n) at ascending tau, the least their largest values are, and their arrivals.

    No value is wrong by more than `bound` times its output's largest; that is 0 where each is rounded once.
    """

    until: float
    sizes: NDArray[np.float64]
    arrivals: NDArray[np.float64]
    bound: float
    values: Callable[[Sequence[float]], ArrayLike]

    def errors(self, found: NDArray[Any], right: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far outputs (outputs, n) are from the right ones, relative to the largest value of each."""
        return np.asarray(np.abs(found.astype(np.float64) - right) / self.sizes[:, np.newaxis])


def standard(model: Model) -> Standard:
    """The tables in balls; modes where waves do not serve a model, or would cost too much under a record.

    CostError where there is neither, ToleranceError where modes leave all digits open.
    """
    if model.damping is None:
        try:
            return _exact(Reference(model))
        except CostError:
            if model.spacing is None:
                raise
    return _modal(_tightest(model))


def _exact(reference: Reference) -> Standard:
    # an output that is 0 throughout has no relative errors
    sizes = np.array([midpoint(size) or 1.0 for size in reference.largest()])
    return Standard(reference.tau_max, sizes, np.array(reference.breakpoints()), 0.0, reference.values)


def _modal(program: Program) -> Standard:
    """Nothing jumps, so that there are no arrivals."""
    sizes = np.array([output.largest or 1.0 for output in program.outputs])
    return Standard(program.tau_max, sizes, np.empty(0), program.error_bound, program.evaluate)


def _tightest(model: Model) -> Program:
    for tolerance in _TIGHTEST:
        try:
            return make(model.tolerating(rational(tolerance)), Request(evaluator="modes"))
        except ToleranceError as error:
            refused = error
    raise refused
