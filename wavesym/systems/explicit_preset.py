"""A named system whose rods differ: written out as a chain, and still what people call it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from wavesym.systems.explicit import ExplicitChain


class ExplicitPreset(ExplicitChain):
    """A collision, a drive or a building, part by part: a chain in all that is computed, `type` in all that is said.

    Each rod counts 1 in places, as in the named system. The foundation of a building is the first node, whatever its
    `base`.
    """

    type: Literal["collision", "drive", "building"]  # type: ignore[assignment]
    base: Literal["force", "ground"] | None = None

    @property
    def choices(self) -> Mapping[str, str]:
        """What was chosen besides its parts."""
        return {"base": self.base, **super().choices} if self.base else super().choices
