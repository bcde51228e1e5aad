"""What acts on a chain from the start and never changes: its own weight, and the forces that springs have at first.

A rod on which gravity g acts along x obeys u_tt = c^2 u_xx + g. With xi from its left end and its length L,

    s = g xi (L - xi) / (2 c^2),        c^2 s_xx = -g,        s = 0 at both ends,

so u = s + w, where w has waves and no weight, and moves the ends as u does. What s pulls at each end is half of the
rod's weight: points carry it, as they do their own. Every engine computes w; a strain or a force has s_x besides
(gauge.py). A rod's strain at first is that of u in its middle, and `gradient` by how much that grows along it.

At first a chain may be in balance (`static`). Parts that move do not take part in it, nor what rubs: contacts and
springs of one side carry nothing between them and what is at rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from flint import fmpq, fmpq_mat

from wavesym.errors import WavesymError
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import DEAD, Bar, Link, Network
from wavesym.mechanics.node import UnitLoad

_ZERO, _ONE = fmpq(0), fmpq(1)
_HALF = fmpq(1, 2)
_MOST = 400  # points that hold one another: seconds


class BalanceError(WavesymError):
    """What is at rest is in no balance at first, or in more than one."""


def with_dead_loads(network: Network, gravity: fmpq = _ZERO, *, static: bool = False) -> Network:
    """A network with what acts on it for good.

    Args:
        network: without it, its links strained as they say.
        gravity: an acceleration along x.
        static: whether what is at rest is in balance at first.

    Returns:
        The network, which feels nothing of it but what `dead_loads` has.

    Raises:
        BalanceError: there is no such balance, or more than one.
    """
    bars = [replace(bar, gravity=gravity) for bar in network.bars]
    forces = [gravity * point.mass if point.motion is None else _ZERO for point in network.points]
    for bar in bars:
        for end in (bar.left, bar.right):
            forces[end] += _HALF * gravity * bar.impedance * bar.delay
    links = list(network.links)
    if static:
        balance = _Balance(network, bars, forces)
        bars = [balance.strain_bar(bar) for bar in bars]
        links = [balance.load_link(link) for link in links]
        forces = [f - p.stiffness * u for f, p, u in zip(forces, network.points, balance.displacements, strict=True)]
    for number, link in enumerate(links):
        if link.preload != 0 and not link.has_corner:
            forces[link.left] += link.ratio * link.preload
            forces[link.right] -= link.preload
            links[number] = replace(link, preload=_ZERO)
    points = list(network.points)
    for number, force in enumerate(forces):
        if force != 0 and points[number].motion is None:
            unit = UnitLoad(f"{number}{DEAD}", None, (force,))
            points[number] = replace(points[number], loads=(*points[number].loads, unit))
    return Network(tuple(points), tuple(bars), tuple(links))


def dead_loads(network: Network) -> tuple[AppliedLoad, ...]:
    """The loads of a network that act from tau = 0 on and never change, such as weights: unit steps, one for each."""
    units = (unit for point in network.points for unit in point.loads)
    return tuple(AppliedLoad(unit.source, _ZERO, _ONE) for unit in units if unit.kind.endswith(DEAD))


@dataclass
class _Balance:
    """How far each point is displaced in the balance of what is at rest."""

    network: Network
    bars: Sequence[Bar]
    forces: Sequence[fmpq]

    def __post_init__(self) -> None:
        network = self.network
        self.displacements = [_ZERO] * len(network.points)
        self._moving = self._moving_points()
        self._acting = [link for link in network.links if self._acts(link)]
        for points in self._sets():
            self._solve(points)
        self._refuse_beyond()

    def strain_bar(self, bar: Bar) -> Bar:
        """A rod as it is strained."""
        if bar.left in self._moving:
            return bar
        if bar.strain != 0:
            raise BalanceError("a rod has a strain at first, which follows from the balance; leave it out")
        strain = (self.displacements[bar.right] - self.displacements[bar.left]) / bar.length
        return replace(bar, strain=strain, gradient=-bar.gravity / bar.speed**2)

    def load_link(self, link: Link) -> Link:
        """A link with the force that it has."""
        if link.side != 0:
            return replace(link, gap=link.gap - link.side * self._play(link))
        if link.contact or link.friction != 0:
            return link
        return replace(link, preload=self._pull(link))

    def _play(self, link: Link) -> fmpq:
        """How much longer a spring gets that acts, and the other one of its play: that stays as wide."""
        sides = (each for each in self._acting if each.side and (each.left, each.right) == (link.left, link.right))
        return next((self._longer(each) for each in sides), _ZERO)

    def _longer(self, link: Link) -> fmpq:
        return self.displacements[link.right] - self.displacements[link.left] if link in self._acting else _ZERO

    def _pull(self, link: Link) -> fmpq:
        """What a spring pulls."""
        at_first = link.preload if link.side == 0 else -link.side * link.stiffness * min(link.gap, _ZERO)
        return at_first + link.stiffness * self._longer(link)

    def _moving_points(self) -> set[int]:
        """Those that move, and what hangs on them."""
        network = self.network
        ties = [(bar.left, bar.right) for bar in network.bars]
        ties += [(link.left, link.right) for link in network.links if not _lets_go(link)]
        moving = {number for number, point in enumerate(network.points) if point.velocity != 0}
        moving |= {end for bar in network.bars if bar.velocity != 0 for end in (bar.left, bar.right)}
        coming = list(moving)
        while coming:
            here = coming.pop()
            beside = {other for tie in ties if here in tie for other in tie} - moving
            moving |= beside
            coming += beside
        return moving

    def _acts(self, link: Link) -> bool:
        """Whether it takes part: it is at rest, and holds or touches."""
        if {link.left, link.right} & self._moving or link.friction != 0:
            return False
        return link.gap <= 0 if link.contact or link.side else True

    def _sets(self) -> Iterator[list[int]]:
        """The points at rest that hold one another, but what is held as it is."""
        free = [n for n, point in enumerate(self.network.points) if point.motion is None and n not in self._moving]
        ties = [{bar.left, bar.right} for bar in self.bars] + [{link.left, link.right} for link in self._acting]
        left = set(free)
        while left:
            found, coming = set[int](), {min(left)}
            while coming:
                found |= coming
                coming = {end for tie in ties if tie & coming for end in tie if end in left} - found
            left -= found
            yield sorted(found)

    def _solve(self, points: Sequence[int]) -> None:
        """Displacements of points, and what closed contacts push: K u + (what contacts do) = forces, no gap."""
        network, place = self.network, {point: k for k, point in enumerate(points)}
        contacts = [link for link in self._acting if link.contact and {link.left, link.right} & place.keys()]
        size = len(points) + len(contacts)
        if size > _MOST:
            raise BalanceError(f"{size} points hold one another, the limit of a balance is {_MOST}")
        rows = [[_ZERO] * size for _ in range(size)]
        right = [self.forces[point] for point in points] + [_ZERO] * len(contacts)

        def hold(one: int, other: int, stiffness: fmpq, pull: fmpq = _ZERO) -> None:
            """A spring from one point to another one, which pulls at first."""
            for here, there, sign in ((one, other, 1), (other, one, -1)):
                if here in place:
                    rows[place[here]][place[here]] += stiffness
                    right[place[here]] += sign * pull
                    if there in place:
                        rows[place[here]][place[there]] -= stiffness

        for bar in self.bars:
            hold(bar.left, bar.right, bar.impedance * bar.speed / bar.length)
        for link in network.links:
            if not link.contact and link.friction == 0:
                stiffness = link.stiffness if link in self._acting else _ZERO
                hold(link.left, link.right, stiffness, self._pull(link))
        for point in points:
            rows[place[point]][place[point]] += network.points[point].stiffness
        for k, link in enumerate(contacts, len(points)):
            for end, sign in ((link.right, 1), (link.left, -1)):
                if end in place:
                    rows[place[end]][k] -= sign
                    rows[k][place[end]] += sign
        try:
            found = fmpq_mat(rows).solve(fmpq_mat([[value] for value in right]))
        except ZeroDivisionError:
            at = network.points[points[0]]
            raise BalanceError(
                f"what is at {at.label} is at rest and nothing holds it, so that it has no "
                "balance; write what it stands on, or its velocity"
            ) from None
        for point, k in place.items():
            self.displacements[point] = found[k, 0]
        for k, link in enumerate(contacts, len(points)):
            if found[k, 0] < 0:
                raise BalanceError(f"the contact at {link.place} would have to pull in the balance")

    def _refuse_beyond(self) -> None:
        """Springs beyond what their laws allow."""
        for link in self._acting:
            pull = self._pull(link)
            if link.limits is not None and not -link.limits[1] <= pull <= link.limits[0]:
                raise BalanceError(f"the spring at {link.place} yields in the balance; write more yield")
            if link.side * pull < 0:
                raise BalanceError(
                    f"the spring at {link.place} would have to {'push' if link.side > 0 else 'pull'} in the balance"
                )


def _lets_go(link: Link) -> bool:
    """Whether it carries nothing between what rests and what moves: it only touches."""
    return link.contact or link.friction != 0 or link.side != 0 or (link.limits is not None and min(link.limits) == 0)
