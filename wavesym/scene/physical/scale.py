"""What one of each dimensionless number is in SI base units, and in the units that results are told in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, ClassVar

from wavesym.fields.quantity import unit
from wavesym.fields.table import Faults, SceneTable, refusal, show
from wavesym.mechanics.clock import Clock
from wavesym.mechanics.length import LengthUnit
from wavesym.numbers.doubles import rational
from wavesym.systems.dimensionless import Kind
from wavesym.systems.elastic import Rods

KINDS: tuple[Kind, ...] = ("longitudinal", "torsional", "shear")
_ALONG = {"velocity": "velocity", "acceleration": "acceleration", "force": "force"}
_ROUND = {"velocity": "angular velocity", "acceleration": "angular acceleration", "force": "moment"}
_DEFAULTS = {
    "time": "s",
    "length": "m",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "force": "N",
    "moment": "N*m",
    "angle": "rad",
    "stress": "Pa",
}


class UnitsTable(SceneTable):
    """`[units]`: how waves move the rods of a chain, and the units of results. In torsion velocities are angular."""

    instead: ClassVar[Mapping[str, str]] = {"pressure": "write stress"}

    kind: object = None
    time: object = None
    length: object = None
    velocity: object = None
    acceleration: object = None
    force: object = None
    moment: object = None
    angle: object = None
    stress: object = None

    def chain_kind(self) -> Kind:
        """How waves move the rods of a chain that is written out."""
        if self.kind is None:
            return "longitudinal"
        for kind in KINDS:
            if self.kind == kind:
                return kind
        raise refusal(f'{show(self.kind)} is not a kind of waves; write "longitudinal", "torsional" or "shear"', "kind")


@dataclass(frozen=True)
class Results:
    """The units of results, and what each of them is in SI base units."""

    texts: Mapping[str, str]
    sizes: Mapping[str, Fraction]

    @classmethod
    def from_table(cls, units: UnitsTable, kind: Kind, faults: Faults) -> Results:
        """Those of a scene; what is wrong with them is kept in `faults`."""
        dimensions = {key: key for key in _DEFAULTS} | (_ROUND | {"force": "force"} if kind == "torsional" else _ALONG)
        texts: dict[str, str] = {}
        sizes: dict[str, Fraction] = {}
        for key, usual in _DEFAULTS.items():
            given = getattr(units, key)
            if given is None:
                given = usual.replace("m/", "rad/") if dimensions[key].startswith("angular") else usual
            with faults.gather("units", key):
                sizes[key] = unit(given, dimensions[key])
            texts[key] = str(given)
            sizes.setdefault(key, Fraction(1))
        return cls(texts, sizes)

    def length(self, one: Fraction) -> LengthUnit:
        """Their unit of length; `one` of x, in m, is so many of it."""
        return LengthUnit(one / self.sizes["length"], self.texts["length"])

    def unit_of(self, dimension: str) -> tuple[Fraction, str]:
        """The unit that a load of a dimension would be told in: its size and its text."""
        key = dimension.removeprefix("angular ")
        return self.sizes[key], self.texts[key]


@dataclass(frozen=True)
class Scale:
    """One tau is `seconds`; a displacement of 1 is so many m (rad in torsion), a force of 1 so many N (N m).

    `lengths` are those of the rods in units of x, in m; one alone where all are as long.
    """

    kind: Kind
    seconds: Fraction
    displacement: Fraction
    force: Fraction
    lengths: tuple[Fraction, ...]
    results: Results
    rods: Rods

    @cached_property
    def clock(self) -> Clock:
        """Time as results tell it."""
        per_tau = self.seconds / self.results.sizes["time"]
        return Clock(rational(self.seconds), rational(per_tau), self.results.texts["time"])

    @cached_property
    def canonical(self) -> dict[str, Any]:
        """What of it makes two scenes different, exact, for JSON."""
        numbers = {"seconds": self.seconds, "displacement": self.displacement, "force": self.force}
        results = {key: [text, str(self.results.sizes[key])] for key, text in self.results.texts.items()}
        if results["stress"][0] == _DEFAULTS["stress"]:  # so scenes keep the hash that they have had
            del results["stress"]
        return {
            "kind": self.kind,
            **{name: str(number) for name, number in numbers.items()},
            "lengths": list(map(str, self.lengths)),
            "results": results,
        }

    def factor(self, quantity: str, rod: int) -> Fraction:
        """What an output is multiplied by, `rod` being that of its place (from 1)."""
        sizes, moved = self.results.sizes, self._displacement_dimension
        match quantity:
            case "strain":
                length = self.lengths[(rod or 1) - 1 if len(self.lengths) > 1 else 0]
                strain = self.displacement / length
                return strain if self.kind != "torsional" else strain * sizes["length"] / sizes["angle"]
            case "velocity":
                return self.displacement / self.seconds / sizes["velocity"]
            case "acceleration":
                return self.displacement / self.seconds**2 / sizes["acceleration"]
            case "force":
                return self.force / sizes[self._force_dimension]
            case "stress":
                section = self.rods.all[rod - 1].section
                assert section is not None  # as `scene.stresses` has looked
                return self.force / section / sizes["stress"]
        return self.displacement / sizes[moved]

    def unit(self, quantity: str) -> str:
        """The unit of an output; empty for a strain, which has none but in torsion: an angle per length."""
        texts = self.results.texts
        match quantity:
            case "strain":
                return f"{texts['angle']}/{texts['length']}" if self.kind == "torsional" else ""
            case "velocity" | "acceleration" | "stress":
                return texts[quantity]
            case "force":
                return texts[self._force_dimension]
        return texts[self._displacement_dimension]

    @property
    def parts(self) -> dict[str, tuple[Fraction, str]]:
        """What a dimensionless 1 of a chain's parts is: in SI units, what moves and how fast in those of results."""
        stiffness = self.force / self.displacement
        turned = self.kind == "torsional"
        mass, spring, dashpot = ("kg*m^2", "N*m/rad", "N*m*s/rad") if turned else ("kg", "N/m", "N*s/m")
        return {
            "mass": (stiffness * self.seconds**2, mass),
            "spring": (stiffness, spring),
            "dashpot": (stiffness * self.seconds, dashpot),
            "impedance": (stiffness * self.seconds, dashpot),
            "velocity": (self.factor("velocity", 1), self.unit("velocity")),
            "displacement": (self.factor("displacement", 1), self.unit("displacement")),
            "energy": (self.force * self.displacement, "J"),
        }

    @property
    def _displacement_dimension(self) -> str:
        return "angle" if self.kind == "torsional" else "length"

    @property
    def _force_dimension(self) -> str:
        return "moment" if self.kind == "torsional" else "force"
