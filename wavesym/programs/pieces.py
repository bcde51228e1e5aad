"""Pieces: on each stretch between breakpoints an output is one polynomial, of just the degree that the tolerance needs.

The waves come from `windows`, in balls. On a piece, with t = (tau - centre) / half in [-1, 1], an output is turned into
a Chebyshev series and cut off where the rest is small enough; what stays is rounded, as powers of w = tau - centre.

The proved error of a piece of degree d with powers c_k (of t) is the sum of
- the Chebyshev terms cut off, and the balls that the waves are known in;
- rounding, with unit roundoff u and to first order: each c_k once, w once (k u), and Horner's rule (2 k + 1) u make
  (3 k + 2) u |c_k|; contraction of a*b + c only makes less of it. NumPy sums products of powers of w with the c_k in
  any order, c_0 last: (2 k + d + 1) u |c_k|, for c_0 2 u |c_0|. The bound takes the larger of the two;
- underflow, which in each coefficient (of w), product and power of w is at most half the smallest number. As
  |w| <= 1/2, Horner's rule makes no more than 2 of these halves for each coefficient; NumPy's powers of w are wrong
  by at most 2, times their coefficients.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from itertools import pairwise

from flint import arb, arb_poly, fmpq

from wavesym.errors import CostError
from wavesym.exact.arrivals import identically_zero
from wavesym.exact.contacts.events import what_helps
from wavesym.exact.motion import NEGLIGIBLE_WAVE, Motion
from wavesym.exact.output_piece import shorten
from wavesym.exact.tables.ball import Balls, Segment, is_zero
from wavesym.mechanics.model import Model
from wavesym.mechanics.travel_times import what_adjusts
from wavesym.numbers import chebyshev
from wavesym.numbers.balls import precise
from wavesym.numbers.doubles import bound, nearest, rational
from wavesym.numbers.reals import Real
from wavesym.programs.piece_grid import PieceGrid, Pieces
from wavesym.programs.program import ProgramOutput

# A table larger than this is for the march.
MOST_BYTES = 4 << 20
# Pieces in a unit of tau: shorter ones have lower degrees and round less, in larger tables, and fewer samples are on
# each.
_USUAL = (4, 2, 1)
_SHORTER = (2, 4, 8, 16, 32)
# A fit of series at so many bits takes seconds, at twice as many the better part of a minute (terms double with bits).
_MOST_BITS = 1024
# Pieces times four times the terms of a series, which are its bits: half a minute.
_MOST_WORK = 15_000_000
# Of all outputs as series, for the next number of pieces, in bytes.
_MOST_KEPT = 256 << 20
# Measured: seconds for a stretch of a wave, times its terms to the power of 3/2.
_MOVED = 4e-7
# The fastest are taken whose tables are no larger than this.
_FAST_BYTES = 128 << 10
_SECOND_ORDER = arb(fmpq(1001, 1000))
# of the largest value; far below what any tolerance asks for
_NEGLIGIBLE = arb(2) ** -200


def pieces(
    model: Model, real: Real, tolerance: fmpq, optimize: str = "speed", most_seconds: float = math.inf
) -> Pieces:
    """The pieces of a model, with degrees for a tolerance, met or not: see `error_bound`.

    Args:
        model: dimensionless.
        real: the numbers of the program.
        tolerance: relative to each output's largest value.
        optimize: "speed" for pieces on which many samples take least time, "size" for the least tables, "making" for
            those that are fitted soonest.
        most_seconds: what computing the waves may take.

    Raises:
        CostError: where tables would be larger than `MOST_BYTES`, or take long to fit, or waves longer than that.
    """
    # no finer than rounding: a smaller tolerance is not met by more bits or more pieces
    fits = _Fits(model, real, max(tolerance, real.roundoff / 8), most_seconds)
    if optimize == "making":
        found = fits.fit_pieces(_USUAL[-1])
    else:
        found = _smallest(fits, tolerance) if optimize == "size" else _fastest(fits, tolerance)
    for shorter in _SHORTER:
        missed = rational(found.error_bound) > tolerance > real.roundoff / 8
        if shorter > found.per_unit and missed and fits.differ(shorter, found.per_unit):
            found = fits.fit_pieces(shorter)
    if found.bytes > MOST_BYTES:
        raise _too_large(found.bytes, MOST_BYTES, model)
    return found


class _TooLarge(CostError):
    """Tables larger than they may be."""


def _too_large(size: int, most: int, model: Model) -> _TooLarge:
    helps = ", ".join(filter(None, (what_adjusts(model.network.bars), "a shorter horizon")))
    return _TooLarge(
        f"output.until: pieces would take at least {size} bytes, the limit is {most} ({helps}, "
        "fewer outputs or load times help)"
    )


def _fastest(fits: _Fits, tolerance: fmpq) -> Pieces:
    """Longer pieces as long as they are faster; the longest where the tables of others are too large."""
    *shorter, longest = _USUAL
    best: Pieces | None = None
    for per_unit in shorter:
        if fits.differ(per_unit, longest):
            with suppress(_TooLarge):
                found = fits.fit_pieces(per_unit, _FAST_BYTES)
                if best and not _better(found, best, tolerance):
                    return best
                if found.bytes <= _FAST_BYTES:
                    best = found
    if best and rational(best.error_bound) > tolerance:
        return best
    found = fits.fit_pieces(longest)
    return found if not best or _better(found, best, tolerance) else best


def _better(longer: Pieces, pieces: Pieces, tolerance: fmpq) -> bool:
    # the cost is not known to a twentieth, and shorter ones are faster where samples are many
    return rational(longer.error_bound) <= tolerance and longer.cost < 0.95 * pieces.cost


def _smallest(fits: _Fits, tolerance: fmpq) -> Pieces:
    tried = []
    for per_unit in _USUAL:
        with suppress(_TooLarge):
            tried.append(fits.fit_pieces(per_unit))
    good = [found for found in tried if rational(found.error_bound) <= tolerance]
    if good:
        return min(good, key=lambda found: found.bytes)
    return tried[0] if tried else fits.fit_pieces(_USUAL[-1])


class _Fits:
    """The outputs of a model at the precision that its tolerance needs, and fits to them."""

    def __init__(self, model: Model, real: Real, tolerance: fmpq, most_seconds: float = math.inf) -> None:
        self._model = model
        self._real = real
        # a little of it is left for printing the bound in two digits, rounded up
        self._tolerance = arb(tolerance) * arb(fmpq(9, 10))
        self._tau_max = model.horizon(real)
        self._motion = Motion(model, rational(self._tau_max))
        self._bits = self._motion.first_bits
        self._known: dict[int, tuple[int, _Course]] = {}
        if self._bits > self._most_bits:
            raise CostError(
                f"output.until: {self._bits} bits would be needed for pieces to tau = {self._tau_max:g}, the "
                f"limit is {self._most_bits} ({self._motion.helps} help)"
            )
        if (seconds := self._motion.stretches * self._motion.terms(self._bits) ** 1.5 * _MOVED) > most_seconds:
            raise CostError(
                f"output.until: {self._motion.stretches} stretches in {self._bits} bits would take about "
                f"{seconds:.0f} s, the limit where another program serves is {most_seconds:g} s (--evaluator "
                "pieces helps)"
            )

    @cached_property
    def _most_bits(self) -> int:
        """As many as fit in about the time of a series with `_MOST_BITS`."""
        most = _MOST_BITS
        while 2 * most * self._motion.terms(2 * most) <= _MOST_BITS**2 // 4:
            most *= 2
        return most

    @cached_property
    def _silent(self) -> set[int]:
        """The outputs that are 0 throughout though waves arrive, which no number of bits tells."""
        return {k for k, nothing in enumerate(identically_zero(self._model, rational(self._tau_max))) if nothing}

    def fit_pieces(self, per_unit: int, most: int = MOST_BYTES) -> Pieces:
        """Pieces, about `per_unit` of them in a unit of tau. CostError where they would take more than `most` bytes."""
        if self._least(per_unit) * self._real.bytes > most:
            raise _too_large(self._least(per_unit) * self._real.bytes, most, self._model)

        def attempt(bits: int) -> Pieces | None:
            self._bits = bits  # what did for one number of pieces is where the next one starts
            if self._least(per_unit) > (most_pieces := _MOST_WORK // (4 * self._motion.terms(bits))):
                raise CostError(
                    f"output.until: {self._least(per_unit):.1e} pieces would be fitted with {bits} bits, the "
                    f"limit is {most_pieces:.1e} (a shorter horizon, fewer outputs or load times help)"
                )
            return self._fit(per_unit, most, bits)

        try:
            return precise(attempt, self._bits, self._most_bits)
        except OverflowError:  # of the numbers' format, which costs have nothing to do with
            raise
        except ArithmeticError as error:
            helps = what_helps(self._model, self._real)
            raise CostError(f"output.until: to fit pieces, {error} ({helps} helps)") from None

    def differ(self, per_unit: int, other: int) -> bool:
        """Whether pieces are others; where breakpoints are close they are not."""
        return self._least(per_unit) != self._least(other)

    def _least(self, per_unit: int) -> int:
        """How many pieces there are at least, of all outputs."""
        return sum(
            len(places) * int(sum(((high - low) * per_unit).ceil() for low, high in pairwise(starts)))
            for starts, places in self._shared
        )

    @cached_property
    def _shared(self) -> list[tuple[Sequence[fmpq], list[int]]]:
        """The outputs, by where they may jump or bend."""
        shared: list[tuple[Sequence[fmpq], list[int]]] = []
        for k, probe in enumerate(self._motion.probes):
            starts = self._motion.starts(probe)
            for known, members in shared:
                if known == starts:  # which differ early as a rule, and exact numbers are hashed slowly
                    members.append(k)
                    break
            else:
                shared.append((starts, [k]))
        return shared

    def _fit(self, per_unit: int, most: int, bits: int) -> Pieces | None:
        probes = self._motion.probes
        grids: list[PieceGrid] = []
        bounds: dict[int, tuple[float, float]] = {}
        size = 0
        keep = self._least(per_unit) * self._motion.terms(bits) * bits <= 8 * _MOST_KEPT
        for _, members in self._shared:
            columns = []
            for k in members:
                course = self._course(k, bits, keep)
                starts = [segment.start for segment in course.segments]
                cuts = _Cuts(starts, self._motion.until, per_unit, self._real)
                fit = self._output(course, cuts, bits)
                if fit is None and k in self._silent:
                    fit = _nothing(cuts)
                if fit is None:
                    return None
                bounds[k], powers = fit
                columns.append(powers)
                size += self._real.bytes * sum(map(len, powers))
                if size > most:
                    raise _too_large(size, most, self._model)
            grids.append(cuts.grid(members, columns))
        outputs = tuple(
            ProgramOutput(probe.name, *bounds[k], incidental=probe.incidental) for k, probe in enumerate(probes)
        )
        return Pieces(outputs, self._tau_max, self._real, tuple(grids), per_unit)

    def _course(self, output: int, bits: int, keep: bool) -> _Course:
        """An output in so many bits, once for all numbers of pieces; with other bits the one before is dropped."""
        known, course = self._known.get(output, (0, None))
        if course is None or known != bits:
            course = _Course(self._motion.segments(self._motion.probes[output], bits))
            if keep:
                self._known[output] = bits, course
        return course

    def _output(
        self, course: _Course, cuts: _Cuts, bits: int
    ) -> tuple[tuple[float, float], list[tuple[float, ...]]] | None:
        """Bound and largest value of an output, and its powers on every piece; None where so many bits do not do."""
        segments = course.segments
        if is_zero([segments[place] for place in cuts.places(segments)]):
            return _nothing(cuts)
        if self._motion.vanishes(Balls(segments).sizes(self._motion.until)):
            _, powers = _nothing(cuts)
            return (bound(NEGLIGIBLE_WAVE), 0.0), powers
        if self._too_blurred(course, cuts, bits):
            return None
        local = list(course.on_pieces(cuts))
        scale = max(map(cuts.size, range(len(local)), local))
        if not scale > 0:
            return None
        allowed, enough = self._allowed_errors(scale)
        worst = arb(0)
        powers = []
        for coefficients, half in zip(chebyshev.coefficients(local, bits), cuts.halves, strict=True):
            blurred = sum((c.rad() for c in coefficients), arb(0))
            if not blurred < enough:
                return None
            error, kept = _cut_off([c.mid() for c in coefficients], allowed - blurred, self._real)
            local_powers = [c / arb(half) ** k for k, c in enumerate(kept)]
            worst = worst.max((error + blurred + _underflow(local_powers, self._real)).upper())
            powers.append(tuple(map(self._real.nearest_middle, local_powers)))
        return (bound(worst / scale), float(scale)), powers

    def _allowed_errors(self, scale: arb) -> tuple[arb, arb]:
        """The error that is allowed where the largest value is `scale`, and what of it balls may take."""
        allowed = self._tolerance * scale
        return allowed, allowed.max(arb(self._real.roundoff) * scale) / 1000

    def _too_blurred(self, course: _Course, cuts: _Cuts, bits: int) -> bool:
        """Whether balls, which grow with time, hide the last piece, however large the largest value is."""
        largest = arb(0)
        segments = course.segments
        for segment, end in zip(segments, [*(s.start for s in segments[1:]), self._motion.until], strict=True):
            (polynomial,) = segment.families.values()
            largest = largest.max(abs(polynomial(arb(0).union(arb(end - segment.start)))).upper())
        (last,) = chebyshev.coefficients(list(course.on_pieces(cuts, len(cuts.middles) - 1)), bits)
        return not sum((c.rad() for c in last), arb(0)) < self._allowed_errors(largest)[1]


def _nothing(cuts: _Cuts) -> tuple[tuple[float, float], list[tuple[float, ...]]]:
    """What fits an output that is 0 throughout."""
    return (0.0, 0.0), [(0.0,)] * len(cuts.centres)


class _Course:
    """An output in balls: its segments, and what it is on each piece, which other numbers of pieces have too.

    Where breakpoints are close most pieces go from one to the next, however many are in a unit.
    """

    def __init__(self, segments: Sequence[Segment]) -> None:
        self.segments = segments
        self._on: dict[tuple[int, float, fmpq], arb_poly] = {}

    @cached_property
    def _negligible(self) -> arb:
        return max(abs(p[0]).lower() for segment in self.segments for p in segment.families.values()) * _NEGLIGIBLE

    def on_pieces(self, cuts: _Cuts, first: int = 0) -> Iterator[arb_poly]:
        """The output on every piece from the `first` on, in t; what is negligible is in the balls."""
        for key in list(zip(cuts.places(self.segments), cuts.centres, cuts.halves, strict=True))[first:]:
            if key not in self._on:
                place, centre, half = key
                segment = self.segments[place]
                (polynomial,) = segment.families.values()
                moved = polynomial(arb_poly([arb(rational(centre) - segment.start), arb(half)]))
                self._on[key] = shorten(moved, arb(1), self._negligible)
            yield self._on[key]


class _Cuts:
    """The pieces between breakpoints: their exact ends, and how these look in real numbers."""

    def __init__(self, breaks: Sequence[fmpq], until: fmpq, per_unit: int, real: Real) -> None:
        self._real = real
        last = rational(real.next_after(real.nearest(until), float("inf")))
        exact = []
        for low, high in pairwise([*breaks, last]):
            parts = max(1, int(((high - low) * per_unit).ceil()))
            inner = (rational(real.nearest(low + (high - low) * j / parts)) for j in range(1, parts))
            exact += [low, *inner]
        exact.append(last)
        # where two of them are the same real number, no tau is between them
        seen = [real.not_below(cut) for cut in exact]
        kept = [k for k in range(len(exact) - 1) if seen[k] < seen[k + 1]]
        self.exact = [exact[k] for k in kept] + [last]
        self.starts = [seen[k] for k in kept] + [seen[-1]]
        # as far as the output goes on without a breakpoint, and within the horizon
        self.ends = [min(exact[k + 1], until) for k in kept]
        self.centres = [real.nearest((low + high) / 2) for low, high in pairwise(self.exact)]
        self.middles = [rational(centre) for centre in self.centres]
        self.halves = [
            max(high - middle, middle - low)
            for (low, high), middle in zip(pairwise(self.exact), self.middles, strict=True)
        ]

    def places(self, segments: Sequence[Segment]) -> list[int]:
        """The segment that each piece is on; one on which no real number lies has none."""
        starts = [segment.start for segment in segments]
        return [bisect_right(starts, start) - 1 for start in self.exact[:-1]]

    def size(self, piece: int, polynomial: arb_poly) -> arb:
        """The largest of an output's values at both ends of a piece and at its centre, from its `polynomial` in t.

        What lies beyond the next breakpoint or the horizon is no value of it.
        """
        low, middle, high = self.exact[piece], self.middles[piece], self.ends[piece]
        places = (low, max(low, min(middle, high)), high)
        return max(abs(polynomial(arb((tau - middle) / self.halves[piece]))).lower() for tau in places)

    def grid(self, outputs: Sequence[int], columns: Sequence[Sequence[tuple[float, ...]]]) -> PieceGrid:
        """The pieces with their powers, output by output."""
        pieces = len(self.centres)
        count = pieces
        while True:  # finer until few pieces lie in a part
            scale = self._real.nearest(fmpq(count) / rational(self.starts[-1]))
            # tau * scale is rounded: a tau that is a little smaller belongs to part b too
            edges = (float(b) / scale * (1 - 8 * nearest(self._real.roundoff)) for b in range(count + 2))
            first = [min(bisect_right(self.starts, edge) - 1, pieces - 1) for edge in edges]
            steps = max(b - a for a, b in pairwise(first)) + 1
            if steps <= 3 or count > 4 * pieces:
                break
            count *= 2
        return PieceGrid(
            tuple(outputs),
            tuple(self.starts),
            tuple(self.centres),
            tuple(map(_as_many, zip(*columns, strict=True))),
            scale,
            tuple(first),
            steps,
        )


def _as_many(polynomials: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    """Polynomials with as many powers as the longest has; a power that is 0 adds no error."""
    most = max(map(len, polynomials))
    return tuple(powers + (0.0,) * (most - len(powers)) for powers in polynomials)


def _cut_off(coefficients: Sequence[arb], allowed: arb, real: Real) -> tuple[arb, list[arb]]:
    """The error and the powers of the shortest series whose error is allowed; of the best one where none is."""
    rest = [arb(0)]
    for c in reversed(coefficients):
        rest.append(rest[-1] + abs(c).upper())
    rest.reverse()  # rest[d] is what is lost by keeping d terms
    best: tuple[arb, list[arb]] | None = None
    for terms in range(1, len(coefficients) + 1):
        if rest[terms] > allowed and terms < len(coefficients):
            continue
        powers = chebyshev.powers(coefficients[:terms])
        weights = (max(3 * k + 2, 2 * k + terms if k else 0) for k in range(terms))
        rounding = sum((w * abs(c) for w, c in zip(weights, powers, strict=True)), arb(0)) * arb(real.roundoff)
        error = rest[terms] + _SECOND_ORDER * rounding.upper()
        if best is None or error < best[0]:
            best = error, powers
        if error <= allowed or rest[terms] < rounding * arb(real.roundoff):
            break
    assert best is not None  # all terms are always tried
    return best


def _underflow(powers: Sequence[arb], real: Real) -> arb:
    """What may underflow on a piece with these coefficients of w."""
    return arb(real.smallest) * sum((2 + 2 * abs(c).upper() for c in powers), arb(0))
