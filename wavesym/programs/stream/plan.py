"""What is streamed: a chain as the march of chains has it (march/plan.py), on equal panels, and its inputs; all exact.

Every joint that a wave can ever come from is part of it, as a stream has no end. A panel is a part of the march's step
such that

- loads may change at its edges: where the time between two calls is fixed, it is a number of panels, if these are not
  too short;
- it is no longer than `LONGEST`, and where joints are fast shorter, down to `SHORTEST`.

Instants inside of panels at which loads change, the same ones in every window, are its breakpoints.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.mechanics.node import RAMPS
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import Real
from wavesym.programs.march.plan import MarchedJoint, MarchPlan, Panel, march_plan, unit_action
from wavesym.programs.program import Input

LONGEST = fmpq(1, 8)
SHORTEST = fmpq(1, 64)
FINEST = fmpq(1, 1024)
"""No panel is shorter for the sake of calls that are some time apart, unless the step of the march is nearly so."""
ROOM = 256
"""For so many breakpoints there is room where nothing is known of calls."""
SIMULATED_ROOM = 1024
"""The same where memory is that of a simulator; there is room for one on every panel up to the horizon, too."""
MOST_BREAKPOINTS = 1 << 14
_LOOKED = 1 << 17  # multiples of a spacing
_CALM = 4.0  # rate times panel

_ZERO, _ONE = fmpq(0), fmpq(1)


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
    """`march` is the march of all joints, under a step of every input at tau = 0, on the panels of the stream.

    There is room for so many `breakpoints`.
    """

    march: MarchPlan
    inputs: tuple[Input, ...]
    acting: tuple[InputForce, ...]
    breakpoints: int

    @property
    def panel(self) -> fmpq:
        """How long one is."""
        return self.march.panels[0].length

    @property
    def loaded(self) -> tuple[int, ...]:
        """The joints on which something acts, by number."""
        return tuple(n for n, joint in enumerate(self.march.joints) if any(force >= 0 for force in joint.forces))

    @property
    def direct(self) -> tuple[tuple[int, ...], ...]:
        """Of each output the inputs that act on it at once: where a loaded point without mass is read, or a load."""
        passing: dict[int, tuple[fmpq, ...]] = {}
        for n in self.loaded:
            joint = self.march.joints[n]
            for port, track in zip(joint.space.ports, joint.sends, strict=True):
                passing[track] = tuple(
                    port.ratio * sum((joint.space.feedthrough[port.point, k] * gain for k, gain in gains), _ZERO)
                    for gains in self._gains(joint)
                )
        at_once = (
            [one for one in output.terms if one.track in passing and one.delay == 0 and not one.summed]
            for output in self.march.outputs
        )
        return tuple(
            tuple(j for j in range(len(self.inputs)) if sum((one.gain * passing[one.track][j] for one in terms), _ZERO))
            for terms in at_once
        )

    def _gains(self, joint: MarchedJoint) -> Iterator[list[tuple[int, fmpq]]]:
        """Of each input how much of it acts on which points of a joint, but through its integral."""
        acting = [(k, self.acting[force]) for k, force in enumerate(joint.forces) if force >= 0]
        for j in range(len(self.inputs)):
            yield [(k, force.gains[j]) for k, force in acting if not force.summed]

    def quicker(self, times: fmpq) -> StreamPlan:
        """The same with joints that are so many times as fast."""
        return replace(self, march=self.march.alter_joints(lambda _, space: space.speed_up(times)))

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
        raise UnservedError("load: none, and its unit is that of the input; with [units] write at least one [[load]]")
    return tuple(Input(source, *model.inputs.get(source, (_ONE, ""))) for source in chosen)


def steps_of(inputs: Sequence[Input]) -> tuple[AppliedLoad, ...]:
    """Steps of all inputs at tau = 0."""
    return tuple(AppliedLoad(given.source, _ZERO, _ONE) for given in sorted(inputs, key=lambda given: given.source))


def stream_plan(
    model: Model,
    inputs: Sequence[Input],
    real: Real,
    spacing: fmpq | None = None,
    *,
    simulated: bool = False,
    quicker: fmpq = _ONE,
) -> StreamPlan:
    """The plan of a model in `real` numbers, for calls at any time or `spacing` apart.

    Args:
        model: What is streamed. Its own loads say at which instants loads are likely to change.
        inputs: Its loads.
        real: The numbers of the program.
        spacing: The time between two calls in tau, None where it may be any.
        simulated: Whether memory is that of a simulator.
        quicker: How many times as fast as they are joints may be.

    Raises:
        UnservedError: The model has contacts or damped modes.
    """
    march = march_plan(replace(model, loads=steps_of(inputs)), real, or_pieces=False)
    acting = acting_inputs(model.network, march.loaded_points, inputs)
    count = _panels(march, spacing, quicker)
    length = march.step / count
    march = replace(march, panels=tuple(Panel(k * length, length) for k in range(count)))
    return StreamPlan(march, tuple(inputs), tuple(acting), _breakpoints(model, march, spacing, simulated=simulated))


def _breakpoints(model: Model, march: MarchPlan, spacing: fmpq | None, *, simulated: bool) -> int:
    """For how many instants inside of panels there is to be room, up to `MOST_BREAKPOINTS`.

    Those at which multiples of the `spacing` lie, or the times of the model's own loads, up to the horizon; where
    nothing is known of the time between calls no fewer than `ROOM`, or if they are `simulated` `SIMULATED_ROOM`.
    """
    until, panel = model.until, march.panels[0].length
    if spacing is None:
        times = {load.time for load in model.loads if load.time <= until}
        room = max(SIMULATED_ROOM, int((until / panel).ceil())) if simulated else ROOM
    else:
        count = min(int((until / spacing).floor()), _LOOKED)
        times = {k * spacing for k in range(count + 1)}
        room = 0
    inside = {time - (time / march.step).floor() * march.step for time in times if (time / panel).q != 1}
    return min(max(len(inside), room), MOST_BREAKPOINTS)


def acting_inputs(
    network: Network, pushed: Iterable[int], inputs: Sequence[Input], kept: Any = _ONE
) -> Iterator[InputForce]:
    """What inputs do to the points that are pushed, `kept` times as much as their sizes say; numbers or functions."""
    for number in pushed:
        point = network.points[number]
        units = {unit.source: unit_action(point, unit) for unit in point.loads}
        responses = [units.get(given.source, ()) for given in inputs]
        summed = any(coefficient != 0 for response in responses for coefficient in response[1:])
        gains = (
            sum(response[int(summed) :][:1], _ZERO) * kept / given.size
            for response, given in zip(responses, inputs, strict=True)
        )
        yield InputForce(point.velocity if point.motion is not None else _ZERO, tuple(gains), summed)


def panels_in_common(window: fmpq, spacing: fmpq) -> int | None:
    """How many panels a window is of which the time between two calls is a whole number, the fewest; None for those
    that would be too short.
    """
    count = int((window / spacing).p)
    return count if count <= max(int((window / FINEST).floor()), 8) else None


def _panels(march: MarchPlan, spacing: fmpq | None, quicker: fmpq) -> int:
    """How many are a step of the march."""
    step, fastest = march.step, nearest(quicker) * march.norm
    few = (spacing and panels_in_common(step, spacing)) or 1  # breakpoints are for the others
    count = few * int((step / (few * LONGEST)).ceil())
    # by halves, so that edges stay edges
    while nearest(step / count) * fastest > _CALM and step / count > SHORTEST:
        count *= 2
    return count
