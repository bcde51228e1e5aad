"""The tables of a named system as the paper has them: by the law of its joints, on the clock of each function."""

from __future__ import annotations

from math import inf

from flint import fmpq

from wavesym.derivation.increments import Increment
from wavesym.derivation.recurrence import recurrence
from wavesym.derivation.table import Table, interval_counts
from wavesym.exact.tables.network_joints import START
from wavesym.exact.tables.network_table import RuledNetwork, Timed
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.network import Network

IMPACT = "impact"
"""What the paper's tables call the start of a collision."""


def named_table(chain: Chain, network: Network, intervals: int | None, until: fmpq, most: float = inf) -> Table:
    """Make the table of a named system: the one that its recurrences make, too.

    Args:
        chain: the system with its clocks.
        network: the same as programs have it.
        intervals: how many of each function; None for those that reach its rod until tau = `until`.
        until: the horizon.
        most: coefficients, about.

    Returns:
        The increments of all functions of all rods, for each source, by intervals.

    Raises:
        CostError: beyond about `most` coefficients, or what half a minute makes.
    """
    interval = recurrence(chain.system).interval
    counts = interval_counts(chain, interval, intervals, until, most)
    starts = {function: chain.leaves(*function, 0) for function in counts}
    ruled = RuledNetwork(network)
    reach = {function: fmpq(starts[function] + interval * (count - 1)) for function, count in counts.items() if count}
    responses = {}
    for source in chain.sources:
        gained = ruled.responses(START if source == IMPACT else source, reach, None)
        responses[source] = {
            function: _by_interval(gained.get(function, ()), starts[function], interval, count)
            for function, count in counts.items()
        }
    return Table(interval, responses)


def _by_interval(gained: Timed, start: int, interval: int, count: int) -> list[Increment]:
    """The increments of intervals 1 ... count, empty where nothing is gained."""
    increments: list[Increment] = [{} for _ in range(count)]
    for time, increment in gained:
        increments[int((time - start) / interval)] = increment
    return increments
