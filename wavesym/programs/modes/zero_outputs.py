"""Outputs that are 0 throughout the horizon: where no load has come to, and where its effects cancel.

They cancel if what all loads together do to the output at a frequency w is 0 at every w: then each mode's part is 0,
damped or not. It is a rational function of w and of E = exp(-i w h), all delays being multiples of h. As in
exact/arrivals.py it is computed modulo a prime, one in which i is a number; at a random w and E what is not 0 is taken
for 0 with a chance of less than one in 2**70.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from flint import fmpq, fmpq_mat, fmpz_mod, fmpz_mod_ctx

from wavesym.exact.first_arrivals import light_arrivals
from wavesym.exact.modes.cuts import cut
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import common_measure
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.projection import Driver, ModalOutput, modal_output, places

_FIELD = fmpz_mod_ctx(2**127 - 39)
_W, _E = _FIELD(0x5EED_C0FFEE_1234_5678_9ABC_DEF0_1357), _FIELD(0x0DD_BA11_2468_ACE0_FACE_0FF5_1DE5)
_I = _FIELD(3) ** ((2**127 - 40) // 4)


def zero_outputs(model: Model, drivers: Sequence[Driver], loads: LinearLoads) -> tuple[bool, ...]:
    """Whether each output is: where no load has come to before the end of the horizon, or cancelled.

    Damped modes move the whole chain at once. Without any load outputs are 0 of themselves.
    """
    response, histories = _Response(model), _histories(loads)
    return tuple(
        (not model.is_damped and (first is None or first >= model.until)) or response.cancels(probe, drivers, histories)
        for probe, first in zip(model.probes, light_arrivals(model), strict=True)
    )


def _histories(loads: LinearLoads) -> list[list[fmpq]]:
    """Loads as sums of as few histories as will do: how much of each history is in each load."""
    if len(loads.slopes) == 1:
        return [[fmpq(1)]]
    rows, rank = fmpq_mat([list(row) for row in (*loads.samples, loads.slopes)]).rref()
    return [[rows[k, j] for j in range(len(loads.slopes))] for k in range(rank)]


class _Response:
    """What loads do to outputs at one w and E, modulo a prime."""

    def __init__(self, model: Model) -> None:
        self._network = model.network
        self._cut = cut(model.network, places(model))
        self._stiffness = Stiffness(self._cut.network)

    def cancels(self, probe: Probe, drivers: Sequence[Driver], histories: Sequence[Sequence[fmpq]]) -> bool:
        """Whether what the loads do to an output adds up to 0."""
        output = modal_output(self._network, self._cut, probe)
        done = [self._read(output, self._motion(driver)) for driver in drivers]
        zero = _FIELD(0)
        return all(
            sum((_modular(part) * each for part, each in zip(history, done, strict=True)), zero) == 0
            for history in histories
        )

    @cached_property
    def _circular(self) -> dict[fmpq, tuple[fmpz_mod, fmpz_mod]]:
        """sin and cos of w times each delay."""
        delays = {bar.delay for bar in self._cut.network.bars}
        measure = common_measure(delays)
        made = {}
        for delay in delays:
            forth = _E ** int(delay / measure)
            back = 1 / forth
            made[delay] = ((back - forth) / (2 * _I), (back + forth) / 2)
        return made

    def _motion(self, driver: Driver) -> list[fmpz_mod]:
        """How far points move under a load."""
        key = driver.point, driver.gain
        return self._known.get(key) or self._known.setdefault(key, self._solve(driver))

    @cached_property
    def _known(self) -> dict[tuple[int, fmpq], list[fmpz_mod]]:
        return {}

    def _solve(self, driver: Driver) -> list[fmpz_mod]:
        network, zero = self._cut.network, _FIELD(0)
        moved, forces = [zero] * len(network.points), [zero] * len(network.points)
        if network.points[driver.point].motion is None:
            forces[driver.point] = _modular(driver.gain)
        else:
            prescribed = moved[driver.point] = -_modular(driver.gain) / (_W * _W)
            shared = {delay: _W / sine for delay, (sine, _) in self._circular.items()}
            _, pushed = self._stiffness.prescribed_column(
                driver.point, _modular, *2 * (lambda bar: shared[bar.delay],), _I * _W
            )
            for there, across in pushed.items():
                forces[there] += across * prescribed
        law = self._stiffness.law(_modular)
        pairs = [self._circular[delay] for delay in sorted(self._circular)]
        matrix = law.matrix(_W, [cosine / sine for sine, cosine in pairs], [1 / sine for sine, _ in pairs], _I * _W)
        found = self._stiffness.solve(*matrix, [forces[point] for point in self._stiffness.points])
        for point, q in zip(self._stiffness.points, found, strict=True):
            moved[point] = q
        return moved

    def _read(self, output: ModalOutput, moved: Sequence[fmpz_mod]) -> fmpz_mod:
        """An output, but for the powers of w that its derivatives have."""
        if output.slope is None:
            return sum((_modular(weight) * moved[point] for point, weight in output.points.items()), _FIELD(0))
        end = output.slope[1]
        bar = self._cut.network.bars[end.bar]
        sine, cosine = self._circular[bar.delay]
        ends = [moved[point] * _modular(ratio) for point, ratio in zip((bar.left, bar.right), bar.ratios, strict=True)]
        return (ends[1 - end.side] - ends[end.side] * cosine) / sine


def _modular(value: fmpq) -> fmpz_mod:
    return _FIELD(int(value.p)) / _FIELD(int(value.q))
