"""How the numbers of a scene that is written out are written: as they are, or as quantities."""

from __future__ import annotations

import json
from collections.abc import Sequence
from fractions import Fraction

from flint import fmpq

from wavesym.fields.numbers import decimal_text
from wavesym.numbers.doubles import fraction
from wavesym.scene.physical.scale import Scale
from wavesym.systems.parts import ChainPart, RodPart
from wavesym.systems.place import Position

Number = fmpq | Fraction


def number_text(value: Number) -> str:
    """An exact number as TOML."""
    text = str(value)
    return text if "/" not in text else f'"{text}"'


class Dimensionless:
    """Numbers as they are."""

    remarks: Sequence[str] = ()

    def rod(self, number: int, part: RodPart) -> dict[str, str]:
        """The keys of a rod."""
        found = {"rod": number_text(part.rod)}
        for key, value in (("impedance", part.impedance), ("speed", part.speed)):
            if value != 1:
                found[key] = number_text(value)
        return found

    def mass(self, value: Number) -> str:
        """Of a body."""
        return number_text(value)

    def velocity(self, value: Number) -> str:
        """Of a rod or a body at first."""
        return number_text(value)

    def time(self, value: Number) -> str:
        """A time."""
        return number_text(value)

    def load(self, value: Number, degree: int, is_motion: bool) -> str:
        """A step (degree 0) or a slope (1), of a force, or of an end that is moved."""
        return number_text(value)

    def place(self, node: int) -> str:
        """A node of a line of rods of length 1."""
        return str(node)

    def position(self, position: Position) -> str:
        """Where an output is."""
        return position.text


class InUnits(Dimensionless):
    """Numbers as quantities in SI base units, so that what is written reads back as the same rods, masses and loads."""

    def __init__(self, scale: Scale, parts: Sequence[ChainPart | str]) -> None:
        self.scale = scale
        impedance = next(part.impedance for part in parts if isinstance(part, RodPart))
        self._mass = scale.rods.first.mass / impedance
        turns = scale.kind == "torsional"
        self._names = ("rad", "kg*m^2", "N*m") if turns else ("m", "kg", "N")
        self.remarks = (
            f"# What counts of a rod is {self._modulus} {self._section[0]}; {self._section[0]} is taken as 1.",
        )

    @property
    def _section(self) -> tuple[str, str]:
        return ("J", "1 m^4") if self.scale.kind == "torsional" else ("A", "1 m^2")

    @property
    def _modulus(self) -> str:
        return "E" if self.scale.kind == "longitudinal" else "G"

    def rod(self, number: int, part: RodPart) -> dict[str, str]:
        """Its length, and what it is made of."""
        rod = self.scale.rods.all[number]
        key, size = self._section
        return {
            "rod": _quantity(rod.length, "m"),
            key: json.dumps(size),
            self._modulus: _quantity(rod.stiffness * rod.length, "Pa"),
            "rho": _quantity(rod.mass / rod.length, "kg/m^3"),
        }

    def mass(self, value: Number) -> str:
        """Of a body, or its moment of inertia."""
        return _quantity(_fraction(value) * self._mass, self._names[1])

    def velocity(self, value: Number) -> str:
        """Of a rod or a body at first."""
        return _quantity(_fraction(value) * self.scale.displacement / self.scale.seconds, f"{self._names[0]}/s")

    def time(self, value: Number) -> str:
        """A time in seconds."""
        return _quantity(_fraction(value) * self.scale.seconds, "s")

    def load(self, value: Number, degree: int, is_motion: bool) -> str:
        """A step or slope of a force (a moment), or of the acceleration of an end."""
        scale, number = self.scale, _fraction(value) / self.scale.seconds**degree
        if is_motion:
            return _quantity(number * scale.displacement / scale.seconds**2, f"{self._names[0]}/s^{2 + degree}")
        return _quantity(number * scale.force, self._names[2] + degree * "/s")

    def place(self, node: int) -> str:
        """How far along the line a node is."""
        return json.dumps(self._place_text(Fraction(node)))

    def position(self, position: Position) -> str:
        """Where an output is, with its side."""
        assert position.x is not None  # named systems have places
        return self._place_text(position.x) + {-1: "-", 0: "", 1: "+"}[position.side]

    def _place_text(self, x: Fraction) -> str:
        lengths = self.scale.lengths
        whole = min(int(x), len(lengths) - 1)
        return f"{decimal_text(sum(lengths[:whole], Fraction(0)) + (x - whole) * lengths[whole])} m"


def _fraction(value: Number) -> Fraction:
    return value if isinstance(value, Fraction) else fraction(value)


def _quantity(value: Fraction, unit: str) -> str:
    return json.dumps(f"{decimal_text(value)} {unit}")
