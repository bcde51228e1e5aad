"""Formulas as trees: what the reader makes of a printed string, and the string again.

A tree says what stands there, not what it means: an index is an expression, a bar is a bar. Meaning comes from the
`Scope` of an adapter (evaluation.py).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cached_property
from typing import Any


@dataclass(frozen=True)
class Number:
    """A whole number, or a decimal with its digits."""

    digits: str


@dataclass(frozen=True)
class Symbol:
    r"""A letter with its marks: accent ("\bar"), primes, indices below and above."""

    name: str
    accent: str = ""
    primes: int = 0
    subscript: tuple[Tree, ...] = ()
    superscript: tuple[Tree, ...] = ()

    @cached_property
    def letter(self) -> str:
        """The letter with its accent and primes, but without its indices."""
        return self.accent + self.name + "'" * self.primes


@dataclass(frozen=True)
class Blank:
    """A mark that cannot be read: a dot where an index should be, a dash in a table."""

    mark: str


@dataclass(frozen=True)
class Minus:
    """A term that is taken away."""

    term: Tree


@dataclass(frozen=True)
class Addition:
    """Terms one after another."""

    terms: tuple[Tree, ...]


@dataclass(frozen=True)
class Product:
    """Factors side by side."""

    factors: tuple[Tree, ...]


@dataclass(frozen=True)
class Fraction:
    """A fraction; `bar` is False for a slash."""

    numerator: Tree
    denominator: Tree
    bar: bool = True


@dataclass(frozen=True)
class Power:
    """A base with an exponent."""

    base: Tree
    exponent: Tree


@dataclass(frozen=True)
class Group:
    """What stands in brackets: "(", "[" or "{"."""

    bracket: str
    inner: Tree


@dataclass(frozen=True)
class Call:
    """A function with its arguments in brackets."""

    function: Symbol
    arguments: tuple[Tree, ...]


@dataclass(frozen=True)
class Series:
    """A sum with limits, and all that it is taken of."""

    variable: Symbol
    first: Tree
    last: Tree
    body: Tree


@dataclass(frozen=True)
class Derivative:
    """A partial derivative of some order."""

    order: int
    function: Tree
    variable: Symbol


@dataclass(frozen=True)
class AtValue:
    """What a derivative is where a variable has a value."""

    expression: Tree
    condition: Relation


@dataclass(frozen=True)
class Cases:
    """Values, each with the range for which it is said."""

    branches: tuple[tuple[Tree, Tree], ...]


@dataclass(frozen=True)
class Relation:
    r"""Sides with the signs between them: "=", "<", "\leq", ..."""

    sides: tuple[Tree, ...]
    signs: tuple[str, ...]


@dataclass(frozen=True)
class FormulaList:
    """Formulas with commas between them."""

    items: tuple[Tree, ...]


@dataclass(frozen=True)
class Progression:
    """A range: a variable, the values that are shown, and after dots the last one, or none where it does not end."""

    variable: Tree
    first_values: tuple[Tree, ...]
    dots: bool = False
    last: Tree | None = None


@dataclass(frozen=True)
class Interval:
    """Where a variable lies, with the brackets of both ends."""

    variable: Tree
    brackets: tuple[str, str]
    low: Tree
    high: Tree


Tree = (
    Number
    | Symbol
    | Blank
    | Minus
    | Addition
    | Product
    | Fraction
    | Power
    | Group
    | Call
    | Series
    | Derivative
    | AtValue
    | Cases
    | Relation
    | FormulaList
    | Progression
    | Interval
)

_CLOSING = {"(": ")", "[": "]", "{": r"\}", r"\langle": r"\rangle"}


def latex(tree: Tree) -> str:
    """The formula as LaTeX."""
    match tree:
        case Number(digits):
            return digits
        case Blank(mark):
            return mark
        case Symbol():
            return _symbol(tree)
        case Minus(of):
            return f"-{latex(of)}"
        case Addition(terms):
            return "".join(_term(term, place) for place, term in enumerate(terms))
        case Product(factors):
            return _side_by_side([latex(factor) for factor in factors])
        case Fraction(over, under, True):
            return rf"\frac{{{latex(over)}}}{{{latex(under)}}}"
        case Fraction(over, under):
            return f"{latex(over)}/{latex(under)}"
        case Power(base, exponent):
            return f"{latex(base)}^{{{latex(exponent)}}}"
        case Group(bracket, inner):
            return f"{_opening(bracket)}{latex(inner)}{_CLOSING[bracket]}"
        case Call(function, arguments):
            return f"{latex(function)}({', '.join(map(latex, arguments))})"
        case Series(variable, first, last, body):
            return rf"\sum_{{{latex(variable)}={latex(first)}}}^{{{latex(last)}}} {latex(body)}"
        case Derivative(order, of, by):
            power = f"^{order}" if order > 1 else ""
            return rf"\frac{{\partial{power} {latex(of)}}}{{\partial {latex(by)}{power}}}"
        case AtValue(of, where):
            return rf"\left. {latex(of)} \right|_{{{latex(where)}}}"
        case Cases(branches):
            lines = r" \\ ".join(f"{latex(value)} & {latex(where)}" for value, where in branches)
            return rf"\begin{{cases}} {lines} \end{{cases}}"
        case Relation(sides, signs):
            parts = [latex(sides[0])]
            for sign, side in zip(signs, sides[1:], strict=True):
                parts += [sign, latex(side)]
            return " ".join(parts)
        case FormulaList(items):
            return ", ".join(map(latex, items))
        case Progression(variable, shown, dots, last):
            ends = [latex(value) for value in shown] + ([r"\dots"] if dots else []) + ([latex(last)] if last else [])
            return f"{latex(variable)} = {', '.join(ends)}"
        case Interval(variable, (low, high), start, end):
            return rf"{latex(variable)} \in {low} {latex(start)}, {latex(end)} {high}"
    raise TypeError(tree)


def negative(term: Tree) -> Tree:
    """A term with the other sign."""
    return term.term if isinstance(term, Minus) else Minus(term)


def parts_of(tree: Tree) -> tuple[Tree, ...]:
    """A tree and all its parts, those of indices included; they are found once and kept with the tree."""
    if (parts := tree.__dict__.get("_parts")) is None:
        parts = tree.__dict__["_parts"] = (tree, *_inner_parts(getattr(tree, field.name) for field in fields(tree)))
    return parts


def _inner_parts(values: Iterable[Any]) -> Iterator[Tree]:
    for value in values:
        if isinstance(value, tuple):
            yield from _inner_parts(value)
        elif is_dataclass(value):
            yield from parts_of(value)  # type: ignore[arg-type]


def symbols(tree: Tree) -> Iterator[Symbol]:
    """All letters of a tree, those of indices included."""
    return (part for part in parts_of(tree) if isinstance(part, Symbol))


def replace_part(tree: Any, part: Tree, instead: Tree) -> Any:
    """A tree with another part wherever it has one."""
    if tree == part:
        return instead
    if isinstance(tree, tuple):
        return tuple(replace_part(each, part, instead) for each in tree)
    if not is_dataclass(tree) or isinstance(tree, type):
        return tree
    return replace(
        tree, **{field.name: replace_part(getattr(tree, field.name), part, instead) for field in fields(tree)}
    )


def _symbol(symbol: Symbol) -> str:
    text = rf"{symbol.accent}{{{symbol.name}}}" if symbol.accent else symbol.name
    text += "'" * symbol.primes
    if symbol.subscript:
        text += f"_{{{','.join(map(latex, symbol.subscript))}}}"
    if symbol.superscript:
        text += f"^{{{','.join(map(latex, symbol.superscript))}}}"
    return text


def _term(term: Tree, place: int) -> str:
    text = latex(term)
    if place == 0:
        return text
    return f" - {text[1:]}" if isinstance(term, Minus) else f" + {text}"


def _side_by_side(parts: list[str]) -> str:
    """With a space where a command would run into a letter."""
    text = parts[0]
    for part in parts[1:]:
        text += f" {part}" if text[-1].isalnum() and part[0].isalnum() and "\\" in text else part
    return text


def _opening(bracket: str) -> str:
    return r"\{" if bracket == "{" else bracket
