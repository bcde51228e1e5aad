"""Which outputs are 0 throughout, though waves arrive: at a free end, or in the middle of what is symmetric.

Rounding hides it, exact tables are too long; but the march is as well a march of Laplace transforms, one number per
wave and window for every fixed s. With all of them times s, and t = 1/s, a body that starts with velocity v obeys
(1 + rate t) q = rate t p + v. An output is 0 if all that arrives at one instant adds up to 0. Computed modulo a prime
at a random t, a sum that is not 0 is taken for 0 with a chance of less than one in 2**70: as a rational function of t
its numerator has a degree below 2**50, and t is one of 2**127 numbers.

Of what arrives at the end of the horizon only the jump is seen, and that is the sum at t = 0.
"""

from __future__ import annotations

from collections import defaultdict

from flint import fmpq

from wavesym.numbers.doubles import rational
from wavesym.programs.march.plan import Junction, Plan, Watched

_PRIME = 2**127 - 1
_T = 0x5EED_C0FFEE_1234_5678_9ABC_DEF0_1357 % _PRIME  # drawn once, so that the same scene makes the same files


def silent(plan: Plan) -> list[bool]:
    """Whether each output is 0 on [0, tau_max]."""
    until = rational(plan.tau_max)
    arriving, jumping = _sums(plan, _T), _sums(plan, 0)
    return [
        not any(sums[time] for time in sums if time < until) and not (_jumps(output) and jumps[until])
        for output, sums, jumps in zip(plan.outputs, arriving, jumping, strict=True)
    ]


def _sums(plan: Plan, t: int) -> list[dict[fmpq, int]]:
    """What arrives at each output, by instant."""
    sums: list[dict[fmpq, int]] = [defaultdict(int) for _ in plan.outputs]
    for panel in range(len(plan.panels)):
        _Train(plan, panel, t).into(sums)
    return sums


def _jumps(output: Watched) -> bool:
    return output.quantity != "displacement"


class _Train:
    """All that leaves nodes at the instants n + (start of a panel); what starts at tau = 0 goes with the first."""

    def __init__(self, plan: Plan, panel: int, t: int) -> None:
        self._plan, self._panel = plan, panel
        still = panel > 0
        self._rods = [0 if still else _modular(v) for v in plan.rods]
        self._motion = [0 if still or node.rate is None else _modular(node.motion) for node in plan.junctions]
        self._law = [(_modular(node.alpha), _modular(node.beta), *_turned(node, t)) for node in plan.junctions]
        self._loads: dict[int, dict[int, int]] = defaultdict(dict)
        for window, force, powers in plan.changes(panel):
            factors = (1, t, 2 * t**2)
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
            for x, (alpha, beta, of_p, of_start) in enumerate(self._law):
                p = alpha * a[x] + beta * b[x] + loads.get(x, 0)
                q = of_p * p + (of_start * self._motion[x] if window == 0 else 0)
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


def _turned(node: Junction, t: int) -> tuple[int, int]:
    """What a node makes q of p and of its velocity at the start."""
    if node.rate is None:
        return 1, 0
    step = t * _modular(node.rate) % _PRIME
    inverse = pow(1 + step, -1, _PRIME)
    return step * inverse, inverse


def _sign(output: Watched) -> int:
    return -1 if output.quantity == "strain" else 1


def _modular(value: fmpq) -> int:
    return int(value.p) * pow(int(value.q), -1, _PRIME) % _PRIME
