"""The cost told beforehand against the terms counted afterwards."""

import pytest
from flint import fmpq

from wavesym.derivation.symbolic import generic, in_rates
from wavesym.derivation.table import full_table
from wavesym.derivation.table_size import LARGEST_SYMBOLIC, refuse_costly, symbolic_terms
from wavesym.errors import CostError
from wavesym.numbers.ratio import Ratio
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE


def counted(chain, intervals):
    values = [row.value for row in full_table(chain, intervals, fmpq(0)).rows()]
    return sum(len(factor) for v in values if isinstance(v, Ratio) for factor, _ in v.factorization.numerator)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("system", "interval", "m", "intervals"),
    [
        (DRIVE, 1, 1, 16),
        (DRIVE, 1, 2, 9),
        (DRIVE, 1, 2, 12),
        (DRIVE, 1, 3, 7),
        (DRIVE, 1, 8, 4),
        (BUILDING_FORCE, 2, 2, 8),
        (BUILDING_FORCE, 2, 4, 5),
        (BUILDING_GROUND, 2, 3, 6),
        (COLLISION, 2, 8, 6),
        (COLLISION, 2, 16, 4),
    ],
)
def test_as_many_terms_as_foretold(system, interval, m, intervals):
    """At most twice as many; fewer for collisions, which have a single source."""
    chain = in_rates(generic(system, m)).chain
    ratio = symbolic_terms(chain, interval, intervals) / counted(chain, intervals)
    assert 1 / 2 < ratio < 8


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("system", "m", "intervals"),
    [(DRIVE, 3, 14), (DRIVE, 30, 2), (DRIVE, 3, 10**9), (BUILDING_FORCE, 12, 1), (COLLISION, 40, 10**6)],
)
def test_the_absurd_is_refused_before_it_is_paid_for(system, m, intervals):
    chain = in_rates(generic(system, m)).chain
    with pytest.raises(CostError, match=r"--intervals: the symbolic tables would have (about|more than)"):
        refuse_costly(chain, intervals, fmpq(0))
    with pytest.raises(CostError, match=r"output\.until"):
        refuse_costly(chain, None, fmpq(2 * intervals + 1))


def test_what_the_project_promises_is_not_refused():
    for system, interval, m, intervals in ((DRIVE, 1, 3, 9), (BUILDING_FORCE, 2, 3, 6)):
        chain = in_rates(generic(system, m)).chain
        refuse_costly(chain, intervals, fmpq(0))
        assert symbolic_terms(chain, interval, intervals) < LARGEST_SYMBOLIC / 5
