"""One law beneath everything: what SymPy derives at a node is what tables, pieces and marches run."""

from __future__ import annotations

import pytest
from sympy import Symbol

import wavesym
from tests.support.generated import files
from wavesym import api
from wavesym.derivation import node_law as derived
from wavesym.derivation.delay import _at_node, delay_equations
from wavesym.derivation.node_law import ALPHA, BETA, DAMPING, INERTIA, node_law
from wavesym.derivation.recurrence import joint_rule, recurrence, stretch_law
from wavesym.mechanics.node import Node, Rod
from wavesym.scene import Scene, lower

REST = Rod(0, 0)
SCENE = Scene(
    name="spine",
    system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
    load=[{"times": [0], "a": [1], "b": [0]}],
    output={"until": 5, "tolerance": 1e-6, "strain": ["1/2"]},
)
CHAIN = Scene(
    name="stepped",
    system={"type": "chain", "parts": [{"mass": 2, "name": "a"}, {"rod": 1}, {"rod": "3/2", "impedance": 3}, "fixed"]},
    load=[{"at": "a", "times": [0], "steps": [1]}],
    output={"until": 5, "tolerance": 1e-6, "strain": ["1-"]},
)
KINDS = ("closed", "pieces", "march")


def forget() -> None:
    for cached in (node_law, delay_equations, recurrence, joint_rule):
        cached.cache_clear()


@pytest.fixture
def balance(monkeypatch):
    """(2.4) put in place of what it is; all that was derived is forgotten before and after."""
    right = derived._balance

    def put(other):
        monkeypatch.setattr(derived, "_balance", lambda left, strain: other(right, left, strain))
        forget()

    yield put
    monkeypatch.undo()
    forget()


def tables():
    return {kind: files(lower(SCENE), "c", kind)["spine.c"] for kind in KINDS} | {"table": wavesym.tables(SCENE)}


def test_the_law_is_that_of_the_paper_by_hand():
    law = node_law()
    assert law.own == (INERTIA, DAMPING + ALPHA / 2 + BETA / 2)
    assert (law.left, law.right, law.load) == (ALPHA, BETA, 1)


def test_on_a_stretch_powers_go_up():
    own = stretch_law(node_law()).own
    k = Symbol("k", integer=True, nonnegative=True)
    assert own.same == DAMPING + ALPHA / 2 + BETA / 2
    assert (own.next_power - INERTIA * (k + 1)).expand() == 0


def test_a_rod_end_is_a_dashpot_and_a_force():
    """Seen from its end a rod is a dashpot Z and a force 2 Z a, on either side."""
    assert joint_rule() == (1, 1, 1, (1, 1), (2, 2))


def of_a_chain():
    made = {kind: files(lower(CHAIN), "c", kind)["stepped.c"] for kind in ("closed", "pieces")}
    return made | {"table": wavesym.tables(CHAIN), "text": api.derive(CHAIN, None)}


@pytest.mark.parametrize("factor", [2, -1])
def test_another_coefficient_is_another_chain(balance, factor):
    before = of_a_chain()
    balance(lambda right, left, strain: right(left, strain) + factor * derived.BETA * derived._B / 64)
    after = of_a_chain()
    for kind, made in before.items():
        assert after[kind] != made, kind


@pytest.mark.parametrize("kind", ["closed", "pieces"])
def test_without_a_derivation_no_chain_is_generated(balance, kind, tmp_path):
    def blocked(*_):
        raise RuntimeError("no derivation")

    balance(blocked)
    with pytest.raises(RuntimeError, match="no derivation"):
        wavesym.generate(CHAIN, tmp_path, evaluator=kind)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("factor", [2, -1])
def test_another_coefficient_is_another_table_and_other_programs(balance, factor):
    before = tables()
    balance(lambda right, left, strain: right(left, strain) + factor * derived.BETA * derived._B / 64)
    after = tables()
    for kind, made in before.items():
        assert after[kind] != made, kind


def test_the_same_law_again_is_the_same_table_and_the_same_programs(balance):
    before = tables()
    balance(lambda right, left, strain: right(left, strain))
    assert tables() == before


@pytest.mark.parametrize("kind", KINDS)
def test_without_a_derivation_nothing_is_generated(balance, kind, tmp_path):
    def blocked(*_):
        raise RuntimeError("no derivation")

    balance(blocked)
    with pytest.raises(RuntimeError, match="no derivation"):
        wavesym.generate(SCENE, tmp_path, evaluator=kind)
    assert not list(tmp_path.iterdir())


def test_delay_equations_need_to_know_which_wave_is_ahead():
    clock = Symbol("clock")
    node = Node(Rod(clock, 0), REST, inertia=1, alpha=2, beta=2)
    with pytest.raises(ValueError, match="which wave is ahead"):
        _at_node(node, 1)
