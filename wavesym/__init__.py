"""Longitudinal and torsional waves in chains of rods and rigid bodies, from a scene to C that can be linked.

From Python:

    import wavesym
    scene = wavesym.Scene.from_toml("building_m2.toml")   # or wavesym.Scene(...), the same fields
    response = wavesym.evaluator(scene)                   # callable: tau array -> (outputs, *tau.shape)
    rows = wavesym.tables(scene)                          # the table's rows, exact fractions
    wavesym.generate(scene, "out", language="all")        # paths written
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wavesym.compiler import evaluator, generate, tables
    from wavesym.errors import CostError, SceneError, ToleranceError, WavesymError
    from wavesym.scene import Scene

__all__ = [
    "CostError",
    "Scene",
    "SceneError",
    "ToleranceError",
    "WavesymError",
    "__version__",
    "evaluator",
    "generate",
    "tables",
]
__version__ = "0.1.0"

# Loaded when first asked for, so that `import wavesym` and `wavesym --help` wait for nobody's SymPy.
_HOMES = {
    "Scene": "wavesym.scene",
    "CostError": "wavesym.errors",
    "SceneError": "wavesym.errors",
    "ToleranceError": "wavesym.errors",
    "WavesymError": "wavesym.errors",
    "evaluator": "wavesym.compiler",
    "generate": "wavesym.compiler",
    "tables": "wavesym.compiler",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'wavesym' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
