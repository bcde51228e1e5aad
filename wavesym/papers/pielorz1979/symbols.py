"""What the letters of sections 2 to 4 mean in symbols, for symbolic i and m, as the derivation has them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from sympy import Add, Expr, Function, IndexedBase, Integer, Sum, expand, latex
from sympy import Symbol as Letter

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS
from wavesym.derivation.delay_terms import Line
from wavesym.mechanics.node import Parameters
from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.pielorz1979.letters import IndexedLetters, letter
from wavesym.papers.tree import Call, Derivative, Series, Symbol, Tree
from wavesym.papers.tree import latex as latex_of

DISPLACEMENTS = {"I": r"\baru", "II": r"\bar\theta", "III": r"\bary"}
"""The U of (2.1) without dimension, Table 1."""
ACCELERATION = Letter(r"\frac{\partial^2 U(x, \tau)}{\partial \tau^2}")
K, Z = Letter("k"), Letter("z")
STEP = Function("H")
_M, _A, _B, _T, _LAST = (IndexedBase(name) for name in ("M", "a", "b", "tau", "m"))


class Symbols(IndexedLetters):
    """Expressions; z is the clock, strain and velocity stand as they are, the acceleration of either rod for the
    node's.
    """

    def __init__(self, parameters: Parameters = SYMBOLS, bound: Mapping[str, Any] | None = None) -> None:
        super().__init__({"i": INDEX, "m": COUNT, "z": Z, r"\tau": Z, "t": Z, "l": Letter("l"), **(bound or {})})
        kappa, inertia = parameters.kappa, parameters.inertia
        self.letters = {
            r"\kappa": kappa.__getitem__,
            "J": inertia.__getitem__,
            r"\barv": SYMBOLS.velocity.__getitem__,
            r"\barA": lambda i: kappa[1] * inertia[1] / inertia[i],
            "m": _LAST.__getitem__,
            r"\tau": lambda *index: _T[index],
            **dict.fromkeys(("M", r"\barM"), lambda s, k: _M[s, k]),
            **dict.fromkeys(("a", r"\bara"), _A.__getitem__),
            **dict.fromkeys(("b", r"\barb"), _B.__getitem__),
        }
        self.functions = {r"\barM": lambda *index: moment(*index[:-1])}  # the last is the time
        for name in "fg":
            self.functions |= {name + "'" * order: partial(_late, name, order) for order in (1, 2)}

    def derivative(self, derivative: Derivative) -> Expr:
        displaced = derivative.of.function if isinstance(derivative.of, Call) else derivative.of
        if isinstance(displaced, Symbol) and letter(displaced) in ("U", *DISPLACEMENTS.values()):
            if latex_of(derivative.by) in ("x", r"\bar{x}") and derivative.order == 1:
                return strain(*self.indices(displaced))
            if latex_of(derivative.by) in ("t", r"\tau") and derivative.order == 2:
                return ACCELERATION
        raise MeaninglessError(f"{latex_of(derivative)} is no part of a balance")

    def literal(self, value: Any) -> Any:
        return Integer(value)

    def series(self, series: Series) -> Any:
        with self.binding({series.variable.name: K}):
            body = self.value(series.body)
        return added(body, self.value(series.last), self.value(series.first))

    def whole(self, tree: Tree) -> Any:
        return expand(self.value(tree))

    def step(self, value: Any) -> Any:
        return STEP(expand(value))


def strain(rod: Any) -> Expr:
    """The strain of a rod at the node."""
    return Letter(rf"\frac{{\partial U_{{{latex(rod)}}}(x, \tau)}}{{\partial x}}")


def moment(number: Any = None) -> Expr:
    """A moment at an instant."""
    return Letter(rf"M_{{{latex(expand(number))}}}(\tau)" if number is not None else r"M(\tau)")


def _late(name: str, order: int, rod: Expr, z: Expr) -> Expr:
    return wave(name, order, rod, expand(Z - z))


def wave(name: str, order: int, rod: Expr, lag: Expr) -> Expr:
    """A derivative of f or g, as one symbol."""
    late = "z" if lag == 0 else f"z-{latex(lag)}"
    return Letter(rf"{name}{chr(39) * order}_{{{latex(rod)}}}({late})")


def added(body: Expr, last: Expr, first: Expr | int = 0) -> Expr:
    """A sum over k, each of its terms apart."""
    return Add(*(Sum(term, (K, first, last)) for term in Add.make_args(expand(body))))


def expression(line: Line) -> Expr:
    """A derived line as an expression, with all pieces of its loads."""
    total = Integer(0)
    for (name, rod, lag), (a, b) in line.waves.items():
        total += a * wave(name, 2, rod, lag) + b * wave(name, 1, rod, lag)
    for (kind, number, lag, power), value in line.loads.items():
        if kind == "impact":
            total += value
            continue
        weight, start = ({"a": _A, "b": _B}[kind][K], _T[K]) if number is None else (_M[number, K], _T[number, K])
        since = Z - lag - start
        total += value * added(weight * since**power * STEP(expand(since)), _LAST[1 if number is None else number])
    return total


def told(difference: Expr) -> str:
    """A difference as mathematics: each quantity with what stands before it."""
    rest = expand(difference)
    parts = []
    for atom in sorted(rest.atoms(Sum) | {s for s in rest.atoms(Letter) if "(" in s.name}, key=str):
        if (factor := rest.coeff(atom)) != 0:
            parts.append(f"({latex(factor)}) {latex(atom)}")
            rest = expand(rest - factor * atom)
    return " + ".join(parts + ([latex(rest)] if rest != 0 or not parts else []))
