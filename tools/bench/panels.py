"""Streams of waves in C: what a panel takes, and a step within one, where loads change at every step."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from tools.bench.harness import flags_cell, toolchains
from wavesym import api
from wavesym.lab.stream import stream
from wavesym.lab.timing import least
from wavesym.programs.request import Request
from wavesym.scene import Scene
from wavesym.targets.files import sources as written

HEAD = ("scene", "degree", "compiler", "flags", "us a panel", "us a step of 0.01")
_STEPS = 2000
_DISCS = 10
_BUILT_IN = ("building_m2", "drive_m1", "geared_drive")


def discs(tolerance: str = "1e-9") -> Scene:
    """Ten unequal discs on nine unequal shafts, moments on the first and the last."""
    system: dict[str, Any] = {
        "type": "drive",
        "m": _DISCS - 1,
        "kappa": [f"{20 + k}/40" for k in range(_DISCS - 1)],
        "inertia": [f"{30 + (7 * k) % 23}/30" for k in range(_DISCS)],
    }
    loads = [{"body": body, "times": [0], "steps": [1]} for body in (1, _DISCS)]
    output = {"until": 40, "tolerance": tolerance, "strain": ["1/2", "9/2"], "velocity": [0, _DISCS - 1]}
    return Scene(name="discs", system=system, load=loads, output=output)


def rows(steps: int = _STEPS) -> Iterator[Sequence[str]]:
    """Of some scenes the degree, and microseconds of both kinds of steps."""
    for name, scene in {"ten discs": discs(), **{name: Scene.from_toml(name) for name in _BUILT_IN}}.items():
        made = api.program(scene, Request(stream=True))
        text = written(made, "c")
        samples = np.random.default_rng(1).standard_normal((steps, int(made.constants["loads"])))
        for compiler, flags in toolchains():
            calls = [
                stream(scene.name, text, samples, len(made.outputs), flags, dtau) for dtau in ("PREFIX_PANEL", "0.01")
            ]
            times = [f"{1e6 * seconds / steps:.2f}" for seconds in least(calls)]
            yield name, str(int(made.constants["degree"])), compiler, flags_cell(flags), *times
