"""Walk polynomials expanded give the tables again, by another route: no delay equations, no recurrences."""

from dataclasses import replace

import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from wavesym.derivation.table import full_table
from wavesym.derivation.walks import letters, units, walks_until
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE
from wavesym.verification.walks import by_walks

NUMBERS = st.builds(fmpq, st.integers(1, 9), st.integers(1, 5)) | st.just(fmpq(1, 2)) | st.just(fmpq(1001, 2000))


@st.composite
def chains(draw: st.DrawFn) -> Chain:
    """Any of the systems, small, often with equal or nearly equal parameters."""
    system = draw(st.sampled_from([COLLISION, DRIVE, BUILDING_FORCE, BUILDING_GROUND]))
    m = system.smallest + system.step * draw(st.integers(0, 1 if system is COLLISION else 2))
    if system is COLLISION:
        bodies = range(1, m, 2)
        velocity = sorted(draw(st.lists(NUMBERS, min_size=len(bodies), max_size=len(bodies))), reverse=True)
        kappa = {i: draw(NUMBERS) for i in bodies}
        return Chain(system, m, Parameters(kappa, velocity=dict(zip(bodies, velocity, strict=True))))
    if system is DRIVE:
        inertia = {i: draw(NUMBERS) for i in range(1, m + 2)}
        return Chain(system, m, Parameters({i: draw(NUMBERS) for i in range(1, m + 1)}, inertia))
    return Chain(system, m, Parameters({i: draw(NUMBERS) for i in range(m + 1)}))


@settings(max_examples=40)
@given(chains(), st.integers(1, 5))
def test_expanded_walk_polynomials_are_the_table(chain, intervals):
    table = full_table(chain, intervals, fmpq(0))
    assert by_walks(chain, table, intervals, letters(chain)) == table.responses


def test_a_wrong_letter_or_visit_is_seen():
    chain = Chain(DRIVE, 2, Parameters({1: fmpq(1, 3), 2: fmpq(2)}, {1: fmpq(1), 2: fmpq(3), 3: fmpq(2)}))
    table = full_table(chain, 5, fmpq(0))
    names = letters(chain)
    assert by_walks(chain, table, 5, names) == table.responses
    ((p, share),) = names.shares.items()
    for wrong in (
        replace(names, shares={p: share + fmpq(1, 1000)}),
        replace(names, rates={**names.rates, "T_2": names.rates["T_2"] + 1}),
        replace(names, visit={**names.visit, 1: "T_1"}),  # the middle disc taken for the first
    ):
        assert by_walks(chain, table, 5, wrong) != table.responses


def test_by_hand():
    """Two discs, a step of M_1: disc 1 turns at T_1/s, sends that to disc 2 and gets it back as 2 T_2 - 1 of it."""
    chain = Chain(DRIVE, 1, Parameters({1: fmpq(1, 3)}, {1: fmpq(1), 2: fmpq(5)}))
    names = letters(chain)
    first, second = names.symbols["T_1"], names.symbols["T_2"]
    sent = walks_until(chain, units(chain)[0], 3, names, names.symbols)
    assert sent[0].right == [first, 0, (2 * first - 1) * (2 * second - 1) * first]
    assert sent[1].left == [0, (2 * second - 1) * first, 0]


@pytest.mark.parametrize(("equal", "count"), [(True, 2), (False, 5)])
def test_equal_rates_are_one_letter(equal, count):
    floors = {i: fmpq(1, 2) if equal else fmpq(i, 7) for i in range(1, 5)}
    chain = Chain(BUILDING_FORCE, 5, Parameters({0: fmpq(1), **floors, 5: fmpq(3)}))
    assert len(letters(chain).rates) == count
