"""TOML -> Scene: what the user said, validated, every number exact."""

from wavesym.errors import SceneError
from wavesym.scene.loads import Acceleration, Moment, Piece, Record
from wavesym.scene.outputs import Observable, Output
from wavesym.scene.reading import builtin_names, builtin_text, first_text, read_text
from wavesym.scene.scene import Scene
from wavesym.scene.systems import Building, Collision, Drive

__all__ = [
    "Acceleration",
    "Building",
    "Collision",
    "Drive",
    "Moment",
    "Observable",
    "Output",
    "Piece",
    "Record",
    "Scene",
    "SceneError",
    "builtin_names",
    "builtin_text",
    "first_text",
    "read_text",
]
