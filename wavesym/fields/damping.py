"""Damping of modes, as a table of a scene has it: a ratio, one for each mode, or that of Rayleigh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Annotated, Any

from pydantic import PlainSerializer, PlainValidator

from wavesym.fields.numbers import decimal_text, exact, percentage
from wavesym.fields.table import check_keys, refusal, show
from wavesym.mechanics.damping import Damping
from wavesym.numbers.doubles import fraction, rational

_MOST = 1000
_LARGEST = 10**9  # in whose squares doubles keep their digits


def damping_ratio(value: object, *at: str | int) -> Fraction:
    """A ratio to critical damping: a number from 0 to 1, or text in percent ("5 %"), which may be above 100 %.

    A number above 1 is a percentage whose sign was forgotten more often than it is a ratio, so it needs the sign.

    Args:
        value: what the user wrote, dimensionless.
        at: keys and indices that lead to it, for the message.

    Returns:
        The ratio, exact.

    Raises:
        PydanticCustomError: that of `table.refusal`, for what is no ratio, negative, or above 1 without a percent sign.
    """
    percent = percentage(value)
    number = exact(value) if percent is None else percent
    if number < 0:
        raise refusal(f"{show(value)} is negative; write a ratio of 0 or more", *at)
    if number > _LARGEST:
        raise refusal(f"{show(value)} is too large a ratio; write {_LARGEST} or less", *at)
    if number > 1 and percent is None:
        written = _percent_text(number / 100), _percent_text(number)
        what = f'{show(value)} is above critical damping; write "{written[0]}" or "{written[1]}", whichever is meant'
        raise refusal(what, *at)
    return number


def _percent_text(ratio: Fraction) -> str:
    return f"{decimal_text(100 * ratio)} %"


def _damping(value: object) -> Damping | None:
    if value is None or isinstance(value, Damping):
        return value
    if isinstance(value, Mapping):
        return _rayleigh(value)
    if isinstance(value, Sequence) and not isinstance(value, str):
        if not 0 < len(value) <= _MOST:
            raise refusal(f"{len(value)} ratios; write 1 to {_MOST} of them")
        return Damping(tuple(rational(damping_ratio(each, k)) for k, each in enumerate(value)))
    return Damping((rational(damping_ratio(value)),))


def _rayleigh(table: Mapping[Any, object]) -> Damping:
    check_keys(table, modes="the numbers of two modes", ratio="a ratio")
    modes = table["modes"]
    if not isinstance(modes, Sequence) or isinstance(modes, str) or len(modes) != 2:
        raise refusal(f"{show(modes)} is not a list of two modes; write [1, 3]", "modes")
    for k, number in enumerate(modes):
        if isinstance(number, bool) or not isinstance(number, int) or not 1 <= number <= _MOST:
            raise refusal(f"{show(number)} is not the number of a mode; write an integer from 1 to {_MOST}", "modes", k)
    first, second = sorted(modes)
    if first == second:
        raise refusal(f"{first} stands twice; write two modes such as [1, 3]", "modes")
    return Damping((rational(damping_ratio(table["ratio"], "ratio")),), (first, second))


def _serialise(damping: Damping | None) -> object:
    if damping is None:
        return None
    ratios = [_written_ratio(fraction(ratio)) for ratio in damping.ratios]
    if damping.modes:
        return {"modes": list(damping.modes), "ratio": ratios[0]}
    return ratios if len(ratios) > 1 else ratios[0]


def _written_ratio(ratio: Fraction) -> str:
    return _percent_text(ratio) if ratio > 1 else str(ratio)


ModalDamping = Annotated[Damping | None, PlainValidator(_damping), PlainSerializer(_serialise)]


def without_damping(fields: dict[str, Any]) -> dict[str, Any]:
    """What is said of a system, not that its modes are not damped: so scenes keep the hash that they have had."""
    return {key: value for key, value in fields.items() if key != "damping" or value is not None}
