"""How far samples of outputs may be apart, and where outputs may jump between them."""

from __future__ import annotations

from math import nextafter

import numpy as np

from wavesym.errors import CostError
from wavesym.exact.breakpoints import Breakpoints
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest, not_below, rational
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.hats import under_jumps
from wavesym.programs.modes.records import Panels
from wavesym.programs.program import Program

_PER_STEP, _PER_CROSSING = 16, 4
_MOST_JUMPS = 20_000  # stretches of all joints: where there are more, jumps lie closer than most samples


def spacing(model: Model) -> float:
    """How far samples are to be apart: 16 in a step of samples and 4 in the crossing of a rod; else 16 in that."""
    crossing = nearest(model.network.shortest)
    if model.spacing is None:
        return crossing / _PER_STEP
    return min(nearest(model.spacing) / _PER_STEP, crossing / _PER_CROSSING)


def describe_step(model: Model, step: float) -> str:
    """How far samples are apart, in a few words."""
    clock = model.clock
    return f"{clock.time(rational(step)):.4g} {clock.unit} apart" if clock else f"{step:g} tau apart"


def sample_program(model: Model, program: Program, step: float) -> tuple[Array, Array]:
    """Instants no more than `step` apart, in order, with both sides of jumps, and the values of a program there."""
    if program.has_equal_steps and program.real is DOUBLE:
        return Panels.from_program(program).sample(step)
    fronts = jumps(under_jumps(program, model))
    taus = np.unique([*program.instants(step), *fronts, *map(just_before, fronts)])
    return taus, program.evaluate(taus)


def jumps(model: Model) -> list[float]:
    """Where in (0, until] an output may jump, as doubles at or above, in order; none where there are too many."""
    breakpoints = Breakpoints(model, rational(model.horizon()))
    try:
        if breakpoints.stretches > _MOST_JUMPS:
            return []
        exact = {time for probe in model.probes for time in breakpoints.of_output(model.sums[probe])}
    except CostError:
        return []
    return sorted({not_below(time) for time in exact if time > 0})


def just_before(tau: float) -> float:
    """The last double before it."""
    return nextafter(tau, 0.0)
