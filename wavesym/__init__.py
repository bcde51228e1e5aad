"""Longitudinal and torsional waves in chains of rods and rigid bodies, from a scene to C that can be linked.

    Scene       what is modelled, which loads act, which outputs are wanted, for how long and how exactly
    run         the histories of its outputs, as a Result: by name, as a table, as a picture; also `scene.run()`
    summary     the least and the greatest value of each output, and when; `peaks` of several scenes as arrays
    spectrum    response spectra of its accelerations
    modes       its frequencies, none missed, with damping, effective masses and shapes
    frf         its frequency responses: complex amplitudes under a harmonic load, and their enclosed peaks
    plot        its histories, place x time, envelopes, as pictures; `report` as one page
    evaluator   the outputs of a scene as a function of tau, right to the last bit
    model       its outputs for many sets of parameters: values, gradients, extremes
    sweep       many scenes that differ in a few fields or records, into a folder of labelled arrays
    generate    its C and NumPy programs, written to files
    verify      these programs, compared with direct integration
    tables      the exact coefficients of its wave functions; `derive` has the equations that give them
    formula     one of its outputs in closed form: as text, LaTeX, SymPy or C

A request that cannot be carried out raises a WavesymError: SceneError, ToleranceError, CostError, UnservedError,
CompilerError or RangeError.

    >>> import wavesym
    >>> scene = wavesym.Scene.from_toml("building_m2")  # built in; or a path, or wavesym.Scene(...)
    >>> scene
    Scene('building_m2', building, 2 storeys, load of 3 changes, until tau = 12)
    >>> result = scene.run()
    >>> result["velocity@1.5"].shape
    (1001,)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wavesym.api import (
        derive,
        evaluator,
        formula,
        frf,
        generate,
        model,
        modes,
        peaks,
        plot,
        report,
        run,
        spectrum,
        summary,
        sweep,
        tables,
        verify,
    )
    from wavesym.errors import CostError, RangeError, SceneError, ToleranceError, UnservedError, WavesymError
    from wavesym.interactive import Scene
    from wavesym.results.result import Result
    from wavesym.running.toolchain import CompilerError

__all__ = [
    "CompilerError",
    "CostError",
    "RangeError",
    "Result",
    "Scene",
    "SceneError",
    "ToleranceError",
    "UnservedError",
    "WavesymError",
    "__version__",
    "derive",
    "evaluator",
    "formula",
    "frf",
    "generate",
    "model",
    "modes",
    "peaks",
    "plot",
    "report",
    "run",
    "spectrum",
    "summary",
    "sweep",
    "tables",
    "verify",
]

# Loaded when first asked for, so that `import wavesym` and `wavesym --help` wait for nobody's SymPy.
_HOMES = {
    **dict.fromkeys(__all__, "wavesym.api"),
    "Scene": "wavesym.interactive",
    "Result": "wavesym.results.result",
    "CompilerError": "wavesym.running.toolchain",
    **dict.fromkeys(
        ("CostError", "RangeError", "SceneError", "ToleranceError", "UnservedError", "WavesymError"), "wavesym.errors"
    ),
}
__version__ = "0.3.0"


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'wavesym' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
