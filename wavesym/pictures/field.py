"""Waves everywhere in a network, in doubles: what a picture of all rods at once needs."""

from __future__ import annotations

import numpy as np
from flint import arb, fmpq

from wavesym.exact.contacts.events import events
from wavesym.exact.joints.network_waves import SentWave, Waves
from wavesym.exact.motion import Motion
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End
from wavesym.mechanics.probe import Probe
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import middle, nearest, rational

# errors this small, relative to the largest wave, are seen in no picture
_UNSEEN = arb(2) ** -20
_FRONT = 0.02  # of the largest wave: smaller jumps are not drawn as fronts
_MORE = (1, 2, 4)


class Field:
    """The velocity and the force (impedance times speed times strain) of every bar until the end of the horizon.

    `events` are those of all contacts. CostError where the outputs of a model with as many would cost too much.
    """

    def __init__(self, model: Model) -> None:
        everywhere = model.watching(
            Probe("", "velocity", number, fmpq(1, 2)) for number in range(1, len(model.network.bars) + 1)
        )
        self._network = model.network
        self.events = events(everywhere)
        motion = Motion(everywhere, rational(model.horizon()))
        self._waves = {end: _SampledWave(wave) for end, wave in _visible_waves(motion).sent.items()}

    def values_at(self, bar: int, part: Array, tau: Array) -> tuple[Array, Array]:
        """Velocity and force of a bar at parts of its length from the left end; all of one shape."""
        delay = nearest(self._network.bars[bar].delay)
        right = self._waves[End(bar, 0)](tau - part * delay)
        left = self._waves[End(bar, 1)](tau - (1 - part) * delay)
        return right + left, nearest(self._network.bars[bar].impedance) * (left - right)

    def delay(self, bar: int) -> float:
        """How long a wave takes to cross a bar, in tau."""
        return nearest(self._network.bars[bar].delay)

    def fronts(self, bar: int) -> tuple[Array, Array]:
        """When jumps that are large enough to be seen leave the left and the right end of a bar, in tau."""
        largest = max(float(np.max(np.abs(wave.ends), initial=0.0)) for wave in self._waves.values())
        left, right = (self._waves[End(bar, side)].jumps(_FRONT * largest) for side in (0, 1))
        return left, right


def _visible_waves(motion: Motion) -> Waves:
    """The waves, with as many bits as a picture needs: the first ones do not always bear what springs swing."""
    for more in _MORE:
        waves = motion.waves(more * motion.first_bits)
        stretches = [
            (known, abs(known.polynomial(arb(end - start))))
            for wave in waves.sent.values()
            for start, end, known in zip(wave.starts, [*wave.starts[1:], motion.until], wave.stretches, strict=True)
        ]
        size = max((value.upper() for _, value in stretches), default=arb(0))
        if all(known.error <= _UNSEEN * size for known, _ in stretches):
            break
    return waves


class _SampledWave:
    def __init__(self, wave: SentWave) -> None:
        self._starts = np.array([nearest(start) for start in wave.starts])
        self._powers = [
            np.array([nearest(middle(c)) for c in known.polynomial.coeffs()] or [0.0]) for known in wave.stretches
        ]
        after = np.array([powers[0] for powers in self._powers])
        lengths = np.diff(self._starts)
        before = [
            np.polynomial.polynomial.polyval(length, own) for length, own in zip(lengths, self._powers, strict=False)
        ]
        # values (before, after) at each start; before the first there is none
        self.ends = np.column_stack([np.array([0.0, *before]), after])

    def jumps(self, least: float) -> Array:
        """When it jumps by so much at least."""
        found: Array = self._starts[np.abs(self.ends[:, 1] - self.ends[:, 0]) >= least]
        return found

    def __call__(self, tau: Array) -> Array:
        place = np.clip(np.searchsorted(self._starts, tau, side="right") - 1, 0, None)
        result = np.zeros_like(tau)
        for number in np.unique(place):
            here = place == number
            result[here] = np.polynomial.polynomial.polyval(tau[here] - self._starts[number], self._powers[number])
        return result
