"""Outputs from waves on windows: between two breakpoints each is one polynomial, in balls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from flint import arb, arb_poly, ctx, fmpq

from wavesym.errors import CostError
from wavesym.evaluators.ball import Segment
from wavesym.evaluators.doubles import fraction, rational
from wavesym.evaluators.windows import Wave, Windows, windows
from wavesym.mechanics.chain import chain
from wavesym.mechanics.cone import light_cone, rod_of
from wavesym.scene import Observable, Scene

MOST_WINDOWS = 20_000


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
        self._bits = 0
        if len(self._nodes) * until > MOST_WINDOWS:
            raise CostError(
                f"output.until: the waves of {len(self._nodes)} nodes on {float(until):.0e} windows would be kept, "
                f"at most {MOST_WINDOWS:.0e} expected"
            )

    def breaks(self, place: Place) -> frozenset[fmpq]:
        """The parts of a unit of tau at which an output may jump or bend."""
        starts = (panel.start for panel in self._waves.panels)
        moments = (moment for start in starts for moment in (start + place.lag, start + 1 - place.lag))
        return frozenset(moment - moment.floor() for moment in moments)

    def segments(self, place: Place) -> list[Segment]:
        """An output between its breakpoints, at the working precision, as polynomials (rate 0) in balls."""
        times = {n + part for part in self.breaks(place) for n in range(int(self.until.floor()) + 1)}
        starts = sorted(time for time in times | {fmpq(0)} if time <= self.until)
        result = []
        displacement = arb(0)
        for start, end in pairwise([*starts, self.until]):
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
        if self._bits < ctx.prec:  # more bits, more terms
            self._bits = ctx.prec
            self.__dict__.pop("_marched", None)
        return self._marched

    @cached_property
    def _marched(self) -> Windows:
        count = int(self.until.floor()) + 1
        return windows(self._chain, self._nodes, self._acting, count, terms=self._bits // 4)


def is_zero(segments: Sequence[Segment]) -> bool:
    """Whether an output is 0 throughout."""
    return all(polynomial.length() == 0 for segment in segments for polynomial in segment.families.values())
