"""What is measured on curves to judge what is said of Figs. 6, 7 and 8.

Words of degree are taken as numbers: two curves differ "slightly" where they are nowhere further apart than a third of
the largest value, "considerably" where they somewhere are by more than half. A curve swings where it goes by a
twentieth of its largest value before it turns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.sentences import Words

_SLIGHT, _CLEAR, _SWING, _UNEVEN, _TURN, _EXACT = 1 / 3, 1 / 2, 1 / 20, 1.5, 0.01, 1e-12

BOUNDS: Mapping[str, tuple[str, Callable[[float], bool]]] = {
    "slightly": (f"at most {_SLIGHT:.3g}", lambda value: value <= _SLIGHT),
    "considerably": (f"more than {_CLEAR:.3g}", lambda value: value > _CLEAR),
    "there and back": (f"more than {_TURN:.2g}", lambda value: value > _TURN),
    "between": ("nowhere outside", lambda value: value <= _EXACT),
    "larger": ("more than 1", lambda ratio: ratio > 1),
    "smaller": ("less than 1", lambda ratio: ratio < 1),
    "irregular oscillations": (
        f"at least three swings of {_SWING:.3g} of the largest value or more, "
        f"the largest more than {_UNEVEN:.3g} times the smallest",
        lambda ratio: ratio > _UNEVEN,
    ),
    "regular oscillations": (
        f"at least three swings, the largest at most {_UNEVEN:.3g} times the smallest",
        lambda ratio: 0 < ratio <= _UNEVEN,
    ),
    "no oscillations": ("fewer than three swings", lambda ratio: ratio == 0),
}
"""When a word is right of a measure: in words, and as a test."""


class MeasuredPoint(NamedTuple):
    """A place on a curve: quantity, place, and which of its instants."""

    quantity: str
    place: str
    instant: int

    @property
    def output(self) -> str:
        """As outputs are called."""
        return f"{self.quantity}@{self.place}"


class Finding(NamedTuple):
    """What was measured, and where: each spot is a point, or two that lie as far apart as the measure says."""

    value: float
    spots: tuple[tuple[MeasuredPoint, ...], ...] = ()


Curve = Callable[[str, str], Array]
"""The curve of a quantity at a place."""


def _quantity_and_places(words: Words) -> tuple[str, list[str]]:
    """The quantity and the places that a sentence names. MeaninglessError where a place is compared with itself."""
    plurals = {"strains": "strain", "displacements": "displacement", "velocities": "velocity"}
    places = words["places"].split("; ") if "places" in words else [words["place"], words["other"]]
    if len(set(places)) < len(places):
        raise MeaninglessError(f"x = {places[0]} is compared with itself")
    return plurals.get(words["quantity"], words["quantity"]), places


def _distance(words: Words, curve: Curve) -> Finding:
    """The largest distance of curves, in their largest value; at the end, in that there."""
    quantity, places = _quantity_and_places(words)
    curves = np.array([curve(quantity, place) for place in places])
    start = curves.shape[1] - 1 if words.get("when", "").startswith("at the end") else 0
    apart = np.ptp(curves[:, start:], axis=0)
    k = int(np.argmax(apart))
    largest = np.max(np.abs(curves[:, start:]))
    return Finding(float(apart[k] / largest), (_extreme_points(quantity, places, start + k, curve),))


def _extreme_points(quantity: str, places: Sequence[str], k: int, curve: Curve) -> tuple[MeasuredPoint, ...]:
    """The lowest and the highest of curves at an instant."""
    low, *_, high = sorted(places, key=lambda place: float(curve(quantity, place)[k]))
    return MeasuredPoint(quantity, low, k), MeasuredPoint(quantity, high, k)


def _turn(words: Words, curve: Curve) -> Finding:
    """How far curves go one way first and back later, the smaller of both in their largest value."""
    quantity, places = _quantity_and_places(words)
    found = []
    for place in places:
        values = curve(quantity, place) * (1 if words["way"].startswith("rise") else -1)
        top = int(np.argmax(values))
        way = min(values[top] - values[0], values[top] - values[-1]) / np.max(np.abs(values))
        found.append(Finding(float(way), ((MeasuredPoint(quantity, place, top),),)))
    return _combine(found, min)


def _excursion(words: Words, curve: Curve) -> Finding:
    """How far curves leave the band of two others, in the largest value of these; where they do not, the band."""
    quantity, places = _quantity_and_places(words)
    ends = words["one"], words["other"]
    low, high = (way([curve(quantity, end) for end in ends], axis=0) for way in (np.min, np.max))
    found = []
    for place in places:
        values = curve(quantity, place)
        beyond = np.maximum(values - high, low - values)
        worst = int(np.argmax(beyond))
        spot: tuple[MeasuredPoint, ...] = (MeasuredPoint(quantity, place, worst),)
        if beyond[worst] <= 0:
            spot = _extreme_points(quantity, ends, int(np.argmax(high - low)), curve)
        found.append(Finding(float(beyond[worst] / np.max(np.abs([low, high]))), (spot,)))
    return _combine(found, max)


def _peaks(words: Words, curve: Curve) -> Finding:
    """The largest absolute value of one curve over that of the other."""
    quantity, places = _quantity_and_places(words)
    tops = [MeasuredPoint(quantity, place, int(np.argmax(np.abs(curve(quantity, place))))) for place in places]
    high, low = (abs(curve(quantity, top.place)[top.instant]) for top in tops)
    return Finding(float(high / low), tuple((top,) for top in tops))


def _unevenness(words: Words, curve: Curve) -> Finding:
    """The largest swing between successive turning points over the smallest; 0 where there are fewer than three."""
    quantity, places = _quantity_and_places(words)
    found = []
    for place in places:
        values = curve(quantity, place)
        turns = _turns(values.tolist(), _SWING * float(np.max(np.abs(values))))
        swings = sorted(pairwise(turns), key=lambda ends: abs(values[ends[1]] - values[ends[0]]))
        if len(swings) < 3:
            found.append(Finding(0.0))
            continue
        large, small = (abs(values[b] - values[a]) for a, b in (swings[-1], swings[0]))
        spots = (tuple(MeasuredPoint(quantity, place, k) for k in ends) for ends in (swings[-1], swings[0]))
        found.append(Finding(float(large / small), tuple(spots)))
    return _combine(found, min)


def _turns(curve: Sequence[float], least: float) -> list[int]:
    """Where a curve turns, after going one way and before going the other, each time by at least `least`."""
    turns: list[int] = []
    low = high = way = 0
    for k, value in enumerate(curve):
        low, high = (k if value < curve[low] else low), (k if value > curve[high] else high)
        if way >= 0 and curve[high] - value >= least:
            turns += [high] * way
            low, way = k, -1
        elif way <= 0 and value - curve[low] >= least:
            turns += [low] * -way
            high, way = k, 1
    return turns


def _combine(found: Sequence[Finding], worst: Callable[[Iterable[float]], float]) -> Finding:
    """The worst of several findings, and where each of them is."""
    spots = dict.fromkeys(spot for finding in found for spot in finding.spots)
    return Finding(worst(finding.value for finding in found), tuple(spots))


class Measure(NamedTuple):
    """What is measured of curves, the bound that it is judged by (of the word in a place, or always the same), and how
    that is put."""

    find: Callable[[Words, Curve], Finding]
    bound: str
    meaning: str


MEASURES: Mapping[str, Measure] = {
    "distance": Measure(_distance, "degree", "largest distance {bound} of the largest value"),
    "turn": Measure(_turn, "there and back", "one way and back, the smaller {bound} of the largest value"),
    "outside": Measure(_excursion, "between", "{bound}"),
    "peaks": Measure(_peaks, "size", "ratio of the largest values, x = {place} to x = {other}, {bound}"),
    "unevenness": Measure(_unevenness, "swings", "{bound}"),
}
