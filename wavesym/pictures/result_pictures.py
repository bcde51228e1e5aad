"""What was measured or computed of a whole scene, drawn: records, modes, response spectra, frequency responses."""

from __future__ import annotations

import os

import numpy as np
from matplotlib.figure import Figure

from wavesym.documents.record import RecordFacts
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest, rational
from wavesym.pictures.groups import axis_title
from wavesym.pictures.naming import heading, in_words, with_titles
from wavesym.pictures.style import CURVES, MAIN, OTHER, curve_look, draw_grid, new_figure, set_title, with_style
from wavesym.pictures.units import unit_text
from wavesym.records.record_file import RecordFile
from wavesym.results.frequency_response import FrequencyResponse
from wavesym.results.modes import Modes
from wavesym.results.shapes import line_shapes
from wavesym.results.spectrum import Spectra
from wavesym.systems.station import Lines

_RECORD = 3.4  # inches


@with_style
def draw_record(record: RecordFile, unit: str) -> Figure:
    """The samples of a file over time, or by their numbers where it does not say when; and the line to 0 after them."""
    facts = RecordFacts(record, unit)
    times = [facts.time(k) for k in range(len(record.samples) + 1)]
    x = [float(k + 1) if time is None else nearest(rational(time)) for k, time in enumerate(times)]
    y = [nearest(rational(sample)) for sample in record.samples]
    figure = new_figure(_RECORD)
    axes = figure.add_subplot()
    draw_grid(axes)
    axes.plot(x, [*y, 0.0], color=MAIN, linewidth=0.8)
    axes.plot(x[facts.peak], y[facts.peak], "o", color=OTHER, markersize=4)
    below = y[facts.peak] < 0
    axes.annotate(
        facts.describe_peak(),
        (x[facts.peak], y[facts.peak]),
        xytext=(6, -3 if below else 3),
        textcoords="offset points",
        va="top" if below else "bottom",
    )
    axes.margins(x=0.01, y=0.12)
    set_title(figure, f"{os.path.basename(record.file)}: {record.kind}, {len(record.samples)} samples")
    axes.set_xlabel("number of the sample" if times[0] is None else _axis("time", facts.clock))
    axes.set_ylabel(_axis("sample", unit))
    return figure


def _axis(name: str, unit: str) -> str:
    return f"{name} in {unit_text(unit)}" if unit else name


MOST_MODES = 6  # modes in a picture
_MODE = 2.4  # inches
_POINTS = 33  # of a rod


@with_style
def draw_modes(found: Modes, model: Model, lines: Lines) -> Figure:
    """The shapes of the first modes along each line of a chain, in phase and, of complex ones, a quarter later.

    Args:
        found: the modes of the model.
        model: the chain.
        lines: its main line and its branches.

    Raises:
        UnservedError: there are no rods.
    """
    drawn = line_shapes(found.exact[:MOST_MODES], found.cut, model, lines, _POINTS)
    figure = new_figure(1.4 + _MODE * len(drawn))
    unit = "Hz" if found.time_unit else "per tau"
    set_title(figure, f"{heading(found.name)}: shapes of the first {min(len(found), MOST_MODES)} modes")
    for axes, each in zip(figure.subplots(len(drawn), 1, squeeze=False)[:, 0], drawn, strict=True):
        for k, (row, moved) in enumerate(zip(found.modes, each.displacements, strict=False)):
            axes.plot(each.x, moved.real, label=f"{row.number}: {row.hz:.4g} {unit}", **curve_look(k, 1.3))
        draw_grid(axes)
        axes.set_xlabel(_place_title(each.line, model))
        axes.set_ylabel("shape")
    figure.legend(*axes.get_legend_handles_labels(), ncols=3, frameon=False, loc="outside lower center")
    return figure


def _place_title(line: str, model: Model) -> str:
    """What is counted along a line: storeys of a building, lengths, or rods."""
    if model.labels.system["type"] == "building":
        return "floor (0: foundation)"
    unit = "lengths of the first rod" if model.labels.system["type"] == "chain" else "rods"
    title = f"position in {model.length.text if model.length else unit}"
    return f"{title}, along {in_words(line)}" if line else title


def _plain_period(period: float, _: float) -> str:
    """Ticks at 1, 2 and 5 of a decade, as people write them."""
    return f"{period:g}" if f"{period:e}"[0] in "125" else ""


@with_style
def draw_spectra(found: Spectra) -> Figure:
    """A line for each output, over the period on a logarithmic axis."""
    figure = new_figure(4.6)
    axes = figure.add_subplot()
    for k, (name, values) in enumerate(zip(found.outputs, found.values, strict=True)):
        grey = {"color": str(0.75 * k / max(1, len(found.outputs) - 1)), "linewidth": 1.2}
        look = curve_look(k, 1.2) if len(found.outputs) <= len(CURVES) else grey
        axes.semilogx(found.periods, values, label=name, **look)
    axes.set_xlabel("period in tau" if found.time_unit is None else f"period in {found.time_unit}")
    unit = next(iter(found.units))
    axes.set_ylabel(f"pseudo-acceleration in {unit_text(unit)}" if unit else "pseudo-acceleration")
    set_title(figure, f"{heading(found.name)}: response spectra, damping {100 * found.damping:.3g} %")
    axes.xaxis.set_major_formatter(_plain_period)
    axes.xaxis.set_minor_formatter(_plain_period)
    axes.set_xlim(found.periods[0], found.periods[-1])
    axes.set_ylim(bottom=0)
    draw_grid(axes)
    axes.legend(ncols=1 + len(found.outputs) // 12)
    return figure


@with_style
def draw_frequency_response(found: FrequencyResponse, model: Model) -> Figure:
    """The amplitude and the phase of each output, its greatest one among them; gaps where there is no value.

    Args:
        found: the frequency response of a scene.
        model: that of the scene, whose outputs have names for people.
    """
    found, probes = found.with_peaks(), with_titles(model).probes
    kinds = [(probe.quantity, probe.unit) for probe in probes]
    units = list(dict.fromkeys(kinds))
    figure = new_figure(2.4 + 2.6 * len(units))
    *amplitudes, phase = figure.subplots(len(units) + 1, 1, sharex=True)
    per = f"{unit_text(found.load_unit) or 'unit'} of {'load ' * found.load.isdecimal()}{in_words(found.load)}"
    for axes, kind in zip(amplitudes, units, strict=True):
        for k, probe in enumerate(probes):
            if kinds[k] == kind:
                size = np.where(found.amplitude[k] > 0, found.amplitude[k], np.nan)
                axes.semilogy(found.frequency, size, label=probe.title, **curve_look(k, 1.2))
        axes.set_ylabel(axis_title(model, *kind))
        draw_grid(axes, zero=False)
        axes.legend(ncols=2, frameon=False, loc="lower left", bbox_to_anchor=(0, 1), borderaxespad=0.2)
    for k in range(len(found)):
        phase.plot(found.frequency, found.phase[k], **curve_look(k, 1.0))
    phase.set_ylabel("phase\nin degrees")
    phase.set_yticks([-180, -90, 0, 90, 180])
    phase.set_xlabel("angular frequency in rad per tau" if model.clock is None else "frequency in Hz")
    phase.set_xlim(found.frequency[0], found.frequency[-1])
    draw_grid(phase)
    set_title(figure, f"{heading(found.name)}: amplitudes per {per}")
    return figure
