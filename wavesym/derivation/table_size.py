"""How large an exact table will be, told before it is made: its coefficients, and the memory that their digits take.

A wave that reaches a rod 2 e later than the shortest way from its load has been to and fro between neighbours e times.
By then it can have met a body e + 1 times, so that an increment has as many powers at that body's rate, and in all
about (e + 1) * (bodies met), unless rates are equal. Every difference of two rates was divided by as often as there are
powers, so the digits of a coefficient are in proportion to their number.

In letters: a numerator is homogeneous in the k letters that its waves have met, of a degree in proportion to the visits
v = (time of the table) / 2 that a body can have had, and the coefficients are in proportion to v**2: about v**(k+1)
terms. Counted for drives and buildings of two to nine bodies they were 4 to 15 times that, for collisions fewer.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import factorial, inf, log2, log10
from typing import NamedTuple, TypeVar

from flint import fmpq

from wavesym.errors import CostError
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Node, Quantity
from wavesym.numbers.ratio import Ratio

LARGEST = 400_000_000  # bytes; made and written in half a minute
MOST_WORK = 1e6  # half a minute
_ENTRY = 80  # bytes of an increment, if it is empty too
_COEFFICIENT = 120  # bytes of one without digits
_AT_ONCE = 100_000  # detours times rods
LARGEST_SYMBOLIC = 3_500_000  # terms; 280 bytes and 5 microseconds each were measured, writing them included
_DIGITS, _LONG = 4000, 1.6  # from so many bits on coefficients take longer, and by which power

K = TypeVar("K", bound=tuple[str, int])


class Size(NamedTuple):
    """About how many coefficients a table has that are not 0, how many bytes it takes, and how much work it is.

    Work is counted in coefficients of few digits; one of b bits takes as long as 1 + (b / 4000)**1.6 of them.
    """

    coefficients: float
    bytes: float
    work: float


def table_size(chain: Chain, interval: int, wanted: Mapping[K, int], sources: Iterable[str]) -> Size:
    """The size of the unit responses of `sources` in the first `wanted[function, rod]` intervals, `interval` long.

    What they rest on is included. No coefficients are counted where the increments alone are beyond `LARGEST`.
    """
    import numpy as np  # of large tables alone: see `_small`

    latest = _latest(chain, interval, wanted)
    rods = np.array(sorted(latest))
    starts = np.array([_first(chain, rod) for rod in rods.tolist()])
    last = np.array([latest[rod] for rod in rods.tolist()])
    places = _places(chain, set(sources))
    increments = 2 * len(places) * float(np.sum((last - starts) // interval + 1))
    if _ENTRY * increments > LARGEST:
        return Size(0, _ENTRY * increments, 0)
    rates = {node.rate for node in chain.nodes if node.inertia}
    bodies = sum(bool(node.inertia) for node in chain.nodes)
    dense = bodies / len(chain.nodes)
    height = mean_bits(rates)
    coefficients = bits = work = 0.0
    for nodes in places.values():
        # how far it is from the load to the nearer end of each rod
        near = np.array(nodes)
        right = np.searchsorted(near, rods)
        far = np.minimum(
            np.where(right < len(near), near[np.minimum(right, len(near) - 1)] - rods, inf),
            np.where(right > 0, rods - 1 - near[np.maximum(right - 1, 0)], inf),
        )
        detours = np.maximum((last - far) // 2 + 1, 0)
        most = int(np.max(detours, initial=0))
        for first in range(0, most, step := 1 + _AT_ONCE // len(rods)):
            e = np.arange(first, min(first + step, most))[:, np.newaxis]
            met = far + 1 + e
            powers = np.minimum((e + 1) * np.minimum(bodies, met), len(rates) * dense * (met + e))
            powers = np.where(detours > e, powers, 0.0)
            coefficients += 2 * float(np.sum(powers))
            bits += 2 * float(np.sum(powers**2)) * height
            work += 2 * float(np.sum(powers * (1 + (powers * height / _DIGITS) ** _LONG)))
    return Size(coefficients, _ENTRY * increments + _COEFFICIENT * coefficients + bits / 8, work)


def response_size(powers: Iterable[int], height: float) -> Size:
    """The size of increments of which each has so many coefficients; `height` are the bits of a rate."""
    counts = [float(count) for count in powers]
    bits = sum(count**2 for count in counts) * height
    work = sum(count * (1 + (count * height / _DIGITS) ** _LONG) for count in counts)
    coefficients = sum(counts)
    return Size(coefficients, _ENTRY * len(counts) + _COEFFICIENT * coefficients + bits / 8, work)


def refuse_large(
    chain: Chain,
    interval: int,
    wanted: Mapping[K, int],
    sources: Iterable[str],
    key: str,
    most: float = inf,
) -> None:
    """CostError, for the key or option `key`, where a table is beyond `LARGEST` bytes, `MOST_WORK` or `most` work."""
    sources = set(sources)
    if not _small(chain, interval, wanted, sources, most):
        refuse_size(table_size(chain, interval, wanted, sources), key, most)


def _small(chain: Chain, interval: int, wanted: Mapping[K, int], sources: set[str], most: float) -> bool:
    """Whether a table would not be too large if all its increments had as many powers as any can have."""
    latest = _latest(chain, interval, wanted)
    bodies = [node.rate for node in chain.nodes if node.inertia]
    powers = (max(latest.values(), default=0) // 2 + 1) * len(bodies)
    instants = sum(last - min(_first(chain, rod), 0) + 1 for rod, last in latest.items())
    increments = 2 * len(_places(chain, sources)) * instants
    size = response_size([powers], mean_bits(set(bodies)))
    return increments * size.bytes <= LARGEST and increments * size.work <= min(most, MOST_WORK)


def refuse_size(size: Size, key: str, most: float = inf, parts: str = "fewer rods") -> None:
    """The same for a size that is known, of a chain with less to work on where it has fewer `parts`."""
    fewer = "a shorter horizon" if key == "output.until" else "fewer intervals"
    if size.bytes > LARGEST:
        raise CostError(
            f"{key}: the tables of coefficients would take {size.bytes:.1e} bytes, the limit is {LARGEST:.1e} "
            f"({fewer} or {parts} helps)"
        )
    if size.work > min(most, MOST_WORK):
        digits = size.bytes / max(size.coefficients, 1) * log10(2) * 8
        raise CostError(
            f"{key}: the tables would hold {size.coefficients:.1e} coefficients of about {digits:.0e} digits, "
            f"work for {size.work:.1e} short ones, the limit is {min(most, MOST_WORK):.1e} ({fewer}, or fewer "
            "digits in the scene's numbers, helps)"
        )


def _latest(chain: Chain, interval: int, wanted: Mapping[K, int]) -> dict[int, int]:
    """Until when the waves of which rods matter: one of a neighbour must have the time to come."""
    latest: dict[int, int] = {}
    for (function, rod), count in wanted.items():
        if count > 0:
            latest[rod] = max(latest.get(rod, -1), chain.leaves(function, rod, interval * (count - 1)))
    for rods, before in ((range(1, chain.m + 1), -1), (range(chain.m, 0, -1), 1)):
        for rod in rods:
            reached = latest.get(rod + before, 0) - 1
            if reached >= _first(chain, rod):
                latest[rod] = max(latest.get(rod, -1), reached)
    return latest


def _first(chain: Chain, rod: int) -> int:
    return min(chain.leaves(function, rod, 0) for function in ("f", "g"))


def _places(chain: Chain, sources: set[str]) -> dict[str, list[int]]:
    """The nodes at which sources act; an impact acts where velocities meet."""
    places: dict[str, list[int]] = defaultdict(list)
    for x, node in enumerate(chain.nodes):
        names = [load.source for load in node.loads]
        if node.left and node.right and node.left.velocity != node.right.velocity:
            names.append("impact")
        for name in sources.intersection(names):
            places[name].append(x)
    return places


def mean_bits(rates: Collection[Quantity]) -> float:
    """How many bits a rate has."""
    return sum(map(_bits, rates)) / max(len(rates), 1)


def _bits(rate: Quantity) -> int:
    """Those of numerator and denominator; letters are counted elsewhere."""
    if not isinstance(rate, int | Fraction | fmpq):
        return 0
    return int(rate.numerator).bit_length() + int(rate.denominator).bit_length()


# in letters


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
        key, fewer = ("output.until", "a shorter horizon") if intervals is None else ("--intervals", "fewer intervals")
        foretold = f"about {terms:.1e}" if terms < inf else "more than 1e+30"
        raise CostError(
            f"{key}: the symbolic tables would have {foretold} terms in {count} intervals, the limit is "
            f"{LARGEST_SYMBOLIC:.1e} ({fewer}, or more that is equal in the scene, helps)"
        )
