"""Response spectra as a picture."""

from __future__ import annotations

from matplotlib.figure import Figure

from wavesym.results.spectrum import Spectra


def _plain(period: float, _: float) -> str:
    """Ticks at 1, 2 and 5 of a decade, as people write them."""
    return f"{period:g}" if f"{period:e}"[0] in "125" else ""


def draw(found: Spectra) -> Figure:
    """A line for each output, over the period on a logarithmic axis."""
    figure = Figure(figsize=(8, 5), layout="constrained")
    axes = figure.add_subplot()
    for k, (name, values) in enumerate(zip(found.names, found.values, strict=True)):
        shade = f"C{k}" if len(found.names) <= 10 else str(0.75 * k / (len(found.names) - 1))
        axes.semilogx(found.periods, values, label=name, color=shade, linewidth=1.2)
    axes.set_xlabel("period" if found.time_unit is None else f"period [{found.time_unit}]")
    unit = next(iter(found.units))
    axes.set_ylabel(f"pseudo-acceleration [{unit}]" if unit else "pseudo-acceleration")
    axes.set_title(f"damping {found.damping:g}", loc="left", fontsize="medium")
    axes.xaxis.set_major_formatter(_plain)
    axes.xaxis.set_minor_formatter(_plain)
    axes.set_xlim(found.periods[0], found.periods[-1])
    axes.set_ylim(bottom=0)
    axes.grid(which="both", alpha=0.25)
    axes.legend(fontsize="small", ncols=1 + len(found.names) // 12)
    return figure
