"""Tables of any network: what every wave gains, at the exact tau at which it leaves its end of a rod."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf

from flint import fmpq

from wavesym.exact.tables.network_response import RuledNetwork, Timed, function_of
from wavesym.exact.tables.table import Function, Row
from wavesym.mechanics.network import Network


@dataclass(frozen=True)
class NetworkTable:
    """Increments of functions, per source: `responses[source][function]` are pairs of a tau and what is gained then."""

    network: Network
    responses: Mapping[str, Mapping[Function, Timed]]

    def rod(self, function: Function) -> int | str:
        """The name of a function's rod, or its number."""
        return self.network.bars[function.rod - 1].name or function.rod

    def rows(self) -> Iterator[Row]:
        """Every coefficient that is not 0, in the order function, rod, source, interval, rate, power."""
        functions = sorted({function for response in self.responses.values() for function in response})
        for function in functions:
            for source, response in self.responses.items():
                for time, increment in response.get(function, ()):
                    for rate in sorted(increment):
                        for power, value in enumerate(increment[rate]):
                            if value != 0:
                                yield Row(function.function, self.rod(function), source, time, rate, power, value)


def network_table(network: Network, intervals: int | None, until: fmpq, most: float = inf) -> NetworkTable:
    """All waves of all rods, all sources: the first `intervals` of each, or those that leave their ends until `until`.

    UnservedError where a joint's polynomial does not split over the rationals; CostError beyond about `most`
    coefficients, or what half a minute makes.
    """
    ruled = RuledNetwork(network)
    for number in range(len(network.joints)):
        ruled.joints.response(number)
    every = [Function(letter, rod) for letter in "fg" for rod in range(1, len(network.bars) + 1)]
    responses = {}
    asked = "output.until" if intervals is None else "--intervals"
    for source in ruled.joints.sources:
        reach = dict.fromkeys(every, until)
        if intervals is not None:
            reach = {function_of(end): time for end, time in ruled.foreseen.nth(source, intervals).items()}
        responses[source] = ruled.responses(source, reach, most, asked)
    return NetworkTable(network, responses)
