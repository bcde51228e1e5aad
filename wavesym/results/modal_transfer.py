"""The transfer functions of a model whose modes have damping ratios of their own: sums over modes, as balls.

A mode of mass 1 with shares l in an output and f in a load answers by l f/(w_n^2 - w^2 + 2 i z w_n w). What it would
do if the load did not change, l f/w_n^2, is known for all modes together, so that of those left out there remains

    |l f (w^2 - 2 i z w_n w)/(w_n^2 (w_n^2 - w^2 + 2 i z w_n w))| <= |l f| (w^2 + 2 z w_n w)/(w_n^2 (w_n^2 - w^2))

which is summed by Cauchy and Schwarz, as sums of squares over all modes are known too (exact/modes/statics.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from flint import acb, acb_series, arb, fmpq

from wavesym.exact.modes.harmonic import Quantity
from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.statics import Statics
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import midpoint
from wavesym.programs.modes.projection import Driver, modal_output, share
from wavesym.programs.modes.undamped_modes import UndampedModes, damping_ratios
from wavesym.results.transfer import ORDERS, HarmonicLoad, drive

_I = acb(0, 1)


class ModalDrive(NamedTuple):
    """What one point is driven by.

    `shares[k][n]` is l f of output k in mode n. `imposed_shape` (None under a force) and `static` are the outputs of
    the shape that a motion imposes, and under the load when it does not change. Of the modes left out the sum of |l f|
    over a power of w_n is at most `truncation[k]`, with that `powers[k]`.
    """

    point: int
    coefficients: tuple[fmpq, ...]
    shares: list[list[arb]]
    imposed_shape: list[arb] | None
    static: list[arb]
    truncation: list[arb]
    powers: list[int]


@dataclass(frozen=True)
class ModalTransfer:
    """The outputs of a model under one unit of a load, as functions of the frequency: the first `count` modes."""

    modes: UndampedModes
    load: HarmonicLoad
    count: int

    @property
    def model(self) -> Model:
        """Whose outputs they are."""
        return self.modes.model

    def __call__(self, w: Quantity) -> list[Quantity]:
        """The complex amplitudes of the outputs, without what `truncation_error` bounds.

        Args:
            w: the frequency in rad per tau: a ball, or a power series of complex ones about one that is not 0.

        Returns:
            One for each output, in its unit per unit of the load.
        """
        rate, square = w * _I, w * w
        answers = [
            _reciprocal(rate * (2 * ratio * n) - square + n * n) - (1 / (n * n) if n != 0 else 0)
            for n, ratio in zip(self._frequencies, self._ratios, strict=True)
        ]
        made: list[Quantity] = [acb(0) for _ in self.model.probes]
        for each in self._drives:
            for k, (probe, shares) in enumerate(zip(self.model.probes, each.shares, strict=True)):
                moved = sum(
                    (answer * share for share, answer in zip(shares, answers, strict=True)), acb(each.static[k])
                )
                order = ORDERS.get(probe.quantity, 0)
                made[k] = made[k] + self._acting(each, rate, order) * moved
                if each.imposed_shape is not None:
                    made[k] = made[k] + self._acting(each, rate, order - 2) * each.imposed_shape[k]
        return made

    def has_pole(self, k: int, low: arb, high: arb) -> bool:
        """Whether output k is proved to have a pole between two frequencies: one of an undamped mode."""
        for number, (n, ratio) in enumerate(zip(self._frequencies, self._ratios, strict=True)):
            if ratio == 0 and low < n < high:
                driven = (self._acting(each, n * _I) * each.shares[k][number] for each in self._drives)
                if not sum(driven, start=acb(0)).contains(0):
                    return True
        return False

    def parts(self, w: Quantity) -> None:
        """It is no fraction, but a sum."""

    def lowest_terms(self, k: int) -> None:
        """It is no fraction, but a sum."""

    def truncation_error(self, w: arb) -> list[arb]:
        """What all modes after the first `count` can add to the amplitude of each output; None where that is open.

        Args:
            w: the frequency in rad per tau; a wide ball stands for all in it.
        """
        last, most = self._frequencies[-1], self._largest_remaining_ratio
        made = [arb(0) for _ in self.model.probes]
        if len(self._frequencies) < self.count:
            return made  # there are no more
        if not last > w:
            return [arb("inf") for _ in made]
        rate = acb(0, w)
        for each in self._drives:
            acting = abs(self._acting(each, rate))
            for k, (left, power) in enumerate(zip(each.truncation, each.powers, strict=True)):
                order = ORDERS.get(self.model.probes[k].quantity, 0)
                most_of_one = last ** (power - 2) * (w * w + 2 * most * last * w) / (last * last - w * w)
                made[k] += acting * left * most_of_one * w**order
        return made

    def _acting(self, each: ModalDrive, rate: Quantity, order: int = 0) -> Quantity:
        """The force on the point, or its acceleration, differentiated `order` times."""
        moves = self.model.network.points[each.point].motion == "velocity"
        return drive(each.coefficients, rate, order + moves)

    @cached_property
    def _mode_list(self) -> list[Mode]:
        return self.modes.spectrum.first(self.count)

    @cached_property
    def _frequencies(self) -> list[arb]:
        return [mode.frequency for mode in self._mode_list]

    @cached_property
    def _ratios(self) -> list[arb]:
        """The damping ratio of each mode; a motion without strain has none.

        UnservedError where two modes with one frequency have ratios of their own.
        """
        assert self.model.damping is not None  # who has none needs no modes
        damping_ratios(self.model.damping, [midpoint(n) for n in self._frequencies if n != 0])
        ratios = iter(self.model.damping.ratios)
        last = ratio = next(ratios)
        made = []
        for n in self._frequencies:
            made.append(arb(0) if n == 0 else arb(ratio))
            if n != 0:
                last = ratio
                ratio = next(ratios, last)
        return made

    @property
    def _largest_remaining_ratio(self) -> arb:
        """The greatest ratio of all modes after the first `count`."""
        assert self.model.damping is not None
        ratios = self.model.damping.ratios
        strained = sum(1 for n in self._frequencies if n != 0)
        return arb(max(ratios[min(strained, len(ratios) - 1) :]))

    @cached_property
    def _drives(self) -> list[ModalDrive]:
        found, cut = self._mode_list, self.modes.spectrum.cut
        statics = Statics(found[0].stiffness)
        outputs = [modal_output(self.model.network, cut, probe) for probe in self.model.probes]
        values = [[output.value(mode) for mode in found] for output in outputs]
        made = []
        for point, coefficients in self.load.drives:
            driver = Driver(point, fmpq(1), "", "")
            shares = [share(cut.network, driver, mode) for mode in found]
            if self.model.network.points[point].motion is None:
                imposed, static, power = None, statics.loaded_shape({point: fmpq(1)}), 1
                total = static.points[point]
            else:
                imposed = statics.imposed_shape(point)
                static, power, total = statics.lagging_shape(imposed), 0, statics.mass(imposed.points)
            spare = self._spare(total, shares, power)
            left_out, powers = [], []
            for output, row in zip(outputs, values, strict=True):
                # as a displacement, whatever of it is the output
                wide = output.power if output.order < 2 else 1
                whole = output.total(statics) if output.order < 2 else statics.loaded_shape(output.points)
                whole = whole if isinstance(whole, arb) else arb(output.value(whole))
                left_out.append((self._spare(whole, row, wide) * spare).sqrt().upper())
                powers.append(wide + power)
            made.append(
                ModalDrive(
                    point,
                    coefficients,
                    [[one * other for one, other in zip(row, shares, strict=True)] for row in values],
                    None if imposed is None else [output.value(imposed) for output in outputs],
                    [output.value(static) for output in outputs],
                    left_out,
                    powers,
                )
            )
        return made

    def _spare(self, total: arb, row: list[arb], power: int) -> arb:
        """What is left of a sum of squares over w^(2 power) once the first modes are taken away: at least 0."""
        for value, n in zip(row, self._frequencies, strict=True):
            if n != 0:
                total = total - value * value / n ** (2 * power)
        return total.max(arb(0))


def _reciprocal(divisor: Quantity) -> Quantity:
    """One over it; not a number where it may be 0."""
    if isinstance(divisor, acb_series) and acb(divisor[0]).contains(0):
        return acb_series([acb("nan"), 0, 0], prec=3)
    return 1 / divisor
