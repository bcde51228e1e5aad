"""Unit responses: the recurrences run for the functions and intervals that are asked for, and those they rest on."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from graphlib import TopologicalSorter
from heapq import heapify, heappop, heappush
from math import inf
from typing import NamedTuple

from flint import fmpq

from wavesym.derivation.increments import Increment, add, apply, solve, start
from wavesym.derivation.rules import Rule
from wavesym.derivation.table_size import refuse_large
from wavesym.mechanics.chain import Chain


class Function(NamedTuple):
    """Wave function "f" or "g" of a rod."""

    function: str
    rod: int


class Part(NamedTuple):
    """A wave function in an output: `factor` times its derivative (or the function itself), `delay` later."""

    factor: int | fmpq
    function: Function
    delay: fmpq


class Row(NamedTuple):
    """One coefficient of a table, as in docs/reference/formats.md; all exact.

    Of a chain that is written out, `rod` may be a name, and `interval` is the tau at which the wave leaves its end.
    """

    function: str
    rod: int | str
    source: str
    interval: int | fmpq | Fraction
    rate: fmpq | Fraction
    power: int
    value: fmpq | Fraction


class Rules:
    """The rules of a chain by function, each derived when it is first asked for."""

    def __init__(self, chain: Chain) -> None:
        # SymPy is needed only here, where rules are made
        from wavesym.derivation.recurrence import recurrence

        self._chain = chain
        self._recurrence = recurrence(chain.system)
        self._rules: dict[Function, Rule] = {}
        self.interval = self._recurrence.interval

    def __getitem__(self, function: Function) -> Rule:
        if function not in self._rules:
            self._rules[function] = self._recurrence.rule(self._chain, *function)
        return self._rules[function]


@dataclass(frozen=True)
class Table:
    """Increments of functions, per source: `responses[source][function][n - 1]` is that of interval n.

    An interval is `interval` long; it starts at interval * (n - 1) on the function's own clock (Table 1).
    """

    interval: int
    responses: Mapping[str, Mapping[Function, list[Increment]]]

    def rows(self) -> Iterator[Row]:
        """Every coefficient that is not 0, in the order function, rod, source, interval, rate, power."""
        numbered = {
            source: {function: list(enumerate(increments, 1)) for function, increments in response.items()}
            for source, response in self.responses.items()
        }
        return table_rows(numbered, lambda function: function.rod)


def table_rows(
    responses: Mapping[str, Mapping[Function, Iterable[tuple[int | fmpq, Increment]]]],
    rod: Callable[[Function], int | str],
) -> Iterator[Row]:
    """Every coefficient that is not 0 of increments, each with its interval, by source and function.

    They come in the order function, rod, source, interval, rate, power; `rod` names that of a function.
    """
    for function in sorted({function for response in responses.values() for function in response}):
        for source, response in responses.items():
            for interval, increment in response.get(function, ()):
                for rate in sorted(increment):
                    for power, value in enumerate(increment[rate]):
                        if value != 0:
                            yield Row(function.function, rod(function), source, interval, rate, power, value)


def required_intervals(rules: Rules, wanted: Mapping[Function, int]) -> dict[Function, int]:
    """How many intervals of which functions the `wanted` ones rest on (their light cone), they themselves included."""
    intervals: dict[Function, int] = {}
    ends = [(-count, function) for function, count in wanted.items() if count > 0]
    heapify(ends)
    while ends:  # most intervals first, so that every function is met once
        count, function = heappop(ends)
        if function not in intervals:
            intervals[function] = -count
            for term in rules[function].terms:
                if -count > term.back:
                    heappush(ends, (count + term.back, Function(term.function, term.rod)))
    return intervals


def unit_response(rules: Rules, source: str, wanted: Mapping[Function, int]) -> dict[Function, list[Increment]]:
    """The increments that a unit of `source` gives in the first `wanted[function]` intervals of every function.

    Functions that these rest on are included, as far as they are needed.
    """
    intervals = required_intervals(rules, wanted)
    order = _order(rules, intervals)
    first = _first_arrivals(rules, source, intervals)
    response: dict[Function, list[Increment]] = {
        function: [{}] * min(first.get(function, count), count) for function, count in intervals.items()
    }
    for n in range(max(intervals.values(), default=0)):
        for function in order:
            if len(response[function]) == n < intervals[function]:
                response[function].append(_increment(rules[function], source, response, n))
    return response


def _first_arrivals(rules: Rules, source: str, functions: Iterable[Function]) -> dict[Function, int]:
    """How many intervals pass at every function before a source can reach it; without those that it never reaches."""
    users: dict[Function, list[tuple[Function, int]]] = defaultdict(list)
    coming = []
    for function in functions:
        rule = rules[function]
        for term in rule.terms:
            users[Function(term.function, term.rod)].append((function, term.back))
        coming += [(load.back, function) for load in rule.loads if load.source == source]
    heapify(coming)
    first: dict[Function, int] = {}
    while coming:  # least intervals first, so that every function is met once
        passed, function = heappop(coming)
        if function not in first:
            first[function] = passed
            for user, back in users[function]:
                heappush(coming, (passed + back, user))
    return first


def _order(rules: Rules, intervals: Mapping[Function, int]) -> list[Function]:
    """Functions such that whatever one needs from its own interval comes before it."""
    graph = {
        function: [Function(t.function, t.rod) for t in rules[function].terms if t.back == 0] for function in intervals
    }
    return list(TopologicalSorter(graph).static_order())


def _increment(rule: Rule, source: str, response: Mapping[Function, list[Increment]], n: int) -> Increment:
    right: Increment = {}
    jump = fmpq(0)
    for term in rule.terms:
        if term.back <= n:
            increment = response[Function(term.function, term.rod)][n - term.back]
            if increment:
                apply(term.weights, increment, right)
                jump += term.weights.jump * start(increment)
    for load in rule.loads:
        if load.back == n and load.source == source:
            add(right, {fmpq(0): [fmpq(0)] * load.power + [load.value]})
    return solve(rule.own, right, jump)


def interval_counts(
    chain: Chain, interval: int, intervals: int | None, until: fmpq, most: float = inf
) -> dict[Function, int]:
    """How many intervals of each function a table has; CostError as of `full_table`."""
    wanted = {}
    for rod in range(1, chain.m + 1):
        for function in "fg":
            # the argument is latest at the end towards which the wave came
            latest = until - chain.leaves(function, rod, 0)
            wanted[Function(function, rod)] = (
                intervals if intervals is not None else max(0, int((fmpq(latest) / interval).floor()) + 1)
            )
    refuse_large(chain, interval, wanted, chain.sources, "output.until" if intervals is None else "--intervals", most)
    return wanted


def full_table(chain: Chain, intervals: int | None, until: fmpq, most: float = inf) -> Table:
    """All functions of all rods, all sources: `intervals` of each, or those that reach its rod until tau = `until`.

    CostError beyond about `most` coefficients, or what half a minute makes (table_size.py). The numbers are of the
    chain's kind: exact, or symbolic (`symbolic`).
    """
    rules = Rules(chain)
    wanted = interval_counts(chain, rules.interval, intervals, until, most)
    responses = {}
    for source in chain.sources:
        response = unit_response(rules, source, wanted)
        responses[source] = {function: response.get(function, [])[:count] for function, count in wanted.items()}
    return Table(rules.interval, responses)
