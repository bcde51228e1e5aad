"""The systems of the paper, each in one file: its table in a scene, its loads, and its nodes for any m."""

from __future__ import annotations

from wavesym.systems.building import Building
from wavesym.systems.collision import Collision
from wavesym.systems.drive import Drive
from wavesym.systems.explicit import ExplicitChain
from wavesym.systems.preset import Preset
from wavesym.systems.written_out import WrittenOut

__all__ = [
    "SYSTEMS",
    "Building",
    "Collision",
    "Drive",
    "ExplicitChain",
    "Preset",
    "SystemTable",
    "WrittenOut",
    "presets",
]

SystemTable = Preset | ExplicitChain
SYSTEMS: dict[str, type[SystemTable]] = {
    "collision": Collision,
    "drive": Drive,
    "building": Building,
    "chain": ExplicitChain,
}
"""By the `type` that a scene says; one more system is one more entry."""


def presets() -> dict[str, type[Preset]]:
    """Those of them that are derived for any m."""
    return {name: table for name, table in SYSTEMS.items() if issubclass(table, Preset)}
