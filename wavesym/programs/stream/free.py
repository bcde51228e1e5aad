"""What is streamed where parameters come at run time: the same march over functions of them.

Lengths, speeds and panels stay. What joints make of waves, what is on its way at tau = 0, how strong inputs are and
what outputs weigh are rational functions of the parameters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from flint import fmpq, fmpq_mat

from wavesym.errors import UnservedError, WavesymError
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.numbers.ratio import Ratio
from wavesym.numbers.reals import Real
from wavesym.programs.march.plan import MarchedJoint, MarchOutput, MarchPlan, march_plan
from wavesym.programs.march.space import JointRows, JointSpace, Rows, joint_rows
from wavesym.programs.runtime.network import RuntimeField, free_network
from wavesym.programs.stream.plan import Input, InputForce, StreamPlan, acting_inputs, breakpoints, paneled, steps_of

QUICKER = fmpq(10)
"""Panels and the degree are enough for joints that parameters make so many times as fast as the scene's own are."""

_ONE = fmpq(1)


@dataclass(frozen=True)
class FreeStream:
    """`rings` and `acting` have functions of the parameters, whose numbers in the scene are those of `fields`."""

    model: Model
    inputs: tuple[Input, ...]
    fields: tuple[RuntimeField, ...]
    rings: MarchPlan
    acting: tuple[InputForce, ...]

    @property
    def quicker(self) -> fmpq:
        """How many times as fast as those of the scene joints may be."""
        return QUICKER if any(field.positive for field in self.fields) else _ONE

    def plan(self, spacing: fmpq | None, *, simulated: bool = False) -> StreamPlan:
        """With the numbers of the scene, as any other stream."""
        rings = replace(
            self.rings,
            model=replace(self.model, loads=steps_of(self.inputs)),
            tracks=tuple(
                replace(track, held=self._number(track.held), impedance=self._number(track.impedance))
                for track in self.rings.tracks
            ),
            joints=tuple(map(self._joint, self.rings.joints)),
            outputs=tuple(
                MarchOutput(output.name, tuple(replace(one, gain=self._number(one.gain)) for one in output.heard))
                for output in self.rings.outputs
            ),
        )
        acting = (
            InputForce(self._number(force.base), tuple(map(self._number, force.gains)), force.summed)
            for force in self.acting
        )
        panels = paneled(rings, spacing, self.quicker)
        room = breakpoints(self.model, panels, spacing, simulated=simulated)
        return StreamPlan(panels, self.inputs, tuple(acting), room)

    @cached_property
    def _values(self) -> Mapping[str, fmpq]:
        return {label: value for field in self.fields for label, value in zip(field.labels, field.values, strict=True)}

    def _number(self, function: Any) -> fmpq:
        return function.at(self._values) if isinstance(function, Ratio) else function

    def _joint(self, joint: MarchedJoint) -> MarchedJoint:
        rows = joint.space
        if not isinstance(rows, JointRows):  # a load that is read
            return joint
        states, points = len(rows.weights), len(rows.passed)

        def matrix(of: Rows, across: int) -> fmpq_mat:
            return fmpq_mat(len(of), across, [self._number(value) for row in of for value in row])

        space = JointSpace(
            matrix(rows.rates, states),
            matrix(rows.pushed, points),
            matrix(rows.shown, states),
            matrix(rows.passed, points),
            tuple(map(self._number, rows.weights)),
            tuple(map(self._number, rows.begun)),
            tuple(
                replace(port, impedance=self._number(port.impedance), push=self._number(port.push))
                for port in rows.ports
            ),
        )
        return replace(joint, space=space)


def free_stream(model: Model, names: Sequence[str], inputs: Sequence[Input], real: Real) -> FreeStream:
    """The stream of a model with the parameters `names` at run time.

    WavesymError for a name that the scene does not have, and for loads; UnservedError, CostError as `fields`,
    `free_network` and `march_plan` say.
    """
    if "load" in names:
        raise WavesymError("--runtime: load given with a stream, other parameters expected (its inputs are the loads)")
    free = free_network(model, names, ())
    network = free.network
    if any(point.motion is not None and isinstance(point.velocity, Ratio) for point in network.points):
        raise UnservedError("--runtime: velocity given where an end moves as it is told, other parameters expected")
    steady = replace(model, network=_loaded(network, model.network), loads=steps_of(inputs))
    rings = march_plan(steady, real, joint_rows)
    kepts: list[Any] = [free.factors.force if probe.quantity == "force" else _ONE for probe in model.probes]
    outputs = tuple(
        MarchOutput(
            output.name,
            tuple(replace(one, gain=one.gain * kept) for one in output.heard),
        )
        for kept, output in zip(kepts, rings.outputs, strict=True)
    )
    acting = acting_inputs(network, rings.pushed, inputs, free.factors.load)
    return FreeStream(model, tuple(inputs), free.fields, replace(rings, outputs=outputs), tuple(acting))


def _loaded(network: Network, own: Network) -> Network:
    """With loads that are numbers: which points they act on is all that counts of them here."""
    points = zip(network.points, own.points, strict=True)
    return replace(network, points=tuple(replace(point, loads=other.loads) for point, other in points))
