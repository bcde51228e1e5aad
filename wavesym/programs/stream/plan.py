"""What is streamed: a chain as the march of chains has it (rings/plan.py), on equal panels, and its inputs; all exact.

Every joint that a wave can ever come from is part of it, as a stream has no end. A panel is a part of the march's step
such that

- loads may change at its edges: where the time between two calls is fixed, it is a number of panels;
- an output hears a joint that is loaded at once, or a panel later at the earliest: what loads have done is known as a
  polynomial once a panel is over, and as a number now;
- it is no longer than `LONGEST`, and where joints are fast shorter, down to `SHORTEST`.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import fmpq

from wavesym.errors import CostError, UnservedError
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.mechanics.node import RAMPS
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import Real
from wavesym.programs.march.plan import MarchPanel
from wavesym.programs.rings.plan import Heard, MarchedJoint, RingPlan, moved_by, ring_plan

LONGEST = fmpq(1, 8)
SHORTEST = fmpq(1, 64)
FINEST = fmpq(1, 1024)
"""No panel is shorter, unless the step of the march is nearly so."""
_CALM = 4.0  # rate times panel

_ZERO, _ONE = fmpq(0), fmpq(1)


@dataclass(frozen=True)
class Input:
    """A load that is given: its source in the chain, and what 1 of the chain's is in the `unit` that a user gives."""

    source: str
    size: fmpq
    unit: str

    @property
    def name(self) -> str:
        """What a user calls it: a source without what it is a step of."""
        return self.source.removesuffix(":step")


@dataclass(frozen=True)
class InputForce:
    """A force (or prescribed velocity), by number: `base` and the sum of gains times inputs, or, where it is `summed`,
    the sum of their integrals.
    """

    base: fmpq
    gains: tuple[fmpq, ...]
    summed: bool


@dataclass(frozen=True)
class StreamPlan:
    """`rings` is the march of all joints, under a step of every input at tau = 0, on the panels of the stream."""

    rings: RingPlan
    inputs: tuple[Input, ...]
    acting: tuple[InputForce, ...]

    @property
    def panel(self) -> fmpq:
        """How long one is."""
        return self.rings.panels[0].length

    @property
    def loaded(self) -> tuple[int, ...]:
        """The joints on which something acts, by number."""
        return _loaded(self.rings.joints)

    @property
    def direct(self) -> tuple[tuple[int, ...], ...]:
        """Of each output the inputs that act on it at once: where a loaded point without mass is heard, or a load."""
        passing: dict[int, tuple[fmpq, ...]] = {}
        for n in self.loaded:
            joint = self.rings.joints[n]
            for port, track in zip(joint.space.ports, joint.sends, strict=True):
                passing[track] = tuple(
                    port.ratio * sum((joint.space.passed[port.point, k] * gain for k, gain in gains), _ZERO)
                    for gains in self._gains(joint)
                )
        return tuple(
            tuple(
                j
                for j in range(len(self.inputs))
                if sum((one.gain * passing[one.track][j] for one in output.heard if _at_once(one, passing)), _ZERO) != 0
            )
            for output in self.rings.outputs
        )

    def _gains(self, joint: MarchedJoint) -> Iterator[list[tuple[int, fmpq]]]:
        """Of each input how much of it acts on which points of a joint, but through its integral."""
        acting = [(k, self.acting[force]) for k, force in enumerate(joint.forces) if force >= 0]
        for j in range(len(self.inputs)):
            yield [(k, force.gains[j]) for k, force in acting if not force.summed]

    def quicker(self, times: fmpq) -> StreamPlan:
        """The same with joints that are so many times as fast."""

        def quick(joint: MarchedJoint) -> MarchedJoint:
            space = joint.space
            return replace(joint, space=replace(space, rates=times * space.rates, pushed=times * space.pushed))

        return replace(self, rings=replace(self.rings, joints=tuple(map(quick, self.rings.joints))))

    def late(self, delay: fmpq) -> tuple[int, fmpq]:
        """A delay as whole panels and a rest."""
        whole = int((delay / self.panel).floor())
        return whole, delay - whole * self.panel


def inputs_of(model: Model, sources: Sequence[str]) -> tuple[Input, ...]:
    """The inputs of a scene whose loads have these sources, or of one without loads: all that its system may have."""
    chosen = list(dict.fromkeys(sources)) or [
        unit.source for point in model.network.points for unit in point.loads if unit.kind not in RAMPS
    ]
    if model.clock is not None and not sources and chosen:
        raise UnservedError("load: none given with [units], at least one expected (its unit is that of the input)")
    return tuple(Input(source, *model.inputs.get(source, (_ONE, ""))) for source in chosen)


def steps_of(inputs: Sequence[Input]) -> tuple[Applied, ...]:
    """Steps of all inputs at tau = 0."""
    return tuple(Applied(given.source, _ZERO, _ONE) for given in sorted(inputs, key=lambda given: given.source))


def stream_plan(model: Model, inputs: Sequence[Input], real: Real, spacing: fmpq | None = None) -> StreamPlan:
    """The plan of a model in `real` numbers, for calls at any time or `spacing` apart.

    UnservedError for contacts and damped modes; CostError where panels would be too short.
    """
    rings = ring_plan(replace(model, loads=steps_of(inputs)), real)
    acting = acting_inputs(model.network, rings.pushed, inputs)
    return StreamPlan(paneled(rings, spacing), tuple(inputs), tuple(acting))


def paneled(rings: RingPlan, spacing: fmpq | None, quicker: fmpq = _ONE) -> RingPlan:
    """On the panels of a stream, for joints that may be `quicker` than they are."""
    count = _panels(rings, spacing, quicker)
    length = rings.step / count
    return replace(rings, panels=tuple(MarchPanel(k * length, length) for k in range(count)))


def acting_inputs(
    network: Network, pushed: Iterable[int], inputs: Sequence[Input], kept: Any = _ONE
) -> Iterator[InputForce]:
    """What inputs do to the points that are pushed, `kept` times as much as their sizes say; numbers or functions."""
    for number in pushed:
        point = network.points[number]
        units = {unit.source: moved_by(point, unit) for unit in point.loads}
        responses = [units.get(given.source, ()) for given in inputs]
        summed = any(coefficient != 0 for response in responses for coefficient in response[1:])
        gains = (
            sum(response[int(summed) :][:1], _ZERO) * kept / given.size
            for response, given in zip(responses, inputs, strict=True)
        )
        yield InputForce(point.velocity if point.motion is not None else _ZERO, tuple(gains), summed)


def _at_once(one: Heard, passing: Container[int]) -> bool:
    return one.track in passing and one.delay == 0 and not one.summed


def _loaded(joints: Sequence[MarchedJoint]) -> tuple[int, ...]:
    return tuple(n for n, joint in enumerate(joints) if any(force >= 0 for force in joint.forces))


def _panels(rings: RingPlan, spacing: fmpq | None, quicker: fmpq) -> int:
    """How many are a step of the march."""
    step, joints = rings.step, rings.joints
    sent = {track for n in _loaded(joints) for track in joints[n].sends}
    near = {heard.delay: output for output in reversed(rings.outputs) for heard in output.heard if heard.track in sent}
    shortest = min((delay for delay in near if delay != 0), default=step)
    fastest = nearest(quicker) * max(joint.space.norm for joint in joints)
    few = 1 if spacing is None else int((step / spacing).p)
    longest, most = min(LONGEST, shortest), max(int((step / FINEST).floor()), 8)
    count = few * int((step / (few * longest)).ceil())
    if count > most and few > most:
        raise CostError(
            f"load: steps of {spacing} are edges of {few} panels in a window of {step}, at most {most} expected "
            "(a --step in a simpler proportion to it helps)"
        )
    if count > most:
        raise CostError(
            f"output: {near[shortest].name} hears a loaded node after {shortest}, which takes {count} panels in a "
            f"window of {step}, at most {most} expected (a place at that node, or farther away, helps)"
        )
    # by halves, so that edges stay edges
    while nearest(step / count) * fastest > _CALM and step / count > SHORTEST:
        count *= 2
    return count
