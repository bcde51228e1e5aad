"""What every table of a scene has in common: known keys, and one clear line for the first thing that is wrong."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from numbers import Number

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from wavesym.errors import did_you_mean

# Enough to recognise a value by, short enough for a line.
_SHOWN = 40
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


class Written(str):
    """A TOML decimal as it is written, so that it never passes through binary floating point."""

    __slots__ = ()


def shown(value: object) -> str:
    """A value for a message: on one line, in ASCII, and short, however long the value is."""
    match value:
        case bool():
            return str(value).lower()
        case int() | Fraction() if (bits := max(n.bit_length() for n in value.as_integer_ratio())) > 4 * _SHOWN:
            # not written out: Python refuses to print very long integers
            return f"a number of about {bits * 30103 // 100000} digits"
        case Written() | Number() | Decimal():
            text = ascii(str(value))[1:-1]
        case str():
            # cut first: escaping a long text would take long
            text = '"' + ascii(value[: _SHOWN + 1])[1:-1] + '"'
        case Mapping():
            return "a table"
        case list() | tuple():
            return "a list"
        case _:
            return f"a value of type {type(value).__name__}"
    return text if len(text) <= _SHOWN else text[: _SHOWN - 3] + "..."


def wrong(what: str, *at: str | int) -> PydanticCustomError:
    """The error to raise in a validator; `at` leads from the field that is validated to what is wrong in it."""
    return PydanticCustomError("scene", "{what}", {"what": what, "at": at})


def first_error(error: ValidationError) -> tuple[str, tuple[str | int, ...]]:
    """What is wrong, and where: the keys and list indices that lead to it from the table that was validated."""
    first = error.errors(include_url=False, include_input=False)[0]
    context = first.get("ctx", {})
    return context.get("what", first["msg"]), (*first["loc"], *context.get("at", ()))


def key_path(keys: Sequence[str | int]) -> str:
    """`load[0].times[2]` from ("load", 0, "times", 2)."""
    path = ""
    for key in keys:
        if isinstance(key, int):
            path += f"[{key}]"
        else:
            path += f".{key}" if len(key) <= _SHOWN and _BARE_KEY.fullmatch(key) else f".{shown(key)}"
    return path.removeprefix(".")


def listed(value: object) -> tuple[object, ...]:
    """A list, from TOML or from Python."""
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise wrong(f"{shown(value)} is not a list; write [ ] around it")
    return tuple(value)


class SceneTable(BaseModel):
    """A table of a scene: every key is known, none that is needed is missing; a field's description says what it is."""

    # built when it is first used: most scenes have few kinds of tables
    model_config = ConfigDict(extra="forbid", frozen=True, serialize_by_alias=True, defer_build=True)

    @model_validator(mode="before")
    @classmethod
    def _keys(cls, value: object) -> object:
        if not isinstance(value, Mapping):
            raise wrong(f"{shown(value)} is not a table; write its keys and values")
        fields = {field.alias or name: field for name, field in cls.model_fields.items()}
        for key in value:
            if key not in fields:
                *others, last = fields
                known = f"{', '.join(others)} or {last}" if others else last
                meant = did_you_mean(str(key)[:_SHOWN], fields)
                raise wrong(f"unknown key; write {known}{meant and f'. {meant}'}", str(key))
        for key, field in fields.items():
            if field.is_required() and key not in value:
                raise wrong(f"missing; write {field.description}", key)
        return value
