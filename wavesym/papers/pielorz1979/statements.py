"""What is said of the examples: what they are made of, where waves run, what equations they obey, and while what holds.

The patterns of the sentences are in sentences.toml.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache

from flint import arb, fmpq

from wavesym.derivation.delay import delay_equations
from wavesym.derivation.table import Function
from wavesym.exact.contacts.events import contact_ends
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.model import Labels, Model
from wavesym.mechanics.network import network_of
from wavesym.mechanics.probe import Probe
from wavesym.papers.evaluation import Scope, span
from wavesym.papers.pielorz1979.chains import (
    EXAMPLES,
    LoadedChain,
    drive,
    example,
    instants,
    loads,
    meeting,
    uneven_building,
)
from wavesym.papers.pielorz1979.equation_kinds import arrival
from wavesym.papers.pielorz1979.equations import is_complete
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case
from wavesym.papers.sentences import Words

UNTIL = 12
"""How far in tau collisions are followed: some contacts of them have opened."""
VELOCITIES = ((3, 1), (1, 1, -2), (2, 1, 1), (1, 2), (3, 0, 1))
"""Of the bodies before they meet, from left to right: falling, equal, rising."""
_SYSTEMS = {"colliding system": "I", "drive": "II", "building": "III"}


def _chains(example: str) -> Iterator[tuple[dict[str, object], Chain]]:
    for m in EXAMPLES[example].sizes:
        yield {"m": m}, EXAMPLES[example].tables(m).chain


def _count(words: Words) -> Iterator[Case]:
    name = _SYSTEMS.get(words["example"], words["example"])
    for at, chain in _chains(name):
        bodies = [node for node in chain.nodes if node.inertia]
        between = [node for node in bodies if node.left and node.right]
        numbers = {
            **dict.fromkeys(("rods", "shafts"), chain.m),
            **dict.fromkeys(("bodies", "rigid bodies"), len(bodies)),
            "bodies with a rod on either side": len(between),
            "floors between foundation and roof": len(between) if name == "III" else 0,
        }
        yield Case(at, Scope(at).value(read_formula(words["count"])), numbers[words["things"]])


def _sizes(words: Words) -> Iterator[Case]:
    system = EXAMPLES[words["example"]].system
    for m in range(system.smallest, system.smallest + 5):
        claim = {"even": m % 2 == 0, "odd": m % 2 == 1, "any number": True}[words["sizes"]]
        yield Case({"m": m}, claim, (m - system.smallest) % system.step == 0)


def _origin(words: Words) -> Iterator[Case]:
    for at, chain in _chains(words["example"]):
        x = {"0": 0, "m": chain.m}[words["x"]]
        moved = any(load.kind in "ab" for load in chain.nodes[x].loads)
        free = f"the free end of rod {max(x, 1)}"
        end = "the foundation" if moved else "the roof" if chain.nodes[x].inertia else free
        yield Case({**at, "x": x}, words["end"], end)


def _masses(words: Words) -> Iterator[Case]:
    """A mass is known by its kappa: it is at the node whose law that changes."""
    for at, chain in _chains("III"):
        places = {number: _place(chain, number) for number in chain.parameters.kappa}
        floors = [x for x, node in enumerate(chain.nodes) if node.left and node.right]
        scope = Scope(at)
        yield Case({**at, "mass of": "the foundation"}, places.get(int(words["foundation"])), 0)
        claim = [places.get(i) for i in span(read_range(f"i = {words['floors']}"), scope)]
        yield Case({**at, "masses of": "the floors, in their order"}, claim, floors)
        yield Case({**at, "mass of": "the roof"}, places.get(scope.whole(read_formula(words["roof"]))), chain.m)


def _place(chain: Chain, number: int) -> int:
    kappa = {**chain.parameters.kappa, number: 2 * chain.parameters.kappa[number]}
    heavier = Chain(chain.system, chain.m, replace(chain.parameters, kappa=kappa))
    (place,) = (x for x, pair in enumerate(zip(chain.nodes, heavier.nodes, strict=True)) if pair[0] != pair[1])
    return place


def _runs(words: Words) -> Iterator[Case]:
    """A rod that a load reaches from the left hears first the wave that runs to the right."""
    for exact in (drive(2), drive(3), uneven_building(3)):
        for source, response in exact.responses.items():
            x, _ = exact.chain.unit_loads[source]
            for rod in range(1, exact.m + 1):
                leaves = {}
                for name in "fg":
                    begins = next(n for n, gained in enumerate(response[Function(name, rod)]) if gained)
                    leaves[name] = exact.chain.leaves(name, rod, exact.interval * begins)
                reached = "left" if rod <= x else "right"
                at = {"m": exact.m, "source": source, "rod": rod, "side": reached}
                yield Case(at, reached == words["way"], min("fg", key=leaves.__getitem__) == words["letter"].lower())


def _arrives(words: Words) -> Iterator[Case]:
    which = min if words["which"] == "first" else max
    for name in EXAMPLES:
        for at, chain in _chains(name):
            for i in range(1, chain.m + 1):
                rod = Scope({"i": i}).whole(read_formula(words["rod"]))
                clock = chain.rod(i)
                time, ends = arrival(chain, rod, which) if 1 <= rod <= chain.m else (None, {None})
                yield Case({"example": name, **at, "i": i}, int(clock.tau0), time)
                yield Case({"example": name, **at, "i": i, "end": int(clock.x0)}, int(clock.x0) in ends, True)


def _zero(words: Words) -> Iterator[Case]:
    """NoValue before z = 0: no equation takes anything from a later z. After it all functions change at some time."""
    for name, known in EXAMPLES.items():
        for equation in delay_equations(known.system):
            lags = [*(wave.lag for wave in equation.right.waves), *(load.lag for load in equation.right.loads)]
            at = {"example": name, "function": f"{equation.function}_{equation.rod}"}
            rests = all(lag.is_nonnegative for lag in lags) if words["sign"] == "negative" else lags == []
            yield Case({**at, "z": words["sign"]}, True, rests)


def _orders(words: Words) -> Iterator[Case]:
    claim = {{"first": 1, "second": 2, "third": 3}[word] for word in words["orders"].split(" and ")}
    for name, known in EXAMPLES.items():
        true = {1 if equation.own.a == 0 else 2 for equation in delay_equations(known.system)}
        yield Case({"example": name, "orders": "of the equations"}, claim, true)


def _list_sizes(words: Words) -> Iterator[Case]:
    numbers = words["sizes"].removeprefix(", where m = ").split(", ") if words["sizes"] else ("2", "4")
    first, second, *_ = map(int, numbers[:2])
    for m in range(2, 12, 2):
        claim = m >= first and (m - first) % (second - first) == 0
        yield Case({"m": m, "what": "every function is given once"}, claim, is_complete("(4.6)", m))


def _follows(words: Words) -> Iterator[Case]:
    yield from _orders(words)
    for velocities in VELOCITIES:
        yield from _while_closed(velocities, words)


def _while_closed(velocities: tuple[int, ...], words: Words) -> Iterator[Case]:
    """A collision: whether contacts are closed at first, and whether (4.6) is its motion when it is said to be."""
    exact = meeting(velocities)
    motion = LoadedChain(exact, loads(exact))
    contacts = range(2, exact.m, 2)
    at_first = _strains(motion, contacts, fmpq(0))
    closed = all(strain <= 0 for strain in at_first)
    if "than" in words:
        for x, strain in zip(contacts, at_first, strict=True):
            left, right = velocities[x // 2 - 1], velocities[x // 2]
            claim = right <= left if words["than"] == "faster than" else right >= left
            yield Case({"velocities": velocities, "contact": x, "what": "closed at first"}, claim, strain <= 0)
    strains = {"strain": [str(x) for x in contacts]}
    look = "the strain at a contact becomes positive: (4.6) goes on as if it could pull"
    falling = list(velocities) == sorted(velocities, reverse=True)  # as in every scene
    seen = example(exact, motion.loads, UNTIL, strains, "wavesym run SCENE --samples 101", look) if falling else None
    for tau in instants(UNTIL):
        pulls = any(strain > 0 for strain in _strains(motion, contacts, tau))
        closed = closed and (not pulls or words.get("hypothesis") != "stay closed")
        if closed or "hypothesis" not in words:
            at = {"velocities": velocities, "tau": tau, "what": "bodies that only touch move as (4.6) says"}
            yield Case(at, True, bool(arb(tau) < _first_opening(velocities)), example=seen)


def _strains(motion: LoadedChain, contacts: range, tau: fmpq) -> list[float]:
    """The strain at contacts, as numbers whose signs are right."""
    waves = (motion.waves_at(x, x, tau) for x in contacts)
    return [float(g - f) for f, g in waves]


@cache
def _first_opening(velocities: tuple[int, ...]) -> arb:
    """When the first contact opens."""
    exact = meeting(velocities)
    probes = tuple(Probe(f"strain@{x}", "strain", x, fmpq(1)) for x in range(2, exact.m, 2))
    impact = (AppliedLoad("impact", fmpq(0), fmpq(1)),)
    network = network_of(exact.chain)
    model = Model("meeting", network, impact, probes, fmpq(UNTIL), fmpq(1), Labels({}, (), ""))
    ends = contact_ends(model)
    return min((end.tau for end in ends), default=arb.pos_inf(), key=float)


STATEMENTS: Mapping[str, Callable[[Words], Iterator[Case]]] = {
    "count": _count,
    "parts": _count,
    "sizes": _sizes,
    "origin": _origin,
    "masses": _masses,
    "runs": _runs,
    "arrives": _arrives,
    "zero": _zero,
    "orders": _orders,
    "follows": _follows,
    "while": _follows,
    "given": _list_sizes,
}
"""What is tried for the words of a sentence, by its pattern."""
