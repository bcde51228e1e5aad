"""The dimensions of a sweep: fields that are varied, each with its exact values and a coordinate for people."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import arb, ctx
from pydantic_core import PydanticCustomError

from wavesym.errors import SceneError
from wavesym.fields.numbers import exact, number_text
from wavesym.fields.quantity import split_quantity
from wavesym.fields.quantity_fields import plain
from wavesym.fields.table import refusal, show
from wavesym.numbers.doubles import midpoint, rational
from wavesym.sweeps.request import Span

_BITS = 128  # of values in equal ratios, each of which is rounded once to a double


@dataclass(frozen=True)
class Column:
    """A field that is varied: its `path`, the `values` that it takes, and how each of them is `told`.

    `coordinate` is numbers where all values are numbers, in `unit` where they are quantities of one unit; else text.
    """

    path: str
    values: tuple[Any, ...]
    labels: tuple[str, ...]
    coordinate: tuple[float, ...] | tuple[str, ...]
    unit: str = ""

    @classmethod
    def from_values(cls, path: str, given: Iterable[object]) -> Column:
        """The column of values as a user gives them."""
        values = tuple(plain(value) for value in given)
        found = [number_of(value) for value in values]
        units = {each[1] for each in found if each is not None}
        texts = tuple(value if isinstance(value, str) else json.dumps(value, default=str) for value in values)
        if None in found or len(units) != 1:
            return cls(path, values, texts, texts)
        numbers = tuple(float(each[0]) for each in found if each is not None)
        return cls(path, values, texts, numbers, units.pop())

    @cached_property
    def keys(self) -> tuple[object, ...]:
        """What tells two values apart: 0.5 and "1/2" are the same."""
        return tuple(number or label for number, label in zip(map(number_of, self.values), self.labels, strict=True))


@dataclass(frozen=True)
class SweepAxis:
    """Columns that are run through side by side: one, but where a sweep zips them."""

    name: str
    columns: tuple[Column, ...]

    def __len__(self) -> int:
        return len(self.columns[0].values)

    def refuse_duplicates(self, path: str) -> None:
        """SceneError where two of its values are the same."""
        seen: dict[object, int] = {}
        for k, key in enumerate(zip(*(column.keys for column in self.columns), strict=True)):
            if key in seen:
                seen_value = ", ".join(column.labels[k] for column in self.columns)
                raise SceneError(f"{show(seen_value)} stands at [{seen[key]}] and again at [{k}]; write it once", path)
            seen[key] = k


def count_of(values: Span | tuple[object, ...]) -> int:
    """How many there are, known before they are made."""
    return values.count if isinstance(values, Span) else len(values)


def spread(values: Span | tuple[object, ...]) -> Sequence[object]:
    """The values, one by one. Raises the error of `table.refusal`."""
    if not isinstance(values, Span):
        return values
    (first, unit), (last, other) = _end(values.first, "from"), _end(values.last, "to")
    if unit != other:
        raise refusal(f"{show(values.last)} has another unit than `from`; write a number in {unit or 'no unit'}", "to")
    steps = values.count - 1
    if not steps and first != last:
        raise refusal("1 value, but `from` and `to` differ; write 2 or more", "count")
    if values.log:
        if first * last <= 0:
            raise refusal(
                f"{show(values.last)} has another sign than `from`, so there are no equal ratios; write "
                "two numbers of one sign",
                "to",
            )
        inner = [_geometric_point(first, last, Fraction(k, steps)) for k in range(1, steps)]
    else:
        inner = [first + (last - first) * Fraction(k, steps) for k in range(1, steps)]
    numbers = [first, *inner, *([last] if steps else [])]
    return [_labels(number, unit) for number in numbers]


def _geometric_point(first: Fraction, last: Fraction, part: Fraction) -> Fraction:
    """first (last/first)^part, rounded to the shortest decimal of a double."""
    with ctx.workprec(_BITS):
        ratio = arb(rational(last / first)) ** arb(rational(part))
        return exact(midpoint(ratio * arb(rational(first))))


def _labels(number: Fraction, unit: str) -> object:
    if unit:
        return f"{number} {unit}"
    return int(number) if number.denominator == 1 else str(number)


def _end(value: object, key: str) -> tuple[Fraction, str]:
    found = number_of(plain(value))
    if found is None:
        raise refusal(f"{show(value)} is not a number; write one, with a unit or without", key)
    return found


def number_of(value: object) -> tuple[Fraction, str] | None:
    """A number and its unit, "" without; None of anything else."""
    if isinstance(value, bool) or (number_text(value) is None and not isinstance(value, int)):
        return None
    try:
        return exact(value), ""
    except PydanticCustomError:
        return split_quantity(value)
