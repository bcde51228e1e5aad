"""Loads on the nodes of an explicit chain: steps and ramps at given times, or samples."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import Field, PlainValidator, model_validator

from wavesym.fields.loads import SampledLoad, TimedLoad
from wavesym.fields.numbers import LONGEST, Numbers, exact, written
from wavesym.fields.table import shown, wrong
from wavesym.model.loads import Applied
from wavesym.numbers.doubles import rational
from wavesym.systems.place import position_of


def _at(value: object) -> str:
    text = written(value)
    if text is None:
        text = str(exact(value))
    if len(text) > LONGEST:
        raise wrong(f"{shown(value)} given, at most {LONGEST} characters expected")
    position_of(text)
    return str(text)


At = Annotated[str, PlainValidator(_at)]


class NodeLoad(TimedLoad):
    """sum_k (steps_k + ramps_k (tau - times_k)) H(tau - times_k), on a node."""

    at: At = Field(description="the name or place of a node")
    steps: Numbers = ()
    ramps: Numbers = ()

    @model_validator(mode="after")
    def _something(self) -> NodeLoad:
        for name in ("steps", "ramps"):
            numbers = getattr(self, name)
            if numbers and len(numbers) != len(self.times):
                raise wrong(f"{len(numbers)} numbers given, {len(self.times)} expected (as many as times)", name)
        if not (self.steps or self.ramps):
            raise wrong("no numbers given, steps or ramps expected")
        return self

    def units(self) -> Iterator[Applied]:
        """The load as unit responses."""
        for name, numbers in (("step", self.steps), ("ramp", self.ramps)):
            for time, number in zip(self.times, numbers, strict=False):
                yield Applied(f"{self.at}:{name}", rational(time), rational(number))


class SampledNodeLoad(SampledLoad):
    """A load that is linear between its samples, on a node."""

    at: At = Field(description="the name or place of a node")

    def units(self) -> Iterator[Applied]:
        """The load as unit responses."""
        return self.sampled(f"{self.at}:step", f"{self.at}:ramp")
