"""How the cases of a sweep are computed: which of them share work."""

from __future__ import annotations

from wavesym.sweeps import parameters, shared_modes, shared_records
from wavesym.sweeps.plan import SweepPlan


def kind(plan: SweepPlan) -> tuple[str, tuple[bool, ...]]:
    """The kind of its batches, and in which dimensions cases can be parts of one batch."""
    if shared_records.serves(plan):
        return "recorded", ()
    if joined := parameters.shared_axes(plan):
        return "parameters", joined
    if shared_modes.serves(plan):
        return "structures", (True,) * len(plan.dimensions)
    return "single", (True,) * len(plan.dimensions)
