"""Increments: what a wave function gains at the start of an interval, and the rules that give them.

An increment is sum_g exp(-g w) sum_k F[g,k] w**k in the local variable w, kept as {g: [F[g,0], F[g,1], ...]} with exact
numbers, the last of each list not 0. Rate 0 is a rate like the others; equal rates are one.
"""

from __future__ import annotations

from collections.abc import Iterable

from flint import fmpq

from wavesym.derivation.rules import DERIVATIVE, Weights

Increment = dict[fmpq, list[fmpq]]
_ZERO, _ONE = fmpq(0), fmpq(1)


def add(total: Increment, part: Increment, factor: fmpq = _ONE) -> None:
    """Add `factor` times `part` to `total`, in place."""
    for rate, powers in part.items():
        out = total.setdefault(rate, [])
        out += [_ZERO] * (len(powers) - len(out))
        for k, value in enumerate(powers):
            out[k] += factor * value


def apply(weights: Weights, increment: Increment, total: Increment) -> None:
    """Add an operator on an increment, same(g) F[g,k] + raised(k) F[g,k+1], to `total`, in place."""
    (s0, s1), (r0, r1), jump = weights
    for rate, powers in increment.items():
        out = total.setdefault(rate, [])
        out += [_ZERO] * (len(powers) - len(out))
        same = s0 + s1 * rate
        if same != 0:
            for k, value in enumerate(powers):
                out[k] += same * value
        if jump != 0:
            for k in range(1, len(powers)):
                out[k - 1] += (r0 + r1 * (k - 1)) * powers[k]


def solve(own: Weights, right: Increment, jump: fmpq) -> Increment:
    """The increment F with own F = right and own.jump sum_g F[g,0] = jump.

    Where own.same(g) is not 0 powers go down from the highest; at the operator's own rate, where it is 0, they go up,
    and F[g,0] is what makes the jump right: the body's velocity is continuous.
    """
    (s0, s1), (r0, r1), own_jump = own
    result: Increment = {}
    for rate, powers in right.items():
        same = s0 + s1 * rate
        if same == 0:
            result[rate] = [_ZERO, *(value / (r0 + r1 * k) for k, value in enumerate(powers))]
            continue
        found = [_ZERO] * len(powers)
        above = _ZERO
        for k in reversed(range(len(powers))):
            value = powers[k]
            if above != 0:
                value = value - (r0 + r1 * k) * above
            above = found[k] = value / same
        result[rate] = found
    if own_jump != 0:
        closure = jump / own_jump - start(result)
        if closure != 0:
            add(result, {-s0 / s1: [closure]})
    return trim(result)


def start(increment: Increment) -> fmpq:
    """The jump: the increment at w = 0."""
    return sum((powers[0] for powers in increment.values()), _ZERO)


def trim(increment: Increment) -> Increment:
    """Without vanishing highest powers and empty rates."""
    if all(powers and powers[-1] != 0 for powers in increment.values()):
        return increment
    result: Increment = {}
    for rate, powers in increment.items():
        length = len(powers)
        while length and powers[length - 1] == 0:
            length -= 1
        if length:
            result[rate] = powers[:length]
    return result


def integrate(increment: Increment) -> Increment:
    """The integral from w = 0: the rule with D alone on the left."""
    return solve(DERIVATIVE, increment, _ZERO)


def differentiate(increment: Increment) -> Increment:
    """The derivative, of an increment that does not jump: (k + 1) F[g,k+1] - g F[g,k]."""
    return trim(
        {
            rate: [
                (k + 1) * after - rate * value
                for k, (value, after) in enumerate(zip(powers, [*powers[1:], _ZERO], strict=True))
            ]
            for rate, powers in increment.items()
        }
    )


def combine(parts: Iterable[tuple[fmpq, Increment]]) -> Increment:
    """A sum of increments that start together, each with its factor."""
    total: Increment = {}
    for factor, part in parts:
        add(total, part, factor)
    return trim(total)
