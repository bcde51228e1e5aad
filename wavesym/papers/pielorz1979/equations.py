"""The test of equations: both sides at all places and instants that their ranges say, on chains that move under loads.

Equations that belong together say each of some things once: a condition at each node, an equation for each function, a
constant for each body. A cell of Table 1 is an equation, too: what its column is for is on the left.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any

from flint import fmpq

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, sides
from wavesym.papers.exact_numbers import Jet
from wavesym.papers.pielorz1979.chains import (
    EXAMPLES,
    LoadedChain,
    building,
    grounded_building,
    loaded_chain,
    loads,
    unequal_collision,
)
from wavesym.papers.pielorz1979.equation_group import EquationGroup
from wavesym.papers.pielorz1979.equation_kinds import (
    Conditions,
    Constants,
    Definitions,
    Delays,
    Interior,
    Loads,
    OfRods,
    Rates,
    Table1,
)
from wavesym.papers.pielorz1979.letters import Motion
from wavesym.papers.pielorz1979.transcript import right_reading
from wavesym.papers.reader import read_range
from wavesym.papers.record import Case, Reading, Test, case
from wavesym.papers.tree import Call, Progression, Relation, Symbol, Tree, latex

EQUAL_FLOORS = "equal floors"


GROUPS: Mapping[str, type[EquationGroup]] = {
    "condition": Conditions,
    "delay": Delays,
    "inside": Interior,
    "definition": Definitions,
    "load": Loads,
    "constant": Constants,
    "rate": Rates,
    "cell": Table1,
}


def equation(entry: PaperEntry) -> Test:
    """How an equation is tried, and under what the text may mean beside what it says."""
    group, base = GROUPS[entry.kind], entry.subject.get("base")
    own = entry.subject.get("row" if entry.kind == "cell" else "example")
    names = (str(own),) if own else tuple(group.sizes)

    def cases(reading: Reading, variant: str | None = base) -> Iterator[Case]:
        for name in names:
            for m in group.sizes[name]:
                motion = _chain(name, m, variant, "at" in entry.subject)
                yield from group(entry, reading, motion).cases({"m": m} if own else {"example": name, "m": m})

    def with_range(more: Tree) -> Callable[[Reading], Iterable[Case]]:
        return lambda reading: cases(_with_range(reading, more))

    conventions: dict[str, Callable[[Reading], Iterable[Case]]] = {}
    if "at" in entry.subject:
        for place in ("(i-1)l", "il"):
            conventions[f"body i stands at x = {place}"] = with_range(read_range(f"x_i = {place}"))
    if own == "III" and entry.kind in ("condition", "delay") and not base:
        conventions["all floors are equal"] = lambda reading: cases(reading, EQUAL_FLOORS)
    if entry.kind == "definition":
        conventions["a letter means the same with a bar"] = lambda reading: cases(_without_bar(reading))
    if entry.kind == "cell":
        bodies = next(r for r in right_reading("(3.1)").ranges if isinstance(r, Progression))
        conventions["i is the number of a body, as in (3.1)"] = with_range(bodies)
    return Test(
        group.reference_note(entry) + (", on a foundation that moves with the ground" if base else ""),
        cases,
        is_subtracted=not base,
        mathematics=(lambda reading: cases(reading, None)) if base else None,
        conventions=conventions,
    )


def _with_range(reading: Reading, more: Tree) -> Reading:
    """A formula with one more range, in the place of one of the same letter."""
    assert isinstance(more, Progression)
    kept = (r for r in reading.ranges if not isinstance(r, Progression) or r.variable != more.variable)
    return Reading(reading.formula, (*kept, more))


def _without_bar(reading: Reading) -> Reading:
    name, means = sides(reading.formula)
    plain = replace(name, accent="") if isinstance(name, Symbol) else name
    return Reading(Relation((plain, means), ("=",)), reading.ranges)


@cache
def _chain(name: str, m: int, variant: str | None, is_general: bool) -> LoadedChain:
    """A chain of an example under its loads; for (2.4), which has an A_i for each rod, with unequal rods."""
    if variant == "ground":
        exact = grounded_building(m)
    elif variant == EQUAL_FLOORS:
        exact = building(m)
    elif name == "I" and is_general:
        exact = unequal_collision(m)
    else:
        return loaded_chain(name, m)
    return LoadedChain(exact, loads(exact))


def is_complete(number: str, m: int) -> bool:
    """Whether the equations of a group, as they are right, give each of f_1, ..., f_m, g_1, ..., g_m once."""
    known = EXAMPLES[{"(4.6)": "I", "(4.7)": "II", "(4.8)": "III"}[number]]
    if (m - known.system.smallest) % known.system.step:
        return False
    entry = PaperEntry(id=number, kind="delay", printed="")
    statements = Delays(entry, Reading(None), loaded_chain(known.name, m)).statements_elsewhere()
    return statements == Counter((name, rod) for name in "fg" for rod in range(1, m + 1))


# solutions


def solution(entry: PaperEntry) -> Test:
    """A displacement in f and g, (2.5) or (4.2), put into the law of every node: a step of velocity, and a force."""
    return Test(
        "continuity and the balance of forces at every node, as derived, on exact f and g; c_f and l are varied",
        partial(_solution_cases, entry),
    )


def _solution_cases(entry: PaperEntry, reading: Reading) -> Iterator[Case]:
    for name, sizes in OfRods.sizes.items():
        for m in sizes:
            group = Definitions(entry, reading, loaded_chain(name, m))
            scope, at = group.scope, {"example": name, "m": m}
            statements = Counter(group.key(reading.formula, place) for place in group.places(reading.formula))
            required = Counter(group.required_keys())
            for key in sorted(statements.keys() | required.keys()):
                yield Case(
                    {**at, "how often it is given": f"rod_{key[1]}"}, statements[key], required[key], is_telling=False
                )
            for tau in (fmpq(2, 3), fmpq(31, 9)):
                for x in range(m + 1):
                    where = {**at, "t": tau * scope.units.l / scope.units.c_f, "node": x}
                    value = "step of velocity, force left over"
                    found = case({**where, "value": value}, partial(_residual, scope, reading.formula, x, tau), (0, 0))
                    yield replace(found, example=None if found.agrees else group.scene({**where, "x": x}, found))


def _residual(scope: Motion, formula: Tree, x: int, tau: fmpq) -> tuple[Any, Any]:
    """What the printed displacements leave of the law of a node."""
    step, force = scope.law(x, tau, partial(_printed_displacement, scope, formula))
    for load in scope.chain.nodes[x].loads:
        for power, coefficient in enumerate(load.coefficients):
            force = force - coefficient * scope.motion.load(load.source, tau, power)
    return step, force


def _printed_displacement(scope: Motion, formula: Tree, rod: int, x: Jet, tau: Jet) -> Jet:
    """The displacement of a rod as printed, in units of U_0."""
    left, right = sides(formula)
    with scope.bind({**scope.variables, "i": rod, **scope.coordinates(x, tau)}):
        match left:
            case Call(Symbol("U", accent, 0, (index,)), (place, time)) if scope.whole(index) == rod:
                if (latex(place), latex(time)) == ((r"\bar{x}", r"\tau") if accent else ("x", "t")):
                    return Jet.from_number(scope.value(right)) / (1 if accent else scope.units.U_0)
    raise MeaninglessError(f"{latex(left)} is not the displacement of rod {rod}")
