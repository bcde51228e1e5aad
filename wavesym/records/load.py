"""A load that is a record: 0, then straight lines through its samples, then 0 again.

From the last sample it goes to 0 in a straight line within one step; to the first one it comes from 0 in the same way,
where that is not at the very start. So a record has no jump but one at tau = 0, and no drift of its own after it ends.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Annotated, Self

from flint import fmpq
from pydantic import Field, PlainValidator, PrivateAttr, model_validator

from wavesym.fields.loads import Load, linear
from wavesym.fields.numbers import Exact, Positive, decimal_text
from wavesym.fields.table import refusal, show
from wavesym.mechanics.loads import AppliedLoad
from wavesym.numbers.doubles import rational
from wavesym.records.recording import Recorded


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise refusal(f"{show(value)} is not a name; write that of a column")
    return value


class RecordedLoad(Load):
    """A load whose samples are in a file; what else it needs to know of them is said once, by the file or beside it."""

    column: Annotated[str, PlainValidator(_text)] | None = None
    spacing: Positive | None = None
    start: Exact | None = None
    scale: Exact = Fraction(1)
    record: Recorded = Field(description="the path of a file")

    _delayed: bool = PrivateAttr(default=False)

    @model_validator(mode="after")
    def _refuse_repeated_units(self) -> Self:
        if self.record.unit or self.record.clock:
            has = " and ".join(filter(None, (self.record.clock, self.record.unit)))
            raise refusal(
                f"the file says {has}, but the scene has no units; write numbers without units, or [units] in the "
                "scene",
                "record",
            )
        self._refuse_repetition("spacing", self.spacing, self.record.spacing)
        self._refuse_repetition("start", self.start, self.record.start)
        if self.spacing is None and self.record.spacing is None:
            raise refusal("missing, and the file does not say it; write the time between samples", "spacing")
        if self._start != 0 and self._start < self.step:
            steps = f"{decimal_text(self._start / self.step)} steps"
            key = "record" if self.start is None else "start"
            raise refusal(f"a first sample after {steps}, but the load comes from 0; write 0, or 1 or more", key)
        return self

    def _refuse_repetition(self, key: str, here: Fraction | None, there: Fraction | None) -> None:
        if here is not None and there is not None and here != there:
            raise refusal(f"{decimal_text(here)}, but the file says {decimal_text(there)}; write that, or nothing", key)

    @property
    def step(self) -> Fraction:
        """The time between samples."""
        step = self.record.spacing if self.spacing is None else self.spacing
        assert step is not None  # or the load was refused
        return step

    @property
    def begin(self) -> Fraction:
        """The time of the first sample."""
        return self.step if self._delayed else self._start

    @property
    def _start(self) -> Fraction:
        return next((start for start in (self.start, self.record.start) if start is not None), Fraction(0))

    @property
    def is_delayed(self) -> bool:
        """Whether it begins one spacing later than it says, so that it does not jump to its first sample."""
        return self._delayed

    def without_jump(self) -> Self:
        """The same load, one spacing later where it would jump at tau = 0: it rises to its first sample from 0."""
        if self._start or not (self.scale and self.record.samples[0]):
            return self
        later = self.model_copy()
        later._delayed = True
        return later

    def units(self) -> Iterator[AppliedLoad]:
        """The load as unit responses: steps and ramps."""
        scale, end = rational(self.scale), fmpq(0)
        samples = [scale * rational(sample) for sample in self.record.samples]
        if self.begin == 0:
            return linear(Fraction(0), self.step, [*samples, end], self.sources)
        return linear(self.begin - self.step, self.step, [end, *samples, end], self.sources)

    @property
    def description(self) -> str:
        """In a line."""
        samples, begin = self.record.samples, self.begin
        last = begin + (len(samples) - 1) * self.step
        return f"{len(samples)} samples at {self.step}, from tau = {begin} to {last}; 0 one step later"
