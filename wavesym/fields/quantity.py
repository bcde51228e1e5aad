"""Quantities: what a user may write for a number with a unit, and what it is as a fraction, in SI base units.

The grammar is our own, so that no text can make it slow: a number, then names with small powers, multiplied or
divided. pint knows what the names mean, one by one; it is imported when the first one that is not usual is asked for.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic_core import PydanticCustomError

from wavesym.errors import did_you_mean
from wavesym.fields.dimensions import DIMENSIONS, dimension_name, fits, with_article
from wavesym.fields.numbers import LARGEST_EXPONENT, LONGEST, exact
from wavesym.fields.table import WrittenDecimal, refusal, show

if TYPE_CHECKING:
    from pint import UnitRegistry

_QUANTITY = re.compile(r"([+-]?[0-9]+(?:/[0-9]+|(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)) ?(?![eE][+-]?[0-9])([^\s0-9.+-].*)")
_COMMA = re.compile(r"[+-]?[0-9]+,[0-9]")
_NAME = r"[A-Za-z\u00b5\u03bc%][A-Za-z_0-9]*"  # with either mu, for micro
_UNIT = re.compile(rf"{_NAME}(?:\^-?[1-9])?(?:[*/]{_NAME}(?:\^-?[1-9])?)*")
_RAISED = re.compile(r"([A-Za-z]+)([2-9])")  # a power as drawings have it
_FACTOR = re.compile(rf"([*/]?)({_NAME})(?:\^(-?[1-9]))?")
_SLIPS = (
    (re.compile(r"N([ms])(?![A-Za-z_0-9])"), r"N*\1"),  # Nm is a unit of its own, of yarn
    (re.compile(r"(?<![A-Za-z_0-9])([mk]?)gals?(?![A-Za-z_0-9])"), r"\1Gal"),  # a gallon
    (re.compile(r"\AG\Z"), "g"),  # gauss, or nothing
)
_AMBIGUOUS = {
    **dict.fromkeys(("ton", "tons", "kton", "Mton"), "t (1000 kg) or short_ton (2000 lb)"),
    **dict.fromkeys(("ton_force", "force_ton"), "tf (1000 kgf) or kip (1000 lbf)"),
}
_MOST_FACTORS = 12
_LARGEST = Fraction(10) ** LARGEST_EXPONENT


class _Meaning(NamedTuple):
    """How much of the SI base units a unit is, and the power of each of them."""

    factor: Fraction
    powers: Mapping[str, int]


def si_value(value: object, dimension: str) -> Fraction:
    """A number with a unit, such as "3.5 m" or "0.3 g", as so many SI base units; exact but for units with pi in them.
    0 is one in every unit, and needs none.

    `dimension` is a name in `DIMENSIONS`. "g" is the acceleration of gravity where an acceleration (or its rate) is
    expected, else the gram. Raises (as does every validator here) the error of `table.refusal`.
    """
    what = f"{show(value)} is not {_example(dimension)}"
    if _is_zero(value):
        return Fraction(0)
    if not isinstance(value, str) or isinstance(value, WrittenDecimal):
        raise refusal(what)
    if len(value) > LONGEST:  # before anything is done with it
        raise refusal(f"{show(value)} is too long; write at most {LONGEST} characters")
    if _COMMA.match(value):
        pointed = value.replace(",", ".")
        like = pointed if value.count(",") == 1 and _QUANTITY.fullmatch(pointed) else DIMENSIONS[dimension].example
        raise refusal(f"{show(value)} has a comma; write a decimal point, as in {show(like)}")
    if not (found := _QUANTITY.fullmatch(value)):
        raise refusal(what)
    meaning = _fitting(found[2], dimension, value)
    number = exact(found[1]) * meaning.factor
    if number and not 1 / _LARGEST <= abs(number) <= _LARGEST:
        size = f"0 or a size from 1e-{LARGEST_EXPONENT} to 1e{LARGEST_EXPONENT} in SI base units"
        raise refusal(f"{show(value)} is too large or too small; write {size}")
    return number


def _is_zero(value: object) -> bool:
    """Whether a value is the number 0, in whatever form."""
    try:
        return exact(value) == 0
    except PydanticCustomError:
        return False


@cache
def _usual(dimension: str) -> str:
    """The usual units of a dimension, as a sentence has them: "m, mm, cm or km"."""
    names = [name for name, one in _USUAL.items() if name.isalpha() and fits(one.powers, DIMENSIONS[dimension])]
    *others, last = names or [DIMENSIONS[dimension].example.partition(" ")[2]]
    return f"{', '.join(others)} or {last}" if others else last


def _example(dimension: str) -> str:
    """A dimension, and how one writes it: `a length; write one such as "3.5 m"`."""
    return f'{with_article(dimension)}; write one such as "{DIMENSIONS[dimension].example}"'


def split_quantity(value: object) -> tuple[Fraction, str] | None:
    """The number and the unit of a quantity, whatever the unit means; None of what is no quantity."""
    if not isinstance(value, str) or isinstance(value, WrittenDecimal) or len(value) > LONGEST:
        return None
    found = _QUANTITY.fullmatch(value)
    return (exact(found[1]), found[2]) if found else None


def unit(value: object, dimension: str) -> Fraction:
    """A unit without a number, such as "mm" or "kN*m": how many SI base units it is. Raises that of `table.refusal`."""
    example = DIMENSIONS[dimension].example.partition(" ")[2]
    if not isinstance(value, str) or isinstance(value, WrittenDecimal):
        raise refusal(f'{show(value)} is not a unit; write one such as "{example}"')
    if len(value) > LONGEST:
        raise refusal(f"{show(value)} is too long; write at most {LONGEST} characters")
    return _fitting(value, dimension, value).factor


def base_units(unit: str) -> tuple[Fraction, Mapping[str, int]]:
    """How many SI base units a unit of results is, and its powers of m, kg, s and rad; "g" is that of gravity."""
    return _meaning(unit, unit, gravity=True)


def likely_unit(text: str) -> str:
    """What is meant by a unit that is often written for another, such as Gal by gal, a gallon; else the unit."""
    for slip, right in _SLIPS:
        text = slip.sub(right, text)
    return text


def is_unit(text: str) -> bool:
    """Whether a scene takes it as a unit of something."""
    try:
        return bool(_meaning(text, text, gravity=True))
    except PydanticCustomError:
        return False


def _fitting(text: str, dimension: str, value: str) -> _Meaning:
    """What a unit means, which is one of a dimension; `value` is what the message shows where it is none."""
    gravity = dimension in ("acceleration", "jerk")
    meaning = _meaning(text, value, gravity=gravity, usual=f"{with_article(dimension)} in {_usual(dimension)}")
    if not fits(meaning.powers, DIMENSIONS[dimension]):
        meant = likely_unit(text)
        hint = (
            f'. Did you mean "{meant}"?'
            if fits(_meaning(meant, value, gravity=gravity).powers, DIMENSIONS[dimension])
            else ""
        )
        raise refusal(f"{show(value)} is {dimension_name(meaning.powers)}, not {_example(dimension)}{hint}")
    return meaning


def _meaning(
    text: str, value: str, *, gravity: bool, usual: str = "one of length, mass, time or angle, or made of these"
) -> _Meaning:
    if not _UNIT.fullmatch(text):
        grammar = 'a number and units joined by * and /, with powers up to ^9, such as "3 kN*s/m^2"'
        raise refusal(f"{show(value)} is not a quantity; write {grammar}")
    factors = _FACTOR.findall(text)
    if len(factors) > _MOST_FACTORS:
        raise refusal(f"{show(value)} has too many units; write at most {_MOST_FACTORS}")
    factor, powers = Fraction(1), dict[str, int]()
    for sign, name, written in factors:
        power = int(written or 1) * (-1 if sign == "/" else 1)
        if name in _AMBIGUOUS:
            raise refusal(f"{show(value)}: {show(name)} is two units; write {_AMBIGUOUS[name]}")
        one = _unit_meaning("standard_gravity" if gravity and name == "g" else name)
        if one is None:
            raised = _RAISED.fullmatch(name)
            drawn = f'Did you mean "{raised[1]}^{raised[2]}"?' if raised and _unit_meaning(raised[1]) else ""
            alike = next((f'Did you mean "{each}"?' for each in _names() if each.casefold() == name.casefold()), "")
            meant = drawn or alike or did_you_mean(name, _names())
            where = "" if value == name else f"{show(value)}: "
            raise refusal(f"{where}{show(name)} is not a known unit; write {usual}{meant and f'. {meant}'}")
        factor *= one.factor**power
        for base, exponent in one.powers.items():
            powers[base] = powers.get(base, 0) + exponent * power
    return _Meaning(factor, powers)


@cache
def _registry() -> UnitRegistry[Any]:
    from pint import UnitRegistry  # half a second, for those who have units

    return UnitRegistry(non_int_type=Fraction)


_BASES = {"meter": "m", "gram": "kg", "second": "s", "radian": "rad"}


def _usual_units() -> dict[str, _Meaning]:
    """Those of most scenes, which need not wait for pint; a test holds them to it."""
    newton, pascal = {"kg": 1, "m": 1, "s": -2}, {"kg": 1, "m": -1, "s": -2}
    sizes = {"m": -3, "c": -2, "": 0, "k": 3, "M": 6, "G": 9}
    units = [
        *((f"{prefix}m", sizes[prefix], {"m": 1}) for prefix in ("", "m", "c", "k")),
        *((f"{prefix}g", sizes[prefix] - 3, {"kg": 1}) for prefix in ("", "k", "M")),
        *((f"{prefix}N", sizes[prefix], newton) for prefix in ("", "k", "M", "G")),
        *((f"{prefix}Pa", sizes[prefix], pascal) for prefix in ("", "k", "M", "G")),
        ("t", 3, {"kg": 1}),
        ("s", 0, {"s": 1}),
        ("ms", -3, {"s": 1}),
        ("rad", 0, {"rad": 1}),
    ]
    usual = {name: _Meaning(Fraction(10) ** power, powers) for name, power, powers in units}
    return usual | {"standard_gravity": _Meaning(Fraction("9.80665"), {"m": 1, "s": -2})}


_USUAL = _usual_units()


def _unit_meaning(name: str) -> _Meaning | None:
    """What a name means; None of what is no unit of length, mass, time or angle, or made of these."""
    return _USUAL.get(name) or _unit_of_pint(name)


@cache
def _unit_of_pint(name: str) -> _Meaning | None:
    from pint.errors import PintError

    registry = _registry()
    try:
        one = registry.Quantity(Fraction(1), registry.UnitsContainer({name: 1})).to_root_units()
    except (PintError, TypeError, KeyError, AssertionError):  # also of logarithmic units, and of names read in two ways
        return None
    powers = {base: Fraction(str(power)) for base, power in one.unit_items()}
    factor = one.magnitude
    if not powers or not powers.keys() <= _BASES.keys() or not isinstance(factor, int | Fraction):
        return None
    if any(power.denominator != 1 for power in powers.values()):
        return None
    grams = powers.get("gram", Fraction(0)).numerator
    return _Meaning(factor / Fraction(1000) ** grams, {_BASES[base]: power.numerator for base, power in powers.items()})


def _names() -> list[str]:
    """The units that are usual enough to be meant."""
    prefixes = ("", "k", "M", "G", "m", "c")
    return [*(p + u for p in prefixes for u in ("m", "N", "Pa", "g", "s")), "kip", "ft", "lbf", "psi", "ksi", "rad"]
