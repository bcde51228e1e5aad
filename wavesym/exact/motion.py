"""Outputs from the waves of a network: between two breakpoints each is one polynomial, in balls."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from math import e, inf, log2
from typing import NamedTuple

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from wavesym.errors import CostError, UnservedError
from wavesym.exact.arrivals import smooth_starts
from wavesym.exact.breakpoints import Breakpoints
from wavesym.exact.joints.enclosure import STILL, Enclosure, shift, weighted_sum
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.joints.jumps import refuse_jumps
from wavesym.exact.joints.network_waves import LoadPolynomial, NetworkWaves, SentWave, Waves
from wavesym.exact.tables.ball import Segment
from wavesym.mechanics.gauge import ReadingTerm
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End
from wavesym.mechanics.probe import Probe
from wavesym.numbers.balls import FIRST_BITS
from wavesym.numbers.doubles import not_below, rational

MOST_STRETCHES = 20_000
# with those that loads begin: a quarter of a minute, and as long again for the values of a self-test
MOST_LOADED = 150_000
MOST_SECONDS = 60
# measured: seconds for a segment, times its terms to the power of 3/2, and for each term of a value
_COMPOSED, _EVALUATED = 2.5e-7, 6e-7
# bits that a crossing of a bar takes from what is known of its wave
_CROSSING = fmpq(3, 2)
# bits for each unit that a series swings: what cancels, and about what its terms need
_CANCELLED, _BORNE = 3, 16
# bits that are wanted of values
_WANTED = 72
# bits come in words of so many, and are never so many
_WORD, _MOST_FIRST = 64, 1 << 20
# of the largest wave: what is smaller may be 0, where contacts open and close
NEGLIGIBLE_WAVE = arb(2) ** -200
_LARGEST = 5 << 27  # bytes
_ZERO = fmpq(0)


class Motion:
    """The outputs of a model until tau = `until` (a number of its horizon), at any precision.

    CostError where there would be too many stretches.
    """

    def __init__(self, model: Model, until: fmpq) -> None:
        model.refuse_damping()
        refuse_jumps(model, until)
        self.until = until
        self.probes = model.probes
        self._model, self._network = model, model.network
        self._acting = model.loads_until(until)
        self._breakpoints = Breakpoints(model, until)
        self._solved: dict[int, Waves] = {}
        self._shifts = _Shifts()
        counted = self._breakpoints.schedule is not None  # of joints with contacts, as they were found
        if not counted and (kept := self._breakpoints.crossings) > MOST_STRETCHES:
            raise CostError(
                f"output.until: {self._breakpoints.label} are {kept:g} stretches to keep, the limit is "
                f"{MOST_STRETCHES} (a shorter horizon helps)"
            )
        if (loaded := self._breakpoints.stretches) > MOST_LOADED:
            raise CostError(
                f"load: {self._breakpoints.label} are {loaded} stretches between loads, the limit is "
                f"{MOST_LOADED} (fewer load times help)"
            )

    @cached_property
    def first_bits(self) -> int:
        """With fewer bits nothing would be left at the end of the horizon; whole words, up to more than is had."""
        _, swing = self._hardest
        words = (64 + self._crossing_bits + _CANCELLED * swing) / _WORD
        return int(min(max(int(words.ceil()) * _WORD, FIRST_BITS), _MOST_FIRST))

    @property
    def helps(self) -> str:
        """What would make `first_bits` less."""
        law, swing = self._hardest
        if self._crossing_bits >= _BORNE * swing:
            return "a shorter horizon or longer rods"
        ways = ["heavier bodies"] * bool(law.heavy) + ["softer springs"] * law.springs
        return " or ".join(ways)

    def terms(self, bits: int) -> int:
        """How many powers waves have that are known in so many bits; those of loads where they are no series.

        What a series that swings by x leaves out after n terms is about x^n / n!, and of what has crossed bars about as
        much as if it swung by one more: no more than is wanted before crossings take their part.
        """
        if not self._series:
            return self._powers
        wanted = bits - self.first_bits + _WANTED + float(self._crossing_bits)
        terms, swing = bits // 8, e * (1 + float(self._hardest[1]))
        while terms * log2(terms / swing) < wanted:
            terms += 1 + terms // 32
        return terms

    @cached_property
    def _series(self) -> bool:
        """Whether joints have a state, which makes series of what arrives: mass, or springs."""
        points = {
            point for number in self._breakpoints.joints_in_reach for point in self._network.joints[number].points
        }
        return any(
            self._network.points[point].stiffness != 0
            or (self._network.points[point].mass != 0 and self._network.points[point].motion is None)
            for point in points
        ) or any(link.stiffness != 0 and link.left in points for link in self._network.links)

    @cached_property
    def _powers(self) -> int:
        """How many powers loads have, at most, as what acts or as a velocity."""
        sources = {load.source for load in self._acting}
        units = [unit for point in self._network.points for unit in point.loads if unit.source in sources]
        return 1 + max((len(unit.coefficients) for unit in units), default=0)

    @cached_property
    def _crossing_bits(self) -> fmpq:
        """The bits that crossings of bars take; none where contacts open and close and all is exact (`ExactJoint`)."""
        if not self._network.bars or (self._network.corners and not self._series):
            return fmpq(0)
        return _CROSSING * self.until / self._network.shortest

    @cached_property
    def _hardest(self) -> tuple[JointLaw, fmpq]:
        """The joint whose series has to bear most on its longest stretch: its law, and exp(what)."""
        laws = ((JointLaw.assemble(self._network, self._network.joints[n]), n) for n in self._breakpoints.joints)
        law, swing = max(((law, self._breakpoints.swing(n, law)) for law, n in laws), key=lambda each: each[1])
        most = self._breakpoints.most_swing
        return law, swing if most is None else min(swing, most)

    @cached_property
    def size(self) -> arb:
        """A lower bound of the largest wave, as a velocity, or velocity of what no wave shows: at points of stretches.

        A chain without rods has no waves, and masses that slide back and forth may be at rest where stretches begin.
        """
        joints, network = self._breakpoints.joints, self._network
        with ctx.workprec(self.first_bits):
            waves = self.waves(self.first_bits)
            of_point = [(network.point_at(end), wave) for end, wave in waves.sent.items()] + [*waves.velocities.items()]
            return max(
                (
                    abs(known.evaluate(w)).lower()
                    for point, wave in of_point
                    if (times := joints.get(network.joint_of[point]))
                    for known, (start, stop) in zip(wave.stretches, pairwise([*wave.starts, times[-1]]), strict=True)
                    if start < stop
                    for w in (fmpq(0), (stop - start) / 2, stop - start)
                ),
                default=arb(0),
            )

    def vanishes(self, sizes: Iterable[arb]) -> bool:
        """Whether what is at most so large counts as 0, where contacts open and close: no sum is exact then."""
        return bool(self._network.corners) and all(size < self.size * NEGLIGIBLE_WAVE for size in sizes)

    def composing_time(self, polynomials: float) -> float:
        """About how many seconds so many polynomials take; CostError where `first_bits` are more than is had."""
        if self.first_bits >= _MOST_FIRST:
            raise CostError(
                f"output.until: more than {_MOST_FIRST} bits would be needed to tau = {float(self.until):g}, the limit "
                f"is {_MOST_FIRST} ({self.helps} help)"
            )
        return float(polynomials * self.terms(self.first_bits) ** 1.5 * _COMPOSED)

    def refuse_long(self, taus: int) -> None:
        """CostError where values of all outputs at so many tau would take minutes."""
        sums = any(map(self._integrates, self.probes))
        segments = sum(min(len(self.starts(probe)), inf if sums else taus) for probe in self.probes)
        seconds = self.composing_time(segments)
        seconds += taus * len(self.probes) * self.terms(self.first_bits) * _EVALUATED
        if seconds > MOST_SECONDS:
            raise CostError(
                f"output: {taus} values of {len(self.probes)} outputs to tau = {float(self.until):g} would take "
                f"about {seconds:.0f} s, the limit is {MOST_SECONDS} (fewer outputs, samples or load times help)"
            )

    @property
    def stretches(self) -> int:
        """How many stretches of all joints waves are made of."""
        return self._breakpoints.stretches

    def starts(self, probe: Probe) -> Sequence[fmpq]:
        """Where its segments start: where it may jump or bend, and 0."""
        return self._breakpoints.of_output(self._model.sums[probe])

    def _integrates(self, probe: Probe) -> bool:
        return any(reading.order < 0 for _, reading in self._model.sums[probe])

    def segments(self, probe: Probe, bits: int, taus: Sequence[fmpq] | None = None) -> list[Segment]:
        """An output between its breakpoints, with so many bits, as polynomials (rate 0) in balls.

        Where `taus` are given, only those on which one of them lies, as far as the others are not needed.
        """
        starts = self.starts(probe)
        wanted: Sequence[int] = range(len(starts))
        if taus is not None and not self._integrates(probe):
            wanted = sorted({bisect_right(starts, tau) - 1 for tau in taus})
        vague = self._vague(starts)
        with ctx.workprec(bits):
            made = self._walk(probe, bits, starts, wanted)
            return [replace(each, vague=True) if vague[k] else each for k, each in zip(wanted, made, strict=True)]

    def walk(self, probe: Probe) -> Iterator[Segment]:
        """The same one by one, for whoever looks at the first ones: with the `first_bits`, which the caller sets."""
        starts = self.starts(probe)
        return self._walk(probe, self.first_bits, starts, range(len(starts)))

    def _walk(self, probe: Probe, bits: int, starts: Sequence[fmpq], wanted: Iterable[int]) -> Iterator[Segment]:
        ends = [*starts[1:], self.until]
        begins = self._smooth_starts[self.probes.index(probe)]
        stretches = ((starts[k], ends[k]) for k in wanted)
        return _segments(self.waves(bits), self._model, probe, stretches, begins, self._shifts.for_output())

    def _vague(self, starts: Sequence[fmpq]) -> list[bool]:
        """Whether what contacts do may be left open from each of these to the next, and no double lies there.

        One lies on the last stretch: it ends with that of the horizon.
        """
        if (known := self._breakpoints.schedule) is None:
            return [False] * len(starts)
        short = (high - low <= known.vague and not_below(low) == not_below(high) for low, high in pairwise(starts))
        return [*short, False]

    @cached_property
    def _smooth_starts(self) -> Sequence[fmpq | None]:
        return smooth_starts(self._model, self.until)

    def waves(self, bits: int) -> Waves:
        """What needs more bits, and so more terms, costs the others nothing."""
        if bits not in self._solved:
            if (size := self.size_in(bits)) > _LARGEST:
                raise CostError(
                    f"output.until: the waves of {self._breakpoints.label} with {bits} bits would take {size:.1e} "
                    f"bytes, the limit is {_LARGEST:.1e} (a shorter horizon or fewer load times help)"
                )
            self._solved[bits] = self._waves(bits)
        return self._solved[bits]

    def size_in(self, bits: int) -> int:
        """About how many bytes the waves take with so many bits."""
        return self._breakpoints.size(self.terms(bits), bits)

    def _waves(self, bits: int) -> Waves:
        if (known := self._breakpoints.schedule) is not None:
            from wavesym.exact.contacts.schedule import waves  # of contacts, which few scenes have

            return waves(self._network, self._acting, known, bits)
        with ctx.workprec(bits):
            return NetworkWaves(
                self._network,
                self._breakpoints.joints,
                self._acting,
                self.terms(bits),
                derivatives=any(reading.order > 0 for reading in self._model.gauges),
            )


def _segments(
    waves: Waves,
    model: Model,
    probe: Probe,
    stretches: Iterable[tuple[fmpq, fmpq]],
    begins: fmpq | None,
    shifts: _Shifts,
) -> Iterator[Segment]:
    """An output on each of these stretches, which come in order; where it `begins` it is 0."""
    terms = model.sums[probe]
    plain, summed = (
        list(_channels(waves, (each for each in terms if (each.reading.order < 0) == below and each.reading.moves)))
        for below in (False, True)
    )
    loads = [
        (weight, LoadPolynomial(model.network, reading.point, model.loads))
        for weight, reading in terms
        if reading.quantity == "load" and reading.point is not None
    ]
    constant = [
        (weight, Enclosure.from_polynomial(fmpq_poly([1])))
        for weight, each in terms
        if not each.rod and each.point is None
    ]
    displacement = arb(0)
    for start, end in stretches:
        acts = [(weight, Enclosure.from_polynomial(load.polynomial_from(start))) for weight, load in loads]
        polynomial = _ball_polynomial(_sum([*_values(waves, plain, start, shifts), *acts, *constant]))
        if summed:
            integral = _ball_polynomial(_sum(_values(waves, summed, start, shifts))).integral() + displacement
            displacement = integral(arb(end - start))
            polynomial = polynomial + integral
        if start == end:  # of what begins at the end of the horizon only the first value is seen
            polynomial = arb_poly(polynomial.coeffs()[:1])
        yield Segment(start, {fmpq(0): polynomial}, start == begins)


def _ball_polynomial(known: Enclosure) -> arb_poly:
    """Its polynomial with its error in the first coefficient."""
    return known.polynomial + arb(0, known.error) if known.error != 0 else known.polynomial


def _sum(parts: Iterable[tuple[fmpq, Enclosure]]) -> Enclosure:
    """A sum with factors; of what cancels nothing is left, where all of it is known exactly."""
    terms = list(parts)
    total = weighted_sum(terms)
    if total.error == 0 and all(c.contains(0) for c in total.polynomial.coeffs()):
        exact = [(factor, known.exact) for factor, known in terms if known.exact is not None]
        if len(exact) == len(terms) and sum((factor * p for factor, p in exact), fmpq_poly()).length() == 0:
            return STILL
    return total


class _Channel(NamedTuple):
    """So many times a wave, `delay` later; nothing where the `end` that it is read at has nothing beside it."""

    weight: fmpq
    wave: SentWave
    delay: fmpq
    end: End | None = None


def _channels(waves: Waves, terms: Iterable[ReadingTerm]) -> Iterator[_Channel]:
    """What sums of strains, velocities and accelerations are made of: the left-going wave of a rod less, or plus, the
    right-going one.
    """
    for weight, reading in terms:
        sent, points = (waves.rates, waves.accelerations) if reading.order > 0 else (waves.sent, waves.velocities)
        if reading.point is not None:
            yield _Channel(weight, points[reading.point].reader(), _ZERO)
            continue
        bar, end = waves.network.bars[reading.rod - 1], None
        if reading.place in (0, 1):
            end = End(reading.rod - 1, int(reading.place))
            if reading.quantity != "strain":
                if (point := waves.network.point_at(end)) in points:  # prescribed: as exact as it is given
                    yield _Channel(weight * bar.ratios[end.side], points[point].reader(), _ZERO)
                    continue
                end = None
        for sender, factor, delay in reading.waves(waves.network):
            yield _Channel(weight * factor, sent[sender].reader(), delay, end)


class _Shifts:
    """What is shifted for an output, kept for the next one: at the same place that asks for the same again."""

    def __init__(self) -> None:
        self._before: dict[tuple[int, fmpq, int], tuple[Enclosure, Enclosure]] = {}
        self._now = self._before

    def for_output(self) -> _Shifts:
        """The same, without what the output before the last one asked for."""
        self._before, self._now = self._now, {}
        return self

    def shift(self, known: Enclosure, by: fmpq) -> Enclosure:
        """As `enclosure.shift`."""
        key = id(known), by, ctx.prec  # an id stays its own, as what has it is kept
        found = self._now.get(key) or self._before.get(key) or (known, shift(known, by))
        self._now[key] = found
        return found[1]


def _values(
    waves: Waves, channels: Iterable[_Channel], start: fmpq, shifts: _Shifts
) -> Iterator[tuple[fmpq, Enclosure]]:
    """What channels carry from tau = `start` on, with factors."""
    for weight, wave, delay, end in channels:
        if end is None or not waves.is_bare(end, start):
            yield weight, shifts.shift(*wave.locate(start - delay))


def waves_size(model: Model) -> int:
    """About how many bytes the waves take."""
    try:
        motion = Motion(model, rational(model.horizon()))
    except (CostError, UnservedError):
        return _LARGEST
    return motion.size_in(motion.first_bits)
