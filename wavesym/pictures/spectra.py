"""Response spectra as a picture."""

from __future__ import annotations

from matplotlib.figure import Figure

from wavesym.pictures.style import draw_grid, new_figure, set_title, with_style
from wavesym.pictures.units import unit_text
from wavesym.results.spectrum import Spectra


def _plain(period: float, _: float) -> str:
    """Ticks at 1, 2 and 5 of a decade, as people write them."""
    return f"{period:g}" if f"{period:e}"[0] in "125" else ""


@with_style
def draw(found: Spectra) -> Figure:
    """A line for each output, over the period on a logarithmic axis."""
    figure = new_figure(4.6)
    axes = figure.add_subplot()
    for k, (name, values) in enumerate(zip(found.names, found.values, strict=True)):
        shade = f"C{k}" if len(found.names) <= 10 else str(0.75 * k / (len(found.names) - 1))
        axes.semilogx(found.periods, values, label=name, color=shade, linewidth=1.2)
    axes.set_xlabel("period in tau" if found.time_unit is None else f"period in {found.time_unit}")
    unit = next(iter(found.units))
    axes.set_ylabel(f"pseudo-acceleration in {unit_text(unit)}" if unit else "pseudo-acceleration")
    set_title(figure, f"Response spectra, damping {100 * found.damping:.3g} %")
    axes.xaxis.set_major_formatter(_plain)
    axes.xaxis.set_minor_formatter(_plain)
    axes.set_xlim(found.periods[0], found.periods[-1])
    axes.set_ylim(bottom=0)
    draw_grid(axes)
    axes.legend(ncols=1 + len(found.names) // 12)
    return figure
