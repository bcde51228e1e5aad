"""Modes in NumPy."""

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.schemes.scheme import Scheme


class ModesScheme(Scheme):
    """Oscillators under loads that are linear between the instants `time`, and outputs that are sums of them.

        y_n'' + 2 damping_n frequency_n y_n' + frequency_n^2 y_n = sum_j push[n, j] a_j(tau)
        output_o = sum_n (moved[o, n] y_n + moving[o, n] y_n') + sum_j sum_k direct[o, j, k] I^k a_j

    I^k is the k-th integral from tau = 0, when all is at rest. Load j at time[i] is sample[i, j]; from there on it has
    the slope to the next, after the last slope[j]. The panel i between two instants has the length length[kind[i]].
    A panel is stepped exactly, whatever its length.
    """

    BLOCK = 512  # panels between which states are kept
    SLOW = 2  # up to here a power series is summed, as differences would lose digits
    _AT_ONCE = 1 << 15  # numbers of an array

    def _read(self, tables: dict[str, tuple[float, ...]], constants: dict[str, float]) -> None:
        real, loads, modes = self.real, int(constants["loads"]), len(tables["frequency"])
        self.outputs = outputs = len(tables["direct"]) // (3 * loads)
        # what multiplies states is in the type of the values; what turns them is computed in doubles
        self._frequency, self._damping, self._length = (
            np.array(tables[name], real).astype(np.float64) for name in ("frequency", "damping", "length")
        )
        self._kind = np.array(tables["kind"], np.intp)
        self._time = np.array(tables["time"], real)
        self._push = np.array(tables["push"], real).reshape(modes, loads).T
        self._moved, self._moving = (
            np.array(tables[name], real).reshape(outputs, modes).T.copy() for name in ("moved", "moving")
        )
        self._direct = np.array(tables["direct"], real).reshape(outputs, loads, 3).transpose(2, 1, 0).copy()
        self.load = self._integrals(np.array(tables["sample"], real).reshape(-1, loads), tables["slope"])
        self._marks = [np.zeros((2, modes), real)]

    def _integrals(self, sample: NDArray[np.float64], last: tuple[float, ...]) -> NDArray[np.float64]:
        """Of loads at instants the slope from there on, the load, and its two integrals: (4, instants, loads)."""
        h = self._length[self._kind].astype(self.real)[:, None]
        now, then = sample[:-1], sample[1:]
        made = np.zeros((4, *sample.shape), self.real)
        made[0, :-1], made[0, -1], made[1] = (then - now) / h, last, sample
        made[2, 1:] = np.cumsum(h * (now + then) / 2, axis=0)
        made[3, 1:] = np.cumsum(h * made[2, :-1] + h * h * (2 * now + then) / 6, axis=0)
        return made

    def _values(self, tau: NDArray[np.float64]) -> NDArray[np.float64]:
        out = np.empty((self.outputs, tau.size), self.real)
        panel = np.searchsorted(self._time, tau, side="right") - 1
        edges = np.flatnonzero(np.diff(panel // self.BLOCK)) + 1
        most = max(1, self._AT_ONCE // len(self._frequency))
        for start, stop in zip([0, *edges], [*edges, tau.size], strict=True):
            block = int(panel[start]) // self.BLOCK
            states = self.states(block, int(panel[stop - 1]))
            for low in range(start, stop, most):
                some = slice(low, min(low + most, stop))
                at = panel[some]
                out[:, some] = self._read_panels(states[at - block * self.BLOCK], at, tau[some] - self._time[at])
        return out

    def _read_panels(
        self, states: NDArray[np.float64], panel: NDArray[np.intp], s: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """The outputs s after the starts of panels, where states (s.size, 2, modes) are: (outputs, s.size)."""
        slope, load, once, twice = self.load[:, panel]
        w = s[:, None]
        ramp, start = slope @ self._push, load @ self._push
        times, which = np.unique(s, return_inverse=True)
        turned = self._mode_functions(s if len(times) == len(s) else times)
        p11, p12, p21, p22, one, two = turned if len(times) == len(s) else (each[which] for each in turned)
        y, v = states[:, 0], states[:, 1]
        out = (p11 * y + p12 * v + (one * start + two * ramp)) @ self._moved
        out += (p21 * y + p22 * v + (p12 * start + one * ramp)) @ self._moving
        out += (load + w * slope) @ self._direct[0]
        out += (once + w * (load + w / 2 * slope)) @ self._direct[1]
        out += (twice + w * (once + w / 2 * (load + w / 3 * slope))) @ self._direct[2]
        values: NDArray[np.float64] = out.T
        return values

    def states(self, block: int, last: int) -> NDArray[np.float64]:
        """Displacements and velocities of the modes at the starts of the panels of a block, up to the `last` panel.

        Of shape (panels, 2, modes). The blocks before are stepped once.
        """
        while len(self._marks) <= block:
            first = (len(self._marks) - 1) * self.BLOCK
            self._marks.append(self._step_states(self._marks[-1], first, first + self.BLOCK)[-1].copy())
        return self._step_states(self._marks[block], block * self.BLOCK, last)

    def _step_states(self, state: NDArray[np.float64], first: int, last: int) -> NDArray[np.float64]:
        """States at the starts of the panels first ... last, from that of the first: (panels, 2, modes)."""
        states = np.empty((last - first + 1, *state.shape), self.real)
        states[0] = state
        kinds, kind = np.unique(self._kind[first:last], return_inverse=True)
        if not len(kinds):
            return states
        p11, p12, p21, p22, one, two = self._mode_functions(self._length[kinds])
        same, crossed = np.stack([p11, p22], 1), np.stack([p12, p21], 1)
        ramp, start = (self.load[part, first:last] @ self._push for part in (0, 1))
        pushed = np.stack([one[kind] * start + two[kind] * ramp, p12[kind] * start + one[kind] * ramp], 1)
        added = np.empty_like(state)
        for k, which in enumerate(kind.tolist()):
            after = states[k + 1]
            np.multiply(same[which], states[k], out=after)
            np.multiply(crossed[which], states[k, ::-1], out=added)
            after += added
            after += pushed[k]
        return states

    def _mode_functions(self, s: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """What modes do in the times s, each of shape (s.size, modes), in the type of the values.

        The matrix p11, p12, p21, p22 of displacement and velocity, and the displacement that a force of 1, and one that
        grows by 1 in a unit of tau, cause from rest. (Velocities are p12, and the displacement of the constant force.)
        """
        s = s.astype(np.float64)[:, None]
        w, decay = self._frequency, self._damping * self._frequency
        p12, one, two = np.empty((3, len(s), len(w)))
        p11, p22 = np.empty((2, len(s), len(w)))
        for columns, rule in ((self._damping < 1, self._swinging), (self._damping >= 1, self._creeping)):
            if columns.any():
                for array, made in zip(
                    (p11, p12, p22, one, two), rule(s, w[columns], decay[columns], self._damping[columns]), strict=True
                ):
                    array[:, columns] = made
        slow = (w + 2 * decay) * s <= self.SLOW
        if slow.any():
            p12[slow], p22[slow], one[slow], two[slow] = self._slow(
                *(np.broadcast_to(each, slow.shape)[slow] for each in (s, w, decay))
            )
            p11[slow] = 1 - (w * w * one)[slow]
        return tuple(each.astype(self.real, copy=False) for each in (p11, p12, -(w * w) * p12, p22, one, two))

    @staticmethod
    def _swinging(
        s: NDArray[np.float64], w: NDArray[np.float64], decay: NDArray[np.float64], damping: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], ...]:
        """Damping below 1."""
        w = np.where(w > 0, w, 1.0)  # of what is slow, which is done elsewhere
        turning = w * np.sqrt((1 - damping) * (1 + damping))
        shrunk = np.exp(-decay * s)
        cosine, p12 = shrunk * np.cos(turning * s), shrunk * (np.sin(turning * s) / turning)
        p11 = cosine + decay * p12
        one = (1 - p11) / (w * w)
        return p11, p12, cosine - decay * p12, one, (s - 2 * decay * one - p12) / (w * w)

    @staticmethod
    def _creeping(
        s: NDArray[np.float64], w: NDArray[np.float64], decay: NDArray[np.float64], damping: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], ...]:
        """Damping of 1 or more: two rates, the slow one without cancellation."""
        apart = w * np.sqrt((damping - 1) * (damping + 1))
        fast = np.where(w > 0, decay + apart, 1.0)
        z, x = w * w / fast * s, 2 * apart * s

        def mean(u: NDArray[np.float64]) -> NDArray[np.float64]:
            """Of exp from -u to 0."""
            safe = np.where(u > 0, u, 1.0)
            return np.where(u > 0, -np.expm1(-u) / safe, 1.0)

        shrunk = np.exp(-z)
        p12 = s * shrunk * mean(x)
        one = s * (mean(z) - shrunk * mean(x)) / fast
        series = np.ones_like(z)
        for k in range(20, 2, -1):
            series = 1 - np.minimum(z, 1.0) / k * series
        two = (s * s * np.where(z < 1, series / 2, (1 - mean(z)) / np.maximum(z, 1.0)) - one) / fast
        return shrunk * (1 + z * mean(x)), p12, shrunk * (1 + np.exp(-x)) / 2 - decay * p12, one, two

    @staticmethod
    def _slow(
        s: NDArray[np.float64], w: NDArray[np.float64], decay: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], ...]:
        """Power series, where nothing much happens in s."""
        before, term = np.zeros_like(s), np.ones_like(s)
        p12, p22, one, two = np.zeros((4, *s.shape))
        for k in range(1, 28):
            p22 += k * term
            p12 += term
            one += term / (k + 1)
            two += term / ((k + 1) * (k + 2))
            before, term = term, -(2 * decay * s * term + (w * s) ** 2 / k * before) / (k + 1)
        return s * p12, p22, s * s * one, s * s * s * two
