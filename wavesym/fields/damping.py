"""Damping of modes, as a table of a scene has it: a ratio, one for each mode, or that of Rayleigh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Annotated, Any

from pydantic import PlainSerializer, PlainValidator

from wavesym.errors import did_you_mean
from wavesym.fields.numbers import exact
from wavesym.fields.table import shown, wrong
from wavesym.mechanics.damping import Damping
from wavesym.numbers.doubles import fraction, rational

_MOST = 1000
_LARGEST = 10**9  # in whose squares doubles keep their digits
_KEYS = ("modes", "ratio")


def _ratio(value: object, *at: str | int) -> Fraction:
    number = exact(value)
    if number < 0:
        raise wrong(f"{shown(value)} given, a ratio of at least 0 expected", *at)
    if number > _LARGEST:
        raise wrong(f"{shown(value)} given, a ratio of at most {_LARGEST} expected", *at)
    return number


def _damping(value: object) -> Damping | None:
    if value is None or isinstance(value, Damping):
        return value
    if isinstance(value, Mapping):
        return _rayleigh(value)
    if isinstance(value, Sequence) and not isinstance(value, str):
        if not 0 < len(value) <= _MOST:
            raise wrong(f"{len(value)} ratios given, 1 to {_MOST} expected")
        return Damping(tuple(rational(_ratio(each, k)) for k, each in enumerate(value)))
    return Damping((rational(_ratio(value)),))


def _rayleigh(table: Mapping[Any, object]) -> Damping:
    for key in table:
        if key not in _KEYS:
            meant = did_you_mean(str(key)[:40], _KEYS)
            raise wrong(f"unknown key, modes or ratio expected{meant and f'. {meant}'}", str(key))
    for key in _KEYS:
        if key not in table:
            expected = "the numbers of two modes" if key == "modes" else "a ratio"
            raise wrong(f"missing, {expected} expected", key)
    modes = table["modes"]
    if not isinstance(modes, Sequence) or isinstance(modes, str) or len(modes) != 2:
        raise wrong(f"{shown(modes)} given, a list of two modes expected", "modes")
    for k, number in enumerate(modes):
        if isinstance(number, bool) or not isinstance(number, int) or not 1 <= number <= _MOST:
            raise wrong(f"{shown(number)} given, the number of a mode from 1 to {_MOST} expected", "modes", k)
    first, second = sorted(modes)
    if first == second:
        raise wrong(f"{first} given twice, two modes expected", "modes")
    return Damping((rational(_ratio(table["ratio"], "ratio")),), (first, second))


def _written(damping: Damping | None) -> object:
    if damping is None:
        return None
    ratios = [str(fraction(ratio)) for ratio in damping.ratios]
    if damping.modes:
        return {"modes": list(damping.modes), "ratio": ratios[0]}
    return ratios if len(ratios) > 1 else ratios[0]


ModalDamping = Annotated[Damping | None, PlainValidator(_damping), PlainSerializer(_written)]


def without_damping(said: dict[str, Any]) -> dict[str, Any]:
    """What is said of a system, not that its modes are not damped: so scenes keep the hash that they have had."""
    return {key: value for key, value in said.items() if key != "damping" or value is not None}
