"""Joints of a march in NumPy: what they send on a window, all joints of a kind at once."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from wavesym.programs.schemes.march import MarchScheme


class JointGroup:
    """Joints that do the same and have as many points and states, with a `step` on all panels of a window.

    It gives what goes out, (panels, joints, ports, k), where a arrives and a load, (panels, joints, points, 3), acts;
    the states x of the joints go on, and `starts` takes them at the start of each panel. Where a joint has fewer ports
    than another, what is missing is a port that neither takes nor gives.
    """

    def __init__(self, scheme: "MarchScheme", joints: NDArray[np.int_]) -> None:
        def members(name: str) -> NDArray[np.int_]:
            firsts = scheme.firsts[name]
            counts = firsts[joints + 1] - firsts[joints]
            places = np.arange(np.max(counts))
            return np.where(places < counts[:, None], firsts[joints, None] + places, -1)

        def of_ports(name: str) -> NDArray[np.float64]:
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

    def matrices(self, width: int, height: int) -> NDArray[np.float64]:
        """Those of each panel and joint, turned: (panels, joints, width, height)."""
        places = self._answers[..., None] + np.arange(width * height)
        return np.asarray(self._matrix[places].reshape(*self._answers.shape, width, height))

    def arriving_waves(self, waves: NDArray[np.float64], n: int) -> NDArray[np.float64]:
        """What arrives on window n, on which nothing of it is sent: (panels, joints, ports, k)."""
        return np.asarray(waves[n - self.back, self.arrive, self.panels])


class Scatterers(JointGroup):
    """Joints without state."""

    def __init__(self, scheme: "MarchScheme", joints: NDArray[np.int_]) -> None:
        super().__init__(scheme, joints)
        ports = self.ports.shape[1]
        self.columns = self.matrices(ports + self.points.shape[1], ports)
        self.waves, self.loads = (
            np.swapaxes(part, 2, 3).copy() for part in (self.columns[:, :, :ports], self.columns[:, :, ports:])
        )

    def step(
        self,
        a: NDArray[np.float64],
        load: NDArray[np.float64],
        x: NDArray[np.float64],
        starts: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """As JointGroup has it."""
        out = self.waves @ a
        out[..., :3] += self.loads @ load
        return np.asarray(out)


class Bodies(JointGroup):
    """Masses between rods: their recurrences as scans, in log2(degree) steps."""

    def __init__(self, scheme: "MarchScheme", joints: NDArray[np.int_]) -> None:
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

    def step(
        self,
        a: NDArray[np.float64],
        load: NDArray[np.float64],
        x: NDArray[np.float64],
        starts: NDArray[np.float64],
    ) -> NDArray[np.float64]:
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

    def __init__(self, scheme: "MarchScheme", joints: NDArray[np.int_]) -> None:
        super().__init__(scheme, joints)
        self.collect = np.swapaxes(self.at * self.push[..., None], 1, 2)
        self.spread = self.at * self.ratio[..., None]
        width = self.points.shape[1] * self.size + self.states.shape[1]
        self._answers = self._answers[:, :1]
        self.columns = self.matrices(width, width)[:, 0]

    def step(
        self,
        a: NDArray[np.float64],
        load: NDArray[np.float64],
        x: NDArray[np.float64],
        starts: NDArray[np.float64],
    ) -> NDArray[np.float64]:
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


def _total(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sums along the last axis, in pairs."""
    while values.shape[-1] > 1:
        half = values.shape[-1] // 2
        folded = values[..., : values.shape[-1] - half].copy()
        folded[..., :half] += values[..., values.shape[-1] - half :]
        values = folded
    return np.asarray(values[..., 0])
