"""What the text says of (4.6), (4.7), (4.8) as systems: what they follow from, when, and for which m."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache

from flint import arb, fmpq

from wavesym.derivation.delay import delay_equations
from wavesym.exact.contact import contact_ends
from wavesym.model.loads import Applied
from wavesym.model.model import Labels, Model
from wavesym.model.network import network_of
from wavesym.model.probe import Probe
from wavesym.papers.entries import Entry
from wavesym.papers.exact_tables import meeting
from wavesym.papers.pielorz1979.delays import given_once
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.truth import EXAMPLES, Driven, instants, loads
from wavesym.papers.record import Case, Reading, Test
from wavesym.papers.sentences import Pattern, sentence_reader

UNTIL = 12
"""How far in tau collisions are followed: some contacts of them have opened."""
VELOCITIES = ((3, 1), (1, 1, -2), (2, 1, 1), (1, 2), (3, 0, 1))
"""Of the bodies before they meet, from left to right: falling, equal, rising."""

_FOLLOWS = (
    "substituting (4.2) into (4.3), (4.4) and (4.5) gives (4.6), (4.7) and (4.8), ordinary differential equations of "
    "{orders} order for f_i(z) and g_i(z)"
)
_ORDERS = {"orders": ("second and first", "second", "first")}
_PATTERNS = (
    Pattern("always", _FOLLOWS, _ORDERS),
    Pattern(
        "while",
        _FOLLOWS
        + ", in example I while the contacts {hypothesis}, which they are at first where no body is {than} the "
        "one on its left",
        {**_ORDERS, "hypothesis": ("stay closed", "are closed at first"), "than": ("faster than", "slower than")},
    ),
    Pattern(
        "sizes",
        "(4.6) gives each of f_1, ..., f_m, g_1, ..., g_m once for m = {least}, ...",
        {"least": ("2, 4, 6", "4, 6, 8", "6, 8, 10", "3, 4, 5")},
    ),
)
_SENTENCES = sentence_reader(_PATTERNS)


def test(entry: Entry) -> Test:
    """How a sentence is tried."""
    about_sizes = entry.about.get("of") == "m"
    against = (
        "the equations of (4.6) as they are right, m = 2 ... 11"
        if about_sizes
        else "the derived equations; when contacts of collisions open, with velocities that fall and rise"
    )
    return Test(against, _sizes if about_sizes else _followed, _SENTENCES.read, _SENTENCES.faults)


def _sizes(read: Reading) -> Iterator[Case]:
    first, second, *_ = (int(value) for value in read.formula.words["least"].split(", "))
    for m in range(2, 12):
        said = m >= first and (m - first) % (second - first) == 0
        yield Case({"m": m, "what": "every function is given once"}, said, given_once("(4.6)", m))


def _followed(read: Reading) -> Iterator[Case]:
    words = read.formula.words
    for name, drawn in EXAMPLES.items():
        orders = {2 if equation.own.a != 0 else 1 for equation in delay_equations(drawn.system)}
        yield Case({"example": name, "what": "orders"}, _orders(words["orders"]), orders)
    for velocities in VELOCITIES:
        yield from _while_closed(velocities, words)


def _orders(words: str) -> set[int]:
    return {{"first": 1, "second": 2}[word] for word in words.split(" and ")}


def _while_closed(velocities: tuple[int, ...], words: Mapping[str, str]) -> Iterator[Case]:
    """A collision: whether contacts are closed at first, and whether (4.6) is its motion when it is said to be."""
    exact = meeting(velocities)
    driven = Driven(exact, loads(exact))
    contacts = range(2, exact.m, 2)
    closed = all(strain <= 0 for strain in _strains(driven, contacts, fmpq(0)))
    if "than" in words:
        for x, strain in zip(contacts, _strains(driven, contacts, fmpq(0)), strict=True):
            left, right = velocities[x // 2 - 1], velocities[x // 2]
            said = right <= left if words["than"] == "faster than" else right >= left
            yield Case({"velocities": velocities, "contact": x, "what": "closed at first"}, said, strain <= 0)
    strains = {"strain": [str(x) for x in contacts]}
    look = "the strain at a contact becomes positive: (4.6) goes on as if it could pull"
    falling = list(velocities) == sorted(velocities, reverse=True)  # as in every scene
    seen = example(exact, driven.loads, UNTIL, strains, "wavesym run SCENE --samples 101", look) if falling else None
    for tau in instants(UNTIL):
        pulls = any(strain > 0 for strain in _strains(driven, contacts, tau))
        closed = closed and (not pulls or words.get("hypothesis") != "stay closed")
        if closed or "hypothesis" not in words:
            at = {"velocities": velocities, "tau": tau, "what": "bodies that only touch move as (4.6) says"}
            yield Case(at, True, bool(arb(tau) < _first_opening(velocities)), example=seen)


def _strains(driven: Driven, contacts: range, tau: fmpq) -> list[float]:
    """The strain at contacts, as numbers whose signs are right."""
    waves = (driven.waves_at(x, x, tau) for x in contacts)
    return [float(g - f) for f, g in waves]


@cache
def _first_opening(velocities: tuple[int, ...]) -> arb:
    """When the first contact opens."""
    exact = meeting(velocities)
    probes = tuple(Probe(f"strain@{x}", "strain", x, fmpq(1)) for x in range(2, exact.m, 2))
    labels = Labels({}, (), "")
    impact = (Applied("impact", fmpq(0), fmpq(1)),)
    ends = contact_ends(Model("meeting", exact.chain, network_of(exact.chain), impact, probes, fmpq(UNTIL), fmpq(1), labels))
    return min((end.tau for end in ends), default=arb.pos_inf(), key=float)
