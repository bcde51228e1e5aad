"""What a client reads first: base shear, largest drift, acceleration of the roof, periods, and a table of storeys."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from wavesym.errors import WavesymError
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import nearest, rational
from wavesym.pictures.histories import History
from wavesym.pictures.line_histories import LineHistories
from wavesym.pictures.page.page_tables import PageTable
from wavesym.pictures.timescale import Timescale, timescale
from wavesym.pictures.units import unit_text
from wavesym.results.modes import ModeRow, modes
from wavesym.results.presentation import group_thousands, number_text, readable_unit
from wavesym.results.statistics import OutputSummary
from wavesym.results.summary import Summary, summarise
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import probes
from wavesym.scene.outputs import Output, observables

_PERIODS, _MOST_PERIODS = 3, 8
_MOVED = 0.9  # of the mass: what codes ask of the modes that are counted
_GRAVITY = 9.80665  # m/s^2
_STOREYS = 60  # rows of the table
_OUTPUTS, _LINKS = 3, 2  # of a scene that is no building, those that are listed first


@dataclass(frozen=True)
class Figure:
    """A number that a client looks for: what it is, its value with its unit, and what more there is to say of it."""

    name: str
    value: str
    detail: str = ""


def _probes(scene: Scene) -> tuple[Probe, ...]:
    """The outputs of a building that a headline is made of, whatever its scene has: base shear, roof acceleration."""
    if scene.system.type != "building" or scene.system.choices.get("base") != "ground":
        return ()
    roof = scene.system.lines[""][-1].x
    fields = {"until": scene.output.until, "tolerance": scene.output.tolerance, "force": [0], "acceleration": [roof]}
    return probes(scene, observables(Output.model_validate(fields), scene.system, scene.load))


def headline(
    scene: Scene,
    model: Model,
    summary: Summary | WavesymError,
    found: Sequence[LineHistories],
    loads: Sequence[History],
    vibrations: Sequence[ModeRow],
) -> Iterator[Figure]:
    """The figures of a scene, those that it has.

    Args:
        scene: what is shown.
        model: the same, lowered.
        summary: the extremes of its outputs, or why there are none.
        found: what happens along the chain.
        loads: what acts on it.
        vibrations: those of `first_modes`.
    """
    outputs = _outputs(scene, model, summary)
    shear = outputs.get("force@0")
    if shear is not None and scene.system.type == "building":
        yield Figure("Base shear", _value(shear.largest.value, shear.unit), _of_the_weight(scene, model, shear))
    if scene.system.type != "building" and not isinstance(summary, WavesymError):
        yield from _largest_values(model, summary)
    yield from _largest_drift(scene, found)
    roof = outputs.get(f"acceleration@{len(model.network.bars)}")
    if roof is not None and scene.system.type == "building":
        yield Figure("Roof acceleration", _value(roof.largest.value, roof.unit), _in_g(scene, roof.largest.value))
    if scene.system.type == "building" and loads:
        peak = float(np.max(np.abs(loads[0].points[:, 1])))
        yield Figure("Peak ground acceleration", _value(peak, loads[0].output.unit), _in_g(scene, peak))
    periods = [row.period for row in vibrations if row.period]
    if periods and model.clock and scene.system.type != "building":
        hertz = ", ".join(f"{1 / period:.3g}" for period in periods)
        yield Figure("Natural frequencies", f"{hertz} Hz", f"periods {', '.join(f'{each:.3g}' for each in periods)} s")
    elif periods:
        unit = "\u00a0s" if model.clock else ""
        values = ", ".join(f"{period:.3g}" for period in periods)
        shares = [f"{100 * row.effective_mass:.2g}" for row in vibrations if row.effective_mass is not None]
        moved = f"{', '.join(shares)} % of the mass" if shares else ""
        detail = ", ".join(filter(None, (moved, "" if unit else "in tau")))
        yield Figure("Period" + "s" * (len(periods) > 1), f"{values}{unit}", detail)


def first_modes(scene: Scene) -> list[ModeRow]:
    """The modes with the longest periods, three and as many more as nine tenths of the mass need; no rigid ones.

    None where waves leave a chain, or contacts open and close.
    """
    with suppress(WavesymError):
        model = lower(scene, in_time=False)
        if not model.network.loses:
            found = [row for row in modes(model, _MOST_PERIODS + 1) if row.period]
            moved = accumulate(row.effective_mass or 0.0 for row in found)
            held = any(row.effective_mass is not None for row in found)
            needed = (
                next((count for count, part in enumerate(moved, 1) if part >= _MOVED), _MOST_PERIODS) if held else 0
            )
            return found[: max(_PERIODS, needed)]
    return []


def storeys(scene: Scene, found: Sequence[LineHistories], scale: Timescale) -> PageTable:
    """Storey by storey: its height, how far its floors move apart, in parts of the height, too, and when."""
    own = next((each for each in found if each.storeys), None)
    if own is None or len(own.bands[0].spots) > _STOREYS:
        return PageTable((), (), ())
    heights = _heights(scene, len(own.bands[0].spots))
    when = f"at {scale.symbol}{scale.unit and ' in '}{scale.unit}"
    head = ("Storey", *["Height in m"] * bool(heights), f"Largest drift{own.unit and ' in '}{unit_text(own.unit)}")
    head += (*["Drift in %"] * bool(heights), when)
    rows = []
    for k, values in reversed(list(enumerate(own.bands[0].values))):
        place = int(np.nanargmax(np.abs(values)))
        row = [str(k + 1), f"{values[place]:.4g}", f"{own.taus[place] * scale.per_tau:.4g}"]
        if heights:
            row.insert(1, f"{heights[k]:.4g}")
            row.insert(3, f"{100 * abs(values[place]) * _metres(scene) / heights[k]:.3g}")
        rows.append(tuple(row))
    return PageTable(head, tuple(rows), (f"The largest values at {len(own.taus)} instants",))


def neglected_effects(model: Model) -> Iterator[str]:
    """What the model of a scene leaves out, a sentence each."""
    if model.labels.system["type"] == "building":
        yield "Floors are rigid and move sideways only: no rocking, no torsion, no bending of the building as a whole"
        yield "Columns carry shear alone; the soil does not give way" * (model.network.points[0].motion is not None)
    else:
        yield "Waves run along rods in one dimension: cross-sections stay plane, and nothing spreads sideways"
    if model.network.corners:
        yield "Rods stay linear: no yielding, no cracks, no change of geometry; links follow the laws of the scene"
    else:
        yield "Everything stays linear: no yielding, no cracks, no change of geometry"
    if change := model.labels.system.get("speeds_changed_by"):
        yield f"Waves have other speeds than were written, by {change}, which is in no bound"
    if model.damping is None:
        yield "The material does not damp"


def _outputs(scene: Scene, model: Model, summary: Summary | WavesymError) -> dict[str, OutputSummary]:
    """Extremes by name: of the scene's outputs, and of those that its headline needs besides, where they can be had."""
    found = {} if isinstance(summary, WavesymError) else {each.name: each for each in summary.outputs}
    if missing := [probe for probe in _probes(scene) if probe.name not in found]:
        with suppress(WavesymError):
            found |= {each.name: each for each in summarise(model.watching(missing)).outputs}
    return found


def _largest_values(model: Model, summary: Summary) -> Iterator[Figure]:
    """The largest values of the first outputs, with their signs and when they are there, and what links lost most.

    Of a scene with forces or stresses one is among them.
    """
    scale, quantities = timescale(model), {probe.name: probe.quantity for probe in model.probes}
    forces = [each for each in summary.outputs if quantities.get(each.name) in ("force", "stress")]
    first = [*summary.outputs[: _OUTPUTS - 1], *forces, *summary.outputs[_OUTPUTS - 1 :]]
    for each in list({each.name: each for each in first}.values())[:_OUTPUTS]:
        shown = each.readable
        peak = shown.largest
        when = f"at {scale.symbol} = {number_text(peak.at.in_scene_time, scale.unit, 4)}"
        yield Figure(each.label, group_thousands(number_text(peak.value, unit_text(shown.unit), 4)), when)
    for link in sorted(summary.links or (), key=lambda link: -abs(link.set.value))[:_LINKS]:
        yield Figure(f"Set at {link.where}", link.set.describe(4), f"{link.dissipated.describe(4)} dissipated")


def _largest_drift(scene: Scene, found: Sequence[LineHistories]) -> Iterator[Figure]:
    own = next((each for each in found if each.storeys), None)
    if own is None:
        return
    values = own.bands[0].values
    storey, place = np.unravel_index(int(np.nanargmax(np.abs(values))), values.shape)
    heights = _heights(scene, len(values))
    value = float(values[storey, place])
    part = f"{100 * abs(value) * _metres(scene) / heights[storey]:.3g} % of its height, " if heights else ""
    yield Figure("Largest drift", _value(value, own.unit), f"{part}storey {storey + 1}")


def _heights(scene: Scene, count: int) -> list[float]:
    """The heights of storeys in m; none for a scene without units."""
    if scene.scale is None:
        return []
    lengths = [float(length) for length in scene.scale.lengths]
    return lengths * count if len(lengths) == 1 else lengths


def _metres(scene: Scene) -> float:
    """The unit of a drift in m."""
    assert scene.scale is not None  # as it has heights
    return float(scene.scale.displacement / scene.scale.factor("drift", 1))


def _of_the_weight(scene: Scene, model: Model, shear: OutputSummary) -> str:
    """A base shear as a part of the weight of floors and columns."""
    if scene.scale is None:
        return ""
    mass = sum(nearest(point.mass) for point in model.network.points)
    mass += sum(nearest(bar.impedance * bar.delay) for bar in model.network.bars)
    newtons = shear.largest.value * float(scene.scale.force / scene.scale.factor("force", 1))
    weight = mass * float(scene.scale.parts["mass"][0]) * _GRAVITY
    return f"{100 * abs(newtons) / weight:.3g} % of the weight above the foundation"


def _in_g(scene: Scene, value: float) -> str:
    if scene.scale is None:
        return ""
    one = scene.scale.displacement / scene.scale.seconds**2 / scene.scale.factor("acceleration", 1)
    return f"{abs(value) * nearest(rational(one)) / _GRAVITY:.3g} g"


def _value(value: float, unit: str) -> str:
    """A size in the unit that people write for it."""
    size, unit = readable_unit(value, unit)
    return group_thousands(number_text(abs(value) / size, unit_text(unit), 4))
