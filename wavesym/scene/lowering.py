"""Scene -> Model: what the user said, as what is to be computed."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import count
from typing import NamedTuple

from flint import fmpq

from wavesym.errors import SceneError
from wavesym.fields.loads import Load, SampledLoad, TimedLoad
from wavesym.fields.numbers import decimal_text
from wavesym.fields.shapes import ShapedLoad
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.damping import Damping
from wavesym.mechanics.dead_loads import dead_loads
from wavesym.mechanics.loads import AppliedLoad, AppliedRecord, merge_loads
from wavesym.mechanics.model import Labels, Model
from wavesym.mechanics.network import Network
from wavesym.mechanics.parameters import SystemParameters
from wavesym.mechanics.probe import Probe
from wavesym.mechanics.travel_times import percent, speed_change
from wavesym.numbers.doubles import fraction, nearest, rational
from wavesym.records.load import RecordedLoad
from wavesym.scene.outputs import Observable
from wavesym.scene.physical.scale import Scale
from wavesym.scene.scene import Scene
from wavesym.systems import ExplicitChain
from wavesym.systems.place import Place

_KEPT = "lowered"  # beside the fields of a scene
_MOST_NAMED = 5  # rods
_USUAL_DAMPING = fmpq(1, 5)  # of critical; above it a ratio is more often a slip than meant


def lower(scene: Scene, *, loads: bool = True) -> Model:
    """The model of a scene; every number in it is an fmpq.

    It is made once and kept with the scene, so that whoever asks again gets the same one.

    Args:
        scene: what the user wrote, validated.
        loads: whether its loads act; frequencies and frequency responses take no notice of what they do over time.

    Raises:
        SceneError: for what is no Scene: a path, say.
        CostError: for loads that would take too many samples.
        UnservedError: where loads act on rods with a loss.
    """
    if not isinstance(scene, Scene):
        raise SceneError(f"{type(scene).__name__} is not a Scene; write Scene.from_toml(...)")
    parts = (scene.name, scene.system, scene.load, scene.output)
    kept = vars(scene).get(_KEPT)  # a copy of a scene with other parts has the model of the first
    if kept is None or any(one is not other for one, other in zip(kept.parts, parts, strict=True)):
        kept = vars(scene)[_KEPT] = _LoweredScene(parts, {})
    if True not in kept.models and loads not in kept.models:
        kept.models[loads] = _build_model(scene if loads else _without_loads(scene))
    model = kept.models.get(True) or kept.models[loads]
    if loads and any(bar.loss != 0 for bar in model.network.bars):
        model.network.refuse_loss(_damping_in_time(scene, model.network))
    return model


class _LoweredScene(NamedTuple):
    """A model, and the parts of the scene that it was made from."""

    parts: tuple[object, ...]
    models: dict[bool, Model]


def _without_loads(scene: Scene) -> Scene:
    """The same scene, its loads never changing: they act where they do, by nothing."""
    still = tuple(
        load.truncate(Fraction(0), Fraction(1)) if isinstance(load, ShapedLoad) else load for load in scene.load
    )
    other = scene.model_copy()
    vars(other)["load"] = still
    return other


def _build_model(scene: Scene) -> Model:
    output = scene.output
    length = scene.physical.length if scene.physical else None
    chain, network = named_chain(scene), scene.system.network(scene.load, length)
    return Model(
        name=scene.name,
        network=network,
        loads=merge_loads((*dead_loads(network), *_loads(scene))),
        probes=probes(scene, scene.outputs),
        until=rational(output.until),
        tolerance=rational(output.tolerance),
        labels=_labels(scene, chain, network),
        clock=scene.scale.clock if scene.scale else None,
        length=length,
        damping=_damping(scene),
        inputs=_inputs(scene),
        spacing=min((rational(load.step) for load in scene.load if load.step), default=None),
        preset=SystemParameters(chain) if chain else None,
    )


def named_chain(scene: Scene) -> Chain | None:
    """The chain as the paper has it, None of a scene that the paper has not.

    Tables, derivations and walks are written in its letters; everything else takes the network.
    """
    return scene.system.named_chain(scene.load)


def _damping(scene: Scene) -> Damping | None:
    """That of the modes, where it is any."""
    damping: Damping | None = getattr(scene.system, "damping", None)  # a collision has none
    return damping if damping and any(damping.ratios) else None


def probes(scene: Scene, outputs: Iterable[Observable]) -> tuple[Probe, ...]:
    """Outputs on a scene's chain as a model has them, in the units of the scene's results."""
    return tuple(_probe(output, scene.scale) for output in outputs)


def drifts(scene: Scene) -> tuple[Probe, ...]:
    """The drift of every rod of the main line, as an output."""
    rods = [station.right for station in scene.system.lines[""] if station.right is not None]
    places = (Place(Fraction(k), 0, "", rod + 1, Fraction(1)) for k, rod in enumerate(rods, 1))
    return probes(scene, (Observable("drift", place.x, 0, f"drift@{place.x}", place) for place in places))


def sample_comb(scene: Scene) -> tuple[fmpq, fmpq] | None:
    """When the samples of the load that has the finest begin, and how far they are apart, in tau; None without any."""
    combs = [(load.begin, load.step) for load in scene.load if isinstance(load, RecordedLoad | ShapedLoad)]
    combs += [(Fraction(0), load.spacing) for load in scene.load if isinstance(load, SampledLoad)]
    if not combs:
        return None
    begin, step = min(combs, key=lambda comb: comb[1])
    return rational(begin), rational(step)


def _labels(scene: Scene, chain: Chain | None, network: Network) -> Labels:
    fields = scene.dimensionless().model_dump(mode="json")
    if scene.scale is not None:
        fields["units"] = scene.scale.canonical
    canonical = json.dumps(fields, sort_keys=True, separators=(",", ":"))
    return Labels(
        system={"type": scene.system.type, **(scene.physical.system if scene.physical else scene.system.choices)},
        loads=scene.physical.loads if scene.physical else tuple(load.description for load in scene.load),
        sha256=hashlib.sha256(canonical.encode()).hexdigest(),
        notes=(
            *_horizon_notes(scene),
            *_damping_notes(scene),
            *_speed_notes(scene),
            *_record_notes(scene),
            *_shape_notes(scene),
        ),
        kind=scene.scale.kind if scene.scale else "",
        size=f"m = {chain.m}" if chain else f"{len(network.bars)} rods",
        dimensions="x in rod lengths, tau = c t / l" if chain else "places in lengths, tau in lengths at speed 1",
        load_names=load_names(scene),
        sources={source: load.label for load in scene.load for source in load.sources},
        titles={source: load.name for load in scene.load if load.name for source in load.sources},
    )


def _horizon_notes(scene: Scene) -> Iterator[str]:
    """A line where a scene with units says a horizon of tau: whoever writes a number may have meant seconds."""
    until = scene.physical.fields_in_units.get("output", {}).get("until") if scene.physical else None
    if until is not None and scene.scale and re.fullmatch(r"[\d./eE+-]+", written := str(until).strip()):
        horizon = scene.scale.clock.format(rational(scene.output.until))
        yield f'output.until: {written} is taken as tau, {horizon}; write "{written} s" if seconds are meant'


def _damping_notes(scene: Scene) -> Iterator[str]:
    """A line where a mode has more damping than structures have."""
    damping = _damping(scene)
    if damping and (largest := max(damping.ratios)) > _USUAL_DAMPING:
        yield f"system.damping: {nearest(100 * largest):g} % of critical; structures have some percent"


def _speed_notes(scene: Scene) -> Iterator[str]:
    """A line where waves in rods are a little faster or slower than was written."""
    if not isinstance(system := scene.system, ExplicitChain) or not system.speed_adjustment:
        return
    before, after = system.drawing_as_written.bars, system.drawing.bars
    if change := speed_change(before, after):
        yield (
            f"system.speed_adjustment: speeds of waves are changed by {percent(change)} or less, so that travel times "
            "have a common measure; impedances are as written"
        )


def _damping_in_time(scene: Scene, network: Network) -> str:
    """What to write in place of losses for motions in time: damping, or beside dashpots a dashpot in each rod.

    A rod of stiffness k = Z/T with a dashpot c between its ends loses as one with the loss c w/k at the frequency w,
    the first of a column that is held at one end: a quarter of a turn while a wave goes through.
    """
    losses = [bar for bar in network.bars if bar.loss != 0]
    if network.takes_modal_damping:
        ratio = decimal_text(fraction(max(bar.loss for bar in losses)) / 2)
        return f"for these write damping = {ratio} under [system] in its place"
    turn = math.pi / 2 / nearest(sum((bar.delay for bar in network.bars), fmpq(0)))
    size, unit = scene.scale.parts["dashpot"] if scene.scale else (1, "")
    rods: list[str] = []
    for number, bar in enumerate(network.bars, 1):
        if bar.loss != 0 and len(rods) < _MOST_NAMED:
            dashpot = float(f"{nearest(bar.loss * bar.impedance / bar.delay) / turn * float(size):.3g}")
            written = f'"{dashpot:.15g} {unit}"' if unit else f"{dashpot:.15g}"
            rods.append(f"dashpot = {written} in {bar.name or f'rod {number}'}")
    others = ", ..." if len(losses) > len(rods) else ""
    when = f"{turn / math.tau / float(scene.scale.seconds):.3g} Hz" if scene.scale else f"{turn:.3g} rad per tau"
    return (
        f"for these write in its place {', '.join(rods)}{others} (they lose as much at {when}, more above; in thin "
        "rods), or multiply the spectrum of a record by `frf`, as in docs/tutorials/soil.md"
    )


def _record_notes(scene: Scene) -> Iterator[str]:
    """A line for each record that begins later, so that it does not jump."""
    for k, load in enumerate(scene.load):
        if isinstance(load, RecordedLoad) and load.is_delayed:
            yield (
                f"load[{k}].record: the first sample is not 0, and modes take no jump: the load rises to it from 0 "
                f"over one spacing, so that the record begins {_spacing(scene, load)} later"
            )


def _shape_notes(scene: Scene) -> Iterator[str]:
    """A line for each load that has a shape: as what it acts."""
    for k, load in enumerate(scene.load):
        if isinstance(load, ShapedLoad):
            yield f"load[{k}]: {load.shape} {load.sampling}, one every {_spacing(scene, load)}"


_NOTES = (_horizon_notes, _damping_notes, _speed_notes, _record_notes, _shape_notes)


def _loads(scene: Scene) -> tuple[AppliedLoad, ...]:
    """The loads, summed; sorted by time, and each source at a time once."""
    if not scene.system.load_kinds:
        return (AppliedLoad("impact", fmpq(0), fmpq(1)),)
    return merge_loads(unit for load in scene.load for unit in load.units())


def amplitudes(scene: Scene) -> tuple[tuple[str, AppliedLoad], ...]:
    """The numbers of the loads in the order of the scene, each with what it is called; zeros too.

    Of a load that has samples it is one, the factor of all of them: 1.
    """
    found: list[tuple[str, AppliedLoad]] = []
    for label, load in zip(load_names(scene), scene.load, strict=True):
        if not isinstance(load, TimedLoad):
            samples = AppliedRecord(load.sources[0], fmpq(0), fmpq(1), merge_loads(load.units()))
            found.append((f"factor of the {label}, samples at {_spacing(scene, load)}", samples))
            continue
        found += [
            (f"{name}[{k}] of the {label}, {_format_time(scene, load.times[k])}", unit)
            for name, units in load.by_list()
            for k, unit in enumerate(units)
        ]
    return tuple(found)


def load_names(scene: Scene) -> tuple[str, ...]:
    """What each load is, for people; several of one kind on one body are numbered."""
    labels = [load.label for load in scene.load]
    numbers = {label: count(1) for label, found in Counter(labels).items() if found > 1}
    return tuple(f"{label} ({next(numbers[label])})" if label in numbers else label for label in labels)


def _spacing(scene: Scene, load: Load) -> str:
    assert load.step is not None  # as it has samples
    return scene.scale.clock.format(rational(load.step)) if scene.scale else str(load.step)


def sources(scene: Scene) -> tuple[str, ...]:
    """What its loads are steps of, in the order of the scene; each once."""
    return tuple(dict.fromkeys(load.sources[0] for load in scene.load))


def _format_time(scene: Scene, tau: Fraction) -> str:
    return f"t = {scene.scale.clock.format(rational(tau))}" if scene.scale else f"tau = {tau}"


def _inputs(scene: Scene) -> dict[str, tuple[fmpq, str]]:
    given = scene.physical.inputs if scene.physical else ()
    parts = scene.scale.parts if scene.scale else {}
    inertia = {"inertia": (fmpq(1), "kg*m^2")} if scene.scale else {}  # as a physical drive is rewritten
    return {
        **inertia,
        **{name: (rational(size), unit) for name, (size, unit) in parts.items()},
        **{
            source: (rational(factor), unit)
            for load, (factor, unit) in zip(scene.load, given, strict=False)
            for source in load.sources
        },
    }


def _probe(output: Observable, scale: Scale | None) -> Probe:
    place = output.place
    probe = Probe(output.name, output.quantity, place.rod, rational(place.part), place.point, title=output.title)
    if scale is None:
        return probe
    factor = rational(scale.factor(output.quantity, place.rod))
    return replace(probe, factor=factor, unit=scale.unit(output.quantity))
