"""Where two formulas differ: both trees with the parts marked that are not in the other.

The cheapest way to make one of the other is found, node by node: parts in a row (terms, factors, indices) may be left
out or put in, and what can neither be kept nor mended part by part is marked as a whole. What it costs is how many
letters and numbers are marked.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import cache
from itertools import product
from typing import Any

from wavesym.papers.tree import (
    Addition,
    Group,
    Highlight,
    Minus,
    Number,
    Power,
    Product,
    Relation,
    Symbol,
    Tree,
    latex,
    negative,
    symbols,
)


def mark_differences(before: Tree, after: Tree) -> tuple[Tree, Tree]:
    """Both formulas, with `Highlight` around what differs; around nothing where they share nothing."""
    _, one, other = _compare(before, after)
    return (before, after) if isinstance(one, Highlight) and isinstance(other, Highlight) else (one, other)


def mark_range_differences(before: Sequence[Tree], after: Sequence[Tree]) -> tuple[tuple[Tree, ...], tuple[Tree, ...]]:
    """Both lists of ranges, with what differs marked."""
    _, one, other = _rows(tuple(before), tuple(after))
    return one, other


_Pair = tuple[int, Any, Any]


@cache
def _compare(a: Any, b: Any) -> _Pair:
    if a == b:
        return 0, a, b
    whole = _size(a) + _size(b), _mark(a), _mark(b)
    return min((whole, *_partial_marks(a, b)), key=lambda pair: pair[0])


def _partial_marks(a: Any, b: Any) -> list[_Pair]:
    """Ways to mark less than the whole."""
    found = []
    if isinstance(a, Minus) != isinstance(b, Minus):
        cost, one, other = _compare(_without_sign(a), _without_sign(b))
        found.append((cost + 1, _with_sign(one, a), _with_sign(other, b)))
    for kind, part in ((Addition, "terms"), (Product, "factors")):
        if isinstance(a, kind) or isinstance(b, kind):
            cost, one, other = _rows(_parts(a, kind, part), _parts(b, kind, part))
            found.append((cost, _join(one, kind), _join(other, kind)))
    if isinstance(a, Power) != isinstance(b, Power):
        found.append(_compare_powers(a, b))
    if isinstance(a, Group) != isinstance(b, Group):
        found.append(_compare_groups(a, b))
    if type(a) is type(b) and not isinstance(a, (Addition, Product, Number)) and is_dataclass(a):
        found += _by_field(a, b)
    return found


def _by_field(a: Any, b: Any) -> list[_Pair]:
    """Part by part; no way where what is no tree differs: a name, a bracket, a sign."""
    total, one, other = 0, {}, {}
    for field in fields(a):
        x, y = getattr(a, field.name), getattr(b, field.name)
        if x == y:
            continue
        if _is_tree(x) and _is_tree(y):
            cost, one[field.name], other[field.name] = _compare(x, y)
        elif isinstance(x, tuple) and isinstance(y, tuple) and all(map(_is_tree, x + y)):
            cost, one[field.name], other[field.name] = _rows(x, y)
        else:
            return []
        total += cost
    if isinstance(a, Symbol) and a.name == b.name and total >= _size(a) + _size(b):
        return []
    return [(total, replace(a, **one), replace(b, **other))]


def _compare_powers(a: Any, b: Any) -> _Pair:
    """One side has an exponent more."""
    if isinstance(a, Power):
        cost, base, other = _compare(a.base, b)
        return cost + _size(a.exponent), Power(base, _mark(a.exponent)), other
    cost, one, base = _compare(a, b.base)
    return cost + _size(b.exponent), one, Power(base, _mark(b.exponent))


def _compare_groups(a: Any, b: Any) -> _Pair:
    """One side has a pair of brackets more; they are seen without a mark."""
    if isinstance(a, Group):
        cost, inner, other = _compare(a.inner, b)
        return cost + 1, Group(a.bracket, inner), other
    cost, one, inner = _compare(a, b.inner)
    return cost + 1, one, Group(b.bracket, inner)


@cache
def _rows(a: tuple[Any, ...], b: tuple[Any, ...]) -> tuple[int, tuple[Any, ...], tuple[Any, ...]]:
    """Two rows of parts, aligned as cheaply as can be."""
    if not a or not b:
        return sum(map(_size, a + b)), tuple(map(_mark, a)), tuple(map(_mark, b))
    if a[0] == b[0]:
        cost, one, other = _rows(a[1:], b[1:])
        return cost, (a[0], *one), (b[0], *other)
    ways = []
    pair, (rest, one, other) = _compare(a[0], b[0]), _rows(a[1:], b[1:])
    ways.append((pair[0] + rest, (pair[1], *one), (pair[2], *other)))
    rest, one, other = _rows(a[1:], b)
    ways.append((_size(a[0]) + rest, (_mark(a[0]), *one), other))
    rest, one, other = _rows(a, b[1:])
    ways.append((_size(b[0]) + rest, one, (_mark(b[0]), *other)))
    return min(ways, key=lambda way: way[0])


def _size(tree: Any) -> int:
    """How many letters, numbers and signs it has."""
    if isinstance(tree, tuple):
        return sum(map(_size, tree))
    if not is_dataclass(tree):
        return 0
    own = 1 if isinstance(tree, (Symbol, Minus)) or not any(_is_part(tree, field.name) for field in fields(tree)) else 0
    return own + sum(_size(getattr(tree, field.name)) for field in fields(tree))


def _is_tree(value: Any) -> bool:
    return is_dataclass(value)


def _is_part(tree: Any, name: str) -> bool:
    value = getattr(tree, name)
    return _is_tree(value) or isinstance(value, tuple)


def _mark(tree: Any) -> Any:
    return tuple(map(_mark, tree)) if isinstance(tree, tuple) else Highlight(tree)


def _without_sign(tree: Any) -> Any:
    return tree.term if isinstance(tree, Minus) else tree


def _with_sign(body: Any, before: Any) -> Highlight:
    """A body with the sign that it had, which is marked."""
    return Highlight(Minus(body) if isinstance(before, Minus) else body, sign_only=True)


def _parts(tree: Any, kind: type, part: str) -> tuple[Any, ...]:
    return getattr(tree, part) if isinstance(tree, kind) else (tree,)


def _join(parts: tuple[Any, ...], kind: type) -> Any:
    return parts[0] if len(parts) == 1 else kind(parts)


def subtract(printed: Tree, corrected: Tree) -> str:
    """One equation less another, term by term, as LaTeX: their right sides, where the left ones are the same, else left
    less right sides; "" where they do not differ.
    """
    if not (isinstance(printed, Relation) and isinstance(corrected, Relation)):
        return ""
    if printed.sides[0] == corrected.sides[0]:
        mine, theirs = (list(_terms(equation.sides[1])) for equation in (printed, corrected))
    else:
        mine, theirs = (
            [*_terms(equation.sides[0]), *map(negative, _terms(equation.sides[1]))] for equation in (printed, corrected)
        )
    rest = [term for term in mine if term not in theirs] + [negative(term) for term in theirs if term not in mine]
    return latex(Addition(tuple(rest))) if rest else ""


def _terms(tree: Tree) -> Iterator[Tree]:
    """The terms of a sum, brackets with coefficients in them multiplied out."""
    match tree:
        case Addition(terms):
            for term in terms:
                yield from _terms(term)
        case Minus(of):
            yield from map(negative, _terms(of))
        case Product(factors):
            for chosen in product(*([*_terms(f.inner)] if _brackets(f) else [f] for f in factors)):  # type: ignore[union-attr]
                plain = [factor.term if isinstance(factor, Minus) else factor for factor in chosen]
                flat = [
                    part for factor in plain for part in (factor.factors if isinstance(factor, Product) else [factor])
                ]
                turned = sum(isinstance(factor, Minus) for factor in chosen) % 2
                yield negative(Product(tuple(flat))) if turned else Product(tuple(flat))
        case _:
            yield tree


def _brackets(factor: Tree) -> bool:
    return isinstance(factor, Group) and any(symbol.superscript for symbol in symbols(factor))
