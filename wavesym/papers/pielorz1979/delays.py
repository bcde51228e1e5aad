"""(4.6), (4.7), (4.8): the delay equations, on the tables and against the derived ones for symbolic i and m."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

from sympy import Expr, latex

from wavesym.derivation.delay import COUNT, INDEX, DelayEquation, delay_equations
from wavesym.derivation.delay_terms import Line, Operator, Wave, exact
from wavesym.model.node import System
from wavesym.papers.exact_tables import Exact, collision, drive, uneven_building
from wavesym.papers.pielorz1979.signals import Formula, Numbers, Place, Symbols, Waves, faults, residual_case
from wavesym.papers.record import Case, Claim, Slip
from wavesym.systems.building import BUILDING_FORCE
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE


@dataclass(frozen=True)
class Example:
    """An example: its derivation, its tables, and the m that they are made for."""

    system: System
    tables: Callable[[int], Exact]
    sizes: range


I = Example(COLLISION, collision, range(4, 11, 2))  # noqa: E741 - the paper's number
II = Example(DRIVE, drive, range(1, 6))
III = Example(BUILDING_FORCE, uneven_building, range(2, 7))


@dataclass(frozen=True)
class PrintedEquation:
    """A printed equation: its text, its range of i, left less right side, how many waves and loads that has.

    `derived` names the derived equations (function, rod, first i) it is to be, `through` those to be put into them;
    `pieces` are the pieces of the load, number k of 0, ..., k, that it is tried on.
    """

    id: str
    text: str
    example: Example
    span: Callable[[int], Iterable[int]]
    formula: Formula
    terms: int
    derived: tuple[tuple[str, Place, Place], ...]
    through: tuple[tuple[str, int], ...] = ()
    ranges: str = ""
    pieces: tuple[int, ...] = (0,)
    slip: Slip[Formula] | None = None


def _ratio(w: Waves, i: Place) -> Place:
    """kappa_(i-1) J_(i-1) / J_i."""
    return w.k[i - 1] * w.J[i - 1] / w.J[i]


def _alone(i: Callable[[int], int]) -> Callable[[int], Iterable[int]]:
    return lambda m: (i(m),)


_FIRST, _LAST = _alone(lambda m: 1), _alone(lambda m: m)


def _foot(floor: Callable[[Place], Place]) -> Formula:
    """(4.8).5, with 2 kappa of the floor given."""
    return lambda w, i: w.f(i).d + 2 * w.k[floor(i)] * w.f(i) + w.g(i).d - 2 * w.k[floor(i)] * w.f(i - 1)


def _last_shaft(limit: Callable[[Place, Place], Place]) -> Formula:
    """(4.7).2, with the upper limit of its sum, a function of m and m_(m+1)."""
    return lambda w, i: (
        w.g(w.m).d
        + _ratio(w, w.m + 1) * w.g(w.m)
        + w.A(w.m + 1) * w.M(w.m + 1, 1, limit(w.m, w.piece))
        + w.f(w.m, 2).d
        - _ratio(w, w.m + 1) * w.f(w.m, 2)
    )


EQUATIONS: tuple[PrintedEquation, ...] = (
    PrintedEquation(
        "(4.6).1",
        "f'_1(z) = g'_1(z-2), g'_m(z) = f'_m(z-2)",
        I,
        lambda m: (1, m),
        lambda w, i: w.f(1) - w.g(1, 2) if i == 1 else w.g(w.m) - w.f(w.m, 2),
        2,
        (("f", 1, 1), ("g", COUNT, COUNT)),
    ),
    PrintedEquation(
        "(4.6).2",
        r"g''_1(z) + 2\kappa_1 g'_1(z) = -g''_1(z-2) + 2\kappa_1 g'_2(z)",
        I,
        _FIRST,
        lambda w, i: w.g(1).d + 2 * w.k[1] * w.g(1) + w.g(1, 2).d - 2 * w.k[1] * w.g(2),
        4,
        (("g", 1, 1),),
    ),
    PrintedEquation(
        "(4.6).3",
        r"g''_i(z) + 2\kappa_i g'_i(z) = -f''_i(z-2) + 2\kappa_i g'_{i+1}(z-2)",
        I,
        lambda m: range(3, m - 2, 2),
        lambda w, i: w.g(i).d + 2 * w.k[i] * w.g(i) + w.f(i, 2).d - 2 * w.k[i] * w.g(i + 1, 2),
        4,
        (("g", INDEX, 3),),
        ranges="i = 3, 5, ..., m-3",
    ),
    PrintedEquation(
        "(4.6).4",
        "g'_{m-1}(z) = -f'_{m-1}(z-2) + f'_m(z-2) + f'_m(z-4)",
        I,
        _LAST,
        lambda w, i: w.g(w.m - 1) + w.f(w.m - 1, 2) - w.f(w.m, 2) - w.f(w.m, 4),
        4,
        (("g", COUNT - 1, COUNT - 1),),
    ),
    PrintedEquation(
        "(4.6).5",
        r"g'_i(z) = -\frac{\bar{v}_{i-1} - \bar{v}_{i+1}}{2} + g'_{i+1}(z)",
        I,
        lambda m: range(2, m - 1, 2),
        lambda w, i: w.g(i) + w.constant((w.v[i - 1] - w.v[i + 1]) / 2) - w.g(i + 1),
        3,
        (("g", INDEX, 2),),
        ranges="i = 2, 4, ..., m-2",
    ),
    PrintedEquation(
        "(4.6).6",
        "f'_2(z) = g'_1(z-2) - g'_2(z-2) + g'_1(z-4)",
        I,
        _FIRST,
        lambda w, i: w.f(2) - w.g(1, 2) + w.g(2, 2) - w.g(1, 4),
        4,
        (("f", 2, 2),),
    ),
    PrintedEquation(
        "(4.6).7",
        "f'_i(z) = g'_{i-1}(z) + f'_{i-1}(z-2) - g'_i(z-2)",
        I,
        lambda m: range(4, m - 1, 2),
        lambda w, i: w.f(i) - w.g(i - 1) - w.f(i - 1, 2) + w.g(i, 2),
        4,
        (("f", INDEX, 4),),
        ranges="i = 4, 6, ..., m-2",
    ),
    PrintedEquation(
        "(4.6).8",
        r"f'_i(z) = \frac{\bar{v}_{i-2} - \bar{v}_i}{2} + f'_{i-1}(z)",
        I,
        lambda m: range(3, m, 2),
        lambda w, i: w.f(i) - w.constant((w.v[i - 2] - w.v[i]) / 2) - w.f(i - 1),
        3,
        (("f", INDEX, 3),),
        ranges="i = 3, 5, ..., m-1",
    ),
    PrintedEquation(
        "(4.6).9",
        r"f''_m(z) + 2\kappa_{m-1} f'_m(z) = -f''_m(z-2) + 2\kappa_{m-1} f'_{m-1}(z)",
        I,
        _LAST,
        lambda w, i: w.f(w.m).d + 2 * w.k[w.m - 1] * w.f(w.m) + w.f(w.m, 2).d - 2 * w.k[w.m - 1] * w.f(w.m - 1),
        4,
        (("f", COUNT, COUNT),),
    ),
    PrintedEquation(
        "(4.7).1",
        "g'_i(z) = -f'_i(z-2) + f'_{i+1}(z-1) + g'_{i+1}(z-1)",
        II,
        lambda m: range(1, m),
        lambda w, i: w.g(i) + w.f(i, 2) - w.f(i + 1, 1) - w.g(i + 1, 1),
        4,
        (("g", INDEX, 1),),
        ranges="i = 1, 2, ..., m-1",
    ),
    PrintedEquation(
        "(4.7).2",
        r"g''_m(z) + \kappa_m \frac{J_m}{J_{m+1}} g'_m(z) = -\bar{A}_{m+1} \sum_{k=0}^{m+1} \bar{M}_{m+1, k} "
        r"H(z-1-\tau_{m+1, k}) - f''_m(z-2) + \kappa_m \frac{J_m}{J_{m+1}} f'_m(z-2)",
        II,
        _LAST,
        _last_shaft(lambda m, last: m + 1),
        5,
        (("g", COUNT, COUNT),),
        pieces=(0, 3, 9),
        slip=Slip(
            "misprint",
            r"\sum_{k=0}^{m_{m+1}} for \sum_{k=0}^{m+1}",
            _last_shaft(lambda m, last: last),
            "The number of steps of the last moment has nothing to do with m; (3.1) and (4.7).3 have m_i. The "
            "moment counts "
            "against positive rotation, as in (4.4).4.",
        ),
    ),
    PrintedEquation(
        "(4.7).3",
        r"f_1''(z) + \kappa_1 f_1'(z) = \bar{A}_1 \sum_{k=0}^{m_1} \bar{M}_{1,k} H(z - \tau_{1,k}) - g_1''(z) "
        r"+ \kappa_1 g_1'(z)",
        II,
        _FIRST,
        lambda w, i: w.f(1).d + w.k[1] * w.f(1) - w.A(1) * w.M(1) + w.g(1).d - w.k[1] * w.g(1),
        5,
        (("f", 1, 1),),
    ),
    PrintedEquation(
        "(4.7).4",
        r"f_i''(z) + \left(\kappa_i + \kappa_{i-1} \frac{J_{i-1}}{J_i}\right) f_i'(z) = \bar{A}_i \sum_{k=0}^{m_i} "
        r"\bar{M}_{i,k} H(z - \tau_{i,k}) - g_i''(z) + \left(\kappa_i - \kappa_{i-1} \frac{J_{i-1}}{J_i}\right) "
        r"g_i'(z) "
        r"+ 2\kappa_{i-1} \frac{J_{i-1}}{J_i} f_{i-1}'(z-1)",
        II,
        lambda m: range(2, m + 1),
        lambda w, i: (
            w.f(i).d
            + (w.k[i] + _ratio(w, i)) * w.f(i)
            - w.A(i) * w.M(i)
            + w.g(i).d
            - (w.k[i] - _ratio(w, i)) * w.g(i)
            - 2 * _ratio(w, i) * w.f(i - 1, 1)
        ),
        6,
        (("f", INDEX, 2),),
        ranges="i = 2, 3, ..., m",
    ),
    PrintedEquation(
        "(4.8).1",
        "g_1'(z) = f_2'(z-2) + g_2'(z-2) - f_1'(z-2)",
        III,
        _FIRST,
        lambda w, i: w.g(1) - w.f(2, 2) - w.g(2, 2) + w.f(1, 2),
        4,
        (("g", 1, 1),),
    ),
    PrintedEquation(
        "(4.8).2",
        r"f_1'(z) = f_2'(z-2) + g_2'(z-2) - f_1'(z-2) - \frac{1}{\kappa_0} \sum_{k=0}^{m_1} H(z - \tau_k) "
        r"[\bar{a}_k + \bar{b}_k(z - \tau_k)]",
        III,
        _FIRST,
        lambda w, i: w.f(1) - w.f(2, 2) - w.g(2, 2) + w.f(1, 2) + 1 / w.k[0] * w.base,
        6,
        (("f", 1, 1),),
        through=(("g", 1),),
    ),
    PrintedEquation(
        "(4.8).3",
        "g_i'(z) = f_{i+1}'(z-2) + g_{i+1}'(z-2) - f_i'(z-2)",
        III,
        lambda m: range(2, m),
        lambda w, i: w.g(i) - w.f(i + 1, 2) - w.g(i + 1, 2) + w.f(i, 2),
        4,
        (("g", INDEX, 1),),
        ranges="i = 2, 3, ..., m-1",
    ),
    PrintedEquation(
        "(4.8).4",
        r"g_m''(z) + \kappa_m g_m'(z) = -f_m''(z-2) + \kappa_m f_m'(z-2)",
        III,
        _LAST,
        lambda w, i: w.g(w.m).d + w.k[w.m] * w.g(w.m) + w.f(w.m, 2).d - w.k[w.m] * w.f(w.m, 2),
        4,
        (("g", COUNT, COUNT),),
    ),
    PrintedEquation(
        "(4.8).5",
        r"f_i''(z) + 2\kappa_i f_i'(z) = -g_i''(z) + 2\kappa_i f_{i-1}'(z)",
        III,
        lambda m: range(2, m + 1),
        _foot(lambda i: i),
        4,
        (("f", INDEX, 2),),
        ranges="i = 2, 3, ..., m",
        slip=Slip(
            "misprint",
            r"f_i''(z) + 2\kappa_{i-1} f_i'(z) = -g_i''(z) + 2\kappa_{i-1} f_{i-1}'(z)",
            _foot(lambda i: i - 1),
            "The floor at the foot of storey i is number i-1; with equal floors this is kappa_1 for every i, and "
            "for i = m "
            "the printed kappa_m is the roof's.",
        ),
    ),
)


def claims() -> Iterator[Claim[Formula]]:
    """The lines of (4.6), (4.7), (4.8)."""
    for printed in EQUATIONS:
        slip = printed.slip
        right = slip.reading if slip else printed.formula
        sizes = printed.example.sizes
        yield Claim(
            printed.id,
            f"section 4, {printed.id[:5]}, line {printed.id[6:]}",
            printed.text,
            printed.ranges,
            f"exact tables with all parameters different, m = {sizes[0]} ... {sizes[-1]}; the derived equation for "
            f"symbolic "
            "i and m",
            _tried(printed),
            printed.formula,
            faults(right, printed.terms),
            slip,
            _minus_derived(printed) if printed.pieces == (0,) else None,
        )


def _tried(printed: PrintedEquation) -> Callable[[Formula], Iterator[Case]]:
    def cases(formula: Formula) -> Iterator[Case]:
        for m in printed.example.sizes:
            table = printed.example.tables(m)
            for i in printed.span(m):
                for source in table.responses:
                    for piece in printed.pieces:
                        yield residual_case(Numbers(table, source, piece), formula, i)

    return cases


def _minus_derived(printed: PrintedEquation) -> Callable[[Formula], str]:
    """Printed less derived, both as left less right side, for symbolic i and m."""

    def difference(formula: Formula) -> str:
        lines = []
        for name in printed.derived:
            line = formula(Symbols(), name[1]).line - _derived(printed.example.system, name, printed.through)
            lines.append(line_text(line))
        return "; ".join(line for line in lines if line != "0") or "0"

    return difference


def _derived(system: System, name: tuple[str, Place, Place], through: tuple[tuple[str, int], ...]) -> Line:
    right = _equation(system, *name)
    line = right.right
    for letter, rod in through:
        line = line.substituted(letter, exact(rod), _equation(system, letter, rod, rod).right)
    return Line({Wave(name[0], exact(name[1]), exact(0)): right.own}) - line


def _equation(system: System, letter: str, rod: Place, first: Place) -> DelayEquation:
    """The derived equation of a rod; where only a range of rods has one, that of its first."""
    mine = [e for e in delay_equations(system) if e.function == letter and exact(e.first - exact(first)) == 0]
    equation = next(e for e in mine if e.rod in (exact(rod), INDEX))
    if equation.rod == exact(rod):
        return equation
    a, b = equation.own
    return replace(
        equation, right=equation.right.renumbered(INDEX, exact(rod)), own=Operator(a, exact(b.subs(INDEX, exact(rod))))
    )


def line_text(line: Line) -> str:
    """A line as mathematics."""
    parts = []
    for wave, (a, b) in line.waves.items():
        for order, factor in (("''", a), ("'", b)):
            if factor != 0:
                lag = "z" if wave.lag == 0 else f"z-{latex(wave.lag)}"
                parts.append(f"{_factor(factor)} {wave.function}{order}_{{{latex(wave.rod)}}}({lag})")
    for source, value in line.loads.items():
        number = "" if source.number is None else f"_{{{latex(source.number)}}}"
        parts.append(f"{_factor(value)} {source.kind}{number}")
    return " + ".join(parts) or "0"


def _factor(expression: Expr) -> str:
    return f"({latex(expression)})"
