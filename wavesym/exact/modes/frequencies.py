"""The first frequencies of a chain: found in doubles, each proved to be the n-th in balls."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf

import numpy as np
from flint import arb, ctx, fmpq

from wavesym.errors import UnservedError
from wavesym.exact.modes.cuts import CutNetwork
from wavesym.exact.modes.equal_frequencies import WIDE, common_frequency, prove_cluster
from wavesym.exact.modes.resting import resting_modes
from wavesym.exact.modes.shape import FoundModes, Mode, rigid, rigid_mode, trial
from wavesym.exact.modes.stiffness import HarmonicLaw, Stiffness
from wavesym.mechanics.network import Network
from wavesym.numbers.arrays import Array

_BITS = 192
_BITS_A_ROW = 6  # of which determinants in balls take about 4
_TIMES = (1, 4, 8)  # as many bits; the most for those that are together
_BISECTIONS = 64
_NEWTON = 6
_TOGETHER = 2.0**-40
_NEAR = 2.0**-8  # a guess may be, where K loses digits in doubles beside resonances of bars
_NEARER = 2.0**-8  # than the root of what is to be told: what a step leaves is its square, times a number
_OFF = 2.0**-36  # a frequency itself tells less of its mode than one near it
_SHARP = arb(2) ** -60  # shapes


class CoincidenceError(ArithmeticError):
    """Frequencies whose modes no bits tell apart, or one at which all points are at rest: near `place`."""

    def __init__(self, message: str, place: float) -> None:
        super().__init__(message)
        self.place = place


def refuse_damped(network: Network) -> None:
    """UnservedError for what has no real modes: dashpots, absorbing ends."""
    for point in network.points:
        if point.damping != 0 and point.motion is None:
            raise UnservedError(
                f"system: the dashpot or absorbing end at {point.label} is not supported by modes "
                "(take pieces or march)"
            )
    for link in network.links:
        if link.damping != 0:
            at = link.place or network.points[link.left].label
            raise UnservedError(f"system: the dashpot at {at} is not supported by modes (pieces and march serve it)")


def frequencies(network: Network, count: int) -> tuple[arb, ...]:
    """The first `count` angular frequencies of an undamped network in balls, ascending; none is missed.

    Per unit of its time. Ends that move as they are told are at rest. A chain that nothing holds begins with 0.
    Of several that are equal each is one. UnservedError where it is damped or has contacts, and for frequencies that
    nearly coincide and whose modes cannot be told apart.

    >>> from wavesym import Scene
    >>> from wavesym.scene import lower
    >>> [float(w) for w in frequencies(lower(Scene.from_toml("drive_m1")).network, 2)]
    [0.0, 1.1362489714714046]
    """
    return tuple(mode.frequency for mode in Spectrum(network).first(count))


class Spectrum(CutNetwork):
    """The modes of an undamped network that is cut at places (bar, part of it), as many as are asked for.

    UnservedError as for `frequencies`.
    """

    def __init__(self, network: Network, places: Sequence[tuple[int, fmpq]] = ()) -> None:
        super().__init__(network, places)
        refuse_damped(network)
        self._found: list[Mode] = []

    def first(self, count: int) -> list[Mode]:
        """The first `count` modes, by their frequencies; all where there are fewer."""
        stiffness = Stiffness(self.cut.network)
        if stiffness.modes is not None:
            count = min(count, stiffness.modes)
        try:
            self._found += undamped_modes(stiffness, count, len(self._found))
        except CoincidenceError as error:
            if not self.cut_again():
                beside = " (a mass, however small, at an end of the rod with a spring beside it helps)"
                helps = beside if self.cut.network.parallel_bars else " (take pieces or march)"
                raise UnservedError(f"system: {error}, which modes cannot tell apart{helps}") from None
            self._found = []
            return self.first(count)
        return self._found[:count]

    def complete(self, count: int) -> FoundModes:
        """The same: none of them is missed."""
        return FoundModes(self.first(count), inf)


def undamped_modes(stiffness: Stiffness, count: int, known: int = 0) -> Iterator[Mode]:
    """The first modes of a network as it is cut, those after the first `known` ones. CoincidenceError."""
    if not stiffness.points:
        raise CoincidenceError("no point moves", 0.0)
    free = rigid(stiffness.network)
    laws: list[tuple[int, HarmonicLaw]] = []
    for times in _TIMES:
        bits = times * (_BITS + _BITS_A_ROW * len(stiffness.points))
        with ctx.workprec(bits):
            laws.append((bits, stiffness.law(arb)))
    guesses = bisect_frequencies(stiffness, count)
    roots = stiffness.softest_rows(guesses * (1 - _OFF)).tolist()
    together = np.diff(guesses) < _TOGETHER * guesses[1:]
    with ctx.workprec(laws[0][0]):
        resting = resting_modes(stiffness, float(guesses[-1]) * (1 + _OFF)) if len(guesses) else []
    n = known + 1
    while n <= count:
        if n == 1 and free:
            with ctx.workprec(_BITS):
                made = [rigid_mode(stiffness, free)]
        elif not (made := _prove_resting(stiffness, laws[0], n, float(guesses[n - 1]), resting)):
            # one that may be several is not tried as one alone
            tried = laws[2:] if together[max(n - 2, 0) : n].any() else laws
            found = (_prove_modes(stiffness, law, n, float(guesses[n - 1]), roots[n - 1], bits) for bits, law in tried)
            made = next((modes for modes in found if modes), [])
        if not made:
            raise CoincidenceError(f"two frequencies meet near {guesses[n - 1]:.6g}", float(guesses[n - 1]))
        yield from made
        n += len(made)


def _prove_resting(
    stiffness: Stiffness, law: tuple[int, HarmonicLaw], n: int, guess: float, resting: Sequence[Mode]
) -> list[Mode]:
    """The modes near a guess of which all points rest, if they are the n-th and following ones and no other is."""
    nearest = min((mode.frequency for mode in resting), key=lambda w: abs(float(w) - guess), default=arb(0))
    found = [mode for mode in resting if mode.frequency.overlaps(nearest)]
    if abs(float(nearest) - guess) > _NEAR * guess:
        return []
    with ctx.workprec(law[0]):
        sides = [found[0].frequency * (1 + sign * arb(_OFF)) for sign in (-1, 1)] if found else []
        counts = [stiffness.proved_count(law[1], side.mid()) for side in sides]
    return found if counts == [n - 1, n - 1 + len(found)] else []


def bisect_frequencies(stiffness: Stiffness, count: int) -> Array:
    """The first frequencies in doubles, by bisection of all at once."""
    n = np.arange(1, count + 1)
    high = stiffness.upper_bounds(n)
    low = np.zeros_like(high)
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        below = stiffness.count_below(middle) < n
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.asarray(high, np.float64)


def _prove_modes(stiffness: Stiffness, law: HarmonicLaw, n: int, guess: float, root: int, bits: int) -> list[Mode]:
    """The n-th mode, in which row `root` moves much, and those that no bits tell from it; none where more bits may."""
    with ctx.workprec(bits):
        if bits > 2 * WIDE:
            for near in _places_of_cluster(stiffness, law, n, guess, root):
                if (made := prove_cluster(stiffness, law, n, near)) and all(map(_is_sharp, made)):
                    return made
        w = _refine_by_newton(stiffness, law, n, guess, root, bits)
        if w is None:
            w = _refine_by_counts(stiffness, law, n, guess, bits // 3)
            if w is None or not _is_nth_alone(stiffness, law, n, w):
                return []
        found = trial(stiffness, law, w, root)
        scale = found.mass.rsqrt()
        mode = Mode(stiffness, w, stiffness.point_motions([scale * row for row in found.rows]))
    return [mode] if _is_sharp(mode) else []


def _places_of_cluster(stiffness: Stiffness, law: HarmonicLaw, n: int, guess: float, root: int) -> Iterator[arb]:
    """Where the n-th frequency and others may be that no bits tell from it."""
    if (w := common_frequency(stiffness, law, arb(guess), root)) is not None:
        yield w
    if (found := _refine_by_counts(stiffness, law, n, guess, WIDE + 2)) is not None:
        yield found.mid()


def _is_sharp(mode: Mode) -> bool:
    return all(q.rad() < _SHARP for q in mode.points)


def _refine_by_newton(stiffness: Stiffness, law: HarmonicLaw, n: int, guess: float, root: int, bits: int) -> arb | None:
    """The n-th frequency by Newton's method, from one near it."""
    small = arb(2) ** (-bits // 3)
    near = small.sqrt() * _NEARER
    w = arb(guess)
    for _ in range(_NEWTON):
        better = trial(stiffness, law, w, root).better(w)
        if not better.is_finite():
            return None
        moved, w = abs(better - w), better
        ball = arb(w, (w * small).upper())
        if moved < near * w and _is_nth_alone(stiffness, law, n, ball):
            return ball
    return None


def _is_nth_alone(stiffness: Stiffness, law: HarmonicLaw, n: int, w: arb) -> bool:
    """Whether the n-th frequency, and no other, is in a ball."""
    return stiffness.proved_count(law, w.lower()) == n - 1 and stiffness.proved_count(law, w.upper()) == n


def _refine_by_counts(stiffness: Stiffness, law: HarmonicLaw, n: int, guess: float, share: int) -> arb | None:
    """The same to `share` bits by counting alone, where another frequency is too near for Newton's method."""
    low, high = arb(guess), arb(guess)
    reach = arb(2) ** -40
    while (below := stiffness.proved_count(law, low)) is None or below >= n:
        low, reach = (low * (1 - reach)).mid(), 4 * reach
        if reach > 1:
            low = arb(0)
            break
    reach = arb(2) ** -40
    while (below := stiffness.proved_count(law, high)) is None or below < n:
        high, reach = (high * (1 + reach)).mid(), 4 * reach
    while high - low > arb(2) ** -share * high:
        # a little off the middle, which may be a frequency
        middle = ((low * 515 + high * 509) / 1024).mid()
        count = stiffness.proved_count(law, middle)
        if count is None:
            return None
        low, high = (middle, high) if count < n else (low, middle)
    return low.union(high)
