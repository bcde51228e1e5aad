"""Loads on the nodes of an explicit chain: steps and ramps at given times, samples, or a record."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, PlainValidator

from wavesym.fields.loads import Load, LoadKinds, SampledLoad, TimedLoad
from wavesym.fields.numbers import LONGEST, Numbers, exact, number_text
from wavesym.fields.shapes import ShapedLoad
from wavesym.fields.table import refusal, show
from wavesym.records.load import RecordedLoad
from wavesym.systems.place import PlaceInUnits, position_of


def _read_place(value: object) -> str:
    text = number_text(value)
    if text is None:
        text = str(exact(value))
    if len(text) > LONGEST:
        raise refusal(f"{show(value)} is too long; write at most {LONGEST} characters")
    position_of(text)
    return value if isinstance(value, PlaceInUnits) else str(text)


At = Annotated[str, PlainValidator(_read_place)]


class OnNode(Load):
    """A load on a node, or the motion of an end."""

    at: At = Field(description="the name or place of a node")

    @property
    def sources(self) -> tuple[str, str]:
        """A step and a ramp there."""
        return f"{self.at}:step", f"{self.at}:ramp"

    @property
    def action(self) -> str:
        """What it acts as, for people."""
        return f"load at {self.at}"


class NodeLoad(OnNode, TimedLoad):
    """sum_k (steps_k + ramps_k (tau - times_k)) H(tau - times_k)."""

    steps: Numbers = ()
    ramps: Numbers = ()


class SampledNodeLoad(OnNode, SampledLoad):
    """A load that is linear between its samples."""


class RecordedNodeLoad(OnNode, RecordedLoad):
    """A load that is a record."""


class ShapedNodeLoad(OnNode, ShapedLoad):
    """A load of one shape."""


NODE_LOADS: LoadKinds = (NodeLoad, SampledNodeLoad, RecordedNodeLoad, ShapedNodeLoad)
