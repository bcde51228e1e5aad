"""Outputs that are 0 throughout the horizon: where no load has come to, and where its effects cancel.

They cancel if what all loads together do to the output at a frequency w is 0 at every w: then each mode's part is 0,
damped or not. It is a rational function of w and of E = exp(-i w h), all delays being multiples of h. As in
exact/arrivals.py it is computed modulo a prime, one in which i is a number; at a random w and E what is not 0 is taken
for 0 with a chance of less than one in 2**70.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpq, fmpq_mat, fmpz_mod, fmpz_mod_ctx

from wavesym.exact.first_arrivals import light_arrivals
from wavesym.exact.modes.cuts import cut
from wavesym.exact.modes.response import HarmonicResponse
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import common_measure
from wavesym.programs.modes.harmonic_response import read
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.projection import Driver, modal_output, places

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
        bars = self._cut.network.bars
        measure = common_measure(bar.delay for bar in bars)
        turns = {bar.delay: _E ** int(bar.delay / measure) for bar in bars}
        # s coth(s h) and s/sinh(s h) with exp(-s h) = E**k
        parts = {delay: _I * _W / (1 - turn * turn) for delay, turn in turns.items()}
        pairs = {delay: (part * (1 + turns[delay] ** 2), 2 * part * turns[delay]) for delay, part in parts.items()}
        self._harmonic = HarmonicResponse(Stiffness(self._cut.network), _modular, _I * _W, pairs)
        self._known: dict[tuple[int, fmpq], list[fmpz_mod]] = {}

    def cancels(self, probe: Probe, drivers: Sequence[Driver], histories: Sequence[Sequence[fmpq]]) -> bool:
        """Whether what the loads do to an output adds up to 0."""
        output = modal_output(self._network, self._cut, probe)
        done = [read(self._harmonic, output, self._motion(driver)) for driver in drivers]
        zero = _FIELD(0)
        return all(
            sum((_modular(part) * each for part, each in zip(history, done, strict=True)), zero) == 0
            for history in histories
        )

    def _motion(self, driver: Driver) -> list[fmpz_mod]:
        """How far points move under a load: a force, or an acceleration."""
        key, s = (driver.point, driver.gain), self._harmonic.s
        if key not in self._known:
            free, gain = self._cut.network.points[driver.point].motion is None, _modular(driver.gain)
            self._known[key] = (
                self._harmonic.move({driver.point: gain})
                if free
                else self._harmonic.prescribe(driver.point, gain / (s * s))[0]
            )
        return self._known[key]


def _modular(value: fmpq) -> fmpz_mod:
    return _FIELD(int(value.p)) / _FIELD(int(value.q))
