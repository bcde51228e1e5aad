"""What a picture of histories has before it is drawn: panels of curves that share an axis, and what is left out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from wavesym.mechanics.model import Model
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.numbers.arrays import Array
from wavesym.pictures.histories import Histories, History
from wavesym.pictures.timescale import Timescale, timescale
from wavesym.pictures.units import unit_text
from wavesym.results.presentation import group_thousands, number_text

CURVES = 8  # that an eye can tell apart in a panel
MOST_PANELS = 6  # of a quantity
STRIPS = 4  # that take the room of a panel
_STRIP = 0.9  # inches
_TURNS, _LEVELS = 40, 20
_NOISE = 1e-12  # parts of the largest value; an extreme below it is 0 but for rounding
_MARKED = 3  # curves of a panel whose extremes are all marked; of more only the panel's own
_SYMBOL = {"collision": "u", "drive": "\u03b8", "building": "y"}


@dataclass(frozen=True)
class Mark:
    """Something to be seen on a curve: its number, and one point or two that a line joins, (n, 2)."""

    text: str
    points: Array
    weight: str = "bold"


@dataclass(frozen=True)
class PlotPanel:
    """Curves that share an axis: what is drawn upwards, how high the panel is (inches), what is marked.

    A strip is for one curve, on an axis with the `limits` of its like, and says all that there is to say above it.
    """

    title: str
    histories: tuple[History, ...]
    marks: tuple[Mark, ...] = ()
    height: float = 2.9
    limits: tuple[float, float] | None = None

    @property
    def summary(self) -> str:
        """Of a strip: the curve's name, and its extremes."""
        return f"{self.histories[0].name}: {', '.join(mark.text for mark in self.marks)}"

    def goes_on(self, before: PlotPanel) -> bool:
        """Whether it and the one before are strips of the same quantity."""
        return None is not self.limits == before.limits


def panels(histories: Histories, most: int = MOST_PANELS) -> list[PlotPanel]:
    """A panel for each quantity that moves, or several where one would be crowded; an empty one if nothing moves.

    At `most` so many of a quantity. Of curves that turn too often to be told apart, each has a strip of its own.
    """
    result: list[PlotPanel] = []
    scale = timescale(histories.model)
    for quantity, shown in quantities(histories).items():
        if is_stacked(shown):
            result += _strips(shown[: most * STRIPS], scale)
            continue
        count = min(-(-len(shown) // CURVES), most)
        title = axis_title(histories.model, quantity, shown[0].output.unit)
        parts = _even(shown[: count * CURVES], count)
        result += [PlotPanel(title, tuple(part), tuple(_extremes(part, scale))) for part in parts]
    return result or [PlotPanel(axis_title(histories.model, histories.outputs[0].output.quantity), ())]


def notes(histories: Histories, most: int = MOST_PANELS) -> list[str]:
    """What is not drawn, a line each."""
    lines = []
    for quantity, shown in quantities(histories).items():
        drawn = most * (STRIPS if is_stacked(shown) else CURVES)
        if len(shown) > drawn:
            lines.append(f"{quantity}: the first {drawn} of {len(shown)} outputs that move are drawn")
    if still := [history.name for history in histories.outputs if history.zero]:
        lines.append(f"0 throughout: {', '.join(still)}")
    if histories.dense:
        lines.append("there are more fronts than the picture has columns, so that a jump may be drawn as a steep line")
    return lines


def load_panel(loads: Sequence[History], height: float) -> PlotPanel:
    """Loads over time; in their unit, where all have the same."""
    units = {load.output.unit for load in loads}
    unit = units.pop() if len(units) == 1 else ""
    return PlotPanel(f"load\nin {unit_text(unit)}" if unit else "load", tuple(loads), height=height)


def axis_title(model: Model, quantity: str, unit: str = "") -> str:
    """A quantity in its unit, or as section 4 of the paper makes it dimensionless."""
    if unit or model.clock is not None:
        words = QUANTITIES[quantity].in_words_of(model.labels.kind).phrase
        return f"{words}\nin {unit_text(unit)}" if unit else words
    letter = _SYMBOL.get(model.labels.system["type"], "u")
    return f"{quantity}\n{QUANTITIES[quantity].axis.format(letter)} (dimensionless)"


def quantities(histories: Histories) -> dict[str, list[History]]:
    """What moves, by quantity."""
    found: dict[str, list[History]] = {}
    for history in histories.outputs:
        if not history.zero:
            found.setdefault(history.output.quantity, []).append(history)
    return found


def restless(history: History) -> bool:
    """Whether a curve turns too often to bear its name; what it does within a part of its height is no turn."""
    values = history.points[:, 1]
    levels = np.rint(values / (np.ptp(values) or 1.0) * _LEVELS)
    steps = np.diff(levels)
    return int(np.count_nonzero(np.diff(np.sign(steps[steps != 0])))) > _TURNS


def is_stacked(shown: Sequence[History]) -> bool:
    """Whether curves of a quantity are drawn one under the other."""
    return len(shown) > 1 and any(restless(history) for history in shown)


def _strips(shown: Sequence[History], scale: Timescale) -> Iterator[PlotPanel]:
    values = np.concatenate([history.points[:, 1] for history in shown])
    limits = float(np.min(values)), float(np.max(values))
    for history in shown:
        yield PlotPanel("", (history,), tuple(_extremes([history], scale)), _STRIP, limits)


def _even(shown: Sequence[History], count: int) -> list[Sequence[History]]:
    """Parts that differ by one at most."""
    cuts = [len(shown) * k // count for k in range(count + 1)]
    return [shown[low:high] for low, high in pairwise(cuts)]


def _extremes(shown: Sequence[History], scale: Timescale) -> Iterator[Mark]:
    """The greatest and the least value of each curve, or of all where they are many; what is formal has none."""
    for group in [[each] for each in shown] if len(shown) <= _MARKED else [shown]:
        points = np.vstack([history.extremes for history in group])
        ends = {int(np.argmax(points[:, 1])), int(np.argmin(points[:, 1]))}
        for k in sorted(ends, key=lambda k: float(points[k, 0])):
            tau, value = points[k]
            if abs(value) > _NOISE * np.max(np.abs(points[:, 1])):
                text = group_thousands(number_text(value, unit_text(shown[0].output.unit), 4))
                yield Mark(f"{text} at {scale.time_text(tau)}", points[k : k + 1], "normal")
