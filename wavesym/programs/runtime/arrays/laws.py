"""What parameters make of a chain, at many sets of them, and the derivatives of that."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod

import numpy as np
from flint import fmpq, fmpq_mpoly
from numpy.typing import NDArray

from wavesym.numbers.doubles import nearest
from wavesym.numbers.ratio import Ratio
from wavesym.programs.runtime.engine import Array
from wavesym.programs.runtime.laws import RuntimeLaws
from wavesym.programs.runtime.products import products
from wavesym.programs.runtime.units import Function

ArrayLaws = Mapping[str, Array]
"""The functions of `RuntimeLaws` by name, each array of shape (functions, sets), and "load", the amplitudes of loads;
or their derivatives, of shape (lanes, functions, sets).
"""


def finite(laws: ArrayLaws) -> NDArray[np.bool_]:
    """Of each set, whether all are numbers."""
    every = [np.isfinite(values).reshape(-1, values.shape[-1]).all(axis=0) for values in laws.values()]
    found: NDArray[np.bool_] = np.logical_and.reduce(every)
    return found


def allowed(laws: RuntimeLaws, given: Array, functions: Sequence[Ratio]) -> NDArray[np.bool_]:
    """Which sets, the rows of `given`, have finite numbers, positive ones where they have to be; and so have what
    `functions` are made of.
    """
    positive = np.array([field.positive for field in laws.fields for _ in field.labels], bool)
    fine = np.isfinite(given)
    fine[:, positive] &= given[:, positive] > 0
    every: NDArray[np.bool_] = np.all(fine, axis=1)
    symbols, least = _symbols(laws, given), np.finfo(np.float64).tiny
    for function in functions:
        for product in products(function, laws.positive):
            size = np.abs(prod((_sum(factor, _own(function, symbols)) for factor in product), start=np.float64(1)))
            every &= (size >= least) & np.isfinite(size)
    return every


def array_laws(laws: RuntimeLaws, given: Array) -> ArrayLaws:
    """Of all sets, the rows of `given`."""
    symbols, sets = _symbols(laws, given), len(given)
    arrays = {name: _evaluated(functions, symbols, sets) for name, functions in laws.functions.items()}
    own = np.broadcast_to(np.array(laws.amplitudes)[:, None], (len(laws.amplitudes), sets))
    lanes = _load_lanes(laws)
    return {**arrays, "load": given.T[lanes] if len(lanes) else own}


def array_slopes(laws: RuntimeLaws, given: Array) -> ArrayLaws:
    """Their derivatives by all parameters, in the order of these."""
    symbols, sets = _symbols(laws, given), len(given)
    labels = list(symbols)
    arrays = {
        name: np.array([_evaluated([_slope(f, label) for f in functions], symbols, sets) for label in labels])
        for name, functions in laws.functions.items()
    }
    lanes = _load_lanes(laws)
    load = np.zeros((len(labels), len(lanes) or len(laws.amplitudes), sets))
    load[lanes, np.arange(len(lanes))] = 1
    return {**arrays, "load": load}


def _symbols(laws: RuntimeLaws, given: Array) -> dict[str, Array]:
    labels = [label for field in laws.fields for label in field.labels]
    return dict(zip(labels, given.T, strict=True))


def _load_lanes(laws: RuntimeLaws) -> NDArray[np.int64]:
    names = [field.name for field in laws.fields for _ in field.labels]
    return np.flatnonzero(np.array(names) == "load")


def _evaluated(functions: Sequence[Function], symbols: Mapping[str, Array], sets: int) -> Array:
    found = np.empty((len(functions), sets))
    for row, function in zip(found, functions, strict=True):
        row[:] = _value(function, symbols)
    return found


def _slope(function: Function, label: str) -> Function:
    if isinstance(function, Ratio) and label in function.ring.names:
        return function.derivative(label)
    return fmpq(0)


def _value(function: Function, symbols: Mapping[str, Array]) -> Array | float:
    if not isinstance(function, Ratio):
        return nearest(function)
    ring = function.ring
    own = _own(function, symbols)
    below = [_sum(ring.forms[form], own) for form, power in function.denominator.items() for _ in range(power)]
    return _sum(function.numerator, own) / prod(below, start=np.float64(1))


def _own(function: Ratio, symbols: Mapping[str, Array]) -> list[Array]:
    return [symbols[name] for name in function.ring.names]


def _sum(polynomial: fmpq_mpoly, own: Sequence[Array]) -> Array | np.float64:
    found: Array | np.float64 = np.float64(0)
    for powers, value in polynomial.to_dict().items():
        factors = (number ** int(power) for number, power in zip(own, powers, strict=True) if power)
        found = found + prod(factors, start=np.float64(nearest(fmpq(value))))
    return found
