"""A chain without dashpots: its modes swing, or are damped by ratios, each by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wavesym.exact.modes.cuts import Cut
from wavesym.exact.modes.frequencies import Spectrum
from wavesym.programs.modes.chain import ModalChain
from wavesym.programs.modes.damped import Damped, damped
from wavesym.programs.modes.modal import ModalSystem, Numbers
from wavesym.programs.modes.roughness import Roughness
from wavesym.programs.modes.shares import Shares, shares
from wavesym.programs.modes.tail import LeftOut
from wavesym.programs.modes.watched import places


@dataclass(frozen=True)
class SwingingChain(ModalChain[Shares]):
    """Its modes, and what those that are left out can add (tail.py)."""

    @cached_property
    def spectrum(self) -> Spectrum:
        return Spectrum(self.model.network, places(self.model))

    @property
    def cut(self) -> Cut:
        """The network with points wherever outputs are."""
        return self.spectrum.cut

    @cached_property
    def least(self) -> int:
        """As many modes as damping is said of, one more that has no strain, and one more to know a frequency of."""
        damping = self.model.damping
        return max(len(damping.ratios), *(damping.modes or (0,)), 0) + 2 if damping else 2

    def shares(self, count: int) -> Shares:
        """The first modes. UnservedError for what modes do not serve."""
        self.refuse()
        found = self.spectrum.first(count)
        return shares(found, self.cut, self.seen, self.drivers)

    def rule(self, known: Shares) -> Damped:
        """The damping of all modes."""
        return damped(self.model.damping, known.w[known.w > 0].tolist())

    def tail(self, known: Shares, count: int) -> LeftOut:
        """The modes after the first `count`."""
        taken = known.w[:count]
        return LeftOut(self.rule(known), float(np.nextafter(taken[-1], 0.0)), int(np.count_nonzero(taken)))

    def errors(self, known: Shares, count: int, loads: Sequence[Roughness] | None = None) -> Numbers:
        """What the modes after the first `count` can add to each output, under its own or other `loads`."""
        tail, rest = self.tail(known, count), known.rest(count)
        left = [rows[:, count] for rows in known.spare]
        made = np.zeros(len(self.model.probes))
        for j, rough in enumerate(self.rough if loads is None else loads):
            declines = tail.declines(rough)
            for o, output in enumerate(self.seen):
                decline = declines[output.order]
                powers = known.powers[0][o] + known.powers[1][j]
                made[o] += np.sqrt(left[0][o] * left[1][j]) * decline.size * tail.w ** float(powers - decline.power)
                if tail.lags and output.order < 2:
                    made[o] += abs(rest[o, j]) * decline.size / tail.above**2
        return np.where(self.silent, 0.0, (1 + 1e-12) * made)

    def system(self, known: Shares, count: int) -> ModalSystem:
        """The system of the first `count` modes."""
        w, values, pushes = known.w[:count], known.seen[:, :count], known.shares[:, :count]
        tail, rule = self.tail(known, count), self.rule(known)
        rest = known.rest(count)
        orders = np.array([output.order for output in self.seen])[:, None]
        damping = rule.of(w)
        direct = np.zeros((*rest.shape, 3))
        for order in range(3):
            direct[:, :, 2 - order] += np.where(orders == order, known.imposed, 0.0)
        direct[:, :, 0] += np.where(orders == 2, values @ pushes.T, 0.0)
        if tail.lags:
            # the modes left out, each load's as one
            above = np.full(len(pushes), tail.above)
            w, damping = np.append(w, above), np.append(damping, rule.of(above))
            values = np.hstack([values, np.where(orders < 2, rest, 0.0)])
            pushes = np.hstack([pushes, np.diag(above**2)])
        else:
            direct[:, :, 0] += np.where(orders == 0, rest, 0.0)
        moved = np.where(orders == 0, values, np.where(orders == 2, -w * w * values, 0.0))
        moving = np.where(orders == 1, values, np.where(orders == 2, -2 * damping * w * values, 0.0))
        heard = ~np.array(self.silent)
        return ModalSystem(
            w, damping, pushes.T.copy(), moved * heard[:, None], moving * heard[:, None], direct * heard[:, None, None]
        )
