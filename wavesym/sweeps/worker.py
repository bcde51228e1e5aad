"""What is in a worker of a Dask cluster: the plan, which it was sent once, and batches computed by it."""

from __future__ import annotations

from distributed import WorkerPlugin

from wavesym import __version__
from wavesym.errors import WavesymError
from wavesym.sweeps.batches import Batches, Place
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.values import BatchValues
from wavesym.sweeps.work import compute

_PLANS: dict[str, tuple[SweepPlan, Batches]] = {}
"""By the hash of the sweep."""


class SentPlan(WorkerPlugin):  # type: ignore[misc]
    """Takes a plan to every worker that there is, and to those that come."""

    def __init__(self, plan: SweepPlan, batches: Batches) -> None:
        self.plan, self.batches = plan, batches
        self.name = f"wavesym-{plan.sha256}"

    def setup(self, worker: object) -> None:
        _PLANS[self.plan.sha256] = self.plan, self.batches


def compute_batch(version: str, sha256: str, batch: int, places: list[Place] | None) -> BatchValues:
    """A batch of a plan that was sent, or some cases of it."""
    if version != __version__:
        raise WavesymError(f"wavesym {__version__} at a worker, {version} here; install the same")
    plan, batches = _PLANS[sha256]
    return compute(plan, batches, batch, places)
