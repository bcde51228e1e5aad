"""Parameters of a scene with units: in which units they are given, and what of the scene they leave as it is.

kappa is a ratio of masses. Loads and velocities are given in the units of results, inertias and the numbers of a
chain's parts in SI base units. In collisions and buildings rods stay, so that kappa changes bodies; in a drive discs
have inertias of their own, so that kappa changes shafts. The time that a wave takes through a rod stays everywhere, and
so does a load: 5 N*m are 5 N*m.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import fmpq

from wavesym.mechanics.loads import Applied, AppliedRecord
from wavesym.mechanics.model import Model
from wavesym.numbers.ratio import Ratio

Function = Ratio | fmpq
"""Of the parameters."""


@dataclass(frozen=True)
class ParameterUnit:
    """`size` is what a dimensionless 1 is in the unit."""

    size: fmpq
    text: str


PLAIN = ParameterUnit(fmpq(1), "")


def unit_of(model: Model, name: str) -> ParameterUnit:
    """That of the numbers of a field other than `load`."""
    return ParameterUnit(*model.inputs[name]) if name in model.inputs else PLAIN


def unit_of_load(model: Model, load: Applied) -> ParameterUnit:
    """That of an amplitude: of a step, or of a ramp per unit of time; the factor of a record has none."""
    if model.clock is None or isinstance(load, AppliedRecord):
        return PLAIN
    size, text = model.inputs[load.source]
    unit = next(unit for point in model.network.points for unit in point.loads if unit.source == load.source)
    if not unit.is_ramp:
        return ParameterUnit(size, text)
    return ParameterUnit(size / model.clock.per_tau, f"{text}/{model.clock.unit}")
