"""III.1 ... III.22 one by one: each with the true values of the coefficients on its right, its H, and what it gives."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache, partial
from itertools import product

from flint import fmpq

from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds
from wavesym.papers.pielorz1979 import alone
from wavesym.papers.pielorz1979.lines import STEPS, Coefficients, Key, Line, given, ids, line, truth
from wavesym.papers.record import Case, Reading, Test, by_size, case
from wavesym.papers.tree import Addition, Group, Minus, Product, Tree, latex

SIZES = tuple(by_size((m, n) for m in range(3, 7) for n in range(12 - m)))
SMALL = tuple((m, n) for m, n in SIZES if m + n < 9)


def coefficient(entry: Entry) -> Test:
    """A line of the list."""
    return Test(
        "the exact tables with equal floors under a load of three steps, m = 3 ... 6, m + n < 12: values, the H of "
        "every coefficient, and every coefficient given once",
        partial(_cases, entry.id),
        difference=partial(_difference, entry.id) if entry.slip else None,
        observed=partial(alone.consequence, entry.id) if entry.slip else None,
    )


def _difference(id: str, read: Reading) -> str:
    """What is printed less what is right: the terms in which they differ."""
    try:
        ((_, printed),) = Line.of(read).equations
    except (MeaninglessError, ValueError):
        return "no line of the list"
    ((_, right),) = line(id).equations
    mine, theirs = list(_terms(printed)), list(_terms(right))
    left = [term for term in mine if term not in theirs] + [_negative(term) for term in theirs if term not in mine]
    return latex(Addition(tuple(left))) if left else "0"


def _terms(tree: Tree) -> Iterator[Tree]:
    """The terms of a sum, brackets with coefficients in them multiplied out."""
    match tree:
        case Addition(terms):
            for term in terms:
                yield from _terms(term)
        case Minus(of):
            yield from map(_negative, _terms(of))
        case Product(factors):
            for chosen in product(*([*_terms(f.inner)] if _brackets(f) else [f] for f in factors)):  # type: ignore[union-attr]
                flat = [part for factor in chosen for part in _factors(factor)]
                turned = sum(isinstance(factor, Minus) for factor in chosen) % 2
                yield _negative(Product(tuple(flat))) if turned else Product(tuple(flat))
        case _:
            yield tree


def _brackets(factor: Tree) -> bool:
    return isinstance(factor, Group) and "^" in latex(factor)


def _factors(factor: Tree) -> tuple[Tree, ...]:
    """Of a term, its sign apart."""
    plain = factor.of if isinstance(factor, Minus) else factor
    return plain.factors if isinstance(plain, Product) else (plain,)


def _negative(term: Tree) -> Tree:
    return term.of if isinstance(term, Minus) else Minus(term)


def sizes(entry: Entry) -> Test:
    """The m for which the list is said to give the coefficients."""
    return Test("whether the list, run by itself, gives every coefficient, m = 2 ... 6, n = 0 ... 5", _sizes)


def _sizes(reading: Reading) -> Iterator[Case]:
    for m in range(2, 7):
        yield Case({"m": m}, holds(reading.formula, Scope({"m": m})), alone.complete(m, 5))


def _cases(id: str, reading: Reading) -> Iterator[Case]:
    """Values of small buildings first: a wrong one says more than a wrong H or range."""
    tried = Line.of(reading)
    for m, n in SMALL:
        for place in tried.places(m, n, (m + n) % len(STEPS)):
            yield _value(*place)
    for m, n in SIZES:
        for place in tried.places(m, n, (m + n) % len(STEPS)):
            if (m, n) not in SMALL:
                yield _value(*place)
            yield from _lets_in(*place)
        yield from _coverage(id, tried, m, n)


def _value(bound: dict[str, int], key: Key, right: Tree) -> Case:
    known = truth(bound["m"])
    true = known(key)
    value = partial(Coefficients(bound, bound["m"], known).value, right)
    return case(bound, value, true, true != 0, partial(known.example, key))


def _lets_in(bound: dict[str, int], key: Key, right: Tree) -> Iterator[Case]:
    """H lets in the coefficients that exist, and no others; none rests on itself."""
    known = truth(bound["m"])
    used, behind = _asked(bound, right), _asked(bound, right, opened=True)
    if key in used:
        yield Case({**bound, "claim": "does not rest on itself"}, False, True)
    if len(behind) > len(used) or not all(map(known.exists, used)):
        yield Case({**bound, "claim": "H lets in"}, _names(used), _names(filter(known.exists, behind)))


def _asked(bound: dict[str, int], right: Tree, opened: bool = False) -> list[Key]:
    """The coefficients that a right side asks for, in their order."""
    found = []

    def asked(key: Key) -> fmpq:
        found.append(key)
        return truth(bound["m"])(key)

    Coefficients(bound, bound["m"], asked, opened).value(right)
    return found


def _coverage(id: str, tried: Line, m: int, n: int) -> Iterator[Case]:
    """Every coefficient is given by one line, once."""
    wanted = _wanted(id, m, n)
    counts = Counter(given([tried], m, n))
    where = {"m": m, "n": n}
    if not wanted and not counts:
        return
    extra = sorted((counts - Counter(wanted)).elements())
    yield Case({**where, "claim": "given twice, or no coefficient"}, _names(extra), (), bool(counts))
    yield Case({**where, "claim": "given by no line"}, _names(sorted(wanted - set(counts))), (), bool(wanted))


@cache
def _wanted(id: str, m: int, n: int) -> frozenset[Key]:
    """The coefficients that no other line gives, of the letter and the family that this line is about."""
    about = {key[:2] for key in given([line(id)], m, n)} or {key[:2] for key in given([line(id)], m, n + 1)}
    others = {key for other in ids() if other != id for key in _given(other, m, n)}
    return frozenset(key for key in truth(m).unknowns(n) - others if key[:2] in about)


@cache
def _given(id: str, m: int, n: int) -> frozenset[Key]:
    return frozenset(given([line(id)], m, n))


def _names(keys: Iterable[Key]) -> tuple[str, ...]:
    return tuple(map(str, keys))
