"""What a user asks of outputs first: the least and the greatest value of each, when, and when it begins to move."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.errors import CostError
from wavesym.exact.arrival import first_arrivals
from wavesym.exact.extremes import Extreme, Range, extremes
from wavesym.model.model import Model
from wavesym.numbers.doubles import nearest, not_below, rational
from wavesym.programs.making import make
from wavesym.results.response import Response
from wavesym.results.sampled import PER_STEP, sampled_extremes
from wavesym.results.stepping import jumps, just_before, step_of

Numbers = NDArray[np.float64]

# two roundings to double, and what exact/extremes.py takes for equal
_EXACT = 1.2e-16
_MOST_SAMPLES = 8_000_000


class Instant(NamedTuple):
    """`tau`, and the `time` in the scene's unit; None where it has none."""

    tau: float
    time: float | None


@dataclass(frozen=True)
class Peak:
    """A `value` in the output's unit, and the first instant `at` which it is taken.

    Where it is not `reached` the output comes up to it and jumps at that instant.
    """

    value: float
    at: Instant
    reached: bool = True


@dataclass(frozen=True)
class OutputSummary:
    """An output, its least and its greatest value, and when it first differs from 0 (None: not on the horizon)."""

    name: str
    unit: str
    min: Peak
    max: Peak
    arrival: Instant | None

    @property
    def largest(self) -> Peak:
        """The one of `min` and `max` with the larger absolute value, and of equal ones the first."""
        return min(self.min, self.max, key=lambda peak: (-abs(peak.value), peak.at.tau))


@dataclass(frozen=True)
class Summary:
    """The extremes of a scene's outputs; `wavesym.summary` makes it.

    `bound` is that of the error of values, relative to each output's largest. Where it is `proved` that no value lies
    beyond an extreme it holds for the extremes, else only for what outputs are at these instants. `how` says how they
    were found. `time_unit` is None for a scene without units.
    """

    name: str
    outputs: tuple[OutputSummary, ...]
    bound: float
    proved: bool
    how: str
    time_unit: str | None

    @property
    def certain(self) -> str:
        """What is known of the values, in a few words."""
        if self.proved:
            return f"right to {self.bound:g} of each output's largest, proved"
        return f"an estimate (values are right to {self.bound:g} of each output's largest; higher tops may be missed)"


def summarised(model: Model, samples: Sequence[float] | None = None) -> Summary:
    """The extremes of a model's outputs: true ones, or of the values at the tau of `samples`.

    True ones are proved where `run` gives values right to the last bit; else they are those of the program that `auto`
    takes, found by samples. ToleranceError, CostError where there is no such program either.
    """
    if samples is not None:
        ranges, bound, how = _at(model, np.asarray(samples))
        proved = True
    else:
        try:
            ranges, bound, proved, how = extremes(model), _EXACT, True, "all values looked at, by balls"
        except CostError:
            ranges, bound, how = _searched(model)
            proved = False
    return Summary(
        model.name,
        tuple(
            OutputSummary(
                probe.name,
                probe.unit,
                _peak(model, found[0]),
                _peak(model, found[1]),
                None if first is None else instant(model, not_below(first), first),
            )
            for probe, found, first in zip(model.probes, ranges, first_arrivals(model), strict=True)
        ),
        bound,
        proved,
        how,
        model.clock.unit if model.clock else None,
    )


def _peak(model: Model, found: Extreme) -> Peak:
    return Peak(found.value, instant(model, found.tau), found.reached)


def instant(model: Model, tau: float, exact: fmpq | None = None) -> Instant:
    """A tau, and the scene's time then."""
    if model.clock is None:
        return Instant(tau, None)
    return Instant(tau, nearest((rational(tau) if exact is None else exact) * model.clock.per_tau))


def _at(model: Model, taus: Numbers) -> tuple[list[Range], float, str]:
    """The extremes of values at these tau."""
    try:
        response = Response(model)
        found = sampled_extremes(response, taus, refined=False)
        return _ranges(*found), response.error_bound, f"the values at {taus.size} samples"
    except CostError:
        program = make(model)
        found = sampled_extremes(program.evaluate, taus, refined=False)
        return _ranges(*found), program.error_bound, f"the values of {program.evaluator} at {taus.size} samples"


def _searched(model: Model) -> tuple[list[Range], float, str]:
    """The extremes of the program that `auto` takes, looked for between many samples."""
    program = make(model)
    step = step_of(model)
    count = int((model.until / step).ceil()) * PER_STEP
    if count * len(model.probes) > _MOST_SAMPLES:
        raise CostError(
            f"output.until: extremes of {len(model.probes)} outputs would be looked for at {count:.1e} samples each, "
            f"at most {_MOST_SAMPLES // len(model.probes):.1e} expected (a shorter horizon or fewer outputs help)"
        )
    fronts = jumps(model)
    taus = np.unique([*np.linspace(0.0, program.tau_max, count + 1), *fronts, *map(just_before, fronts)])
    found = sampled_extremes(program.evaluate, taus)
    how = f"{program.evaluator} at {taus.size} samples, {PER_STEP} in each {nearest(step):g} tau, then refined"
    return _ranges(*found), program.error_bound, how


def _ranges(values: Numbers, taus: Numbers) -> list[Range]:
    """As of pieces; all of these are values that are taken."""
    least, greatest = (
        [Extreme(*each) for each in zip(values[:, side].tolist(), taus[:, side].tolist(), strict=True)]
        for side in (0, 1)
    )
    return list(zip(least, greatest, strict=True))
