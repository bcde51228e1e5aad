"""The march in NumPy: its numbers, and outputs at any tau."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesym.programs.schemes.march_joints import Blocks, Bodies, Scatterers
from wavesym.programs.schemes.march_windows import Marching


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
        # joints: where their points, states and ports start in the next tables, and the force on each point
        "first_point",
        "first_state",
        "first_port",
        "force_on",
        # ports: the point of the joint, how fast an end moves with it, and tracks
        "point_of",
        "ratio",
        "arrive",
        "send",
        # what acts for a wave that arrives at a port; what joints do (0 scatter, 1 a body, 2 a block), how strong loads
        # are on a body, and where on each panel their matrix is: of a body three numbers for each degree, slack, loss
        # and 0, then ratio, first and last
        "push",
        "law",
        "drive",
        "answer",
        "matrix",
        "initial_state",
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
