"""A proof for symbolic i and m that the delay equations are the node law: no sample is taken.

Both are put in Laplace images, D as s, a delay by one rod length as a symbol E for exp(-s). With q0 the velocity of the
rods fixed to a body, and A and B the waves that arrive from the left and the right, v/2 among them, the node law is

    inertia (s Q - q0) + (damping + (alpha + beta)/2) Q = alpha A + beta B + load,    sent: Q - A left, Q - B right.

At a node either route gives linear equations for the waves that leave it. Where both determinants are other than 0 and
the solutions differ by 0, as rational functions, the one follows from the other and the other from the one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from math import factorial
from typing import NamedTuple

from sympy import Expr, Integer, Matrix, Rational, Symbol, cancel, exp, together

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS, DelayEquation
from wavesym.derivation.delay_terms import Line, Operator, exact
from wavesym.mechanics.node import Family, Node, Rod, System

S, E = Symbol("s"), Symbol("E")


class Outgoing(NamedTuple):
    """The wave `function` of rod `rod` that leaves a node, by both routes; `determinants` of the two systems."""

    function: str
    rod: Expr
    difference: Expr
    determinants: tuple[Expr, Expr]


class Law(NamedTuple):
    """The node law of a family of nodes: the waves that leave, what they are, the determinant it took."""

    family: Family
    outgoing: tuple[tuple[str, Expr], ...]
    solution: tuple[Expr, ...]
    determinant: Expr
    substitutions: dict[Expr, Expr]


def node_law(system: System, equations: Iterable[DelayEquation]) -> Iterator[Outgoing]:
    """Every wave that leaves a node, by delay equations and by the node law: equal where the difference is 0.

    ValueError where a wave has no equation, or more than one.
    """
    given = list(equations)
    for law in _laws(system):
        own = [_image(*wave) for wave in law.outgoing]
        derived = [_image_of(_wave_equation(given, law.family, *wave)).subs(law.substitutions) for wave in law.outgoing]
        solution, determinant = _solution(derived, own)
        for wave, one, other in zip(law.outgoing, solution, law.solution, strict=True):
            yield Outgoing(*wave, cancel(together(one - other)), (determinant, law.determinant))


@cache
def _laws(system: System) -> tuple[Law, ...]:
    """The node laws of a system; what a free end sends back is put into the others, as in the delay equations."""
    families = system.families(COUNT, SYMBOLS)
    echoes = dict(_echo(family) for family in families if _only_echoes(_node(family)[0]))
    laws = []
    for family in families:
        node, x = _node(family)
        known = {} if _only_echoes(node) else echoes
        outgoing = _leaving(node, x)
        solution, determinant = _solution(
            [equation.subs(known) for equation in _node_equations(node, x)], [_image(*wave) for wave in outgoing]
        )
        laws.append(Law(family, tuple(outgoing), tuple(solution), determinant, known))
    return tuple(laws)


def _node(family: Family) -> tuple[Node, Expr]:
    x = exact(family.first) if exact(family.first - family.last) == 0 else INDEX
    return family.node_at(x), x


def _leaving(node: Node, x: Expr) -> list[tuple[str, Expr]]:
    return [*([("g", exact(x))] if node.left else []), *([("f", exact(x + 1))] if node.right else [])]


def _image(function: str, rod: Expr) -> Symbol:
    """The Laplace image of a wave on its own clock."""
    return Symbol(f"{function}({rod})")


def _late(lag: Expr) -> Expr:
    """exp(-s lag): a power of E, times a symbol for what of the lag is symbolic, the same at all waves of a node."""
    whole, rest = exact(lag).as_coeff_Add()
    return E ** int(whole) * (Symbol(f"E^({rest})") if rest != 0 else 1)


def with_delays(expression: Expr) -> Expr:
    """An expression with the exponentials that the symbols for delays stand for."""
    return expression.subs({E: exp(-S), **{Symbol(f"E^({place})"): exp(-S * place) for place in (INDEX, COUNT)}})


def _power(power: int) -> Expr:
    """The image of tau**power from tau = 0 on."""
    return factorial(power) / S ** (power + 1)


def _source(kind: str, number: Expr | int | None) -> Expr:
    return Integer(1) if kind == "impact" else Symbol(f"{kind}({number})")


def _node_equations(node: Node, x: Expr) -> list[Expr]:
    """The node law with the velocity Q of the node eliminated: each equation, an expression that is 0."""
    arrived = {"left": _arriving_wave(node.left, "f", x, x), "right": _arriving_wave(node.right, "g", x + 1, x)}
    load = sum(
        (
            value * _power(k) * _source(unit.kind, unit.number)
            for unit in node.loads
            for k, value in enumerate(unit.coefficients)
        ),
        Integer(0),
    )
    held = node.left or node.right
    assert held is not None
    gamma = node.damping + Rational(1, 2) * (node.alpha + node.beta)
    right = node.alpha * arrived["left"] + node.beta * arrived["right"] + load + node.inertia * held.velocity
    velocity = right / (node.inertia * S + gamma)
    equations = []
    for rod, came, function, number in (
        (node.left, arrived["left"], "g", x),
        (node.right, arrived["right"], "f", x + 1),
    ):
        if rod is not None:
            sent = _late(_lag(rod, function, x)) * _image(function, exact(number))
            equations.append(sent + rod.velocity / (2 * S) - (velocity - came))
    return equations


def _lag(rod: Rod, function: str, x: Expr) -> Expr:
    """When the wave with argument 0 passes x."""
    return exact(rod.tau0 + (x - rod.x0 if function == "f" else rod.x0 - x))


def _arriving_wave(rod: Rod | None, function: str, number: Expr, x: Expr) -> Expr:
    if rod is None:
        return Integer(0)
    return _late(_lag(rod, function, x)) * _image(function, exact(number)) + rod.velocity / (2 * S)


def _only_echoes(node: Node) -> bool:
    return not (node.left and node.right) and not node.inertia and not node.damping and not node.loads


def _echo(family: Family) -> tuple[Expr, Expr]:
    """What a free end sends back, by the node law: the image, and what it is."""
    node, x = _node(family)
    ((function, rod),) = _leaving(node, x)
    own = _image(function, rod)
    ((solution,), _) = _solution(_node_equations(node, x), [own])
    return own, cancel(solution)


def _wave_equation(equations: Iterable[DelayEquation], family: Family, function: str, rod: Expr) -> DelayEquation:
    """The equation of a wave that leaves the nodes of a family, with i the place of the node."""
    shift = 1 if function == "f" else 0
    found = [
        e
        for e in equations
        if e.function == function
        and exact(e.first - family.first - shift) == 0
        and exact(e.last - family.last - shift) == 0
    ]
    if len(found) != 1:
        raise ValueError(f"{len(found)} equations for {function} of rod {rod}")
    (e,) = found
    at = INDEX + shift
    own = Operator(*(exact(part.subs(INDEX, at)) for part in e.own))
    return DelayEquation(function, rod, own, e.right.replace_index(INDEX, at), e.first, e.last, e.step)


def _image_of(e: DelayEquation) -> Expr:
    """Left less right side of a delay equation, in images."""
    return (e.own.a * S + e.own.b) * _image(e.function, e.rod) - _line(e.right)


def _line(line: Line) -> Expr:
    waves = ((a * S + b) * _late(w.lag) * _image(w.function, w.rod) for w, (a, b) in line.waves.items())
    loads = (
        value * _power(source.power) * _late(source.lag) * _source(source.kind, source.number)
        for source, value in line.loads.items()
    )
    return sum(waves, Integer(0)) + sum(loads, Integer(0))


def _solution(equations: Sequence[Expr], unknowns: Sequence[Symbol]) -> tuple[list[Expr], Expr]:
    """The solution of linear equations for as many waves, and their determinant."""
    matrix = Matrix(equations).jacobian(unknowns)
    right = -Matrix(equations).subs(dict.fromkeys(unknowns, 0))
    determinant = cancel(together(matrix.det()))
    return list(matrix.adjugate() * right / determinant), determinant
