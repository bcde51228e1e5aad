"""What every table of a scene has in common: known keys, and one clear line for each thing that is wrong."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from decimal import Decimal
from fractions import Fraction
from numbers import Number
from typing import Any, ClassVar, NamedTuple, Self

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator
from pydantic.functional_validators import ModelWrapValidatorHandler
from pydantic_core import PydanticCustomError

from wavesym.errors import MOST_FAULTS, SceneError, did_you_mean

# Enough to recognise a value by, short enough for a line.
_SHOWN = 40
_MISSING = "Field required"  # as pydantic says it
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


class Fault(NamedTuple):
    """What is wrong, and the keys and list indices that lead to it."""

    what: str
    keys: tuple[str | int, ...]


class WrittenDecimal(str):
    """A TOML decimal as it is written, so that it never passes through binary floating point."""

    __slots__ = ()


def show(value: object) -> str:
    """A value for a message: on one line, in ASCII, and short, however long the value is."""
    match value:
        case bool():
            return str(value).lower()
        case int() | Fraction() if (bits := max(n.bit_length() for n in value.as_integer_ratio())) > 4 * _SHOWN:
            # not written out: Python refuses to print very long integers
            return f"a number of about {bits * 30103 // 100000} digits"
        case WrittenDecimal() | Number() | Decimal():
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


def without_usual(fields: dict[str, Any], **usual: object) -> dict[str, Any]:
    """Fields of a table without those that are as usual: so scenes keep the hash that they have had."""
    return {key: value for key, value in fields.items() if key not in usual or value != usual[key]}


def refusal(what: str, *keys: str | int) -> PydanticCustomError:
    """The error to raise in a validator; `keys` lead from the field that is validated to what is wrong in it."""
    return _refusal([Fault(what, keys)])


def read_choice(fault: str, *words: str) -> Callable[[object], str]:
    """A validator of one of some words; `fault` is what a message says of anything else."""

    def read(value: object) -> str:
        if isinstance(value, str) and value in words:
            return value
        choice = " or ".join(f'"{word}"' for word in words)
        raise refusal(f"{show(value)} {fault}; write {choice}")

    return read


def _refusal(faults: Sequence[Fault]) -> PydanticCustomError:
    return PydanticCustomError("scene", "{what}", {"what": faults[0].what, "faults": faults})


def faults_of(error: PydanticCustomError | ValidationError, *keys: str | int) -> list[Fault]:
    """All that an error of a validator, or of a validated table, has found; `keys` lead to that table."""
    if isinstance(error, PydanticCustomError):
        return [Fault(what, (*keys, *at)) for what, at in (error.context or {})["faults"]]
    return [
        Fault(what, (*keys, *each["loc"], *at))
        for each in error.errors(include_url=False, include_input=False)
        for what, at in each.get("ctx", {}).get("faults", [(each["msg"], ())])
    ]


class Faults:
    """What is wrong with parts that are read one after another, gathered so that a user reads all of it at once."""

    def __init__(self, found: Sequence[Fault] = ()) -> None:
        self.found = list(found)

    @contextmanager
    def gather(self, *keys: str | int) -> Iterator[None]:
        """Keep what the body finds wrong; `keys` lead to what it reads."""
        try:
            yield
        except (PydanticCustomError, ValidationError) as error:
            self.found += faults_of(error, *keys)

    def refuse(self) -> None:
        """Raise the error of a validator where anything is wrong."""
        if self.found:
            raise _refusal(self.found) from None


@contextmanager
def key_context(*keys: str | int) -> Iterator[None]:
    """Say of what the body finds wrong where in the scene it is: `keys` lead to what it reads."""
    faults = Faults()
    with faults.gather(*keys):
        yield
    faults.refuse()


def key_path(keys: Sequence[str | int]) -> str:
    """`load[0].times[2]` from ("load", 0, "times", 2)."""
    path = ""
    for key in keys:
        if isinstance(key, int):
            path += f"[{key}]"
        else:
            path += f".{key}" if len(key) <= _SHOWN and _BARE_KEY.fullmatch(key) else f".{show(key)}"
    return path.removeprefix(".")


def as_list(value: object) -> tuple[object, ...]:
    """A list, from TOML or from Python."""
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise refusal(f"{show(value)} is not a list; write [ ] around it")
    return tuple(value)


def scene_error(error: PydanticCustomError | ValidationError, file: str = "scene") -> SceneError:
    """All that validation has found, as an error for users."""
    every = dict.fromkeys((what, key_path(keys)) for what, keys in faults_of(error))
    first, *others = (SceneError(what, path, file) for what, path in every)
    return SceneError(first.what, first.path, file, others=tuple(others))


def check_keys(table: Mapping[Any, object], **needed: str) -> None:
    """Refuse a table without one of these keys, of each of which is said what to write, or with another."""
    _key_faults(table, list(needed), needed, {}).refuse()


def _key_faults(
    table: Mapping[Any, object], known: Sequence[str], needed: Mapping[str, str], instead: Mapping[str, str]
) -> Faults:
    others = [str(key) for key in table if key not in known]
    unknown = [
        Fault(f"unknown key; {instead.get(key) or _known_keys(key, known, guess=k < MOST_FAULTS)}", (key,))
        for k, key in enumerate(others)
    ]
    missing = [
        Fault(f"missing; write {what}", (key,))
        for key, what in needed.items()
        if key not in table and not any(f'mean "{key}"?' in said for said, _ in unknown)
    ]
    return Faults([*unknown, *missing])


class SceneTable(BaseModel):
    """A table of a scene: every key is known, none that is needed is missing; a field's description says what it is."""

    # built when it is first used: most scenes have few kinds of tables
    model_config = ConfigDict(extra="forbid", frozen=True, serialize_by_alias=True, defer_build=True)

    instead: ClassVar[Mapping[str, str]] = {}
    """What to write for keys that people look for here."""

    @model_validator(mode="wrap")
    @classmethod
    def _keys(cls, value: object, handler: ModelWrapValidatorHandler[Self]) -> Self:
        if isinstance(value, cls):
            return handler(value)
        if not isinstance(value, Mapping):
            raise refusal(f"{show(value)} is not a table; write its keys and values")
        fields = {field.alias or name: field for name, field in cls.model_fields.items()}
        needed = {key: str(field.description) for key, field in fields.items() if field.is_required()}
        faults = _key_faults(value, list(fields), needed, cls.instead)
        if faults.found:
            with faults.gather():  # also what is wrong with the other keys
                handler({key: each for key, each in value.items() if key in fields})
            faults.found = [fault for fault in faults.found if fault.what != _MISSING]
            faults.refuse()
        return handler(value)


def _known_keys(key: str, known: Sequence[str], *, guess: bool) -> str:
    *others, last = known
    choice = f"{', '.join(others)} or {last}" if others else last
    meant = guess and did_you_mean(key[:_SHOWN], known)
    return f"write {choice}{meant and f'. {meant}'}"
