"""One look of all pictures: size, font, colours.

A picture is WIDTH inches across, all its text has FONT points: shown 376 px across (a page on a phone) it has 9 px.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from io import BytesIO
from itertools import pairwise
from typing import Any, ParamSpec, TypeVar

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import Formatter

from wavesym.pictures.ticks import omitted_power, power_text, tick_text

WIDTH, FONT, DPI = 6.9, 12.0, 120  # inches, points, dots an inch
MAIN, GREATEST, LEAST, OTHER = "#1f4e9c", "#b2431f", "#1f4e9c", "#d0692b"
Dashes = str | tuple[int, tuple[int, ...]]
CURVES: tuple[tuple[Dashes, str], ...] = (
    ("-", "black"),
    ("--", "#1f4e9c"),
    ("-", "#d0692b"),
    ("-.", "#4d4d4d"),
    (":", "black"),
    ((0, (6, 2, 1, 2, 1, 2)), "#4a78ad"),
    ((0, (9, 3)), "#9a6420"),
    ((0, (3, 1)), "#777777"),
)
BETWEEN, FORMAL, SLIPS = "#e9ecf0", "0.75", "darkviolet"
_GRID, _ZERO, _SHADES = "0.92", "0.6", 101  # an odd number, so that 0 is white; few, so that files are small
_LOOK: Any = {"font.size": FONT, "font.family": "DejaVu Sans", "axes.titlesize": FONT, "legend.fontsize": FONT}
HALO = [withStroke(linewidth=2.5, foreground="white")]

P = ParamSpec("P")
R = TypeVar("R")


class NotebookFigure(Figure):
    """A figure that a notebook shows by itself, also before pyplot has taught it how."""

    def _repr_png_(self) -> bytes:
        content = BytesIO()
        self.savefig(content, format="png")
        return content.getvalue()


def with_style(draw: Callable[P, R]) -> Callable[P, R]:
    """A function that draws, with the font of all pictures and without a change of the user's settings."""

    @wraps(draw)
    def wrapper(*args: P.args, **keys: P.kwargs) -> R:
        with mpl.rc_context(_LOOK):
            return draw(*args, **keys)

    return wrapper


def new_figure(height: float, *, constrained: bool = True) -> Figure:
    """An empty figure, `height` inches high.

    Args:
        height: in inches.
        constrained: whether matplotlib finds room for texts; else axes have places of their own.
    """
    figure = NotebookFigure(figsize=(WIDTH, height), dpi=DPI, layout="constrained" if constrained else None)
    FigureCanvasAgg(figure)
    return figure


def curve_look(number: int, width: float) -> dict[str, Any]:
    """How a curve is drawn, the first being number 0: told from the others without colours."""
    dashes, colour = CURVES[number % len(CURVES)]
    return {"linestyle": dashes, "color": colour, "linewidth": width}


def set_title(figure: Figure, words: str) -> None:
    """What is seen in a figure, above it."""
    figure.suptitle(words, x=0.01, ha="left", weight="bold", fontsize=FONT)


def draw_grid(axes: Axes, *, zero: bool = True) -> None:
    """Pale lines at the ticks, below the curves, and a darker one at zero."""
    axes.set_axisbelow(True)
    axes.grid(True, color=_GRID, linewidth=0.6)
    if zero:
        axes.axhline(0, color=_ZERO, linewidth=0.7, zorder=1)


class _PlainFormatter(Formatter):
    """Numbers as they are beside the axes of pages, with as many digits as the steps between them have."""

    def format_ticks(self, values: Sequence[float]) -> list[str]:
        self.set_locs(list(values))
        size = 10.0**self._power
        step = min((high - low for low, high in pairwise(values)), default=values[0] if len(values) else 1.0)
        return [tick_text(value / size, step / size).replace("-", "\u2212") for value in values]

    def get_offset(self) -> str:
        return power_text(self._power) if self._power else ""

    @property
    def _power(self) -> int:
        assert self.axis is not None  # ticks are those of an axis
        low, high = self.axis.get_view_interval()
        return omitted_power(low, high)


def write_plain_numbers(axis: Axis) -> None:
    """Write the numbers of an axis as people do: 10\u202f000, not 1.0 and a power of ten apart."""
    axis.set_major_formatter(_PlainFormatter())


def colours(*, signed: bool) -> Colormap:
    """Shades from blue by white to red for values with a sign, from light to dark for sizes."""
    return mpl.colormaps["RdBu_r" if signed else "YlGnBu"].resampled(_SHADES).with_extremes(bad=FORMAL)
