"""The systems of the paper, each in one file: its table in a scene, its loads, and its nodes for any m."""

from __future__ import annotations

from wavesym.systems.building import Building, PhysicalBuilding
from wavesym.systems.collision import Collision, PhysicalCollision
from wavesym.systems.drive import Drive, PhysicalDrive
from wavesym.systems.explicit import ExplicitChain
from wavesym.systems.explicit_preset import ExplicitPreset
from wavesym.systems.preset import Preset

__all__ = [
    "PHYSICAL",
    "SYSTEMS",
    "Building",
    "Collision",
    "Drive",
    "ExplicitChain",
    "ExplicitPreset",
    "Preset",
    "SystemTable",
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
PHYSICAL: dict[str, type[PhysicalBuilding | PhysicalCollision | PhysicalDrive]] = {
    "collision": PhysicalCollision,
    "drive": PhysicalDrive,
    "building": PhysicalBuilding,
}
"""The presets as a scene with units says them."""


def presets() -> dict[str, type[Preset]]:
    """Those of them that are derived for any m."""
    return {name: table for name, table in SYSTEMS.items() if issubclass(table, Preset)}
