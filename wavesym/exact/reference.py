"""The reference: values of a model's outputs that are right to the last bit, whatever they cost.

Two routes lead there, and both are balls: the exact tables, where they are of moderate size, and power series from
breakpoint to breakpoint, where they are not (many unequal rates, many reflections).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, partial

from flint import arb, fmpq

from wavesym.errors import CostError, RangeError, UnservedError
from wavesym.exact.contacts.events import what_helps
from wavesym.exact.motion import NEGLIGIBLE_WAVE, Motion, waves_size
from wavesym.exact.tables.ball import Balls, Source, largest, segments, values
from wavesym.exact.tables.signal import Signal, refuse_many, signals
from wavesym.mechanics.model import Model
from wavesym.numbers.balls import FIRST_BITS
from wavesym.numbers.doubles import not_below, rational
from wavesym.numbers.reals import DOUBLE, Real

# bytes of waves that are known in a second or two
_QUICK = 10**8
# coefficients of the tables from which on power series are cheaper
_MODERATE = 50_000
_SHORTEST = fmpq(8)
# more bits tell nothing more where contacts open and close
_MOST_KNOWN = 2048


def beginning(model: Model) -> Model:
    """The model, or as much of its horizon as takes little time to know exactly."""
    until = model.until
    while until > _SHORTEST and waves_size(model.shorten(until)) > _QUICK:
        until = max(_SHORTEST, fmpq((3 * until / 4).floor()))
    return model.shorten(until)


class Reference:
    """The outputs of a model on its horizon in `real` numbers, in balls. CostError where that would cost too much."""

    def __init__(self, model: Model, real: Real = DOUBLE) -> None:
        self.model = model
        self.real = real
        self.tau_max = model.horizon(real)

    @cached_property
    def signals(self) -> tuple[Signal, ...] | None:
        """The outputs as exact sums of arrivals; None where their tables would be large."""
        try:
            refuse_many(self.model, _MODERATE)
            return signals(self.model, _MODERATE, self.real)
        except (CostError, UnservedError):
            return None

    @cached_property
    def _motion(self) -> Motion:
        return Motion(self.model, rational(self.tau_max))

    def _sources(self, taus: Sequence[float] | None = None) -> list[Source]:
        """The outputs, or as much of them as values at `taus` need."""
        if self.signals is not None:
            return [partial(segments, signal) for signal in self.signals]
        exact = None if taus is None else [rational(tau) for tau in taus]
        return [partial(self._motion.segments, probe, taus=exact) for probe in self._motion.probes]

    @property
    def _first_bits(self) -> int:
        return FIRST_BITS if self.signals is not None else self._motion.first_bits

    def values(self, taus: Sequence[float]) -> list[list[float]]:
        """Each output at doubles 0 <= tau <= tau_max, correctly rounded. RangeError where one is beyond all doubles."""
        if self.signals is None:
            self._motion.refuse_long(len(taus))
        try:
            if self.model.network.corners:
                most = max(self._first_bits, _MOST_KNOWN)
                return [
                    values(source, taus, self._first_bits, size * NEGLIGIBLE_WAVE, most)
                    for source, size in zip(self._sources(taus), self._known_sizes, strict=True)
                ]
            return [values(source, taus, self._first_bits) for source in self._sources(taus)]
        except RangeError:
            raise
        except ArithmeticError as error:
            helps = what_helps(self.model, self.real)
            raise CostError(f"output.until: for values right to the last bit, {error} ({helps} helps)") from None

    @cached_property
    def _known_sizes(self) -> list[arb]:
        """What outputs come to at most where contacts open and close: values are known to 2^-200 of that.

        An output that may be 0 throughout is as large as waves are.
        """
        found = [Balls(whole(self._first_bits)).largest(rational(self.tau_max)) for whole in self._sources()]
        return [size if size > 0 else self._motion.size for size in found]

    def largest(self) -> list[arb]:
        """A lower bound of the largest absolute value of each output; 0 where it is 0 throughout.

        It is 0, too, where contacts open and close and nothing is more than 2^-200 of the largest wave.
        """
        vanishes = self._motion.vanishes if self.model.network.corners else lambda sizes: False
        return [largest(source, self.tau_max, self._first_bits, vanishes) for source in self._sources()]

    def breakpoints(self) -> list[float]:
        """All tau at which an output may jump or bend, as doubles at or just above."""
        starts = {segment.start for source in self._sources() for segment in source(self._first_bits)}
        return sorted(not_below(start) for start in starts)
