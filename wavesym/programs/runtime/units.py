"""Parameters of a scene with units: in which units they are given, and what of the scene they leave as it is.

kappa is a ratio of masses. Loads and velocities are given in the units of results, inertias and the numbers of a
chain's parts in SI base units. In collisions and buildings rods stay, so that kappa changes bodies; in a drive discs
have inertias of their own, so that kappa changes shafts. The time that a wave takes through a rod stays everywhere, and
so does a load: 5 N*m are 5 N*m.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import fmpq

from wavesym.mechanics.chain import Chain
from wavesym.mechanics.loads import Applied, AppliedRecord
from wavesym.mechanics.model import Model
from wavesym.mechanics.node import RAMPS
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
    if model.clock is None or name == "kappa":
        return PLAIN
    if name == "inertia":  # as a physical drive is rewritten
        return ParameterUnit(fmpq(1), "kg*m^2")
    return ParameterUnit(*model.inputs[name])


def unit_of_load(model: Model, load: Applied) -> ParameterUnit:
    """That of an amplitude: of a step, or of a ramp per unit of time; the factor of a record has none."""
    if model.clock is None or isinstance(load, AppliedRecord):
        return PLAIN
    size, text = model.inputs[load.source]
    ramp = load.source.endswith(":ramp") if model.chain is None else load.source[0] in RAMPS
    if not ramp:
        return ParameterUnit(size, text)
    return ParameterUnit(size / model.clock.per_tau, f"{text}/{model.clock.unit}")


def load_kept(model: Model, free: Chain) -> Function:
    """What a load is multiplied by where parameters change the moment that a dimensionless 1 is."""
    if model.clock is None or free.parameters.inertia is None:
        return fmpq(1)
    own, now = model.named.parameters, free.parameters
    kept: Function = own.kappa[1] * own.inertia[1] / (now.kappa[1] * now.inertia[1])
    return kept


def force_kept(model: Model, free: Chain) -> Function:
    """The same of a force that is read."""
    if model.clock is None or free.parameters.inertia is None:
        return fmpq(1)
    kept: Function = free.parameters.inertia[1] / model.named.parameters.inertia[1]
    return kept
