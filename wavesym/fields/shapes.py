"""Loads of a given shape: a sine, half of one, a decay, Ricker's pulse; as polynomials, or as lines between samples.

Polynomials (shape_polynomials.py) are a few, and as near to the shape as doubles are. What takes nothing but samples
(modes, programs with parameters at run time) has straight lines. A line between two samples is off by at most h^2/8
times the greatest second derivative, h the time between them. That is kept below a part of the tolerance, in parts of
the amplitude. Each sample is rounded once, to far less than that.

Where the travel times of a structure have a common measure, pieces and samples are a part or a multiple of it apart:
waves that they begin meet others then, and what has to be followed is what one rod has, however many there are. Half a
sine ends at a sample, and lasts too short to gain by that.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import cached_property
from math import ceil, sqrt
from typing import Annotated, Self

from flint import arb, ctx, fmpq, fmpq_poly
from pydantic import Field, PlainValidator, PrivateAttr, model_validator

from wavesym.errors import CostError
from wavesym.fields.loads import MOST_TIMES, Load, linear
from wavesym.fields.numbers import Exact, Positive, exact
from wavesym.fields.shape_polynomials import (
    BITS,
    CLOSE,
    DEGREE,
    DIGITS,
    RICKER,
    derivative_bound,
    interpolate,
    longest_piece,
    nearest_dyadic,
    value,
)
from wavesym.fields.table import refusal, show
from wavesym.mechanics.loads import AppliedLoad, power_source
from wavesym.numbers.doubles import fraction, middle, rational

SHAPES = {"sine": "frequency", "half-sine": "duration", "exponential": "duration", "ricker": "frequency"}
"""Each shape, and what says how fast it is."""
MOST_SAMPLES = MOST_TIMES
# where no tolerance is written, most samples of a load, and the largest tolerance: few samples if these are good enough
_USUAL = ((500, Fraction(1, 1000)), (2_000, Fraction(1, 100)))
_SHARE = Fraction(1, 4)  # of the tolerance
_ROUND = 20  # samples in a period are a multiple of it, so that tops and simple fractions are among them
_FINEST = 64  # of a common measure, that many fit between samples at most; a finer one is by chance
_RICKER_ENDS = Fraction(1, 10**15)  # of its amplitude, which is left out before and after: 78 exp(-4 pi^2) is 5.6e-16


def _shape(value: object) -> str:
    if isinstance(value, str) and value in SHAPES:
        return value
    *others, last = (f'"{shape}"' for shape in SHAPES)
    raise refusal(f"{show(value)} is not a shape; write {', '.join(others)} or {last}")


def _start(value: object) -> Fraction:
    start = exact(value)
    if start < 0:
        raise refusal(f"{show(value)} is before the start; write a time of 0 or later")
    return start


class ShapedLoad(Load):
    """A load of one shape, times its amplitude A, from its start on (t is the time since then), and 0 before:

    sine          A sin(2 pi f t)                                            until the horizon
    half-sine     A sin(pi t/D)                                              for the duration D
    exponential   A exp(-t/D), which jumps to A
    ricker        A (1 - 2 a^2) exp(-a^2), a = pi f (t - 2/f)                for 4/f
    """

    shape: Annotated[str, PlainValidator(_shape)] = Field(description=", ".join(SHAPES))
    amplitude: Exact = Field(description="a number")
    frequency: Positive | None = None
    duration: Positive | None = None
    start: Annotated[Exact, PlainValidator(_start)] = Fraction(0)

    _until: Fraction = PrivateAttr(default=Fraction(1))
    _tolerance: Fraction = PrivateAttr(default=Fraction(1, 10**10))
    _measure: Fraction = PrivateAttr(default=Fraction(0))
    _straight: bool = PrivateAttr(default=False)

    @model_validator(mode="after")
    def _check_frequency(self) -> Self:
        needed = SHAPES[self.shape]
        other = "duration" if needed == "frequency" else "frequency"
        if getattr(self, needed) is None:
            raise refusal(f"missing, and a {self.shape} has it; write a positive number", needed)
        if getattr(self, other) is not None:
            raise refusal(f"not of a {self.shape}; write {needed}", other)
        return self

    def truncate(
        self, until: Fraction, tolerance: Fraction, measure: Fraction = Fraction(0), *, straight: bool = False
    ) -> Self:
        """The same load as far as it matters to a horizon and a tolerance, on what travel times are multiples of.

        Args:
            until: the horizon in tau.
            tolerance: of the scene.
            measure: the common measure of all travel times in tau; 0 where there is none.
            straight: whether it acts as straight lines between samples, for what takes nothing else.
        """
        other = self.model_copy()
        for found in ("step", "_samples"):  # for another tolerance
            vars(other).pop(found, None)
        other._until, other._tolerance, other._measure, other._straight = until, tolerance, measure, straight
        return other

    @property
    def begin(self) -> Fraction:
        """The time of the first sample."""
        return self.start

    @property
    def degree(self) -> int:
        """That of its polynomials; 1 where it acts as straight lines."""
        return 1 if self._straight else DEGREE

    @property
    def period(self) -> Fraction:
        """The time in which it changes: 1/f, or D."""
        period = self.duration if self.frequency is None else 1 / self.frequency
        assert period is not None  # or the load was refused
        return period

    @property
    def error(self) -> Fraction:
        """How far what acts is from it at most, in parts of its amplitude: proved."""
        share = self._tolerance * _SHARE if self._straight else CLOSE
        left_out = {"exponential": share, "ricker": _RICKER_ENDS}.get(self.shape, Fraction(0))
        lines = fraction(middle(self._bend)) / 8 * (self.step / self.period) ** 2
        return (lines if self._straight else CLOSE) + left_out + Fraction(DEGREE, 2**DIGITS)

    @cached_property
    def step(self) -> Fraction:
        """The time between samples, or of a polynomial: a part or a multiple of the common measure, or else a whole
        part of the period."""
        needed = sqrt(float(self._bend) / (8 * float(self._tolerance * _SHARE)))
        longest = self.period * (1 / Fraction(needed) if self._straight else longest_piece(self.shape))
        round_, measure = _ROUND if self._straight else 1, self._measure
        if self.shape == "half-sine" or measure * _FINEST < longest:
            return self.period / (round_ * max(1, ceil(self.period / longest / round_)))
        if measure <= longest:
            return measure * (longest // measure)
        parts = ceil(measure / longest)
        return measure / (parts if parts < _ROUND else _ROUND * ceil(Fraction(parts, _ROUND)))

    @cached_property
    def _bend(self) -> arb:
        """The greatest second derivative for amplitude and period 1: not below it."""
        if self.shape == "ricker":  # at its top
            return (6 * arb.pi() ** 2).upper()
        return derivative_bound(self.shape, 2).upper()

    @property
    def _end(self) -> Fraction | None:
        """After how many periods it is 0, or so little that it does not matter; None for a sine."""
        left = _SHARE * self._tolerance if self._straight else CLOSE
        decays = ceil(float(left.denominator.bit_length()) * 0.7 + 1)
        ends = {"half-sine": Fraction(1), "ricker": Fraction(2 * RICKER), "exponential": Fraction(decays)}
        return ends.get(self.shape)

    @property
    def _last(self) -> Fraction:
        """How long it lasts, in periods; what comes after the horizon does not matter."""
        left = max(self._until - self.start, Fraction(0)) / self.period
        return left if self._end is None else min(left, self._end)

    @property
    def _steps(self) -> int:
        """How many lines, or polynomials, it is made of."""
        return ceil(self._last * self.period / self.step)

    @property
    def count(self) -> int:
        """How many samples it has."""
        return self._steps * (1 if self._straight else DEGREE) + 1

    @property
    def samples(self) -> tuple[fmpq, ...]:
        """Its values where lines, or polynomials, meet; after the last it is of no matter. CostError for too many."""
        size = rational(self.amplitude)
        return tuple(size * sample for sample in self._samples)

    @cached_property
    def _samples(self) -> tuple[fmpq, ...]:
        """Those of amplitude 1."""
        if self.count > MOST_SAMPLES:
            article = "an" if self.shape.startswith("e") else "a"
            tolerance, larger = "", ""
            if self._straight:
                enough = float(self._tolerance) * (self.count / MOST_SAMPLES) ** 2
                tolerance = f" for a tolerance of {float(self._tolerance):.1e}"
                larger = f"output.tolerance = {enough:.1e} or more, or "
            raise CostError(
                f"load: {self.count} samples of {article} {self.shape}{tolerance}, the limit is {MOST_SAMPLES} "
                f"({larger}fewer periods help)"
            )
        with ctx.workprec(BITS):
            each = rational(self.step / self.period)
            values = [nearest_dyadic(value(self.shape, arb(k * each))) for k in range(self._steps + 1)]
        if self.shape == "ricker":
            values[0] = fmpq(0)  # no jump
        if not self._straight and self._has_ended:
            values[-1] = fmpq(0)
        return tuple(values)

    @property
    def _has_ended(self) -> bool:
        """Whether it is over where its last polynomial ends."""
        return self._end is not None and self._steps * self.step >= self._end * self.period

    def units(self) -> Iterator[AppliedLoad]:
        """The load as unit responses."""
        if self._straight:
            return linear(self.start, self.step, self.polyline, self.sources)
        return self._changes()

    def _changes(self) -> Iterator[AppliedLoad]:
        """What changes where polynomials meet, by powers of the time since then."""
        samples, step, size = self._samples, rational(self.step), rational(self.amplitude)
        length, (constant, ramp) = rational(self.step / self.period), self.sources
        sources = (constant, ramp, *(power_source(ramp, power) for power in range(2, DEGREE + 1)))
        before = fmpq_poly()
        for k in range(len(samples)):
            if k + 1 < len(samples):
                now = size * interpolate(self.shape, k * length, length, (samples[k], samples[k + 1]))
            elif self._has_ended:
                now = fmpq_poly()
            else:
                return
            change = now - before
            for power, source in enumerate(sources):
                if change[power]:
                    yield AppliedLoad(source, rational(self.start) + k * step, change[power] / step**power)
            before = now(fmpq_poly([1, 1]))

    @property
    def polyline(self) -> tuple[fmpq, ...]:
        """Its samples, and the 0 that ends a decay."""
        return self.samples if self.shape in ("sine", "half-sine") else (*self.samples, fmpq(0))

    @property
    def description(self) -> str:
        """In a line."""
        pace = f"{SHAPES[self.shape]} {getattr(self, SHAPES[self.shape])}"
        return f"{self.shape} of amplitude {self.amplitude}, {pace}, from tau = {self.start}, {self.sampling}"

    @property
    def sampling(self) -> str:
        """How it is sampled, for people."""
        lines = "" if self._straight else f"{self._steps} polynomials of degree {DEGREE} through "
        return f"as {lines}{self.count} samples, within {float(self.error):.1e} of its amplitude"


def usual_tolerance(loads: Iterable[Load], until: Fraction, finest: Fraction, measure: Fraction) -> Fraction:
    """The tolerance of a scene that has none written: the finest, or what loads of a shape meet with few samples, as 1,
    2 or 5 times a power of ten: some hundreds, or some thousands where these do not do; else the finest.
    """
    shaped = [load for load in loads if isinstance(load, ShapedLoad)]
    steps = [Fraction(digit * 10**power) * finest for power in range(12) for digit in (1, 2, 5)]
    for most, coarsest in _USUAL:
        for tolerance in (each for each in steps if each <= coarsest):
            if all(load.truncate(until, tolerance, measure, straight=True).count <= most for load in shaped):
                return tolerance
    return finest
