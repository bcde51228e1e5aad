"""The exact tables by another route: the node law in physical time."""

from copy import deepcopy
from dataclasses import replace

import pytest
from flint import fmpq

from tests.support.physical_time import differences, unit_waves
from wavesym.derivation import table as tables
from wavesym.derivation.table import Function, full_table
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

KAPPAS = {
    "different": [fmpq(1, 3), fmpq(2, 5), fmpq(7, 4), fmpq(1, 2), fmpq(3, 7), fmpq(5, 6), fmpq(2, 3)],
    "equal": [fmpq(1, 2)] * 7,
    # rates of one node meet those of another: 2 kappa_1 = kappa_2 and so on
    "meeting": [fmpq(1, 4), fmpq(1, 2), fmpq(1), fmpq(1, 2), fmpq(1, 4), fmpq(1), fmpq(1, 2)],
}
INERTIAS = {
    "different": [fmpq(1), fmpq(2), fmpq(3, 5), fmpq(5), fmpq(4, 3), fmpq(7), fmpq(1, 2)],
    "equal": [fmpq(1)] * 7,
    "meeting": [fmpq(1), fmpq(2), fmpq(1), fmpq(2), fmpq(1), fmpq(1), fmpq(1)],
}


def collision(m, parameters="different"):
    bodies = range(1, m, 2)
    return Chain(
        COLLISION,
        m,
        Parameters(
            kappa=dict(zip(bodies, KAPPAS[parameters], strict=False)),
            velocity={i: fmpq(m - i, 3) for i in bodies},
        ),
    )


def drive(m, parameters="different"):
    kappa, inertia = KAPPAS[parameters][:m], INERTIAS[parameters][: m + 1]
    return Chain(DRIVE, m, Parameters(kappa=dict(enumerate(kappa, 1)), inertia=dict(enumerate(inertia, 1))))


def building(system):
    return lambda m, parameters="different": Chain(
        system, m, Parameters(kappa=dict(enumerate(KAPPAS[parameters][: m + 1])))
    )


RANGE = [
    *(pytest.param(collision, m, 8, id=f"collision-{m}") for m in (4, 6)),
    *(pytest.param(drive, m, 2 * m + 4, id=f"drive-{m}") for m in range(1, 5)),
    *(pytest.param(drive, m, 2 * m + 4, id=f"drive-{m}", marks=pytest.mark.slow) for m in (5, 6)),
    *(pytest.param(building(BUILDING_FORCE), m, 8, id=f"force-{m}") for m in range(2, 7)),
    *(pytest.param(building(BUILDING_GROUND), m, 8, id=f"ground-{m}") for m in range(2, 7)),
]


@pytest.mark.quick(3)
@pytest.mark.parametrize("parameters", KAPPAS)
@pytest.mark.parametrize(("make", "m", "intervals"), RANGE)
def test_tables_are_right(make, m, intervals, parameters):
    chain = make(m, parameters)
    table = full_table(chain, intervals, fmpq(0))
    for source in chain.sources:
        response = table.responses[source]
        assert {len(increments) for increments in response.values()} == {intervals}
        assert len(response) == 2 * m
        assert any(any(increments) for increments in response.values())
    assert not list(differences(chain, table))


@pytest.mark.parametrize("make", [collision, drive, building(BUILDING_FORCE), building(BUILDING_GROUND)])
def test_wrong_starts_throughout_are_seen(make, monkeypatch):
    """Tables whose every start is wrong, and all else follows from it, solve the delay equations just as well."""
    right = tables.solve

    def wrong(own, right_side, jump):
        return right(own, right_side, jump + 1)

    monkeypatch.setattr(tables, "solve", wrong)
    chain = make(4)
    assert list(differences(chain, full_table(chain, 5, fmpq(0))))


def test_every_changed_coefficient_is_seen():
    chain = drive(2)
    true = full_table(chain, 5, fmpq(0))
    for row in true.rows():
        table = deepcopy(true)
        increment = table.responses[row.source][Function(row.function, row.rod)][row.interval - 1]
        increment[row.rate][row.power] += fmpq(1, 10**9)
        assert list(differences(chain, table))


def test_a_missing_increment_is_seen():
    chain = building(BUILDING_FORCE)(2)
    table = full_table(chain, 6, fmpq(0))
    response = {function: list(increments) for function, increments in table.responses["a"].items()}
    response[Function("g", 1)][2] = {}
    assert list(differences(chain, replace(table, responses={**table.responses, "a": response})))


def test_node_law_first_waves_by_hand():
    """A step of M_1: the first disc follows q' + kappa q = kappa and sends q on; the last answers one unit later."""
    chain = drive(1)
    kappa = chain.parameters.kappa[1]
    first, last = unit_waves(chain, "M1", 2)
    assert {rate: polynomial.coeffs() for rate, polynomial in first.right[0].items()} == {0: [1], kappa: [-1]}
    assert first.right[1] == {}
    assert last.left[0] == {}
    assert last.left[1] != {}


def test_node_law_refuses_an_unknown_source():
    with pytest.raises(ValueError, match="M9"):
        unit_waves(drive(1), "M9", 2)
