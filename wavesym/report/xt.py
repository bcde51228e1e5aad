"""Place x time: what every rod carries at every instant, as waves are drawn on paper, time upward.

A cell of the picture shows the value at its middle, which is shifted by a part of a cell that no front lies on, so that
fronts are as crisp as the picture is fine. Masses are thick lines, other nodes thin ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from flint import fmpq
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from wavesym.exact.field import Field
from wavesym.model.model import Model
from wavesym.model.network import Network
from wavesym.numbers.doubles import nearest

Array = NDArray[np.float64]

_WIDTH, _HEIGHT, _FONT = 11.0, 7.5, 9  # inches, points
_ROWS, _COLUMNS = 900, 700  # cells of all lines together
_OFF = 0.4142  # of a cell: where in it the value is taken
_COLOURS = "RdBu_r"
_THICK, _THIN = 4.0, 0.6
_NAMED = {"velocity": "velocity", "force": "force (impedance times strain), pull red, push blue"}


@dataclass(frozen=True)
class ChainLine:
    """Bars one after another: the main line of a chain, or a branch; where each of its nodes is along it."""

    name: str
    bars: tuple[int, ...]
    nodes: tuple[tuple[float, int], ...]

    @property
    def length(self) -> float:
        """From its first node to its last."""
        return self.nodes[-1][0]


def draw(model: Model) -> Figure:
    """Velocity and force of all rods over the horizon. CostError as for outputs of all rods."""
    field = Field(model)
    lines = list(_lines(model.network))
    until = nearest(model.until)
    figure = Figure(figsize=(_WIDTH, _HEIGHT), dpi=120)
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        2,
        2 * len(lines) + 1,
        width_ratios=[*(line.length for line in lines), 0.08 * lines[0].length, *(line.length for line in lines)],
        height_ratios=(1, 0.03),
        left=0.06,
        right=0.98,
        top=0.9,
        bottom=0.08,
        wspace=0.12,
        hspace=0.16,
    )
    figure.suptitle(f"{model.name}: {model.labels.system['type']}, tau upward to {until:g}", x=0.06, ha="left")
    for first, quantity in ((0, "velocity"), (len(lines) + 1, "force")):
        images = [_image(field, line, until, quantity) for line in lines]
        largest = max(float(np.max(np.abs(image[2]), initial=0.0)) for bars in images for image in bars) or 1.0
        norm = Normalize(-largest, largest)
        for column, (line, bars) in enumerate(zip(lines, images, strict=True)):
            axes = figure.add_subplot(grid[0, first + column])
            for x, tau, values in bars:
                axes.pcolormesh(x, tau, values, cmap=_COLOURS, norm=norm, rasterized=True)
            _frame(axes, model.network, line, until, column == 0)
        place = figure.add_subplot(grid[1, first : first + len(lines)])
        bar = figure.colorbar(ScalarMappable(norm, _COLOURS), cax=place, orientation="horizontal")
        bar.ax.tick_params(labelsize=_FONT - 1)
        bar.set_label(_NAMED[quantity], fontsize=_FONT)
    return figure


def _lines(network: Network) -> Iterator[ChainLine]:
    """The bars in chains: each goes on where the last one ended; what begins at an inner point is a branch."""
    left = list(range(len(network.bars)))
    while left:
        bars = [left.pop(0)]
        nodes = [(0.0, network.bars[bars[0]].left)]
        x = fmpq(0)
        while True:
            bar = network.bars[bars[-1]]
            x += bar.length
            nodes.append((nearest(x), bar.right))
            following = bars[-1] + 1
            if following not in left or not _continues(network, bar.right, following):
                break
            left.remove(following)
            if network.bars[following].left != bar.right:
                nodes.append((nearest(x), network.bars[following].left))
            bars.append(following)
        yield ChainLine(f"from point {nodes[0][1]}" if bars[0] else "", tuple(bars), tuple(nodes))


def _continues(network: Network, end: int, following: int) -> bool:
    """Whether a bar goes on from a point: it begins there without a gear, or at a point that a link holds."""
    bar = network.bars[following]
    held = any({end, bar.left} == {link.left, link.right} for link in network.links)
    return bar.ratios[0] == 1 and (end == bar.left or held)


def _image(field: Field, line: ChainLine, until: float, quantity: str) -> list[tuple[Array, Array, Array]]:
    """The cells of every bar of a line: their edges, and the values in them, (rows, columns)."""
    edges = np.linspace(0.0, until, _ROWS + 1)
    tau = edges[:-1] + _OFF * (edges[1] - edges[0])
    images = []
    ends = [x for k, (x, _) in enumerate(line.nodes) if k == 0 or x != line.nodes[k - 1][0]]
    for number, bar in enumerate(line.bars):
        low, high = ends[number], ends[number + 1]
        count = max(8, int(_COLUMNS * (high - low) / line.length))
        columns = np.linspace(low, high, count + 1)
        part = (np.arange(count) + _OFF) / count
        velocity, force = field.at(bar, *np.meshgrid(part, tau))
        images.append((columns, edges, velocity if quantity == "velocity" else force))
    return images


def _frame(axes: Axes, network: Network, line: ChainLine, until: float, first: bool) -> None:
    masses: Sequence[float] = [nearest(network.points[point].mass) for _, point in line.nodes]
    for (x, point), mass in zip(line.nodes, masses, strict=True):
        axes.axvline(x, color="black", linewidth=_THICK if mass else _THIN)
        if network.points[point].name:
            axes.annotate(
                network.points[point].name,
                (x, until),
                (0, 3),
                textcoords="offset points",
                ha="center",
                fontsize=_FONT - 1,
            )
    axes.set_xlim(0, line.length)
    axes.set_ylim(0, until)
    axes.set_xlabel(f"x {line.name}".rstrip(), fontsize=_FONT)
    axes.tick_params(labelsize=_FONT - 1, labelleft=first)
    if first:
        axes.set_ylabel("tau", fontsize=_FONT)
