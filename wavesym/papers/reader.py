"""The one reader of printed formulas: the part of LaTeX that papers use, to trees."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from lark import Lark, Token, Transformer, v_args
from lark.exceptions import UnexpectedInput, VisitError

from wavesym.papers.tree import (
    Addition,
    AtValue,
    Blank,
    Call,
    Cases,
    Derivative,
    FormulaList,
    Fraction,
    Group,
    Interval,
    Minus,
    Number,
    Power,
    Product,
    Progression,
    Relation,
    Series,
    Symbol,
    Tree,
)

_INDEXED_ABOVE = frozenset("fgF")
"""Letters whose upper indices are indices; those of all others are exponents."""
_FUNCTIONS = frozenset({*"fgFGHEUuySsM", r"\theta"})
"""Letters that are functions where a bracket follows; with an upper index they are coefficients."""


class UnreadableError(Exception):
    """A string has no meaning as a formula: the reason, in a few words."""


def read_formula(text: str) -> Tree:
    """The tree of a formula; UnreadableError."""
    return _read("formula", text)


def read_range(text: str) -> Tree:
    """The tree of a range of variables, such as "i = 2, 3, \\dots, m"; UnreadableError."""
    return _read("range", text)


@cache
def _read(start: str, text: str) -> Tree:
    try:
        tree: Tree = _Trees().transform(_parser().parse(text, start=start))
    except VisitError as error:
        raise UnreadableError(f"{text} cannot be read: {error.orig_exc}") from None
    except UnexpectedInput as error:
        place = error.pos_in_stream
        what = f"from {text[place:]} on" if place is not None and text[max(place, 0) :].strip() else "to its end"
        raise UnreadableError(f"{text} cannot be read {what}") from None
    return tree


@cache
def _parser() -> Lark:
    grammar = Path(__file__).with_name("latex.lark").read_text(encoding="utf-8")
    return Lark(grammar, parser="lalr", start=["formula", "range"], maybe_placeholders=True)


@v_args(inline=True)
class _Trees(Transformer[Token, Any]):
    """Lark's parse to our trees: what each rule of latex.lark makes of its parts."""

    def formula(self, *items: Tree) -> Tree:
        return items[0] if len(items) == 1 else FormulaList(items)

    def progression(self, variable: Tree, shown: tuple[Tree, ...], dots: Token | None, last: Tree | None) -> Tree:
        return Progression(variable, shown, dots is not None, last)

    def first_value(self, value: Tree) -> tuple[Tree, ...]:
        return (value,)

    def next_value(self, values: tuple[Tree, ...], value: Tree) -> tuple[Tree, ...]:
        return (*values, value)

    def relation(self, *items: Any) -> Tree:
        stated = [item for item in items if item is not None]
        return Relation(tuple(stated[::2]), tuple(map(str, stated[1::2])))

    def interval(self, variable: Tree, opening: Token, low: Tree, high: Tree, closing: Token) -> Tree:
        return Interval(variable, (str(opening), str(closing)), low, high)

    def signed_terms(self, *items: Any) -> Tree:
        signs, terms = items[::2], items[1::2]
        signed = [Minus(term) if sign == "-" else term for sign, term in zip(signs, terms, strict=True)]
        return signed[0] if len(signed) == 1 else Addition(tuple(signed))

    def term(self, *items: Any) -> Tree:
        factors: list[Tree] = []
        for item in items:
            before = factors[-1] if factors else None
            is_applied = isinstance(before, Symbol) and before.name in _FUNCTIONS and not before.superscript
            match before, item:
                case Symbol() as function, _Arguments(arguments) if is_applied:
                    factors[-1] = Call(function, arguments)
                case Symbol() as function, Group("(", argument) if is_applied:
                    factors[-1] = Call(function, (argument,))
                case _, _Arguments():
                    raise ValueError("brackets with commas after what is no function")
                case _:
                    factors.append(item)
        return factors[0] if len(factors) == 1 else Product(tuple(factors))

    def slash(self, numerator: Tree, denominator: Tree) -> Tree:
        return Fraction(numerator, denominator, bar=False)

    def fraction(self, numerator: Tree, denominator: Tree) -> Tree:
        return Fraction(numerator, denominator)

    def number(self, digits: Token) -> Tree:
        return Number(str(digits))

    def name(self, name: Token) -> Tree:
        return Symbol(str(name))

    def blank(self, mark: Token) -> Tree:
        return Blank(str(mark))

    def round(self, *items: Any) -> Any:
        *inner, power = items
        return _Arguments(tuple(inner)) if len(inner) > 1 else _power("(", inner[0], power)

    def square(self, inner: Tree, power: Tree | None) -> Tree:
        return _power("[", inner, power)

    def curly(self, inner: Tree, power: Tree | None) -> Tree:
        return _power("{", inner, power)

    def derivative(self, power: Tree | None, function: Tree, variable: Tree) -> Tree:
        lower = None
        if isinstance(variable, Power):
            lower, variable = variable.exponent, variable.base
        if _order(lower) != _order(power) or not isinstance(variable, Symbol):
            raise ValueError("orders of a derivative differ")
        return Derivative(_order(power), function, variable)

    def at_value(self, expression: Tree, condition: Tree) -> Tree:
        if not isinstance(condition, Relation):
            raise ValueError("a derivative is taken where a variable has a value")
        return AtValue(expression, condition)

    def cases(self, *branches: tuple[Tree, Tree]) -> Tree:
        return Cases(branches)

    def branch(self, value: Tree, where: Tree) -> tuple[Tree, Tree]:
        return value, where

    def series(self, variable: Symbol, first: Tree, last: tuple[Tree], body: Tree) -> Tree:
        return Series(variable, first, *last, body)

    def power(self, index: tuple[Tree]) -> Tree:
        (exponent,) = index
        return exponent

    def symbol(self, letter: tuple[str, str], early: Token | None, scripts: tuple[Any, Any, Any] | None) -> Tree:
        (accent, name), (below, above, late) = letter, scripts or (None, None, None)
        symbol = Symbol(name, accent, len(early or "") + len(late or ""), below or ())
        if above is not None and name in _INDEXED_ABOVE:
            return replace(symbol, superscript=above)
        return symbol if above is None else Power(symbol, self.power(above))

    def scripts(self, below: Any, above: Any, primes: Token | None) -> tuple[Any, Any, Any]:
        return below, above, primes

    def above_alone(self, above: Any) -> tuple[Any, Any, Any]:
        return None, above, None

    def letter(self, *items: Any) -> tuple[str, str]:
        if len(items) == 1:
            return "", str(items[0])
        accent, (inner, name) = items
        return f"{accent}{inner}", name

    def below(self, index: tuple[Tree, ...]) -> tuple[Tree, ...]:
        return tuple(part for entry in index for part in _indices(entry))

    def index(self, *items: Tree) -> tuple[Tree, ...]:
        return items


class _Arguments(NamedTuple):
    """What stands between brackets with commas."""

    items: tuple[Tree, ...]


def _power(bracket: str, inner: Tree, power: Tree | None) -> Tree:
    return Group(bracket, inner) if power is None else Power(Group(bracket, inner), power)


def _order(exponent: Tree | None) -> int:
    """The order of a derivative; where none is printed it is the first."""
    if exponent is None:
        return 1
    if not isinstance(exponent, Number):
        raise ValueError("the order of a derivative is no number")
    return int(exponent.digits)


def _indices(entry: Tree) -> tuple[Tree, ...]:
    """An index; "0i" is two of them."""
    match entry:
        case Product((Number("0"), *rest)):
            return (Number("0"), *rest)
    return (entry,)
