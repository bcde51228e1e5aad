"""Pictures of a page over time: loads and histories. Each is an SVG with a title and a description."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import quote

import numpy as np
from numpy.typing import NDArray

from wavesym.pictures.groups import PlotPanel
from wavesym.pictures.histories import History
from wavesym.pictures.page.curves import HEIGHT, Grid, curve
from wavesym.pictures.page.frame import Frame, PlotAxis, spread
from wavesym.pictures.page.svg import Svg, concatenate, element, line, text
from wavesym.pictures.reduction import reduce_vertices
from wavesym.pictures.timescale import Timescale
from wavesym.pictures.units import unit_text

WIDTH, LEFT, RIGHT, TOP, BELOW = 900.0, 84.0, 12.0, 10.0, 44.0
_LOAD, _STRIP, _PANEL = 90.0, 66.0, 190.0  # pixels high
LETTER = 6.6  # wide
_UPRIGHT = (230.0, 470.0)  # from here, so wide: what stands in the middle, and words beside it
_PER_ROW = 12  # columns of a picture that have three rows of a CSV


@dataclass(frozen=True)
class PagePicture:
    """A picture: what it is called, its markup, and its curves: their look, their name, and their values as CSV."""

    title: str
    markup: Svg
    curves: tuple[tuple[int, str, str], ...] = ()
    strip: bool = False


def picture(
    number: str,
    title: str,
    description: str,
    height: float,
    *content: Svg,
    class_: str = "plot",
    is_upright: bool = False,
    **attributes: str | float,
) -> Svg:
    """An SVG that those who do not see it are told of; one that `is_upright` shows the middle of the width alone."""
    left, width = _UPRIGHT if is_upright else (0.0, WIDTH)
    return element(
        "svg",
        element("title", title, id=f"{number}-title"),
        element("desc", description, id=f"{number}-told"),
        *content,
        role="img",
        aria_labelledby=f"{number}-title {number}-told",
        viewBox=f"{left:.0f} 0 {width:.0f} {height:.0f}",
        class_=f"{class_} upright" if is_upright else class_,
        **attributes,
    )


def panel(number: str, given: PlotPanel, columns: int, until: float, scale: Timescale, *, last: bool) -> PagePicture:
    """The curves of a panel over time."""
    height, (low, high) = _size(given)
    grid = Grid.from_limits(columns, until, low, high)
    x = PlotAxis(0.0, until * scale.per_tau, LEFT, WIDTH - RIGHT)
    y = PlotAxis(grid.low, grid.high, TOP + height, TOP)
    frame = Frame(x, y, scale.title, given.title)
    curves = (curve(history, grid, look) for look, history in enumerate(given.histories))
    placed = element(
        "g",
        *curves,
        transform=f"translate({LEFT:g} {TOP:g}) scale({(x.end - x.start) / columns:.6g} {height / HEIGHT:.6g})",
    )
    spots = sorted(
        (value, x.pixel(tau * scale.per_tau), mark.text) for mark in given.marks for tau, value in mark.points
    )
    marks = [spot(at, y.pixel(value)) for value, at, _ in spots]
    if given.limits:
        marks.append(text(LEFT + 4, TOP + 11, given.summary, "start", class_="halo"))
    else:
        marks += [_label_near(at, y.pixel(value), words, above) for (value, at, words), above in _ends(spots)]
    description = " ".join(_describe(history, scale) for history in given.histories)
    quantity = given.histories[0].name if given.limits else given.title.split("\n")[0]
    title = f"{quantity} over time".capitalize()
    svg = picture(
        number,
        title,
        description,
        TOP + height + (BELOW if last else 8),
        frame.draw(numbers=last),
        placed,
        *marks,
        line(LEFT, TOP, LEFT, TOP + height, "cursor"),
        class_="plot timed",
        data_columns=columns,
        data_left=LEFT,
        data_right=WIDTH - RIGHT,
        data_low=repr(grid.low),
        data_high=repr(grid.high),
    )
    return PagePicture(
        title,
        svg,
        strip=given.limits is not None,
        curves=tuple(
            (look, history.name, _csv_link(history, columns, until, scale))
            for look, history in enumerate(given.histories)
        ),
    )


def _csv_link(history: History, columns: int, until: float, scale: Timescale) -> str:
    """An address that is the curve itself as CSV: of every few columns the first, the least and the greatest value."""
    time = f"t in {scale.unit}" if scale.unit else "tau"
    name = f"{history.name} in {history.output.unit}" if history.output.unit else history.name
    taus, values = reduce_vertices(history.points, until, columns // _PER_ROW).T
    return csv_address((time, name), taus * scale.per_tau, values)


def csv_address(names: tuple[str, str], x: NDArray[np.float64], y: NDArray[np.float64]) -> str:
    """An address that is two columns as CSV: their names, and six digits of each of their numbers."""
    lines = [f'{names[0]},"{names[1].replace(chr(34), chr(39))}"']
    lines += [f"{first:.6g},{second:.6g}" for first, second in zip(x.tolist(), y.tolist(), strict=True)]
    return "data:text/csv;charset=utf-8," + quote("\n".join(lines) + "\n", safe=",.+-")


def _size(given: PlotPanel) -> tuple[float, tuple[float, float]]:
    """How high a panel is, in pixels, and its values from bottom to top."""
    if given.limits:  # a strip, with room for a line above its curve
        low, high = spread(*given.limits, 0.06)
        return _STRIP, (low, high + 0.4 * (high - low))
    values = np.concatenate([history.points[:, 1] for history in given.histories])
    if given.marks:
        return _PANEL, spread(float(np.min(values)), float(np.max(values)), 0.14)
    return _LOAD, spread(min(0.0, float(np.min(values))), max(0.0, float(np.max(values))), 0.08)


def _describe(history: History, scale: Timescale) -> str:
    least, greatest = history.extremes
    unit = f" {unit_text(history.output.unit)}".rstrip()
    return (
        f"{history.name}: from {least[1]:.4g}{unit} at {scale.format(least[0])} "
        f"to {greatest[1]:.4g}{unit} at {scale.format(greatest[0])}."
    )


def _ends(spots: list[tuple[float, float, str]]) -> list[tuple[tuple[float, float, str], bool]]:
    """The least and the greatest of a panel, and whether what they are is written above."""
    return [(spots[0], False), (spots[-1], True)] if len(spots) > 1 else [(spot, True) for spot in spots]


def _label_near(x: float, y: float, words: str, above: bool) -> Svg:
    """Words above or below a spot, inside of the panel."""
    half = LETTER * len(words) / 2
    return text(min(max(x, LEFT + half), WIDTH - RIGHT - half), y - 7 if above else y + 16, words, class_="halo")


def spot(x: float, y: float) -> Svg:
    return element("circle", class_="spot", cx=x, cy=y, r=3)


def labelled_spot(x: float, y: float, words: str, *, above: bool) -> Svg:
    """A spot and what it is, written towards the middle."""
    right = x < (LEFT + WIDTH - RIGHT) / 2
    return concatenate(
        spot(x, y),
        text(x + (8 if right else -8), y + (-7 if above else 15), words, "start" if right else "end", class_="halo"),
    )
