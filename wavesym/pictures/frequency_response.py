"""A frequency response: amplitudes on logarithmic axes over the phases of the outputs."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from wavesym.pictures.style import draw_grid, new_figure, set_title, with_style
from wavesym.pictures.units import unit_text
from wavesym.results.frequency_response import FrequencyResponse


@with_style
def draw(found: FrequencyResponse) -> Figure:
    """The amplitude and the phase of each output; gaps where there is no value.

    Args:
        found: the frequency response of a scene.
    """
    units = list(dict.fromkeys(zip((name.partition("@")[0] for name in found), found.units, strict=True)))
    figure = new_figure(2.4 + 2.6 * len(units))
    *amplitudes, phase = figure.subplots(len(units) + 1, 1, sharex=True)
    per = f" per {found.load_unit} of {found.load}" if found.load_unit else f" per unit of {found.load}"
    for axes, (quantity, unit) in zip(amplitudes, units, strict=True):
        for k, name in enumerate(found):
            if (name.partition("@")[0], found.units[k]) == (quantity, unit):
                size = np.where(found.amplitude[k] > 0, found.amplitude[k], np.nan)
                axes.semilogy(found.frequency, size, label=name, color=f"C{k % 10}", linewidth=1.2)
        axes.set_ylabel(f"{quantity} in {unit_text(unit)}" if unit else quantity)
        draw_grid(axes, zero=False)
        axes.legend(ncols=1 + len(found) // 8)
    for k in range(len(found)):
        phase.plot(found.frequency, found.phase[k], color=f"C{k % 10}", linewidth=1.0)
    phase.set_ylabel("phase in degrees")
    phase.set_yticks([-180, -90, 0, 90, 180])
    phase.set_xlabel("w [rad per tau]" if found.frequency_label == "omega" else found.frequency_label)
    phase.set_xlim(found.frequency[0], found.frequency[-1])
    draw_grid(phase)
    set_title(figure, f"{found.name}: amplitudes{per}")
    return figure
