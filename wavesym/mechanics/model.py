"""The intermediate form: a scene as engines take it, lowered once; every number exact, all of it frozen."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import NamedTuple

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.clock import Clock
from wavesym.mechanics.damping import Damping
from wavesym.mechanics.gauge import Gauge, Sum, positions, readings
from wavesym.mechanics.length import LengthUnit
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import Network
from wavesym.mechanics.parameters import Parametrization, PartParameters
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import nearest, rational
from wavesym.numbers.reals import DOUBLE, Real


class SampledShape(NamedTuple):
    """A load of a shape as what it acts: polynomials through so many samples, `error` in parts of its amplitude.

    Those of degree 1 are straight lines.
    """

    load: str
    shape: str
    degree: int
    samples: int
    error: float

    def __str__(self) -> str:
        curves = "straight lines between" if self.degree == 1 else f"polynomials of degree {self.degree} through"
        return (
            f"{curves} {self.samples} samples of the {self.shape} {self.load}, within {self.error:.2g} of its amplitude"
        )


@dataclass(frozen=True)
class Labels:
    """What to call a model's parts: `system` its type and what was chosen of it, `loads` a line for each load,
    `load_names` what each is, `sources` what a unit load is one of, and `titles` its name for people, if it has one.

    `sha256` is that of the scene, whatever way it was written. `structure_notes` say how the structure was read where
    that may surprise, `time_notes` how its loads and the horizon were. `kind` is that of the rods of a physical scene.
    `size` is how many rods there are, `dimensions` what lengths and times count.
    `shapes` are the loads that act as lines or polynomials which are not quite what was asked for.
    """

    system: Mapping[str, str]
    loads: tuple[str, ...]
    sha256: str
    structure_notes: tuple[str, ...] = ()
    time_notes: tuple[str, ...] = ()
    kind: str = ""
    size: str = ""
    dimensions: str = ""
    load_names: tuple[str, ...] = ()
    sources: Mapping[str, str] = field(default_factory=dict)
    titles: Mapping[str, str] = field(default_factory=dict)
    shapes: tuple[SampledShape, ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """How all of the scene was read where that may surprise."""
        return (*self.time_notes, *self.structure_notes)

    @property
    def left_out_text(self) -> str:
        """What bounds of errors leave out, to be said behind them; empty where there is nothing."""
        shapes = f", of {' and '.join(map(str, self.shapes))}" if self.shapes else ""
        change = self.system.get("speeds_changed_by")
        return f"{shapes}, of waves whose speeds are changed by {change}" if change else shapes

    @property
    def type(self) -> str:
        """Of a chain that is written out, also where it is a named system: that has rods that differ then."""
        type = self.system["type"]
        return type if type == "chain" else f"{type} of rods that differ, which is a chain,"


@dataclass(frozen=True)
class Model:
    """A network, the loads on it, its outputs until tau = `until`, and the error allowed.

    `tolerance` is relative to an output's largest value. Loads are sorted by time; where they have samples, the closest
    are `spacing` apart. The `clock` is that of a physical scene, `length` the unit of its places where they are
    lengths. `damping` is that of its modes; `inputs` says of the sources of its loads, and of the numbers of its parts
    by name, what 1 is in a unit, and that unit. An `endless` one goes on after that tau. `preset` are the parameters of
    a network that a preset made, None where they are those of its parts. Contacts and other corners are followed
    as far as `followed_probes` need, too, so that one solution serves several models. `written_speeds` are those of the
    bars before they were adjusted, none where they were not; a speed may change by `speed_adjustment`, None where its
    scene cannot say so. `lines` makes the model whose loads are linear between samples, where these are polynomials.
    """

    name: str
    network: Network
    loads: tuple[AppliedLoad, ...]
    probes: tuple[Probe, ...]
    until: fmpq
    tolerance: fmpq
    labels: Labels
    clock: Clock | None = None
    length: LengthUnit | None = None
    damping: Damping | None = None
    spacing: fmpq | None = None
    inputs: Mapping[str, tuple[fmpq, str]] = field(default_factory=dict)
    endless: bool = False
    preset: Parametrization | None = None
    followed_probes: tuple[Probe, ...] = ()
    written_speeds: tuple[fmpq, ...] = ()
    speed_adjustment: fmpq | None = None
    lines: Callable[[fmpq], Model] | None = field(default=None, compare=False, repr=False)

    @property
    def in_lines(self) -> Model:
        """The same under loads that are linear between samples, for programs that take no others.

        CostError for too many samples.
        """
        return self.straighten(fmpq(0))

    def straighten(self, coarsest: fmpq) -> Model:
        """The same, where a tolerance is enough that need be no smaller."""
        if self.lines is None:
            return self
        kept = {name: getattr(self, name) for name in ("probes", "until", "endless", "followed_probes")}
        lines = self.lines(coarsest)
        return replace(lines, tolerance=max(self.tolerance, lines.tolerance), **kept)

    def refuse_polynomials(self) -> None:
        """UnservedError where a load is more than linear: for what takes `in_lines`."""
        if self.lines is not None:
            raise UnservedError("load: polynomials of a shape are supported by closed forms and pieces only")

    @property
    def network_as_written(self) -> Network:
        """The network with speeds of waves as they were before they were adjusted: that of frequencies."""
        if not self.written_speeds:
            return self.network
        pairs = zip(self.network.bars, self.written_speeds, strict=True)
        return replace(self.network, bars=tuple(replace(bar, speed=speed) for bar, speed in pairs))

    @property
    def parameters(self) -> Parametrization:
        """Its numbers by name: those of a preset, or of the parts of the network."""
        return self.preset or PartParameters(self.network)

    def describe_step(self, load: AppliedLoad) -> str:
        """A step of a load, in units where there are any: how much, and when."""
        factor, unit = self.inputs.get(load.source, (fmpq(1), ""))
        when = self.clock.format(load.time) if self.clock else f"tau = {nearest(load.time):g}"
        node, parts, _ = load.source.partition(":")  # of a chain, NODE:step
        if parts:
            point = next(p for p in self.network.points if any(unit.source == load.source for unit in p.loads))
            node = f"what acts at {point.label}"
        return f"{node} jumps by {nearest(load.weight * factor):g}{unit and ' '}{unit} at {when}"

    @cached_property
    def sums(self) -> Mapping[Probe, Sum]:
        """What each output is the sum of."""
        return {probe: readings(self.network, probe) for probe in self.probes}

    @cached_property
    def gauges(self) -> tuple[Gauge, ...]:
        """All that outputs are sums of, but loads; of one that is 0 whatever moves, where it would be."""
        found = {reading: None for terms in self.sums.values() for _, reading in terms if reading.moves}
        for probe, terms in self.sums.items():
            if not terms:
                found[Gauge("velocity", probe.rod, probe.place, probe.point)] = None
        return tuple(found)

    def refuse_damping(self, remedy: str = "write --evaluator modes, or leave it out") -> None:
        """UnservedError, with a remedy, where modes are damped: for what knows nothing but waves."""
        if self.damping is not None:
            raise UnservedError(f"system.damping: supported by modes only ({remedy})")

    @property
    def is_damped(self) -> bool:
        """Whether a mode is damped, so that the whole chain can influence an output from the first instant on."""
        return self.damping is not None and self.damping.acts

    @property
    def whole(self) -> bool:
        """Whether nothing of the chain can be left out."""
        return self.is_damped or self.endless

    def horizon(self, real: Real = DOUBLE) -> float:
        """The last tau in `real` numbers: the smallest of them that is not below `until`."""
        return real.not_below(self.until)

    def to_horizon(self, real: Real = DOUBLE) -> Model:
        """The same until the last tau in `real` numbers, for what compares times with `until`: it has been reached."""
        return self.shorten(rational(self.horizon(real)))

    def loads_until(self, until: fmpq) -> tuple[AppliedLoad, ...]:
        """The loads that begin by then."""
        return self.loads[: bisect_right(self.loads, until, key=lambda load: load.time)]

    def joints_in_reach(self, until: fmpq) -> dict[int, fmpq]:
        """The joints of the network that can influence an output by then, and until when each can.

        A contact counts as if it were closed: it may close. What one does is asked for until the end, as an output is.
        """
        if self.followed_probes and self.network.corners:
            return replace(self, probes=(*self.probes, *self.followed_probes), followed_probes=()).joints_in_reach(
                until
            )
        return self._arrival_times(until, [self.network.links[number].left for number in self.contacts(until)])

    def contacts(self, until: fmpq) -> tuple[int, ...]:
        """The links that are contacts and can influence an output by then."""
        if not self.network.corners:
            return ()
        reached, network = self._arrival_times(until), self.network
        return tuple(n for n in network.corners if network.joint_of[network.links[n].left] in reached)

    def _arrival_times(self, until: fmpq, more: Iterable[int] = ()) -> dict[int, fmpq]:
        network = self.network
        places, points = positions(self.gauges)
        distances = network.distances(places, [*points, *more])
        bars = [network.bars[bar] for bar, _ in places]
        beside = {network.joint_of[point] for bar in bars for point in (bar.left, bar.right)}
        return {
            joint: max(until - distance, fmpq(0))
            for joint, distance in sorted(distances.items())
            if self.whole or distance <= until or joint in beside
        }

    @cached_property
    def letters(self) -> dict[str, dict[int, fmpq]]:
        """The parameters of a preset that can matter to an output within the horizon, by letter and index.

        A body that a wave first meets at `until` has not answered by then; a node without mass has.
        """
        network = self.network

        @cache
        def distances() -> dict[int, fmpq]:
            return network.distances(*positions(self.gauges))

        def matters(point: int) -> bool:
            distance = distances().get(network.joint_of[point])
            if self.whole or distance is None:
                return self.whole
            return distance < self.until or (distance == self.until and network.points[point].mass == 0)

        return self.parameters.letters(matters)

    def shorten(self, until: fmpq) -> Model:
        """The same with an earlier end."""
        return replace(self, until=until)

    def tolerating(self, tolerance: fmpq) -> Model:
        """The same with another error allowed."""
        return replace(self, tolerance=tolerance)

    def watching(self, probes: Iterable[Probe]) -> Model:
        """The same with other outputs."""
        return replace(self, probes=tuple(probes))

    def following(self, probes: Iterable[Probe]) -> Model:
        """The same whose contacts are followed as far as these outputs need, too."""
        return replace(self, followed_probes=tuple(probes))
