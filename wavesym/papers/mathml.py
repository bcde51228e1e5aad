"""Trees as MathML, in the part of it that browsers know (MathML Core)."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Sequence
from itertools import chain
from xml.etree.ElementTree import Element, tostring

from wavesym.papers.tree import (
    Addition,
    AtValue,
    Blank,
    Call,
    Cases,
    Derivative,
    Fraction,
    Group,
    Interval,
    Listed,
    Marked,
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

LONGEST = 26
"""Elements of a formula that is not broken: about what a line of a phone holds."""
_MINUS, _PLUS, _PRIME, _APPLIED, _TIMES = "\N{MINUS SIGN}", "+", "\N{PRIME}", "\u2061", "\u2062"
_DOTS = "…"
_TALL = frozenset({"mfrac", "munderover", "mtable"})
_SIGNS = {r"\leq": "≤", r"\le": "≤", r"\geq": "≥", r"\ge": "≥", r"\approx": "≈", r"\neq": "≠"}
_ACCENTS = {r"\bar": "¯", r"\dot": "˙", r"\ddot": "¨"}
_BRACKETS = {"(": ("(", ")"), "[": ("[", "]"), "{": ("{", "}")}
_ANGLES = {r"\langle": "⟨", r"\rangle": "⟩"}
_BLANKS = {r"\cdot": "·"}


def mathml(tree: Tree) -> str:
    """The formula as <math> elements: one, or, where it is long, pieces of it between which a line may be broken."""
    return " ".join(_math(piece) for piece in _pieces(tree))


def _math(parts: Sequence[Element]) -> str:
    top = Element("math", displaystyle="true")
    top.extend(parts)
    return tostring(top, encoding="unicode")


def _pieces(tree: Tree) -> list[list[Element]]:
    """A formula cut before its signs, where it is long; within brackets too."""
    if _length(tree) <= LONGEST:
        return [[_element(tree)]]
    match tree:
        case Relation(sides, signs):
            return _cut(sides, [_operator(_sign(sign)) for sign in signs])
        case Listed(items):
            pieces = [_pieces(item) for item in items]
            for piece in pieces[:-1]:
                piece[-1].append(_operator(","))
            return list(chain.from_iterable(pieces))
        case Addition(terms):
            pieces = [_pieces(terms[0])]
            for term in terms[1:]:
                sign, body = _signed(term)
                whole = isinstance(term, Marked) and not term.sign_only
                pieces.append([_later_term(term)] if whole else _after(sign, _pieces(body)))
            return list(chain.from_iterable(pieces))
        case Product((*before, last)):
            return _after(_element(Product(tuple(before))), _pieces(last))
        case Minus(of):
            return _after(_operator(_MINUS, form="prefix"), _pieces(of))
        case Series(body=body):
            return _after(_sum(tree), _pieces(body))
        case Group(bracket, inner):
            opening, closing = _BRACKETS[bracket]
            within = _after(_operator(opening, stretchy="false"), _pieces(inner))
            within[-1].append(_operator(closing, stretchy="false"))
            return within
    return [[_element(tree)]]


def _cut(sides: Sequence[Tree], signs: Sequence[Element]) -> list[list[Element]]:
    pieces = _pieces(sides[0])
    for sign, side in zip(signs, sides[1:], strict=True):
        pieces += _after(sign, _pieces(side))
    return pieces


def _after(first: Element, pieces: list[list[Element]]) -> list[list[Element]]:
    return [[first, *pieces[0]], *pieces[1:]]


def _length(tree: Tree) -> int:
    return sum(1 for part in _element(tree).iter() if part.text)


def _element(tree: Tree) -> Element:
    match tree:
        case Number(digits):
            return _leaf("mn", digits)
        case Blank(mark):
            return _leaf("mtext", _BLANKS.get(mark, mark))
        case Symbol():
            return _symbol(tree)
        case Minus(of):
            return _row(_operator(_MINUS, form="prefix"), _element(of))
        case Addition(terms):
            return _row(_element(terms[0]), *chain.from_iterable(map(_later_term, terms[1:])))
        case Product(factors):
            return _row(*_between(_operator(_TIMES), map(_element, factors)))
        case Fraction(over, under, True):
            return _made("mfrac", _element(over), _element(under))
        case Fraction(over, under):
            return _row(_element(over), _operator("/"), _element(under))
        case Power(Symbol(above=()) as base, exponent) if base.below and not base.primes:
            return _made("msubsup", _letter(base), _indices(base.below), _element(exponent))
        case Power(base, exponent):
            return _made("msup", _element(base), _element(exponent))
        case Group(bracket, inner):
            return _within(*_BRACKETS[bracket], _element(inner))
        case Call(function, arguments):
            given = _between(_operator(","), map(_element, arguments))
            return _row(
                _element(function), _operator(_APPLIED), _operator("(", stretchy="false"), *given,
                _operator(")", stretchy="false"),
            )  # fmt: skip
        case Series(body=body):
            return _row(_sum(tree), _element(body))
        case Derivative(order, of, by):
            return _made("mfrac", _row(_partial(order), _element(of)), _row(_partial(1), _raised(_element(by), order)))
        case AtValue(of, where):
            bar = _operator("|", stretchy="true", form="postfix")
            return _made("msub", _made("mrow", _element(of), bar), _element(where))
        case Cases(branches):
            rows = [_made("mtr", _cell(_element(value)), _cell(_element(where))) for value, where in branches]
            return _row(_operator("{", stretchy="true", form="prefix"), _made("mtable", *rows))
        case Relation(sides, signs):
            pairs = ((_operator(_sign(sign)), _element(side)) for sign, side in zip(signs, sides[1:], strict=True))
            return _row(_element(sides[0]), *chain.from_iterable(pairs))
        case Listed(items):
            return _row(*_between(_operator(",", rspace="1em"), map(_element, items)))
        case Progression(variable, shown, dots, last):
            values = [
                *map(_element, shown),
                *([_leaf("mo", _DOTS)] if dots else []),
                *([_element(last)] if last else []),
            ]
            return _row(_element(variable), _operator("="), *_between(_operator(","), values))
        case Interval(variable, (opening, closing), low, high):
            return _row(
                _element(variable), _operator("∈"), _operator(_ANGLES.get(opening, opening), form="prefix"),
                _element(low), _operator(","), _element(high),
                _operator(_ANGLES.get(closing, closing), form="postfix"),
            )  # fmt: skip
        case Marked(Minus(of), True):
            return _row(_mark(_operator(_MINUS, form="prefix")), _element(of))
        case Marked(of, True):
            return _element(of)
        case Marked(of):
            return _mark(_element(of))
    raise TypeError(tree)


def _within(opening: str, closing: str, inner: Element) -> Element:
    """In brackets, which are as tall as need be."""
    stretchy = "true" if any(part.tag in _TALL for part in inner.iter()) else "false"
    return _row(_operator(opening, stretchy=stretchy), inner, _operator(closing, stretchy=stretchy))


def _later_term(term: Tree) -> list[Element]:
    """A term that is not the first, with its sign."""
    sign, body = _signed(term)
    parts = [sign, _element(body)]
    return [_mark(_row(*parts))] if isinstance(term, Marked) and not term.sign_only else parts


def _symbol(symbol: Symbol) -> Element:
    """A letter with primes and indices; what is above it stands behind the primes."""
    base = _letter(symbol)
    above = [_operator(_PRIME * symbol.primes, lspace="0", rspace="0")] if symbol.primes else []
    if symbol.above:
        above.append(_indices(symbol.above))
    if symbol.below and above:
        return _made("msubsup", base, _indices(symbol.below), _row(*above))
    if symbol.below:
        return _made("msub", base, _indices(symbol.below))
    return _made("msup", base, _row(*above)) if above else base


def _letter(symbol: Symbol) -> Element:
    """The letter alone, with its accent."""
    accents = symbol.accent.replace("\\", " \\").split()
    base = _leaf("mi", _script(symbol.name) if r"\mathcal" in accents else _named(symbol.name))
    for accent in reversed(accents):
        if accent in _ACCENTS:
            # not as an accent: browsers put those onto the tops of capitals
            base = _made("mover", base, _operator(_ACCENTS[accent], stretchy="false"))
    return base


def _named(name: str) -> str:
    return unicodedata.lookup(f"GREEK SMALL LETTER {name[1:].upper()}") if name.startswith("\\") else name


def _script(letter: str) -> str:
    """A calligraphic capital; some of them are older than the rest of their alphabet."""
    try:
        return unicodedata.lookup(f"MATHEMATICAL SCRIPT CAPITAL {letter}")
    except KeyError:
        return unicodedata.lookup(f"SCRIPT CAPITAL {letter}")


def _indices(indices: Sequence[Tree]) -> Element:
    return _row(*_between(_operator(",", lspace="0", rspace="0"), map(_element, indices)))


def _sum(series: Series) -> Element:
    first = _row(_element(series.variable), _operator("="), _element(series.first))
    return _made("munderover", _operator("∑"), first, _element(series.last))


def _partial(order: int) -> Element:
    return _raised(_leaf("mo", "∂"), order)


def _raised(element: Element, order: int) -> Element:
    return element if order == 1 else _made("msup", element, _leaf("mn", str(order)))


def _signed(term: Tree) -> tuple[Element, Tree]:
    """The sign before a term that is not the first, and the term without it."""
    match term:
        case Minus(of):
            return _operator(_MINUS, form="infix"), of
        case Marked(Minus(of), True):
            return _mark(_operator(_MINUS, form="infix")), of
        case Marked(of, True):
            return _mark(_operator(_PLUS, form="infix")), of
        case Marked(Minus(of)):
            return _operator(_MINUS, form="infix"), of
        case Marked(of):
            return _operator(_PLUS, form="infix"), of
    return _operator(_PLUS, form="infix"), term


def _sign(sign: str) -> str:
    return _SIGNS.get(sign, sign)


def _mark(element: Element) -> Element:
    row = _made("mrow", element)
    row.set("class", "marked")
    return row


def _cell(element: Element) -> Element:
    return _made("mtd", element)


def _between(separator: Element, elements: Iterable[Element]) -> list[Element]:
    parts: list[Element] = []
    for element in elements:
        parts += [separator, element] if parts else [element]
    return parts


def _row(*parts: Element) -> Element:
    return parts[0] if len(parts) == 1 else _made("mrow", *parts)


def _made(tag: str, *parts: Element) -> Element:
    element = Element(tag)
    element.extend(parts)
    return element


def _leaf(tag: str, text: str, **attributes: str) -> Element:
    element = Element(tag, attributes)
    element.text = text
    return element


def _operator(text: str, **attributes: str) -> Element:
    return _leaf("mo", text, **attributes)
