"""The modes of a chain with dashpots: those of its parts, and up to where none is missed.

The chain is taken apart where branches are equal (equal_branches.py), so that frequencies that are always equal do not
meet in one part. Of a part those at 0 are exact. Without rods all others are roots of a polynomial
(polynomial_modes.py); with rods they are sought (damped_modes.py) and counted in circles (turns.py). Where two meet and
are not told apart, those below are counted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np
from flint import acb, arb, ctx, fmpq

from wavesym.errors import UnservedError
from wavesym.exact.modes.cuts import CutNetwork
from wavesym.exact.modes.damped_modes import SHARP, distinct_modes, proof_bits, search_modes
from wavesym.exact.modes.equal_branches import take_apart
from wavesym.exact.modes.frequencies import CoincidenceError, undamped_modes
from wavesym.exact.modes.polynomial_modes import polynomial_modes
from wavesym.exact.modes.resting import resting_modes
from wavesym.exact.modes.shape import FoundModes, Mode, rigid, rigid_mode, unstrained_groups
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.exact.modes.turns import MOST_ROOTS, Circles
from wavesym.mechanics.network import Network

_SEARCHES, _BEYOND = 4, 3  # with some modes more, between which a circle has room
_MEETING = 1e-5  # of where frequencies meet: those nearer to it are not listed


class DampedSpectrum(CutNetwork):
    """The modes of a network with dashpots that is cut at places (bar, part of it): complex numbers all.

    They come by the absolute values of their frequencies, of which real parts are at least 0. UnservedError for a ring.
    """

    def first(self, count: int) -> list[Mode]:
        """About the first `count` modes with a frequency, proved but not counted.

        UnservedError where frequencies coincide but those of equal branches.
        """
        found = self._modes_of_parts(lambda network, _: search_modes(Stiffness(network), count))
        if found.meeting is not None:
            raise UnservedError(
                f"system: two frequencies meet near {found.meeting:.6g}, which modes with dashpots cannot "
                "tell apart (take pieces or march)"
            )
        return found.modes

    def complete(self, count: int) -> FoundModes:
        """The first `count` modes, counted; fewer where there are fewer, or where several meet."""
        found = self._modes_of_parts(lambda network, may_be_cut: _modes_of_part(network, count, may_be_cut))
        meeting = inf if found.meeting is None else found.meeting
        below = [mode for mode in found.modes if abs(complex(mode.frequency)) < meeting * (1 - _MEETING)]
        return replace(found, modes=below[:count])

    def _modes_of_parts(self, find: Callable[[Network, bool], FoundModes]) -> FoundModes:
        """Those of all parts together, once `find` has those of each; it is told whether rods can be cut once more."""
        with ctx.workprec(proof_bits(self.cut.network)):
            parts = take_apart(self.cut.network)
        found = [find(part.network, not self.is_cut_most) for part in parts]
        if any(each.is_open for each in found) and self.cut_again():  # all points may be at rest
            return self._modes_of_parts(find)
        whole, every = Stiffness(self.cut.network), list[Mode]()
        with ctx.workprec(proof_bits(self.cut.network)):
            for part, each in zip(parts, found, strict=True):
                made = {id(mode): list(part.modes_of_whole(mode, whole)) for mode in each.modes}
                every += [copy for mode in each.modes for copy in made[id(mode)]]
        return FoundModes(
            sorted(every, key=lambda mode: (abs(complex(mode.frequency)), mode.stays)),
            min(each.reach for each in found),
            min((each.meeting for each in found if each.meeting is not None), default=None),
            all(each.are_roots for each in found),
        )


def _modes_of_part(network: Network, count: int, may_be_cut: bool) -> FoundModes:
    """The first modes of a network without equal branches, as it is cut: none where some ask for a cut that may be."""
    stiffness = Stiffness(network)
    if not network.loses:
        return _undamped_modes(stiffness, count)
    circles, resting = Circles(network), _zero_modes(stiffness)
    determinant = circles.determinant
    if determinant is not None and determinant.degree() <= MOST_ROOTS:
        roots = polynomial_modes(stiffness, determinant, SHARP)
        known = [mode for mode in roots if mode is not None]
        if len(known) == len(roots):
            return FoundModes([*resting, *known], inf, are_roots=True)
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
    return FoundModes([*resting, *found], reach, meeting, is_open=is_open)


def _undamped_modes(stiffness: Stiffness, count: int) -> FoundModes:
    """Those of what no dashpot is part of."""
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
    made = [mode.to_complex() for mode in found]
    return FoundModes(made, inf if meeting is None else meeting, meeting, is_open=meeting is not None)


def _zero_modes(stiffness: Stiffness) -> list[Mode]:
    """Rigid motion, if there is one, and shifts, each of one group alone: exact.

    Where s = i w is 0 dashpots resist nothing, so what holds points is rods and springs alone. Each group of points
    that these tie to each other, and to nothing at rest, has one motion without strain. Where dashpots resist it, it is
    a shift that stays: a zero of the determinant, as often as there are such motions that differ. Where they do not, as
    the whole chain moves alike, its velocity lasts too: a rigid motion, and a double zero.

    All groups together move as rigid motion does: beside it there is one shift less. Shifts are not scaled to a mass.
    """
    network = stiffness.network
    groups = unstrained_groups(network)
    free = None
    if all(point.damping == 0 for point in network.points):
        links = tuple(replace(link, stiffness=link.stiffness + link.damping) for link in network.links)
        free = rigid(replace(network, links=links))
    found = []
    if free is not None:
        found.append(rigid_mode(stiffness, free).to_complex())
    for group in groups[len(found) :]:
        points = [acb(arb(group.get(number, fmpq(0)))) for number in range(len(network.points))]
        found.append(Mode(stiffness, acb(0), points, stays=True))
    return found
