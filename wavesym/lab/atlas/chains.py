"""Families of curves: contact events, and where each program refuses a chain."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq

from wavesym.exact.contacts.events import events
from wavesym.exact.motion import Motion
from wavesym.lab.atlas.attempts import EVALUATORS, Truth, attempt, truth
from wavesym.lab.atlas.evaluators import sprung_masses
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import atlas_scene, chain
from wavesym.mechanics.event import ContactEvent
from wavesym.numbers.doubles import rational
from wavesym.programs.choice import attempt as attempt_program
from wavesym.scene import Scene, lower

BITS = 384
_AFTER = fmpq(1, 2**30)  # so soon after an event a ball is looked at

WIDTH, RADIUS, PIECES = "width of the instant", f"radius of a velocity, {BITS} bits", "pieces, error so far"


def dropped_bar(until: int) -> Scene:
    """A bar with a ground below that comes up to it, always faster: its own frame. Every 16 it is as at the start."""
    parts: list[Any] = [{"motion": "acceleration", "name": "ground"}, {"contact": "1/2"}, {"rod": 1}, "free"]
    load = [{"at": "ground", "times": [0], "steps": ["1/9"]}]
    return atlas_scene({"type": "chain", "parts": parts}, load, until, velocity=["0+"])


def wagons(until: int) -> Scene:
    """Two masses between elastic buffers: the first one runs into the other, which hits a wall and comes back."""
    first: list[Any] = [{"rod": 1, "velocity": 1}, {"mass": 2, "velocity": 1, "name": "first"}]
    second: list[Any] = [{"rod": 1}, {"mass": 3}, {"rod": 1}]
    parts = ["fixed", {"contact": 1}, *first, {"rod": 1, "velocity": 1}, {"contact": 1}, *second, {"contact": 1}]
    return atlas_scene({"type": "chain", "parts": [*parts, "fixed"]}, [], until, velocity=["first"])


CONTACTS: Mapping[str, Scene] = {
    "a bar dropped on the ground: all is rational": dropped_bar(200),
    "two wagons between walls": wagons(20),
}


def contacts(progress: Progress, panels: Mapping[str, Scene] = CONTACTS) -> CurveFamily:
    """How well each event is known, and what it takes from what follows it; x counts the events of a scene."""
    points: list[AtlasPoint] = []
    for panel, scene in panels.items():
        progress(panel)
        known = truth(scene, per_unit=8)
        found = events(known.model)
        for curve, sizes in ((WIDTH, widths(found)), (RADIUS, _radii(known, found))):
            points += [AtlasPoint(panel, curve, n, size) for n, size in enumerate(sizes, 1)]
        points += _errors_so_far(panel, known, found)
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


def _radii(known: Truth, found: tuple[ContactEvent, ...]) -> list[float]:
    """The radius of the first output just after each event, at a precision that is the same for all."""
    motion = Motion(known.model, rational(known.model.horizon()))
    after = [min(rational(event.double) + _AFTER, motion.until) for event in found]
    segments = motion.segments(motion.probes[0], BITS)
    with ctx.workprec(BITS):
        starts = [segment.start for segment in segments]
        places = [bisect_right(starts, tau) - 1 for tau in after]
        return [float(segments[k].evaluate(tau - starts[k]).rad()) for k, tau in zip(places, after, strict=True)]


def _errors_so_far(panel: str, known: Truth, found: tuple[ContactEvent, ...]) -> Iterator[AtlasPoint]:
    """The largest error of pieces up to each event."""
    one = attempt(known, "pieces")
    for n, event in enumerate(found, 1):
        here = int(np.searchsorted(known.taus, event.double, side="right"))
        error, bound = math.nan, math.inf
        if one.errors is not None:
            error, bound = float(np.max(one.errors[:here])), float(one.bounds[-1])
        yield AtlasPoint(panel, PIECES, n, error, bound, one.refusal)


def _masses(lengths: Sequence[Fraction], until: int) -> Scene:
    """Rods between unit masses, the first of which is pushed."""
    parts: list[Any] = [{"mass": 1, "name": "first"}]
    for length in lengths:
        parts += [{"rod": length}, {"mass": 1}]
    return chain(parts, until, velocity=["first"])


def _incommensurable(until: float) -> Scene:
    """Three lengths without a common measure to speak of, and so with ever more breakpoints."""
    return _masses([Fraction(1), Fraction("1.414213562"), Fraction("1.732050808")], int(until))


def _one_step_longer(steps: float) -> Scene:
    """Two lengths of which the second is one step longer, `steps` of which are the first."""
    return _masses([Fraction(1), 1 + Fraction(1, int(steps))], 10)


REFUSALS: Mapping[str, tuple[Callable[[float], Scene], Sequence[float]]] = {
    "horizon, lengths 1, 1.414213562 and 1.732050808": (_incommensurable, (2, 5, 10, 20, 40, 120)),
    "steps in the first rod, lengths 1 and 1 + a step": (_one_step_longer, (1, 2, 4, 8, 16, 32, 64, 128, 1e3, 1e6)),
    "K/M of a spring between two masses": (
        lambda ratio: sprung_masses(Fraction(ratio)),
        (1, 10, 100, 1e3, 1e4, 1e5, 1e6, 1e8),
    ),
    "contact events": (lambda count: dropped_bar(4 * int(count)), (4, 16, 64, 256, 1024)),
}
"""Of each panel a scene for x, and the places of x."""


def refusals(
    progress: Progress, panels: Mapping[str, tuple[Callable[[float], Scene], Sequence[float]]] = REFUSALS
) -> CurveFamily:
    """What each program proves, or that it refuses: by breakpoints, common steps, springs and contact events."""
    points = []
    for panel, (scene, places) in panels.items():
        for name in EVALUATORS:
            for x in places:
                progress(f"{panel}: {x:g}, {name}")
                tried = attempt_program(lower(scene(x)), name, asked=True)
                bound = tried.form.error_bound if tried.form else math.nan
                points.append(AtlasPoint(panel, name, x, bound, refusal=tried.refusal))
    return CurveFamily(
        "refusals",
        "Where each program refuses a chain that asks for 1e-10",
        Axis("as the panel says"),
        "proved bound / largest value",
        tuple(points),
        "filled: served; hollow: its bound is too large; cross: refused before the work (the table has each reason)",
        most=1e9,
    )
