"""Pictures of a sweep: an output over one field that is varied, or as colours over two."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.pictures.page.frame import Frame, PlotAxis, spread
from wavesym.pictures.page.places import colour_bar
from wavesym.pictures.page.plots import BELOW, LEFT, RIGHT, TOP, WIDTH, PagePicture, labelled_spot, picture, spot
from wavesym.pictures.page.png import colour_image
from wavesym.pictures.page.svg import Svg, element, polyline, upright
from wavesym.pictures.reduction import reduce_vertices
from wavesym.pictures.units import unit_text
from wavesym.results.presentation import number_text, readable_unit
from wavesym.sweeps.results import StoredAxis, StoredColumn, SweepResults

_TALL, _MAP = 230.0, 360.0  # pixels high
_CELLS = 120  # of a map, in each direction; of more the greatest of some is shown
_COLUMNS = 300  # of a curve
_NUMBERED = 10
_DOTS = 2000  # cases, of which each is a dot
_LONGEST = 60  # characters of a text in a picture


@dataclass(frozen=True)
class SweepOutput:
    """An output of all cases: its least and greatest values over all dimensions, NaN where there is none."""

    name: str
    unit: str
    least: Array
    greatest: Array

    @property
    def title(self) -> str:
        return f"{self.name} in {self.unit}" if self.unit else f"{self.name} (dimensionless)"

    @property
    def size(self) -> Array:
        """The larger of both, without sign."""
        return np.fmax(np.abs(self.least), np.abs(self.greatest))


def outputs_of(found: SweepResults, most: int) -> list[SweepOutput]:
    """The first outputs, then what was kept of the first links, which has one value a case.

    Of statistics that were not kept, the other one stands for both.
    """
    low, high = ("min" if "min" in found.statistics else "max"), ("max" if "max" in found.statistics else "min")
    every = []
    if low in found.statistics:
        names = list(found.outputs.items())[:most]
        every += [SweepOutput(*each, found.values(low, k), found.values(high, k)) for k, each in enumerate(names)]
    for statistic in found.link_statistics:
        for k, (link, unit) in enumerate(list(found.manifest.links.items())[:most]):
            values = found.values(statistic, k)
            every.append(SweepOutput(f"{statistic} of {link}", unit, values, values))
    return [_readable(each) for each in every]


def _readable(output: SweepOutput) -> SweepOutput:
    """The same in the unit that people write for values so large."""
    largest = output.size[np.isfinite(output.size)]
    size, unit = readable_unit(float(largest.max(initial=0.0)), output.unit)
    return SweepOutput(output.name, unit_text(unit), output.least / size, output.greatest / size)


def axes_of(found: SweepResults) -> list[int]:
    """The dimensions that pictures have: the first two with more than one value, records last."""
    free = [k for k, dimension in enumerate(found.dimensions) if len(dimension) > 1]
    return sorted(sorted(free, key=lambda k: found.dimensions[k].name == "record")[:2])


def output_picture(number: str, output: SweepOutput, found: SweepResults) -> PagePicture | None:
    """Over what was varied; None where no case is done, or nothing was varied."""
    own = axes_of(found)
    if not own or not np.isfinite(output.size).any():
        return None
    rest = tuple(k for k in range(len(found.shape)) if k not in own)
    axes = [found.dimensions[k] for k in own]
    beyond = [found.dimensions[k].name for k in rest if len(found.dimensions[k]) > 1]
    if len(axes) == 1:
        return _curve(number, output, axes[0])
    return _map(number, output, np.fmax.reduce(output.size, axis=rest), axes, beyond)


def _curve(number: str, output: SweepOutput, axis: StoredAxis) -> PagePicture:
    """Least and greatest over numbers; over anything else from the case of the largest size to that of the smallest.

    Where columns are zipped it is over the first whose numbers differ: a line where the others change as it does, else
    a dot for each case.
    """
    least, greatest = output.least.ravel(), output.greatest.ravel()
    done = np.flatnonzero(np.isfinite(output.size.ravel()))
    column = _leading(axis)
    dotted = column is not None and not _goes_along(axis, column) and len(done) <= _DOTS
    ordered = column is not None and (dotted or _goes_along(axis, column))
    if column is not None and ordered:
        along = np.array(column.coordinate, dtype=float)
        done = done[np.argsort(along[done], kind="stable")]
        x_title = f"{column.path if len(axis.columns) > 1 else axis.name} {f'in {column.unit}' * bool(column.unit)}"
        x_title = x_title.rstrip() + f", with {_others(axis, column)}" * (len(axis.columns) > 1)
    else:
        done, x_title = done[np.argsort(-output.size.ravel()[done])], f"{axis.name}, the largest first"
        along = np.empty(len(axis))
        along[done] = np.arange(1, len(done) + 1)
    low, high = spread(min(0.0, float(np.min(least[done]))), max(0.0, float(np.max(greatest[done]))), 0.1)
    ends = spread(float(along[done].min()), float(along[done].max()), 0.02)
    x, y = PlotAxis(*ends, LEFT, WIDTH - RIGHT), PlotAxis(low, high, TOP + _TALL, TOP)
    numbers = None if ordered else [(float(k), str(k)) for k in range(1, len(done) + 1, -(-len(done) // _NUMBERED))]
    worst = int(np.nanargmax(output.size.ravel()))
    value = float(greatest[worst] if greatest[worst] >= -least[worst] else least[worst])
    title = f"{output.name} over {column.path if column and ordered else axis.name}"
    description = f"Largest: {number_text(value, output.unit, 5)} where {_case_label(axis, worst)}."
    parts: list[Svg] = [Frame(x, y, x_title, output.title, x_places=numbers).draw()]
    for values, class_, sign in ((least, "least", -1.0), (greatest, "greatest", 1.0)):
        points = np.column_stack([along[done] - x.low, values[done]])
        if dotted:
            parts += [
                element("circle", class_=f"dot {class_}", cx=x.pixel(at + x.low), cy=y.pixel(value), r=2)
                for at, value in points.tolist()
            ]
            continue
        if ordered:
            points = reduce_vertices(points, x.high - x.low, _COLUMNS)
        elif len(done) > _COLUMNS:  # of some the longest
            starts = np.arange(_COLUMNS) * len(done) // _COLUMNS
            points = np.column_stack([points[starts, 0], sign * np.maximum.reduceat(sign * points[:, 1], starts)])
        places = [(x.pixel(at + x.low), y.pixel(value)) for at, value in points.tolist()]
        parts.append(polyline(places, class_) if ordered else upright(places, y.pixel(0.0), class_))
    parts.append(
        labelled_spot(x.pixel(float(along[worst])), y.pixel(value), _short(_case_label(axis, worst)), above=value > 0)
    )
    return PagePicture(title, picture(number, title, description, TOP + _TALL + BELOW, *parts))


def _leading(axis: StoredAxis) -> StoredColumn | None:
    """The column that an axis of a picture has: the first of numbers that differ."""
    return next((each for each in axis.columns if each.numbers and len(set(each.coordinate)) > 1), None)


def _goes_along(axis: StoredAxis, leading: StoredColumn) -> bool:
    """Whether all columns rise, fall or stay as one does, so that a line through the cases means something."""
    if len(axis.columns) == 1:
        return True
    order = np.argsort(np.array(leading.coordinate, dtype=float), kind="stable")
    if not all(each.numbers for each in axis.columns) or len(set(leading.coordinate)) < len(axis):
        return False
    steps = [np.diff(np.array(each.coordinate, dtype=float)[order]) for each in axis.columns]
    return all(bool(np.all(step >= 0) or np.all(step <= 0)) for step in steps)


def _others(axis: StoredAxis, leading: StoredColumn) -> str:
    """What else changes along an axis, short."""
    return _short(", ".join(each.path for each in axis.columns if each is not leading))


def _map(number: str, output: SweepOutput, size: Array, axes: list[StoredAxis], beyond: list[str]) -> PagePicture:
    """The size as colours, the first dimension to the right, the second upward, each value as wide as the next."""
    across, upward = axes
    low, high = float(np.nanmin(size)), float(np.nanmax(size))
    x, y = (
        PlotAxis(0.5, len(across) + 0.5, LEFT, WIDTH - RIGHT),
        PlotAxis(0.5, len(upward) + 0.5, TOP + _MAP, TOP),
    )
    image = colour_image(_fewer(size).T, x, y, (low, high if high > low else low + 1), signed=False)
    worst = np.unravel_index(int(np.nanargmax(size)), size.shape)
    where = ", ".join(_case_label(axis, int(k)) for axis, k in zip(axes, worst, strict=True))
    frame = Frame(x, y, _axis_title(across), _axis_title(upward), _places(upward), _places(across))
    name = f"size of {output.title}" + f", the greatest over {' and '.join(beyond)}" * bool(beyond)
    bar = colour_bar(
        f"{name}; at the spot {_short(where)}", (f"{low:.4g}", f"{high:.4g}"), TOP + _MAP + BELOW, signed=False
    )
    title = f"{output.name} over {across.name} and {upward.name}"
    ends = f"from {number_text(low, output.unit, 5)} to {number_text(high, output.unit, 5)}"
    description = f"Colours show the size, {ends}, the largest where {where}."
    # words beside the spot would cover the colours of other cases
    mark = spot(x.pixel(float(worst[0] + 1)), y.pixel(float(worst[1] + 1)))
    return PagePicture(
        title,
        picture(number, title, description, TOP + _MAP + BELOW + 34, frame.draw(), image, mark, bar),
    )


def _fewer(values: Array) -> Array:
    """As many cells as one sees, each the greatest of those that it stands for."""
    for axis, n in enumerate(values.shape):
        starts = np.unique(np.arange(_CELLS) * n // _CELLS)
        values = np.fmax.reduceat(values, starts, axis=axis)
    return values


def _places(axis: StoredAxis) -> list[tuple[float, str]]:
    """What is written along a dimension of a map: numbers, or of anything else its number in the list."""
    column = axis.columns[0]
    numbers = column.numbers and len(axis.columns) == 1
    step = -(-len(axis) // _NUMBERED)
    return [(k + 1.0, f"{column.coordinate[k]:.4g}" if numbers else str(k + 1)) for k in range(0, len(axis), step)]


def _axis_title(axis: StoredAxis) -> str:
    column = axis.columns[0]
    if column.numbers and len(axis.columns) == 1:
        return f"{axis.name} in {column.unit}" if column.unit else axis.name
    return f"{axis.name}, by its number in the list"


def _case_label(axis: StoredAxis, k: int) -> str:
    return ", ".join(f"{column.path} = {column.format(k)}" for column in axis.columns)


def _short(words: str) -> str:
    """A text without its middle, where it is too long for a picture."""
    half = _LONGEST // 2
    return words if len(words) <= _LONGEST else f"{words[:half]}\u2026{words[-half:]}"
