"""The kinds of joints in a network, with symbols for their numbers: the law of joints runs over them as over numbers.

Symbols, numbered within the joint: M_i, c_i, K_i are mass, dashpot and spring of its points; Z_e and n_e impedance and
ratio of the rod ends at it; d_l, k_l and r_l dashpot, spring and ratio of what holds its points together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from flint import fmpq

from wavesym.exact.joints.joint_law import JointLaw
from wavesym.mechanics.network import Bar, Joint, Link, Network, Point
from wavesym.numbers.ratio import Ratio, Ring

_NONE, _ONE = fmpq(0), fmpq(1)
_CONTACT = "contact (open; closed, they move as one)"


@dataclass(frozen=True)
class LoneJoint:
    """A joint alone, in numbers or in symbols: its law, and of each end its point and ratio and what a wave counts."""

    network: Network
    joint: Joint
    law: JointLaw


@dataclass(frozen=True)
class Kind:
    """Joints that differ in numbers alone: in symbols, and which they are."""

    symbols: LoneJoint
    numbers: tuple[int, ...]


def kinds(network: Network) -> tuple[Kind, ...]:
    """All kinds, in the order in which one meets them."""
    found: dict[Any, list[int]] = {}
    for number in range(len(network.joints)):
        found.setdefault(_structure(isolate_joint(network, number).network), []).append(number)
    return tuple(Kind(_symbolic(isolate_joint(network, numbers[0])), tuple(numbers)) for numbers in found.values())


def isolate_joint(network: Network, number: int) -> LoneJoint:
    """A joint with its points, its links and the bars at it, whose other ends are nowhere."""
    joint = network.joints[number]
    place = {point: k for k, point in enumerate(joint.points)}
    bars, far = [], len(joint.points)
    for end, point in joint.ends:
        bar = network.bars[end.bar]
        left, right = (far, place[point]) if end.side else (place[point], far)
        bars.append(Bar(left, right, bar.length, bar.speed, bar.impedance, bar.ratios, name=bar.name))
    links = [
        Link(place[link.left], place[link.right], link.stiffness, link.damping, link.ratio, link.contact)
        for link in network.links
        if link.left in place
    ]
    return _write([network.points[point] for point in joint.points], bars, links)


def _write(points: list[Point], bars: list[Bar], links: list[Link]) -> LoneJoint:
    network = Network((*points, Point(_NONE)), tuple(bars), tuple(links))
    ends = tuple(end for end in network.joints[-1].ends)
    near = Joint(
        tuple(range(len(points))), tuple((network.opposite_end(end), _near_point(bars[end.bar])) for end, _ in ends)
    )
    return LoneJoint(network, near, JointLaw.assemble(network, near))


def _near_point(bar: Bar) -> int:
    return min(bar.left, bar.right)  # the other end is at the last point


def _structure(network: Network) -> Any:
    """What two joints of one kind have in common."""
    return (
        tuple((p.mass != 0, p.damping != 0, p.stiffness != 0, p.motion, bool(p.loads)) for p in network.points),
        tuple((_near_point(bar), bar.ratios[int(bar.left != _near_point(bar))] != 1) for bar in network.bars),
        tuple(
            (link.left, link.right, link.stiffness != 0, link.damping != 0, link.ratio != 1, link.contact)
            for link in network.links
        ),
    )


def values(joint: LoneJoint) -> dict[str, fmpq]:
    """The numbers of a joint by the names of their symbols."""
    found: dict[str, fmpq] = {}
    for i, point in enumerate(joint.network.points[:-1], 1):
        found |= {f"M_{i}": point.mass, f"c_{i}": point.damping, f"K_{i}": point.stiffness}
    for e, (end, _) in enumerate(joint.joint.ends, 1):
        bar = joint.network.bars[end.bar]
        found[f"Z_{e}"] = bar.impedance
        if bar.ratios[end.side] != 1:
            found[f"n_{e}"] = bar.ratios[end.side]
    for number, link in enumerate(joint.network.links, 1):
        found |= {f"k_{number}": link.stiffness, f"d_{number}": link.damping}
        if link.ratio != 1:
            found[f"r_{number}"] = link.ratio
    return {name: value for name, value in found.items() if value != 0}


def _symbolic(joint: LoneJoint) -> LoneJoint:
    """The same joint with symbols for the numbers that it has."""
    symbols: Mapping[str, Ratio] = Ring(tuple(values(joint))).symbols()

    def symbol(name: str, usual: fmpq = _NONE) -> Any:
        return symbols.get(name, usual)

    points = [
        Point(symbol(f"M_{i}"), symbol(f"c_{i}"), symbol(f"K_{i}"), motion=point.motion, loads=point.loads)
        for i, point in enumerate(joint.network.points[:-1], 1)
    ]
    bars = []
    for e, bar in enumerate(joint.network.bars, 1):
        ratio = symbol(f"n_{e}", _ONE)
        bars.append(Bar(bar.left, bar.right, bar.length, bar.speed, symbol(f"Z_{e}"), (ratio, ratio)))
    links = [
        Link(link.left, link.right, symbol(f"k_{n}"), symbol(f"d_{n}"), symbol(f"r_{n}", _ONE), link.contact)
        for n, link in enumerate(joint.network.links, 1)
    ]
    return _write(points, bars, links)


def describe_joint(joint: LoneJoint) -> Iterator[str]:
    """What a kind of joint consists of, in words, point by point."""
    network = joint.network
    for i, point in enumerate(network.points[:-1], 1):
        sizes = (("mass", point.mass), ("dashpot", point.damping), ("spring", point.stiffness))
        own = [word for word, size in sizes if size != 0]
        rods = [bar for bar in network.bars if _near_point(bar) == i - 1]
        geared = any(bar.ratios[int(bar.left != i - 1)] != 1 for bar in rods)
        what = {None: "joint", "fixed": "fixed end"}.get(point.motion, f"end of prescribed {point.motion}")
        what = ", ".join(own) or what if point.motion is None else what
        count = f"{len(rods)} rod{'s' * (len(rods) != 1)}" if rods else "no rod"
        which = f"{i}: " if len(network.points) > 2 else ""
        yield f"{which}{what}; {count}{', geared' * geared}{', loaded' * bool(point.loads)}"
    for link in network.links:
        names = (("spring", link.stiffness != 0), ("dashpot", link.damping != 0), (_CONTACT, link.contact))
        what = " and ".join(word for word, there in names if there)
        yield f"{what} between {link.left + 1} and {link.right + 1}"
