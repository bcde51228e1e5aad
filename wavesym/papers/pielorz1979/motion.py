"""(2.1), (2.2), (2.5), (3.1), (3.2), (4.1), (4.2), and the constants kappa and A that stand under (4.3)-(4.5)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from flint import fmpq, fmpq_poly
from sympy import Symbol, latex

from wavesym.exact.increments import start
from wavesym.numbers.doubles import rational
from wavesym.papers.exact_tables import Exact
from wavesym.papers.pielorz1979.conditions import DIMENSIONLESS
from wavesym.papers.pielorz1979.delays import II, III, I
from wavesym.papers.pielorz1979.node_motion import Ansatz, case, lags
from wavesym.papers.record import Case, Claim, Slip
from wavesym.scene import Scene

Physical = Mapping[str, fmpq]
Constant = Callable[[Any], Any]

# numbers for the quantities of the text; p is none of them
PHYSICAL: Physical = {
    name: fmpq(numerator, denominator)
    for name, numerator, denominator in (
        ("E", 7, 3), ("G", 5, 4), ("rho", 11, 6), ("F", 3, 8), ("A", 2, 9), ("l", 13, 5), ("M_i", 17, 7),
        ("J_i", 19, 10), ("J_0i", 4, 15), ("n", 4, 1), ("k'", 5, 6), ("p", 23, 12),
    )
}  # fmt: skip
PHYSICAL = {**PHYSICAL, "J_01": PHYSICAL["J_0i"]}
# stiffness of a rod, inertia of a body, density; of examples I, II, III
STIFFNESS: Mapping[str, Constant] = {
    "I": lambda q: q["E"] * q["F"],
    "II": lambda q: q["G"] * q["J_0i"],
    "III": lambda q: q["n"] * q["k'"] * q["G"] * q["A"],
}
SPEED: Mapping[str, tuple[str, Constant]] = {
    "I": (r"\frac{E}{\rho} = a^2", lambda q: q["E"] / q["rho"]),
    "II": (r"\frac{G}{\rho} = C^2", lambda q: q["G"] / q["rho"]),
    "III": (r"\frac{k'G}{\rho} = C^2", lambda q: q["k'"] * q["G"] / q["rho"]),
}
KAPPA: Mapping[str, Constant] = {
    "I": lambda q: q["F"] * q["rho"] * q["l"] / q["M_i"],
    "II": lambda q: q["J_0i"] * q["rho"] * q["l"] / q["J_i"],
    "III": lambda q: q["n"] * q["A"] * q["rho"] * q["l"] / q["M_i"],
}


def claims() -> Iterator[Claim[Any]]:
    """The equations of motion, their solution, the loads and the constants."""
    yield from _equations()
    yield from _loads()
    yield from _without_dimensions()
    yield from _constants()


def _equations() -> Iterator[Claim[Any]]:
    yield Claim(
        "(2.1)",
        "section 2, (2.1)",
        r"\frac{\partial^2 U_i}{\partial t^2} - c_f \frac{\partial^2 U}{\partial x^2} = 0",
        "(i-1)l < x < il, i = 1, 2, ..., m",
        "(2.5): the second derivatives of F_i(c_f t - x) and G_i(c_f t + x)",
        _speeds,
        lambda c: c,
        {"c_f^3": lambda c: c**3, "sign": lambda c: -(c**2)},
        Slip(
            "misprint",
            r"\frac{\partial^2 U_i}{\partial t^2} - c_f^2 \frac{\partial^2 U_i}{\partial x^2} = 0",
            lambda c: c**2,
            "The square is missing (Table 1 gives c_f^2), and an index i.",
        ),
        _speed_difference,
    )
    yield Claim(
        "(2.2)",
        "section 2, (2.2)",
        r"U_i(x, 0) = 0, \left. \frac{\partial U_i}{\partial t} \right|_{t=0} = v_i",
        "(i-1)l < x < il",
        "(4.2) with the exact tables at tau = 0 inside every rod",
        _starts,
        (fmpq(0), fmpq(1)),
        {"v_i twice": (fmpq(0), fmpq(2)), "U_i = 1": (fmpq(1), fmpq(1))},
    )
    yield Claim(
        "(2.5)",
        "section 2, (2.5)",
        r"U_i = \mathcal{F}_i(c_f(t - t_{0i}) - x + x_{0i}) + \mathcal{G}_i(c_f(t - t_0) + x - x_{0i}) + v_i t",
        "i = 1, 2, ..., m",
        "(4.2) and the clocks of the examples: t_0 in G as a constant of all rods",
        _clocks,
        lambda table, rod: table.chain.rod(1).tau0,
        {"t_(0,i+1)": lambda table, rod: table.chain.rod(min(rod + 1, table.m)).tau0},
        Slip(
            "unreadable",
            r"\mathcal{G}_i(c_f(t - t_{0i}) + x - x_{0i})",
            lambda table, rod: table.chain.rod(rod).tau0,
            "t_0 without i is not defined; (4.2) has tau_(0,i) in both: beyond doubt.",
        ),
    )


def _loads() -> Iterator[Claim[Any]]:
    yield _load(
        "(3.1)",
        r"M_i(t) = \sum_{k=0}^{m_i} M_{i,k} H(t-t_{i,k})",
        "i = 1, 2, ..., m+1",
        Scene(
            name="moments",
            system={"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 1]},
            load=[{"body": 1, "times": [0, "1/2", 2], "steps": [1, "-1/3", "2/5"]}],
            output={"until": 3, "strain": [0]},
        ),
        lambda k, t: k["steps"] * _heaviside(t - k["times"]),
        {
            "H turned": lambda k, t: k["steps"] * _heaviside(k["times"] - t),
            "sign": lambda k, t: -k["steps"] * _heaviside(t - k["times"]),
            "H(0) = 0": lambda k, t: k["steps"] * (t > k["times"]),
        },
        None,
    )
    yield _load(
        "(3.2)",
        r"\ddot{y}_{0jI} = \sum_{k=0}^{m_1} [a_k + b_k (t - t_k)] H(t - t_k)",
        "",
        Scene(
            name="quake",
            system={"type": "building", "m": 2, "kappa": [1, 1, 1], "base": "force"},
            load=[{"times": [0, "1/2", 2], "a": [1, "-1/3", 0], "b": ["2/5", "1/7", -1]}],
            output={"until": 3, "strain": ["1/2"]},
        ),
        lambda k, t: (k["a"] + k["b"] * (t - k["times"])) * _heaviside(t - k["times"]),
        {
            "sign of t_k": lambda k, t: (k["a"] + k["b"] * (t + k["times"])) * _heaviside(t - k["times"]),
            "sign of b_k": lambda k, t: (k["a"] - k["b"] * (t - k["times"])) * _heaviside(t - k["times"]),
        },
        "The index of the left side cannot be read, and the symbol does not occur again; the acceleration of the "
        "foundation "
        "is meant, likely \\ddot{y}_0. The right side holds.",
    )


def _without_dimensions() -> Iterator[Claim[Any]]:
    yield Claim(
        "(4.1)",
        "section 4, (4.1)",
        r"\frac{\partial^2 \bar{U}_i}{\partial \tau^2} - \frac{\partial^2 \bar{U}_i}{\partial \bar{x}^2} = 0",
        r"i-1 < \bar{x} < i",
        "(2.1) as corrected with x = l x', t = l tau / c_f, for several c_f and l",
        _scaled,
        fmpq(-1),
        {"sign": fmpq(1), "factor": fmpq(-2)},
    )
    yield Claim(
        "(4.2)",
        "section 4, (4.2)",
        r"\bar{U}_i = f_i(\tau - \tau_{0,i} - \bar{x} + \bar{x}_{0,i}) + g_i(\tau - \tau_{0,i} + \bar{x} - "
        r"\bar{x}_{0,i}) "
        r"+ \bar{v}_i \tau",
        "i = 1, 2, ..., m",
        "every condition (4.3)-(4.5), corrected, on the exact tables",
        _solution,
        lags,
        {
            "x turned": lambda rod, x: (rod.tau0 - x + rod.x0, rod.tau0 + x - rod.x0),
            "without tau_0": lambda rod, x: (x - rod.x0, rod.x0 - x),
            "sign of x_0": lambda rod, x: (rod.tau0 + x + rod.x0, rod.tau0 - x - rod.x0),
        },
    )


def _constants() -> Iterator[Claim[Any]]:
    yield _kappa("(4.3).kappa", "I", r"\kappa_i = \frac{Fpl}{M_i}", "i = 1, 3, ..., m-1", _with_p(KAPPA["I"]))
    yield _kappa("(4.4).kappa", "II", r"\kappa_i = \frac{J_{0i} \rho l}{J_i}", "i = 1, ..., m", None)
    yield Claim(
        "(4.4).A",
        "section 4, under (4.4)",
        r"\bar{A}_i = \frac{G J_i l}{J_i c^2}",
        "i = 1, ..., m+1",
        "J_i theta_tt = M_i made dimensionless, with the unit of moment S_0 = G J_01 theta_0 / l",
        lambda value: iter([Case(dict(PHYSICAL), value(PHYSICAL), _moment_unit(PHYSICAL))]),
        lambda q: q["G"] * q["J_i"] * q["l"] / (q["J_i"] * _c2("II", q)),
        {
            "c for c^2": lambda q: q["G"] * q["J_01"] * q["l"] / q["J_i"],
            "no l": lambda q: q["G"] * q["J_01"] / q["J_i"],
        },
        Slip(
            "unreadable",
            r"\bar{A}_i = \frac{G J_{01} l}{J_i c^2}",
            lambda q: q["G"] * q["J_01"] * q["l"] / (q["J_i"] * _c2("II", q)),
            "J_i would cancel. Likely: the unit of moment is not in the text; with S_0 = G J_01 theta_0 / l the "
            "formula has "
            "J_01 in the numerator.",
        ),
    )
    yield _kappa("(4.5).kappa", "III", r"\kappa = \frac{n A p l}{M_i}", "i = 0, 1, m; n columns", _with_p(KAPPA["III"]))


def _speeds(factor: Constant) -> Iterator[Case]:
    for c in (fmpq(2), fmpq(3), fmpq(1, 2)):
        for wave in ("F_i(c_f t - x)", "G_i(c_f t + x)"):
            yield Case({"c_f": c, "wave": wave}, factor(c), c**2)


def _speed_difference(factor: Constant) -> str:
    c = Symbol("c_f")
    left = (c**2 - factor(c)).expand()
    return "0" if left == 0 else rf"({latex(left)}) \frac{{\partial^2 U_i}}{{\partial x^2}}"


def _starts(printed: tuple[fmpq, fmpq]) -> Iterator[Case]:
    """What f and g have gained at tau = 0 where their arguments are positive, and the velocity with it."""
    for example in (I, II, III):
        for m in example.sizes:
            table = example.tables(m)
            for source in table.responses:
                for rod in range(1, m + 1):
                    clock = table.chain.rod(rod)
                    late = dict(zip("fg", map(min, *(lags(clock, x) for x in (rod - 1, rod))), strict=True))
                    gained = sum(
                        (start(table.increment(source, a, rod, 1)) for a, lag in late.items() if lag < 0), fmpq(0)
                    )
                    velocity = fmpq(clock.velocity)
                    yield Case(
                        {"m": m, "i": rod, "source": source},
                        (printed[0], printed[1] * velocity),
                        (gained, velocity + gained),
                        telling=velocity != 0 or min(late.values()) < 0,
                    )


def _clocks(late: Callable[[Exact, int], int]) -> Iterator[Case]:
    for name, example in (("I", I), ("II", II), ("III", III)):
        for m in example.sizes:
            table = example.tables(m)
            for rod in range(1, m + 1):
                yield Case({"example": name, "m": m, "i": rod}, late(table, rod), table.chain.rod(rod).tau0)


def _load(
    id: str,
    text: str,
    ranges: str,
    scene: Scene,
    term: Callable[[Mapping[str, fmpq], fmpq], Any],
    faults: Mapping[str, Callable[[Mapping[str, fmpq], fmpq], Any]],
    garbled: str | None,
) -> Claim[Any]:
    """A load as the sum of what its pieces give: against the unit loads of the node."""

    def cases(reading: tuple[str, Callable[[Mapping[str, fmpq], fmpq], Any]]) -> Iterator[Case]:
        name, term = reading
        yield Case({"left side": name}, "j" in name, False, telling=False)
        table = scene.load[0]
        columns = {
            key: [rational(v) for v in getattr(table, key)]
            for key in ("times", "steps", "a", "b")
            if hasattr(table, key)
        }
        for quarter in range(13):
            t = fmpq(quarter, 4)
            rows = (dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True))
            yield Case({"t": t}, sum((term(row, t) for row in rows), fmpq(0)), _node_load(scene, t))

    left = text.split(" = ")[0]
    right = (r"\ddot{y}_0", term) if garbled else (left, term)
    return Claim(
        id,
        f"section 3, {id}",
        text,
        ranges,
        "the unit loads of the node, right-hand limits",
        cases,
        (left, term),
        {name: (right[0], fault) for name, fault in faults.items()},
        Slip("unreadable", text.replace(left, right[0]), right, garbled) if garbled else None,
    )


def _heaviside(t: fmpq) -> int:
    return int(t >= 0)


def _node_load(scene: Scene, t: fmpq) -> fmpq:
    """What acts on node 0 at t, in units of what a unit of the first kind gives."""
    units = {u.source: fmpq_poly(list(u.coefficients)) for u in scene.system.chain.nodes[0].loads}
    unit = next(iter(units.values()))(fmpq(0))
    total = fmpq(0)
    for load in scene.load:
        for part in load.units():
            if part.time <= t:
                total += part.weight * units[part.source](t - part.time) / unit
    return total


def _scaled(factor: fmpq) -> Iterator[Case]:
    """U_tt - c^2 U_xx = (c^2 / l^2) (U_tautau + factor U_x'x')."""
    for c, l in ((fmpq(2), fmpq(3)), (fmpq(5, 2), fmpq(1, 7))):  # noqa: E741 - the paper's letter
        yield Case({"c_f": c, "l": l}, factor * c**2 / l**2, -(c**2) / l**2)


def _solution(ansatz: Ansatz) -> Iterator[Case]:
    for printed in DIMENSIONLESS:
        stated = printed.slip.reading if printed.slip else printed.stated
        for m in printed.examples[0].sizes:
            table = printed.examples[0].tables(m)
            for i in stated.span(m):
                for source in table.responses:
                    found = case(table, source, stated.condition, i, ansatz)
                    yield Case({"condition": printed.id, **found.at}, found.printed, found.true, found.telling)


def _c2(example: str, q: Physical) -> fmpq:
    return SPEED[example][1](q)  # type: ignore[no-any-return]


def _moment_unit(q: Physical) -> fmpq:
    """S_0 l^2 / (J_i c^2 theta_0) with S_0 = G J_01 theta_0 / l."""
    return q["G"] * q["J_01"] / q["l"] * q["l"] ** 2 / (q["J_i"] * _c2("II", q))


def _with_p(kappa: Constant) -> Constant:
    """The scan's p, which is no quantity of the text, for the density."""
    return lambda q: kappa({**q, "rho": q["p"]})


def _kappa(id: str, example: str, text: str, ranges: str, scanned: Constant | None) -> Claim[Constant]:
    """kappa = stiffness l / (inertia c_f^2): what (2.4) becomes without dimensions."""
    inertia = "J_i" if example == "II" else "M_i"
    right = KAPPA[example]

    def cases(value: Constant) -> Iterator[Case]:
        true = STIFFNESS[example](PHYSICAL) * PHYSICAL["l"] / (PHYSICAL[inertia] * _c2(example, PHYSICAL))
        yield Case(dict(PHYSICAL), value(PHYSICAL), true)

    return Claim(
        id,
        f"section 4, under {id[:5]}",
        text,
        ranges,
        "(2.4) made dimensionless: stiffness l / (inertia c_f^2), c_f^2 as in Table 1",
        cases,
        scanned or right,
        {"factor": lambda q: 2 * right(q), "E for rho": lambda q: right({**q, "rho": q["E"]})},
        Slip(
            "unreadable",
            text.replace("pl", r"\rho l").replace("p l", r"\rho l").replace(r"\kappa =", r"\kappa_i ="),
            right,
            "The scan has p, which is no quantity of the text, for rho"
            + (", and no index i: beyond doubt." if example == "III" else ": beyond doubt."),
        )
        if scanned
        else None,
    )
