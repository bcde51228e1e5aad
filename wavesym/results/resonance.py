"""The greatest amplitude of each output in a band of frequencies, enclosed: no peak between points is missed.

On an interval about m of half width r a function is its Taylor polynomial about m, and a rest that its second
derivative on the whole interval bounds: h(m) + h'(m) s + h''(interval)/2 s^2, |s| <= r, all of it in balls. Intervals
whose amplitudes may exceed the greatest one found so far, L, are halved until none is left. An amplitude |N/D| that
hardly changes stays near L, and so does the top of a peak of nearly that height: then |N|^2 - L^2 |D|^2 is taken as one
polynomial, in which what is alike cancels, and is itself looked at in parts.

Where no half has a bound, D is 0. That is a pole if it is proved to be one: D is real and has two signs, and N is not
0. Where both are, N/D is searched once more in lowest terms, which have no common zeros (exact/modes/lowest_terms.py).
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, isfinite, isnan, nan

from flint import arb, ctx

from wavesym.errors import CostError, WavesymError
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import midpoint, upper_double
from wavesym.results.amplitude_polynomials import (
    Transfers,
    reaches_zero,
    squared_amplitudes,
    transfer_fractions,
)
from wavesym.results.modal_transfer import MOST_MODES, transfers
from wavesym.results.presentation import csv_line, output_number
from wavesym.results.transfer import HarmonicLoad, angular

_SHARE = arb(2) ** -33  # of the greatest amplitude: what peaks are enclosed to
_NOISE = arb(2) ** -128  # of an amplitude: one that is no higher than by so much is the same
_LEAST = arb(2) ** -40  # of the band: in an interval in which amplitudes are still not bounded a pole is sought
_LOOKS_AT = ((256, arb(2) ** -80), (1024, arb(2) ** -320))
"""Bits, and of the band an interval that is given up, where there may be a pole or none; then the second."""
_GROWTH = arb(1.5)  # of a square towards 0, in the last octave: there is a pole at 0, where it is 4 or 16
_MOST = 600_000  # intervals times parts
_SHARP = arb(2) ** -80  # of a frequency: the place of a pole
_ASIDE = arb(509) / 1024
_NEWTON = 3
_HALVINGS = 30
_PARTS = 64  # of the band at first
_TIMES = 4  # as many modes, where damping ratios need more


@dataclass(frozen=True)
class AmplitudePeak:
    """The greatest amplitude of one output in the band.

    Attributes:
        name: the output; `unit` its unit, per unit of the load.
        frequency: where it is, in Hz, or in rad per tau without [units]; of places that are equally high one, the lower
            end of the band if that is.
        frequency_low: proved: amplitudes are lower below it, and above `frequency_high`; these are far apart where
            places are equally high. A pole (one of those that there are) is between them. nan where amplitude is.
        frequency_high: see there.
        amplitude: what it is there, to the nearest double; inf at a natural frequency that nothing damps; nan where it
            is not decided whether there is a greatest one: at a natural frequency that the load may not excite.
        low: proved: it is at least this, and at most `high`, inf where amplitude is inf or nan.
    """

    name: str
    unit: str
    frequency: float
    amplitude: float
    low: float
    high: float
    frequency_low: float
    frequency_high: float


@dataclass(frozen=True)
class AmplitudePeaks:
    """The peaks of all outputs; `wavesym.frf(...).peaks()` makes it; `peaks[NAME]` is that of one output."""

    name: str
    load: str
    load_unit: str
    frequency_label: str
    band: tuple[float, float]
    peaks: tuple[AmplitudePeak, ...]

    def __iter__(self) -> Iterator[AmplitudePeak]:
        return iter(self.peaks)

    def __len__(self) -> int:
        return len(self.peaks)

    def __getitem__(self, name: str) -> AmplitudePeak:
        return self.peaks[output_number(name, [peak.name for peak in self.peaks], self.name)]

    @property
    def notes(self) -> tuple[str, ...]:
        """What is not decided: lines for people."""
        return tuple(
            f"{p.name}: not decided whether it has a greatest amplitude: the load may not excite what is natural at "
            f"{p.frequency:g} (travel times of rods with a common measure, or a band without it, help)"
            for p in self.peaks
            if isnan(p.amplitude)
        )

    def csv(self) -> str:
        """A line for each output."""
        head = f"output,{self.frequency_label},amplitude,low,high,frequency_low,frequency_high\n"
        rows = (
            (p.name, p.frequency, p.amplitude, p.low, p.high, p.frequency_low, p.frequency_high) for p in self.peaks
        )
        return head + "".join(map(csv_line, rows))

    def json(self) -> str:
        """As JSON; null in place of what is not bounded."""
        peaks = [
            {key: each if isinstance(each, str) or isfinite(each) else None for key, each in vars(peak).items()}
            for peak in self.peaks
        ]
        about = {"load": self.load, "load_unit": self.load_unit, "frequency_label": self.frequency_label}
        return json.dumps({"name": self.name, **about, "band": list(self.band), "peaks": peaks}, indent=2) + "\n"


def peaks(model: Model, load: HarmonicLoad, low: float, high: float) -> AmplitudePeaks:
    """The greatest amplitude of each output from one frequency to another.

    Args:
        model: a chain without contacts that open.
        load: which load.
        low: the least frequency, in Hz where the model has a clock, else in rad per tau.
        high: the greatest.

    Raises:
        WavesymError: for a band that is none.
        UnservedError: as for `frequency_response`.
        CostError: where too many intervals would be needed.
    """
    if not 0 <= low < high:
        raise WavesymError(f"--peaks: {low:g} to {high:g} is no band of frequencies; write two that differ")
    for bits, shortest in _LOOKS_AT:
        with ctx.workprec(bits):
            found = _searches(model, load, angular(model, low), angular(model, high), shortest)
            per = angular(model, 1.0)
            made = [_peak(probe, each, per, (low, high)) for probe, each in zip(model.probes, found, strict=True)]
        if not any(each.is_open for each in found):
            break
    label = "omega" if model.clock is None else "frequency [Hz]"
    return AmplitudePeaks(model.name, load.label, load.unit, label, (low, high), tuple(made))


def _searches(model: Model, load: HarmonicLoad, first: arb, last: arb, shortest: arb) -> list[_Search]:
    """What is known of the greatest amplitude of each output from one frequency to another."""
    parts = len(model.network.points)
    for transfer, rests in transfers(model, load, last, _TIMES):
        found = [_Search(rest) for rest in rests]
        if not all(rest.is_finite() for rest in rests):
            continue
        _search(transfer, found, first, last, parts, shortest)
        if all(each.rest**2 <= each.square * arb(model.tolerance) ** 2 for each in found):
            break
    if not all(each.is_finite() for each in rests):
        raise CostError(f"--to: {MOST_MODES} modes lie below it, the limit is {MOST_MODES} (a lower frequency helps)")
    for k, each in enumerate(found):
        terms = transfer.lowest_terms(k) if each.is_open else None
        if terms is not None:
            found[k] = _Search(each.rest)
            _search(terms, found[k : k + 1], first, last, parts, shortest)
    return found


def _peak(probe: Probe, search: _Search, per: arb, band: tuple[float, float]) -> AmplitudePeak:
    square, rest, bounded = search.square, search.rest, not (search.pole or search.is_open)
    low, high = band
    frequency = low if search.at is None else min(max(midpoint(search.at / per), low), high)
    if search.is_open:
        low = high = nan
    elif search.place is not None:
        least, most = search.place
        low, high = max(low, -upper_double(-least / per)), min(high, upper_double(most / per))
        frequency = min(max(frequency, low), high)
    return AmplitudePeak(
        name=probe.name,
        unit=probe.unit,
        frequency=frequency,
        amplitude=midpoint(square.sqrt()) if bounded else inf if search.pole else nan,
        low=-upper_double(rest - square.sqrt()) if square > rest**2 else 0.0,
        high=upper_double((square * (1 + _SHARE)).sqrt() + rest) if bounded else inf,
        frequency_low=low,
        frequency_high=high,
    )


class _Search:
    """The greatest amplitude of one output: as far as it is known."""

    def __init__(self, rest: arb) -> None:
        self.rest = rest
        """What the modes left out may add."""
        self.square = arb(0)
        """The square of the greatest amplitude found, without the rest."""
        self.at: arb | None = None
        self.pole = False
        self.is_open = False
        """Whether there is a place where it has no bound, and no pole that is proved."""
        self.place: tuple[arb, arb] | None = None
        """Between which frequencies the greatest amplitude is proved to be; None for somewhere in the band."""
        self.near_top: list[tuple[arb, arb, arb]] = []
        """From where to where amplitudes, squared, are at most the third, and may be the greatest."""

    @property
    def surpassed(self) -> arb:
        """What is less, squared, without the rest, is not the greatest amplitude."""
        if self.rest == 0:
            return self.square
        root = (self.square.sqrt() - 2 * self.rest).lower()
        return root**2 if root > 0 else arb(0)

    def enclose_place(self) -> None:
        """Take what may still be the greatest amplitude together."""
        left = [(low, high) for low, high, most in self.near_top if not most < self.surpassed]
        if left and not (self.pole or self.is_open):
            self.place = min(low for low, _ in left), max(high for _, high in left)

    def amplitude_squared(self, w: arb, square: arb) -> None:
        """An amplitude, squared, at a frequency."""
        if square.is_finite() and (self.at is None or square.lower() > self.square * (1 + _NOISE)):
            self.square, self.at = square.lower(), w

    def leave(self, low: arb, high: arb, most: arb) -> None:
        """Look no further at an interval in which amplitudes, squared, are at most so much."""
        if not most < self.surpassed:
            self.near_top.append((low, high, most))

    def excludes(self, square: arb) -> bool:
        """Whether what is nowhere above so much cannot matter."""
        return bool(square <= self.square * (1 + _SHARE))


@dataclass(frozen=True)
class _Interval:
    """Frequencies from `low` to `high`, and the outputs whose greatest amplitude may be there."""

    low: arb
    high: arb
    outputs: Sequence[int]

    @property
    def middle(self) -> arb:
        return ((self.low + self.high) / 2).mid()

    def halves(self, outputs: Sequence[int]) -> Iterator[_Interval]:
        yield _Interval(self.low, self.middle, outputs)
        yield _Interval(self.middle, self.high, outputs)


def _search(transfer: Transfers, found: Sequence[_Search], first: arb, last: arb, parts: int, shortest: arb) -> None:
    """Find the greatest amplitudes from one frequency to another, in intervals down to `shortest` of it. CostError.

    What is not finite at 0 is searched from a 2^-40 of the band on: there it has a pole, or goes on as it comes.
    """
    is_from_zero = first.contains(0) and not all(
        square.is_finite() for square, _, _ in squared_amplitudes(transfer, first)
    )
    if is_from_zero:
        first = (last * _LEAST).mid()
        near, next_to = squared_amplitudes(transfer, first), squared_amplitudes(transfer, 2 * first)
        for search, (square, _, _), (later, _, _) in zip(found, near, next_to, strict=True):
            if square > later * _GROWTH:
                search.amplitude_squared(first, square)
                search.pole, search.at, search.place = True, arb(0), (arb(0), arb(0))
    every = list(range(len(found)))
    edges = [(first + (last - first) * k / _PARTS).mid() for k in range(_PARTS + 1)]
    edges[0], edges[-1] = first.lower(), last.upper()
    for edge in (edges[0], edges[-1]):
        for search, (square, _, _) in zip(found, squared_amplitudes(transfer, edge), strict=True):
            search.amplitude_squared(edge, square)
    level, count = [_Interval(*each, every) for each in pairwise(edges)], 0
    allowed = _MOST // parts
    while level:
        count += len(level)
        if count > allowed:
            raise CostError(f"--peaks: {count} intervals, the limit is {allowed} (a narrower band or fewer parts help)")
        middles = [squared_amplitudes(transfer, each.middle) for each in level]
        for each, squares in zip(level, middles, strict=True):
            for k in each.outputs:
                found[k].amplitude_squared(each.middle, squares[k][0])
        for k in {k for each in level for k in each.outputs}:
            _polish(transfer, found[k], k, first, last)
        following: list[_Interval] = []
        for each, squares in zip(level, middles, strict=True):
            ball, half = each.low.union(each.high), (each.high - each.low) / 2
            fractions = transfer_fractions(transfer, ball)
            whole = squared_amplitudes(transfer, ball, fractions)
            open_for = []
            for k in each.outputs:
                value, slope, _ = squares[k]
                rest = value + abs(slope) * half + abs(whole[k][2]) * half * half
                most = (whole[k][0] if reaches_zero(ball) else rest).upper()
                if found[k].pole or found[k].is_open:
                    continue
                if most.is_finite() and found[k].excludes(most):
                    found[k].leave(each.low, each.high, most)
                    continue
                enough = found[k].square * (1 + _SHARE)
                if fractions is not None and fractions.stays_below(k, enough, half):
                    if not fractions.stays_below(k, found[k].surpassed, half):
                        found[k].leave(each.low, each.high, enough)
                    continue
                width, wide = each.high - each.low, (last - first).min(each.high)
                below, above = each.low - width, each.high + width
                if width > wide * shortest:  # what is nearer to an end of the band than that is at it
                    below, above = below.max(edges[0]), above.min(edges[-1])
                if width < wide * _LEAST and transfer.has_pole(k, below, above):
                    pole = _locate_pole(transfer, k, below, above)
                    found[k].pole, found[k].place, found[k].at = True, pole, ((pole[0] + pole[1]) / 2).mid()
                elif width < wide * (shortest if transfer.lowest_terms(k) is None else _LEAST):
                    found[k].is_open, found[k].at = True, each.middle
                else:
                    open_for.append(k)
            if open_for:
                following += each.halves(open_for)
        level = following
    for k, search in enumerate(found):
        search.enclose_place()
        _sharpen_place(transfer, search, k)
        if search.place is not None and is_from_zero and search.place[0] == edges[0]:
            search.place = arb(0), search.place[1]


def _sharpen_place(transfer: Transfers, search: _Search, k: int) -> None:
    """Enclose the place of the greatest amplitude better: where it rises or falls all the way, or has one top."""
    if search.place is None or search.at is None or search.pole:
        return
    low, high = (_approach(transfer, search, k, end, search.at) for end in search.place)
    search.place = low, high
    for _ in range(_NEWTON if search.rest == 0 else 0):
        low, high = search.place
        if not low < high:
            return
        ball = low.union(high)
        if reaches_zero(ball):
            return
        _, slope, bend = squared_amplitudes(transfer, ball, transfer_fractions(transfer, ball))[k]
        at_low, at_middle, at_high = (squared_amplitudes(transfer, w)[k][1] for w in (low, ball.mid(), high))
        if slope > 0 or (bend < 0 and at_high > 0):
            search.place = high, high
        elif slope < 0 or (bend < 0 and at_low < 0):
            search.place = low, low
        elif bend < 0 and at_low > 0 > at_high:
            top = ball.mid() - at_middle / (2 * bend)
            search.place = low.max(top.lower()), high.min(top.upper())
        else:
            return


def _approach(transfer: Transfers, search: _Search, k: int, end: arb, top: arb) -> arb:
    """How near to the greatest amplitude found all are proved to be lower from `end` on, half of the way at a time."""
    for _ in range(_HALVINGS):
        middle = ((end + top) / 2).mid()
        ball, half = end.union(middle), abs(end - middle) / 2
        fractions = transfer_fractions(transfer, ball)
        is_lower = squared_amplitudes(transfer, ball, fractions)[k][0] < search.surpassed
        if not is_lower and (fractions is None or not fractions.stays_below(k, search.surpassed, half)):
            break
        end = middle
    return end


def _locate_pole(transfer: Transfers, k: int, low: arb, high: arb) -> tuple[arb, arb]:
    """Where output k has the pole that it is proved to have between two frequencies, far closer than a double tells."""
    while high - low > high * _SHARP:
        part = (low + (high - low) * _ASIDE).mid()  # the middle of all is a pole sooner than that
        if transfer.has_pole(k, low, part):
            high = part
        elif transfer.has_pole(k, part, high):
            low = part
        else:
            break
    return low.mid(), high.mid()


def _polish(transfer: Transfers, search: _Search, k: int, first: arb, last: arb) -> None:
    """Go to the top that the greatest amplitude found lies beside, by Newton's method."""
    for _ in range(_NEWTON):
        if search.pole or search.is_open or search.at is None or search.at.contains(0):
            return
        _, slope, bend = squared_amplitudes(transfer, search.at)[k]
        if not bend < 0:
            return
        better = (search.at - slope / (2 * bend)).mid()
        if first < better < last:
            search.amplitude_squared(better, squared_amplitudes(transfer, better)[k][0])
