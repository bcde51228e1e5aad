"""The change of wave speeds with which a march lasts to a horizon, where the one that a scene allows is too little.

The larger the change, the longer the common measure of travel times, the fewer the windows. What a march takes is
forecast from its plan; none is run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flint import fmpq

from wavesym.errors import CostError, SpacingError, ToleranceError, UnservedError
from wavesym.mechanics.model import Model
from wavesym.mechanics.travel_times import adjust_speeds, percent
from wavesym.numbers.doubles import common_measure, nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.hats import split, still
from wavesym.programs.march.evaluator import first_degree, refuse_long
from wavesym.programs.march.plan import MarchPlan, march_plan

_TRIED = tuple(fmpq(ratio, 100) for ratio in (1, 2, 5, 10, 20))  # as people write them, up to the largest there is


def short_steps(model: Model) -> ToleranceError:
    """The error that says that the windows of a march are too short for a horizon, and what makes them long enough.

    Args:
        model: whose speeds of waves are adjusted, so that it has `written_speeds`.
    """
    step = _step(model)
    per_tau, unit = (model.clock.per_tau, f" {model.clock.unit}") if model.clock else (fmpq(1), "")
    until, window = (f"{'' if unit else 'tau = '}{nearest(tau * per_tau):.3g}{unit}" for tau in (model.until, step))
    enough = next((ratio for ratio in _TRIED if _lasts(model, ratio, step)), None)
    remedy = f'speed_adjustment = "{percent(enough)}" under [system], or ' if enough is not None else ""
    return ToleranceError(
        f"system.speed_adjustment: it leaves travel times a common measure of {window}, too short for any program to "
        f"{until}; write {remedy}a shorter horizon, or take `wavesym frf` for the response at frequencies"
    )


def _step(model: Model) -> fmpq:
    return common_measure([bar.delay for bar in model.network.bars])


def _lasts(model: Model, ratio: fmpq, step: fmpq) -> bool:
    """Whether speeds that change by so much give longer windows, and two marches of these are served."""
    written = model.network_as_written
    try:
        other = replace(model, network=replace(written, bars=adjust_speeds(written.bars, ratio)))
        if _step(other) <= step:
            return False
        for plan in _plans(other):
            degree = first_degree(plan, DOUBLE)
            refuse_long(plan, degree + 2, refuse_long(plan, degree, 0.0, DOUBLE), DOUBLE)
    except (CostError, UnservedError, OverflowError):
        return False
    return True


def _plans(model: Model) -> Sequence[MarchPlan]:
    """Those of a march, or where loads fit into no window of one hat of each record and of the rest."""
    try:
        return [march_plan(model, DOUBLE)]
    except SpacingError:
        parts = split(model)
        if not parts.records:
            raise
        rest = [replace(model, loads=parts.rest)] if parts.rest else []
        return [march_plan(each, DOUBLE) for each in (*rest, *(still(model, record) for record in parts.records))]
