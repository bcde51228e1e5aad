"""What each window adds to the error of a march, by truncation and by rounding: bound.py says how, and adds it up."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.march.plan import MarchPlan, Panel
from wavesym.programs.march.responses import NEGLIGIBLE, body_roundings
from wavesym.programs.march.tables import MarchTables
from wavesym.programs.schemes.march import MarchScheme, RunningLoads, WindowBlock
from wavesym.programs.schemes.march_joints import Blocks, Bodies, JointGroup, Scatterers

# roundings of a product in a sum, besides those of the sum: of factors, pushes, loads and their times
_SPARE = 24
_LOADED = 5  # times those of a sum of at least 5 products are no less than those of a load and its times


def block_loss(turned: float) -> float:
    """What a block adds to the norm of energy for each unit of eps, where rates times the panel's length is `turned`.

    2 sqrt(g h) is that of the waves that it sends, 2 (1 + g h)/sqrt(2) that of the state at the end.
    """
    return 2 * (sqrt(turned) + (1 + turned) / sqrt(2))


class Losses:
    """What windows add to the error: in the norm of energy, and on tracks that carry none.

    `begun` is what the numbers of the start lose. `direct` is how wrong what is read of each track may be by itself.
    """

    def __init__(self, plan: MarchPlan, made: MarchTables, scheme: MarchScheme, unit: float, smallest: float) -> None:
        self._scheme, self._unit, self._smallest = scheme, unit, smallest
        # of the same loads, how large what cancels may have been
        self._loads = RunningLoads(scheme, np.abs(scheme.event_power), np.abs(scheme.since))
        self._lengths = [nearest(panel.length) for panel in plan.panels]
        self._impedance = np.array([*(nearest(track.impedance) for track in plan.tracks), 0.0])
        self._weights = np.array([nearest(weight) for joint in plan.joints for weight in joint.space.weights])
        self._pushes = max(group.send.shape[1] for group in scheme.groups)
        first = [plan.joints[group.joints[0]] for group in scheme.groups]
        self._norms = [joint.space.norm for joint in first]
        self._missed: dict[tuple[int, int], Array] = {}
        self._bodies: dict[tuple[int, int], BodyLosses] = {}
        for number, group in enumerate(scheme.groups):
            for place, panel in enumerate(plan.panels):
                if isinstance(group, Blocks):
                    self._missed[number, place] = made.block(first[number], panel.length).truncation_error
                if isinstance(group, Bodies):
                    self._bodies[number, place] = self._body_losses(plan, made, group, panel)
        delays = nearest(plan.step) * scheme.steps
        self.initial_error = unit * sqrt(
            delays * self._impedance @ scheme.held**2 + self._weights @ scheme.initial_state**2 / 2
        )
        self.direct = np.zeros(len(scheme.held))

    def of_block(self, block: WindowBlock) -> tuple[float, float]:
        """By truncation and by rounding, in all windows of a block."""
        panels = range(len(self._lengths))
        loads = np.array([self._loads.on_window(block.first + n) for n in range(block.count)])
        lost = inexact = 0.0
        for panel in panels:
            truncation, rounding = np.zeros(block.count), np.zeros(block.count)
            for number, group in enumerate(self._scheme.groups):
                a, sent = self._waves(block, group, panel)
                size = loads[:, panel, group.points]
                x = block.starts[:, panel, group.states]
                if isinstance(group, Bodies):
                    wrong, single, ends, missed = self._of_bodies(group, self._bodies[number, panel], a, sent, size, x)
                elif isinstance(group, Blocks):
                    acting = block.acting[:, panel, group.points]
                    wrong, single, ends, missed = self._of_blocks(group, number, panel, a, sent, acting, size, x)
                else:
                    wrong, single, ends, missed = self._of_scatterers(group, panel, a, size)
                rounding += np.sum(self._weights[group.states] / 2 * ends**2, axis=(1, 2))
                rounding += pi / 4 * self._lengths[panel] * np.sum(self._impedance[group.send] * wrong, axis=(1, 2))
                truncation += missed
                np.maximum.at(self.direct, group.send, np.max(single, axis=0))
            lost += float(np.sum(np.sqrt(truncation)))
            inexact += float(np.sum(np.sqrt(rounding)))
        return lost, inexact

    def _waves(self, block: WindowBlock, group: JointGroup, panel: int) -> tuple[Array, Array]:
        """What arrives at the joints and what they send, (windows, joints, ports, k)."""
        n = self._scheme.deepest + np.arange(block.count)[:, None, None]
        return block.waves[n - group.back, group.arrive, panel], block.waves[n, group.send, panel]

    def _body_losses(self, plan: MarchPlan, made: MarchTables, group: Bodies, panel: Panel) -> BodyLosses:
        joints = [plan.joints[number] for number in group.joints]
        operators = [made.body(joint, panel.length) for joint in joints]
        known = {id(one): body_roundings(one, group.ports.shape[1] + 4) for one in operators}
        rates = np.array([[nearest(joint.space.rate * panel.length)] for joint in joints])
        share = 4 * rates[:, 0] + 2
        return BodyLosses(
            np.array([known[id(one)] for one in operators]),
            np.array([one.leak for one in operators]),
            self._weights[group.states[:, 0]] * share,
            np.sqrt(2 * share),
        )

    def _of_bodies(
        self, group: Bodies, of: BodyLosses, a: Array, sent: Array, size: Array, x: Array
    ) -> tuple[Array, Array, Array, Array]:
        """Of waves squares and sums of what may be wrong, of states errors, and squares of what is missed."""
        unit, acting = self._unit, np.einsum("jp,wjpk->wjk", np.abs(group.push), np.abs(a))
        acting[..., :3] += _LOADED * group.drive * size[:, :, 0]
        lowest = np.full((*acting.shape[:2], 1), self._smallest)
        given = np.concatenate([unit * acting, unit * np.abs(x), lowest], axis=-1)
        made = np.moveaxis(of.roundings @ np.moveaxis(given, 0, -1), -1, 0)
        q, ends = _norm(made[..., :-1]), made[..., -1]
        turned = np.abs(group.ratio)
        near = unit * (_norm(sent) + np.where(turned == 1, 0.0, 2.0) * (_norm(a) + _norm(sent)))
        wrong = turned * q[..., None] + near + 4 * sqrt(group.size + 1) * self._smallest
        # the last coefficients of q and p, from what is sent, about
        last = (sent[..., 0, -1] + a[..., 0, -1]) / group.ratio[:, 0]
        excess = np.abs(last - np.sum(group.push * a[..., -1], axis=-1))
        about = 4 * unit * (np.abs(sent[..., 0, -1]) + np.abs(a[..., 0, -1])) / turned[:, 0]
        missed = of.leak * (excess + about)
        # what rounding makes of the same counts as if the body were wrong by it at the end
        ends += of.end_error * of.leak * (q + (2 * self._pushes + 4) * unit * _norm(acting))
        single = sqrt(group.size) * wrong
        return wrong**2, single, ends[..., None], np.asarray(np.sum(of.squared_loss * missed**2, axis=-1))

    def _of_blocks(
        self, group: Blocks, number: int, panel: int, a: Array, sent: Array, acting: Array, size: Array, x: Array
    ) -> tuple[Array, Array, Array, Array]:
        """The same."""
        loaded, largest = (np.zeros((*a.shape[:2], group.points.shape[1], group.size)) for _ in range(2))
        loaded[..., :3], largest[..., :3] = acting, size
        given = _block_matrix(group.collect @ a + loaded, x)
        sizes = _block_matrix(np.abs(group.collect) @ np.abs(a) + largest, np.abs(x))
        turned = self._norms[number] * self._lengths[panel]
        missed = self._truncation_losses(self._missed[number, panel], turned, given, sizes)
        wrong, ends = self._response_errors(group, panel, sizes)
        wrong = np.abs(group.spread) @ wrong + 3 * self._unit * (np.abs(sent) + np.abs(a)) + 4 * self._smallest
        return _square(wrong), np.sum(wrong, axis=-1), ends, missed

    def _of_scatterers(self, group: Scatterers, panel: int, a: Array, size: Array) -> tuple[Array, Array, Array, Array]:
        """The same."""
        matrix = np.abs(group.columns[panel])
        acting = np.concatenate([np.abs(a), np.zeros((*size.shape[:-1], group.size))], axis=2)
        acting[:, :, a.shape[2] :, :3] = _LOADED * size
        count = matrix.shape[1] + 4
        wrong = self._unit * count * (np.swapaxes(matrix, 1, 2) @ acting)
        small = count * (1 + np.sum(matrix, axis=1)) + np.sum(acting, axis=(2, 3))[..., None]
        wrong += self._smallest * (small + 4)[..., None]
        none = np.zeros((len(a), len(group.joints), 0))
        return _square(wrong), np.sum(wrong, axis=-1), none, np.zeros(len(a))

    def _products(self, columns: Array, sizes: Array) -> Array:
        """How wrong (..., rows) times (rows, columns) may be, from absolute values.

        What is multiplied is itself a sum of pushes, and so are the `sizes`.
        """
        size = np.abs(columns) + NEGLIGIBLE * np.max(np.abs(columns))
        count = len(columns) + self._pushes + _SPARE
        small = count * (1 + np.sum(size, axis=0)) + np.sum(sizes, axis=-1, keepdims=True)
        return np.asarray(self._unit * count * (sizes @ size) + self._smallest * small)

    def _response_errors(self, group: Blocks, panel: int, sizes: Array) -> tuple[Array, Array]:
        """How wrong velocities (windows, joints, points, k) and states at the end may be."""
        columns, states = group.columns[panel], group.states.shape[1]
        wrong = self._products(columns, sizes)
        after = sizes[..., -states:] + sizes @ np.abs(columns[:, -states:])
        ends = wrong[..., -states:] + 2 * self._unit * after
        return wrong[..., :-states].reshape(*sizes.shape[:2], -1, group.size), ends

    def _truncation_losses(self, missed: Array, turned: float, given: Array, sizes: Array) -> Array:
        """The squares of what is lost by truncation, (windows,)."""
        eps = np.linalg.norm(np.abs(given @ missed.T) + self._products(missed.T, sizes), axis=-1)
        return np.asarray(np.sum((eps * block_loss(turned)) ** 2, axis=1))


@dataclass(frozen=True)
class BodyLosses:
    """Of bodies on a panel: their `roundings`, (joints, d + 2, d + 3), leaks, and what a leak of 1 costs.

    That is a `squared_loss` of energy, or an `end_error` of the velocity.
    """

    roundings: Array
    leak: Array
    squared_loss: Array
    end_error: Array


def _square(wrong: Array) -> Array:
    """The squares of norms that count c_0 twice."""
    return np.asarray(np.sum(wrong**2, axis=-1) + wrong[..., 0] ** 2)


def _norm(series: Array) -> Array:
    """Norms that count c_0 twice."""
    return np.sqrt(_square(series))


def _block_matrix(acting: Array, x: Array) -> Array:
    """What the matrix of a block is multiplied with, (windows, joints, columns)."""
    return np.concatenate([acting.reshape(*acting.shape[:2], -1), x], axis=2)
