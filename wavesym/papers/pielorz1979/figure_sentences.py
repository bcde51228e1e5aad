"""What can be said of Figs. 6, 7 and 8: sentences by their patterns, and what is measured on curves to judge them.

Words of degree are taken as numbers: two curves differ "slightly" where they are nowhere further apart than a third of
the largest value, "considerably" where they somewhere are by more than half. A curve swings where it goes by a
twentieth of its largest value before it turns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.pielorz1979.figure_scenes import SAMPLES, SENSES, Array
from wavesym.papers.sentences import Pattern

Words = Mapping[str, str]

SLIGHT, CLEAR = 1 / 3, 1 / 2
SWING = 1 / 20
UNEVEN = 1.5
TURN = 0.01
EXACT = 1e-12


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


@dataclass(frozen=True)
class Kind:
    """Sentences of a pattern: what is measured, when that is what is said, and how that is put."""

    pattern: Pattern
    measured: Callable[[Words, Curve], Finding]
    true: Callable[[Words, float], bool]
    meaning: Callable[[Words], str]


# What is measured


def _apart(quantity: str, places: Sequence[str], curve: Curve) -> Finding:
    """The largest distance of curves, in their largest value."""
    _unlike(*places)
    together = np.array([curve(quantity, place) for place in places])
    distance = np.ptp(together, axis=0)
    k = int(np.argmax(distance))
    return Finding(float(distance[k] / np.max(np.abs(together))), (_across(quantity, places, k, curve),))


def _unlike(*places: str) -> None:
    if len(set(places)) < len(places):
        raise MeaninglessError(f"x = {places[0]} is compared with itself")


def _across(quantity: str, places: Sequence[str], k: int, curve: Curve) -> tuple[MeasuredPoint, ...]:
    """The lowest and the highest of curves at an instant."""
    low, *_, high = sorted(places, key=lambda place: float(curve(quantity, place)[k]))
    return MeasuredPoint(quantity, low, k), MeasuredPoint(quantity, high, k)


def _at_end(quantity: str, places: Sequence[str], curve: Curve) -> Finding:
    """The distance of curves at their end, in the largest of them there."""
    ends = [float(curve(quantity, place)[-1]) for place in places]
    return Finding((max(ends) - min(ends)) / max(map(abs, ends)), (_across(quantity, places, SAMPLES - 1, curve),))


def _turn(quantity: str, place: str, sign: int, curve: Curve) -> Finding:
    """How far a curve goes one way first and back later, the smaller of both in its largest value."""
    values = sign * curve(quantity, place)
    top = int(np.argmax(values))
    way = min(values[top] - values[0], values[top] - values[-1]) / np.max(np.abs(values))
    return Finding(float(way), ((MeasuredPoint(quantity, place, top),),))


def _outside(inner: str, ends: Sequence[str], curve: Curve) -> Finding:
    """How far a displacement leaves the band of two others, in their largest value; where it does not, the band."""
    values = curve("displacement", inner)
    low, high = (way([curve("displacement", end) for end in ends], axis=0) for way in (np.min, np.max))
    beyond = np.maximum(values - high, low - values)
    worst = int(np.argmax(beyond))
    spot: tuple[MeasuredPoint, ...] = (MeasuredPoint("displacement", inner, worst),)
    if beyond[worst] <= 0:
        spot = _across("displacement", ends, int(np.argmax(high - low)), curve)
    return Finding(float(beyond[worst] / np.max(np.abs([low, high]))), (spot,))


def _peaks(quantity: str, one: str, other: str, curve: Curve) -> Finding:
    """The largest absolute value of one curve over that of the other."""
    _unlike(one, other)
    tops = {place: int(np.argmax(np.abs(curve(quantity, place)))) for place in (one, other)}
    high, low = (abs(curve(quantity, place)[k]) for place, k in tops.items())
    return Finding(float(high / low), tuple((MeasuredPoint(quantity, *top),) for top in tops.items()))


def _unevenness(quantity: str, place: str, curve: Curve) -> Finding:
    """The largest swing between successive turning points over the smallest; 0 where there are fewer than three."""
    values = curve(quantity, place)
    turns = _turns(values.tolist(), SWING * float(np.max(np.abs(values))))
    swings = sorted(pairwise(turns), key=lambda ends: abs(values[ends[1]] - values[ends[0]]))
    if len(swings) < 3:
        return Finding(0.0)
    small, large = (abs(values[b] - values[a]) for a, b in (swings[0], swings[-1]))
    spots = ((swings[-1][0], swings[-1][1]), (swings[0][0], swings[0][1]))
    return Finding(
        float(large / small), tuple(tuple(MeasuredPoint(quantity, place, k) for k in ends) for ends in spots)
    )


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


def _worst(found: Iterable[Finding], worst: Callable[[Any], float] = max) -> Finding:
    """The worst of several findings, and where each of them is."""
    kept = list(found)
    spots = dict.fromkeys(spot for finding in kept for spot in finding.spots)
    return Finding(worst(finding.value for finding in kept), tuple(spots))


# What can be said

_PLURALS = {"strains": "strain", "displacements": "displacement", "velocities": "velocity"}
_DEGREES: Mapping[str, tuple[str, Callable[[float], bool]]] = {
    "slightly": (f"at most {SLIGHT:.3g}", lambda value: value <= SLIGHT),
    "considerably": (f"more than {CLEAR:.3g}", lambda value: value > CLEAR),
}
_WAYS = {"rise at first and fall later": 1, "fall at first and rise later": -1}
_SIZES: Mapping[str, Callable[[float], bool]] = {"larger": lambda ratio: ratio > 1, "smaller": lambda ratio: ratio < 1}
_SWINGS: Mapping[str, tuple[str, Callable[[float], bool]]] = {
    "irregular oscillations": (
        f"at least three swings of {SWING:.3g} of the largest value or more, the largest more than {UNEVEN:.3g} times "
        "the smallest",
        lambda ratio: ratio > UNEVEN,
    ),
    "regular oscillations": (
        f"at least three swings, the largest at most {UNEVEN:.3g} times the smallest",
        lambda ratio: 0 < ratio <= UNEVEN,
    ),
    "no oscillations": ("fewer than three swings", lambda ratio: ratio == 0),
}


def _kind(
    text: str,
    words: Mapping[str, Iterable[str]],
    measured: Callable[[Words, Curve], Finding],
    true: Callable[[Words, float], bool],
    meaning: Callable[[Words], str],
    name: str = "",
) -> Kind:
    return Kind(
        Pattern(name or text, text, {place: tuple(choices) for place, choices in words.items()}),
        measured,
        true,
        meaning,
    )


def _differs(
    quantity: str, places: Sequence[str], before: str = "", words: Mapping[str, Iterable[str]] | None = None
) -> Kind:
    """One curve against another, of those that the figure has of a quantity."""
    return _kind(
        before + "the {quantity} at x = {place} differs {degree} from that at x = {other}",
        {**(words or {}), "quantity": ("strain", "displacement"), "place": places, "degree": _DEGREES, "other": places},
        lambda words, curve: _apart(words["quantity"], (words["place"], words["other"]), curve),
        _degree,
        _distance,
        name=f"{before}{quantity} at a place from another",
    )


def _degree(words: Words, value: float) -> bool:
    return _DEGREES[words["degree"]][1](value)


def _distance(words: Words) -> str:
    return f"largest distance {_DEGREES[words['degree']][0]} of the largest value"


def _listed(places: str) -> list[str]:
    return places.split("; ")


_SENSE = "under moments {sense}, "
KINDS: Mapping[int, Sequence[Kind]] = {
    6: (
        _differs("strain", ("1-", "2", "3+")),
        _differs("displacement", ("0", "1", "3", "4")),
        _kind(
            "the displacements at x = {places} {way}",
            {"places": ("0; 1", "3; 4", "0; 4", "1; 3"), "way": _WAYS},
            lambda words, curve: _worst(
                (_turn("displacement", place, _WAYS[words["way"]], curve) for place in _listed(words["places"])),
                worst=min,
            ),
            lambda words, value: value > TURN,
            lambda words: f"one way and back, the smaller more than {TURN:.2g} of the largest value",
        ),
        _kind(
            "the displacements at x = {places} lie between those at x = {one} and x = {other}",
            {
                "places": ("1.5; 2; 2.5", "0; 1.5; 2; 2.5", "1.5; 2; 2.5; 4"),
                "one": ("1", "2"),
                "other": ("2", "3"),
            },
            lambda words, curve: _worst(
                _outside(place, (words["one"], words["other"]), curve) for place in _listed(words["places"])
            ),
            lambda words, value: value <= EXACT,
            lambda words: "nowhere outside",
        ),
        _kind(
            "{when} the {quantity} at x = {places} differ {degree}",
            {
                "when": ("at the end of the collision", "throughout the collision"),
                "quantity": ("displacements", "strains"),
                "places": ("1; 1.5; 2; 2.5; 3",),
                "degree": _DEGREES,
            },
            lambda words, curve: (_at_end if words["when"].startswith("at the end") else _apart)(
                _PLURALS[words["quantity"]], _listed(words["places"]), curve
            ),
            _degree,
            lambda words: f"{words['when']} a distance of {_DEGREES[words['degree']][0]} of the largest value",
        ),
    ),
    7: (
        _kind(
            _SENSE + "the {quantity} at x = {places} differ {degree}",
            {
                "sense": SENSES,
                "quantity": ("strains", "displacements"),
                "places": ("0; 0.5; 1",),
                "degree": _DEGREES,
            },
            lambda words, curve: _apart(_PLURALS[words["quantity"]], _listed(words["places"]), curve),
            _degree,
            _distance,
        ),
        _differs("displacement", ("0", "1"), _SENSE, {"sense": SENSES}),
    ),
    8: (
        _kind(
            "the {size} {quantity} occur at x = {place}, not at x = {other}",
            {"size": _SIZES, "quantity": _PLURALS, "place": ("0.5", "1.5"), "other": ("0.5", "1.5")},
            lambda words, curve: _peaks(_PLURALS[words["quantity"]], words["place"], words["other"], curve),
            lambda words, value: _SIZES[words["size"]](value),
            lambda words: (
                f"ratio of the largest values, x = {words['place']} to x = {words['other']}, "
                f"{'more' if words['size'] == 'larger' else 'less'} than 1"
            ),
        ),
        _kind(
            "the {quantity} at x = {places} are {swings}",
            {"quantity": _PLURALS, "places": ("0.5; 1.5",), "swings": _SWINGS},
            lambda words, curve: _worst(
                (_unevenness(_PLURALS[words["quantity"]], place, curve) for place in _listed(words["places"])),
                worst=min,
            ),
            lambda words, value: _SWINGS[words["swings"]][1](value),
            lambda words: _SWINGS[words["swings"]][0],
        ),
    ),
}
"""The sentences about each figure."""
