"""Table 1, cell by cell."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from flint import fmpq

from wavesym.model.chain import Chain
from wavesym.papers.pielorz1979.conditions import DIMENSIONLESS
from wavesym.papers.pielorz1979.delays import II, III, I
from wavesym.papers.pielorz1979.motion import PHYSICAL, SPEED, STIFFNESS
from wavesym.papers.record import Case, Claim, Slip

EXAMPLES = {"I": I, "II": II, "III": III}
Value = Callable[[Chain, int], Any]


def claims() -> Iterator[Claim[Any]]:
    """The cells of Table 1, by rows."""
    for name in EXAMPLES:
        yield _letter(name)
        yield _speed(name)
        yield _cell(name, "x_0", *_X0[name])
        yield _cell(name, "tau_0", *_TAU0[name])
        yield _cell(name, "v", *_V[name])
        yield _cell(name, "S", *_S[name])


def arrival(chain: Chain, rod: int) -> tuple[int, set[int]]:
    """When the first disturbance reaches a rod, and at which of its ends: from a load, or a contact that is struck."""
    struck = [
        x
        for x, node in enumerate(chain.nodes)
        if node.loads or (node.left and node.right and node.left.velocity != node.right.velocity)
    ]
    times = {end: min(abs(end - x) for x in struck) for end in (rod - 1, rod)}
    first = min(times.values())
    return first, {end for end, time in times.items() if time == first}


def _x0_i(m: int, i: int, scanned: bool) -> int:
    if i == m:
        return m - 1
    if i % 2 == 0:
        return 1 if scanned else i
    return i if scanned and i > 1 else max(i - 1, 1)


_GARBLED = "i is read as a line of its own, and i-1 as i = 1; the front arrives there: beyond doubt."
_X0: dict[str, tuple[str, Value, Slip[Value] | None]] = {
    "I": (
        "1 for i = 1 and for i = 2, 4, ..., m-2; i = 1 for i = 3, 5, ..., m-1; m-1 for i = m",
        lambda c, i: _x0_i(c.m, i, scanned=True),
        Slip(
            "unreadable",
            "1 for i = 1, i for i = 2, 4, ..., m-2, i-1 for i = 3, 5, ..., m-1, m-1 for i = m",
            lambda c, i: _x0_i(c.m, i, scanned=False),
            _GARBLED,
        ),
    ),
    "II": ("i-1", lambda c, i: i - 1, None),
    "III": ("i-1", lambda c, i: i - 1, None),
}
_TAU0: dict[str, tuple[str, Value, Slip[Value] | None]] = {
    "I": ("1 for i = 1, m; 0 for i = 2, 3, ..., m-1", lambda c, i: int(i in (1, c.m)), None),
    "II": ("0", lambda c, i: 0, None),
    "III": ("i-1", lambda c, i: i - 1, None),
}
_V: dict[str, tuple[str, Value, Slip[Value] | None]] = {
    "I": (
        r"\bar{v}_i^{-1} for i = 2, 4, ..., m; \bar{v}_i for i = 1, 3, ..., m-1",
        lambda c, i: c.parameters.velocity[i] if i % 2 else 1 / c.parameters.velocity[i - 1],
        Slip(
            "unreadable",
            r"\bar{v}_{i-1} for i = 2, 4, ..., m; \bar{v}_i for i = 1, 3, ..., m-1",
            lambda c, i: c.parameters.velocity[i if i % 2 else i - 1],
            "The index i-1 is read as an exponent; an even rod moves with the body on its left: beyond doubt.",
        ),
    ),
    "II": ("0", lambda c, i: fmpq(0), None),
    "III": ("0", lambda c, i: fmpq(0), None),
}
_S: dict[str, tuple[str, Value, Slip[Value] | None]] = {
    "I": ("0", lambda c, i: (), None),
    "II": ("M_i(t)", lambda c, i: (("M", i),), None),
    "III": ("0", lambda c, i: (), None),
}
# where the words between the formulas are part of the reading
_SCANNED = {
    "T1.I.x_0": "1 dla i=1 i dla i=2, 4, ..., m-2 i=1 dla i=3, 5, ..., m-1 m-1 dla i=m",
    "T1.I.tau_0": "1 dla i=1, m 0 dla i=2, 3, ..., m-1",
    "T1.I.v": r"\bar{v}_i^{-1} dla i=2, 4, ..., m \bar{v}_i dla i=1, 3, ..., m-1",
}
_TRUE: dict[str, Value] = {
    "x_0": lambda c, i: c.rod(i).x0,
    "tau_0": lambda c, i: c.rod(i).tau0,
    "v": lambda c, i: fmpq(c.rod(i).velocity),
    # the body at the left end of rod i: number i in example II
    "S": lambda c, i: tuple((u.kind, u.number) for u in c.nodes[i - 1].loads) if c.nodes[i - 1].inertia else (),
}
_AGAINST = {
    "x_0": "the end at which the first disturbance arrives, and the clock with which (4.6)-(4.8) follow",
    "tau_0": "the time at which the first disturbance arrives, and the clock with which (4.6)-(4.8) follow",
    "v": "the velocity of the body to which the rod is fixed",
    "S": "the loads of the rigid bodies",
}


def _cell(name: str, column: str, text: str, value: Value, slip: Slip[Value] | None) -> Claim[Value]:
    def cases(reading: Value) -> Iterator[Case]:
        for m in EXAMPLES[name].sizes:
            chain = EXAMPLES[name].tables(m).chain
            for i in range(1, m + 1):
                printed, true = reading(chain, i), _TRUE[column](chain, i)
                yield Case({"m": m, "i": i}, printed, true)
                time, ends = arrival(chain, i)
                if column == "tau_0":
                    yield Case({"m": m, "i": i, "claim": "front"}, printed, time)
                if column == "x_0":
                    yield Case({"m": m, "i": i, "claim": "front"}, printed if printed in ends else None, printed)

    right = slip.reading if slip else value
    more: Value = (lambda c, i: (*right(c, i), ("M", 0))) if column == "S" else (lambda c, i: right(c, i) + 1)
    return Claim(
        f"T1.{name}.{column}",
        f"Table 1, example {name}, column {column}",
        text,
        "i = 1, 2, ..., m",
        _AGAINST[column],
        cases,
        value,
        {"one more": more, "that of the next rod": lambda c, i: right(c, i % c.m + 1)}
        if text not in ("0",)
        else {"one more": more},
        slip,
        scan=_SCANNED.get(f"T1.{name}.{column}"),
    )


def _speed(name: str) -> Claim[Callable[[Any], Any]]:
    text, value = SPEED[name]
    area = {"I": ("F",), "II": ("J_0i",), "III": ("n", "A")}[name]

    def cases(reading: Callable[[Any], Any]) -> Iterator[Case]:
        mass = PHYSICAL["rho"]
        for part in area:
            mass *= PHYSICAL[part]
        yield Case(dict(PHYSICAL), reading(PHYSICAL), STIFFNESS[name](PHYSICAL) / mass)

    return Claim(
        f"T1.{name}.c_f^2",
        f"Table 1, example {name}, column c_f^2",
        text,
        "",
        "stiffness of the rod over its inertia per length",
        cases,
        value,
        {"twice": lambda q: 2 * value(q), "rho squared": lambda q: value(q) / q["rho"]},
    )


_LETTERS = {"I": ("(4.3)", "u"), "II": ("(4.4)", r"\theta"), "III": ("(4.5)", "y")}


def _letter(name: str) -> Claim[str]:
    equations, letter = _LETTERS[name]

    def cases(reading: str) -> Iterator[Case]:
        for printed in DIMENSIONLESS:
            if printed.id.startswith(equations):
                yield Case({"condition": printed.id}, rf"\bar{{{reading}}}_" in printed.text, True)

    return Claim(
        f"T1.{name}.U",
        f"Table 1, example {name}, column U",
        f"{letter}(x, t)",
        "",
        f"the letter in {equations}",
        cases,
        letter,
        {f"the letter {other}": other for _, other in _LETTERS.values() if other != letter},
    )
