"""What modes have to do with loads and outputs, as arrays, and what all modes together have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import fsum

import numpy as np
from flint import acb, arb, ctx, fmpq

from wavesym.exact.modes.cuts import Cut
from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.statics import Shape, Statics
from wavesym.exact.modes.stiffness import Quantity
from wavesym.mechanics.network import End, Network
from wavesym.numbers.doubles import nearest
from wavesym.programs.modes.modal import Numbers
from wavesym.programs.modes.watched import Driver, Seen

_BITS = 256
_ULPS = 16 * 2.0**-53  # of a sum of squares, each of which is rounded a few times


@dataclass(frozen=True)
class Shares:
    """Modes by columns: `w`, what outputs are of them (`seen`), their shares in loads; and sums over all modes.

    `imposed` and `static`, (outputs, loads): what an output is of the shape that a load imposes, and under it when it
    does not change. `powers` of outputs and loads: sums of squares are over w^(2 power), `totals` over all modes.
    """

    w: Numbers
    seen: Numbers
    shares: Numbers
    imposed: Numbers
    static: Numbers
    powers: tuple[Numbers, Numbers]
    totals: tuple[Numbers, Numbers]

    @cached_property
    def spare(self) -> tuple[Numbers, Numbers]:
        """Of each output, and each load, the sum of squares over all modes but the first k: (rows, modes + 1)."""
        seen, shares = (
            _spare(self.w, *each) for each in zip((self.seen, self.shares), self.powers, self.totals, strict=True)
        )
        return seen, shares

    def rest(self, count: int) -> Numbers:
        """What the modes after the first `count` do to the outputs under loads that do not change: (outputs, loads)."""
        w = np.where(self.w > 0, self.w, np.inf)[:count]
        made = np.empty_like(self.static)
        for j, share in enumerate(self.shares):
            terms = self.seen[:, :count] * (share[:count] / w / w)
            made[:, j] = [fsum([whole, *(-row).tolist()]) for whole, row in zip(self.static[:, j], terms, strict=True)]
        return made


def _spare(w: Numbers, rows: Numbers, powers: Numbers, totals: Numbers) -> Numbers:
    strained = np.where(w > 0, w, np.inf)
    made = np.zeros((len(rows), len(w) + 1))
    for row, power, total, out in zip(rows, powers, totals, made, strict=True):
        squares = np.where(w > 0, row, 0.0) ** 2 / (strained ** (2 * power) if power else 1.0)
        left = max(fsum([total, *(-squares).tolist()]), 0.0) + _ULPS * total
        out[-1], out[:-1] = left, left + np.cumsum(squares[::-1])[::-1] * (1 + _ULPS * len(w))
    return made


def shares(found: Sequence[Mode], pieces: Cut, seen: Sequence[Seen], drivers: Sequence[Driver]) -> Shares:
    """Those of the modes of a network that is cut."""
    network = pieces.network
    with ctx.workprec(_BITS):
        statics = Statics(found[0].stiffness)
        shapes = [_shapes(statics, driver) for driver in drivers]
        share_totals = [
            (static.points[driver.point] if imposed is None else statics.mass(imposed.points)) * driver.gain**2
            for driver, (imposed, static) in zip(drivers, shapes, strict=True)
        ]
        gains = [driver.gain for driver in drivers]
        return Shares(
            w=np.array([float(mode.frequency) for mode in found]),
            seen=np.array([_column(each, found) for each in seen]).reshape(len(seen), len(found)),
            shares=_array([[share(network, each, mode) for mode in found] for each in drivers], len(found)),
            imposed=_array(
                [
                    [arb(0) if s is None else each.of(s) * g for g, (s, _) in zip(gains, shapes, strict=True)]
                    for each in seen
                ],
                len(drivers),
            ),
            static=_array(
                [[each.of(s) * g for g, (_, s) in zip(gains, shapes, strict=True)] for each in seen], len(drivers)
            ),
            powers=(np.array([each.power for each in seen]), np.array([1 if s is None else 0 for s, _ in shapes])),
            totals=(_above([each.total(statics) for each in seen]), _above(share_totals)),
        )


def _column(output: Seen, found: Sequence[Mode]) -> list[float]:
    if len(output.points) == 1:  # so are most, of many modes
        ((point, weight),) = output.points.items()
        factor = nearest(weight)
        return [factor * float(mode.points[point]) for mode in found]
    return [float(output.of(mode)) for mode in found]


def _shapes(statics: Statics, driver: Driver) -> tuple[Shape | None, Shape]:
    """What a load imposes, and the shape under it when it does not change, both but for its gain."""
    if statics.stiffness.network.points[driver.point].motion is None:
        return None, statics.under({driver.point: fmpq(1)})
    imposed = statics.imposed(driver.point)
    return imposed, statics.accelerated(imposed)


def share(network: Network, driver: Driver, mode: Mode) -> Quantity:
    """The share of a mode of mass 1 in a load."""
    if network.points[driver.point].motion is None:
        return mode.points[driver.point] * driver.gain
    # what holds the end in the mode, over w^2, is the mass that both move together, the mode and what the end imposes
    pull = arb(0)
    for number, bar in enumerate(network.bars):
        if bar.left == driver.point:
            pull += mode.slope(End(number, 0)) * (bar.impedance * bar.ratios[0])
        if bar.right == driver.point:
            pull -= mode.slope(End(number, 1)) * (bar.impedance * bar.ratios[1])
    for link in network.links:
        if driver.point in (link.left, link.right):
            other = link.right if link.left == driver.point else link.left
            pull += mode.points[other] * (link.ratio * link.stiffness)
            if link.damping != 0:
                pull += mode.points[other] * (mode.frequency * acb(0, link.ratio * link.damping))
    return -pull * driver.gain / (mode.frequency * mode.frequency)


def _array(rows: list[list[arb]], columns: int) -> Numbers:
    return np.array([[float(value) for value in row] for row in rows]).reshape(len(rows), columns)


def _above(values: Sequence[arb]) -> Numbers:
    """Doubles that are not below."""
    return np.asarray(np.nextafter([float(value.upper()) for value in values], np.inf), np.float64)
