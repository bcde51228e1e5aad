"""The first modes of a chain with dashpots, and up to where none is missed.

The chain is taken apart where branches are equal (equal_branches.py), so that frequencies that are always equal do not
meet in one part. Those at 0 are exact (zero_modes.py). Without rods all others are roots of a polynomial
(polynomial_modes.py); with rods they are sought (damped_modes.py) and counted in circles (turns.py). Where two meet and
are not told apart, those below are counted.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from flint import acb

from wavesym.exact.modes.cuts import CutNetwork
from wavesym.exact.modes.damped_modes import SHARP, distinct_modes, search_modes
from wavesym.exact.modes.equal_branches import take_apart
from wavesym.exact.modes.frequencies import CoincidenceError, undamped_modes
from wavesym.exact.modes.polynomial_modes import polynomial_modes
from wavesym.exact.modes.resting import resting_modes
from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.exact.modes.turns import MOST_ROOTS, Circles
from wavesym.exact.modes.zero_modes import zero_modes
from wavesym.mechanics.network import Network

_SEARCHES, _BEYOND = 4, 3  # with some modes more, between which a circle has room
_MEETING = 1e-5  # of where frequencies meet: those nearer to it are not listed


@dataclass(frozen=True)
class CompleteModes:
    """The first modes, by the absolute values of their frequencies.

    Attributes:
        modes: those at 0 first, rigid motion before shifts; each as often as its frequency is one.
        reach: up to which absolute value none is missed.
        meeting: where two or more frequencies meet that are not told apart; None where none are known to. Modes end
            before it.
        are_roots: whether they are the roots of a polynomial.
    """

    modes: list[Mode]
    reach: float
    meeting: float | None = None
    are_roots: bool = False


class CompleteSpectrum(CutNetwork):
    """The modes of a network with dashpots."""

    def first(self, count: int) -> CompleteModes:
        """The first `count` modes, or fewer, where there are fewer or where several meet. UnservedError for a ring."""
        while True:
            whole = Stiffness(self.cut.network)
            parts = take_apart(self.cut.network)
            found = [_modes_of_part(part.network, count, not self.is_cut_most) for part in parts]
            if not any(each.is_open for each in found) or not self.cut_again():
                break
        every: list[Mode] = []
        for part, each in zip(parts, found, strict=True):
            made = {id(mode): list(part.modes_of_whole(mode, whole)) for mode in each.complete.modes}
            every += [copy for mode in each.complete.modes for copy in made[id(mode)]]
        every.sort(key=lambda mode: (abs(complex(mode.frequency)), mode.stays))
        meeting = min((each.complete.meeting for each in found if each.complete.meeting is not None), default=inf)
        below = [mode for mode in every if abs(complex(mode.frequency)) < meeting * (1 - _MEETING)]
        return CompleteModes(
            below[:count],
            min(each.complete.reach for each in found),
            None if meeting == inf else meeting,
            all(each.complete.are_roots for each in found),
        )


@dataclass(frozen=True)
class _OfPart:
    """`is_open` says whether some are not proved, and may be where rods are cut once more."""

    complete: CompleteModes
    is_open: bool = False


def _modes_of_part(network: Network, count: int, may_be_cut: bool) -> _OfPart:
    """The first modes of a network without equal branches, as it is cut: none where some ask for a cut that may be."""
    stiffness = Stiffness(network)
    damping = [point.damping for point in network.points if point.motion is None]
    if not any(each != 0 for each in [*damping, *(link.damping for link in network.links)]):
        return _undamped_modes(stiffness, count)
    circles, resting = Circles(network), zero_modes(stiffness)
    determinant = circles.determinant
    if determinant is not None and determinant.degree() <= MOST_ROOTS:
        roots = polynomial_modes(stiffness, determinant, SHARP)
        known = [mode for mode in roots if mode is not None]
        if len(known) == len(roots):
            return _OfPart(CompleteModes([*resting, *known], inf, are_roots=True))
    found: list[Mode] = []
    reach, is_open, slow = 0.0, False, circles.slow_frequencies()
    meeting: float | None = None
    for again in range(_SEARCHES):
        searched = search_modes(stiffness, count + _BEYOND, again, slow)
        is_open = is_open or searched.is_open
        if is_open and may_be_cut:
            break
        found = distinct_modes([*found, *searched.modes])
        sizes = [abs(complex(mode.frequency)) for mode in found]
        if searched.meeting is not None:
            meeting = searched.meeting if meeting is None else min(meeting, searched.meeting)
            found = [mode for mode, size in zip(found, sizes, strict=True) if size < meeting * (1 - _MEETING)]
        frequencies = [complex(mode.frequency) for mode in found]
        wanted = count if meeting is None else min(count, len(found))
        beyond = [] if meeting is None else [complex(meeting)]
        reach = circles.largest_complete([*frequencies, *beyond], wanted)
        enough = circles.is_finite or len(found) >= wanted
        if circles.is_exhausted or (enough and reach >= max(map(abs, frequencies[:wanted]), default=0.0)):
            break
    return _OfPart(CompleteModes([*resting, *found], reach, meeting), is_open)


def _undamped_modes(stiffness: Stiffness, count: int) -> _OfPart:
    """Those of what no dashpot is part of; their numbers are complex, as of others."""
    most = count if stiffness.modes is None else min(count, stiffness.modes)
    found: list[Mode] = []
    meeting = None
    try:
        if stiffness.points:
            found.extend(undamped_modes(stiffness, most))
        elif stiffness.network.bars:
            found = resting_modes(stiffness, float(stiffness.upper_bounds(np.array([most]))[0]))[:most]
    except CoincidenceError as error:
        meeting = error.place
    complex_modes = [
        replace(mode, frequency=acb(mode.frequency), points=[acb(q) for q in mode.points]) for mode in found
    ]
    return _OfPart(CompleteModes(complex_modes, inf if meeting is None else meeting, meeting), meeting is not None)
