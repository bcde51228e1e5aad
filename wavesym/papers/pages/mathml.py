"""Trees as MathML, by the library latex2mathml."""

from __future__ import annotations

from wavesym.errors import WavesymError, install_command
from wavesym.papers.pages.marks import mark
from wavesym.papers.tree import Addition, FormulaList, Group, Minus, Product, Relation, Series, Tree, latex

LONGEST = 90
"""Characters of LaTeX that are not broken: about what a line of a phone holds."""


_REPLACED = (
    (' xmlns="http://www.w3.org/1998/Math/MathML"', ""),
    ('style="marked"', 'class="marked"'),
    ('display="block"', 'displaystyle="true"'),
)


def mathml(tree: Tree, differing: frozenset[int] = frozenset()) -> str:
    """The formula, marked at some tokens, as <math> elements: one, or, where it is long, pieces that a line may be
    broken between.

    WavesymError where the library is not installed.
    """
    try:
        from latex2mathml.converter import convert
    except ImportError:
        raise WavesymError(f"latex2mathml is not installed: {install_command('papers')}") from None
    elements = []
    for piece in mark(pieces(tree), differing):
        element = convert(piece.replace(r"\marked{", r"\style{marked}{"), display="block")
        for before, after in _REPLACED:
            element = element.replace(before, after)
        elements.append(element)
    return " ".join(elements)


def pieces(tree: Tree) -> list[str]:
    """A formula as LaTeX, cut before its signs where it is long; within brackets too."""
    text = latex(tree)
    if len(text) <= LONGEST:
        return [text]
    match tree:
        case Relation(sides, signs):
            return _parts(sides, [f"{sign} " for sign in signs])
        case FormulaList(items):
            cut = [pieces(item) for item in items]
            return [part for item in cut[:-1] for part in (*item[:-1], f"{item[-1]},")] + cut[-1]
        case Addition(terms):
            bodies = [term.term if place and isinstance(term, Minus) else term for place, term in enumerate(terms)]
            return _parts(bodies, ["- " if isinstance(term, Minus) else "+ " for term in terms[1:]])
        case Product((*before, last)):
            return _prefix(f"{latex(Product(tuple(before)))} ", pieces(last))
        case Series(body=body):
            return _prefix(text.removesuffix(latex(body)), pieces(body))
        case Minus(of):
            return _prefix("-", pieces(of))
        case Group(_, inner):
            opening, closing = text.split(latex(inner))
            first, *rest = _prefix(opening, pieces(inner))
            return [*[first, *rest][:-1], [first, *rest][-1] + closing]
    return [text]


def _parts(parts: tuple[Tree, ...] | list[Tree], signs: list[str]) -> list[str]:
    return [piece for sign, part in zip(["", *signs], parts, strict=True) for piece in _prefix(sign, pieces(part))]


def _prefix(first: str, later: list[str]) -> list[str]:
    return [first + later[0], *later[1:]]
