"""The transfer functions of a model whose modes have damping ratios of their own: sums over modes, as balls.

A mode of mass 1 with shares l in an output and f in a load answers by l f/(w_n^2 - w^2 + 2 i z w_n w). What it would
do if the load did not change, l f/w_n^2, is known for all modes together, so that of those left out there remains

    |l f (w^2 - 2 i z w_n w)/(w_n^2 (w_n^2 - w^2 + 2 i z w_n w))| <= |l f| (w^2 + 2 z w_n w)/(w_n^2 (w_n^2 - w^2))

which is summed by Cauchy and Schwarz, as sums of squares over all modes are known too (exact/modes/statics.py).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from flint import acb, arb, fmpq

from wavesym.exact.modes.harmonic import Quantity, inverse
from wavesym.exact.modes.shape import Mode
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import midpoint
from wavesym.programs.modes.projection import Driver, ExactProjection, modal_output
from wavesym.programs.modes.undamped_modes import UndampedModes, damping_ratios
from wavesym.results.amplitude_polynomials import Transfers
from wavesym.results.transfer import ORDERS, HarmonicLoad, Transfer, laplace

_I = acb(0, 1)
_FIRST_MODES = 32
MOST_MODES = 2048
"""Whose responses are summed up."""


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
            inverse(rate * (2 * ratio * n) - square + n * n) - (1 / (n * n) if n != 0 else 0)
            for n, ratio in zip(self._frequencies, self._ratios, strict=True)
        ]
        made: list[Quantity] = []
        for probe, products, static, imposed in zip(
            self.model.probes, self._products, self._projection.static, self._projection.imposed_shape, strict=True
        ):
            order, total = ORDERS.get(probe.quantity, 0), acb(0)
            for drive_number, (point, coefficients) in enumerate(self.load.drives):
                pairs = zip(products[drive_number], answers, strict=True)
                moved = sum((answer * part for part, answer in pairs), acb(static[drive_number]))
                total = total + self._acting(point, coefficients, rate, order) * moved
                if self.model.network.points[point].motion is not None:
                    total = total + self._acting(point, coefficients, rate, order - 2) * imposed[drive_number]
            made.append(total)
        return made

    def has_pole(self, k: int, low: arb, high: arb) -> bool:
        """Whether output k is proved to have a pole between two frequencies: one of an undamped mode."""
        for number, (n, ratio) in enumerate(zip(self._frequencies, self._ratios, strict=True)):
            if ratio == 0 and low < n < high:
                pairs = zip(self.load.drives, self._products[k], strict=True)
                driven = (self._acting(*drive, n * _I) * row[number] for drive, row in pairs)
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
        (outputs, loads), powers = self._spare, self._projection.powers
        for drive, load, load_power in zip(self.load.drives, loads, powers[1], strict=True):
            acting = abs(self._acting(*drive, rate))
            for k, (output, output_power) in enumerate(zip(outputs, powers[0], strict=True)):
                left, power = (output * load).sqrt().upper(), output_power + load_power
                order = ORDERS.get(self.model.probes[k].quantity, 0)
                most_of_one = last ** (power - 2) * (w * w + 2 * most * last * w) / (last * last - w * w)
                made[k] += acting * left * most_of_one * w**order
        return made

    def _acting(self, point: int, coefficients: tuple[fmpq, ...], rate: Quantity, order: int = 0) -> Quantity:
        """The force on the point, or its acceleration, differentiated `order` times."""
        moves = self.model.network.points[point].motion == "velocity"
        return laplace(coefficients, rate, order + moves)

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
        ratios, strained = self.model.damping.ratios, [n for n in self._frequencies if n != 0]
        of_strained = [arb(ratios[min(k, len(ratios) - 1)]) for k in range(len(strained))]
        return [arb(0)] * (len(self._frequencies) - len(strained)) + of_strained

    @property
    def _largest_remaining_ratio(self) -> arb:
        """The greatest ratio of all modes after the first `count`."""
        assert self.model.damping is not None
        ratios = self.model.damping.ratios
        strained = sum(1 for n in self._frequencies if n != 0)
        return arb(max(ratios[min(strained, len(ratios) - 1) :]))

    @cached_property
    def _projection(self) -> ExactProjection:
        """Outputs as displacements, whatever of these they are."""
        found, network, cut = self._mode_list, self.model.network, self.modes.spectrum.cut
        outputs = [replace(modal_output(network, cut, probe), order=0) for probe in self.model.probes]
        return ExactProjection(found, outputs, [Driver(point, fmpq(1), "", "") for point, _ in self.load.drives])

    @cached_property
    def _products(self) -> list[list[list[arb]]]:
        """l f of each output, each point that is driven, and each mode."""
        return [
            [[one * other for one, other in zip(row, shares, strict=True)] for shares in self._projection.shares]
            for row in self._projection.values
        ]

    @cached_property
    def _spare(self) -> tuple[list[arb], list[arb]]:
        """What is left of sums of squares over w^(2 power) once the first modes are taken away: at least 0."""
        known = self._projection
        outputs, loads = (
            [
                sum((-x * x / n ** (2 * power) for x, n in zip(row, self._frequencies, strict=True) if n != 0), total)
                for row, power, total in zip(rows, powers, totals, strict=True)
            ]
            for rows, powers, totals in zip((known.values, known.shares), known.powers, known.totals, strict=True)
        )
        return [each.max(arb(0)) for each in outputs], [each.max(arb(0)) for each in loads]


def transfers(model: Model, load: HarmonicLoad, last: arb, times: int) -> Iterator[tuple[Transfers, list[arb]]]:
    """The transfer functions, and what modes left out may add to each of them up to a `last` frequency.

    Where each mode has a damping ratio of its own they come again and again, with so many times as many modes.
    """
    if model.damping is None or model.damping.modes is not None or not model.damping.acts:
        yield Transfer(model, load), [arb(0) for _ in model.probes]
        return
    modes, count = UndampedModes(model), _FIRST_MODES
    while count <= MOST_MODES:
        transfer = ModalTransfer(modes, load, count)
        yield transfer, transfer.truncation_error(last)
        count *= times
