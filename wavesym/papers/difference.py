"""One equation less another, term by term."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from wavesym.papers.tree import Addition, Group, Minus, Product, Relation, Tree, latex, negative, symbols


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
