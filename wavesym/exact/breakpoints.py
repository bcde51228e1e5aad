"""Breakpoints: the instants at which something not smooth arrives at a joint.

A breakpoint t of one joint is a breakpoint t + T of the next, T being the delay of the bar between them: exact
rationals. Between two of them a joint's motion is one smooth function, and it rests only on stretches that start
earlier. Where all delays are equal, breakpoints are those of a common window: every delay, and the parts of it at which
loads act.

What stiff springs do between two breakpoints is smooth, but no series of moderate length. There stretches are cut, and
as the waves that are sent begin anew then, a cut travels as a breakpoint does. Cuts are as far apart as a part or a
multiple of the common measure of all delays, so that most of those that come back meet others. In a common window of
equal delays all joints begin anew at once: where what is fast in them decays, cuts end when it has died away, and one
stretch without it (`joints/relaxation.py`) is left of the window. Of other delays this is so after each front that no
cut has made: cuts follow it from joint to joint, and end there as they do here.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import cache, cached_property, partial
from itertools import chain, pairwise
from typing import TYPE_CHECKING

from flint import fmpq

from wavesym.errors import CostError
from wavesym.exact.contacts.events import contact_schedule
from wavesym.exact.joints.fronts import front_sources, front_times
from wavesym.exact.joints.joint_law import SWING, JointLaw
from wavesym.exact.joints.relaxation import settling_gap
from wavesym.mechanics.gauge import Gauge, Sum
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import common_measure, in_order

if TYPE_CHECKING:
    from wavesym.exact.contacts.schedule import Schedule

MOST_BREAKPOINTS = 20_000


class Breakpoints:
    """The stretches of every joint that can be felt, until tau = `until`.

    `joints` has, for each of them, the starts of its stretches and the end of the last one.
    """

    def __init__(self, model: Model, until: fmpq) -> None:
        self._network = model.network
        self._until = until
        self._acting = model.loads_until(until)
        self._last = model.joints_in_reach(until)
        self._delays = {bar.delay for bar in self._network.bars}
        self._windowed = len(self._delays) == 1 and not self._network.corners
        self._scheduled = partial(contact_schedule, model, until)
        self._breakpoints: Callable[[int, fmpq], Sequence[fmpq]] = cache(self._find_breakpoints)

    @property
    def joints_in_reach(self) -> Collection[int]:
        """The joints that can be felt."""
        return self._last.keys()

    @cached_property
    def stretches(self) -> int:
        """How many stretches there are in all. CostError where there are too many to count."""
        return sum(map(self.count, self._last))

    def count(self, number: int) -> int:
        """How many stretches a joint has; windows are not written out for it."""
        return self._count * len(self._parts) if self._windowed else len(self.joints[number]) - 1

    @property
    def crossings(self) -> int:
        """How often fronts meet joints, or joints go through windows."""
        return self._count * len(self._last) if self._windowed else self.stretches

    def size(self, terms: int, bits: int) -> int:
        """About how many bytes the waves take: of each power middle and radius, and the words of the middle."""
        ends = sum(len(self._network.joints[number].ends) for number in self._last) / max(len(self._last), 1)
        return int(self.stretches * ends * terms * (48 + bits // 8))

    @property
    def label(self) -> str:
        """What is counted, in a few words."""
        return f"{len(self._last)} nodes times {float(self._until):g} units of tau"

    @cached_property
    def schedule(self) -> Schedule | None:
        """What contacts do, of a chain that has some."""
        return self._scheduled()

    @cached_property
    def joints(self) -> Mapping[int, Sequence[fmpq]]:
        """The starts of the stretches of every joint, and the end of the last one."""
        if self._windowed:
            return dict.fromkeys(self._last, self._windows)
        if (known := self.schedule) is not None:
            return known.breakpoints
        return self._natural if not self.cut else self._with_cuts()

    @cached_property
    def cut(self) -> bool:
        """Whether stretches are cut for the sake of springs."""
        if self._windowed:
            return len(self._natural_parts) < len(self._parts)
        if self._network.corners:  # stages bear what they have to
            return False
        return any(
            high - low > longest
            for number, longest in self._bearable.items()
            for low, high in pairwise(self._natural[number])
        )

    @property
    def most_swing(self) -> fmpq | None:
        """What series bear at most, as exp(this), where stages of contacts are cut for it."""
        if self.schedule is None:
            return None
        from wavesym.exact.contacts.joint_stretch import MOST_SWING  # how contacts touch: few scenes have any

        return MOST_SWING

    def swing(self, number: int, law: JointLaw) -> fmpq:
        """What series of a joint have to bear, as exp(this), on the stretches on which it moves."""
        times = self.joints[number]
        if self._is_at_rest(number):
            times = times[1:]
        lengths = [high - low for low, high in pairwise(times)]
        longest, slowly = max(lengths, default=fmpq(0)), fmpq(0)
        if (borne := law.longest) is not None and longest > borne and (gap := settling_gap(law, longest)):
            slowly = gap.slow * longest
            longest = max((length for length in lengths if length <= borne), default=fmpq(0))
        return max(slowly, law.fastest * longest)

    def _is_at_rest(self, number: int) -> bool:
        """Whether nothing moves on the first stretch of a joint."""
        return (fmpq(0), number) not in self._sources

    def of_output(self, terms: Sum) -> Sequence[fmpq]:
        """Where a sum of readings may jump or bend, and 0; in order."""
        found = [self._read(reading) for _, reading in terms]
        return found[0] if len(found) == 1 else in_order(chain((fmpq(0),), *found))

    def _read(self, reading: Gauge) -> Sequence[fmpq]:
        if reading.quantity == "load":
            sources = {unit.source for unit in self._network.points[reading.point or 0].loads}
            return in_order([fmpq(0), *(load.time for load in self._acting if load.source in sources)])
        if reading.quantity == "constant":
            return [fmpq(0)]
        if reading.point is not None:
            times = self.joints[self._network.joint_of[reading.point]]
            return in_order([fmpq(0), *(time for time in times if time <= self._until)])
        return self._breakpoints(reading.rod - 1, reading.place)

    def _find_breakpoints(self, number: int, place: fmpq) -> Sequence[fmpq]:
        bar = self._network.bars[number]
        if self._windowed:
            return list(self._in_windows(place))
        found = []
        for point, way in ((bar.left, place * bar.delay), (bar.right, (1 - place) * bar.delay)):
            times = (breakpoint + way for breakpoint in self.joints[self._network.joint_of[point]][:-1])
            found.append([time for time in times if 0 <= time <= self._until])
        return in_order(chain((fmpq(0),), *found))

    # stiff springs

    @cached_property
    def _bearable(self) -> Mapping[int, fmpq]:
        """How long stretches of joints with springs may be."""
        network = self._network
        if not any(point.stiffness for point in network.points) and not any(link.stiffness for link in network.links):
            return {}  # told without laws, whose derivation takes SymPy
        laws = {number: JointLaw.assemble(network, network.joints[number]) for number in self._last}
        return {number: law.longest for number, law in laws.items() if law.longest is not None}

    @cached_property
    def _cut_distance(self) -> fmpq:
        """How far cuts are apart, of a network with springs."""
        shortest = min(self._bearable.values())
        measure = common_measure(self._delays) or shortest
        return measure / (measure / shortest).ceil() if measure > shortest else (shortest / measure).floor() * measure

    def _too_stiff(self, count: str) -> CostError:
        return CostError(
            f"output.until: springs make {len(self._last)} nodes swing at a rate of up to "
            f"{float(SWING / min(self._bearable.values())):.3g}, which are {count} stretches by tau = "
            f"{float(self._until):g}, the limit is {MOST_BREAKPOINTS} (softer springs, heavier bodies or a "
            "shorter horizon help)"
        )

    # equal delays

    @cached_property
    def _natural_parts(self) -> Sequence[fmpq]:
        """Where in a window stretches start for the sake of loads."""
        (delay,) = self._delays
        times = in_order(time for time, _ in self._sources)
        return in_order([fmpq(0), *(time - (time / delay).floor() * delay for time in times)])

    @cached_property
    def _parts(self) -> Sequence[fmpq]:
        """Where in a window stretches start."""
        natural = self._natural_parts
        if not self._bearable:
            return natural
        longest = min(self._bearable.values())
        spans = [self._swinging(high - low) for low, high in pairwise([*natural, self._span])]
        cuts = [max(1, int((span / longest).ceil())) for span, _ in spans]
        count = sum(cuts) + sum(rests for _, rests in spans)
        if len(cuts) < count and (count := len(self._last) * self._count * count) > MOST_BREAKPOINTS:
            raise self._too_stiff(str(count))
        return [
            part + span * k / n
            for part, (span, rests), n in zip(natural, spans, cuts, strict=True)
            for k in range(n + rests)
        ]

    def _swinging(self, length: fmpq) -> tuple[fmpq, bool]:
        """How long what is fast has to be followed on a stretch of a window, and whether it has died away then."""
        stiff = [
            JointLaw.assemble(self._network, self._network.joints[n]) for n, x in self._bearable.items() if x < length
        ]
        gaps = [settling_gap(law, length) for law in stiff]
        times = [gap.settling_time for gap in gaps if gap]
        return (max(times), True) if times and len(times) == len(gaps) else (length, False)

    @cached_property
    def _count(self) -> int:
        (delay,) = self._delays
        return int((self._until / delay).floor()) + 1

    @cached_property
    def _span(self) -> fmpq:
        """How long a window is; of a rod that is crossed not once no more is moved than is asked for."""
        (delay,) = self._delays
        return min(delay, self._until + 1) if self._count == 1 else delay

    @cached_property
    def _windows(self) -> Sequence[fmpq]:
        starts = [n * self._span + part for n in range(self._count) for part in self._parts]
        return [*starts, self._count * self._span]

    def _in_windows(self, place: fmpq) -> Iterator[fmpq]:
        (delay,) = self._delays
        moments = {moment for part in self._parts for moment in (part + place * delay, part + (1 - place) * delay)}
        parts = sorted({moment - (moment / delay).floor() * delay for moment in moments})
        if parts[0] != 0:
            yield fmpq(0)
        for n in range(self._count):
            yield from (n * delay + part for part in parts if n * delay + part <= self._until)

    # any delays

    @cached_property
    def _natural(self) -> Mapping[int, Sequence[fmpq]]:
        later, found = self._network.shortest, self._meetings({})
        return {number: [*times, self._last[number] + later] for number, times in found.items()}

    def _with_cuts(self) -> Mapping[int, Sequence[fmpq]]:
        """When fronts meet joints, those of cuts and where these are made, too; and no later than is known then."""
        if self._rests:
            return self._with_rests()
        found = self._meetings({number: self._reach(number) for number in self._bearable})
        for number, times in found.items():
            end = self._last[number] + self._cut_distance
            if number in self._bearable:
                end = times[-1] + self._reach(number)
            times.append(min(self._last[number] + 1, end))
        return found

    def _with_rests(self) -> Mapping[int, Sequence[fmpq]]:
        """The same, cuts ending when what is fast has died away after a front."""
        longest = min(self._bearable.values())
        found = self._meetings(dict.fromkeys(self._bearable, longest), self._rests)
        for number, times in found.items():
            end, following = self._natural[number][-1], times[-1] + longest
            if number in self._bearable and not any(low <= following < high for low, high in self._rests[number]):
                end = min(end, following)
            times.append(end)
        return found

    @cached_property
    def _rests(self) -> Mapping[int, Sequence[tuple[fmpq, fmpq]]]:
        """Between which instants joints with springs are not cut; nothing where that is not most of the time.

        A front that no cut has made meets the other end of a bar as such: what dies away here has died away there.
        """
        gaps = []
        for number, bearable in self._bearable.items():
            length = max(high - low for low, high in pairwise(self._natural[number]))
            if length > bearable:
                law = JointLaw.assemble(self._network, self._network.joints[number])
                gaps.append(settling_gap(law, length))
        known = [gap for gap in gaps if gap]
        if not known or len(known) < len(gaps):
            return {}
        settled = max(gap.settling_time for gap in known) + min(self._bearable.values())
        least = 2 * settled + max(gap.resting_time for gap in known)
        rests, passed, rested = {}, fmpq(0), fmpq(0)
        for number in self._bearable:
            stretches = list(pairwise(self._natural[number]))
            still = stretches[:1] if self._is_at_rest(number) else []
            moving = stretches[len(still) :]
            rests[number] = still + [(low + settled, high) for low, high in moving if high - low >= least]
            passed += sum((high - low for low, high in moving), fmpq(0))
            rested += sum((high - low for low, high in rests[number][len(still) :]), fmpq(0))
        return rests if 2 * rested > passed else {}

    @cached_property
    def _sources(self) -> Sequence[tuple[fmpq, int]]:
        return front_sources(self._network, self._acting, self._last)

    def _meetings(
        self, cuts: Mapping[int, fmpq], rests: Mapping[int, Sequence[tuple[fmpq, fmpq]]] | None = None
    ) -> dict[int, list[fmpq]]:
        """0, and when fronts meet joints."""
        found: dict[int, list[fmpq]] = {number: [fmpq(0)] for number in self._last}
        sources = self._sources if rests else [*self._sources, *((fmpq(0), number) for number in cuts)]
        for count, (time, number) in enumerate(front_times(self._network, sources, self._last, cuts, rests), 1):
            if count > MOST_BREAKPOINTS:
                if cuts:
                    raise self._too_stiff(f"more than {MOST_BREAKPOINTS}")
                raise CostError(
                    f"output.until: fronts meet joints more than {MOST_BREAKPOINTS} times by tau = "
                    f"{float(time):g}, the limit is {MOST_BREAKPOINTS} (a shorter horizon or lengths with a "
                    "larger common measure help)"
                )
            if time > 0:
                found[number].append(time)
        return found

    def _reach(self, number: int) -> fmpq:
        """How long a stretch may be until it is cut."""
        return (self._bearable[number] / self._cut_distance).floor() * self._cut_distance
