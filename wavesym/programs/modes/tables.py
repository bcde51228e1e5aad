"""The numbers of modes as flat tables by name: for NumPy, which steps any panels, and for a stream of equal steps."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from wavesym.numbers.reals import Real
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.modal import ModalSystem, Numbers
from wavesym.programs.modes.step import Stepper

LANES = 8
"""Modes and outputs of a stream come in groups of so many, the last one filled up with zeros."""

Tables = dict[str, tuple[float, ...]]


def scheme_tables(system: ModalSystem, loads: LinearLoads, real: Real) -> Tables:
    """What schemes/modes.py reads."""
    lengths, kind = loads.distinct
    return {
        "frequency": _as(real, system.frequency),
        "damping": _as(real, system.damping),
        "push": _as(real, system.pushes),
        "moved": _as(real, system.moved),
        "moving": _as(real, system.moving),
        "direct": _as(real, system.direct),
        "time": real.table(loads.times),
        "length": real.table(lengths),
        "kind": kind,
        "sample": tuple(real.nearest(value) for row in loads.samples for value in row),
        "slope": real.table(loads.slopes),
    }


def stream_tables(stepper: Stepper, real: Real) -> Tables:
    """What templates/c/modes/modes.c reads.

    Of each mode the matrix of a step; of each load for each mode what it does where the step begins and ends. The
    outputs that displacements count in are moved_row[0 ...], with `moved_weight`: LANES of them, mode by mode, then the
    next; so those that velocities count in. What loads and their integrals count is `load_weight`.
    """
    system = stepper.system
    modes, filled = len(system.frequency), padded(len(system.frequency))
    made: Tables = {}
    for name, values in stepper.tables().items():
        rows = [values[first : first + modes] for first in range(0, len(values), modes)]
        made[name] = tuple(x for row in rows for x in [*map(real.nearest, row), *[0.0] * (filled - modes)])
    for name, weights in (("moved", system.moved), ("moving", system.moving)):
        used = np.flatnonzero(weights.any(axis=1))
        lanes = np.zeros((padded(len(used)), filled))
        lanes[: len(used), :modes] = weights[used]
        made[f"{name}_row"] = tuple(used.tolist())
        made[f"{name}_weight"] = _as(real, lanes.reshape(-1, LANES, filled).transpose(0, 2, 1))
    return made | {"load_weight": _as(real, system.direct)}


def padded(count: int) -> int:
    """The next multiple of LANES."""
    return -(-count // LANES) * LANES


def _as(real: Real, values: Numbers) -> tuple[float, ...]:
    rounded: Iterable[float] = values.astype(f"f{real.bytes}").astype(np.float64).ravel().tolist()
    return tuple(rounded)
