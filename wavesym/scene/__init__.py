"""TOML -> Scene -> Model: what the user said, validated, every number exact; then what is to be computed."""

from wavesym.errors import SceneError
from wavesym.scene.lowering import lower
from wavesym.scene.outputs import Observable, Output
from wavesym.scene.scene import Scene
from wavesym.scene.scene_file import builtin_names, builtin_text

__all__ = [
    "Observable",
    "Output",
    "Scene",
    "SceneError",
    "builtin_names",
    "builtin_text",
    "lower",
]
