"""Rods as waves see them: how long, how heavy, how stiff; and what of them is irrational."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from wavesym.fields.rounding import polar_moment, root
from wavesym.fields.table import refusal


def round_section(diameter: Fraction, bore: Fraction | None) -> Fraction:
    """The polar moment of a round shaft. Raises the error of `table.refusal` for one that is all bore."""
    if bore and bore >= diameter:
        raise refusal("as wide as the shaft or wider; write a bore below the diameter", "bore")
    return polar_moment(diameter, bore or Fraction(0))


@dataclass(frozen=True)
class ElasticRod:
    """A rod in SI base units: its length, its mass, and the force on it per metre that its ends part.

    In torsion its moment of inertia, and the moment per radian. A wave takes sqrt(mass/stiffness) from end to end, and
    its impedance is sqrt(mass stiffness). Its stress is the force over `section`, where that is known: the area; of a
    round shaft J over the radius, for the stress at its surface.
    """

    length: Fraction
    mass: Fraction
    stiffness: Fraction
    width_squared: Fraction | None = None
    section: Fraction | None = None

    @classmethod
    def from_area(
        cls, length: Fraction, modulus: Fraction, area: Fraction, density: Fraction, *, sheared: bool = False
    ) -> ElasticRod:
        """A rod of one section: E A, or k G A of one that is sheared, over its length, and its mass."""
        return cls(length, density * area * length, modulus * area / length, None if sheared else area, area)

    @classmethod
    def from_polar_moment(
        cls, length: Fraction, modulus: Fraction, moment: Fraction, density: Fraction, diameter: Fraction | None
    ) -> ElasticRod:
        """A shaft of one section: G J over its length, and its inertia; `diameter` if it is round."""
        square, section = (None, None) if diameter is None else (diameter**2, 2 * moment / diameter)
        return cls(length, density * moment * length, modulus * moment / length, square, section)

    @property
    def slenderness(self) -> float | None:
        """How many times as long as wide it is, where that is known: of columns each, as if they were square."""
        return None if self.width_squared is None else float(self.length**2 / self.width_squared) ** 0.5

    @property
    def delay_squared(self) -> Fraction:
        """The square of how long a wave takes from end to end."""
        return self.mass / self.stiffness


@dataclass(frozen=True)
class Rods:
    """The rods of a scene, in order; all that is made relative is so to the first, or without any to 1 m, 1 s and 1 kg.

    The delay of the first, l/c, and where rods differ the ratios of their delays are rounded, each unless it is
    rational. Masses are kept, so that impedances follow: mass/delay.
    """

    all: tuple[ElasticRod, ...]
    seconds: Fraction
    ratios: tuple[Fraction, ...]

    @classmethod
    def from_rods(cls, rods: Sequence[ElasticRod]) -> Rods:
        """Rods with their delays."""
        if not rods:
            return cls((), Fraction(1), ())
        first = rods[0]
        ratios: dict[Fraction, Fraction] = {}
        for rod in rods:
            square = rod.delay_squared / first.delay_squared
            if square not in ratios:
                ratios[square] = root(square)
        return cls(
            tuple(rods),
            root(first.delay_squared),
            tuple(ratios[rod.delay_squared / first.delay_squared] for rod in rods),
        )

    @property
    def first(self) -> ElasticRod:
        """The one whose length and delay are the units."""
        return self.all[0] if self.all else ElasticRod(Fraction(1), Fraction(1), Fraction(1))

    @property
    def in_step(self) -> bool:
        """Whether a wave takes equally long through each of them."""
        return all(ratio == 1 for ratio in self.ratios)

    @property
    def alike(self) -> bool:
        """Whether they are as heavy and as stiff as one another, too."""
        return self.in_step and all(rod.mass == self.first.mass for rod in self.all)

    @property
    def rounded_ratios(self) -> int:
        """How many different ratios of delays are irrational, and so rounded."""
        first = self.first.delay_squared
        return len(
            {ratio for rod, ratio in zip(self.all, self.ratios, strict=True) if ratio**2 != rod.delay_squared / first}
        )

    def impedance(self, number: int) -> Fraction:
        """That of a rod, the first one's being 1."""
        return self.all[number].mass / self.first.mass / self.ratios[number]

    @property
    def parts(self) -> list[dict[str, object]]:
        """Each of them as a part of a chain that counts rods."""
        return [self.part(number, Fraction(1)) for number in range(len(self.all))]

    def part(self, number: int, length: Fraction) -> dict[str, object]:
        """A rod as a part of a chain that is so long there."""
        found: dict[str, object] = {"rod": length}
        if (impedance := self.impedance(number)) != 1:
            found["impedance"] = impedance
        if (speed := length / self.ratios[number]) != 1:
            found["speed"] = speed
        return found
