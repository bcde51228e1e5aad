"""Chains of systems of one's own: what no method serves is refused in a line, what looks alike is told apart."""

from __future__ import annotations

from dataclasses import replace

import pytest
from flint import fmpq

from tests.support.physical_time import differences
from wavesym.derivation.delay import delay_equations
from wavesym.derivation.table import full_table
from wavesym.errors import WavesymError
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Family, Node, Parameters, Rod, System, UnitLoad, single

LOAD = UnitLoad("F", None, (1,))


def rod(i):
    return Rod(tau0=i - 1, x0=i - 1)


def chain(m, *families):
    """Rods between a force at x = 0, what is given, and a body at x = m."""
    first = single(0, lambda: Node(None, rod(1), inertia=0, alpha=0, beta=2, loads=(LOAD,)))

    def all_of(m, p):
        return (first, *(family(m) for family in families), single(m, lambda: Node(rod(m), None, 1, fmpq(1, 3), 0)))

    return Chain(System("own", all_of, lambda m: {}, smallest=2), m, Parameters(kappa={}))


def body(i):
    return Node(rod(i), rod(i + 1), inertia=1, alpha=fmpq(2, 3), beta=fmpq(2, 3))


def clamp(i):
    return Node(rod(i), rod(i + 1), inertia=0, alpha=0, beta=0, damping=1)


def splice(i):
    return Node(rod(i), rod(i + 1), inertia=0, alpha=2, beta=2)


@pytest.mark.parametrize("m", [2, 3, 4])
def test_clamps_in_a_family_send_back_and_are_told_apart(m):
    """Each function that a clamp sends is that of its own rod: of a family the law is not put into others."""
    made = chain(m, lambda m: Family(1, m - 1, 1, clamp))
    table = full_table(made, 6, fmpq(0))
    assert sum(1 for _ in table.rows()) > 5
    assert not list(differences(made, table))


def test_splices_between_bodies_let_waves_through():
    made = chain(4, lambda m: Family(1, m - 1, 2, body), lambda m: Family(2, m - 2, 2, splice))
    table = full_table(made, 6, fmpq(0))
    assert not list(differences(made, table))
    assert len(delay_equations(made.system)) >= 6


def wrong(**changes):
    return chain(2, lambda m: single(1, lambda: replace(body(1), **changes))).nodes


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"damping": fmpq(-2, 3)}, r"damping \+ \(alpha \+ beta\)/2 is 0 at x = 1; write more than 0"),
        ({"damping": -2}, "is -4/3 at x = 1; write more than 0"),
        ({"loads": (LOAD,)}, "F acts on two nodes; write one"),
        ({"loads": (UnitLoad("a", None, (0, 0, 1, 1)),)}, "a has powers of tau above 2; write lower ones"),
        ({"left": Rod(0, 0, velocity=1)}, "rods that move at tau = 0 and loads exclude each other; write one of them"),
    ],
)
def test_what_nothing_serves_is_refused(changes, words):
    with pytest.raises(WavesymError, match=f"^system: .*{words}$"):
        wrong(**changes)
