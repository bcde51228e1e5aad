"""(2.3), (2.4), (4.3)-(4.5): the conditions at the nodes, on the tables and against the nodes for symbolic i and m."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

from sympy import Integer, Rational

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS
from wavesym.derivation.delay_terms import Line, Wave, exact
from wavesym.model.node import Node
from wavesym.papers.exact_tables import grounded_building, uneven_building
from wavesym.papers.pielorz1979.delays import II, III, Example, I, line_text
from wavesym.papers.pielorz1979.node_motion import (
    Condition,
    Formally,
    NodeMotion,
    PrintedCondition,
    Stated,
    Tabulated,
    case,
)
from wavesym.papers.pielorz1979.signals import Faulty, Place, PrintedSignal, Symbols
from wavesym.papers.record import Case, Claim, Slip


def _single(place: Callable[[int], int]) -> Callable[[int], Iterable[int]]:
    return lambda m: (place(m),)


_LEFT, _RIGHT = _single(lambda m: 0), _single(lambda m: m)


def _inside(m: int) -> range:
    return range(1, m)


def _contacts(m: int) -> range:
    return range(2, m - 1, 2)


def _continuous(y: NodeMotion, i: Place) -> Any:
    return y.t(i) - y.t(i + 1)


def _stiffness(y: NodeMotion, i: Place) -> Any:
    """The A_i of (2.4) for a drive, in units in which B_i is J_i."""
    return y.k[i] * y.J[i]


def _force(y: NodeMotion, body: Place) -> Any:
    """The S of (2.4) for a drive."""
    return y.A(body) * y.J[body] * y.M(body)


def _floor(kappa: Callable[[Place], Place]) -> Condition:
    """(4.5).2 with the kappa of the floor given."""
    return lambda y, i: y.x(i + 1) - y.x(i) - 1 / y.k[kappa(i)] * y.tt(i + 1)


def _first_disc(number: int | None) -> Condition:
    """(4.4).1 with the moment of the disc given."""
    return lambda y, i: y.A(1) * y.M(number) - y.tt(1) + y.k[1] * y.x(1)


def _end(sign: int) -> Condition:
    """(2.4)_5, its moment counted along (1) positive rotation, or against it (-1, as the tables have it)."""
    return lambda y, i: (-sign) * _force(y, y.m + 1) + _stiffness(y, y.m) * y.x(y.m) + y.J[y.m + 1] * y.tt(y.m)


def _last_disc(sign: int) -> Condition:
    """(4.4).4, in the same way."""
    return lambda y, i: (
        (-sign) * y.A(y.m + 1) * y.M(y.m + 1) + y.tt(y.m) + y.k[y.m] * y.J[y.m] / y.J[y.m + 1] * y.x(y.m)
    )


_AGAINST = (
    "With the moment along positive rotation, as in the other lines, it fails; it holds where the moment on the "
    "last body "
    "counts against positive rotation."
)


def _signed(text: str, condition: Callable[[int], Condition]) -> Slip[Stated]:
    return Slip("convention", text, Stated(condition(-1), _RIGHT), _AGAINST)


GENERAL: tuple[PrintedCondition, ...] = (
    PrintedCondition(
        "(2.3)",
        r"\frac{\partial U_i}{\partial t} = \frac{\partial U_{i+1}}{\partial t}, x = il",
        (I, II, III),
        Stated(_continuous, lambda m: range(1, m + 1)),
        None,
        step=1,
        ranges="i = 1, 2, ..., m",
        slip=Slip(
            "misprint",
            "i = 1, 2, ..., m-1",
            Stated(_continuous, _inside),
            "At x = ml there is no rod m+1; (4.3), (4.4), (4.5) have i = 1, ..., m-1.",
        ),
    ),
    PrintedCondition(
        "(2.4).1",
        r"\frac{\partial U_i}{\partial x} = 0",
        (I,),
        Stated(lambda y, i: y.x(1) if i == 0 else y.x(y.m), lambda m: (0, m)),
        None,
        ranges="free ends",
    ),
    PrintedCondition(
        "(2.4).2",
        r"S_i(t) + A_i \frac{\partial U_i}{\partial x} - A_{i-1} \frac{\partial U_{i-1}}{\partial x} "
        r"- B_i \frac{\partial^2 U_i}{\partial t^2} = 0",
        (II,),
        Stated(
            lambda y, i: (
                _force(y, i + 1)
                + _stiffness(y, i + 1) * y.x(i + 1)
                - _stiffness(y, i) * y.x(i)
                - y.J[i + 1] * y.tt(i + 1)
            ),
            _inside,
        ),
        INDEX,
        step=1,
        ranges="bodies between two rods",
    ),
    PrintedCondition(
        "(2.4).3",
        r"A_i \frac{\partial U_i}{\partial x} = A_{i+1} \frac{\partial U_{i+1}}{\partial x}",
        (I,),
        Stated(lambda y, i: y.x(i) - y.x(i + 1), _contacts),
        INDEX,
        step=2,
        ranges="contacts; equal A",
    ),
    PrintedCondition(
        "(2.4).4",
        r"S_i(t) + A_i \frac{\partial U_i}{\partial x} - B_i \frac{\partial^2 U_i}{\partial t^2} = 0",
        (II,),
        Stated(lambda y, i: _force(y, 1) + _stiffness(y, 1) * y.x(1) - y.J[1] * y.tt(1), _LEFT),
        Integer(0),
        ranges="a body at the left end",
    ),
    PrintedCondition(
        "(2.4).5",
        r"S_i(t) + A_i \frac{\partial U_i}{\partial x} + B_i \frac{\partial^2 U_i}{\partial t^2} = 0",
        (II,),
        Stated(_end(1), _RIGHT),
        COUNT,
        ranges="a body at the right end",
        slip=_signed("as printed, S_i(t) counted against the positive direction", _end),
    ),
)

DIMENSIONLESS: tuple[PrintedCondition, ...] = (
    PrintedCondition(
        "(4.3).1",
        r"\frac{\partial \bar{u}_1}{\partial \bar{x}} = 0, \bar{x} = 0",
        (I,),
        Stated(lambda y, i: y.x(1), _LEFT),
        Integer(0),
    ),
    PrintedCondition(
        "(4.3).2",
        r"\frac{\partial \bar{u}_i}{\partial \tau} = \frac{\partial \bar{u}_{i+1}}{\partial \tau}, \bar{x} = i",
        (I,),
        Stated(_continuous, _inside),
        None,
        step=1,
        ranges="i = 1, 2, ..., m-1",
    ),
    PrintedCondition(
        "(4.3).3",
        r"\frac{\partial \bar{u}_i}{\partial \bar{x}} = \frac{\partial \bar{u}_{i+1}}{\partial \bar{x}}, \bar{x} = i",
        (I,),
        Stated(lambda y, i: y.x(i) - y.x(i + 1), _contacts),
        INDEX,
        step=2,
        ranges="i = 2, 4, ..., m-2",
    ),
    PrintedCondition(
        "(4.3).4",
        r"-\frac{\partial \bar{u}_i}{\partial \bar{x}} + \frac{\partial \bar{u}_{i+1}}{\partial \bar{x}} "
        r"- \frac{1}{\kappa_i} \frac{\partial^2 \bar{u}_i}{\partial \tau^2} = 0, \bar{x} = i",
        (I,),
        Stated(lambda y, i: y.x(i + 1) - y.x(i) - 1 / y.k[i] * y.tt(i), lambda m: range(1, m - 2, 2)),
        INDEX,
        ranges="i = 1, 3, ..., m-3",
    ),
    PrintedCondition(
        "(4.3).5",
        r"-\frac{\partial \bar{u}_{m-1}}{\partial \bar{x}} + \frac{\partial \bar{u}_m}{\partial \bar{x}} "
        r"- \frac{1}{\kappa_{m-1}} \frac{\partial^2 \bar{u}_m}{\partial \tau^2} = 0, \bar{x} = m-1",
        (I,),
        Stated(
            lambda y, i: y.x(y.m) - y.x(y.m - 1) - 1 / y.k[y.m - 1] * y.tt(y.m),
            _single(lambda m: m - 1),
        ),
        COUNT - 1,
    ),
    PrintedCondition(
        "(4.3).6",
        r"\frac{\partial \bar{u}_m}{\partial \bar{x}} = 0, \bar{x} = m",
        (I,),
        Stated(lambda y, i: y.x(y.m), _RIGHT),
        COUNT,
    ),
    PrintedCondition(
        "(4.4).1",
        r"\bar{A}_1 \bar{M}(\tau) - \frac{\partial^2 \bar{\theta}_1}{\partial \tau^2} "
        r"+ \kappa_1 \frac{\partial \bar{\theta}_1}{\partial \bar{x}} = 0, \bar{x} = 0",
        (II,),
        Stated(_first_disc(None), _LEFT),
        Integer(0),
        slip=Slip(
            "unreadable",
            r"\bar{M}_1(\tau) for \bar{M}(\tau)",
            Stated(_first_disc(1), _LEFT),
            "The moment has no index; no other moment than the first holds here: beyond doubt.",
        ),
    ),
    PrintedCondition(
        "(4.4).2",
        r"\bar{A}_{i+1} \bar{M}_{i+1}(\tau) + \kappa_{i+1} \frac{\partial \bar{\theta}_{i+1}}{\partial \bar{x}} "
        r"- \kappa_i \frac{J_i}{J_{i+1}} \frac{\partial \bar{\theta}_i}{\partial \bar{x}} "
        r"- \frac{\partial^2 \bar{\theta}_{i+1}}{\partial \tau^2} = 0, \bar{x} = i",
        (II,),
        Stated(
            lambda y, i: (
                y.A(i + 1) * y.M(i + 1) + y.k[i + 1] * y.x(i + 1) - y.k[i] * y.J[i] / y.J[i + 1] * y.x(i) - y.tt(i + 1)
            ),
            _inside,
        ),
        INDEX,
        ranges="i = 1, 2, ..., m-1",
    ),
    PrintedCondition(
        "(4.4).3",
        r"\frac{\partial \bar{\theta}_i}{\partial \tau} = \frac{\partial \bar{\theta}_{i+1}}{\partial \tau}, "
        r"\bar{x} = i",
        (II,),
        Stated(_continuous, _inside),
        None,
        step=1,
        ranges="i = 1, 2, ..., m-1",
    ),
    PrintedCondition(
        "(4.4).4",
        r"\bar{A}_{m+1} \bar{M}_{m+1}(\tau) + \frac{\partial^2 \bar{\theta}_m}{\partial \tau^2} "
        r"+ \kappa_m \frac{J_m}{J_{m+1}} \frac{\partial \bar{\theta}_m}{\partial \bar{x}} = 0, \bar{x} = m",
        (II,),
        Stated(_last_disc(1), _RIGHT),
        COUNT,
        slip=_signed(r"as printed, \bar{M}_{m+1} counted against positive rotation", _last_disc),
    ),
    PrintedCondition(
        "(4.5).2",
        r"\frac{\partial \bar{y}_{i+1}}{\partial \bar{x}} - \frac{\partial \bar{y}_i}{\partial \bar{x}} "
        r"- \frac{1}{\kappa_1} \frac{\partial^2 \bar{y}_{i+1}}{\partial \tau^2} = 0, \bar{x} = i",
        (III,),
        Stated(_floor(lambda i: 1), _inside),
        INDEX,
        ranges="i = 1, 2, ..., m-1",
        slip=Slip(
            "convention",
            r"as printed, with equal floors: \kappa_i = \kappa_1",
            Stated(_floor(lambda i: i), _inside),
            "With unequal floors kappa_i must stand for kappa_1; the text numbers the floors M_1, ..., M_(m-1), "
            "but gives "
            "kappa for i = 0, 1, m only.",
        ),
    ),
    PrintedCondition(
        "(4.5).3",
        r"\frac{\partial \bar{y}_i}{\partial \tau} = \frac{\partial \bar{y}_{i+1}}{\partial \tau}, \bar{x} = i",
        (III,),
        Stated(_continuous, _inside),
        None,
        step=1,
        ranges="i = 1, 2, ..., m-1",
    ),
    PrintedCondition(
        "(4.5).4",
        r"\frac{\partial \bar{y}_m}{\partial \bar{x}} + \frac{1}{\kappa_m} \frac{\partial^2 \bar{y}_m}{\partial "
        r"\tau^2} "
        r"= 0, \bar{x} = m",
        (III,),
        Stated(lambda y, i: y.x(y.m) + 1 / y.k[y.m] * y.tt(y.m), _RIGHT),
        COUNT,
    ),
)


def claims() -> Iterator[Claim[Any]]:
    """The conditions, the base of the building in its place."""
    for printed in (*GENERAL, *DIMENSIONLESS):
        if printed.id == "(4.5).2":
            yield _base()
        yield _claim(printed)


def _claim(printed: PrintedCondition) -> Claim[Stated]:
    slip = printed.slip
    right = slip.reading if slip else printed.stated
    line = printed.id.removeprefix("(")
    return Claim(
        printed.id,
        f"section {line[0]}, ({line}",
        printed.text,
        printed.ranges,
        "exact tables with all parameters different"
        + (", and the node for symbolic i and m" if printed.place is not None else ""),
        partial(_cases, printed.examples),
        printed.stated,
        dict(_faults(printed, right)),
        slip,
        partial(_difference, printed) if printed.place is not None else None,
    )


def _cases(examples: Iterable[Example], stated: Stated) -> Iterator[Case]:
    for example in examples:
        for m in example.sizes:
            table = example.tables(m)
            for i in stated.span(m):
                for source in table.responses:
                    yield case(table, source, stated.condition, i)


def _faults(printed: PrintedCondition, right: Stated) -> Iterator[tuple[str, Stated]]:
    if printed.step:
        longer = replace(right, span=lambda m: [*right.span(m), *[max(right.span(m), default=0) + printed.step]])
        yield "range one longer", longer
    for name, factor, late in (("sign", -1, 0), ("factor", 2, 0), ("lag", 1, 1)):
        for nth in (1, 2):

            def faulty(y: Tabulated, i: int, nth: int = nth, factor: int = factor, late: int = late) -> PrintedSignal:
                wrong = Tabulated(Faulty(y.waves, nth, factor, late), y._table, i)
                result: PrintedSignal = right.condition(wrong, i)
                return result

            yield f"{name} of term {nth}", replace(right, condition=faulty)


def _difference(printed: PrintedCondition, stated: Stated) -> str:
    """Printed less derived for symbolic i and m, both scaled to the same strain (contact: velocity)."""
    mine: Line = stated.condition(Formally(Symbols()), printed.place).line
    return line_text(_scaled(mine) - _scaled(_balance(_node(printed), printed.place)))


def _node(printed: PrintedCondition) -> Node:
    families = printed.examples[0].system.families(COUNT, SYMBOLS)
    place = exact(printed.place)
    alone = [f for f in families if exact(f.first - f.last) == 0 and exact(f.first - place) == 0]
    first = min(printed.stated.span(8))
    family = next(iter(alone), None) or next(
        f for f in families if exact(f.first - f.last) != 0 and (f.first - first) % 2 in (0, f.step % 2)
    )
    return family.at(place)


def _balance(node: Node, x: Place) -> Line:
    """The node's own condition, (2.4) as `Node` has it."""
    y = Formally(Symbols())
    left, right = exact(x), exact(x) + 1
    line = (-node.inertia) * y.tt(right if node.right else left)
    if node.right:
        line = line + Rational(1, 2) * exact(node.beta) * y.x(right)
    if node.left:
        line = line - Rational(1, 2) * exact(node.alpha) * y.x(left)
    for unit in node.loads:
        for power, value in enumerate(unit.coefficients):
            line = line + value * y.waves.load(unit.kind, unit.number, 0, power)
    result: Line = line.line
    return result


def _scaled(line: Line) -> Line:
    """With factor 1 at the last strain, and the acceleration of either rod as that of the node."""
    strain = max((w for w in line.waves if w.function == "U_x"), key=lambda w: str(w.rod - INDEX))
    joined = Line({}, line.loads)
    for wave, operator in line.waves.items():
        name = wave if wave.function == "U_x" else Wave("U_t", Integer(0), Integer(0))
        joined = joined + Line({name: operator})
    return joined.scaled(1 / line.waves[strain].b)


def _base() -> Claim[str]:
    """(4.5).1: as mathematics the base of the tables, but not what the text says of the foundation."""
    return Claim(
        "(4.5).1",
        "section 4, (4.5).1",
        r"\frac{\partial \bar{y}_i}{\partial \bar{x}} - \frac{1}{\kappa_0} \sum_{k=0}^{m_i} H(\tau - \tau_k) "
        r"[a_k + b_k(\tau - \tau_k)] = 0, \bar{x} = 0",
        "i = 1, the only rod at x = 0",
        "the prose before (3.2): all points of the foundation have the acceleration of the ground",
        _foundation_cases,
        "force",
        {"the printed base": "force"},
        Slip(
            "model",
            r"\frac{\partial \bar{y}_1}{\partial \tau} = \int_0^\tau \ddot{\bar{y}}_0 d\tau, \bar{x} = 0",
            "ground",
            "The line balances the foundation's inertia against the columns; the foundation itself then moves "
            "otherwise.",
        ),
        mathematics=_strain_cases,
        note="The index i at x = 0 can only be 1, and m_i is the m_1 of (3.2).",
    )


def _foundation_cases(base: str) -> Iterator[Case]:
    for m in range(2, 6):
        table = {"force": uneven_building, "ground": grounded_building}[base](m)
        for source in table.responses:
            yield case(table, source, lambda y, i: y.tt(1) - y.base, 0)


def _strain_cases(_: str) -> Iterator[Case]:
    for m in range(2, 6):
        table = uneven_building(m)
        for source in table.responses:
            yield case(table, source, lambda y, i: y.x(1) - 1 / y.k[0] * y.base, 0)
