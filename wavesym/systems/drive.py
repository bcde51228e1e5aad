"""System II: m shafts between m + 1 rigid discs under moments that step (4.4), or ramp."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, ClassVar, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer

from wavesym.fields.damping import ModalDamping, without_damping
from wavesym.fields.loads import Load, LoadKinds, SampledLoad, TimedLoad
from wavesym.fields.numbers import Integer, Numbers, Positives
from wavesym.fields.shapes import ShapedLoad
from wavesym.fields.table import shown
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Family, Node, Parameters, Quantity, Rod, System, UnitLoad, single
from wavesym.records.load import RecordedLoad
from wavesym.systems.preset import Preset


def _families(ramps: bool, m: Quantity, p: Parameters) -> tuple[Family, ...]:
    def shaft(i: Quantity) -> Rod:
        return Rod(tau0=0, x0=i - 1)

    def moment(number: Quantity, sign: int = 1) -> tuple[UnitLoad, ...]:
        # the A_i of (4.4), in units of G J_01 theta_0 / l
        size = sign * p.kappa[1] * p.inertia[1] / p.inertia[number]
        return (UnitLoad("M", number, (size,)), *([UnitLoad("R", number, (0, size))] if ramps else []))

    def pull(i: Quantity) -> Quantity:
        """What shaft i does to disc i + 1."""
        return 2 * p.kappa[i] * p.inertia[i] / p.inertia[i + 1]

    return (
        single(0, lambda: Node(None, shaft(1), inertia=1, alpha=0, beta=2 * p.kappa[1], loads=moment(1))),
        Family(
            1,
            m - 1,
            1,
            lambda i: Node(
                shaft(i), shaft(i + 1), inertia=1, alpha=pull(i), beta=2 * p.kappa[i + 1], loads=moment(i + 1)
            ),
        ),
        # the last moment counts against positive rotation, as in the paper
        single(m, lambda: Node(shaft(m), None, inertia=1, alpha=pull(m), beta=0, loads=moment(m + 1, sign=-1))),
    )


def _indices(m: int) -> Mapping[str, range]:
    return {"kappa": range(1, m + 1), "inertia": range(1, m + 2)}


DRIVE = System("drive", partial(_families, False), _indices, smallest=1)
DRIVE_RAMPS = System("drive-ramps", partial(_families, True), _indices, smallest=1)
"""With ramps of the moments, which the paper does not have, beside their steps."""


class OnBody(Load):
    """(3.1): the moment on a body of a drive."""

    body: Integer = Field(description="the number of a body, 1 to m + 1")

    def refused(self, m: int) -> tuple[str, str] | None:
        """A body that there is not."""
        if 1 <= self.body <= m + 1:
            return None
        return f"{shown(self.body)} is not the number of a body; write 1 to {m + 1}", "body"

    @property
    def sources(self) -> tuple[str, str]:
        """A step and a ramp of it."""
        return f"M{self.body}", f"R{self.body}"

    @property
    def label(self) -> str:
        """What it is, for people."""
        return f"torque on disc {self.body}"


class Moment(OnBody, TimedLoad):
    """sum_k (steps_k + ramps_k (tau - times_k)) H(tau - times_k)."""

    steps: Numbers = ()
    ramps: Numbers = ()

    @model_serializer(mode="wrap")
    def _said(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without ramps where there are none: so scenes keep the hash that they have had."""
        said: dict[str, Any] = handler(self)
        return {key: value for key, value in said.items() if key != "ramps" or self.ramps}


class SampledMoment(OnBody, SampledLoad):
    """A moment that is linear between its samples."""


class RecordedMoment(OnBody, RecordedLoad):
    """A moment that is a record."""


class ShapedMoment(OnBody, ShapedLoad):
    """A moment of one shape."""


class Drive(Preset):
    """m shafts between m + 1 rigid discs at x = 0, 1, ... m."""

    variants: ClassVar[tuple[System, ...]] = (DRIVE,)
    beside: ClassVar[tuple[System, ...]] = (DRIVE_RAMPS,)
    counts: ClassVar[Mapping[str, str]] = {"kappa": "m", "inertia": "m + 1"}
    load_kinds: ClassVar[LoadKinds] = (Moment, SampledMoment, RecordedMoment, ShapedMoment)

    type: Literal["drive"] = Field(description='"drive"')
    kappa: Positives = Field(description="a list of m positive numbers")
    inertia: Positives = Field(description="a list of m + 1 positive numbers")
    damping: ModalDamping = None

    @model_serializer(mode="wrap")
    def _said(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return without_damping(handler(self))

    @property
    def choices(self) -> Mapping[str, str]:
        """How its modes are damped."""
        return {"damping": self.damping.told} if self.damping else {}

    def named_chain(self, loads: Sequence[Load]) -> Chain:
        """The chain as the paper has it, with ramps where a load needs them."""
        ramped = any(not isinstance(load, Moment) or any(load.ramps) for load in loads)
        return replace(self.chain, system=DRIVE_RAMPS) if ramped else self.chain
