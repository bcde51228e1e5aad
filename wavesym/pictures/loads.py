"""What acts on a chain, over tau: each load as it is, straight or a polynomial between its changes, upright where it
steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from flint import fmpq, fmpq_poly

from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Point
from wavesym.mechanics.node import UnitLoad
from wavesym.mechanics.probe import Probe
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.pictures.histories import History

Acting = Sequence[tuple[AppliedLoad, int]]
"""Loads on one node, each with the power of tau that it grows with: 0 for a step, 1 for a ramp."""
_CURVED = 16  # straight parts of a polynomial


def load_histories(model: Model) -> tuple[History, ...]:
    """The loads of a model, one for each node that is loaded, in the units that its scene has for them.

    None for a chain that its own start moves.
    """
    found = []
    for point in model.network.points:
        powers = {unit.source: _power(unit, point) for unit in point.loads}
        if acting := [(load, powers[load.source]) for load in model.loads if load.source in powers]:
            factor, unit = model.inputs.get(acting[0][0].source, (fmpq(1), ""))
            probe = Probe(_load_name(model, point), "load", 1, fmpq(0), factor=factor, unit=unit)
            in_units = [(replace(load, weight=factor * load.weight), power) for load, power in acting]
            found.append(History(probe, tuple(stretches(in_units, model.until))))
    return tuple(found)


def stretches(acting: Acting, until: fmpq) -> Iterator[Array]:
    """The sum of loads as polylines (n, 2) of tau and value; between them it jumps."""
    times = sorted({fmpq(0), until, *(load.time for load, _ in acting if load.time < until)})
    changes = {time: fmpq_poly() for time in times}
    for load, power in acting:
        if load.time < until:
            changes[load.time] += fmpq_poly([fmpq(0)] * power + [load.weight])
    value = fmpq_poly()
    vertices: list[tuple[float, float]] = []
    for time, after in zip(times, [*times[1:], until], strict=True):
        if changes[time][0] and vertices:
            vertices.append((nearest(time), nearest(value[0])))
            yield np.array(vertices)
            vertices = []
        value += changes[time]
        parts, length = _CURVED if value.degree() > 1 else 1, after - time
        vertices += [
            (nearest(time + since), nearest(value(since))) for since in (length * k / parts for k in range(parts))
        ]
        value = value(fmpq_poly([length, 1]))
    yield np.array(vertices)


def _power(unit: UnitLoad, point: Point) -> int:
    """How many powers of tau more than a step a unit load at a point has."""
    return len(unit.coefficients) - min(len(other.coefficients) for other in point.loads)


def _load_name(model: Model, point: Point) -> str:
    """What its scene calls what acts on a point, else what kind of quantity that is."""
    titles = dict.fromkeys(title for unit in point.loads if (title := model.labels.titles.get(unit.source)))
    return " + ".join(titles) or _usual_name(model, point)


def _usual_name(model: Model, point: Point) -> str:
    if model.labels.system["type"] == "building":
        return "acceleration of the base"
    if any(unit.number is not None for unit in point.loads):
        return " + ".join(sorted({unit.source.partition(":")[0] for unit in point.loads}))
    force = "moment" if model.labels.kind == "torsional" else "force"
    return f"{point.motion or force} {'of' if point.motion else 'at'} {point.name or f'x = {point.place}'}"
