"""Exact numbers: what a user may write for one, and what it is as a fraction."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from numbers import Integral, Rational
from typing import Annotated

from pydantic import BeforeValidator, FailFast, PlainSerializer, PlainValidator

from wavesym.fields.table import WrittenDecimal, as_list, refusal, show

# Short and of moderate size, so that no scene can make a number that takes long, or that is infinite or 0 as a double.
LONGEST = 100
LARGEST_EXPONENT = 300
_LARGEST = Fraction(10) ** LARGEST_EXPONENT
_SMALLEST = 1 / _LARGEST
_MOST_BITS = 2048  # above what LONGEST and LARGEST_EXPONENT let through
_MODERATE_BITS = 996  # of numerator and denominator: 2^996 is less than 10^LARGEST_EXPONENT

_MOST_DIGITS = 40  # behind the point of a decimal that is written out

_DECIMAL = re.compile(r"([+-]?[0-9]+)(?:\.([0-9]+))?(?:[eE]([+-]?[0-9]+))?")
_RATIO = re.compile(r"([+-]?[0-9]+)/([0-9]+)")


def number_text(value: object) -> str | None:
    """The text of a number that is given as text or as a floating-point number; None of anything else.

    A float stands for the shortest decimal that reads back to it.
    """
    match value:
        case WrittenDecimal():
            return value.replace("_", "")  # TOML has checked where they stand
        case str():
            return value
        case float():
            return float.__repr__(value)  # of a NumPy double too, whose own repr is no number
        case Decimal():
            return str(value)
    return None


def exact(value: object) -> Fraction:
    """A number: an integer, a decimal or a ratio `"p/q"` as TOML, text, or a Python number.

    Raises (as does every validator here) the error of `table.refusal`.
    """
    if type(value) is Fraction and _is_moderate(value):
        return value  # as the many samples of a record are
    text = number_text(value)
    if text is not None:
        number = _parse(text, value)
    elif isinstance(value, Rational) and not isinstance(value, bool):
        number = _fraction(value)
    else:
        raise refusal(f'{show(value)} is not a number; write an integer, a decimal or "p/q"')
    if number and not _is_moderate(number) and not _SMALLEST <= abs(number) <= _LARGEST:
        raise refusal(
            f"{show(value)} is too large or too small; write 0 or a size from 1e-{LARGEST_EXPONENT} to "
            f"1e{LARGEST_EXPONENT}"
        )
    return number


def percentage(value: object) -> Fraction | None:
    """The ratio of text such as "5 %" or "5 percent", 1/20 here; None of anything else. Raises as `exact` does."""
    if not isinstance(value, str) or isinstance(value, WrittenDecimal) or not value.endswith(("%", " percent")):
        return None
    return _parse(value.removesuffix("%").removesuffix("percent").removesuffix(" "), value) / 100


def _is_moderate(number: Fraction) -> bool:
    """Whether a number is 0 or of a size from _SMALLEST to _LARGEST, as its few bits tell at once."""
    return max(number.numerator.bit_length(), number.denominator.bit_length()) <= _MODERATE_BITS


def _fraction(value: Rational) -> Fraction:
    number = Fraction(int(value.numerator), int(value.denominator))  # of NumPy's integers too
    if max(number.numerator.bit_length(), number.denominator.bit_length()) > _MOST_BITS:
        raise refusal(
            f"{show(number)} has too many digits; write at most {_MOST_BITS} bits in numerator and denominator"
        )
    return number


def _parse(text: str, value: object) -> Fraction:
    """The number that `text` writes; `value` is what the message shows where it writes none."""
    if len(text) > LONGEST:  # before anything is done with it
        raise refusal(f"{show(value)} is too long; write a number of at most {LONGEST} characters")
    if ratio := _RATIO.fullmatch(text):
        above, below = int(ratio[1]), int(ratio[2])
        if not below:
            raise refusal(f"{show(value)} divides by 0; write another denominator")
        return Fraction(above, below)
    if decimal := _DECIMAL.fullmatch(text):
        whole, digits, exponent = decimal[1], decimal[2] or "", int(decimal[3] or 0)
        if abs(exponent) > LARGEST_EXPONENT:  # before ten is raised to it
            raise refusal(
                f"{show(value)} is too large or too small; write an exponent from -{LARGEST_EXPONENT} to "
                f"{LARGEST_EXPONENT}"
            )
        shift = exponent - len(digits)
        return Fraction(int(whole + digits) * 10 ** max(shift, 0), 10 ** max(-shift, 0))
    raise refusal(f'{show(value)} is not a number; write an integer, a decimal or "p/q"')


def decimal_text(value: Fraction) -> str:
    """A number as a decimal where it is one, else as a ratio."""
    digits = next((k for k in range(_MOST_DIGITS) if 10**k % value.denominator == 0), 0)
    if value.denominator > 1 and not digits:
        return str(value)
    scaled = str(abs(value.numerator) * 10**digits // value.denominator).zfill(digits + 1)
    sign, cut = "-" if value < 0 else "", len(scaled) - digits
    return f"{sign}{scaled[:cut]}{(digits and '.') or ''}{scaled[cut:]}"


def _positive(value: object) -> Fraction:
    number = exact(value)
    if number <= 0:
        raise refusal(f"{show(value)} is not positive; write a number above 0")
    return number


def _integer(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise refusal(f"{show(value)} is not an integer; write one without point or quotes, such as 2")
    return int(value)


# dumped as text that reads back to the same number
Exact = Annotated[Fraction, PlainValidator(exact), PlainSerializer(str, return_type=str)]
Positive = Annotated[Fraction, PlainValidator(_positive), PlainSerializer(str, return_type=str)]
Integer = Annotated[int, PlainValidator(_integer)]
# The first number that is wrong ends the reading of a list, however long.
Numbers = Annotated[tuple[Exact, ...], FailFast(), BeforeValidator(as_list)]
Positives = Annotated[tuple[Positive, ...], FailFast(), BeforeValidator(as_list)]
