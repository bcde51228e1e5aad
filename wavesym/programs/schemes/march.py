"""The march in NumPy."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


class MarchScheme:
    """The march. All delays are multiples of one step, so what arrives at a joint on a window (one step long) was sent
    on a window before, and each joint needs to know no more. A window is cut into panels at the instants of loads; on a
    panel waves are Chebyshev series in u, -1 <= u <= 1. A track is what is sent into an end of a bar.

    A joint without state scatters: a matrix makes what it sends of what arrives. The others have velocities q of their
    points and send ratio q - a; where a arrives, push a acts. A body, one mass without springs, solves

        q'/rate + q = p,    p = drive load + the sum of push a:

    integrated once, with q_0 and p_0 counted twice, this is q_k + x_k (q_(k-1) - q_(k+1)) = x_k (p_(k-1) - p_(k+1));
    slack, ratios, loss, first and last are its elimination. A block, any other joint with a state x (velocities of
    masses, lengthening of springs), has a matrix for each panel:
    (coefficients of what acts on its points, x at the start) -> (those of the velocities q, x at the end less x).
    """

    TABLES = (
        # tracks: how many windows later it arrives, and what is on its way at tau = 0
        "steps",
        "held",
        # joints: what they do (0 scatter, 1 a body, 2 a block), where their points, states and ports start in the next
        # tables, how strong loads are on a body, and where on each panel their matrix is: of a body three numbers for
        # each degree, slack, loss and 0, then ratio, first and last
        "law",
        "first_point",
        "first_state",
        "first_port",
        "drive",
        "answer",
        "matrix",
        "initial_state",
        "force_on",
        # ports: the point of the joint, factors, and tracks
        "point_of",
        "push",
        "ratio",
        "arrive",
        "send",
        # panels: half the length, and what its start is later than that of another
        "half_length",
        "since",
        # changes of the loads: from there on three powers of the time since
        "event_window",
        "event_panel",
        "event_force",
        "event_power",
        # outputs: where their tracks start in the next tables; factors, whether the integral counts, and delays
        "first_term",
        "track",
        "gain",
        "summed",
        "delay",
        # after a cycle of windows tau is a whole number again; where they begin in it
        "begin",
        # delays: from t >= `from` on, t counted from the start of the cycle, a wave is that of `panel_of`, `back`
        # windows ago, with u = (t - start + excess) / half - 1; an integral over all of a window is from low to high
        "first_stretch",
        "from",
        "start",
        "excess",
        "low",
        "high",
        "back",
        "panel_of",
    )
    CONSTANTS = ("degree", "step", "span", "forces")
    SAMPLES = 4096
    """So many samples at once."""

    def __init__(
        self,
        tables: dict[str, tuple[float, ...]],
        constants: dict[str, float],
        tau_max: float,
        real: type[np.float64],
    ) -> None:
        def reals(name: str, *shape: int) -> NDArray[np.float64]:
            return np.array(tables[name], real).reshape(shape or -1)

        def indices(name: str, *shape: int) -> NDArray[np.int_]:
            return np.array(tables[name], int).reshape(shape or -1)

        self.tau_max, self.real = tau_max, real
        self.degree, self.forces = int(constants["degree"]), int(constants["forces"])
        self.step, self.span = real(constants["step"]), real(constants["span"])
        # one track more than there are: for ports that are missing
        self.steps, self.held = np.append(indices("steps"), 1), np.append(reals("held"), real(0))
        self.half_length = reals("half_length")
        self.panels = len(self.half_length)
        self.since = reals("since", self.panels, self.panels)
        self.initial_state, self.force_on = reals("initial_state"), indices("force_on")
        self.event_window, self.event_panel = indices("event_window"), indices("event_panel")
        self.event_force, self.event_power = indices("event_force"), reals("event_power", -1, 3)
        self.first_term = indices("first_term")
        self.outputs = len(self.first_term) - 1
        self.track, self.delay = indices("track"), indices("delay")
        self.gain, self.summed = reals("gain"), indices("summed") > 0
        self.begin = reals("begin")
        self.first_stretch = indices("first_stretch")
        self.counts_from, self.start, self.excess = (
            reals(name, -1, len(self.begin)) for name in ("from", "start", "excess")
        )
        self.low, self.high = reals("low"), reals("high")
        self.back, self.panel_of = indices("back"), indices("panel_of")
        self.deepest = max(1, int(np.max(self.back, initial=0)), int(np.max(self.steps)))
        """How many windows back anything is asked for."""
        law, answers = indices("law"), indices("answer", self.panels, -1)
        shapes = [np.diff(tables[f"first_{name}"]) for name in ("point", "state", "port")]
        # bodies differ in ports, one of which may be missing; blocks are large, so those of a group have one matrix
        shapes[2][law == 1] = 0
        kinds = np.stack([law, *shapes, np.where(law == 2, answers[0], 0)], axis=1)
        self.groups = [
            (Scatterers, Bodies, Blocks)[kind[0]](self, tables, np.flatnonzero(np.all(kinds == kind, axis=1)), answers)
            for kind in np.unique(kinds, axis=0)
        ]

    def evaluate(self, tau: ArrayLike) -> NDArray[np.float64]:
        """All outputs at tau, an array or a number: shape (outputs, *tau.shape), NaN where tau is out of range.

        Marches once, up to the last tau.
        """
        taus = np.asarray(tau, dtype=self.real)
        flat = taus.ravel()
        out = np.full((self.outputs, flat.size), np.nan, self.real)
        inside = np.flatnonzero((flat >= 0) & (flat <= self.tau_max))
        if inside.size:
            order = inside[np.argsort(flat[inside], kind="stable")]
            windows = self.places(flat[order])[0]
            marching = Marching(self)
            count = int(windows[-1]) + 1
            for first in range(0, count, marching.most):
                block = marching.block(first, min(marching.most, count - first))
                begin, end = np.searchsorted(windows, [first, first + block.count])
                for low in range(begin, end, self.SAMPLES):
                    part = order[low : min(low + self.SAMPLES, end)]
                    out[:, part] = block.read(flat[part])
        return out.reshape(self.outputs, *taus.shape)

    def places(self, tau: NDArray[np.float64]) -> tuple[NDArray[np.int_], NDArray[np.int_], NDArray[np.float64]]:
        """Of each tau its window, the place of that in a cycle, and the time since the cycle began."""
        cycle = np.floor(tau / self.span)
        cycle -= cycle * self.span > tau
        t = tau - cycle * self.span
        phase = np.searchsorted(self.begin, t, side="right") - 1
        return cycle.astype(int) * len(self.begin) + phase, phase, t


class WindowBlock:
    """Some windows of a march: all tracks, (deepest + windows, track, panel, k), with those of the windows before.

    `starts` are the states at the start of each panel, `acting` what acts on each point there, `totals` the integrals
    at the start of each window and at the end of the last.
    """

    def __init__(
        self,
        scheme: MarchScheme,
        first: int,
        waves: NDArray[np.float64],
        starts: NDArray[np.float64],
        acting: NDArray[np.float64],
        totals: NDArray[np.float64],
    ) -> None:
        self._scheme, self.first, self.count, self.waves = scheme, first, len(starts), waves
        self.starts, self.acting = starts, acting
        self.totals = np.repeat(totals[:, None], self.count + 1, axis=1)
        self._integrals: dict[int, list[NDArray[np.float64]]] = {}
        self._limits: dict[tuple[int, int], tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
        n = np.arange(self.count)
        for output in range(scheme.outputs):
            if np.any(scheme.summed[self._output_terms(output)]):
                self.totals[output, 1:] += np.cumsum(self._integral_values(output, n, n, None), dtype=scheme.real)

    def read(self, tau: NDArray[np.float64]) -> NDArray[np.float64]:
        """All outputs at some tau in these windows."""
        return self.read_places(*self._scheme.places(tau))

    def read_places(
        self,
        window: NDArray[np.int_],
        phase: NDArray[np.int_],
        t: NDArray[np.float64],
        outputs: range | None = None,
    ) -> NDArray[np.float64]:
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

    def _direct_values(
        self, output: int, n: NDArray[np.int_], phase: NDArray[np.int_], t: NDArray[np.float64]
    ) -> NDArray[np.float64]:
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

    def _integral(self, track: int) -> list[NDArray[np.float64]]:
        """Of a track, on each panel, the antiderivatives on all windows, (k, windows)."""
        if track not in self._integrals:
            until = self._scheme.deepest + self.count
            self._integrals[track] = [
                _antiderivative(self.waves[:until, track, panel].T) for panel in range(self._scheme.panels)
            ]
        return self._integrals[track]

    def _ends(self, track: int, stretch: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
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

    def _integral_values(
        self, output: int, n: NDArray[np.int_], phase: NDArray[np.int_], t: NDArray[np.float64] | None
    ) -> NDArray[np.float64]:
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

    def __init__(self, scheme: MarchScheme, most: int | None = None) -> None:
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
                group.move(self._waves, scheme.deepest + n, acting[n], self._x, starts[n])
        made = WindowBlock(scheme, first, self._waves, starts, acting, self._totals)
        self._totals = made.totals[:, -1]
        return made


class RunningLoads:
    """The loads, polynomials in the time since their last change."""

    def __init__(self, scheme: MarchScheme, powers: NDArray[np.float64], since: NDArray[np.float64]) -> None:
        self._scheme, self._powers, self._since = scheme, powers, since
        self._now: dict[int, tuple[int, int, NDArray[np.float64]]] = {}
        self._event = 0

    def on_window(self, window: int) -> NDArray[np.float64]:
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


class JointGroup:
    """Joints that do the same and have as many points and states.

    Where one has fewer ports than another, what is missing is a port that neither takes nor gives.
    """

    def __init__(
        self,
        scheme: MarchScheme,
        tables: dict[str, tuple[float, ...]],
        joints: NDArray[np.int_],
        answers: NDArray[np.int_],
    ) -> None:
        def members(name: str) -> NDArray[np.int_]:
            firsts = np.array(tables[f"first_{name}"], int)
            counts = firsts[joints + 1] - firsts[joints]
            places = np.arange(np.max(counts))
            return np.where(places < counts[:, None], firsts[joints, None] + places, -1)

        def of_ports(name: str, missing: float) -> NDArray[np.float64]:
            return np.append(tables[name], missing).astype(scheme.real)[self.ports]

        self.joints = joints
        self.points, self.states, self.ports = members("point"), members("state"), members("port")
        self.arrive, self.send = (of_ports(name, len(scheme.held) - 1).astype(int) for name in ("arrive", "send"))
        self.back = scheme.steps[self.arrive]
        self.push, self.ratio = of_ports("push", 0), of_ports("ratio", 0)
        self.at = of_ports("point_of", 0).astype(int)[..., None] == np.arange(self.points.shape[1])
        self.size = scheme.degree + 1
        self._panels = np.arange(scheme.panels)[:, None, None]
        self._answers, self._matrix = answers[:, joints], np.array(tables["matrix"], scheme.real)
        self.drive = np.array(tables["drive"], scheme.real)[joints, None]
        self.prepare()

    def prepare(self) -> None:
        """Read what the matrices say."""
        raise NotImplementedError

    def matrices(self, width: int, height: int) -> NDArray[np.float64]:
        """Those of each panel and joint, turned: (panels, joints, width, height)."""
        places = self._answers[..., None] + np.arange(width * height)
        return np.asarray(self._matrix[places].reshape(*self._answers.shape, width, height))

    def move(
        self,
        waves: NDArray[np.float64],
        n: int,
        acting: NDArray[np.float64],
        x: NDArray[np.float64],
        starts: NDArray[np.float64],
    ) -> None:
        """A window, in which nothing arrives that is sent in it: what the joints send goes into `waves`.

        Their states x go on; `starts` takes them at the start of each panel.
        """
        a = waves[n - self.back, self.arrive, self._panels]
        waves[n, self.send, self._panels] = self.sent(a, acting[:, self.points], x, starts)

    def sent(
        self,
        a: NDArray[np.float64],
        load: NDArray[np.float64],
        x: NDArray[np.float64],
        starts: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """What goes out, (panels, joints, ports, k), where a arrives and a load, (panels, joints, points, 3), acts."""
        raise NotImplementedError


class Scatterers(JointGroup):
    """Joints without state."""

    def prepare(self) -> None:
        ports = self.ports.shape[1]
        self.columns = self.matrices(ports + self.points.shape[1], ports)
        self.waves, self.loads = (
            np.swapaxes(part, 2, 3).copy() for part in (self.columns[:, :, :ports], self.columns[:, :, ports:])
        )

    def sent(
        self,
        a: NDArray[np.float64],
        load: NDArray[np.float64],
        x: NDArray[np.float64],
        starts: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        out = self.waves @ a
        out[..., :3] += self.loads @ load
        return np.asarray(out)


class Bodies(JointGroup):
    """Masses between rods: their recurrences as scans, in log2(degree) steps."""

    def prepare(self) -> None:
        rows = np.swapaxes(self.matrices(self.size, 3), 2, 3)
        self.slack, self.loss = rows[:, :, 0, 0].copy(), rows[:, :, 1, 0].copy()
        rows[..., 0] = 0
        self.ratios, self.sums = rows[:, :, 0].copy(), np.moveaxis(rows[:, :, 1:], 2, 1).copy()
        self.down, self.up = [], []
        stride, down, up = 1, self.ratios, -self.ratios
        while stride < self.size and down.any():
            self.down.append((stride, down[..., :-stride].copy()))
            self.up.append((stride, up[..., stride:].copy()))
            longer, longer_up = np.zeros_like(down), np.zeros_like(up)
            longer[..., :-stride] = down[..., :-stride] * down[..., stride:]
            longer_up[..., stride:] = up[..., stride:] * up[..., :-stride]
            # what is too small to matter is 0, and ends the scan
            longer[np.abs(longer) < 2.0**-100] = 0
            stride, down, up = 2 * stride, longer, longer_up

    def sent(
        self,
        a: NDArray[np.float64],
        load: NDArray[np.float64],
        x: NDArray[np.float64],
        starts: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        p = (self.push[:, None, :] @ a)[:, :, 0]
        p[..., :3] += self.drive * load[:, :, 0]
        y = np.zeros_like(p)
        y[..., 1:] = p[..., :-1]
        y[..., 1] *= 2
        y[..., 1:-1] -= p[..., 2:]
        y *= self.ratios
        for stride, products in self.down:
            y[..., :-stride] += products * y[..., stride:]
        sums, mean, own = _total(self.sums * y[:, None]), np.zeros_like(y[..., 0]), self.states[:, 0]
        for panel, (begun, ended) in enumerate(sums):
            starts[panel, own] = x[own]
            begun = x[own] - begun
            mean[panel] = begun - self.slack[panel] * begun
            x[own] = mean[panel] + (ended - self.loss[panel] * mean[panel])
        y[..., 0] = 2 * mean
        for stride, products in self.up:
            y[..., stride:] += products * y[..., :-stride]
        y[..., 0] = mean
        return np.asarray(self.ratio[..., None] * y[:, :, None] - a)


class Blocks(JointGroup):
    """Joints with any other state, all with the same matrices."""

    def prepare(self) -> None:
        self.collect = np.swapaxes(self.at * self.push[..., None], 1, 2)
        self.spread = self.at * self.ratio[..., None]
        width = self.points.shape[1] * self.size + self.states.shape[1]
        self._answers = self._answers[:, :1]
        self.columns = self.matrices(width, width)[:, 0]

    def sent(
        self,
        a: NDArray[np.float64],
        load: NDArray[np.float64],
        x: NDArray[np.float64],
        starts: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        s = self.collect @ a
        s[..., :3] += load
        for panel, start in enumerate(starts):
            start[self.states] = x[self.states]
            answer = np.concatenate([s[panel].reshape(len(self.joints), -1), x[self.states]], axis=1)
            answer = answer @ self.columns[panel]
            x[self.states] += answer[:, s[0, 0].size :]
            s[panel] = answer[:, : s[0, 0].size].reshape(s[panel].shape)
        return np.asarray(self.spread @ s - a)


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
