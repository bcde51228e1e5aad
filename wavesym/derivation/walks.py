"""Walk polynomials: unit responses as sums over the ways a wave can take from body to body; the second route to tables.

At a rigid body with rate q the node law of (2.3) and (2.4), in s = d/dtau, is

    sent right = (2 p T - 1) from the right + 2 (1 - p) T from the left,        T = q/(s + q),
    sent left  = (2 (1 - p) T - 1) from the left + 2 p T from the right,

where p is the right rod's share of q = (alpha + beta)/2. So whatever leaves a node is unit/s**(power + 1) times a
polynomial with integer coefficients in the letters T and p, one term for each kind of walk: T**j means j visits. The
increments have exp(-q w) w**k with k up to degree - 1, and equal rates are the same letter. Neither delay equations nor
recurrences are used, only nodes and physical time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count, islice
from math import factorial
from typing import Any, NamedTuple

from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx

from wavesym.derivation.table import Function
from wavesym.errors import WavesymError
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Node, Quantity


class Unit(NamedTuple):
    """What a source sends from the node at `x`: `value`/s**(power + 1) times `left`, `right` (0 or a sign).

    From a body it has the body's T as well.
    """

    name: str
    x: int
    value: Quantity
    power: int
    left: int
    right: int


class SentPolynomials(NamedTuple):
    """The polynomials that a node sends to the left and to the right at tau = 0, 1, 2, ..."""

    left: list[Any]
    right: list[Any]


@dataclass(frozen=True)
class Letters:
    """The letters of a chain's bodies: T_1, T_2, ... by distinct rate, p_1, p_2, ... by distinct share.

    `visit[x]` is the body's T, `share[x]` its p, or 2 p where that is a whole number, as between equal shafts.
    """

    rates: Mapping[str, Quantity]
    shares: Mapping[str, Quantity]
    visit: Mapping[int, str]
    share: Mapping[int, str | int]

    @property
    def names(self) -> tuple[str, ...]:
        """All letters."""
        return (*self.rates, *self.shares)

    @cached_property
    def context(self) -> fmpz_mpoly_ctx:
        """The ring of the polynomials, over the integers."""
        return fmpz_mpoly_ctx.get(self.names, Ordering.lex)

    @cached_property
    def symbols(self) -> Mapping[str, fmpz_mpoly]:
        """The letters themselves."""
        return dict(zip(self.names, self.context.gens(), strict=True))


def letters(chain: Chain) -> Letters:
    """The letters of a chain, equal where rates or shares are equal; its numbers may be symbolic (`symbolic`)."""
    rates: dict[str, Quantity] = {}
    shares: dict[str, Quantity] = {}
    visit: dict[int, str] = {}
    share: dict[int, str | int] = {}
    for x, node in enumerate(chain.nodes):
        if node.inertia:
            if node.damping != 0:
                raise WavesymError(f"system: the body at x = {x} has a dashpot, which walk polynomials do not have")
            rate = node.radiation
            visit[x] = _letter("T", rates, rate)
            twice = node.beta / rate
            whole = next((number for number in range(3) if twice == number), None)
            share[x] = _letter("p", shares, twice / 2) if whole is None else whole
    return Letters(rates, shares, visit, share)


def units(chain: Chain) -> tuple[Unit, ...]:
    """The sources of a chain, each at one node: its unit loads, or the contacts of an impact."""
    found = []
    for x, node in enumerate(chain.nodes):
        for load in node.loads:
            ((power, value),) = ((k, c) for k, c in enumerate(load.coefficients) if c != 0)
            factor = value * factorial(power) / node.radiation
            found.append(Unit(load.source, x, factor, power, node.left is not None, 1))
        if not node.inertia and node.left and node.right and node.left.velocity != node.right.velocity:
            jump = (node.left.velocity - node.right.velocity) / 2
            found.append(Unit(f"impact at x = {x}", x, jump, 0, -1, 1))
    return tuple(found)


def walks(
    chain: Chain, unit: Unit, letters: Letters, values: Mapping[str, Any]
) -> Iterator[tuple[SentPolynomials, ...]]:
    """What the nodes send at tau = 0, 1, ..., over unit.value/s**(unit.power + 1); after each tau, all up to there.

    `values` are what is written for the letters: the symbols themselves, or elements of another ring.
    """
    nodes = chain.nodes
    sent = tuple(SentPolynomials([], []) for _ in nodes)
    scatter = [_scattering(node, x, letters, values) for x, node in enumerate(nodes)]
    zero = 0 * next(iter(values.values()))
    for tau in count():
        for x, node in enumerate(nodes):
            a = sent[x - 1].right[tau - 1] if tau and node.left else zero
            b = sent[x + 1].left[tau - 1] if tau and node.right else zero
            (back_left, through_left), (through_right, back_right) = scatter[x]
            start = zero + 1 if tau == 0 and x == unit.x else zero
            if node.inertia:
                start = start * values[letters.visit[x]]
            sent[x].left.append(back_left * a + through_left * b + unit.left * start)
            sent[x].right.append(through_right * a + back_right * b + unit.right * start)
        yield sent


def walks_until(
    chain: Chain, unit: Unit, times: int, letters: Letters, values: Mapping[str, Any]
) -> tuple[SentPolynomials, ...]:
    """What the nodes send at tau = 0, 1, ... times - 1 (see `walks`)."""
    return next(islice(walks(chain, unit, letters, values), times - 1, None))


def function_walks(
    chain: Chain, polynomials: Sequence[SentPolynomials], function: Function, interval: int, step: int
) -> Any:
    """The polynomial that a wave function gains in an interval 1, 2, ... of length `step`; 0 where that is before 0."""
    tau = chain.leaves(*function, step * (interval - 1))
    node = polynomials[function.rod - 1].right if function.function == "f" else polynomials[function.rod].left
    return node[tau] if tau >= 0 else 0 * node[0]


def departures(chain: Chain, step: int, intervals: int) -> int:
    """How many units of tau hold the first `intervals` of every function."""
    functions = (Function(letter, rod) for rod in range(1, chain.m + 1) for letter in "fg")
    return 1 + max(chain.leaves(*function, step * (intervals - 1)) for function in functions)


def _scattering(
    node: Node, x: int, letters: Letters, values: Mapping[str, Any]
) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """(sent left of what comes from the left, from the right), (sent right of the same)."""
    if node.inertia:
        visit, share = values[letters.visit[x]], letters.share[x]
        right = (2 * values[share] if isinstance(share, str) else share) * visit
        left = 2 * visit - right
    else:
        left, right = (_whole(pull / node.radiation) for pull in (node.alpha, node.beta))
    return (left - 1, right), (left, right - 1)


def _whole(value: Quantity) -> int:
    (number,) = (n for n in range(-2, 3) if value == n)  # a node without a body only passes on or sends back
    return number


def _letter(kind: str, known: dict[str, Quantity], value: Quantity) -> str:
    for name, other in known.items():
        if other == value:
            return name
    name = f"{kind}_{len(known) + 1}"
    known[name] = value
    return name
