"""What loads have in common, as tables of a scene: times with a number for each, or samples at a spacing."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Self

from flint import fmpq
from pydantic import (
    Field,
    PlainValidator,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
    model_validator,
)

from wavesym.fields.numbers import Numbers, Positive
from wavesym.fields.table import SceneTable, refusal, show, without_usual
from wavesym.fields.titles import check_title
from wavesym.mechanics.loads import AppliedLoad
from wavesym.numbers.doubles import rational

_LONG = 440  # characters of a load that is written out
MOST_TIMES = 50_000
"""At so many a load may change: what takes more is refused by every program, half a minute later."""


class Load(SceneTable):
    """A load of a scene; `name` is its name for people, if any."""

    name: Annotated[str, PlainValidator(check_title)] = ""

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return without_usual(handler(self), name="")

    @property
    @abstractmethod
    def sources(self) -> tuple[str, str]:
        """The unit loads that it is made of: a step, and a ramp."""

    @property
    def label(self) -> str:
        """What it is, for people: its name, or else what it acts as."""
        return self.name or self.action

    @property
    @abstractmethod
    def action(self) -> str:
        """What it acts as, for people: "torque on disc 1"."""

    @property
    def step(self) -> Fraction | None:
        """The time between its samples, where it has any."""
        return None

    def fault(self, m: int) -> tuple[str, str] | None:
        """What is wrong with it on a system of m elements, and under which key; None where nothing is."""
        return None

    @abstractmethod
    def units(self) -> Iterator[AppliedLoad]:
        """The load as unit responses."""

    @property
    @abstractmethod
    def description(self) -> str:
        """In a line, and a long one by its size; empty where it is nothing."""


LoadKinds = tuple[type[Load], ...]


def refuse_falling(times: Sequence[Fraction], written: Sequence[object]) -> None:
    """Raise the error of `table.refusal` for times that do not rise, which messages show as they are written."""
    for k, (before, time) in enumerate(pairwise(times), 1):
        if time <= before:
            one, other = show(written[k]), show(written[k - 1])
            raise refusal(f"{one} is not later than the {other} before it; write times in rising order", k)


class TimedLoad(Load):
    """A load that changes at given times, with a number in each other list for each of them.

    `lists` are the names of these lists: of the steps, and of the ramps.
    """

    lists: ClassVar[tuple[str, str]] = ("steps", "ramps")

    times: Numbers = Field(description="a list of times")

    @field_validator("times", mode="before")
    @classmethod
    def _refuse_many(cls, times: object) -> object:
        """Before any of them is looked at."""
        if isinstance(times, list | tuple) and len(times) > MOST_TIMES:
            raise refusal(f"{len(times)} times, the limit is {MOST_TIMES}; write `samples` at a spacing, or a `record`")
        return times

    @field_validator("times")
    @classmethod
    def _check_times(cls, times: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
        if times and times[0] < 0:
            raise refusal(f"{show(times[0])} is before the start; write a time of 0 or later", 0)
        refuse_falling(times, times)
        return times

    @model_validator(mode="after")
    def _check_lengths(self) -> Self:
        for name, numbers in zip(self.lists, self._numbers, strict=True):
            if numbers and len(numbers) != len(self.times):
                raise refusal(
                    f"{len(numbers)} numbers for {len(self.times)} times; write {len(self.times)}, one for each", name
                )
        if self.times and not any(self._numbers):
            raise refusal(f"no numbers; write {' or '.join(self.lists)}")
        return self

    @property
    def _numbers(self) -> tuple[tuple[Fraction, ...], tuple[Fraction, ...]]:
        steps, ramps = self.lists
        return getattr(self, steps), getattr(self, ramps)

    def rise(self, within: Fraction) -> Self:
        """The load that acts there, but rises to 1 from the start on, and stays."""
        steps, ramps = self.lists
        return self.model_copy(update={"times": (Fraction(0), within), steps: (), ramps: (1 / within, -1 / within)})

    def by_list(self) -> Iterator[tuple[str, list[AppliedLoad]]]:
        """Each list that is given, by name, as unit responses."""
        for name, source, numbers in zip(self.lists, self.sources, self._numbers, strict=True):
            if numbers:
                times = zip(self.times, numbers, strict=True)
                yield name, [AppliedLoad(source, rational(time), rational(number)) for time, number in times]

    def units(self) -> Iterator[AppliedLoad]:
        """The load as unit responses."""
        given = [(source, numbers) for source, numbers in zip(self.sources, self._numbers, strict=True) if numbers]
        for k, time in enumerate(self.times):
            for source, numbers in given:
                yield AppliedLoad(source, rational(time), rational(numbers[k]))

    @property
    def description(self) -> str:
        """In a line, and a long one by its size; empty where it is nothing."""
        line = ", ".join(f"{unit.weight} {unit.source} at {unit.time}" for unit in self.units() if unit.weight)
        if len(line) > _LONG:
            return f"{len(self.times)} changes from tau = {self.times[0]} to {self.times[-1]}"
        return line


class SampledLoad(Load):
    """A load that is linear between its samples at tau = 0, spacing, ... and constant after the last."""

    spacing: Positive = Field(description="the time between samples")
    samples: Numbers = Field(description="a list of numbers")

    @field_validator("samples")
    @classmethod
    def _check_samples(cls, samples: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
        if not samples:
            raise refusal("no numbers; write at least 1")
        return samples

    @property
    def step(self) -> Fraction:
        """The time between samples."""
        return self.spacing

    def units(self) -> Iterator[AppliedLoad]:
        """The load as unit responses."""
        return linear(Fraction(0), self.spacing, self.samples, self.sources)

    @property
    def description(self) -> str:
        """In a line."""
        last = (len(self.samples) - 1) * self.spacing
        return f"{len(self.samples)} samples at {self.spacing}, to tau = {last}"


def linear(
    start: Fraction, spacing: Fraction, samples: Sequence[Fraction | fmpq], sources: tuple[str, str]
) -> Iterator[AppliedLoad]:
    """Straight lines through samples, constant after the last: a step to the first, then the changes of slope."""
    step, ramp = sources
    time, each, values = rational(start), rational(spacing), [rational(sample) for sample in samples]
    yield AppliedLoad(step, time, values[0])
    slope = fmpq(0)
    for k, (left, right) in enumerate(pairwise((*values, values[-1]))):
        before, slope = slope, (right - left) / each
        yield AppliedLoad(ramp, time + k * each, slope - before)
