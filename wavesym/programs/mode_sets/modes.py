"""The modes of models that differ in numbers alone, in doubles, and each of these models as one with modes.

What the modes left out can add is computed as it is of proved modes (modes/undamped.py), from sums that are doubles,
too: an estimate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from wavesym.errors import UnservedError
from wavesym.exact.modes.cuts import Cut, cut
from wavesym.exact.modes.frequencies import bisect_frequencies
from wavesym.exact.modes.shape import rigid
from wavesym.exact.modes.statics import Shape, Statics
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import nearest
from wavesym.programs.mode_sets.network import (
    Columns,
    ModeColumns,
    StiffnessSets,
    column,
    double,
    drawn,
    pattern,
    stack_networks,
)
from wavesym.programs.modes.loads import Numbers, Roughness
from wavesym.programs.modes.projection import (
    Driver,
    ModalOutput,
    Projection,
    drivers_of,
    modal_output,
    places,
    share,
    static_shapes,
)
from wavesym.programs.modes.truncation import truncated
from wavesym.programs.modes.undamped import UndampedModes

_MORE = 1.1  # times as many modes as one set of numbers needs
_SPARE = 1e-12  # of sums of squares, for the roundings of their terms


@dataclass(frozen=True)
class ModeSets:
    """Models side by side: one of them is `like`, whose cut has the pattern of `network`, where numbers are columns.

    So are those of `outputs` and `drivers`. `zero_outputs` are 0 whatever the numbers.
    """

    like: UndampedModes
    network: Network
    outputs: Sequence[ModalOutput]
    drivers: Sequence[Driver]
    zero_outputs: tuple[bool, ...]
    fewest: int

    @cached_property
    def stiffness(self) -> StiffnessSets:
        return StiffnessSets(self.network, self.like.cut.network)

    @cached_property
    def statics(self) -> Statics:
        return StaticsSets(self.stiffness, double)

    def projection(self, count: int) -> ProjectionSets:
        """The first modes of all sets, found once."""
        if count not in self._known:
            self._known[count] = self._project(count)
        return self._known[count]

    @cached_property
    def _known(self) -> dict[int, ProjectionSets]:
        return {}

    def _project(self, count: int) -> ProjectionSets:
        stiffness, network, statics = self.stiffness, self.network, self.statics
        count = min(count, stiffness.modes or count)
        w = bisect_frequencies(stiffness, count)
        rows, wrong, blurred = stiffness.shapes(w)
        if statics.free is not None:
            w[:, 0] = wrong[:, 0] = blurred[:, 0] = 0.0
            for row, point in enumerate(stiffness.points):
                rows[row][:, :1] = statics.free[point]
        modes = ModeColumns(stiffness, w, stiffness.point_motions(rows))
        shapes = [static_shapes(statics, driver) for driver in self.drivers]
        pairs = list(zip(self.drivers, shapes, strict=True))
        imposed = [[_imposed_value(o, s) * d.gain for d, (s, _) in pairs] for o in self.outputs]
        static = [[o.value(s) * d.gain for d, (_, s) in pairs] for o in self.outputs]
        sizes = [(t.points[d.point] if s is None else statics.mass(s.points)) * d.gain**2 for d, (s, t) in pairs]
        one = len(w), 1
        return ProjectionSets(
            w,
            wrong,
            blurred,
            _side_by_side([o.value(modes) for o in self.outputs], w.shape),
            _side_by_side([share(network, d, modes) for d in self.drivers], w.shape),
            np.stack([_side_by_side(row, one)[..., 0] for row in imposed], 1),
            np.stack([_side_by_side(row, one)[..., 0] for row in static], 1),
            (np.array([o.power for o in self.outputs]), np.array([1 if s is None else 0 for s, _ in shapes])),
            (
                (1 + _SPARE) * _side_by_side([o.total(statics) for o in self.outputs], one)[..., 0],
                (1 + _SPARE) * _side_by_side(sizes, one)[..., 0],
            ),
        )


def _side_by_side(columns: Sequence[Columns | float], shape: tuple[int, ...]) -> Columns:
    """(sets, how many columns, ...)."""
    return np.stack([np.broadcast_to(each, shape) for each in columns], axis=1)


def _imposed_value(output: ModalOutput, shape: Shape | None) -> Any:
    """What an output is of the shape that a load imposes: 0 where it is that but for rounding, as of a drift."""
    if shape is None:
        return 0.0
    value = output.value(shape)
    size: Columns = sum(abs(weight) for weight in output.points.values())
    if output.slope:
        weight, end = output.slope
        size = abs(weight) / shape.statics.stiffness.network.bars[end.bar].delay
    return np.where(np.abs(value) > _SPARE * size, value, 0.0)


class StaticsSets(Statics):
    """Those of networks side by side."""

    @cached_property
    def free(self) -> list[Columns] | None:
        assert isinstance(self.stiffness, StiffnessSets)
        found = rigid(self.stiffness.like.network)
        if found is None:
            return None
        points = [double(q) for q in found]
        scale = self.mass(points) ** -0.5
        return [scale * q for q in points]


@dataclass(frozen=True)
class ProjectionSets:
    """`Projection` of sets, the first dimension; `wrong` and `blurred` are those of `Shapes`."""

    w: Columns
    wrong: Columns
    blurred: Columns
    outputs: Numbers
    shares: Numbers
    imposed: Numbers
    static: Numbers
    powers: tuple[Numbers, Numbers]
    totals: tuple[Numbers, Numbers]

    def of(self, number: int) -> Projection:
        """That of one set."""
        return Projection(
            self.w[number],
            self.outputs[number],
            self.shares[number],
            self.imposed[number],
            self.static[number],
            self.powers,
            (self.totals[0][number], self.totals[1][number]),
        )


@dataclass(frozen=True)
class ModesOfSet(UndampedModes):
    """One of the sets, whose modes are found together with those of all."""

    sets: ModeSets
    number: int

    @property
    def cut(self) -> Cut:
        return self.sets.like.cut

    @property
    def fewest(self) -> int:
        return self.sets.fewest

    @cached_property
    def drivers(self) -> tuple[Driver, ...]:
        return self.sets.like.drivers

    @cached_property
    def outputs(self) -> list[ModalOutput]:
        return self.sets.like.outputs

    @cached_property
    def zero_outputs(self) -> tuple[bool, ...]:
        return self.sets.zero_outputs

    def project(self, count: int) -> Projection:
        return self.sets.projection(count).of(self.number)

    def errors(self, known: Projection, count: int, loads: Sequence[Roughness] | None = None) -> Numbers:
        """As of proved modes; infinite where doubles have no shape."""
        with np.errstate(invalid="ignore"):
            return np.nan_to_num(super().errors(known, count, loads), nan=np.inf, posinf=np.inf)

    def looseness(self, count: int) -> Numbers:
        """A frequency that is a little wrong is so for as long as its mode remembers; a shape has some of its
        neighbours'. Each mode counts as much as it has in the sums of outputs."""
        found, known = self.sets.projection(count), self.project(count)
        w, wrong = known.w, found.wrong[self.number]
        gaps = np.diff(w * w, prepend=-np.inf, append=np.inf)
        with np.errstate(all="ignore"):
            kept = np.minimum(1 / (self.rule(known).ratios_at(w) * w), nearest(self.model.until))
            off = np.where(w > 0, wrong / (2 * w) * kept, 0.0) + wrong / np.minimum(gaps[:-1], gaps[1:])
            off += found.blurred[self.number]
            orders = np.array([output.order for output in self.outputs])[:, None]
            size = np.where(w > 0, np.abs(known.shares).max(axis=0) * np.abs(known.outputs) * w ** (orders - 2.0), 0.0)
            loose = size @ off / size.max(axis=1)
        return np.where(size.any(axis=1), np.nan_to_num(loose, nan=np.inf), 0.0)


def enough_modes(model: Model) -> int:
    """As many modes as a model needs for its tolerance, and some more for others like it.

    UnservedError, ToleranceError as for `modal_system`.
    """
    chain = UndampedModes(model.to_horizon())
    return min(int(_MORE * truncated(chain).count) + 1, chain.most)


def mode_sets(models: Sequence[Model], fewest: int) -> ModeSets:
    """Models side by side, in the order in which they are given, beginning with `fewest` modes.

    UnservedError for what modes do not serve, and for models that differ in more than numbers.
    """
    like = UndampedModes(models[0].to_horizon())
    like.refuse()
    cuts = [cut(model.network, places(model)) for model in models]
    if any(pattern(each.network) != pattern(cuts[0].network) for each in cuts[1:]):
        raise UnservedError("system: these models differ in more than numbers")
    rows = [[modal_output(m.network, c, probe) for probe in m.probes] for m, c in zip(models, cuts, strict=True)]
    drivers = [_drivers_of(model, like) for model in models]
    return ModeSets(
        like,
        stack_networks([each.network for each in cuts]),
        [_output_columns(each) for each in zip(*rows, strict=True)],
        [replace(each[0], gain=column(d.gain for d in each)) for each in zip(*drivers, strict=True)],
        generic_zeros(like),
        fewest,
    )


def _drivers_of(model: Model, like: UndampedModes) -> list[Driver]:
    """The loads of a model that are those of another."""
    sources = set(like.sources)
    return [each for each in drivers_of(model.network) if (each.step, each.ramp) in sources]


def _output_columns(outputs: Sequence[ModalOutput]) -> ModalOutput:
    """One output of each set. UnservedError where they are different sums."""
    first = outputs[0]
    if any(list(o.points) != list(first.points) or o.order != first.order for o in outputs):
        raise UnservedError("output: these models read different sums")
    slope = first.slope and (column(o.slope[0] for o in outputs if o.slope), first.slope[1])
    points: dict[int, Any] = {point: column(o.points[point] for o in outputs) for point in first.points}
    return replace(first, points=points, slope=slope)


def generic_zeros(like: UndampedModes) -> tuple[bool, ...]:
    """The outputs that are 0 in a model, and would be with other numbers."""
    if not any(like.zero_outputs):
        return like.zero_outputs
    other = UndampedModes(replace(like.model, network=drawn(like.model.network), preset=None))
    return tuple(a and b for a, b in zip(like.zero_outputs, other.zero_outputs, strict=True))
