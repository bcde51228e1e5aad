"""Fields of physical tables: quantities of a dimension, checked where they are read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Annotated, Any

from pydantic import PlainValidator

from wavesym.fields.dimensions import DIMENSIONS, with_article
from wavesym.fields.numbers import number_text
from wavesym.fields.quantity import si_value
from wavesym.fields.table import SceneTable, refusal, show


def read_quantity(value: object, dimension: str, least: int | None = None) -> Fraction:
    """A quantity in SI base units, above 0 where `least` is 1, not below it where that is 0."""
    number = si_value(value, dimension)
    if least is not None and (number < 0 or (number == 0 and least)):
        sign, size = ("not positive", "above 0") if least else ("negative", "of 0 or more")
        raise refusal(f"{show(value)} is {sign}; write {with_article(dimension)} {size}")
    return number


def missing(dimension: str, *at: str | int) -> Exception:
    """The error for a quantity that is not given."""
    return refusal(f'missing; write {with_article(dimension)} such as "{DIMENSIONS[dimension].example}"', *at)


def _positive(dimension: str) -> Callable[[object], Fraction]:
    return lambda value: read_quantity(value, dimension, 1)


Length = Annotated[Fraction, PlainValidator(_positive("length"))]
Bore = Annotated[Fraction, PlainValidator(lambda value: read_quantity(value, "length", 0))]  # 0: a full shaft
Mass = Annotated[Fraction, PlainValidator(_positive("mass"))]
Area = Annotated[Fraction, PlainValidator(_positive("area"))]
Modulus = Annotated[Fraction, PlainValidator(_positive("modulus"))]
Density = Annotated[Fraction, PlainValidator(_positive("density"))]
Stiffness = Annotated[Fraction, PlainValidator(_positive("stiffness"))]
SecondMoment = Annotated[Fraction, PlainValidator(_positive("second moment of area"))]
Inertia = Annotated[Fraction, PlainValidator(_positive("moment of inertia"))]
Speed = Annotated[Fraction, PlainValidator(_positive("velocity"))]
Velocity = Annotated[Fraction, PlainValidator(lambda value: read_quantity(value, "velocity"))]


def one_of(table: SceneTable, *keys: str) -> str:
    """Which one of some keys is given. Raises the error of `table.refusal` where it is not one."""
    given = [key for key in keys if getattr(table, key) is not None]
    *others, last = keys
    if not given:
        raise refusal(f"missing; write {', '.join(others)} or {last}", keys[0])
    if len(given) > 1:
        raise refusal(f"stands beside {given[0]}; write one of them", given[1])
    return given[0]


def plain(value: object) -> Any:
    """A value of a scene as TOML has it, exact: text, integers, lists and tables."""
    match value:
        case SceneTable():
            return plain(value.model_dump(exclude_defaults=True))
        case Mapping():
            return {str(key): plain(each) for key, each in value.items()}
        case list() | tuple():
            return [plain(each) for each in value]
        case bool() | int() | str():
            return str(value) if isinstance(value, str) else value
        case Fraction():
            return str(value)
    text = number_text(value)
    return value if text is None else text


def tidy(number: Fraction) -> str:
    """A number for a message, with 6 digits."""
    return f"{float(number):.6g}"
