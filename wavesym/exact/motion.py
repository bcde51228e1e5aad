"""Outputs from waves on windows: between two breakpoints each is one polynomial, in balls."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf

from flint import arb, arb_poly, ctx, fmpq

from wavesym.errors import CostError
from wavesym.exact.ball import Segment
from wavesym.exact.windows import Panel, Wave, Windows, damping, panels_of, sources, windows
from wavesym.model.chain import chain
from wavesym.model.light_cone import light_cone, rod_of
from wavesym.numbers.doubles import fraction, rational
from wavesym.scene import Observable, Scene

MOST_WINDOWS = 20_000
MOST_SECONDS = 60
# measured: seconds for a segment, times its terms to the power of 3/2, and for each term of a value
_COMPOSED, _EVALUATED = 2.5e-7, 6e-7


@dataclass(frozen=True)
class Place:
    """Where an output lies: its rod, and how far the right-going wave has come from the node on its left."""

    observable: Observable
    rod: int
    lag: fmpq


class Motion:
    """The outputs of a scene until tau = `until` (a number of the scene's horizon), at any precision.

    CostError where there would be too many windows.
    """

    def __init__(self, scene: Scene, until: fmpq) -> None:
        self.until = until
        self._chain = chain(scene)
        self._nodes = light_cone(self._chain, scene.outputs, fraction(until))
        self._acting = [piece for piece in scene.pieces if rational(piece.time) <= until]
        self.places = [
            Place(output, rod_of(output), rational(output.x) - (rod_of(output) - 1)) for output in scene.outputs
        ]
        self._marched: dict[int, Windows] = {}
        if (kept := len(self._nodes) * until) > MOST_WINDOWS:
            raise CostError(
                f"output.until: {len(self._nodes)} nodes times {float(until):g} units of tau are {float(kept):g} "
                f"windows to keep, at most {MOST_WINDOWS} expected (a shorter horizon helps)"
            )

    @cached_property
    def _panels(self) -> tuple[Panel, ...]:
        return panels_of(self._chain, self._nodes, self._acting)

    @cached_property
    def first_bits(self) -> int:
        """With fewer bits nothing would be left at the end of the horizon; a power of 2, up to more than is had."""
        lost = int(max(map(self._lost, self._nodes)) * 36 / 25)  # not more than 1/log(2)
        return 1 << min(max(lost.bit_length(), 7), 20)

    def refuse_long(self, taus: int) -> None:
        """CostError where values of all outputs at so many tau would take minutes."""
        terms = self.first_bits // 4
        windows = int(self.until.floor()) + 1
        sums = any(place.observable.quantity == "displacement" for place in self.places)
        segments = sum(min(len(self.breaks(place)) * windows, inf if sums else taus) for place in self.places)
        seconds = segments * terms**1.5 * _COMPOSED + taus * len(self.places) * terms * _EVALUATED
        if seconds > MOST_SECONDS:
            raise CostError(
                f"output: {taus} values of {len(self.places)} outputs to tau = {float(self.until):g} would take about "
                f"{seconds:.0f} s, at most {MOST_SECONDS} expected (fewer outputs, samples or load times help)"
            )

    def _lost(self, x: int) -> fmpq:
        """The logarithm of what a body makes of radii: exp(g) in each unit of tau in which it moves and is felt."""
        node = self._chain.nodes[x]
        if not node.inertia:
            return fmpq(0)
        felt = self.until - min(abs(rational(place.observable.x) - x) for place in self.places)
        moves = min((time + abs(x - at) for at, time in self._loaded), default=fmpq(1))  # collisions begin at contacts
        return max(damping(node) * (felt - moves), fmpq(0))

    @cached_property
    def _loaded(self) -> list[tuple[int, fmpq]]:
        """The nodes on which loads act, and when the first of them does."""
        first = {piece.source: rational(piece.time) for piece in reversed(self._acting)}
        of_nodes = ((x, source) for x in self._nodes for source in sources(self._chain.nodes[x]))
        return [(x, first[source]) for x, source in of_nodes if source in first]

    def breaks(self, place: Place) -> frozenset[fmpq]:
        """The parts of a unit of tau at which an output may jump or bend."""
        starts = (panel.start for panel in self._panels)
        moments = (moment for start in starts for moment in (start + place.lag, start + 1 - place.lag))
        return frozenset(moment - moment.floor() for moment in moments)

    def starts(self, place: Place) -> list[fmpq]:
        """Where its segments start."""
        parts = sorted(self.breaks(place))
        times = [n + part for n in range(int(self.until.floor()) + 1) for part in parts]
        return [fmpq(0)] * (parts[0] != 0) + [time for time in times if time <= self.until]

    def segments(self, place: Place, taus: Sequence[fmpq] | None = None) -> list[Segment]:
        """An output between its breakpoints, at the working precision, as polynomials (rate 0) in balls.

        Where `taus` are given, only those on which one of them lies, as far as the others are not needed.
        """
        starts = self.starts(place)
        ends = [*starts[1:], self.until]
        wanted: Sequence[int] = range(len(starts))
        if taus is not None and place.observable.quantity != "displacement":
            wanted = sorted({bisect_right(starts, tau) - 1 for tau in taus})
        result = []
        displacement = arb(0)
        for start, end in ((starts[k], ends[k]) for k in wanted):
            value = self._value(place, start)
            polynomial = value.polynomial
            if place.observable.quantity == "displacement":
                polynomial = polynomial.integral() + displacement + arb(0, (value.error * arb(end - start)).upper())
                displacement = polynomial(arb(end - start))
            elif value.error != 0:
                polynomial = polynomial + arb(0, value.error)
            if start == end:  # of what begins at the end of the horizon only the first value is seen
                polynomial = arb_poly(polynomial.coeffs()[:1])
            result.append(Segment(start, {fmpq(0): polynomial}))
        return result

    def _value(self, place: Place, start: fmpq) -> Wave:
        """Strain, or velocity, from tau = `start` on: the left-going wave less, or plus, the right-going one."""
        polynomial, error = arb_poly(), arb(0)
        sign = -1 if place.observable.quantity == "strain" else 1
        for factor, wave, offset in (
            (sign, *self._waves.sent("right", place.rod - 1, start - place.lag)),
            (1, *self._waves.sent("left", place.rod, start - 1 + place.lag)),
        ):
            if wave.polynomial.length():
                later = wave.polynomial(arb_poly([arb(offset), 1])) if offset != 0 else wave.polynomial
                polynomial += factor * later
            error += wave.error
        return Wave(polynomial, error)

    @property
    def _waves(self) -> Windows:
        """At the working precision; what needs more bits, and so more terms, costs the others nothing."""
        if ctx.prec not in self._marched:
            count = int(self.until.floor()) + 1
            made = windows(self._chain, self._nodes, self._acting, count, terms=ctx.prec // 4)
            self._marched[ctx.prec] = made
        return self._marched[ctx.prec]


def is_zero(segments: Sequence[Segment]) -> bool:
    """Whether an output is 0 throughout."""
    return all(polynomial.length() == 0 for segment in segments for polynomial in segment.families.values())
