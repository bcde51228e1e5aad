"""How far samples of outputs may be apart, and where outputs may jump between them."""

from __future__ import annotations

from itertools import pairwise
from math import nextafter

from flint import fmpq

from wavesym.errors import CostError
from wavesym.exact.knots import Knots
from wavesym.model.model import Model
from wavesym.numbers.doubles import not_below, rational

_MOST_JUMPS = 20_000  # stretches of all joints: where there are more, jumps lie closer than most samples


def step_of(model: Model) -> fmpq:
    """The time in which the shortest rod is crossed, or, where that is shorter, the usual one between two loads."""
    times = sorted({load.time for load in model.loads})
    gaps = sorted(after - before for before, after in pairwise(times))
    return min([bar.delay for bar in model.network.bars] + gaps[len(gaps) // 2 : len(gaps) // 2 + 1])


def jumps(model: Model) -> list[float]:
    """Where in (0, until] an output may jump, as doubles at or above, in order; none where there are too many."""
    knots = Knots(model, rational(model.horizon()))
    try:
        if knots.stretches > _MOST_JUMPS:
            return []
        exact = {time for probe in model.probes for time in knots.breakpoints(probe)}
    except CostError:
        return []
    return sorted({not_below(time) for time in exact if time > 0})


def just_before(tau: float) -> float:
    """The last double before it."""
    return nextafter(tau, 0.0)
