"""Modes of a chain without dashpots, undamped or with damping ratios of their own; and the truncation error: proved.

Let f be a load, linear between instants, and e what a mode does from the displacement 1. Without what the load would do
if it did not change, a mode of mass 1 that has the share b of the load moves by b/w^2 times r, r' and r'' follow:

    r(tau) = -integral of f'(s) e(tau - s)

Kinks d_k of the load at t_k each add a swing of d_k/w times exp(-damping w (tau - t_k)), over sqrt(1 - damping^2), and
what does not swing is at most 2 damping/w times the steepest slope of f. With damping of 1 and more e has no more sign
than one, and |r| <= 2 damping/w times the steepest. So r is at most c/w, r' at most c', r'' at most c'' w.

Rayleigh's damping a/w + b w grows: all high modes lag behind the load alike. What they do is one more oscillator for
each load, which is far above them, and the rest is smaller by another 1/w^2: of y + b y' = f differ the higher modes by
at most (2/b + a)/w^2 times the steepest.

The sum over all modes left out of |l_n b_n|/w_n^a is at most that of l_n^2/w_n^(2p) times that of b_n^2/w_n^(2q), under
a root, and the least w to the power p + q - a. These sums are known: over all modes in closed form
(exact/modes/statics.py), less those that are taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from wavesym.errors import UnservedError
from wavesym.exact.modes.frequencies import Spectrum
from wavesym.mechanics.damping import Damping
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.modes.loads import Roughness
from wavesym.programs.modes.modal_system import ModalSystem
from wavesym.programs.modes.projection import ExactProjection, Projection
from wavesym.programs.modes.truncation import ModalModel


@dataclass(frozen=True)
class DampingRatios:
    """`ratios` of the first modes with strain, and for all higher ones the last; or a/w + b w, halved, for all."""

    ratios: tuple[float, ...] = (0.0,)
    rayleigh: tuple[float, float] | None = None

    def ratios_at(self, w: Array) -> Array:
        """The ratios at ascending frequencies from the first on; 0 for a motion without strain."""
        strained = w > 0
        made = np.zeros(len(w))
        if self.rayleigh:
            a, b = self.rayleigh
            made[strained] = (a / w[strained] + b * w[strained]) / 2
        else:
            number = np.minimum(np.arange(np.count_nonzero(strained)), len(self.ratios) - 1)
            made[strained] = np.array(self.ratios)[number]
        return made

    def least(self, w: float, count: int) -> float:
        """The least ratio of all modes with a frequency of at least w, which follow after `count` with strain."""
        if not self.rayleigh:
            return min(self.ratios[min(count, len(self.ratios) - 1) :])
        a, b = self.rayleigh
        return sqrt(a * b) if b * w * w < a else (a / w + b * w) / 2

    def most(self, count: int) -> float:
        """The largest ratio of these modes."""
        return inf if self.rayleigh else max(self.ratios[min(count, len(self.ratios) - 1) :])


def damping_ratios(damping: Damping | None, w: Sequence[float]) -> DampingRatios:
    """What a scene says of damping, for modes whose first frequencies with strain are w.

    UnservedError where two modes with one frequency have ratios of their own, as then it is open which modes they are,
    and where there are not as many as it names.
    """
    if damping is None:
        return DampingRatios()
    ratio = nearest(damping.ratios[0])
    if damping.modes is None or ratio == 0:
        ratios = tuple(map(nearest, damping.ratios))
        for number, (one, other) in enumerate(pairwise(ratios[: len(w)]), 1):
            if one != other and w[number - 1] == w[number]:
                raise UnservedError(
                    f"system.damping: {one:g} and {other:g} for modes {number} and {number + 1}, which have one "
                    f"frequency, {w[number]:g} (write the same ratio for both)"
                )
        return DampingRatios(ratios)
    if max(damping.modes) > len(w):
        raise UnservedError(f"system.damping.modes: {max(damping.modes)}, of {len(w)} modes with strain")
    first, second = (w[number - 1] for number in damping.modes)
    return DampingRatios(rayleigh=(2 * ratio * first * second / (first + second), 2 * ratio / (first + second)))


class Decline(NamedTuple):
    """A mode with shares l and b adds at most size |l b|/w^power."""

    size: float
    power: int


@dataclass(frozen=True)
class TruncatedModes:
    """The modes after the first `count` with strain, none of which has a frequency below w."""

    ratios: DampingRatios
    w: float
    count: int

    def declines(self, load: Roughness) -> tuple[Decline, Decline, Decline]:
        """Of what a load does to their displacements (beyond statics, or the lag), velocities and accelerations."""
        steep, least = load.steepest, self.ratios.least(self.w, self.count)
        if self.ratios.rayleigh:
            a, b = self.ratios.rayleigh
            late = steep * (2 / b + a)
            return Decline(late / min(1.0, least) ** 2, 4), Decline(4 * late / b, 4), Decline(4 * steep / b, 2)
        most = self.ratios.most(self.count)
        swing = inf
        if most < 1:
            swing = (load.swing(least * self.w) if most else load.in_step) / sqrt(1 - most * most)
        crept = steep / least if least else inf
        return (
            Decline(min(swing + 2 * most * steep, max(2 * crept, 2 * most * steep)), 3),
            Decline(min(steep + swing, crept / least if least < 1 else steep) if least else steep + swing, 2),
            Decline(min(swing, 2 * crept), 1),
        )

    @property
    def lags(self) -> bool:
        """Whether they lag behind a load alike."""
        return self.ratios.rayleigh is not None

    @property
    def above(self) -> float:
        """The frequency of the oscillator that stands for all of them where they lag alike."""
        return 8 * self.w


@dataclass(frozen=True)
class UndampedModes(ModalModel[Projection]):
    """Its modes, and the truncation error of those that are left out."""

    SPECTRUM = Spectrum

    @cached_property
    def least(self) -> int:
        """As many modes as damping is said of, one more that has no strain, and one more to know a frequency of."""
        damping = self.model.damping
        return max(len(damping.ratios), *(damping.modes or (0,)), 0) + 2 if damping else 2

    def project(self, count: int) -> Projection:
        """The first modes. UnservedError for what modes do not serve."""
        self.refuse()
        found = self.spectrum.first(count)  # only then it is known how bars are cut
        pushed = [each for each in self.drivers if self.cut.network.points[each.point].motion is None]
        for probe in self.massless_accelerations():
            if pushed:
                raise UnservedError(
                    f"output.acceleration: {probe.name}: modes support no place without mass under a force (write "
                    "one with mass, or a motion of the ground in place of the force, or take pieces or `run`)"
                )
        return ExactProjection(found, self.outputs, self.drivers).to_doubles()

    def rule(self, known: Projection) -> DampingRatios:
        """The damping of all modes."""
        return damping_ratios(self.model.damping, known.w[known.w > 0].tolist())

    def tail(self, known: Projection, count: int) -> TruncatedModes:
        """The modes after the first `count`."""
        taken = known.w[:count]
        return TruncatedModes(self.rule(known), float(np.nextafter(taken[-1], 0.0)), int(np.count_nonzero(taken)))

    def errors(self, known: Projection, count: int, loads: Sequence[Roughness] | None = None) -> Array:
        """What the modes after the first `count` can add to each output, under its own or other `loads`."""
        tail, rest = self.tail(known, count), known.rest(count)
        left = [rows[:, count] for rows in known.spare]
        made = np.zeros(len(self.model.probes))
        for j, rough in enumerate(self.roughness if loads is None else loads):
            declines = tail.declines(rough)
            for o, output in enumerate(self.outputs):
                decline = declines[output.order]
                powers = known.powers[0][o] + known.powers[1][j]
                made[o] += np.sqrt(left[0][o] * left[1][j]) * decline.size * tail.w ** float(powers - decline.power)
                if tail.lags and output.order < 2:
                    made[o] += abs(rest[o, j]) * decline.size / tail.above**2
        return np.where(self.zero_outputs, 0.0, (1 + 1e-12) * made)

    def system(self, known: Projection, count: int) -> ModalSystem:
        """The system of the first `count` modes."""
        w, values, pushes = known.w[:count], known.outputs[:, :count], known.shares[:, :count]
        tail, rule = self.tail(known, count), self.rule(known)
        rest = known.rest(count)
        orders = np.array([output.order for output in self.outputs])[:, None]
        damping = rule.ratios_at(w)
        direct = np.zeros((*rest.shape, 3))
        for order in range(3):
            direct[:, :, 2 - order] += np.where(orders == order, known.imposed_shape, 0.0)
        direct[:, :, 0] += np.where(orders == 2, values @ pushes.T, 0.0)
        if tail.lags:
            # the modes left out, each load's as one
            above = np.full(len(pushes), tail.above)
            w, damping = np.append(w, above), np.append(damping, rule.ratios_at(above))
            values = np.hstack([values, np.where(orders < 2, rest, 0.0)])
            pushes = np.hstack([pushes, np.diag(above**2)])
        else:
            direct[:, :, 0] += np.where(orders == 0, rest, 0.0)
        moved = np.where(orders == 0, values, np.where(orders == 2, -w * w * values, 0.0))
        moving = np.where(orders == 1, values, np.where(orders == 2, -2 * damping * w * values, 0.0))
        return ModalSystem(w, damping, pushes.T.copy(), moved, moving, direct).drop_outputs(self.zero_outputs)
