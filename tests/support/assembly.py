"""The text of a chain read part by part into M, C, K, rods and corners: what the truths in these tests start from.

Nothing of the package is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import arb, fmpq

from tests.support.laws import Corner, Law, Rubbing, Sided, Touching, Yielding

_ONE = fmpq(1)


def exact(number: object) -> fmpq:
    """A number of a scene."""
    return fmpq(*Fraction(str(number)).as_integer_ratio())


@dataclass
class Rod:
    """Two points with a rod between them; each end moves `ratio` times as fast as its point."""

    ends: tuple[int, int]
    ratios: tuple[fmpq, fmpq]
    length: Fraction
    speed: Fraction
    impedance: fmpq
    begun: tuple[fmpq, fmpq]
    """The waves in it at first: to the left, which arrives at its left end, and to the right."""

    @property
    def delay(self) -> Fraction:
        return self.length / self.speed


@dataclass
class Assembly:
    """M, C, K of a chain, as they are read part by part; C has the impedances of the rods in it."""

    mass: list[fmpq] = field(default_factory=list)
    velocity: list[fmpq] = field(default_factory=list)
    damping: dict[tuple[int, int], fmpq] = field(default_factory=dict)
    stiffness: dict[tuple[int, int], fmpq] = field(default_factory=dict)
    motion: dict[int, str] = field(default_factory=dict)
    rods: list[Rod] = field(default_factory=list)
    corners: list[Corner] = field(default_factory=list)
    names: dict[str, int] = field(default_factory=dict)
    lines: dict[str, list[tuple[Fraction, int]]] = field(default_factory=dict)
    """The points of each line with their places; those that a spring, dashpot or contact joins have the same place."""
    on: dict[str, list[int | None]] = field(default_factory=dict)
    """What follows each of them: a rod, or None for what has no length."""

    @classmethod
    def of(cls, scene: Mapping[str, Any]) -> Assembly:
        """The chain of a scene, given as the table that its text is."""
        made = cls()
        made.line("", scene["system"]["parts"])
        for branch in scene["system"].get("branch", ()):
            made.line(branch["name"], branch["parts"], made.names[branch["from"]], exact(branch.get("ratio", 1)))
        contacts = [corner for corner in made.corners if corner.subject == "contact"]
        for place in {contact.place for contact in contacts}:
            same = [contact for contact in contacts if contact.place == place]
            for contact, side in zip(same, ["-", *[""] * (len(same) - 2), "+"] if len(same) > 1 else [""], strict=True):
                contact.place += side
        return made

    def point(self) -> int:
        self.mass.append(fmpq(0))
        self.velocity.append(fmpq(0))
        return len(self.mass) - 1

    def tied(self, spring: fmpq, dashpot: fmpq, stretch: Mapping[int, fmpq]) -> None:
        """A spring and a dashpot whose lengthening is sum of factor times displacement."""
        for matrix, size in ((self.stiffness, spring), (self.damping, dashpot)):
            for i, left in stretch.items():
                for j, right in stretch.items():
                    matrix[i, j] = matrix.get((i, j), fmpq(0)) + size * left * right

    def bound(self, table: Mapping[str, Any], stretch: Mapping[int, fmpq], place: str) -> None:
        """The spring and the dashpot of a part, and its laws that have corners."""
        found = laws(table)
        for subject, law in found:
            self.corners.append(Corner(place, subject, stretch, law))
        sprung = {type(law) for _, law in found}
        spring, dashpot = exact(table.get("spring", 0)), exact(table.get("dashpot", 0))
        self.tied(fmpq(0) if sprung & {Sided, Yielding} else spring, fmpq(0) if Sided in sprung else dashpot, stretch)

    def line(self, name: str, parts: Sequence[Any], begin: int | None = None, ratio: fmpq = _ONE) -> None:
        """Read the parts of a line."""
        here = self.point() if begin is None else begin
        x, points, follows = Fraction(0), [(Fraction(0), here)], []
        for k, part in enumerate(parts):
            table = part if isinstance(part, Mapping) else {}
            place = f"{name}{name and ':'}{x}"
            beside = [p for p in parts[max(k - 1, 0) : k + 2] if isinstance(p, Mapping) and "rod" in p]
            if "rod" in table:
                there = self.point()
                self._rod(table, here, there, ratio, place)
                x += Fraction(str(table["rod"]))
                follows.append(len(self.rods) - 1)
            elif part == "contact" or "contact" in table:
                there = self.point()
                gap = exact(table.get("contact", 0))
                law = Touching("open" if gap > 0 else "closed", gap)
                self.corners.append(Corner(place, "contact", {here: -ratio, there: _ONE}, law))
                follows.append(None)
            elif not table or table.keys() & {"mass", "joint", "motion"}:
                self._node(here, part, table, beside, place)
                continue
            else:
                there = self.point()
                self.bound(table, {here: -ratio, there: _ONE}, place)
                follows.append(None)
            points.append((x, there))
            here, ratio = there, _ONE
        self.lines[name], self.on[name] = points, follows

    def _rod(self, table: Mapping[str, Any], here: int, there: int, ratio: fmpq, place: str) -> None:
        speed, v, strain = (
            exact(table.get(key, 0 if key != "speed" else 1)) for key in ("speed", "velocity", "strain")
        )
        length, impedance = Fraction(str(table["rod"])), exact(table.get("impedance", 1))
        begun = ((v + speed * strain) / 2, (v - speed * strain) / 2)
        self.rods.append(
            Rod((here, there), (ratio, _ONE), length, Fraction(str(table.get("speed", 1))), impedance, begun)
        )
        self.bound(table, {here: -ratio, there: _ONE}, place)
        for point, n in ((here, ratio), (there, _ONE)):
            self.tied(fmpq(0), impedance * n * n, {point: _ONE})

    def _node(
        self, point: int, part: object, table: Mapping[str, Any], beside: Sequence[Mapping[str, Any]], place: str
    ) -> None:
        if part == "fixed":
            self.motion[point] = "fixed"
        if part == "absorbing":
            self.tied(fmpq(0), exact(beside[0].get("impedance", 1)), {point: _ONE})
        if "motion" in table:
            self.motion[point] = table["motion"]
        self.mass[point] = exact(table.get("mass", 0))
        own = table.get("velocity", beside[0].get("velocity", 0) if beside and "mass" in table else 0)
        self.velocity[point] = exact(own)
        self.bound(table, {point: _ONE}, place)
        if "name" in table:
            self.names[table["name"]] = point

    def shown(self, quantity: str, place: object) -> int | tuple[int, Fraction]:
        """The point, or the rod and where in it, that shows a quantity at a place as it is written in a scene."""
        text = str(place)
        side = text[-1] if text[-1] in "-+" else ""
        line, _, at = text.rstrip("+-").rpartition(":") if ":" in text else ("", "", text.rstrip("+-"))
        if at in self.names and quantity != "strain":
            return self.names[at]
        points, follows = self.lines[line], self.on[line]
        x = next(x for x, point in points if point == self.names[at]) if at in self.names else Fraction(at)
        rods = [(points[k][0], rod) for k, rod in enumerate(follows) if rod is not None]
        if quantity != "strain":
            there = [point for where, point in points if where == x]
            # a branch begins with the end of its rod, which moves as its ratio says
            if there and not (line and x == 0 and len(there) == 1):
                return there[-1 if side == "+" else 0]
        inside = [(start, rod) for start, rod in rods if start <= x <= start + self.rods[rod].length]
        start, number = inside[0] if side == "-" or len(inside) == 1 else inside[-1]
        return number, x - start

    def loaded(self, at: str) -> int:
        """The point that a load acts on."""
        if at in self.names:
            return self.names[at]
        line, _, bare = at.rstrip("+-").rpartition(":")
        there = [point for x, point in self.lines[line] if x == Fraction(bare)]
        return there[-1 if at[-1] == "+" else 0]


def laws(table: Mapping[str, Any]) -> list[tuple[str, Law]]:
    """The laws that have corners of a part, each with the name of what has it."""
    found: list[tuple[str, Law]] = []
    if table.get("friction"):
        found.append(("friction", Rubbing("sticks", exact(table["friction"]), exact(table.get("breakaway", 0)))))
    spring, dashpot, gap = exact(table.get("spring", 0)), exact(table.get("dashpot", 0)), table.get("gap", 0)
    if "yield" in table:
        limits = table["yield"] if isinstance(table["yield"], list) else [table["yield"]] * 2
        plastic = arb(-exact(table.get("preload", 0)) / spring)
        found.append(("spring", Yielding("holds", spring, (exact(limits[0]), exact(limits[1])), plastic)))
    elif "only" in table or "gap" in table:
        if isinstance(gap, list):
            sides = [(-1, -exact(gap[0])), (1, exact(gap[1]))]
        else:
            sides = [(1 if table.get("only") == "pull" else -1, exact(gap))]
        for side, free in sides:
            found.append(("spring", Sided("idles" if free > 0 else "acts", side, free, spring, dashpot)))
    return found


def jumps(load: Mapping[str, Any]) -> Iterator[tuple[Fraction, int, fmpq]]:
    """When a load jumps (power 0) or changes its slope (power 1), and by how much."""
    if "samples" in load:
        spacing, samples = Fraction(str(load["spacing"])), [exact(sample) for sample in load["samples"]]
        slopes = [fmpq(0), *((b - a) / exact(spacing) for a, b in pairwise(samples)), fmpq(0)]
        yield Fraction(0), 0, samples[0]
        for k, (before, after) in enumerate(pairwise(slopes)):
            yield k * spacing, 1, after - before
        return
    for power, key in enumerate(("steps", "ramps")):
        for time, size in zip(load["times"], load.get(key, ()), strict=False):
            yield Fraction(str(time)), power, exact(size)
