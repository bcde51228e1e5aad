"""How large exact responses will be, told before anything is solved: fronts, and how many powers each brings.

It is the walk of the responses themselves, with the number of powers at each rate in the place of coefficients. A wave
that meets a joint has one more power at each rate of the joint, and keeps all others; what a joint absorbs is not sent.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from itertools import product
from math import inf

from flint import fmpq

from wavesym.derivation.table_size import MOST_WORK, Size, mean_bits, response_size
from wavesym.errors import CostError
from wavesym.exact.joints.fronts import departures, reachable
from wavesym.exact.tables.network_joints import START, NetworkJoints, unit_at
from wavesym.mechanics.network import End

MOST_FRONTS = 20_000
Shape = Mapping[fmpq, int]
"""How many powers there are at each rate."""


class Forecast:
    """What is known of responses before they are made."""

    def __init__(self, joints: NetworkJoints) -> None:
        self._joints = joints
        self._passes: Callable[[int], Mapping[End, frozenset[End]]] = cache(self._find_passes)

    def size(self, source: str, last: Mapping[int, fmpq], most: float = inf, key: str = "output.until") -> Size:
        """How large the response to a source will be. CostError where fronts or coefficients are too many."""
        found: set[fmpq] = set()
        counts: list[int] = []
        coefficients, most = 0, min(most, MOST_WORK)
        for time, _, shape in self._walk(source, last, key):
            counts.append(sum(shape.values()))
            found |= shape.keys()
            coefficients += counts[-1]
            if coefficients > most:
                raise CostError(
                    f"{key}: the tables would hold more than {most:.1e} coefficients by tau = {float(time):g}, "
                    f"the limit is {most:.1e} ({_fewer(key)} or fewer parts helps)"
                )
        return response_size(counts, mean_bits(found))

    def times(self, source: str, last: Mapping[int, fmpq]) -> Mapping[End, list[fmpq]]:
        """When fronts leave the ends of bars."""
        found: dict[End, list[fmpq]] = defaultdict(list)
        for time, end, _ in self._walk(source, last, "output.until"):
            found[end].append(time)
        return found

    def nth(self, source: str, count: int) -> dict[End, fmpq]:
        """When the first `count` fronts have left each end that something leaves at all."""
        starts = {end for number in self._joints.acting_joints(source) for end in self._starts(number, source)}
        waiting = dict.fromkeys(reachable(self._joints.network, starts, self._passes), count)
        found: dict[End, fmpq] = {}
        for time, end, _ in self._walk(source, None, "--intervals"):
            if end in waiting:
                found[end] = time
                waiting[end] -= 1
                if not waiting[end]:
                    del waiting[end]
            if not waiting:
                break
        return found

    def _walk(self, source: str, last: Mapping[int, fmpq] | None, key: str) -> Iterator[tuple[fmpq, End, Shape]]:
        network = self._joints.network
        units = (unit_at(point, source).get(fmpq(0), ()) for point in network.points)
        first = max(1, *map(len, units))

        def answer(number: int, time: fmpq, waves: Mapping[End, Shape]) -> Iterator[tuple[End, Shape]]:
            shape = {fmpq(0): first}
            for wave in waves.values():
                for rate, powers in wave.items():
                    shape[rate] = max(powers, shape.get(rate, 0))
            for pole in self._joints.response(number).poles:
                shape[pole.rate] = shape.get(pole.rate, 0) + len(pole.residues)
            return ((end, shape) for end in self._leaves(number, source if time == 0 else "", waves))

        acting = self._joints.acting_joints(source)
        starts = [(fmpq(0), number) for number in acting if last is None or number in last]
        for count, front in enumerate(departures(network, starts, answer, last), 1):
            if count > MOST_FRONTS:
                raise CostError(
                    f"{key}: fronts leave the ends of rods more than {MOST_FRONTS} times by tau = "
                    f"{float(front[0]):g}, the limit is {MOST_FRONTS} ({_fewer(key)} or fewer parts helps)"
                )
            yield front

    def _leaves(self, number: int, source: str, waves: Iterable[End]) -> set[End]:
        """The ends that something leaves, where waves arrive at some and a source acts, if any."""
        passes = self._passes(number)
        return set(self._starts(number, source) if source else ()).union(*(passes[end] for end in waves))

    def _find_passes(self, number: int) -> Mapping[End, frozenset[End]]:
        """Of what arrives at an end of a joint, which ends get something: none where it is absorbed."""
        law, response, ends = self._joints.law(number), self._joints.response(number), self._joints.ends(number)
        found: dict[End, set[End]] = {each.end: set() for each in ends}
        for (end, j, _, force), (other, i, ratio, _) in product(ends, repeat=2):
            if law.motions[j] is not None:
                goes = end == other
            else:
                at_once = ratio * response.direct.get((i, j), fmpq(0)) * force
                goes = (i, j) in response.later or at_once != int(end == other)
            if goes:
                found[end].add(other)
        return {end: frozenset(others) for end, others in found.items()}

    def _starts(self, number: int, source: str) -> set[End]:
        """The ends of a joint into which a source sends something at 0."""
        joints, ends = self._joints, self._joints.ends(number)
        if source == START:
            return {each.end for each in ends}
        law, points = joints.law(number), joints.network.joints[number].points
        acted = {k for k, point in enumerate(points) if unit_at(joints.network.points[point], source)}
        moved = {k for k in acted if law.motions[k] is not None}
        held = (
            other for k in moved for other in range(len(points)) if law.damping[other][k] or law.stiffness[other][k]
        )
        pushed = (acted - moved).union(held)
        moved |= {i for i, j in joints.response(number).entries if j in pushed}
        return {each.end for each in ends if each.place in moved}


def _fewer(key: str) -> str:
    return "a shorter horizon" if key == "output.until" else "fewer intervals"
