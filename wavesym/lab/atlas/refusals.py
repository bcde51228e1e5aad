"""Where each program refuses a chain: by its knots, the common step of its delays, its springs, its contact events."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from wavesym.lab.atlas.attempts import EVALUATORS
from wavesym.lab.atlas.contacts import dropped
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import chain
from wavesym.lab.atlas.stiffness import scene as sprung
from wavesym.programs.choice import attempt
from wavesym.scene import Scene, lower


def long(until: float) -> Scene:
    """Three lengths without a common measure to speak of, and so with ever more knots."""
    return masses([Fraction(1), Fraction("1.414213562"), Fraction("1.732050808")], int(until))


def stepped(steps: float) -> Scene:
    """Two lengths of which the second is one step longer, `steps` of which are the first."""
    return masses([Fraction(1), 1 + Fraction(1, int(steps))], 10)


def stiff(ratio: float) -> Scene:
    """Two masses with a spring between them, K/M = `ratio`."""
    return sprung(Fraction(ratio))


def bouncing(count: float) -> Scene:
    """A bar dropped on the ground, which it meets or leaves so often."""
    return dropped(4 * int(count))


def masses(lengths: Sequence[Fraction], until: int) -> Scene:
    """Rods between unit masses, the first of which is pushed."""
    parts: list[Any] = [{"mass": 1, "name": "first"}]
    for length in lengths:
        parts += [{"rod": length}, {"mass": 1}]
    return chain(parts, until, velocity=["first"])


Panel = tuple[Callable[[float], Scene], Sequence[float]]

PANELS: Mapping[str, Panel] = {
    "horizon, lengths 1, 1.414213562 and 1.732050808": (long, (2, 5, 10, 20, 40, 120)),
    "steps in the first rod, lengths 1 and 1 + a step": (stepped, (1, 2, 4, 8, 16, 32, 64, 128, 1e3, 1e6)),
    "K/M of a spring between two masses": (stiff, (1, 10, 100, 1e3, 1e4, 1e5, 1e6, 1e8)),
    "contact events": (bouncing, (4, 16, 64, 256, 1024)),
}


def family(progress: Progress, panels: Mapping[str, Panel] = PANELS) -> CurveFamily:
    """What each program proves there, or that it refuses."""
    points = []
    for panel, (scene, places) in panels.items():
        for name in EVALUATORS:
            for x in places:
                progress(f"{panel}: {x:g}, {name}")
                tried = attempt(lower(scene(x)), name, asked=True)
                bound = tried.form.error_bound if tried.form else math.nan
                points.append(AtlasPoint(panel, name, x, bound, refused=tried.refusal))
    return CurveFamily(
        "refusals",
        "Where each program refuses a chain that asks for 1e-10",
        Axis("as the panel says"),
        "proved bound / largest value",
        tuple(points),
        "filled: served; hollow: its bound is too large; cross: refused before the work (the table has each reason)",
        most=1e9,
    )
