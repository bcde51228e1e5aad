"""Cases computed: wherever that is, and from nothing but the plan and their batch.

What a case gives depends on the sweep alone. Cases that share work do so in groups (`Batches.groups`): whoever needs
one of them computes what its group shares, so that it is the same to the last bit.
"""

from __future__ import annotations

import warnings
from threading import Lock

from wavesym.errors import WavesymError
from wavesym.sweeps.batches import Batches, Place
from wavesym.sweeps.parameters import parameters
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.shared_modes import structure_cases
from wavesym.sweeps.shared_records import record_cases
from wavesym.sweeps.single import single
from wavesym.sweeps.values import BatchValues, CaseValues

ALONE = Lock()
"""The precision of balls is one for all threads of a process: two batches at once would set it for each other."""


def compute(plan: SweepPlan, batches: Batches, batch: int, places: list[Place] | None = None) -> BatchValues:
    """The values of a batch, or of some places in it. What is wrong with a case is its reason, and the others go on."""
    values = BatchValues.empty(plan, batches.places(batch) if places is None else places)
    row = {place: k for k, place in enumerate(values.places)}
    with ALONE:
        for group in batches.groups(batch):
            if asked := [place for place in group if place in row]:
                shared = shared_cases(plan, batches, group)
                for place in asked:
                    if place in shared:
                        values.put(row[place], shared[place])
                    else:
                        _attempt(plan, place, values, row[place])
    return values


def shared_cases(plan: SweepPlan, batches: Batches, group: list[Place]) -> dict[Place, CaseValues]:
    """The cases of a group that can share work, as far as that serves them."""
    try:
        if batches.kind == "recorded":
            return dict(record_cases(plan, group))
        if batches.kind == "parameters":
            return dict(parameters(plan, group, batches.is_joined))
        if batches.kind == "structures":
            return dict(structure_cases(plan, group))
        return {}
    except (WavesymError, MemoryError):  # each by itself says what is wrong
        return {}
    except Exception as error:  # a mistake of wavesym's own, which costs time alone
        told = f"cases of this sweep are computed one by one, as together they fail: {type(error).__name__}: {error}"
        warnings.warn(told, RuntimeWarning, stacklevel=2)
        return {}


def _attempt(plan: SweepPlan, place: Place, values: BatchValues, row: int) -> None:
    """The values of one case, or the reason why it has none."""
    try:
        values.put(row, single(plan, plan.scene(place)))
    except WavesymError as error:
        values.failed[place] = str(error)
    except MemoryError:
        values.failed[place] = "out of memory"
    except Exception as error:  # a mistake of wavesym's own: the other cases are none the worse for it
        values.failed[place] = f"{type(error).__name__}: {error}"
