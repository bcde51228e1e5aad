"""A frequency response: amplitudes on logarithmic axes over the phases of the outputs."""

from __future__ import annotations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from wavesym.results.frequency_response import FrequencyResponse


def draw(found: FrequencyResponse) -> Figure:
    """The amplitude and the phase of each output; gaps where there is no value.

    Args:
        found: the frequency response of a scene.
    """
    units = list(dict.fromkeys(zip((name.partition("@")[0] for name in found), found.units, strict=True)))
    figure = Figure(figsize=(8, 2.2 + 2.2 * len(units)), layout="constrained")
    FigureCanvasAgg(figure)
    *amplitudes, phase = figure.subplots(len(units) + 1, 1, sharex=True)
    per = f" per {found.load_unit} of {found.load}" if found.load_unit else f" per unit of {found.load}"
    for axes, (quantity, unit) in zip(amplitudes, units, strict=True):
        for k, name in enumerate(found):
            if (name.partition("@")[0], found.units[k]) == (quantity, unit):
                size = np.where(found.amplitude[k] > 0, found.amplitude[k], np.nan)
                axes.semilogy(found.frequency, size, label=name, color=f"C{k % 10}", linewidth=1.2)
        axes.set_ylabel(f"{quantity} [{unit}]" if unit else quantity)
        axes.grid(which="both", alpha=0.2)
        axes.legend(fontsize="small", ncols=1 + len(found) // 8)
    for k in range(len(found)):
        phase.plot(found.frequency, found.phase[k], color=f"C{k % 10}", linewidth=1.0)
    phase.set_ylabel("phase [deg]")
    phase.set_yticks([-180, -90, 0, 90, 180])
    phase.set_xlabel("w [rad per tau]" if found.frequency_label == "omega" else found.frequency_label)
    phase.set_xlim(found.frequency[0], found.frequency[-1])
    phase.grid(alpha=0.2)
    figure.suptitle(f"{found.name}: amplitudes{per}", x=0.01, ha="left", weight="bold")
    return figure
