"""Accelerations where nothing has mass, as velocities: what a chain at rest does under the derivatives of its loads.

The equations are linear and do not change in time: under f', where f begins at 0 and does not jump, all that f makes
is differentiated. So a network stands beside a copy of itself, the loads of which are the derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.loads import AppliedLoad, merge_loads
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network, Point
from wavesym.mechanics.node import UnitLoad
from wavesym.mechanics.probe import Probe

_COPY = "d/dtau "  # before the kinds of the copy's loads


def with_derivatives(model: Model) -> Model:
    """A model whose outputs are sums of strains, velocities, displacements and loads alone, with the same values.

    Args:
        model: any; it is returned as it is where it has no other outputs.

    Raises:
        UnservedError: where what acts on the chain jumps, or it moves or is strained at tau = 0.
    """
    derived = [probe for probe in model.probes if any(reading.order > 0 for _, reading in model.sums[probe])]
    if not derived:
        return model
    network, why = model.network, f"output.acceleration: {derived[0].name}: no place without mass is supported where"
    if any(bar.velocity or bar.strain for bar in network.bars) or any(point.velocity for point in network.points):
        raise UnservedError(f"{why} a chain moves or is strained at first (write one with mass)")
    loads = [*model.loads]
    for load in model.loads:
        if (found := _derivative(load, network.points)) is None:
            raise UnservedError(f"{why} a load jumps: {model.describe_step(load)} (write a steep ramp, or mass there)")
        loads.append(found)
    probes = tuple(_as_velocity(probe, network) if probe in derived else probe for probe in model.probes)
    return replace(model, network=_add_copy(network), loads=merge_loads(loads), probes=probes)


def _derivative(load: AppliedLoad, points: Sequence[Point]) -> AppliedLoad | None:
    """A load of the copy; None where the force, or the velocity that is prescribed, jumps."""
    point, unit = next((p, u) for p in points for u in p.loads if u.source == load.source)
    first, *rest = point.action(unit)
    slope = [power * coefficient for power, coefficient in enumerate(rest, 1)]
    if first != 0:
        return None
    for other in point.loads:
        action = [*point.action(other)]
        pairs = list(zip_longest(action, slope, fillvalue=0))
        factor = next((fmpq(b) / fmpq(a) for a, b in pairs if a != 0), None)
        if factor is not None and all(b == factor * a for a, b in pairs):
            return AppliedLoad(_copy_load(other).source, load.time, factor * load.weight)
    return None


def _copy_load(unit: UnitLoad) -> UnitLoad:
    return replace(unit, kind=_COPY + unit.kind)


def _add_copy(network: Network) -> Network:
    """A network and its copy, behind it."""
    count = len(network.points)
    points = [replace(point, name="", loads=tuple(map(_copy_load, point.loads))) for point in network.points]
    bars = [replace(bar, left=bar.left + count, right=bar.right + count, name="") for bar in network.bars]
    links = [replace(link, left=link.left + count, right=link.right + count) for link in network.links]
    return Network((*network.points, *points), (*network.bars, *bars), (*network.links, *links))


def _as_velocity(probe: Probe, network: Network) -> Probe:
    """An acceleration as a velocity of the copy."""
    point = None if probe.point is None else probe.point + len(network.points)
    return replace(probe, quantity="velocity", rod=probe.rod and probe.rod + len(network.bars), point=point)
