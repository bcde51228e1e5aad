"""Longitudinal and torsional waves in chains of rods and rigid bodies, from a scene to C that can be linked.

    Scene       what is modelled, which loads act, which outputs are wanted, for how long and how exactly
    evaluator   the outputs of a scene as a function of tau, right to the last bit
    summary     the least and the greatest value of each output, and when; `peaks` of several scenes as arrays
    sweep       many scenes that differ in a few fields or records, into a folder of labelled arrays
    tables      the exact coefficients of its wave functions
    model       its outputs for many sets of parameters: values, gradients, extremes
    generate    its C and NumPy programs, written to files

A request that cannot be carried out raises a WavesymError: SceneError, ToleranceError, CostError, UnservedError or
RangeError.

    >>> import wavesym
    >>> scene = wavesym.Scene.from_toml("building_m2")  # built in; or a path, or wavesym.Scene(...)
    >>> response = wavesym.evaluator(scene)
    >>> response([0.5, 20.0]).shape  # outputs, then the shape of tau
    (6, 2)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wavesym.compiler import evaluator, generate, model, peaks, summary, sweep, tables
    from wavesym.errors import CostError, RangeError, SceneError, ToleranceError, UnservedError, WavesymError
    from wavesym.scene import Scene

__all__ = [
    "CostError",
    "RangeError",
    "Scene",
    "SceneError",
    "ToleranceError",
    "UnservedError",
    "WavesymError",
    "__version__",
    "evaluator",
    "generate",
    "model",
    "peaks",
    "summary",
    "sweep",
    "tables",
]
__version__ = "0.1.0"

# Loaded when first asked for, so that `import wavesym` and `wavesym --help` wait for nobody's SymPy.
_HOMES = {
    "Scene": "wavesym.scene",
    "CostError": "wavesym.errors",
    "RangeError": "wavesym.errors",
    "SceneError": "wavesym.errors",
    "ToleranceError": "wavesym.errors",
    "UnservedError": "wavesym.errors",
    "WavesymError": "wavesym.errors",
    "evaluator": "wavesym.compiler",
    "generate": "wavesym.compiler",
    "model": "wavesym.compiler",
    "peaks": "wavesym.compiler",
    "summary": "wavesym.compiler",
    "sweep": "wavesym.compiler",
    "tables": "wavesym.compiler",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'wavesym' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
