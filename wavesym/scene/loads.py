"""Loads, each reduced to unit responses: the tables of (3.1) and (3.2), and sampled records."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from pydantic import Field, ValidationError, ValidationInfo, field_validator

from wavesym.scene.numbers import Integer, Numbers, Positive
from wavesym.scene.systems import Building, Collision, Drive
from wavesym.scene.table import Table, first_error, listed, shown, wrong


@dataclass(frozen=True)
class Piece:
    """`weight` times the unit response to `source` from `time` (in tau) on.

    `source` is "M1", ... "M(m+1)" (a unit step of that moment), "a" or "b" (a unit step or ramp of the base
    acceleration), or "impact" (a collision, with its velocities).
    """

    source: str
    time: Fraction
    weight: Fraction


class _Timed(Table):
    """A load that changes at given times, with a number in each other list for each of them."""

    times: Numbers = Field(description="a list of times")

    @field_validator("times")
    @classmethod
    def _increasing(cls, times: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
        if times and times[0] < 0:
            raise wrong(f"{shown(times[0])} given, a time of at least 0 expected", 0)
        for k, (before, time) in enumerate(pairwise(times), 1):
            if time <= before:
                raise wrong(f"{shown(time)} given, more than the {shown(before)} before it expected", k)
        return times

    @field_validator("steps", "a", "b", check_fields=False)
    @classmethod
    def _one_a_time(cls, numbers: tuple[Fraction, ...], info: ValidationInfo) -> tuple[Fraction, ...]:
        times = info.data.get("times")
        if times is not None and len(numbers) != len(times):
            raise wrong(f"{len(numbers)} numbers given, {len(times)} expected (as many as times)")
        return numbers


class Moment(_Timed):
    """(3.1): the moment on a body of a drive, sum_k steps_k H(tau - times_k)."""

    body: Integer = Field(description="the number of a body, 1 to m + 1")
    steps: Numbers = Field(description="a list with a number for each time")

    def pieces(self) -> Iterator[Piece]:
        """The load as unit responses."""
        return (Piece(f"M{self.body}", *at) for at in zip(self.times, self.steps, strict=True))


class Acceleration(_Timed):
    """(3.2): the base acceleration of a building, sum_k (a_k + b_k (tau - times_k)) H(tau - times_k)."""

    a: Numbers = Field(description="a list with a number for each time")
    b: Numbers = Field(description="a list with a number for each time")

    def pieces(self) -> Iterator[Piece]:
        """The load as unit responses."""
        for time, a, b in zip(self.times, self.a, self.b, strict=True):
            yield Piece("a", time, a)
            yield Piece("b", time, b)


class Record(Table):
    """A base acceleration that is linear between its samples at tau = 0, spacing, ... and constant after the last."""

    spacing: Positive = Field(description="the time between samples")
    samples: Numbers = Field(description="a list of numbers")

    @field_validator("samples")
    @classmethod
    def _some(cls, samples: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
        if not samples:
            raise wrong("no numbers given, at least 1 expected")
        return samples

    def pieces(self) -> Iterator[Piece]:
        """The load as unit responses: the first sample, and the changes of slope."""
        yield Piece("a", Fraction(0), self.samples[0])
        slope = Fraction(0)
        for k, (left, right) in enumerate(pairwise((*self.samples, self.samples[-1]))):
            before, slope = slope, (right - left) / self.spacing
            yield Piece("b", k * self.spacing, slope - before)


Load = Moment | Acceleration | Record


def loads(tables: object, system: Collision | Drive | Building) -> tuple[Load, ...]:
    """The loads on a system. Which keys a table has depends on the system, so pydantic is told here."""
    if isinstance(tables, Sequence) and tables and isinstance(system, Collision):
        raise wrong("loads given, none expected (a collision has its velocities)")
    return tuple(_load(table, k, system) for k, table in enumerate(listed(tables)))


def _load(table: object, k: int, system: Collision | Drive | Building) -> Load:
    kind: type[Load] = Acceleration
    if isinstance(system, Drive):
        kind = Moment
    elif isinstance(table, dict) and table.keys() & {"spacing", "samples"}:
        kind = Record
    try:
        load = kind.model_validate(table)
    except ValidationError as error:
        what, path = first_error(error)
        raise wrong(what, k, *path) from None
    if isinstance(load, Moment) and not 1 <= load.body <= system.m + 1:
        raise wrong(f"{shown(load.body)} given, a body from 1 to {system.m + 1} expected", k, "body")
    return load


def merged(pieces: Iterable[Piece]) -> tuple[Piece, ...]:
    """Pieces of the same source and time as one, none of weight 0, sorted by time and then by source."""
    weights: dict[tuple[str, Fraction], Fraction] = {}
    for piece in pieces:
        at = piece.source, piece.time
        weights[at] = weights.get(at, Fraction(0)) + piece.weight
    # M2 comes before M10: a shorter name is a smaller number
    ordered = sorted(weights, key=lambda at: (at[1], len(at[0]), at[0]))
    return tuple(Piece(*at, weights[at]) for at in ordered if weights[at])
