"""The one reader of printed formulas: the part of LaTeX that papers use, to trees."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from lark import Lark, Token, Transformer
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


class _Trees(Transformer[Token, Any]):
    """Lark's parse to our trees."""

    def formula(self, items: list[Tree]) -> Tree:
        return items[0] if len(items) == 1 else FormulaList(tuple(items))

    def progression(self, items: list[Any]) -> Tree:
        variable, shown, dots, last = items
        return Progression(variable, shown, dots is not None, last)

    def first_value(self, items: list[Tree]) -> tuple[Tree, ...]:
        return tuple(items)

    def next_value(self, items: list[Any]) -> tuple[Tree, ...]:
        return (*items[0], items[1])

    def comparison(self, items: list[Any]) -> Tree:
        kept = [item for item in items if item is not None]
        return Relation(tuple(kept[::2]), tuple(map(str, kept[1::2])))

    def interval(self, items: list[Any]) -> Tree:
        variable, _, opening, low, high, closing = items
        return Interval(variable, (opening, closing), low, high)

    def opening(self, items: list[Token]) -> str:
        return str(items[0])

    closing = opening

    def related_sides(self, items: list[Any]) -> Tree:
        return Relation(tuple(items[::2]), tuple(items[1::2]))

    def equal(self, items: list[Any]) -> str:
        return "="

    def otherwise(self, items: list[Token]) -> str:
        return str(items[0])

    def signed_terms(self, items: list[Any]) -> Tree:
        terms: list[Tree] = []
        negative = False
        for item in items:
            if item is None:
                continue
            if isinstance(item, Token):
                negative = item == "-"
            else:
                terms.append(Minus(item) if negative else item)
                negative = False
        return terms[0] if len(terms) == 1 else Addition(tuple(terms))

    def term(self, items: list[Tree]) -> Tree:
        factors: list[Tree] = []
        for item in items:
            before = factors[-1] if factors else None
            if isinstance(before, Symbol) and _applies(before) and isinstance(item, (_Arguments, Group)):
                if isinstance(item, Group) and item.bracket != "(":
                    factors.append(item)
                else:
                    factors[-1] = Call(before, item.items if isinstance(item, _Arguments) else (item.inner,))
            elif isinstance(item, _Arguments):
                raise ValueError("brackets with commas after what is no function")
            else:
                factors.append(item)
        return factors[0] if len(factors) == 1 else Product(tuple(factors))

    def slash(self, items: list[Tree]) -> Tree:
        return Fraction(items[0], items[1], bar=False)

    def number(self, items: list[Token]) -> Tree:
        return Number(str(items[0]))

    def blank(self, items: list[Token]) -> Tree:
        return Blank(str(items[0]))

    def round(self, items: list[Any]) -> Any:
        *inner, power = items
        if len(inner) > 1:
            return _Arguments(inner)
        return _power(Group("(", inner[0]), power)

    def square(self, items: list[Any]) -> Tree:
        return _power(Group("[", items[0]), items[1])

    def curly(self, items: list[Any]) -> Tree:
        return _power(Group("{", items[1]), items[3])

    def fraction(self, items: list[Any]) -> Tree:
        return Fraction(items[1], items[2])

    def derivative(self, items: list[Any]) -> Tree:
        _, _, power, of, _, by = items
        order = 1 if power is None else _order(power)
        if isinstance(by, Power):
            lower, by = _order(by.exponent), by.base
        else:
            lower = 1
        if lower != order or not isinstance(by, Symbol):
            raise ValueError("orders of a derivative differ")
        return Derivative(order, of, by)

    def at_value(self, items: list[Any]) -> Tree:
        _, of, _, where = items
        if not isinstance(where, Relation):
            raise ValueError("a derivative is taken where a variable has a value")
        return AtValue(of, where)

    def cases(self, items: list[Any]) -> Tree:
        return Cases(tuple(item for item in items if isinstance(item, tuple)))

    def branch(self, items: list[Tree]) -> tuple[Tree, Tree]:
        return items[0], items[1]

    def series(self, items: list[Any]) -> Tree:
        _, variable, first, last, body = items
        (upper,) = last
        return Series(variable, first, upper, body)

    def sum_body(self, items: list[Tree]) -> Tree:
        return items[0]

    def power(self, items: list[Any]) -> Tree:
        ((exponent,),) = items
        return exponent  # type: ignore[no-any-return]

    def symbol(self, items: list[Any]) -> Tree:
        (accent, name), early, scripts = items
        below, above, late = scripts or (None, None, None)
        primes = len(early or "") + len(late or "")
        symbol = Symbol(name, accent, primes, below or ())
        if above is None:
            return symbol
        if name in _INDEXED_ABOVE:
            return Symbol(name, accent, primes, below or (), above)
        (exponent,) = above
        return Power(symbol, exponent)

    def scripts(self, items: list[Any]) -> list[Any]:
        return items

    def above_alone(self, items: list[Any]) -> list[Any]:
        return [None, items[0], None]

    def letter(self, items: list[Any]) -> tuple[str, str]:
        if len(items) == 1:
            return "", str(items[0])
        accent, (inner, name) = items
        return f"{accent}{inner}", name

    def below(self, items: list[Any]) -> tuple[Tree, ...]:
        return tuple(part for entry in items[0] for part in _indices(entry))

    def above(self, items: list[Any]) -> tuple[Tree, ...]:
        return tuple(items[0])

    def number_index(self, items: list[Token]) -> tuple[Tree, ...]:
        return (Number(str(items[0])),)

    def name_index(self, items: list[Token]) -> tuple[Tree, ...]:
        return (Symbol(str(items[0])),)

    def index(self, items: list[Tree]) -> tuple[Tree, ...]:
        return tuple(items)


class _Arguments:
    """What stands between brackets with commas."""

    def __init__(self, items: list[Tree]) -> None:
        self.items = tuple(items)


def _applies(symbol: Symbol) -> bool:
    return symbol.name in _FUNCTIONS and not symbol.above


def _power(group: Tree, power: Tree | None) -> Tree:
    return group if power is None else Power(group, power)


def _order(exponent: Tree) -> int:
    if not isinstance(exponent, Number):
        raise ValueError("the order of a derivative is no number")
    return int(exponent.digits)


def _indices(entry: Tree) -> tuple[Tree, ...]:
    """An index; "0i" is two of them."""
    match entry:
        case Product((Number("0"), *rest)):
            return (Number("0"), *rest)
    return (entry,)
