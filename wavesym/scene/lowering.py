"""Scene -> Model: what the user said, as what is to be computed."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import count
from typing import NamedTuple

from flint import fmpq

from wavesym.errors import SceneError
from wavesym.fields.loads import Load, SampledLoad, TimedLoad
from wavesym.fields.shapes import ShapedLoad
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.damping import Damping
from wavesym.mechanics.dead_loads import dead_loads
from wavesym.mechanics.loads import AppliedLoad, AppliedRecord, merge_loads, power_source
from wavesym.mechanics.model import Labels, Model, SampledShape
from wavesym.mechanics.network import Network
from wavesym.mechanics.node import UnitLoad
from wavesym.mechanics.parameters import SystemParameters
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import fraction, rational
from wavesym.records.load import RecordedLoad
from wavesym.scene.notes import (
    changed_speeds,
    damping_in_time,
    spacing_text,
    structure_notes,
    time_notes,
    written_speeds,
)
from wavesym.scene.outputs import Observable
from wavesym.scene.physical.scale import Scale
from wavesym.scene.scene import Scene
from wavesym.systems import ExplicitChain
from wavesym.systems.place import Place

_KEPT = "lowered"  # beside the fields of a scene


def lower(scene: Scene, *, in_time: bool = True) -> Model:
    """The model of a scene; every number in it is an fmpq.

    It is made once and kept with the scene, so that whoever asks again gets the same one.

    Args:
        scene: what the user wrote, validated.
        in_time: whether its motion in time is computed: its loads act, and speeds of waves are adjusted. Frequencies
            and frequency responses need neither: loads never change, and speeds are as they are written.

    Raises:
        SceneError: for what is no Scene: a path, say; for motion in time of one without outputs.
        CostError: for loads that would take too many samples.
        UnservedError: where loads act on rods with a loss.
    """
    if not isinstance(scene, Scene):
        raise SceneError(f"{type(scene).__name__} is not a Scene; write Scene.from_toml(...)")
    if in_time:
        scene.refuse_without_output()
    parts = (scene.name, scene.system, scene.load, scene.output)
    kept = vars(scene).get(_KEPT)  # a copy of a scene with other parts has the model of the first
    if kept is None or any(one is not other for one, other in zip(kept.parts, parts, strict=True)):
        kept = vars(scene)[_KEPT] = _LoweredScene(parts, {})
    model = kept.models.get(in_time) or kept.models.get(True)
    if model is None or (model.written_speeds and not in_time):
        model = kept.models[in_time] = _build_model(scene if in_time else _in_frequency(scene))
    if in_time and any(bar.loss != 0 for bar in model.network.bars):
        model.network.refuse_loss(damping_in_time(scene, model.network))
    return model


class _LoweredScene(NamedTuple):
    """A model, and the parts of the scene that it was made from."""

    parts: tuple[object, ...]
    models: dict[bool, Model]


def _in_frequency(scene: Scene) -> Scene:
    """The same scene, its loads never changing: they act where they do, by nothing; speeds are as they are written."""
    still = tuple(
        load.truncate(Fraction(0), Fraction(1)) if isinstance(load, ShapedLoad) else load for load in scene.load
    )
    other = scene.model_copy()
    vars(other)["load"] = still
    if isinstance(scene.system, ExplicitChain):
        vars(other)["system"] = scene.system.unadjusted
    return other


def _build_model(scene: Scene) -> Model:
    output = scene.output
    length, in_lines = scene.physical.length if scene.physical else None, scene.in_lines
    chain, network = named_chain(scene), _with_powers(scene.system.network(scene.load, length), scene.load)
    return Model(
        name=scene.name,
        network=network,
        loads=merge_loads((*dead_loads(network), *_loads(scene))),
        probes=probes(scene, scene.outputs),
        until=rational(output.until),
        tolerance=rational(scene.tolerance),
        labels=_labels(scene, chain, network),
        clock=scene.scale.clock if scene.scale else None,
        length=length,
        damping=_damping(scene),
        inputs=_inputs(scene),
        spacing=min((rational(load.step) for load in scene.load if load.step), default=None),
        preset=SystemParameters(chain) if chain else None,
        written_speeds=written_speeds(scene),
        speed_adjustment=_speed_adjustment(scene),
        lines=partial(_lower_straight, scene, in_lines) if in_lines is not scene else None,
    )


def _lower_straight(scene: Scene, in_lines: Scene, coarsest: fmpq) -> Model:
    """The model of a scene in lines, of which that to its own tolerance is there."""
    return lower(in_lines if fraction(coarsest) <= in_lines.tolerance else scene.straighten(fraction(coarsest)))


def _with_powers(network: Network, loads: Iterable[Load]) -> Network:
    """A network whose loaded points take the powers of time, too, that loads of a shape are made of."""
    degrees = {load.sources: load.degree for load in loads if isinstance(load, ShapedLoad)}
    points = list(network.points)
    for (step, ramp), degree in degrees.items():
        number, unit = next((k, u) for k, p in enumerate(points) for u in p.loads if u.source == step)
        _, *rising = unit.coefficients  # of an acceleration that moves a point, with the velocity that a step makes
        powers = [
            UnitLoad(
                power_source(ramp, k),
                None,
                (fmpq(0),) * (k + len(rising)) + (unit.coefficients[-1] / (k + 1 if rising else 1),),
            )
            for k in range(2, degree + 1)
        ]
        points[number] = replace(points[number], loads=(*points[number].loads, *powers))
    return replace(network, points=tuple(points))


def named_chain(scene: Scene) -> Chain | None:
    """The chain as the paper has it, None of a scene that the paper has not.

    Tables, derivations and walks are written in its letters; everything else takes the network.
    """
    return scene.system.named_chain(scene.load)


def _damping(scene: Scene) -> Damping | None:
    """That of the modes, where it is any."""
    damping: Damping | None = getattr(scene.system, "damping", None)  # a collision has none
    return damping if damping and any(damping.ratios) else None


def _speed_adjustment(scene: Scene) -> fmpq | None:
    """How much of its speed that of a rod may change."""
    most: Fraction | None = getattr(scene.system, "speed_adjustment", None)  # a collision has none
    return None if most is None else rational(most)


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
        if scene.output.stress:
            fields["sections"] = [str(rod.section) for rod in scene.scale.rods.all]
    canonical = json.dumps(fields, sort_keys=True, separators=(",", ":"))
    system = {"type": scene.system.type, **(scene.physical.system if scene.physical else scene.system.choices)}
    if change := changed_speeds(scene):
        system["speeds_changed_by"] = change
    return Labels(
        system=system,
        loads=scene.physical.loads if scene.physical else tuple(load.description for load in scene.load),
        sha256=hashlib.sha256(canonical.encode()).hexdigest(),
        structure_notes=structure_notes(scene, _damping(scene)),
        time_notes=time_notes(scene),
        kind=scene.scale.kind if scene.scale else "",
        size=f"m = {chain.m}" if chain else f"{len(network.bars)} rods",
        dimensions="x in rod lengths, tau = c t / l" if chain else "places in lengths, tau in lengths at speed 1",
        load_names=load_names(scene),
        sources={source: load.label for load in scene.load for source in load.sources},
        titles={source: load.name for load in scene.load if load.name for source in load.sources},
        shapes=tuple(
            SampledShape(f"load[{k}]", load.shape, load.degree, load.count, float(load.error))
            for k, load in enumerate(scene.load)
            if isinstance(load, ShapedLoad)
        ),
    )


def _loads(scene: Scene) -> tuple[AppliedLoad, ...]:
    """The loads, one after the other."""
    if not scene.system.load_kinds:
        return (AppliedLoad("impact", fmpq(0), fmpq(1)),)
    return tuple(unit for load in scene.load for unit in load.units())


def amplitudes(scene: Scene) -> tuple[tuple[str, AppliedLoad], ...]:
    """The numbers of the loads in the order of the scene, each with what it is called; zeros too.

    Of a load that has samples it is one, the factor of all of them: 1.
    """
    found: list[tuple[str, AppliedLoad]] = []
    for label, load in zip(load_names(scene), scene.load, strict=True):
        if not isinstance(load, TimedLoad):
            samples = AppliedRecord(load.sources[0], fmpq(0), fmpq(1), merge_loads(load.units()))
            found.append((f"factor of the {label}, samples at {spacing_text(scene, load)}", samples))
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


def lower_rising(scene: Scene, step: Fraction) -> Model:
    """The model of a scene under loads that come `step` apart, as nobody knows them: each rises to 1 in the first step,
    and stays.
    """
    other = scene.model_copy()
    vars(other)["load"] = tuple(load.rise(step) if isinstance(load, TimedLoad) else load for load in scene.load)
    model, every = lower(other), rational(step)
    rises = [
        AppliedLoad(ramp, time, slope)
        for ramp in dict.fromkeys(load.sources[1] for load in scene.load)
        for time, slope in ((fmpq(0), 1 / every), (every, -1 / every))
    ]
    return replace(model, loads=merge_loads((*dead_loads(model.network), *rises)), spacing=every)


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
