"""Outputs that are 0 throughout the horizon, whatever a load does."""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpq

from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End
from wavesym.mechanics.probe import Probe
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.watched import Driver, ground


def silent(model: Model, drivers: Sequence[Driver], loads: LinearLoads) -> tuple[bool, ...]:
    """Whether each output is: at a free end, or where no load has come to before the end of the horizon.

    Damped modes move the whole chain at once. Without any load outputs are 0 of themselves.
    """
    begun = [(each.point, _begin(loads, j)) for j, each in enumerate(drivers)]
    acting = [(point, time) for point, time in begun if time is not None]
    return tuple(_silent(model, probe, acting) for probe in model.probes)


def _silent(model: Model, probe: Probe, acting: Sequence[tuple[int, fmpq]]) -> bool:
    network, bar = model.network, probe.rod - 1
    strained = probe.quantity in ("strain", "force")
    if strained and probe.place in (0, 1) and network.is_free(End(bar, int(probe.place))):
        return True
    places = [] if probe.point is not None else [(bar, probe.place)]
    points = [] if probe.point is None else [probe.point]
    if probe.quantity == "drift":
        places = [(bar, fmpq(0)), (bar, fmpq(1))]
    if probe.quantity == "relative":
        points.append(ground(network))
    if model.damped:
        return False
    away = network.distances(places, points)
    return bool(acting) and not any(time + away[network.joint_of[point]] < model.until for point, time in acting)


def _begin(loads: LinearLoads, j: int) -> fmpq | None:
    """When a load begins to rise; None where it never does."""
    for k, row in enumerate(loads.samples):
        if row[j] != 0:
            return loads.times[k - 1]
    return loads.times[-1] if loads.slopes[j] != 0 else None
