"""What contacts cost: how many stretches there are, and would be by the end; too many are refused early."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import islice
from math import log

from flint import fmpq

from wavesym.errors import CostError
from wavesym.exact.contacts.joint_stretch import MOST_SWING, JointStretch
from wavesym.exact.joints.fronts import front_sources, front_times
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import Network
from wavesym.mechanics.travel_times import what_adjusts
from wavesym.numbers.doubles import nearest

# stretches in all, which take half a minute and half a gigabyte, and those whose motion is a series: half a minute
MOST_STAGES, MOST_SERIES = 150_000, 10_000
# how often joints are moved: half a minute
MOST_MOVES = 500_000
# after so many series, half a second, it is reckoned how many there would be; the margin of that, which gets less
_RECKONED, _MARGIN = 96, 3
# after so many times that count what happened lately is more than all that did, and what dies away counts
_LATELY = 8
# after each time so many stretches it is reckoned how they grow with the fronts; fronts that are counted
_GROWN, _MOST_FRONTS, _MANY = 1024, 200_000, 4


class Cost:
    """Counts the stretches of joints as they begin. CostError where there are too many, or would be by the end."""

    def __init__(self, network: Network, loads: Sequence[AppliedLoad], last: Mapping[int, fmpq]) -> None:
        self._network, self._loads, self._last = network, loads, last
        self._until = max(last.values(), default=fmpq(0))
        self._starts: list[fmpq] = []
        self._series: list[fmpq] = []
        self._lasting: list[fmpq] = []
        self._stretches: Counter[int] = Counter()
        self._swings: dict[int, fmpq] = {}

    def refuse_many_moves(self, shortest: Mapping[int, fmpq]) -> None:
        """CostError where joints, which are moved no further at once than their `shortest`, would be too often."""
        moves = sum((tau / shortest[number] for number, tau in self._last.items()), fmpq(0))
        if moves > MOST_MOVES:
            raise CostError(
                f"output.until: waves cross the shortest rod in tau = {nearest(min(shortest.values())):g}, contacts "
                f"are looked for {nearest(moves):.1e} times, the limit is {MOST_MOVES:g} (a shorter horizon or longer "
                "rods help)"
            )

    def add(self, number: int, start: fmpq, moved: JointStretch, events: int) -> None:
        """A stretch of a joint; so many events have been found."""
        self._stretches[number] += 1
        self._swings[number] = moved.swing
        self._starts.append(start)
        if moved.swing > 0:
            self._series.append(start)
            if not moved.fleeting:
                self._lasting.append(start)
        for starts, most in ((self._starts, MOST_STAGES), (self._series, MOST_SERIES)):
            if len(starts) > most:
                causes, helps = self._causes(events)
                raise CostError(
                    f"output.until: {causes} make more than {most} stretches by tau = {nearest(start):g}, the limit is "
                    f"{most} ({helps} help)"
                )
        if moved.swing > 0:
            self._refuse_series(self._lasting, _RECKONED, events)
            self._refuse_series(self._series, _RECKONED * _LATELY, events)
        if len(self._starts) % _GROWN == 0:
            self._refuse_growth(start, events)

    def _refuse_series(self, starts: Sequence[fmpq], first: int, events: int) -> None:
        """Where these, at their rate so far, would be too many."""
        count = len(starts)
        if count < first or count % _RECKONED or starts[-1] == 0:
            return
        since, counted = (starts[count // 2], count - count // 2) if count >= _RECKONED * _LATELY else (fmpq(0), count)
        if since == starts[-1]:
            return
        reckoned = count + counted * (self._until - starts[-1]) / (starts[-1] - since)
        if reckoned > MOST_SERIES * (1 + fmpq(_MARGIN * _RECKONED, count)):
            raise self._refusal(count, starts[-1], reckoned, MOST_SERIES, events)

    def _refuse_growth(self, start: fmpq, events: int) -> None:
        """Where all, as a power of the number of fronts that they grew like since half of them, would be too many.

        No more than the fronts, unless events have made many more of them than there are fronts: then as the square.
        """
        count, fronts = len(self._starts), self._fronts
        now, then = (bisect_right(fronts, time) for time in (start, self._starts[count // 2]))
        if not then < now < len(fronts):
            return
        power = min(2.0 if count > _MANY * now else 1.0, log(2) / log(now / then))
        reckoned = fmpq(int(count * (self._front_count / now) ** power))
        if reckoned > MOST_STAGES * (1 + fmpq(_MARGIN * _GROWN, count)):
            raise self._refusal(count, start, reckoned, MOST_STAGES, events)

    @cached_property
    def _fronts(self) -> Sequence[fmpq]:
        """When fronts would meet joints if all contacts were closed, as far as they are counted."""
        sources = front_sources(self._network, self._loads, self._last)
        return [time for time, _ in islice(front_times(self._network, sources, self._last), _MOST_FRONTS)]

    @cached_property
    def _front_count(self) -> float:
        """How many fronts there are by the end; beyond those that are counted at the rate of their last half."""
        fronts = self._fronts
        half, last = (nearest(fronts[k]) for k in (len(fronts) // 2, -1))
        if len(fronts) < _MOST_FRONTS or last == half:
            return len(fronts)
        return len(fronts) * (1 + (nearest(self._until) - last) / (last - half) / 2)

    def _refusal(self, count: int, start: fmpq, reckoned: fmpq, most: int, events: int) -> CostError:
        causes, helps = self._causes(events)
        return CostError(
            f"output.until: {causes} make {count} stretches by tau = {nearest(start):g}, which would be "
            f"{nearest(reckoned):.1e} by tau = {nearest(self._until):g}, the limit is {most} ({helps} help)"
        )

    def _causes(self, events: int) -> tuple[str, str]:
        """What makes stretches, and what helps: where the joint with most stretches swings fast, less of that."""
        causes = f"fronts and {events} openings and closings of contacts"
        number = max(self._last, key=lambda number: self._stretches[number])
        joint, swing = self._network.joints[number], self._swings.get(number, fmpq(0))
        longest = min((self._network.bars[end.bar].delay for end, _ in joint.ends), default=self._last[number])
        if swing * longest <= MOST_SWING:
            helps = "a shorter horizon, lengths with a larger common measure, or springs in place of thin rods"
            return causes, ", ".join(filter(None, (what_adjusts(self._network.bars), helps)))
        place = self._network.points[joint.points[0]].place
        return (
            f"what swings or decays{place and ' at '}{place} at a rate of {nearest(swing):.3g}, {causes}",
            "heavier bodies, or joints with dashpots in place of light ones, softer springs or a shorter horizon",
        )
