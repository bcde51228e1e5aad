"""The march in NumPy."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


class MarchScheme:
    """The march. A wave crosses a rod in one unit of tau, so what arrives at a node on a window [n, n + 1) was sent on
    the window before, and each node needs to know no more. A window is cut into panels at the instants of its loads; on
    a panel waves are Chebyshev series in u, -1 <= u <= 1. Let a and b arrive from the left and the right. A node solves

        q'/rate + q = p (a body) or q = p,    p = alpha a + beta b + load,

    and sends q - a to the left and q - b to the right. Integrated once, with q_0 and p_0 counted twice, this is
    q_k + x_k (q_(k-1) - q_(k+1)) = x_k (p_(k-1) - p_(k+1)); ratio, first, last, slack, loss are its elimination.
    """

    TABLES = (
        # half the length of a panel; what its start is later than that of another
        "half_length",
        "since",
        # nodes; on each panel the row of a body in the tables below, -1 for a node without inertia
        "alpha",
        "beta",
        "body",
        "force_on",
        "motion",
        # waves at tau = 0 in the rods on the left of each node, and on the right of the last
        "rod",
        # bodies on panels: rows of degree + 1
        "ratio",
        "first",
        "last",
        "slack",
        "loss",
        "leak",
        # changes of the loads: from there on three powers of the time since
        "event_window",
        "event_panel",
        "event_force",
        "event_power",
        # outputs: where what they hear starts in the next tables; which way it is sent and by which node (or which load
        # it is), factors, whether the integral counts, and how late it arrives
        "first_heard",
        "way",
        "sender",
        "gain",
        "summed",
        "delay",
        # delays: in a window, t after its start, a wave is that of `panel_of`, `back` windows ago, from t >= `from` on,
        # with u = (t - start + excess) / half - 1
        "first_stretch",
        "from",
        "start",
        "excess",
        "back",
        "panel_of",
    )
    # of the largest velocity or mean of a wave, polynomials may miss `trusted`
    CONSTANTS = ("degree", "trusted")
    LEFT, RIGHT, LOAD = 0, 1, 2
    SAMPLES = 4096
    """So many samples at once."""

    def __init__(
        self,
        tables: dict[str, tuple[float, ...]],
        constants: dict[str, float],
        tau_max: float,
        real: type[np.float64],
    ) -> None:
        def reals(name: str) -> NDArray[np.float64]:
            return np.array(tables[name], real)

        def indices(name: str) -> NDArray[np.int_]:
            return np.array(tables[name], int)

        self.tau_max, self.real = tau_max, real
        self.degree, self.trusted = int(constants["degree"]), constants["trusted"]
        self.half_length = reals("half_length")
        self.panels, self.nodes = len(self.half_length), len(tables["alpha"])
        self.since = reals("since").reshape(self.panels, self.panels)
        self.alpha, self.beta = reals("alpha")[:, None], reals("beta")[:, None]
        self.body = indices("body").reshape(self.panels, self.nodes)
        self.force_on = indices("force_on")
        self.motion, self.rod = reals("motion"), reals("rod")
        self.ratio, self.first, self.last = (
            reals(name).reshape(-1, self.degree + 1) for name in ("ratio", "first", "last")
        )
        self.slack, self.loss, self.leak = reals("slack"), reals("loss"), reals("leak")
        self.event_window, self.event_panel = indices("event_window"), indices("event_panel")
        self.event_force, self.event_power = indices("event_force"), reals("event_power")
        self.first_heard = indices("first_heard")
        self.outputs = len(self.first_heard) - 1
        self.way, self.sender, self.delay = indices("way"), indices("sender"), indices("delay")
        self.gain, self.summed = reals("gain"), indices("summed") > 0
        self.ways = max(self.LOAD, int(np.max(self.way, initial=0)) + 1)
        self.first_stretch = indices("first_stretch")
        self.counts_from, self.start, self.excess = reals("from"), reals("start"), reals("excess")
        self.back, self.panel_of = indices("back"), indices("panel_of")

    def evaluate(self, tau: ArrayLike) -> NDArray[np.float64]:
        """All outputs at tau, an array or a number: shape (outputs, *tau.shape), NaN where tau is out of range.

        Marches once, up to the last tau. ArithmeticError where the degree is seen to be too low.
        """
        taus = np.asarray(tau, dtype=self.real)
        flat = taus.ravel()
        out = np.full((self.outputs, flat.size), np.nan, self.real)
        inside = np.flatnonzero((flat >= 0) & (flat <= self.tau_max))
        if inside.size:
            order = inside[np.argsort(flat[inside], kind="stable")]
            values = np.empty((self.outputs, order.size), self.real)
            self._sample(values, flat[order])
            out[:, order] = values
        return out.reshape(self.outputs, *taus.shape)

    def _sample(self, out: NDArray[np.float64], tau: NDArray[np.float64]) -> None:
        """Fill out (outputs, samples) for sorted tau within range."""
        places = np.floor(tau)
        totals = np.zeros(len(out), self.real)
        marching = Marching(self)
        windows = int(places[-1]) + 1
        for first in range(0, windows, marching.most):
            count = min(marching.most, windows - first)
            waves = marching.block(first, count)
            begin, end = (int(place) for place in np.searchsorted(places, [first, first + count]))
            for output in range(self.outputs):
                sums = self._heard(output, summed=True)
                if sums.size:
                    gains = self._gathered(waves, sums, np.arange(count), np.ones(count, self.real))
                    starts = np.cumsum(np.concatenate([totals[output : output + 1], gains]), dtype=self.real)
                    totals[output] = starts[-1]
                for low in range(begin, end, self.SAMPLES):
                    part = slice(low, min(low + self.SAMPLES, end))
                    n = places[part].astype(int) - first
                    t = tau[part] - places[part]
                    value = self._arrived(waves, self._heard(output, summed=False), n, t)
                    if sums.size:
                        value += starts[n] + self._gathered(waves, sums, n, t)
                    out[output, part] = value

    def _heard(self, output: int, *, summed: bool) -> NDArray[np.int_]:
        """What an output hears, or hears the integrals of, in the tables of that."""
        here = np.arange(self.first_heard[output], self.first_heard[output + 1])
        return np.asarray(here[self.summed[here] == summed])

    def _arrived(
        self, waves: NDArray[np.float64], heard: NDArray[np.int_], n: NDArray[np.int_], t: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """The sum of what is heard, t after the start of windows n of a block."""
        total = np.zeros(t.shape, self.real)
        for k in heard:
            delay = self.delay[k]
            stretches = slice(self.first_stretch[delay], self.first_stretch[delay + 1])
            s = stretches.start + np.searchsorted(self.counts_from[stretches], t, side="right") - 1
            u = ((t - self.start[s]) + self.excess[s]) / self.half_length[self.panel_of[s]] - 1
            c = waves[n + 1 - self.back[s], self.way[k], self.panel_of[s], self.sender[k] + 1].T
            total += self.gain[k] * _series(np.ascontiguousarray(c), u)
        return total

    def _gathered(
        self, waves: NDArray[np.float64], heard: NDArray[np.int_], n: NDArray[np.int_], t: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """The same of integrals from the start of the windows to t after it."""
        sums = np.zeros(t.shape, self.real)
        for k in heard:
            total = np.zeros(t.shape, self.real)
            first, end = self.first_stretch[self.delay[k]], self.first_stretch[self.delay[k] + 1]
            for s in range(first, end):
                here = np.flatnonzero(t >= self.counts_from[s]) if s > first else np.arange(t.size)
                half = self.half_length[self.panel_of[s]]
                wave = waves[n[here] + 1 - self.back[s], self.way[k], self.panel_of[s], self.sender[k] + 1]
                c = _antiderivative(wave.T)
                low = np.full(here.shape, self.excess[s] - self.start[s] if s == first else 0, self.real)
                high = (t[here] - self.start[s]) + self.excess[s]
                if s + 1 < end:
                    high = np.where(t[here] >= self.counts_from[s + 1], 2 * half, high)
                total[here] += half * (_series(c, high / half - 1) - _series(c, low / half - 1))
            sums += self.gain[k] * total
        return sums


class Marching:
    """A march on its way."""

    def __init__(self, scheme: MarchScheme) -> None:
        shape = scheme.ways, scheme.panels, scheme.nodes + 2, scheme.degree + 1
        self.most = max(1, min(256, 2_000_000 // (shape[0] * shape[1] * shape[2] * shape[3])))
        """So many windows at once."""
        self._scheme = scheme
        self._bodies = [PanelBodies(scheme, panel) for panel in range(scheme.panels)]
        self._last = np.zeros(shape, scheme.real)
        self._last[scheme.LEFT, :, 1:, 0] = scheme.rod
        self._last[scheme.RIGHT, :, :-1, 0] = scheme.rod
        self._velocity = scheme.motion.copy()
        self._loads: dict[int, tuple[int, int, NDArray[np.float64]]] = {}
        self._event = 0
        self._leak: float = 0.0
        self._size: float = 0.0

    def block(self, first: int, count: int) -> NDArray[np.float64]:
        """Waves (1 + windows, way, panel, 1 + node, k) of the next windows, the one before them first.

        Where loads are heard they are a way of their own, by number in the place of the node.
        """
        scheme = self._scheme
        left, right = scheme.LEFT, scheme.RIGHT
        waves = np.repeat(self._last[None], 1 + count, axis=0)
        for n in range(count):
            for panel in range(scheme.panels):
                self._change(first + n, panel)
                a, b = waves[n, right, panel, :-2], waves[n, left, panel, 2:]
                p = scheme.alpha * a + scheme.beta * b
                self._load(p, waves[n + 1, scheme.LOAD :, panel], first + n, panel)
                bodies = self._bodies[panel]
                nodes = bodies.nodes
                if nodes.size:
                    p[nodes], self._velocity[nodes], missed = bodies.moved(p[nodes], self._velocity[nodes])
                    self._leak += missed
                    self._size = max(self._size, np.max(np.abs(self._velocity)))
                waves[n + 1, left, panel, 1:-1] = p - a
                waves[n + 1, right, panel, 1:-1] = p - b
        self._last = waves[-1]
        self._size = max(self._size, np.max(np.abs(waves[:, : scheme.LOAD, ..., 0])))
        if self._leak > scheme.trusted * self._size:
            end = first + count
            raise ArithmeticError(f"degree {scheme.degree} is too low: polynomials lost {self._leak} by tau = {end}")
        return waves

    def _change(self, window: int, panel: int) -> None:
        """The changes of the loads at the start of a panel."""
        scheme = self._scheme
        while self._event < len(scheme.event_window) and (
            (scheme.event_window[self._event], scheme.event_panel[self._event]) == (window, panel)
        ):
            powers = scheme.event_power[3 * self._event : 3 * self._event + 3]
            self._loads[int(scheme.event_force[self._event])] = window, panel, powers
            self._event += 1

    def _load(self, p: NDArray[np.float64], heard: NDArray[np.float64], window: int, panel: int) -> None:
        """Add the loads on a panel to p, as series, and set what is heard of them."""
        scheme = self._scheme
        half = scheme.half_length[panel]
        for force, (since, place, c) in self._loads.items():
            middle = (window - since) + scheme.since[panel, place] + half
            node = np.flatnonzero(scheme.force_on == force)
            mean = c[0] + middle * c[1] + (middle * middle + half * half / 2) * c[2]
            series = np.array([mean, half * (c[1] + 2 * middle * c[2]), half * half / 2 * c[2]])
            p[node, :3] += series
            heard[:, force + 1, :3] = series


class PanelBodies:
    """All bodies on one panel: their recurrences as scans, in log2(degree) steps."""

    def __init__(self, scheme: MarchScheme, panel: int) -> None:
        self.nodes = np.flatnonzero(scheme.body[panel] >= 0)
        rows = scheme.body[panel, self.nodes]
        self.ratio = scheme.ratio[rows]
        self.sums = np.stack([scheme.first[rows], scheme.last[rows]])
        self.slack, self.loss, self.leak = scheme.slack[rows], scheme.loss[rows], scheme.leak[rows]
        self.down, self.up = [], []
        stride, down, up = 1, self.ratio, -self.ratio
        while stride <= scheme.degree and down.any():
            self.down.append((stride, down[:, :-stride].copy()))
            self.up.append((stride, up[:, stride:].copy()))
            longer, longer_up = np.zeros_like(down), np.zeros_like(up)
            longer[:, :-stride] = down[:, :-stride] * down[:, stride:]
            longer_up[:, stride:] = up[:, stride:] * up[:, :-stride]
            # what is too small to matter is 0, and ends the scan
            longer[np.abs(longer) < 2.0**-100] = 0
            stride, down, up = 2 * stride, longer, longer_up

    def moved(
        self, p: NDArray[np.float64], velocity: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
        """q, its value at the end of the panel, and what the polynomials miss; from p and the value at the start."""
        y = np.zeros_like(p)
        y[:, 1:] = p[:, :-1]
        y[:, 1] *= 2
        y[:, 1:-1] -= p[:, 2:]
        y *= self.ratio
        for stride, products in self.down:
            y[:, :-stride] += products * y[:, stride:]
        begun, ended = _total(self.sums * y)
        begun = velocity - begun
        mean = begun - self.slack * begun
        y[:, 0] = 2 * mean
        for stride, products in self.up:
            y[:, stride:] += products * y[:, :-stride]
        y[:, 0] = mean
        return y, mean + (ended - self.loss * mean), np.sum(self.leak * np.abs(y[:, -1] - p[:, -1]))


def _total(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sums along the last axis, in pairs."""
    while values.shape[-1] > 1:
        half = values.shape[-1] // 2
        folded = values[..., : values.shape[-1] - half].copy()
        folded[..., :half] += values[..., values.shape[-1] - half :]
        values = folded
    return np.asarray(values[..., 0])


def _series(c: NDArray[np.float64], u: NDArray[np.float64]) -> NDArray[np.float64]:
    """sum of c[k] T_k(u)"""
    twice = u + u
    now, after = np.zeros_like(u), np.zeros_like(u)
    for k in range(len(c) - 1, 0, -1):
        now, after = (twice * now - after) + c[k], now
    return np.asarray((u * now - after) + c[0])


def _antiderivative(c: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of a series, times 1 / half the length of the panel."""
    result = np.zeros((len(c) + 1, c.shape[1]), c.dtype)
    result[1:] = c
    result[1] *= 2
    result[1:-2] -= c[2:]
    result[1:] /= 2 * np.arange(1, len(c) + 1, dtype=c.dtype)[:, None]
    return result
