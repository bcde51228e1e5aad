"""When contacts open and close: found once, with so many bits that all later requests can rest on it.

Joints are moved as in `network_waves`, but breakpoints become known only as time goes on: a joint is moved no further
than to the next one that is known, nor further than the shortest delay beside it reaches. As nobody has read beyond
that, a contact that opens or closes on the way cuts the stretch there. `docs/contacts.md` has the argument.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from heapq import heappop, heappush
from typing import NamedTuple, TypeVar

from flint import arb, ctx, fmpq

from wavesym.errors import CostError, WavesymError
from wavesym.exact.contacts.cluster import Closed, subsets
from wavesym.exact.contacts.crossing import first_fall, positive_until, sign_after
from wavesym.exact.contacts.touching_joint import MOST_SWING, Moved, SwingError
from wavesym.exact.contacts.touching_waves import Stage, TouchingWaves, replayed
from wavesym.exact.joints.enclosed import Enclosed
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import middle, nearest

# stretches in all, and those whose motion is a series: half a minute
MOST_STAGES, MOST_SERIES = 20_000, 10_000
# after so many of these, half a second, it is told how many there would be; the margin of that, which gets less
_FORETOLD, _MARGIN = 96, 3
# how often joints are moved, told before it begins: half a minute
MOST_MOVES = 500_000
# an instant is known this closely, in shortest delays
_WIDTH = fmpq(1, 2**230)
# bits with which instants are told
_TOLD = 320
# how much longer each next stretch is on which it is left open what a contact does, in bits
_LONGER = 3
# working precision at first, and how much of it is beyond the first of these stretches
_BITS, _SPARE = 448, 128
# what is tried: bits, and whether what decays fast is left out where it is lost among rounding errors
_ATTEMPTS = ((_BITS, True), (_BITS, False), (2 * _BITS, False))
_NOTHING = fmpq(0)

T = TypeVar("T")


class GrazingError(WavesymError):
    """A contact that touches and does not, as far as any number of bits shows."""


@dataclass(frozen=True)
class Found:
    """A contact (the number of its link) opens or closes between two instants, or at one."""

    link: int
    closes: bool
    low: fmpq
    high: fmpq

    @property
    def instant(self) -> arb:
        """The ball between these, to as many digits as are told."""
        with ctx.workprec(_TOLD):
            return arb(self.low) if self.low == self.high else arb(self.low).union(arb(self.high))


@dataclass(frozen=True, eq=False)
class Schedule:
    """The stages of every joint, when its last one ends, and what contacts did, in order of time.

    No stage on which it is left open what a contact does is longer than `vague`. `waves` are those that it was found
    with, in so many `bits`.
    """

    stages: Mapping[int, Sequence[Stage]]
    ends: Mapping[int, fmpq]
    found: tuple[Found, ...]
    vague: fmpq
    waves: TouchingWaves
    bits: int


@lru_cache(maxsize=4)
def schedule(network: Network, loads: tuple[Applied, ...], last: tuple[tuple[int, fmpq], ...]) -> Schedule:
    """What happens at the joints, each until its last instant.

    CostError where it would take minutes, GrazingError where no number of bits tells what a contact does.
    """
    return _decided(network, loads, last, _Search.scheduled)


@lru_cache(maxsize=16)
def first_opening(network: Network, loads: tuple[Applied, ...], last: tuple[tuple[int, fmpq], ...]) -> Found | None:
    """The first opening of any contact; what comes after it is not looked at. None where there is none.

    CostError, GrazingError as in `schedule`.
    """
    return _decided(network, loads, last, _Search.opening)


def _decided(
    network: Network, loads: Sequence[Applied], last: tuple[tuple[int, fmpq], ...], found: Callable[[_Search], T]
) -> T:
    """What is found with as many bits as it takes."""
    for bits, relaxing in _ATTEMPTS:
        try:
            with ctx.workprec(bits):
                return found(_Search(network, loads, dict(last), relaxing))
        except _Undecided as doubt:
            undecided = doubt
    link = network.links[undecided.link]
    what = "force" if undecided.closed else "gap"
    raise GrazingError(
        f"contact at {link.place}: {bits} bits do not show the sign of its {what} at tau = "
        f"{nearest(undecided.tau):.17g} (another gap, load or length, or heavier masses beside it, help)"
    )


@lru_cache(maxsize=1)
def waves(network: Network, loads: tuple[Applied, ...], known: Schedule, bits: int) -> TouchingWaves:
    """The waves of what is scheduled, with so many bits; the last ones are kept for whoever asks again."""
    with ctx.workprec(bits):
        if bits <= known.bits:
            return known.waves.rounded(known.ends)
        return replayed(network, known.stages, known.ends, loads)


class _Undecided(Exception):
    """With so many bits."""

    def __init__(self, link: int, closed: bool, tau: fmpq) -> None:
        super().__init__()
        self.link, self.closed, self.tau = link, closed, tau


@dataclass
class _Gap:
    """Of a contact: how wide it is, as far as that is known; and what it was when that was last decided."""

    size: arb
    exact: fmpq | None
    closed: bool

    @property
    def shut(self) -> bool:
        """It is 0."""
        return self.exact is not None and self.exact == 0

    @property
    def wide(self) -> bool:
        """It is certainly more than 0."""
        return self.exact > 0 if self.exact is not None else bool(self.size > 0)

    def grow(self, rate: Enclosed, length: fmpq) -> None:
        """To what it is at the end of a stretch on which it is open."""
        h = arb(length)
        size = rate.polynomial.integral()(h) + self.size + arb(0, (rate.error * h).upper())
        if self.exact is not None and rate.exact is not None:
            self.exact = self.exact + rate.exact.integral()(length)
            self.size = arb(self.exact)
        else:
            self.size, self.exact = _not_negative(size), None


class _End(NamedTuple):
    """How long something is certain; and how far off that may be, in time, unless it is exact."""

    length: fmpq
    spread: fmpq | None


@dataclass
class _Doubt:
    """Since when it is not certain what a contact of a joint does, until when that was left open; how long next."""

    low: fmpq
    high: fmpq
    next: fmpq


@dataclass
class _Course:
    """A joint on its way: since when and how far its present stretch is known, and the breakpoints to come.

    It is moved no further at a time than `shortest`: nobody reads what is sent before, and springs do not swing more;
    and not beyond `end`, later than its `last` instant that matters: until then it is known what comes to it.
    """

    number: int
    last: fmpq
    end: fmpq
    shortest: fmpq
    gaps: dict[int, _Gap]
    since: fmpq
    reached: fmpq
    moved: Moved | None = None
    doubt: _Doubt | None = None
    spread: fmpq | None = None
    swing: fmpq = _NOTHING
    breakpoints: list[fmpq] = field(default_factory=list)
    stages: list[Stage] = field(default_factory=list)

    def comes(self, time: fmpq) -> bool:
        """Whether there is a breakpoint at an instant; it and all before are done with."""
        found = False
        while self.breakpoints and self.breakpoints[0] <= time:
            found = heappop(self.breakpoints) == time or found
        return found

    def limit(self, start: fmpq) -> fmpq:
        """How far it can be moved from an instant on."""
        far = min(start + self.shortest, self.end)
        return min(self.breakpoints[0], far) if self.breakpoints else far


class _Search:
    def __init__(self, network: Network, loads: Sequence[Applied], last: Mapping[int, fmpq], relaxing: bool) -> None:
        self._network = network
        self._relaxing = relaxing
        self._waves = TouchingWaves(network, last, loads)
        self._found: list[Found] = []
        self._coming: list[tuple[fmpq, int]] = []
        self._stages = self._series = 0
        self._width = min(bar.delay for bar in network.bars) * _WIDTH
        # the first stretch on which it is left open what a contact does
        self._least = min(bar.delay for bar in network.bars) / fmpq(2) ** (ctx.prec - _SPARE)
        self._resolution = self._least / 4
        # a joint is not moved after its last instant: its last series has to bear what neighbours read of it later
        rates = [joint.law.fastest for joint in self._waves.joints.values()]
        self._beyond = min([bar.delay for bar in network.bars] + [MOST_SWING / rate for rate in rates if rate != 0])
        self._courses = {number: self._course(number, until, loads) for number, until in last.items()}
        self._refuse_many_moves()

    def _course(self, number: int, last: fmpq, loads: Sequence[Applied]) -> _Course:
        network, joint = self._network, self._network.joints[number]
        far = [network.bars[end.bar].delay for end, _ in joint.ends]
        gaps = {
            n: _Gap(arb(network.links[n].gap), network.links[n].gap, network.links[n].gap == 0)
            for n in self._waves.joints[number].touches
        }
        course = _Course(number, last, last + self._beyond, min(far, default=last + 1), gaps, fmpq(0), fmpq(0))
        sources = {unit.source for point in joint.points for unit in network.points[point].loads}
        for load in loads:
            if load.source in sources and 0 < load.time <= last:
                heappush(course.breakpoints, load.time)
        return course

    def _refuse_many_moves(self) -> None:
        """No joint is moved further at once than the shortest delay beside it."""
        moves = sum((course.last / course.shortest for course in self._courses.values()), fmpq(0))
        if moves > MOST_MOVES:
            least = min(course.shortest for course in self._courses.values())
            raise CostError(
                f"output.until: waves cross the shortest rod in {nearest(least):g}, contacts are looked for "
                f"{nearest(moves):.1e} times, at most {MOST_MOVES:g} expected (a shorter horizon or longer rods help)"
            )

    def opening(self) -> Found | None:
        """The first opening."""
        for _ in self._steps():
            for each in self._found:
                if not each.closes:
                    return each
        return None

    def scheduled(self) -> Schedule:
        """All of it."""
        for _ in self._steps():
            pass
        return Schedule(
            {number: course.stages for number, course in self._courses.items()},
            {number: course.reached for number, course in self._courses.items()},
            tuple(sorted(self._found, key=lambda each: (each.low, each.link))),
            self._width,
            self._waves,
            ctx.prec,
        )

    def _steps(self) -> Iterator[None]:
        """Joints are moved in order of time."""
        self._coming = [(fmpq(0), number) for number in self._courses]
        while self._coming:
            time, number = heappop(self._coming)
            course = self._courses[number]
            if time <= course.last:
                self._advance(course, time)
                yield
                heappush(self._coming, (course.reached, number))

    def _advance(self, course: _Course, time: fmpq) -> None:
        """From where a joint's motion is known up to the next limit, or to where a contact may change."""
        breakpoint, limit = course.comes(time), course.limit(time)
        if course.moved is not None and not breakpoint and not self._swings(course.moved, limit - course.since):
            since, far = course.since, time - course.since
            moved = self._moved(course, since, limit - since, course.moved.closed)
            if moved.length > far:
                moved, end = self._cut(course, since, moved, far)
                if moved.length > far or end is not None:
                    self._kept(course, moved, end)
                    return
        if course.moved is not None:
            self._take(course, course.moved)
            course.moved = None
        self._begin(course, time, limit)

    def _swings(self, moved: Moved, length: fmpq) -> bool:
        """Whether a stretch would become too long for its series."""
        return moved.swing * length > MOST_SWING

    def _moved(self, course: _Course, start: fmpq, length: fmpq, closed: Closed) -> Moved:
        """On a stretch, or on as much of it as a series bears."""
        joint = self._waves.joints[course.number]
        try:
            arriving = self._waves.arriving(course.number, start, length)
            return joint.moved(arriving, start, length, closed, relaxing=self._relaxing)
        except SwingError as error:
            return self._moved(course, start, error.longest, closed)

    def _cut(self, course: _Course, start: fmpq, moved: Moved, low: fmpq) -> tuple[Moved, _End | None]:
        """As much of a stretch as all contacts are certainly what they are said to be, as they are up to `low`."""
        end = self._end(course, moved, low)
        if end is None or end.length == 0:
            return moved, end
        moved = self._moved(course, start, end.length, moved.closed)
        return moved, end if moved.length == end.length else None

    def _begin(self, course: _Course, start: fmpq, limit: fmpq) -> None:
        """A new stretch: what is closed on it? Until that is certain, it is left open, a little longer each time."""
        decided = self._decided(course, start, limit) if course.spread is None else None
        if decided is None:
            course.reached = self._drift(course, start, limit, course.spread or fmpq(0))
            course.spread = None
            return
        moved, end = decided
        for n, gap in course.gaps.items():
            closed = n in moved.closed
            if closed != gap.closed:
                doubted = course.doubt is not None and course.doubt.high == start
                low = course.doubt.low if course.doubt is not None and doubted else start
                self._found.append(Found(n, closed, low, start))
                gap.closed = closed
        course.since = start
        self._staged(course, Stage(start, moved.closed), moved)
        self._kept(course, moved, end)

    def _staged(self, course: _Course, stage: Stage, moved: Moved) -> None:
        course.stages.append(stage)
        course.swing = moved.swing
        self._stages += 1
        self._series += moved.swing > 0
        for count, most in ((self._stages, MOST_STAGES), (self._series, MOST_SERIES)):
            if count > most:
                raise CostError(
                    f"output.until: {self._met} make more than {most} stretches by tau = {nearest(stage.start):g}, at "
                    f"most {most} expected ({self._helps} help)"
                )
        if moved.swing > 0 and self._series % _FORETOLD == 0 and stage.start > 0:
            last = max(each.last for each in self._courses.values())
            foretold = self._series * last / stage.start
            if foretold > MOST_SERIES * (1 + fmpq(_MARGIN * _FORETOLD, self._series)):
                raise CostError(
                    f"output.until: {self._met} make {self._series} stretches by tau = {nearest(stage.start):g}, which "
                    f"would be {nearest(foretold):.1e} by tau = {nearest(last):g}, at most {MOST_SERIES} expected "
                    f"({self._helps} help)"
                )

    @property
    def _met(self) -> str:
        """What makes stretches."""
        events = f"{len(self._found)} openings and closings of contacts"
        if not self._is_fast(course := self._busiest):
            return f"fronts and {events}"
        place = self._network.points[self._network.joints[course.number].points[0]].place
        return f"what swings or decays at {place} at a rate of {nearest(course.swing):.3g}, fronts and {events}"

    @property
    def _helps(self) -> str:
        if not self._is_fast(self._busiest):
            return "a shorter horizon or lengths with a larger common measure"
        return "heavier bodies, or joints with dashpots in place of light ones, softer springs or a shorter horizon"

    @property
    def _busiest(self) -> _Course:
        """The joint with most stretches."""
        return max(self._courses.values(), key=lambda course: len(course.stages))

    def _is_fast(self, course: _Course) -> bool:
        """Whether stretches are cut short by what swings, not by fronts."""
        ends = self._network.joints[course.number].ends
        return (
            course.swing * min((self._network.bars[end.bar].delay for end, _ in ends), default=course.last) > MOST_SWING
        )

    def _decided(self, course: _Course, start: fmpq, limit: fmpq) -> tuple[Moved, _End | None] | None:
        """The motion under the choice of closed contacts that is certainly right just after `start`, and its end."""
        shut = [n for n, gap in course.gaps.items() if gap.shut]
        for closed in sorted(subsets(shut), key=len, reverse=True):
            moved = self._moved(course, start, limit - start, closed)
            if all(_starts_well(moved, n, gap) for n, gap in course.gaps.items()):
                moved, end = self._cut(course, start, moved, fmpq(0))
                return (moved, end) if end is None or end.length > 0 else None
        return None

    def _kept(self, course: _Course, moved: Moved, end: _End | None) -> None:
        """A stretch all the way, or up to its `end`, where a contact may change."""
        since = course.since
        if end is None:
            course.moved, course.reached = moved, since + moved.length
            self._tell(course, since, moved)
            return
        if end.length > 0:
            self._tell(course, since, moved)
            self._take(course, moved)
        course.moved, course.reached, course.spread = None, since + end.length, end.spread

    def _end(self, course: _Course, moved: Moved, low: fmpq) -> _End | None:
        """How long all contacts are certainly what they are said to be; None: all the way."""
        ends = [end for n, gap in course.gaps.items() if (end := self._certain(moved, n, gap, low)) is not None]
        if not ends:
            return None
        first = min(ends, key=lambda end: end.length)
        if first.spread is not None:  # an instant with a short denominator
            grid = self._resolution / 4
            aligned = ((course.since + first.length) / grid).floor() * grid - course.since
            if aligned > low:
                return _End(fmpq(aligned), max(end.spread or first.spread for end in ends))
        return first

    def _certain(self, moved: Moved, n: int, gap: _Gap, low: fmpq) -> _End | None:
        """The same of one contact."""
        if n in moved.closed:
            return self._positive(moved.pushes[n], low, moved.length)
        rate = moved.rates[n]
        if gap.exact is not None and rate.exact is not None:
            return self._positive(Enclosed.of(rate.exact.integral() + gap.exact), low, moved.length)
        if not gap.wide and low == 0:  # it opens: as long as it grows it is open
            grows = self._positive(rate, low, moved.length)
            if grows is None or grows.length == 0:
                return grows
            low = grows.length
        error = (rate.error * arb(moved.length)).upper()
        return self._positive(Enclosed(rate.polynomial.integral() + gap.size, error), low, moved.length)

    def _positive(self, known: Enclosed, low: fmpq, high: fmpq) -> _End | None:
        """Up to where a function that starts well is certainly not negative; None: all the way."""
        if known.exact is None:
            if known.least is not None and first_fall(known.least, low, high) is None:
                return None
            if known.choices and all(self._positive(each, low, high) is None for each in known.choices):
                return None
            if low == 0 and known.onset is not None:
                low = known.onset.positive_until(high)
                if low == high:
                    return None
            end = positive_until(known.polynomial, known.error, low, high, self._resolution)
            return None if end is None else _End(end, _spread(known, end))
        if known.over(arb(low).union(arb(high))) > 0:
            return None
        fall = first_fall(known.exact, low, high)
        if not isinstance(fall, tuple):
            return None if fall is None else _End(fall, None)
        before, after = fall
        while after - before > self._resolution:
            half = (before + after) / 2
            before, after = (half, after) if known.exact(half) > 0 else (before, half)
        return _End(before, fmpq(0))

    def _take(self, course: _Course, moved: Moved) -> None:
        """The joint goes to the end of its stretch; gaps become what they are there."""
        self._waves.joints[course.number].take(moved)
        for n, gap in course.gaps.items():
            if n in moved.closed:
                gap.size, gap.exact = arb(0), fmpq(0)
            else:
                gap.grow(moved.rates[n], moved.length)

    def _tell(self, course: _Course, start: fmpq, moved: Moved) -> None:
        """What a joint sends is kept; what begins there is a breakpoint at the other ends of its bars."""
        network = self._network
        begun = self._waves.record(course.number, start, moved)
        for (end, _), new in zip(network.joints[course.number].ends, begun, strict=True):
            other = self._courses.get(network.joint_of[network.point_at(network.beyond(end))])
            time = start + network.bars[end.bar].delay
            if new and other is not None and time <= other.last:
                heappush(other.breakpoints, time)

    def _drift(self, course: _Course, start: fmpq, limit: fmpq, spread: fmpq) -> fmpq:
        """Over a short stretch, on which it is left open what some contacts do; its end."""
        length = limit - start
        doubt = course.doubt
        if doubt is None or start - doubt.high > 16 * (doubt.high - doubt.low):
            doubt = course.doubt = _Doubt(start, start, max(self._least, 4 * spread))
        if length > self._width:
            if doubt.next > self._width:
                worst = next((n for n, gap in course.gaps.items() if not gap.shut and not gap.wide), min(course.gaps))
                raise _Undecided(worst, course.gaps[worst].closed, start)
            length = min(length, doubt.next)
            doubt.next *= 1 << _LONGER
        else:  # what is not known came with a front: it takes about as long again
            doubt.next = max(doubt.next, 4 * length)
        drifted, stage = self._drifted(course, start, length)
        h = arb(length)
        for n, gap in course.gaps.items():
            if n in stage.closed:
                continue
            if n not in stage.vague:
                gap.grow(drifted.rates[n], length)
                continue
            rate = _range(drifted.rates[n], length)
            grown = gap.size + h * rate.union(arb(0))
            if rate < 0 and _range(drifted.pushes[n], length) > 0 and gap.size + h * rate < 0:
                gap.size, gap.exact = arb(0), fmpq(0)
            else:
                gap.size, gap.exact = _not_negative(grown), None
        self._staged(course, stage, drifted)
        self._tell(course, start, drifted)
        self._waves.joints[course.number].take(drifted)
        doubt.high = start + length
        return doubt.high

    def _drifted(self, course: _Course, start: fmpq, length: fmpq) -> tuple[Moved, Stage]:
        """The motion, with all contacts vague that are not certainly open or closed all the time."""
        joint, arriving = self._waves.joints[course.number], self._waves.arriving(course.number, start, length)
        vague = {n for n, gap in course.gaps.items() if not gap.shut and not gap.wide}
        while True:
            closed = frozenset(n for n, gap in course.gaps.items() if gap.shut and n not in vague)
            drifted = joint.moved(arriving, start, length, closed, frozenset(vague))
            wrong = {n for n in closed if not _pushes(drifted.pushes[n], length)}
            for n, gap in course.gaps.items():
                if (
                    n not in closed
                    and n not in vague
                    and not (gap.size + arb(length) * _range(drifted.rates[n], length) > 0)
                ):
                    wrong.add(n)
            if not wrong:
                return drifted, Stage(start, closed, frozenset(vague))
            vague |= wrong


def _not_negative(size: arb) -> arb:
    """A gap, which is not negative, whatever its ball says."""
    if size >= 0:
        return size
    return arb(0).union(size.upper().max(arb(0)))


def _starts_well(moved: Moved, n: int, gap: _Gap) -> bool:
    """Whether a contact is certainly what it is said to be, just after the start of a stretch."""
    if n in moved.closed:
        if (least := moved.pushes[n].least) is not None and sign_after(least, fmpq(0)) >= 0:
            return True
        return all(
            _begins_positive(each) if each.exact is None else sign_after(each.exact, fmpq(0)) >= 0
            for each in moved.pushes[n].choices or (moved.pushes[n],)
        )
    if gap.wide:
        return True
    return all(
        _begins_positive(each) if each.exact is None else sign_after(each.exact, fmpq(0)) > 0
        for each in moved.rates[n].choices or (moved.rates[n],)
    )


def _begins_positive(known: Enclosed) -> bool:
    return known.at(fmpq(0)) > 0 or (known.onset is not None and known.onset.sign() > 0)


def _spread(known: Enclosed, x: fmpq) -> fmpq:
    """How far off the place is where a function comes to 0; 0 where that is not known."""
    slope = abs(known.polynomial.derivative()(arb(x))).lower()
    if not slope > 0:
        return fmpq(0)
    return middle(2 * (known.error + known.polynomial(arb(x)).rad()) / slope)


def _range(known: Enclosed, length: fmpq) -> arb:
    """All values on a stretch."""
    return known.over(arb(0).union(arb(length)))


def _pushes(known: Enclosed, length: fmpq) -> bool:
    """Whether a force is certainly not negative on a stretch."""
    if known.least is not None and first_fall(known.least, fmpq(0), length) is None:
        return True
    return all(
        _range(each, length) > 0 if each.exact is None else first_fall(each.exact, fmpq(0), length) is None
        for each in known.choices or (known,)
    )
