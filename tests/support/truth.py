"""The exact solution of a scene, from the law of its nodes alone: what everything that is generated is held against.

Nothing of the package is used but the scene. Each wave that a node sends gains, at every whole unit after its source
began, a sum of decays with rational coefficients. So instants are known exactly, and so is what is zero.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

from flint import arb, fmpq

from tests.support.decays import Decays
from tests.support.history import History
from wavesym.numbers.doubles import fraction
from wavesym.scene import Observable, Scene, lower
from wavesym.systems import Building, Collision, Drive

_ZERO = fmpq(0)
_NOTHING = Decays()
_Gains = dict[tuple[int, int], Decays]
"""What is gained, by node and tau."""


@dataclass(frozen=True)
class Node:
    """Two rods meet, in which the waves a (from the left) and b (from the right) arrive.

    The node's velocity q follows a body, q' + (alpha + beta)/2 q = alpha a + beta b + load; without mass
    (alpha + beta)/2 q = alpha a + beta b, plus the load; or is held, q = load. An end has no rod on one side.
    """

    kind: str
    alpha: fmpq
    beta: fmpq
    velocity: fmpq = _ZERO
    """That of the node before anything has happened."""

    def moves(self, a: Decays, b: Decays, load: Decays = _NOTHING, start: fmpq = _ZERO) -> Decays:
        """q, where a, b and the load begin at w = 0 and q(0) = start."""
        rate, driven = (self.alpha + self.beta) / 2, a * self.alpha + b * self.beta
        if self.kind == "body":
            return (driven + load).lagged(rate, start)
        return driven * (1 / rate) + load if self.kind == "light" else load


def _q(number: Fraction | int) -> fmpq:
    return fmpq(*number.as_integer_ratio())


def _nodes(system: Collision | Drive | Building) -> list[Node]:
    """The nodes at x = 0, 1, ... m."""
    m, kappa = system.m, [_q(kappa) for kappa in system.kappa]
    if isinstance(system, Collision):
        # rigid bodies between free ends and contacts, which stay closed
        bodies = [Node("body", 2 * k, 2 * k, _q(v)) for k, v in zip(kappa, system.velocity, strict=True)]
        light = [Node("light", fmpq(min(x, 1)), fmpq(min(m - x, 1))) for x in range(0, m + 1, 2)]
        return [bodies[x // 2] if x % 2 else light[x // 2] for x in range(m + 1)]
    if isinstance(system, Drive):
        inertia = [_q(inertia) for inertia in system.inertia]
        left = [_ZERO, *(2 * kappa[i - 1] * inertia[i - 1] / inertia[i] for i in range(1, m + 1))]
        right = [*(2 * kappa[i] for i in range(m)), _ZERO]
        return [Node("body", *sides) for sides in zip(left, right, strict=True)]
    base = Node("light" if system.base == "force" else "held", _ZERO, fmpq(1))
    return [base, *(Node("body", 2 * k, 2 * k) for k in kappa[1:m]), Node("body", 2 * kappa[m], _ZERO)]


def _rods(system: Collision | Drive | Building) -> list[fmpq]:
    """The velocities with which the rods begin: each collides with the velocity of its body."""
    if isinstance(system, Collision):
        return [_q(velocity) for velocity in system.velocity for _ in range(2)]
    return [_ZERO] * system.m


def _load(system: Collision | Drive | Building, source: str) -> dict[int, Decays]:
    """What a unit of a source does to its node, by the number of the node."""
    if isinstance(system, Collision):
        return {}
    if isinstance(system, Drive):
        power, body = "MR".index(source[0]), int(source[1:])
        size = system.kappa[0] * system.inertia[0] / system.inertia[body - 1]
        return {body - 1: Decays.power(power, _q(-size if body == system.m + 1 else size))}
    power = "ab".index(source)
    if system.base == "force":
        # the end's strain, 2 b - q, is the acceleration over kappa_0
        return {0: Decays.power(power, -1 / _q(system.kappa[0]))}
    return {0: Decays.power(power + 1)}  # the ground's velocity


class Truth:
    """The outputs of a scene for 0 <= tau <= until, as exactly as one asks."""

    def __init__(self, scene: Scene, until: Fraction) -> None:
        self.scene = scene
        self.until = until
        self._nodes = _nodes(scene.system)
        # a rod that moves does so by two waves, each of half its velocity; beyond the ends there is none
        self._begun = [Decays.power(0, velocity / 2) for velocity in (_ZERO, *_rods(scene.system), _ZERO)]
        gains: list[dict[Fraction, Decays]] = [{} for _ in scene.outputs]
        acting = [(load.source, fraction(load.time), load.weight) for load in lower(scene).loads]
        acting = [load for load in acting if load[1] <= until]
        for source in {source: None for source, *_ in acting}:
            times = {time: weight for which, time, weight in acting if which == source}
            left, right = self._sent(source, until - min(times))
            for output, gained in zip(scene.outputs, gains, strict=True):
                for start, gain in self._felt(output, left, right):
                    for time, weight in times.items():
                        if start + time <= until:
                            gained[start + time] = gained.get(start + time, _NOTHING) + gain * weight
        self._histories = [History(gained) for gained in gains]

    def value(self, output: int, tau: Fraction, bits: int = 80) -> arb:
        """An output at tau, at a jump that after it; right to so many bits, however small, and 0 only where it is 0.

        To calculate with so many bits, set flint's precision.
        """
        assert 0 <= tau <= self.until
        return self._histories[output].value(tau, bits)

    def largest(self, output: int, until: Fraction) -> tuple[arb, arb]:
        """Bounds of the largest absolute value of an output for 0 <= tau <= until, a part in 500 apart at most."""
        assert until <= self.until
        return self._histories[output].largest(until)

    def arrivals(self, output: int) -> list[Fraction]:
        """The instants up to `until` at which an output, or one of its derivatives, jumps."""
        return list(self._histories[output].instants)

    def _sent(self, source: str, until: Fraction) -> tuple[_Gains, _Gains]:
        """What the waves that nodes send to the left and to the right gain from a source that begins at tau = 0.

        Only what an output can feel by tau = until.
        """
        load = _load(self.scene.system, source)
        places = {output.x for output in self.scene.outputs}
        first = max(0, ceil(min(places) - until))
        last = min(self.scene.system.m, floor(max(places) + until))
        distances = {i: min(abs(i - x) for x in places) for i in range(first, last + 1)}
        left: _Gains = {}
        right: _Gains = {}
        for n in range(floor(until) + 1):
            for i in (i for i, distance in distances.items() if n + distance <= until):
                a, b = right.get((i - 1, n - 1), _NOTHING), left.get((i + 1, n - 1), _NOTHING)
                if n:
                    q = self._nodes[i].moves(a, b)
                    left[i, n], right[i, n] = q - a, q - b
                else:
                    a, b = self._begun[i], self._begun[i + 1]
                    q = self._nodes[i].moves(a, b, load.get(i, _NOTHING), self._nodes[i].velocity)
                    left[i, n], right[i, n] = q - a - a, q - b - b
        return left, right

    def _felt(self, output: Observable, left: _Gains, right: _Gains) -> Iterator[tuple[Fraction, Decays]]:
        """What an output gains, and when.

        In a rod the velocity is p + r and the strain r - p, where p goes to the right and r to the left.
        """
        rod = ceil(output.x) if output.side < 0 or output.x == self.scene.system.m else floor(output.x) + 1
        from_left = output.x - (rod - 1)
        sign = -1 if output.quantity == "strain" else 1
        waves = [(from_left + n, gain * sign) for (i, n), gain in right.items() if i == rod - 1]
        waves += [(1 - from_left + n, gain) for (i, n), gain in left.items() if i == rod]
        if output.quantity != "strain":
            waves.append((Fraction(0), self._begun[rod] * 2))
        for start, gain in waves:
            yield start, gain.lagged(0) if output.quantity == "displacement" else gain
