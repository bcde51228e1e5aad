"""C with parameters at run time: what each of its functions gives, as values to be compared.

Those of `eval`, of `sample` in both directions, and of models of `error_bound` and of a batch are compared as those of
a program are. What is computed from values is compared with values: peaks with extremes, derivatives with differences
of models, a misfit with its sum.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import log2

import numpy as np

from wavesym.errors import WavesymError
from wavesym.exact.extremes import extremes
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.mode_sets.parameters import mode_parameters, names_of
from wavesym.running.compilation import CompiledLibrary, CompiledModel
from wavesym.running.mode_sets import ModalSets
from wavesym.scene import Scene
from wavesym.scene.lowering import amplitudes
from wavesym.verification.outcome import Integrals, IntegratedOutput, ProgramValues
from wavesym.verification.reference import ReferenceOutputs, even_taus, sample_evenly

_ROUNDING = 2.0**-44
"""Sums and instants are rounded by less, relative to the largest value."""
_LEAST_STEP, _MOST_STEP = 2.0**-10, 2.0**-4
"""Models differ by so much of a parameter where their difference is a derivative."""
_MOST_DERIVATIVES = 6


@dataclass(frozen=True)
class ParameterSet:
    """Numbers of all parameters in the order of the struct, the largest values `sizes` that outputs have with them, and
    what integrations have of these; `exact` is what is known, of the scene's own numbers alone.
    """

    numbers: Sequence[float]
    sizes: Sequence[float]
    integrals: Integrals
    exact: ReferenceOutputs | None = None


def model_values(
    built: CompiledLibrary, name: str, given: ParameterSet, taus: Array, until: float
) -> Iterator[ProgramValues]:
    """Values at `taus` of [0, until], samples and peaks of a model."""
    model = built.model(given.numbers)
    bounds = [model.estimate] * built.outputs
    integrals = () if given.exact else given.integrals

    def values(function: str, taus: Array, values: Array) -> ProgramValues:
        return ProgramValues(f"{name}{function}", taus, values, given.sizes, bounds, integrals=integrals)

    yield replace(
        values("", taus, model(taus.tolist())), note=f"{name}: build returns {model.status}" * (model.status != 0)
    )
    instants = even_taus(until)
    step, count = instants[1], len(instants)
    yield values(", sample", instants, model.sample(0.0, step, count))
    yield values(", sample backwards", instants, model.sample(instants[-1], -step, count)[:, ::-1])
    yield _peaks(model, f"{name}, peaks", given)


def functions_of_parameters(
    built: CompiledLibrary, name: str, own: ParameterSet, other: Sequence[float], taus: Array, until: float
) -> Iterator[ProgramValues]:
    """The model of `error_bound`, that of a batch with `other` numbers beside it, its misfit, and derivatives."""
    model, bounds = built.bounded_model(own.numbers)
    yield ProgramValues(f"{name}, error_bound", taus, model(taus.tolist()), own.sizes, bounds.tolist())
    estimate, instants = model.estimate, even_taus(until)
    off = np.array([[size or 1.0] for size in own.sizes]) * (1 + np.arange(len(instants)) % 3)
    data = built.model(own.numbers).sample(0.0, instants[1], len(instants)) + off
    (_, beside), (_, misfit) = built.batch([other, own.numbers], instants, data)
    stated = [beside.estimate] * built.outputs
    yield ProgramValues(f"{name}, batch", taus, beside(taus.tolist()), own.sizes, stated)
    found = np.full((built.outputs, 1), misfit / np.sum(off**2))
    yield _computed_values(f"{name}, misfit", found, np.ones_like(found), [4 * (estimate + _ROUNDING)] * built.outputs)
    yield _derivatives(built, f"{name}, gradients", own, estimate, instants)


def _computed_values(name: str, values: Array, due: Array, allowed: Sequence[float]) -> ProgramValues:
    """Numbers that are not values at instants, (outputs, n), relative to 1, and how far they may be from those due."""
    places = np.arange(values.shape[1], dtype=float)
    integrals = [IntegratedOutput(places.tolist(), *each) for each in zip(due, allowed, strict=True)]
    nothing = [0.0] * len(values)
    return ProgramValues(name, places, values, [1.0] * len(values), nothing, integrals=integrals)


def _peaks(model: CompiledModel, name: str, given: ParameterSet) -> ProgramValues:
    """Peaks and values where they are said to be, against true extremes; where these are not known, against all values
    that are.
    """
    peaks = model.peaks()
    values, due, allowed = [], [], []
    true = _true_extremes(given.exact)
    for k, (size, pair) in enumerate(zip(given.sizes, peaks, strict=True)):
        unit, (low, high) = size or 1.0, pair[:, 0]
        integral = given.integrals[k]
        least, greatest, off = low, high, 0.0
        if true:
            least, greatest = true[k]
        elif integral:
            least, greatest = min(low, np.min(integral.values)), max(high, np.max(integral.values))
            off = integral.error_bound / unit
        there = [_nearest_value(model, k, *each) for each in pair]
        values.append(np.array([low, high, *there]) / unit)
        due.append(np.array([least, greatest, low, high]) / unit)
        allowed.append(2 * model.estimate + _ROUNDING + off)
    return _computed_values(name, np.array(values), np.array(due), allowed)


def _true_extremes(known: ReferenceOutputs | None) -> list[tuple[float, float]] | None:
    """The least and the greatest value of each output, where they are known on the whole horizon."""
    if known is None or known.model.until != known.whole.until:
        return None
    try:
        return [(least.value, greatest.value) for least, greatest in extremes(known.model)]
    except WavesymError:
        return None


def _nearest_value(model: CompiledModel, output: int, value: float, tau: float) -> float:
    """What an output is at an instant or beside it, where it may jump: that which is nearest to a value."""
    taus = [np.nextafter(tau, 0.0), tau, np.nextafter(tau, np.inf)]
    there = model(taus)[output]
    return float(there[np.nanargmin(np.abs(there - value))]) if not np.all(np.isnan(there)) else np.nan


def _derivatives(
    built: CompiledLibrary, name: str, own: ParameterSet, estimate: float, instants: Array
) -> ProgramValues:
    """Derivatives by some parameters, against differences of models, extrapolated: relative to the largest of each."""
    count, dtau = len(instants), instants[1]
    lanes = built.tangent(own.numbers, 0.0, dtau, count)
    step = min(_MOST_STEP, max(_LEAST_STEP, 2.0 ** round(log2(max(estimate, _ROUNDING)) / 3)))
    sizes = np.array(own.sizes)[:, np.newaxis]
    values, due, allowed = [], [], np.zeros(built.outputs)
    for parameter in sample_evenly(np.arange(len(own.numbers)), _MOST_DERIVATIVES).tolist():
        by = step * (abs(own.numbers[parameter]) or 1.0)
        near, far = (_difference(built, own.numbers, parameter, k * by, dtau, count) for k in (1, 2))
        slopes = (4 * near - far) / 3
        scale = np.max(np.abs(slopes), axis=1, keepdims=True)
        scale = np.where(scale > estimate * sizes / by, scale, 1.0 + sizes / by)  # one that may be 0 is small
        values.append(lanes[1 + parameter] / scale)
        due.append(slopes / scale)
        wrong = np.max(np.abs(near - far), axis=1) / 3 + 2 * estimate * sizes[:, 0] / by
        allowed = np.maximum(allowed, wrong / scale[:, 0])
    return _computed_values(name, np.hstack(values), np.hstack(due), allowed.tolist())


def _difference(
    built: CompiledLibrary, numbers: Sequence[float], parameter: int, by: float, dtau: float, count: int
) -> Array:
    """The central difference of values by a parameter, (outputs, count)."""
    there = []
    for changed in (by, -by):
        moved = list(numbers)
        moved[parameter] += changed
        there.append(built.model(moved).sample(0.0, dtau, count))
    return np.asarray((there[0] - there[1]) / (2 * by))


# numbers of modes


def mode_set_names(model: Model) -> tuple[str, ...]:
    """All numbers that may be given of a damped model, or one without rods; none of another one: marches serve it."""
    if model.damping is None and model.network.bars:
        return ()
    try:
        return (*names_of(model), *(["load"] if model.loads else []))
    except WavesymError:
        return ()


def mode_set_values(
    scene: Scene, model: Model, names: Sequence[str], taus: Array, sizes: Sequence[float], name: str
) -> Iterator[ProgramValues]:
    """Values at `taus`, each relative to the `sizes` of outputs, with the estimate as bound.

    Raises:
        WavesymError: where modes do not serve the model, or these numbers of it.
    """
    parameters = mode_parameters(model, names, amplitudes(scene) if "load" in names else ())
    own = np.array([[nearest(value) for field in parameters.fields for value in field.values]])
    sets = ModalSets(parameters).values(own, taus)
    yield ProgramValues(f"{name}, C", taus, sets.values[0, 0], sizes, [float(sets.estimate[0])] * len(sizes))
