"""How much the speeds of waves in rods may change, so that their travel times have a common measure."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Any

from pydantic import PlainSerializer, PlainValidator

from wavesym.fields.numbers import decimal_text, exact, percentage
from wavesym.fields.table import refusal, show

_NONE = Fraction(0)
_MOST = Fraction(1, 5)  # another soil


def _read(value: object) -> Fraction:
    """A part of a speed: text in percent, or a number."""
    percent = percentage(value)
    number = exact(value) if percent is None else percent
    if not 0 <= number <= _MOST:
        most = percent_text(_MOST)
        raise refusal(f'{show(value)} of a speed is out of range; write "0.5 %", or another up to "{most}"')
    return number


def percent_text(ratio: Fraction) -> str:
    """A ratio in percent."""
    return f"{decimal_text(100 * ratio)} %"


def adjustment_choice(ratio: Fraction) -> dict[str, str]:
    """What was chosen of a system, by its key: nothing where no speed may change."""
    return {"speed_adjustment": percent_text(ratio)} if ratio else {}


def without_adjustment(fields: dict[str, Any]) -> dict[str, Any]:
    """What is said of a system, not that no speed may change: so scenes keep the hash that they have had."""
    return {key: value for key, value in fields.items() if key != "speed_adjustment" or value != percent_text(_NONE)}


SpeedAdjustment = Annotated[Fraction, PlainValidator(_read), PlainSerializer(percent_text)]
