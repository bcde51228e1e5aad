"""What a symbolic table will cost, told before it is made: how many terms its polynomials have.

A numerator is homogeneous in the k letters that its waves have met, of a degree in proportion to the visits
v = (time of the table) / 2 that a body can have had, and the coefficients are in proportion to v**2: about v**(k+1)
terms. Counted for drives and buildings of two to nine bodies they were 4 to 15 times that, for collisions fewer.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import factorial, inf, log2

from flint import fmpq

from wavesym.errors import CostError
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Node
from wavesym.numbers.ratio import Ratio

LARGEST_SYMBOLIC = 3_500_000  # terms; 280 bytes and 5 microseconds each were measured, writing them included


def symbolic_terms(chain: Chain, interval: int, intervals: int) -> float:
    """About how many terms the table of a chain in letters has, with what is multiplied out on the way to it.

    `interval` is how long an interval is; infinite where it is beyond 1e30.
    """
    time = interval * intervals
    reach = time - interval + 1 + max(int(chain.rod(i).tau0) for i in range(1, chain.m + 1))
    # who is met: as many neighbours as waves can reach
    windows = [chain.nodes[x : x + reach] for x in range(max(1, chain.m + 2 - reach))]
    letters = max(len(set(_letters(window))) for window in windows)
    families = max(len({node.alpha + node.beta for node in window if node.inertia}) for window in windows)
    visits = max(time / 2, 1.0)
    if (letters + 1) * log2(visits) > 100 or families > 100:
        return inf
    # a closure sums over families with all their differences below: up to as many terms as permutations
    summed = 1 + factorial(families) / 200
    return 9 * visits ** (letters + 1) * summed * max(1.0, chain.m / reach) + _loads(chain)


def _letters(nodes: Sequence[Node]) -> Iterator[int]:
    """The letters that the equations at some nodes have."""
    for node in nodes:
        for ratio in (node.alpha, node.beta):
            if isinstance(ratio, Ratio):
                yield from ratio.letters


def _loads(chain: Chain) -> float:
    """The terms of a load on the last body: the ratio of inertia to the first one's, multiplied out."""
    inertia = chain.parameters.inertia
    first = inertia[min(inertia)] if inertia else None
    if not isinstance(first, Ratio):
        return 0.0
    return float(2 ** sum(len(first.ring.forms[form]) > 1 for form in first.denominator))


def refuse_costly(chain: Chain, intervals: int | None, until: fmpq) -> None:
    """CostError where a symbolic table, asked for as in `full_table`, would take about a minute or a gigabyte."""
    from wavesym.derivation.recurrence import recurrence  # SymPy is needed only here, where rules are made

    interval = recurrence(chain.system).interval
    count = intervals if intervals is not None else int((until / interval).floor()) + 1
    terms = symbolic_terms(chain, interval, count)
    if terms > LARGEST_SYMBOLIC:
        asked, fewer = (
            ("output.until", "a shorter horizon") if intervals is None else ("--intervals", "fewer intervals")
        )
        foretold = f"about {terms:.1e}" if terms < inf else "more than 1e+30"
        raise CostError(
            f"{asked}: the symbolic tables would have {foretold} terms in {count} intervals, at most "
            f"{LARGEST_SYMBOLIC:.1e} expected ({fewer}, or more that is equal in the scene, helps)"
        )
