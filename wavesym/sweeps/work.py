"""A batch computed: wherever it is, and from nothing but the plan and its number."""

from __future__ import annotations

from threading import Lock

from wavesym.errors import WavesymError
from wavesym.sweeps.batches import Batches
from wavesym.sweeps.parameters import parameters
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.recorded import recorded
from wavesym.sweeps.single import single
from wavesym.sweeps.values import BatchValues, CaseValues

_ALONE = Lock()
"""The precision of balls is one for all threads of a process: two batches at once would set it for each other."""


def compute(plan: SweepPlan, batches: Batches, batch: int) -> BatchValues:
    """The values of a batch. What is wrong with a case is its reason, and the others go on."""
    values = BatchValues.empty(plan, batches.region(batch))
    region, left = batches.region(batch), batches.places(batch)
    with _ALONE:
        for place, case in _shared(plan, batches, left):
            values.put(region, place, case)
            left.remove(place)
        for place in left:
            _attempt(plan, batches, batch, place, values)
    return values


def _shared(
    plan: SweepPlan, batches: Batches, places: list[tuple[int, ...]]
) -> list[tuple[tuple[int, ...], CaseValues]]:
    """The cases that can share work, as far as that serves them."""
    try:
        if batches.kind == "recorded":
            return list(recorded(plan, places))
        if batches.kind == "parameters":
            return list(parameters(plan, places, batches.together))
        return []
    except Exception:  # each by itself says what is wrong
        return []


def compute_case(plan: SweepPlan, batches: Batches, batch: int, place: tuple[int, ...]) -> BatchValues:
    """One case of a batch, by itself."""
    values = BatchValues.empty(plan, batches.region(batch))
    with _ALONE:
        _attempt(plan, batches, batch, place, values)
    return values


def _attempt(plan: SweepPlan, batches: Batches, batch: int, place: tuple[int, ...], values: BatchValues) -> None:
    """The values of one case, or the reason why it has none."""
    try:
        values.put(batches.region(batch), place, single(plan, plan.scene(place)))
    except WavesymError as error:
        values.failed[place] = str(error)
    except MemoryError:
        values.failed[place] = "out of memory"
    except Exception as error:  # a mistake of wavesym's own: the other cases are none the worse for it
        values.failed[place] = f"{type(error).__name__}: {error}"
