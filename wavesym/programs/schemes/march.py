"""The march in NumPy: how it goes on window by window, and outputs at any tau."""

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array
from wavesym.programs.schemes.march_joints import MarchNumbers


class WindowBlock:
    """Some windows of a march: all tracks, (deepest + windows, track, panel, k), with those of the windows before.

    `starts` are the states at the start of each panel, `acting` what acts on each point there, `totals` the integrals
    at the start of each window and at the end of the last.
    """

    def __init__(
        self, scheme: MarchNumbers, first: int, waves: Array, starts: Array, acting: Array, totals: Array
    ) -> None:
        self._scheme, self.first, self.count, self.waves = scheme, first, len(starts), waves
        self.starts, self.acting = starts, acting
        self.totals = np.repeat(totals[:, None], self.count + 1, axis=1)
        self._integrals: dict[int, list[Array]] = {}
        self._limits: dict[tuple[int, int], tuple[Array, Array]] = {}
        n = np.arange(self.count)
        for output in range(scheme.outputs):
            if np.any(scheme.summed[self._output_terms(output)]):
                self.totals[output, 1:] += np.cumsum(self._integral_values(output, n, n, None), dtype=scheme.real)

    def read(self, tau: Array) -> Array:
        """All outputs at some tau in these windows."""
        return self.read_places(*self._scheme.places(tau))

    def read_places(
        self, window: NDArray[np.int_], phase: NDArray[np.int_], t: Array, outputs: range | None = None
    ) -> Array:
        """The same where `places` are known; all outputs, or some."""
        scheme = self._scheme
        n = window - self.first
        chosen = range(scheme.outputs) if outputs is None else outputs
        out = np.zeros((len(chosen), len(t)), scheme.real)
        for row, output in zip(out, chosen, strict=True):
            summed = scheme.summed[self._output_terms(output)]
            if np.any(summed):
                row[:] = self.totals[output, n] + self._integral_values(output, n, phase, t)
            if not np.all(summed):
                row += self._direct_values(output, n, phase, t)
        return out

    def _output_terms(self, output: int) -> slice:
        return slice(self._scheme.first_term[output], self._scheme.first_term[output + 1])

    def _tracks(self, output: int, *, summed: bool) -> list[tuple[int, float, int]]:
        """Tracks with gains and delays that an output hears, or whose integrals it hears."""
        scheme, here = self._scheme, self._output_terms(output)
        heard = zip(scheme.track[here], scheme.gain[here], scheme.delay[here], scheme.summed[here], strict=True)
        return [(track, gain, delay) for track, gain, delay, integral in heard if integral == summed]

    def _direct_values(self, output: int, n: NDArray[np.int_], phase: NDArray[np.int_], t: Array) -> Array:
        """What an output hears at t, on windows n, which are at `phase` in their cycle."""
        scheme = self._scheme
        total = np.zeros(t.shape, scheme.real)
        for track, gain, delay in self._tracks(output, summed=False):
            s = np.full(t.shape, scheme.first_stretch[delay])
            for later in range(scheme.first_stretch[delay] + 1, scheme.first_stretch[delay + 1]):
                s[t >= scheme.counts_from[later, phase]] = later
            half = scheme.half_length[scheme.panel_of[s]]
            u = ((t - scheme.start[s, phase]) + scheme.excess[s, phase]) / half - 1
            c = self.waves[scheme.deepest + n - scheme.back[s], track, scheme.panel_of[s]].T
            total += gain * _series(np.ascontiguousarray(c), u)
        return total

    def _integral(self, track: int) -> list[Array]:
        """Of a track, on each panel, the antiderivatives on all windows, (k, windows)."""
        if track not in self._integrals:
            until = self._scheme.deepest + self.count
            self._integrals[track] = [
                _antiderivative(self.waves[:until, track, panel].T) for panel in range(self._scheme.panels)
            ]
        return self._integrals[track]

    def _ends(self, track: int, stretch: int) -> tuple[Array, Array]:
        """The antiderivatives where a stretch begins and where it ends, on all windows."""
        scheme = self._scheme
        if (track, stretch) not in self._limits:
            panel = scheme.panel_of[stretch]
            c, half = self._integral(track)[panel], scheme.half_length[panel]
            low, high = (
                _series(c, np.full(c.shape[1], each[stretch] / half - 1, scheme.real))
                for each in (scheme.low, scheme.high)
            )
            self._limits[track, stretch] = low, high
        return self._limits[track, stretch]

    def _integral_values(self, output: int, n: NDArray[np.int_], phase: NDArray[np.int_], t: Array | None) -> Array:
        """The integral from the start of windows n to t; without t over all of them."""
        scheme = self._scheme
        total = np.zeros(n.shape, scheme.real)
        for track, gain, delay in self._tracks(output, summed=True):
            first, end = scheme.first_stretch[delay], scheme.first_stretch[delay + 1]
            for s in range(first, end):
                panel, window = scheme.panel_of[s], scheme.deepest + n - scheme.back[s]
                half = scheme.half_length[panel]
                low, high = self._ends(track, s)
                over = np.ones(n.shape, bool)
                if t is not None:
                    over = t >= scheme.counts_from[s + 1, phase] if s + 1 < end else ~over
                    begun = ~over if s == first else ~over & (t >= scheme.counts_from[s, phase])
                    here = np.flatnonzero(begun)
                    within = (t[here] - scheme.start[s, phase[here]]) + scheme.excess[s, phase[here]]
                    c = self._integral(track)[panel][:, window[here]]
                    total[here] += gain * (half * (_series(c, within / half - 1) - low[window[here]]))
                total[over] += gain * (half * (high[window[over]] - low[window[over]]))
        return total


class Marching:
    """A march on its way."""

    def __init__(self, scheme: MarchNumbers, most: int | None = None) -> None:
        tracks, size = len(scheme.held), scheme.degree + 1
        self.most = most or max(1, min(256, 2_000_000 // (tracks * scheme.panels * size)))
        """So many windows at once."""
        self._scheme = scheme
        self._waves = np.zeros((scheme.deepest + self.most, tracks, scheme.panels, size), scheme.real)
        self._waves[..., 0] = scheme.held[:, None]
        self._x = scheme.initial_state.copy()
        self._loads = RunningLoads(scheme, scheme.event_power, scheme.since)
        self._totals = np.zeros(scheme.outputs, scheme.real)

    def block(self, first: int, count: int) -> WindowBlock:
        """The next windows; what the block holds is overwritten by the one after it."""
        scheme = self._scheme
        starts = np.zeros((count, scheme.panels, len(self._x)), scheme.real)
        acting = np.zeros((count, scheme.panels, len(scheme.force_on), 3), scheme.real)
        if first > 0:
            self._waves[: scheme.deepest] = self._waves[self.most : self.most + scheme.deepest].copy()
        for n in range(count):
            acting[n] = self._loads.on_window(first + n)
            for group in scheme.groups:
                arriving = group.arriving_waves(self._waves, scheme.deepest + n)
                sent = group.step(arriving, acting[n][:, group.points], self._x, starts[n])
                self._waves[scheme.deepest + n, group.send, group.panels] = sent
        made = WindowBlock(scheme, first, self._waves, starts, acting, self._totals)
        self._totals = made.totals[:, -1]
        return made


class RunningLoads:
    """The loads, polynomials in the time since their last change."""

    def __init__(self, scheme: MarchNumbers, powers: Array, since: Array) -> None:
        self._scheme, self._powers, self._since = scheme, powers, since
        self._now: dict[int, tuple[int, int, Array]] = {}
        self._event = 0

    def on_window(self, window: int) -> Array:
        """What acts on each point on the panels of a window, (panels, points, 3); windows come in order."""
        scheme = self._scheme
        # one more, for points on which nothing acts
        acting = np.zeros((scheme.panels, scheme.forces + 1, 3), scheme.real)
        first = 0
        while first < scheme.panels:
            end = self._begin(window, first)
            half = scheme.half_length[first:end]
            for force, (begun, place, c) in self._now.items():
                middle = ((window - begun) * scheme.step + self._since[first:end, place]) + half
                acting[first:end, force, 0] = (c[0] + middle * c[1]) + (middle * middle + half * half / 2) * c[2]
                acting[first:end, force, 1] = half * (c[1] + 2 * middle * c[2])
                acting[first:end, force, 2] = half * half / 2 * c[2]
            first = end
        return acting[:, scheme.force_on]

    def _begin(self, window: int, panel: int) -> int:
        """Take the changes at the start of a panel; the next panel of the window that has one, or how many it has."""
        scheme = self._scheme
        while self._event < len(scheme.event_window) and scheme.event_window[self._event] == window:
            place = int(scheme.event_panel[self._event])
            if place > panel:
                return place
            self._now[int(scheme.event_force[self._event])] = window, place, self._powers[self._event]
            self._event += 1
        return scheme.panels


class MarchScheme(MarchNumbers):
    """The march: its numbers, and outputs at any tau."""

    SAMPLES = 4096
    """So many samples at once."""

    def _values(self, tau: Array) -> Array:
        out = np.empty((self.outputs, tau.size), self.real)
        windows = self.places(tau)[0]
        marching, count = Marching(self), int(windows[-1]) + 1
        for first in range(0, count, marching.most):
            block = marching.block(first, min(marching.most, count - first))
            begin, end = np.searchsorted(windows, [first, first + block.count])
            for low in range(begin, end, self.SAMPLES):
                part = slice(low, min(low + self.SAMPLES, end))
                out[:, part] = block.read(tau[part])
        return out


def _series(c: Array, u: Array) -> Array:
    """sum of c[k] T_k(u)"""
    twice = u + u
    now, after = np.zeros_like(u), np.zeros_like(u)
    for k in range(len(c) - 1, 0, -1):
        now, after = (twice * now - after) + c[k], now
    return np.asarray((u * now - after) + c[0])


def _antiderivative(c: Array) -> Array:
    """Of a series, times 1 / half the length of the panel."""
    result = np.zeros((len(c) + 1, c.shape[1]), c.dtype)
    result[1:] = c
    result[1] *= 2
    result[1:-2] -= c[2:]
    result[1:] /= 2 * np.arange(1, len(c) + 1, dtype=c.dtype)[:, None]
    return result
