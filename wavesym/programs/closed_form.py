"""The closed form: the paper's sums of increments in double arithmetic, with a proof of how far it can be trusted.

For tau between two arrivals an output is the sum, over all arrivals so far, of sum_g exp(-g w) sum_k c_k w**k. That is
what the generated program adds up, oldest first: w as the sum of two doubles, the powers by Horner's rule. With u the
unit roundoff 2**-53, a term c_k w**k exp(-g w) is wrong by at most (to first order, times its absolute value)

    c_k rounded                     1 u         w, twice rounded       2 k u + 2 g w u
    Horner's rule                   (2 k + 1) u   g rounded, g w rounded   2 g w u
    exp, within two ulp             4 u         times the polynomial   1 u      and 1 u for every later addition.

What underflows is wrong by at most the smallest number of the format instead, before powers of w multiply it: once for
each c_k and each step of Horner's rule, and for g, g w and exp on top of the whole polynomial.

The weighted absolute values are themselves exponential polynomials without negative coefficients, so that they merge
from segment to segment as the output does, and their largest value on a segment is known term by term. Where terms
cancel (many reflections, nearly equal rates) this bound grows without the output growing: there the form ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import pairwise

from flint import arb, arb_poly, fmpq

from wavesym.exact.tables.ball import largest, segments, shift
from wavesym.exact.tables.signal import Signal
from wavesym.numbers.doubles import bound, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.form import Form
from wavesym.programs.program import ProgramOutput
from wavesym.programs.tables import Tables, firsts

_EXP = 20  # an exponential, in multiplications
# all that is of second order in u but for additions, as long as no factor of u reaches 1/1000
_SECOND_ORDER = arb(fmpq(1001, 1000))
_MOST_ADDED = arb(fmpq(1, 2))  # additions, in 1/u


@dataclass(frozen=True)
class PulseFamily:
    """exp(-rate w) * (powers[0] + powers[1] w + ...)."""

    rate: float
    powers: tuple[float, ...]


@dataclass(frozen=True)
class Pulse:
    """What is added from tau = `start` on, in w = (tau - start) + excess: the arrival was `excess` before `start`."""

    start: float
    excess: float
    families: tuple[PulseFamily, ...]


@dataclass(frozen=True)
class ClosedOutput(ProgramOutput):
    """One output as a sum of pulses; `pulse_bounds[n]` is its bound up to the end of pulse n."""

    pulses: tuple[Pulse, ...]
    pulse_bounds: tuple[float, ...]


@dataclass(frozen=True)
class ClosedForm(Form):
    """The closed form of a scene's outputs on [0, tau_max]."""

    KERNEL = "closed"

    outputs: tuple[ClosedOutput, ...]
    tau_max: float
    real: Real

    @cached_property
    def work(self) -> float:
        """About how many operations a value takes, at the end of the horizon and for the mean output."""
        families = [family for output in self.outputs for pulse in output.pulses for family in pulse.families]
        return sum(_EXP + len(family.powers) for family in families) / len(self.outputs)

    @property
    def bytes(self) -> int:
        """The size of the tables, with indices of 4 bytes."""
        pulses = [pulse for output in self.outputs for pulse in output.pulses]
        families = [family for pulse in pulses for family in pulse.families]
        numbers = 2 * len(pulses) + sum(1 + len(family.powers) for family in families)
        return numbers * self.real.bytes + 4 * (len(self.outputs) + len(pulses) + len(families) + 3)

    @property
    def summary(self) -> str:
        """What it is, in a few words."""
        return f"closed, {sum(len(output.pulses) for output in self.outputs)} pulses, bound {self.error_bound:g}"

    def shortfall(self, tolerance: fmpq) -> str:
        """Why it does not meet a tolerance: how many digits are lost, from which tau on."""
        since = min(
            pulse.start
            for output in self.outputs
            for pulse, reached in zip(output.pulses, output.pulse_bounds, strict=True)
            if not (math.isfinite(reached) and rational(reached) <= tolerance)
        )
        lost = math.log10(self.worst.bound / float(self.real.roundoff))
        digits = "all" if self.worst.bound >= 1 else str(math.ceil(lost))
        return f"closed: loses {digits} digits after tau = {since:g} (bound {self.worst.bound:g} for {self.worst.name})"

    @cached_property
    def check_points(self) -> list[float]:
        """0, every start of a pulse, the last double before it, the middle between two of them, and tau_max."""
        starts = sorted({0.0, self.tau_max} | {pulse.start for output in self.outputs for pulse in output.pulses})
        points = set(starts)
        for start, end in pairwise(starts):
            middle = self.real.nearest(rational(start) / 2 + rational(end) / 2)
            points |= {middle, self.real.next_after(end, start)}
        return sorted(points)

    @property
    def tables(self) -> Tables:
        """Of output o the pulses first_pulse[o] ... in order of their start; of each its families, of these the powers.

        `coefficient` has the powers of a family, lowest first.
        """
        pulses = [pulse for output in self.outputs for pulse in output.pulses]
        families = [family for pulse in pulses for family in pulse.families]
        return {
            "first_pulse": firsts(len(output.pulses) for output in self.outputs),
            "start": tuple(pulse.start for pulse in pulses),
            "excess": tuple(pulse.excess for pulse in pulses),
            "first_family": firsts(len(pulse.families) for pulse in pulses),
            "rate": tuple(family.rate for family in families),
            "first_power": firsts(len(family.powers) for family in families),
            "coefficient": tuple(power for family in families for power in family.powers),
        }

    @property
    def constants(self) -> dict[str, float]:
        """None."""
        return {}


def closed_form(signals: Sequence[Signal], tau_max: float, real: Real = DOUBLE) -> ClosedForm:
    """The closed form of signals, with its bounds, whatever they are.

    Args:
        signals: what arrives at each output, exact.
        tau_max: the last tau, a number of the format.
        real: the numbers of the program.
    """
    return ClosedForm(tuple(_closed_output(signal, tau_max, real) for signal in signals), tau_max, real)


def _closed_output(signal: Signal, tau_max: float, real: Real) -> ClosedOutput:
    pulses = []
    for arrival in signal.arrivals:
        start, increment = real.not_below(arrival.time), arrival.increment
        powers = {rate: tuple(map(real.nearest, increment[rate])) for rate in sorted(increment)}
        families = tuple(PulseFamily(real.nearest(rate), of) for rate, of in powers.items())
        pulses.append(Pulse(start, real.nearest(rational(start) - arrival.time), families))
    if not pulses:
        return ClosedOutput(signal.name, 0.0, 0.0, (), ())
    size = largest(partial(segments, signal), tau_max)
    errors = [
        bound(error / size) if error is not None else math.inf
        for error in _segment_errors(signal, rational(tau_max), real)
    ]
    reached = tuple(max(errors[: n + 1]) for n in range(len(errors)))
    return ClosedOutput(signal.name, reached[-1], float(size), tuple(pulses), reached)


def _segment_errors(signal: Signal, until: fmpq, real: Real) -> list[arb | None]:
    """Upper bounds of the absolute error on each segment; None where sums might overflow, or are longer than 1/u."""
    u = arb(real.roundoff)
    # Horner's rule must stay within the exponents of the format
    largest_power = arb(real.largest) ** fmpq(7, 8)
    underflow = arb(0)  # the errors of all numbers so far that may be below the normal ones
    places: dict[fmpq, int] = {}  # of rates, in the two lists
    sizes: list[arb_poly] = []  # the absolute values of all terms so far
    weights: list[arb_poly] = []  # the same, each times its factor of u
    ends = [arrival.time for arrival in signal.arrivals[1:]] + [until]
    last = signal.arrivals[0].time
    representable = True
    additions = 0
    errors: list[arb | None] = []
    for arrival, end in zip(signal.arrivals, ends, strict=True):
        sizes, weights = (shift(places, each, arrival.time - last) for each in (sizes, weights))
        last = arrival.time
        for rate, powers in sorted(arrival.increment.items()):  # in the order in which programs add them
            polynomial = arb_poly([abs(arb(c)) for c in powers])
            if (place := places.setdefault(rate, len(places))) == len(sizes):
                sizes.append(arb_poly())
                weights.append(arb_poly())
            sizes[place] += polynomial
            weights[place] += _weigh(rate, polynomial)
            farthest = arb(until - last).max(arb(1))
            representable &= bool(polynomial(farthest) < largest_power)
            underflow += arb(real.smallest) * _underflows(polynomial, farthest)
            # every family is one more addition for all that came before it
            additions += 1
            weights = [weight + size for weight, size in zip(weights, sizes, strict=True)]
        length = arb(end - arrival.time)
        error = sum(
            (_largest(rate, polynomial, length) for rate, polynomial in zip(places, weights, strict=True)), arb(0)
        )
        # (1 + u)**n - 1 <= n u / (1 - n u)
        representable &= bool(additions * u < _MOST_ADDED)
        errors.append((error * u * _SECOND_ORDER / (1 - additions * u) + underflow) if representable else None)
    return errors


def _underflows(polynomial: arb_poly, farthest: arb) -> arb:
    """What a family can lose by underflow for w <= `farthest` (at least 1), in smallest numbers."""
    terms = arb_poly([4 * c + 2 for c in polynomial.coeffs()])
    return (farthest * terms(farthest)).upper()


def _weigh(rate: fmpq, polynomial: arb_poly) -> arb_poly:
    """Every term times its factor of u in the module's table: 7 + 4 k + 4 g w."""
    powers = [(7 + 4 * k) * c for k, c in enumerate(polynomial.coeffs())]
    return arb_poly(powers) + arb_poly([arb(0), 4 * arb(rate)]) * polynomial


def _largest(rate: fmpq, polynomial: arb_poly, length: arb) -> arb:
    """An upper bound of exp(-rate w) polynomial(w), coefficients >= 0, on [0, length]: each term's largest, summed."""
    total = arb(0)
    for k, c in enumerate(polynomial.coeffs()):
        peak = length if rate == 0 else length.min(arb(fmpq(k) / rate))
        total += c * peak**k * (-arb(rate) * peak).exp()
    return total.upper()
