"""Contacts that open and close: how well each instant is known, and what every event takes from what follows it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq

from wavesym.exact.contacts.events import events
from wavesym.exact.motion import Motion
from wavesym.lab.atlas.attempts import Truth, attempt, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import made
from wavesym.mechanics.event import ContactEvent
from wavesym.numbers.doubles import rational
from wavesym.scene import Scene

BITS = 384
_AFTER = fmpq(1, 2**30)  # so soon after an event a ball is looked at

DROPPED = "a bar dropped on the ground: all is rational"
WAGONS = "two wagons between walls"
WIDTH, RADIUS, PIECES = "width of the instant", f"radius of a velocity, {BITS} bits", "pieces, error so far"


def dropped(until: int) -> Scene:
    """A bar with a ground below that comes up to it, always faster: its own frame. Every 16 it is as at the start."""
    parts: list[Any] = [{"motion": "acceleration", "name": "ground"}, {"contact": "1/2"}, {"rod": 1}, "free"]
    load = [{"at": "ground", "times": [0], "steps": ["1/9"]}]
    return made({"type": "chain", "parts": parts}, load, until, velocity=["0+"])


def wagons(until: int) -> Scene:
    """Two masses between elastic buffers: the first one runs into the other, which hits a wall and comes back."""
    first: list[Any] = [{"rod": 1, "velocity": 1}, {"mass": 2, "velocity": 1, "name": "first"}]
    second: list[Any] = [{"rod": 1}, {"mass": 3}, {"rod": 1}]
    parts = ["fixed", {"contact": 1}, *first, {"rod": 1, "velocity": 1}, {"contact": 1}, *second, {"contact": 1}]
    return made({"type": "chain", "parts": [*parts, "fixed"]}, [], until, velocity=["first"])


PANELS: Mapping[str, Scene] = {DROPPED: dropped(200), WAGONS: wagons(20)}


def family(progress: Progress, panels: Mapping[str, Scene] = PANELS) -> CurveFamily:
    """A panel for each scene; x counts its events."""
    points = []
    for panel, scene in panels.items():
        progress(panel)
        known = truth(scene, per_unit=8)
        found = events(known.model)
        for curve, sizes in ((WIDTH, widths(found)), (RADIUS, radii(known, found))):
            points += [AtlasPoint(panel, curve, n, size) for n, size in enumerate(sizes, 1)]
        points += _kept(panel, known, found)
    return CurveFamily(
        "contacts",
        "Contact events: each takes a few of the hundreds of bits that enclosures have; pieces are as good after many",
        Axis("number of the event", scale="linear"),
        "width, radius, or largest error so far / largest value",
        tuple(points),
        least=1e-125,
        most=1e6,
    )


def widths(found: tuple[ContactEvent, ...]) -> list[float]:
    """How wide the enclosure of each instant is; 0 where it is exact."""
    return [float(2 * arb(event.tau.rad())) for event in found]


def radii(known: Truth, found: tuple[ContactEvent, ...]) -> list[float]:
    """The radius of the first output just after each event, at a precision that is the same for all."""
    motion = Motion(known.model, rational(known.model.horizon()))
    after = [min(rational(event.double) + _AFTER, motion.until) for event in found]
    segments = motion.segments(motion.probes[0], BITS)
    with ctx.workprec(BITS):
        starts = [segment.start for segment in segments]
        places = [bisect_right(starts, tau) - 1 for tau in after]
        return [float(segments[k].at(tau - starts[k]).rad()) for k, tau in zip(places, after, strict=True)]


def _kept(panel: str, known: Truth, found: tuple[ContactEvent, ...]) -> list[AtlasPoint]:
    one = attempt(known, "pieces")
    if one.errors is None:
        return [AtlasPoint(panel, PIECES, n, float("nan"), refused=one.refused) for n in range(1, len(found) + 1)]
    points = []
    for n, event in enumerate(found, 1):
        here = int(np.searchsorted(known.taus, event.double, side="right"))
        points.append(
            AtlasPoint(panel, PIECES, n, float(np.max(one.errors[:here])), float(one.bounds[-1]), one.refused)
        )
    return points
