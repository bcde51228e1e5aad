"""When contacts open and close: found once, with so many bits that all later requests can rest on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from time import monotonic
from typing import TypeVar

from flint import ctx, fmpq

from wavesym.errors import WavesymError
from wavesym.exact.contacts.branches import Change, lasting
from wavesym.exact.contacts.course import CHATTER, UndecidedError
from wavesym.exact.contacts.search import Search
from wavesym.exact.contacts.touching_waves import Stage, TouchingWaves, replay
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import nearest
from wavesym.progress import tell_detail, warn_part

# what is tried: bits, and whether what decays fast is left out where it is lost among rounding errors (if it was not,
# the second is the first)
_ATTEMPTS = ((448, True), (448, False), (896, False))

# where more bits reach further, as friction that slips loses some each time, twice as many are tried, up to so many
_MOST_BITS = 7168
_FURTHER = 2**64  # longest stretches on which a branch is left open: a graze is no further with more bits

# springs: what is known to fewer bits than these at the end is found once more with twice as many; what is not known of
# them grows with each stretch, whatever the bits of waves that are made of it later
_KEPT_BITS = 128

# what is taken back so soon, in longest stretches on which it is left open what a contact does, is no event
_MOMENT = 64

T = TypeVar("T")


class GrazingError(WavesymError):
    """A contact that touches and does not, as far as any number of bits shows."""


@dataclass(frozen=True, eq=False)
class Schedule:
    """The stages of every joint, when its last one ends, and what contacts did, in order of time.

    No stage on which it is left open what a contact does is longer than `vague`. `waves` are those that it was found
    with, in so many `bits`.
    """

    stages: Mapping[int, Sequence[Stage]]
    ends: Mapping[int, fmpq]
    changes: tuple[Change, ...]
    vague: fmpq
    waves: TouchingWaves
    bits: int

    @property
    def breakpoints(self) -> Mapping[int, Sequence[fmpq]]:
        """The starts of the stages of every joint, and the end of the last one."""
        return {number: [*(stage.start for stage in each), self.ends[number]] for number, each in self.stages.items()}


def schedule(network: Network, loads: tuple[AppliedLoad, ...], last: tuple[tuple[int, fmpq], ...]) -> Schedule:
    """What happens at the joints, each until its last instant.

    CostError where it would take minutes, GrazingError where no number of bits tells what a contact does.
    """
    found = outcome(network, loads, last)
    if isinstance(found, WavesymError):
        raise found.with_traceback(None)
    return found


@lru_cache(maxsize=4)
def outcome(
    network: Network, loads: tuple[AppliedLoad, ...], last: tuple[tuple[int, fmpq], ...]
) -> Schedule | WavesymError:
    """The same, or why there is none: one program after another asks for it, and a refusal takes as long."""
    try:
        return _attempt(network, loads, last, _whole)
    except WavesymError as error:
        return error


@lru_cache(maxsize=16)
def first_opening(
    network: Network, loads: tuple[AppliedLoad, ...], last: tuple[tuple[int, fmpq], ...]
) -> Change | None:
    """The first opening of any contact; what comes after it is not looked at. None where there is none.

    CostError, GrazingError as in `schedule`.
    """
    return _attempt(network, loads, last, _opening)


@lru_cache(maxsize=1)
def waves(network: Network, loads: tuple[AppliedLoad, ...], known: Schedule, bits: int) -> TouchingWaves:
    """The waves of what is scheduled, with so many bits; the last ones are kept for whoever asks again."""
    with ctx.workprec(bits):
        if bits <= known.bits:
            return known.waves.round_to_precision(known.ends)
        return replay(network, known.stages, known.breakpoints, loads)


def _attempt(
    network: Network, loads: Sequence[AppliedLoad], last: tuple[tuple[int, fmpq], ...], follow: Callable[[Search], T]
) -> T:
    """What a search finds with as many bits as it takes."""
    tried: list[int] = []
    attempts, reached = list(_ATTEMPTS), fmpq(-1)
    first: T | None = None
    springs = all(network.links[number].is_spring_with_corner for number in network.corners)
    while attempts:
        bits, relaxing = attempts.pop(0)
        if bits in tried:
            continue
        with ctx.workprec(bits):
            search = Search(network, loads, dict(last), relaxing)
            try:
                found = follow(search)
            except UndecidedError as error:
                if first is not None:
                    return first
                undecided = error
                if error.chatters:
                    break
            else:
                if first is not None or not springs or search.known_bits() >= _KEPT_BITS:
                    return found
                first, attempts = found, [(2 * bits, False)]
                continue
        if not search.has_relaxed:
            tried.append(bits)
        if not attempts and undecided.tau - reached > _FURTHER * search.width and bits < _MOST_BITS:
            attempts.append((2 * bits, False))
        reached = undecided.tau
    raise _grazing_error(network, undecided, bits)


def _grazing_error(network: Network, undecided: UndecidedError, bits: int) -> GrazingError:
    """What so many bits do not show, where and when, and what helps."""
    link, shown = network.links[undecided.link], f"{bits} bits do not show"
    others = ""
    if undecided.chatters:
        what, others = f"changes its branch {CHATTER} times within no time", ", as others do theirs"
        change = "limit, load or length helps"
    elif link.friction != 0:
        what, change = f"{shown} whether it sticks or slips", "friction, load or length helps"
    elif link.is_spring_with_corner:
        what, change = f"{shown} what it does", "gap, yield, load or length helps"
    else:
        what = f"{shown} the sign of its {'force' if undecided.closed else 'gap'}"
        beside = next(joint.points for joint in network.joints if link.left in joint.points)
        rubs = any(each.friction != 0 and each.left in beside for each in network.links)
        other = "a rod between it and friction" if rubs else "heavier masses beside it"
        change = f"gap, load or length, or {other}, help"
    tau = f"{nearest(undecided.tau):.17g}"
    return GrazingError(f"{link.law} at {link.place}: {what} at tau = {tau}{others} (another {change})")


def _whole(search: Search) -> Schedule:
    start = monotonic()
    for passed in search.steps():
        tell_detail(f"events up to {passed:.0%} of the time, with {ctx.prec} bits")
        warn_part(passed, monotonic() - start, "to find all events", "a shorter horizon takes less")
    return Schedule(
        {number: course.stages for number, course in search.courses.items()},
        {number: course.reach for number, course in search.courses.items()},
        tuple(lasting(search.changes, _MOMENT * search.width)),
        search.width,
        search.waves,
        ctx.prec,
    )


def _opening(search: Search) -> Change | None:
    for _ in search.steps():
        for each in search.changes:
            if not each.closes:
                return each
    return None
