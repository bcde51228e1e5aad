"""Which outputs are 0 throughout, though waves arrive: at a free end, or in the middle of what is symmetric.

Rounding hides it, exact tables are too long; but the march is as well a march of Laplace transforms, one number per
wave and window for every fixed s: (s/rate + 1) q = p. An output is 0 if all that arrives at one instant adds up to 0.
Computed modulo a prime at a random s, a sum that is not 0 is taken for 0 with a chance of less than one in 2**70:
as a rational function of s its numerator has a degree below 2**50, and s is one of 2**127 numbers.
"""

from __future__ import annotations

from collections import defaultdict

from flint import fmpq

from wavesym.evaluators.doubles import rational
from wavesym.evaluators.march.plan import Plan, Watched

_PRIME = 2**127 - 1
_S = 0x5EED_C0FFEE_1234_5678_9ABC_DEF0_1357 % _PRIME  # drawn once, so that the same scene makes the same files


def silent(plan: Plan) -> list[bool]:
    """Whether each output is 0 on [0, tau_max]."""
    sums: list[dict[fmpq, int]] = [defaultdict(int) for _ in plan.outputs]
    for panel in range(len(plan.panels)):
        _Train(plan, panel).into(sums)
    return [not any(total.values()) for total in sums]


class _Train:
    """All that leaves nodes at the instants n + (start of a panel); what starts at tau = 0 goes with the first."""

    def __init__(self, plan: Plan, panel: int) -> None:
        self._plan, self._panel = plan, panel
        inverse = pow(_S, -1, _PRIME)
        still = panel > 0
        self._rods = [0 if still else _modular(v) * inverse % _PRIME for v in plan.rods]
        self._motion = [
            0 if still or node.rate is None else _modular(node.motion / node.rate) for node in plan.junctions
        ]
        self._law = [
            (
                _modular(node.alpha),
                _modular(node.beta),
                1 if node.rate is None else pow(_S * _modular(1 / node.rate) + 1, -1, _PRIME),
            )
            for node in plan.junctions
        ]
        self._loads: dict[int, dict[int, int]] = defaultdict(dict)
        for window, force, powers in plan.changes(panel):
            factors = (inverse, inverse**2, 2 * inverse**3)
            total = sum(_modular(c) * factor for c, factor in zip(powers, factors, strict=True))
            self._loads[window][plan.loaded[force]] = total

    def into(self, sums: list[dict[fmpq, int]]) -> None:
        """Add what arrives at each output, by instant."""
        plan, nodes = self._plan, len(self._plan.junctions)
        start = plan.panels[self._panel].start
        until = rational(plan.tau_max)
        # waves of all rods until something is sent into them
        a, b = self._rods[:-1], self._rods[1:]
        for output, total in zip(plan.outputs, sums, strict=True):
            total[start] += (_sign(output) + 1) * self._rods[output.left]
        for window in range(plan.windows):
            loads = self._loads.get(window, {})
            left, right = [0] * nodes, [0] * nodes
            for x, (alpha, beta, inverse) in enumerate(self._law):
                p = alpha * a[x] + beta * b[x] + loads.get(x, 0) + (self._motion[x] if window == 0 else 0)
                q = p * inverse
                left[x], right[x] = (q - a[x]) % _PRIME, (q - b[x]) % _PRIME
            if window == 0:  # what is sent takes the place of what was there
                left = [value - rod for value, rod in zip(left, self._rods[:-1], strict=True)]
                right = [value - rod for value, rod in zip(right, self._rods[1:], strict=True)]
            for output, total in zip(plan.outputs, sums, strict=True):
                for delay, value in (
                    (output.delay, _sign(output) * right[output.right]),
                    (1 - output.delay, left[output.left]),
                ):
                    if (time := window + start + delay) <= until:
                        total[time] = (total[time] + value) % _PRIME
            a, b = [0, *right[:-1]], [*left[1:], 0]


def _sign(output: Watched) -> int:
    return -1 if output.quantity == "strain" else 1


def _modular(value: fmpq) -> int:
    return int(value.p) * pow(int(value.q), -1, _PRIME) % _PRIME
