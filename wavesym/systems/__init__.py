"""The systems of the paper, each in one file: its table in a scene, its loads, and its nodes for any m."""

from __future__ import annotations

from wavesym.systems.building import Building
from wavesym.systems.collision import Collision
from wavesym.systems.drive import Drive
from wavesym.systems.explicit import ExplicitChain
from wavesym.systems.preset import Preset

__all__ = ["PRESETS", "SYSTEMS", "Building", "Collision", "Drive", "ExplicitChain", "Preset", "SystemTable"]

SystemTable = Preset | ExplicitChain
PRESETS: dict[str, type[Preset]] = {"collision": Collision, "drive": Drive, "building": Building}
"""By the `type` that a scene says; one more system is one more entry."""
SYSTEMS: dict[str, type[SystemTable]] = {**PRESETS, "chain": ExplicitChain}
"""All that a scene's `type` may be."""
