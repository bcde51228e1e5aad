"""The numbers of a march in NumPy, and its joints: what they send on a window, all joints of a kind at once."""

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array
from wavesym.programs.schemes.scheme import Scheme


class MarchNumbers(Scheme):
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

    def _read(self, tables: dict[str, tuple[float, ...]], constants: dict[str, float]) -> None:
        real = self.real

        def reals(name: str, *shape: int) -> Array:
            return np.array(tables[name], real).reshape(shape or -1)

        def indices(name: str, *shape: int) -> NDArray[np.int_]:
            return np.array(tables[name], int).reshape(shape or -1)

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
        law, self.answers = indices("law"), indices("answer", self.panels, -1)
        self.firsts = {name: indices(f"first_{name}") for name in ("point", "state", "port")}
        self.joint_numbers = {name: reals(name) for name in ("drive", "push", "ratio", "matrix")}
        self.ports = {name: indices(name) for name in ("point_of", "arrive", "send")}
        shapes = [np.diff(first) for first in self.firsts.values()]
        # bodies differ in ports, one of which may be missing; blocks are large, so those of a group have one matrix
        shapes[2][law == 1] = 0
        kinds = np.stack([law, *shapes, np.where(law == 2, self.answers[0], 0)], axis=1)
        self.groups: list[Scatterers | Bodies | Blocks] = [
            (Scatterers, Bodies, Blocks)[kind[0]](self, np.flatnonzero(np.all(kinds == kind, axis=1)))
            for kind in np.unique(kinds, axis=0)
        ]

    def places(self, tau: Array) -> tuple[NDArray[np.int_], NDArray[np.int_], Array]:
        """Of each tau its window, the place of that in a cycle, and the time since the cycle began."""
        cycle = np.floor(tau / self.span)
        cycle -= cycle * self.span > tau
        t = tau - cycle * self.span
        phase = np.searchsorted(self.begin, t, side="right") - 1
        return cycle.astype(int) * len(self.begin) + phase, phase, t


class JointGroup:
    """Joints that do the same and have as many points and states, with a `step` on all panels of a window.

    It gives what goes out, (panels, joints, ports, k), where a arrives and a load, (panels, joints, points, 3), acts;
    the states x of the joints go on, and `starts` takes them at the start of each panel. Where a joint has fewer ports
    than another, what is missing is a port that neither takes nor gives.
    """

    def __init__(self, scheme: MarchNumbers, joints: NDArray[np.int_]) -> None:
        def members(name: str) -> NDArray[np.int_]:
            firsts = scheme.firsts[name]
            counts = firsts[joints + 1] - firsts[joints]
            places = np.arange(np.max(counts))
            return np.where(places < counts[:, None], firsts[joints, None] + places, -1)

        def of_ports(name: str) -> Array:
            return np.append(scheme.joint_numbers[name], 0).astype(scheme.real)[self.ports]

        self.joints = joints
        self.points, self.states, self.ports = members("point"), members("state"), members("port")
        missing = len(scheme.held) - 1
        self.arrive, self.send = (np.append(scheme.ports[name], missing)[self.ports] for name in ("arrive", "send"))
        self.back = scheme.steps[self.arrive]
        self.push, self.ratio = of_ports("push"), of_ports("ratio")
        at = np.append(scheme.ports["point_of"], 0)[self.ports]
        self.at = at[..., None] == np.arange(self.points.shape[1])
        self.size = scheme.degree + 1
        self.panels = np.arange(scheme.panels)[:, None, None]
        self.drive = scheme.joint_numbers["drive"][joints, None]
        self._answers, self._matrix = scheme.answers[:, joints], scheme.joint_numbers["matrix"]

    def matrices(self, width: int, height: int) -> Array:
        """Those of each panel and joint, turned: (panels, joints, width, height)."""
        places = self._answers[..., None] + np.arange(width * height)
        return np.asarray(self._matrix[places].reshape(*self._answers.shape, width, height))

    def arriving_waves(self, waves: Array, n: int) -> Array:
        """What arrives on window n, on which nothing of it is sent: (panels, joints, ports, k)."""
        return np.asarray(waves[n - self.back, self.arrive, self.panels])


class Scatterers(JointGroup):
    """Joints without state."""

    def __init__(self, scheme: MarchNumbers, joints: NDArray[np.int_]) -> None:
        super().__init__(scheme, joints)
        ports = self.ports.shape[1]
        self.columns = self.matrices(ports + self.points.shape[1], ports)
        self.waves, self.loads = (
            np.swapaxes(part, 2, 3).copy() for part in (self.columns[:, :, :ports], self.columns[:, :, ports:])
        )

    def step(self, a: Array, load: Array, x: Array, starts: Array) -> Array:
        """As JointGroup has it."""
        out = self.waves @ a
        out[..., :3] += self.loads @ load
        return np.asarray(out)


class Bodies(JointGroup):
    """Masses between rods: their recurrences as scans, in log2(degree) steps."""

    def __init__(self, scheme: MarchNumbers, joints: NDArray[np.int_]) -> None:
        super().__init__(scheme, joints)
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

    def step(self, a: Array, load: Array, x: Array, starts: Array) -> Array:
        """As JointGroup has it."""
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

    def __init__(self, scheme: MarchNumbers, joints: NDArray[np.int_]) -> None:
        super().__init__(scheme, joints)
        self.collect = np.swapaxes(self.at * self.push[..., None], 1, 2)
        self.spread = self.at * self.ratio[..., None]
        width = self.points.shape[1] * self.size + self.states.shape[1]
        self._answers = self._answers[:, :1]
        self.columns = self.matrices(width, width)[:, 0]

    def step(self, a: Array, load: Array, x: Array, starts: Array) -> Array:
        """As JointGroup has it."""
        s = self.collect @ a
        s[..., :3] += load
        for panel, start in enumerate(starts):
            start[self.states] = x[self.states]
            answer = np.concatenate([s[panel].reshape(len(self.joints), -1), x[self.states]], axis=1)
            answer = answer @ self.columns[panel]
            x[self.states] += answer[:, s[0, 0].size :]
            s[panel] = answer[:, : s[0, 0].size].reshape(s[panel].shape)
        return np.asarray(self.spread @ s - a)


def _total(values: Array) -> Array:
    """Sums along the last axis, in pairs."""
    while values.shape[-1] > 1:
        half = values.shape[-1] // 2
        folded = values[..., : values.shape[-1] - half].copy()
        folded[..., :half] += values[..., values.shape[-1] - half :]
        values = folded
    return np.asarray(values[..., 0])
