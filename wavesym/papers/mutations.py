"""Faults put into a formula: every sign, number, index, H, limit and quantity wrong once.

A verdict is worth what it would not survive. Each fault has a name that says what became what, and where.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any, cast

from wavesym.papers.tree import (
    Addition,
    Call,
    Derivative,
    Fraction,
    Group,
    Interval,
    Minus,
    Number,
    Power,
    Product,
    Progression,
    Series,
    Symbol,
    Tree,
    latex,
    negative,
)

LONGEST = 60
"""Characters of a context; what is longer is told by what is around it."""
_STRUCTURE = frozenset("e")
"""Letters that are no quantities."""
_TURNED_BRACKETS = {"(": r"\langle", r"\langle": "(", ")": r"\rangle", r"\rangle": ")"}


def mutations(tree: Tree) -> Iterator[tuple[str, Tree]]:
    """The tree with one fault each, by what was changed; no two have the same name."""
    seen: dict[str, int] = {}
    known: set[Tree] = {tree}
    for change, wrong in _tree_faults(tree, ""):
        if wrong in known:
            continue
        known.add(wrong)
        seen[change] = seen.get(change, 0) + 1
        yield (change if seen[change] == 1 else f"{change}, number {seen[change]}"), wrong


def ends(range_: Tree) -> Iterator[tuple[str, Tree]]:
    """A range with both its ends one step longer and shorter, by what was changed; other ranges as formulas.

    An interval is opened and closed at its ends, too.
    """
    if isinstance(range_, Interval):
        for end, bracket in enumerate(range_.brackets):
            turned = _TURNED_BRACKETS[bracket]
            brackets = (turned, range_.brackets[1]) if end == 0 else (range_.brackets[0], turned)
            yield f"{turned} for {bracket} in {latex(range_)}", replace(range_, brackets=brackets)
    if not isinstance(range_, Progression) or not range_.dots:
        yield from mutations(range_)
        return
    text = latex(range_)
    first, *others = range_.first_values
    for by in (1, -1):
        moved = tuple(_plus(value, by) for value in range_.first_values)
        if len(others) == 0:
            yield f"first {latex(moved[0])} for {latex(first)} in {text}", replace(range_, first_values=moved)
    if others:
        later = tuple(others)
        shown = (*later, *(() if len(later) > 1 else (_twice_less(others[-1], first),)))
        yield f"without {latex(first)} in {text}", replace(range_, first_values=shown)
        earlier = (_twice_less(first, others[0]), *range_.first_values)
        yield f"with {latex(earlier[0])} in {text}", replace(range_, first_values=earlier)
    if range_.last is not None:
        for by in (1, -1):
            step = _step(range_)
            last = _plus(range_.last, by * step)
            yield f"last {latex(last)} for {latex(range_.last)} in {text}", replace(range_, last=last)


def _tree_faults(tree: Any, context: str) -> Iterator[tuple[str, Any]]:
    here = context or _short(latex(tree)) or "the formula"
    yield from _own_faults(tree, here)
    yield from _inner_faults(tree, here)


def _inner_faults(tree: Any, here: str) -> Iterator[tuple[str, Any]]:
    """Faults in the parts."""
    for field in fields(tree):
        value = getattr(tree, field.name)
        if isinstance(value, tuple):
            for place, part in enumerate(value):
                for change, wrong in _part_faults(part, tree, here):
                    yield change, replace(tree, **{field.name: (*value[:place], wrong, *value[place + 1 :])})
        elif is_dataclass(value) and not _is_label(tree, field.name):
            inner = _context(value, here)
            # the letter of a function is no quantity
            faults = _inner_faults(value, inner) if isinstance(tree, Call) else _tree_faults(value, inner)
            for change, wrong in faults:
                yield change, replace(tree, **{field.name: wrong})


def _part_faults(part: Any, parent: Any, here: str) -> Iterator[tuple[str, Any]]:
    if isinstance(part, tuple):  # a branch of cases
        for place, inner in enumerate(part):
            faults = ends(inner) if isinstance(inner, Progression) else _tree_faults(inner, _context(inner, here))
            for change, wrong in faults:
                yield change, (*part[:place], wrong, *part[place + 1 :])
    elif is_dataclass(part):
        if isinstance(parent, Symbol) and not isinstance(part, Number):
            for by in (1, -1):
                wrong = _plus(cast(Tree, part), by)
                yield f"index {latex(wrong)} for {latex(cast(Tree, part))} in {here}", wrong
            return
        if isinstance(parent, Addition) and isinstance(part, Minus):  # its sign is the sum's
            for change, inner_wrong in _tree_faults(part.term, _context(part.term, here)):
                yield change, Minus(inner_wrong)
            return
        yield from _tree_faults(part, _context(part, here))


def _own_faults(tree: Any, here: str) -> Iterator[tuple[str, Any]]:
    match tree:
        case Number(digits) if "." not in digits:
            for by in (1, -1):
                value = int(digits) + by
                wrong: Tree = Number(str(value)) if value >= 0 else Group("(", Minus(Number(str(-value))))
                yield f"{value} for {digits} in {here}", wrong
        case Number(digits):
            yield f"{digits}1 for {digits} in {here}", Number(f"{digits}1")
        case Addition(terms):
            for place, term in enumerate(terms):
                turned = negative(term)
                changed = Addition((*terms[:place], turned, *terms[place + 1 :]))
                yield f"sign of {_short(latex(term)) or 'a term'} in {_short(latex(tree)) or here}", changed
        case Minus(of):
            yield f"sign of {latex(tree)} in {here}", of
        case Product(factors):
            for place, factor in enumerate(factors):
                if isinstance(factor, Call) and factor.function.name == "H":
                    left = (*factors[:place], *factors[place + 1 :])
                    yield f"without {latex(factor)} in {here}", left[0] if len(left) == 1 else Product(left)
        case Call(Symbol("H"), (argument,)):
            for by in (1, -1):
                moved = _plus(argument, by)
                yield f"H({latex(moved)}) for {latex(tree)} in {here}", Call(tree.function, (moved,))
        case Series(variable, first, last, body):
            for by in (1, -1):
                moved = _plus(first, by)
                yield f"sum from {latex(moved)} for {latex(first)} in {here}", Series(variable, moved, last, body)
                moved = _plus(last, by)
                yield f"sum to {latex(moved)} for {latex(last)} in {here}", Series(variable, first, moved, body)
        case Symbol(name) if name not in _STRUCTURE and not tree.superscript and not tree.primes:
            yield f"2 {latex(tree)} for {latex(tree)} in {here}", Group("(", Product((Number("2"), tree)))


def _is_label(tree: Any, field: str) -> bool:
    """Parts that name something and are no quantity: what is summed over, or derived by; a function's letter."""
    return (isinstance(tree, Series) and field in ("variable", "first", "last")) or (
        isinstance(tree, Derivative) and field == "variable"
    )


def _context(part: Any, here: str) -> str:
    """The smallest part that tells a reader where a change is."""
    if isinstance(part, (Symbol, Call, Power, Series, Derivative, Fraction, Group)):
        return _short(latex(part)) or here
    return here


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else ""


def _plus(tree: Tree, by: int) -> Tree:
    """An expression and a number, put together where it ends in one."""
    match tree:
        case Number(digits) if "." not in digits:
            value = int(digits) + by
            return Number(str(value)) if value >= 0 else Minus(Number(str(-value)))
        case Minus(Number(digits)):
            return _plus(Number("0"), by - int(digits))
        case Addition((*before, Number() | Minus(Number()) as last)):
            value = (-1 if isinstance(last, Minus) else 1) * int(
                cast(Number, last.term if isinstance(last, Minus) else last).digits
            ) + by
            if value == 0:
                return before[0] if len(before) == 1 else Addition(tuple(before))
            return Addition((*before, _signed_number(value)))
        case Addition(terms):
            return Addition((*terms, _signed_number(by)))
    return Addition((tree, _signed_number(by)))


def _signed_number(value: int) -> Tree:
    return Number(str(value)) if value > 0 else Minus(Number(str(-value)))


def _step(range_: Progression) -> int:
    """The step of the values shown, where it can be seen."""
    first, *others = range_.first_values
    for step in (1, 2, -1, -2, 4):
        if others and _plus(first, step) == others[0]:
            return step
    return 1


def _twice_less(one: Tree, other: Tree) -> Tree:
    """2 one - other: the value before `one`, or after it."""
    for step in (1, 2, -1, -2, 4):
        if _plus(one, step) == other:
            return _plus(one, -step)
        if _plus(other, step) == one:
            return _plus(one, step)
    return Addition((Product((Number("2"), one)), Minus(other)))
