"""Notes and reasons, which nothing computes: what they refer to is there, and what they say of it is so."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import product

import pytest
from flint import fmpq

from tests.papers.falsified import ENTRIES
from wavesym.mechanics.node import Parameters
from wavesym.papers.pielorz1979.chains import Exact, collision, drive, with_parameters
from wavesym.papers.pielorz1979.transcript import paper

REFERENCE = re.compile(r"\(\d\.\d+\)(?:\.\w+)?|III\.\d+|text\.\w+(?:\.\w+)*|def\.\w|Table \d")
PLACES = {passage.where.split(",")[0] for passage in paper().passages}


def _sayings() -> Iterator[tuple[str, str]]:
    """Whatever is said beside what is printed, by record or line."""
    for passage in paper().passages:
        yield f"line {passage.lines[0]}", " ".join([passage.why, *(aside.why for aside in passage.asides)])
        for entry in passage.entries:
            reasons = [why for _, why in entry.equivalent] + [why for _, _, why in entry.edits]
            yield entry.id, " ".join([entry.slip.note if entry.slip else "", entry.note, *reasons])


def test_what_is_referred_to_exists() -> None:
    numbers = {id.partition(")")[0] + ")" for id in ENTRIES if id.startswith("(")}
    for where, said in _sayings():
        for name in REFERENCE.findall(said):
            known = name in ENTRIES or name in numbers or name in PLACES
            assert known or any(id.startswith(f"{name}.") for id in ENTRIES), (where, name)


@pytest.mark.parametrize(
    ("id", "said", "places"),
    [
        ("(2.3)", "(4.3), (4.4), (4.5) have i = 1, ..., m-1", ["(4.3).2 m-1", "(4.4).3 m-1", "(4.5).3 m-1"]),
        (
            "(2.4).5",
            "as the last moment does in (4.4).4 and (4.7).2",
            [r"(4.4).4 \bar{A}_{m+1}", r"(4.7).2 = -\bar{A}"],
        ),
        (
            "(2.5)",
            "(4.2) has tau_(0,i) in both waves",
            [r"(4.2) f_i(\tau - \tau_{0,i}", r"(4.2) g_i(\tau - \tau_{0,i}"],
        ),
        ("def.f", "(4.2) and all that follows write f_i without the bar", ["(4.2) = f_i(", "(4.6).1 f'_1("]),
        ("def.s", "(2.4) and Table 1 have S_i", ["(2.4).2 S_i(t)"]),
        ("T1.II.S", "S_i is of body i = 1, ..., m+1, as (3.1) has it", ["(3.1) m+1"]),
        ("(4.4).A", "Table 1 has C", ["T1.II.c_f^2 C^2"]),
        ("(4.7).2", "(3.1) and (4.7).4 have m_i", ["(3.1) ^{m_i}", "(4.7).4 ^{m_i}"]),
        ("(4.9).z", "Table 2 has 2n <= z < 2n+2", [r"T2.range 2n \leq z < 2n+2"]),
        ("(4.12).z", "Table 4 has 2n <= z < 2n+2", [r"T4.range 2n \leq z < 2n+2"]),
        ("(4.9)", "Table 2 and the text below have K_1", ["text.T2 K_1"]),
        ("(4.9).F", "(4.10) has l for the body", [r"(4.10) e^{-\gamma_l w}"]),
        ("(4.10)", "Table 3 and the text below have d for a", ["T3.even.d 2n+1", "(4.10).F i,s,d"]),
        ("(4.10).H", "H(w), which (4.12) has", [r"(4.12) H(z-2n-\tau_k)"]),
        ("(4.11).1", "(4.7).4 has kappa_i", [r"(4.7).4 \kappa_i + "]),
        ("(4.12)", "as in (4.8).4", [r"(4.8).4 + \kappa_m g_m'(z)"]),
        ("text.12.e", r"(4.10) has e^{-\gamma_l w}", [r"(4.10) e^{-\gamma_l w}"]),
        ("text.8", "read as in (4.12), with j the number of the interval", ["(4.12) F'_{i,n+1}"]),
        ("III.6", "f_0^{k,j,n+1} stands in the bracket already, by III.9", ["III.9 f_0^{k,j,n+1} = f_0^{k,j-1,n+1}"]),
        ("III.12", "as in III.13", ["III.13 H(2n+m-6-i)g_{1,i}^{k,m,n}"]),
        ("III.17", "III.16 leaves out the power 0", ["III.16 2, \\dots, 1"]),
        ("(4.4).4", "as in (2.4).5 and (4.7).2", ["(2.4).5 S_i(t) + A_i", r"(4.7).2 = -\bar{A}"]),
        ("text.23", "(4.4) counts the last one against positive rotation", [r"(4.4).4 + \frac{\partial^2"]),
    ],
)
def test_what_notes_say_of_other_places_stands_there(id: str, said: str, places: list[str]) -> None:
    entry = ENTRIES[id]
    assert said in f"{entry.slip.note if entry.slip else ''} {entry.note}"
    for place in places:
        other, _, words = place.partition(" ")
        stated = ", ".join((ENTRIES[other].printed, *ENTRIES[other].ranges))
        assert words.replace(" ", "") in stated.replace(" ", ""), place


def _compared(usual: Exact, special: Exact) -> set[int]:
    """How the highest powers differ from those of a chain in which nothing cancels."""
    bodies = usual.rates
    places = product("fg", range(1, usual.m + 1), range(1, 8), special.responses, bodies)
    return {
        special.degree(letter, rod, number, special.rates[body], source)
        - usual.degree(letter, rod, number, bodies[body], source)
        for letter, rod, number, source, body in places
    }


@pytest.mark.parametrize(
    ("ids", "said", "special"),
    [
        (("text.T2", "text.10"), "three bodies with kappa 1, 2, 3", ({1: 1, 3: 2, 5: 3}, None)),
        (("text.T3",), "three equal discs with kappa 1, 2", ({1: 1, 2: 2}, {1: 1, 2: 1, 3: 1})),
    ],
)
def test_the_special_values_of_notes_make_powers_lower_and_none_higher(
    ids: tuple[str, ...], said: str, special: tuple[dict[int, int], dict[int, int] | None]
) -> None:
    usual = collision(6) if special[1] is None else drive(2)
    kappa, inertia = ({i: fmpq(value) for i, value in given.items()} if given else None for given in special)
    given = Parameters(kappa=kappa, inertia=inertia, velocity=usual.chain.parameters.velocity)
    changed = with_parameters(usual, given)
    assert len(set(changed.rates.values())) == len(changed.rates)
    differences = _compared(usual, changed)
    assert min(differences) < 0 == max(differences)
    assert all(said in f"{ENTRIES[id].slip.note if ENTRIES[id].slip else ''} {ENTRIES[id].note}" for id in ids)
