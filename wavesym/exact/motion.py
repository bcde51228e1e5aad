"""Outputs from waves on windows: between two breakpoints each is one polynomial, in balls."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from math import inf

from flint import arb, arb_poly, ctx, fmpq

from wavesym.errors import CostError
from wavesym.exact.ball import Segment
from wavesym.exact.windows import PanelWave, WindowPanel, Windows, panels_of, windows
from wavesym.model.model import Model
from wavesym.model.probe import Probe

MOST_WINDOWS = 20_000
MOST_SECONDS = 60
# measured: seconds for a segment, times its terms to the power of 3/2, and for each term of a value
_COMPOSED, _EVALUATED = 2.5e-7, 6e-7


class Motion:
    """The outputs of a model until tau = `until` (a number of its horizon), at any precision.

    CostError where there would be too many windows.
    """

    def __init__(self, model: Model, until: fmpq) -> None:
        self.until = until
        self.probes = model.probes
        self._chain = model.chain
        self._nodes = model.light_cone(until)
        self._acting = model.acting(until)
        self._marched: dict[int, Windows] = {}
        if (kept := len(self._nodes) * until) > MOST_WINDOWS:
            raise CostError(
                f"output.until: {len(self._nodes)} nodes times {float(until):g} units of tau are {float(kept):g} "
                f"windows to keep, at most {MOST_WINDOWS} expected (a shorter horizon helps)"
            )

    @cached_property
    def _panels(self) -> tuple[WindowPanel, ...]:
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
        sums = any(probe.order < 0 for probe in self.probes)
        segments = sum(min(len(self.breaks(probe)) * windows, inf if sums else taus) for probe in self.probes)
        seconds = segments * terms**1.5 * _COMPOSED + taus * len(self.probes) * terms * _EVALUATED
        if seconds > MOST_SECONDS:
            raise CostError(
                f"output: {taus} values of {len(self.probes)} outputs to tau = {float(self.until):g} would take about "
                f"{seconds:.0f} s, at most {MOST_SECONDS} expected (fewer outputs, samples or load times help)"
            )

    def _lost(self, x: int) -> fmpq:
        """The logarithm of what a body makes of radii: exp(g) in each unit of tau in which it moves and is felt."""
        node = self._chain.nodes[x]
        if not node.inertia:
            return fmpq(0)
        felt = self.until - min(abs(probe.x - x) for probe in self.probes)
        moves = min((time + abs(x - at) for at, time in self._loaded), default=fmpq(1))  # collisions begin at contacts
        lost: fmpq = node.radiation * (felt - moves)
        return max(lost, fmpq(0))

    @cached_property
    def _loaded(self) -> list[tuple[int, fmpq]]:
        """The nodes on which loads act, and when the first of them does."""
        first = {load.source: load.time for load in reversed(self._acting)}
        of_nodes = ((x, load.source) for x in self._nodes for load in self._chain.nodes[x].loads)
        return [(x, first[source]) for x, source in of_nodes if source in first]

    def breaks(self, probe: Probe) -> frozenset[fmpq]:
        """The parts of a unit of tau at which an output may jump or bend."""
        starts = (panel.start for panel in self._panels)
        moments = (moment for start in starts for moment in (start + probe.place, start + 1 - probe.place))
        return frozenset(moment - moment.floor() for moment in moments)

    def starts(self, probe: Probe) -> list[fmpq]:
        """Where its segments start."""
        parts = sorted(self.breaks(probe))
        times = [n + part for n in range(int(self.until.floor()) + 1) for part in parts]
        return [fmpq(0)] * (parts[0] != 0) + [time for time in times if time <= self.until]

    def segments(self, probe: Probe, bits: int, taus: Sequence[fmpq] | None = None) -> list[Segment]:
        """An output between its breakpoints, with so many bits, as polynomials (rate 0) in balls.

        Where `taus` are given, only those on which one of them lies, as far as the others are not needed.
        """
        starts = self.starts(probe)
        ends = [*starts[1:], self.until]
        wanted: Sequence[int] = range(len(starts))
        if taus is not None and probe.order == 0:
            wanted = sorted({bisect_right(starts, tau) - 1 for tau in taus})
        waves = self._waves(bits)
        with ctx.workprec(bits):
            return list(_segments(waves, probe, [(starts[k], ends[k]) for k in wanted]))

    def _waves(self, bits: int) -> Windows:
        """What needs more bits, and so more terms, costs the others nothing."""
        if bits not in self._marched:
            count = int(self.until.floor()) + 1
            self._marched[bits] = windows(self._chain, self._nodes, self._acting, count, bits // 4, bits)
        return self._marched[bits]


def _segments(waves: Windows, probe: Probe, stretches: Iterable[tuple[fmpq, fmpq]]) -> Iterator[Segment]:
    """An output on each of these stretches, which come in order."""
    displacement = arb(0)
    for start, end in stretches:
        value = _value(waves, probe, start)
        polynomial = value.polynomial
        if probe.order < 0:
            polynomial = polynomial.integral() + displacement + arb(0, (value.error * arb(end - start)).upper())
            displacement = polynomial(arb(end - start))
        elif value.error != 0:
            polynomial = polynomial + arb(0, value.error)
        if start == end:  # of what begins at the end of the horizon only the first value is seen
            polynomial = arb_poly(polynomial.coeffs()[:1])
        yield Segment(start, {fmpq(0): polynomial})


def _value(waves: Windows, probe: Probe, start: fmpq) -> PanelWave:
    """Strain, or velocity, from tau = `start` on: the left-going wave less, or plus, the right-going one."""
    polynomial, error = arb_poly(), arb(0)
    right, left = probe.weights
    for factor, wave, offset in (
        (right, *waves.sent("right", probe.rod - 1, start - probe.place)),
        (left, *waves.sent("left", probe.rod, start - 1 + probe.place)),
    ):
        if wave.polynomial.length():
            later = wave.polynomial(arb_poly([arb(offset), 1])) if offset != 0 else wave.polynomial
            polynomial += factor * later
        error += wave.error
    return PanelWave(polynomial, error)


def is_zero(segments: Sequence[Segment]) -> bool:
    """Whether an output is 0 throughout."""
    return all(polynomial.length() == 0 for segment in segments for polynomial in segment.families.values())
