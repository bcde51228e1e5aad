"""Sentences about what the examples are made of, where waves run, and what equations they obey."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace

from wavesym.derivation.delay import delay_equations
from wavesym.exact.table import Function
from wavesym.model.chain import Chain
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import Scope, span
from wavesym.papers.exact_tables import Exact, drive, uneven_building
from wavesym.papers.pielorz1979.clocks import arrival
from wavesym.papers.pielorz1979.truth import EXAMPLES
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Reading, Test
from wavesym.papers.sentences import Pattern, sentence_reader

Words = Mapping[str, str]
_COUNTS = ("m/2", "m-1", "m", "m+1", "2m")
_ENDS = ("the free end of rod 1", "the foundation", "the roof", "a contact")

MAKEUP = (
    Pattern(
        "count",
        "example {example} has {count} {things}",
        {
            "example": ("I", "II", "III"),
            "count": _COUNTS,
            "things": ("rods", "bodies", "bodies with a rod on either side"),
        },
    ),
    Pattern(
        "sizes", "in example {example} m is {sizes}", {"example": ("I", "II"), "sizes": ("even", "odd", "any number")}
    ),
    Pattern(
        "origin", "in example {example} x = {x} is {end}", {"example": ("I", "III"), "x": ("0", "m"), "end": _ENDS}
    ),
    Pattern(
        "masses",
        "M_{foundation} is the mass of the foundation, M_i of floor i, i = {floors}, M_{roof} of the roof",
        {
            "foundation": ("0", "1"),
            "floors": (r"1, 2, \dots, m-1", r"1, 2, \dots, m", r"0, 1, \dots, m-1", r"2, 3, \dots, m-1"),
            "roof": ("m", "m-1", "m+1"),
        },
    ),
)
WAVES = (
    Pattern(
        "runs",
        "the functions {letter}_i are disturbances that run to the {way}",
        {"letter": "FG", "way": ("right", "left")},
    ),
    Pattern(
        "arrives",
        "t_0i and x_0i are the time and one of the ends at which the {which} disturbance reaches rod {rod}",
        {"which": ("first", "last"), "rod": ("i", "i+1", "i-1")},
    ),
    Pattern("zero", "for {sign} arguments the functions F_i and G_i are zero", {"sign": ("negative", "positive")}),
    Pattern(
        "order",
        "the equations for the functions F_i and G_i are of {orders} order",
        {"orders": ("first", "second", "first and second", "second and third")},
    ),
)


def makeup(entry: Entry) -> Test:
    """What an example is made of."""
    return _test("the nodes of the example's chain, for several m", MAKEUP, _MAKEUP_CASES)


def waves(entry: Entry) -> Test:
    """Where waves run, and what equations they obey."""
    return _test("the derived delay equations, and their exact tables for every source", WAVES, _WAVE_CASES)


def _test(against: str, patterns: tuple[Pattern, ...], cases: Mapping[str, Callable[[Words], Iterator[Case]]]) -> Test:
    reader = sentence_reader(patterns)

    def tried(reading: Reading) -> Iterator[Case]:
        return cases[reading.formula.pattern](reading.formula.words)

    return Test(against, tried, reader.read, reader.faults)


def _chains(example: str) -> Iterator[tuple[dict[str, object], Chain]]:
    for m in EXAMPLES[example].sizes:
        yield {"m": m}, EXAMPLES[example].tables(m).chain


def _count(words: Words) -> Iterator[Case]:
    for at, chain in _chains(words["example"]):
        bodies = [node for node in chain.nodes if node.inertia]
        between = [node for node in bodies if node.left and node.right]
        things = {"rods": chain.m, "bodies": len(bodies), "bodies with a rod on either side": len(between)}
        yield Case(at, Scope(at).value(read_formula(words["count"])), things[words["things"]])


def _sizes(words: Words) -> Iterator[Case]:
    system = EXAMPLES[words["example"]].system
    for m in range(system.smallest, system.smallest + 5):
        said = {"even": m % 2 == 0, "odd": m % 2 == 1, "any number": True}[words["sizes"]]
        yield Case({"m": m}, said, (m - system.smallest) % system.step == 0)


def _origin(words: Words) -> Iterator[Case]:
    for at, chain in _chains(words["example"]):
        x = {"0": 0, "m": chain.m}[words["x"]]
        yield Case({**at, "x": x}, words["end"], _end(chain, x))


def _end(chain: Chain, x: int) -> str:
    """What is at an end of a chain."""
    node = chain.nodes[x]
    if any(load.kind in "ab" for load in node.loads):
        return "the foundation"
    if node.inertia:
        return "the roof"
    return f"the free end of rod {max(x, 1)}"


def _masses(words: Words) -> Iterator[Case]:
    """A mass is known by its kappa: it is at the node whose law that changes."""
    for at, chain in _chains("III"):
        places = {number: _place(chain, number) for number in chain.parameters.kappa}
        floors = [x for x, node in enumerate(chain.nodes) if node.left and node.right]
        scope = Scope(at)
        yield Case({**at, "mass of": "the foundation"}, places.get(int(words["foundation"])), 0)
        said = [places.get(i) for i in span(read_range(f"i = {words['floors']}"), scope)]
        yield Case({**at, "masses of": "the floors, in their order"}, said, floors)
        yield Case({**at, "mass of": "the roof"}, places.get(scope.whole(read_formula(words["roof"]))), chain.m)


def _place(chain: Chain, number: int) -> int:
    kappa = {**chain.parameters.kappa, number: 2 * chain.parameters.kappa[number]}
    heavier = Chain(chain.system, chain.m, replace(chain.parameters, kappa=kappa))
    (place,) = (x for x, pair in enumerate(zip(chain.nodes, heavier.nodes, strict=True)) if pair[0] != pair[1])
    return place


def _runs(words: Words) -> Iterator[Case]:
    """A rod that a load reaches from the left hears first the wave that runs to the right."""
    letter = words["letter"].lower()
    for exact in (drive(2), drive(3), uneven_building(3)):
        for source in exact.responses:
            x, _ = exact.chain.loaded[source]
            for rod in range(1, exact.m + 1):
                first = min("fg", key=lambda name: exact.chain.leaves(name, rod, _begins(exact, source, name, rod)))
                reached = "left" if rod <= x else "right"
                at = {"m": exact.m, "source": source, "rod": rod, "side": reached}
                yield Case(at, reached == words["way"], first == letter)


def _begins(exact: Exact, source: str, letter: str, rod: int) -> int:
    """The z from which on a function is not 0."""
    increments = exact.responses[source][Function(letter, rod)]
    return exact.interval * next(n for n, increment in enumerate(increments) if increment)


def _arrives(words: Words) -> Iterator[Case]:
    which: Callable[[Iterable[int]], int] = {"first": min, "last": max}[words["which"]]
    for example in EXAMPLES:
        for at, chain in _chains(example):
            for i in range(1, chain.m + 1):
                rod = Scope({"i": i}).whole(read_formula(words["rod"]))
                clock = chain.rod(i)
                said = (int(clock.tau0), int(clock.x0))
                time, ends = arrival(chain, rod, which) if 1 <= rod <= chain.m else (None, {None})
                yield Case({"example": example, **at, "i": i}, said[0], time)
                yield Case({"example": example, **at, "i": i, "end": said[1]}, said[1] in ends, True)


def _zero(words: Words) -> Iterator[Case]:
    """Nothing before z = 0: no equation takes anything from a later z. After it all functions change at some time."""
    for example, known in EXAMPLES.items():
        for equation in delay_equations(known.system):
            lags = [*(wave.lag for wave in equation.right.waves), *(load.lag for load in equation.right.loads)]
            at = {"example": example, "function": f"{equation.function}_{equation.rod}"}
            rests = all(lag.is_nonnegative for lag in lags) if words["sign"] == "negative" else lags == []
            yield Case({**at, "z": words["sign"]}, True, rests)


def _order(words: Words) -> Iterator[Case]:
    numbers = {"first": 1, "second": 2, "third": 3}
    for example, known in EXAMPLES.items():
        true = {1 if equation.own.a == 0 else 2 for equation in delay_equations(known.system)}
        said = {numbers[word] for word in words["orders"].split(" and ")}
        yield Case({"example": example, "orders": "of the equations"}, said, true)


_MAKEUP_CASES = {"count": _count, "sizes": _sizes, "origin": _origin, "masses": _masses}
_WAVE_CASES = {"runs": _runs, "arrives": _arrives, "zero": _zero, "order": _order}
