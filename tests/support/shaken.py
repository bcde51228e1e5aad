"""A building on ground that shakes as samples say, which are any time apart."""

from __future__ import annotations

from wavesym.mechanics.model import Model
from wavesym.scene import Scene, lower

SAMPLES = [(37 * k * k) % 101 - 50 for k in range(25)]


def shaken(samples: list[int], spacing: str = "1.37", until: int = 36, **output: object) -> Model:
    return lower(
        Scene(
            name="record",
            system={"type": "building", "m": 3, "kappa": ["1/4", "3/5", "3/5", "1/5"], "base": "ground"},
            load=[{"spacing": spacing, "samples": samples}],
            output={"until": until, "strain": ["1/3", "2+"], "velocity": [3], "displacement": ["1/2"], **output},
        )
    )
