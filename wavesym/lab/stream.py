"""The generated stream of a scene in a loop that is C, too, so that nothing else is timed; and a scene's loads."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.doubles import nearest, rational
from wavesym.programs.modes.evaluator import ModesEvaluator
from wavesym.running.native import FAST, address, library

Values = NDArray[Any]

_STEPS = """
void steps(const REAL *samples, size_t count, REAL *out)
{
    static NAME_state state;
    NAME_init(&state);
    for (size_t k = 0; k < count; ++k) {
        NAME_step(&state, DTAU, samples + k * PREFIX_LOADS, out + k * PREFIX_OUTPUTS);
    }
}
"""


def stream(
    name: str,
    made: Mapping[str, str],
    samples: Values,
    outputs: int,
    flags: tuple[str, ...] = FAST,
    dtau: str = "PREFIX_SPACING",
) -> Callable[[], Values]:
    """A call that goes through samples (n, loads) by the C of scene `name`, in their precision: (outputs, n).

    `dtau` is the step, in C. CompilerError where there is no C compiler.
    """
    real = {np.dtype(np.float32): "float", np.dtype(np.float64): "double"}[samples.dtype]
    harness = _STEPS.replace("DTAU", dtau).replace("REAL", real).replace("NAME", name).replace("PREFIX", name.upper())
    steps = library(made[f"{name}.c"] + harness, flags, (f"{name}.h", made[f"{name}.h"])).steps
    steps.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p]
    steps.restype = None
    inputs = np.ascontiguousarray(samples)
    out = np.empty((len(inputs), outputs), dtype=samples.dtype)

    def call() -> Values:
        steps(address(inputs), len(inputs), address(out))
        return out.T

    return call


def own_samples(made: ModesEvaluator) -> tuple[Values, Values]:
    """A scene's loads as its stream takes them, sample by sample up to the horizon: tau (n,), and (n, loads)."""
    count = int((rational(made.tau_max) / made.spacing).floor())
    taus = np.minimum([nearest(k * made.spacing) for k in range(1, count + 1)], made.tau_max)
    times = np.array([nearest(time) for time in made.loads.times])
    late = np.maximum(taus - times[-1], 0.0)
    values = np.array([[nearest(value) for value in row] for row in made.loads.samples])
    columns = [
        (np.interp(taus, times, column) + nearest(slope) * late) * nearest(given.size)
        for column, slope, given in zip(values.T, made.loads.slopes, made.inputs, strict=True)
    ]
    return taus, np.column_stack(columns).astype(f"f{made.real.bytes}")
