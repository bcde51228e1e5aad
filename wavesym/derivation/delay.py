"""The law of a node on the clocks of Table 1: the delay equations, as in (4.6)-(4.8).

At a node two waves leave, one to each side. Continuity (2.3) gives one of them, the node's law the other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

from sympy import Expr, IndexedBase, Integer, Rational, Symbol

from wavesym.derivation.delay_terms import Line, Operator, Wave, exact, load, wave
from wavesym.derivation.node_law import node_law
from wavesym.mechanics.node import Family, Node, Parameters, Rod, System

INDEX = Symbol("i", integer=True, positive=True)
COUNT = Symbol("m", integer=True, positive=True)
SYMBOLS = Parameters(
    kappa=IndexedBase("kappa"), inertia=IndexedBase("J"), velocity=IndexedBase("v"), dashpot=IndexedBase("b")
)


@dataclass(frozen=True)
class DelayEquation:
    """(a D + b) of wave `function` of rod `rod` equals `right`, for i = first, first + step, ... last.

    Where `rod` is no function of i the equation stands alone and first = last = rod.
    """

    function: str
    rod: Expr
    own: Operator
    right: Line
    first: Expr
    last: Expr
    step: int


@dataclass(frozen=True)
class Side:
    """A rod as its end at a node sees it: velocity and strain there, as lines in the clock tau.

    `arriving` is the wave that comes to the node, as a velocity: of the rod's own, each wave has half.
    """

    rod: Expr
    velocity: Line
    strain: Line
    arriving: Line
    outgoing: Wave


def side(rod: Rod, number: Expr, x: Expr, outgoing: str) -> Side:
    """Rod `number` at x, by (4.2): velocity f' + g' + v and strain g' - f'."""
    lag = {"f": exact(rod.tau0 + x - rod.x0), "g": exact(rod.tau0 - x + rod.x0)}
    f, g = wave("f", number, lag["f"]), wave("g", number, lag["g"])
    moving = load("impact", None, 0, rod.velocity)
    return Side(
        number,
        velocity=f + g + moving,
        strain=g - f,
        arriving=(f if outgoing == "g" else g) + moving.scale(Rational(1, 2)),
        outgoing=Wave(outgoing, exact(number), lag[outgoing]),
    )


def _solve_for(equation: Line, unknown: Wave) -> tuple[Operator, Line]:
    """`equation` = 0 as (own operator) unknown = right, on the clock of the unknown, own operator D + b or 1."""
    a, b = equation.waves[unknown]
    factor = a if a != 0 else b
    right = equation.drop(unknown).scale(-1 / factor).delay(-unknown.lag)
    return Operator(exact(a / factor), exact((b / factor).expand())), right


def sides(node: Node, x: Expr) -> tuple[Side | None, Side | None]:
    """The rods at the node at x as they end there: the left one, the right one."""
    left = side(node.left, x, x, "g") if node.left else None
    right = side(node.right, x + 1, x, "f") if node.right else None
    return left, right


def balance(node: Node, x: Expr) -> tuple[Line, Line]:
    """(2.4) at the node at x with (4.2) put in: what moves, as the right rod has it where there is one; what acts."""
    left, right = sides(node, x)
    own = right or left
    assert own is not None  # a node has a rod
    motion, force = own.velocity.scale(node.damping), Line()
    if node.inertia:
        motion = motion + own.velocity.differentiate().scale(node.inertia)
    if right:
        force = force + right.strain.scale(Rational(1, 2) * node.beta)
    if left:
        force = force - left.strain.scale(Rational(1, 2) * node.alpha)
    return motion, force + loads(node)


def loads(node: Node) -> Line:
    """What acts on a node."""
    units = ((unit, power, value) for unit in node.loads for power, value in enumerate(unit.coefficients))
    return sum((load(unit.kind, unit.number, power, value) for unit, power, value in units), Line())


def _lawful(node: Node, left: Side | None, right: Side | None, moving: Side) -> Line:
    """What the node's law makes 0, with the velocity as one of its rods has it."""
    law = node_law().with_numbers(node)
    line = moving.velocity.scale(law.own.b) - loads(node).scale(law.load)
    if law.own.a != 0:
        line = line + moving.velocity.differentiate().scale(law.own.a)
    for side, factor in ((left, law.left), (right, law.right)):
        if side:
            line = line - side.arriving.scale(factor)
    return line


def _at_node(node: Node, x: Expr) -> list[tuple[Wave, Operator, Line]]:
    """The waves that leave the node at x: each as (wave, its operator, what that equals)."""
    left, right = sides(node, x)
    if left is None or right is None:
        end = left or right
        assert end is not None  # a node has a rod
        return [(end.outgoing, *_solve_for(_lawful(node, left, right, end), end.outgoing))]
    # Continuity must look back in time, so it gives the wave that is ahead on its clock; on a tie, the right one.
    later = exact(right.outgoing.lag - left.outgoing.lag)
    if later.is_nonpositive is None:
        raise ValueError(f"which wave is ahead at x = {x} is not decided: {later} may have either sign")
    ahead, other = (right, left) if later.is_nonpositive else (left, right)
    _, continuous = _solve_for(ahead.velocity - other.velocity, ahead.outgoing)
    own, rest = _solve_for(_lawful(node, left, right, other), other.outgoing)
    if own.a == 0:
        continuous = continuous.substitute(other.outgoing.function, other.rod, rest)
    return [(ahead.outgoing, Operator(Integer(0), Integer(1)), continuous), (other.outgoing, own, rest)]


def _family_equations(family: Family) -> list[DelayEquation]:
    alone = exact(family.first - family.last) == 0
    x = exact(family.first) if alone else INDEX
    equations = []
    for unknown, own, right in _at_node(family.node_at(x), x):
        if alone:
            equations.append(DelayEquation(unknown.function, unknown.rod, own, right, unknown.rod, unknown.rod, 1))
            continue
        # number the equation by its own rod: of the node at x = i, the right one is rod i + 1
        shift = unknown.rod - INDEX
        place = Line({Wave(unknown.function, unknown.rod, Integer(0)): own}).replace_index(INDEX, INDEX - shift)
        ((renumbered, operator),) = place.waves.items()
        equations.append(
            DelayEquation(
                unknown.function,
                renumbered.rod,
                operator,
                right.replace_index(INDEX, INDEX - shift),
                exact(family.first + shift),
                exact(family.last + shift),
                family.step,
            )
        )
    return equations


def _without_echoes(equations: list[DelayEquation]) -> list[DelayEquation]:
    """A free end only sends back what arrives: put that into the other equations, as the paper does.

    Of an equation that stands for several, the functions would have to be told apart by their numbers.
    """
    for echo in equations:
        if echo.rod.has(INDEX):
            continue
        (end,) = echo.right.waves.values() if len(echo.right.waves) == 1 else (None,)
        if end is not None and end.a == 0 and echo.own.a == 0 and not echo.right.loads:
            equations = [
                other
                if other is echo
                else replace(other, right=other.right.substitute(echo.function, echo.rod, echo.right))
                for other in equations
            ]
    return equations


@cache
def delay_equations(system: System, parameters: Parameters = SYMBOLS) -> tuple[DelayEquation, ...]:
    """The delay equations of a system for symbolic m: one for every wave function of every kind of rod.

    `parameters` may say that some are equal: they give an expression for every symbolic index.
    """
    equations = [e for family in system.families(COUNT, parameters) for e in _family_equations(family)]
    return tuple(_without_echoes(equations))
