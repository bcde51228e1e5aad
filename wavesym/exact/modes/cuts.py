"""A network with points wherever something is to be known, inside bars too."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.network import Bar, End, Network, Point

_ZERO, _ONE = fmpq(0), fmpq(1)
# Where a bar is cut so that no mode within reach is at rest at both ends of a piece: a fraction with a large prime
# below, as delays are simple fractions of each other.
_ASIDE = fmpq(38197, 100003)


@dataclass(frozen=True)
class Cut:
    """A network whose bars are cut, `places[bar]` from left to right; `firsts[bar]` is the first of a bar's pieces."""

    network: Network
    places: tuple[tuple[fmpq, ...], ...]
    firsts: tuple[int, ...]

    def end(self, bar: int, place: fmpq, before: bool = True) -> End:
        """The end of a piece that lies at a place of a bar: of the piece `before` it, or of that after it."""
        if place == 0 or (place != 1 and not before):
            return End(self.firsts[bar] + (0 if place == 0 else 1 + self.places[bar].index(place)), 0)
        return End(self.firsts[bar] + (len(self.places[bar]) if place == 1 else self.places[bar].index(place)), 1)


def cut(network: Network, places: Iterable[tuple[int, fmpq]], *, aside: bool = False) -> Cut:
    """The network with a massless point at each of the places (bar, part of it from its left end).

    With `aside` every piece is cut once more, so that no mode has all points at rest.
    """
    wanted: list[set[fmpq]] = [set() for _ in network.bars]
    for bar, place in places:
        if 0 < place < 1:
            wanted[bar].add(place)
    points, bars = list(network.points), list[Bar]()
    firsts, cuts = list[int](), list[tuple[fmpq, ...]]()
    for whole, inside in zip(network.bars, wanted, strict=True):
        if aside:
            edges = [_ZERO, *sorted(inside), _ONE]
            inside |= {a + (b - a) * _ASIDE for a, b in pairwise(edges)}
        firsts.append(len(bars))
        cuts.append(tuple(sorted(inside)))
        bars += _pieces(whole, cuts[-1], len(points))
        points += [Point(_ZERO)] * len(inside)
    return Cut(Network(tuple(points), tuple(bars), network.links), tuple(cuts), tuple(firsts))


def _pieces(bar: Bar, places: tuple[fmpq, ...], first: int) -> list[Bar]:
    edges = [_ZERO, *places, _ONE]
    ends = [bar.left, *range(first, first + len(places)), bar.right]
    ratios = [bar.ratios[0], *(_ONE for _ in places), bar.ratios[1]]
    return [
        replace(
            bar,
            left=ends[k],
            right=ends[k + 1],
            length=(edges[k + 1] - edges[k]) * bar.length,
            ratios=(ratios[k] if k == 0 else _ONE, ratios[k + 1] if k + 1 == len(ratios) - 1 else _ONE),
        )
        for k in range(len(edges) - 1)
    ]


class CutNetwork:
    """A network that is cut at places (bar, part of it), and once more where all points of a mode may be at rest.

    UnservedError for laws with corners: there are no modes of what is not one linear law for good.
    """

    def __init__(self, network: Network, places: Sequence[tuple[int, fmpq]] = ()) -> None:
        for link in (network.links[number] for number in network.corners):
            at = link.place or network.points[link.left].label
            raise UnservedError(f"system: the {link.law} at {at} is not supported by modes (pieces serve it)")
        self._cuts = [cut(network, places)]
        if not network.parallel_bars:  # where cuts would make rings
            self._cuts.append(cut(network, places, aside=True))

    @property
    def cut(self) -> Cut:
        """The network as it is cut."""
        return self._cuts[0]

    @property
    def is_cut_most(self) -> bool:
        """Whether it cannot be cut once more."""
        return not self._cuts[1:]

    def cut_again(self) -> bool:
        """Go on with the network that is cut once more, if it has not been."""
        if self.is_cut_most:
            return False
        del self._cuts[0]
        return True
