"""A chain in physical units: quantities in its parts and lengths for its places.

The first rod is the unit: of length, of time by its delay, of impedance. Displacements are counted in its length,
angles in radians.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from pydantic import Field

from wavesym.fields.numbers import LONGEST, exact
from wavesym.fields.quantity_fields import read_quantity
from wavesym.fields.table import Faults, SceneTable, as_list, key_context, refusal, show
from wavesym.scene.physical.chain_parts import OTHERS, RODS, RodKeys
from wavesym.scene.physical.places import PlaceInMetres, place
from wavesym.systems.dimensionless import DimensionlessSystem, Kind, LoadUnit
from wavesym.systems.elastic import ElasticRod, Rods
from wavesym.systems.parts import PartName, unfold_ground
from wavesym.systems.place import PlaceInUnits

_Keys = tuple[str | int, ...]
_Read = tuple[_Keys, object]
"""A part and where it is: a table of keys, or what is no table of a part, as it is."""

_TRANSLATION = {
    "mass": "mass",
    "displacement": "length",
    "velocity": "velocity",
    "acceleration": "acceleration",
    "jerk": "jerk",
    "spring": "stiffness",
    "dashpot": "damping constant",
    "force": "force",
    "force rate": "force rate",
}
_ROTATION = {
    "mass": "moment of inertia",
    "displacement": "angle",
    "velocity": "angular velocity",
    "acceleration": "angular acceleration",
    "jerk": "angular jerk",
    "spring": "rotational stiffness",
    "dashpot": "rotational damping constant",
    "force": "moment",
    "force rate": "moment rate",
}


class PhysicalBranch(SceneTable):
    """Parts that start at a named node."""

    from_: PartName = Field(alias="from", description="the name of a node")
    name: PartName = Field(description="a name")
    ratio: Any = 1
    parts: Any = Field(description="a list of parts")


class PhysicalChain(SceneTable):
    """A chain that is written out, part by part."""

    type: str
    parts: Any = Field(description="a list of parts")
    branch: tuple[PhysicalBranch, ...] = ()
    damping: Any = None
    speed_adjustment: Any = None
    gravity: Any = Field(None, description="an acceleration along x")
    initial: Any = Field(None, description='"static": what is at rest is in balance at first')

    def without_units(self, kind: Kind) -> DimensionlessSystem:
        """As a chain without units. Raises the error of `table.refusal`."""
        faults = Faults()
        main = _read(faults, self.parts, kind, "parts")
        branches = [_read(faults, branch.parts, kind, "branch", k, "parts") for k, branch in enumerate(self.branch)]
        names = _TRANSLATION if kind != "torsional" else _ROTATION
        elastic: list[ElasticRod] = []
        for keys, part in (read for line in (main, *branches) for read in line):
            if isinstance(part, RodKeys):
                with faults.gather(*keys):
                    elastic.append(part.elastic(names["dashpot"]))
        if faults.found:  # what else is wrong does not hang together with these
            blank = _Pen(kind, names, Rods.from_rods(()))
            for line in (main, *branches):
                with faults.gather():
                    blank.line("", [(keys, part) for keys, part in line if not isinstance(part, RodKeys)])
        faults.refuse()
        rods = Rods.from_rods(elastic)
        pen = _Pen(kind, names, rods)
        table: dict[str, object] = {"type": "chain", "parts": pen.line("", main)}
        if self.branch:
            table["branch"] = [
                {"from": each.from_, "name": each.name, "ratio": each.ratio, "parts": pen.line(each.name, parts)}
                for each, parts in zip(self.branch, branches, strict=True)
            ]
        for key in ("damping", "speed_adjustment", "initial"):
            if (said := getattr(self, key)) is not None:
                table[key] = said
        if self.gravity is not None:
            with key_context("gravity"):
                if kind != "longitudinal":
                    raise refusal("acts along x, and such rods do not move along it; leave it out")
                table["gravity"] = read_quantity(self.gravity, "acceleration") / pen.acceleration
        return DimensionlessSystem(
            kind=kind,
            rods=rods,
            system=table,
            displacement=pen.displacement,
            force=pen.force,
            lengths=(rods.first.length,),
            load_unit=pen.load_unit,
            lines=pen.lines,
        )


def _read(faults: Faults, parts: object, kind: Kind, *at: str | int) -> list[_Read]:
    """Parts by their keys; what is wrong with them is kept in `faults`."""
    values: Sequence[object] = ()
    with faults.gather(*at):
        values = as_list(parts)
    found: list[_Read] = []
    for k, value in enumerate(values):
        with faults.gather(*at, k):
            found.append(((*at, k), _part(value, kind)))
    return found


def _part(value: object, kind: Kind) -> object:
    if not isinstance(value, Mapping):
        return value  # a mark, or what is refused with the chain
    known = {"rod": RODS[kind], **OTHERS, "dashpot": OTHERS["spring"], "friction": OTHERS["spring"]}
    keys = next((known[key] for key in known if key in value), None)
    return value if keys is None else keys.model_validate(unfold_ground(value))


_MEASURES = {
    "contact": "displacement",
    "friction": "force",
    "breakaway": "force",
    "gap": "displacement",
    "yield": "force",
    "preload": "force",
}
_MOST_NAMED = 5  # nodes
_WRITTEN = {"yields": "yield"}  # fields whose keys are words of Python


@dataclass
class _Pen:
    """Writes parts without units, one line after another, and keeps what loads and places need to know of them."""

    kind: Kind
    names: Mapping[str, str]
    rods: Rods

    def __post_init__(self) -> None:
        first, seconds = self.rods.first, self.rods.seconds
        self.displacement = Fraction(1) if self.kind == "torsional" else first.length
        self.force = first.stiffness * self.displacement
        self.lines: dict[str, Fraction] = {}
        self.moved: dict[object, str] = {}  # what a motion end is, by its name and its place
        self.nodes: list[str] = []  # their names
        self._next = 0
        self._units = {
            "mass": first.mass,
            "velocity": self.displacement / seconds,
            "spring": first.stiffness,
            "dashpot": first.stiffness * seconds,
            "contact": self.displacement,
            "friction": self.force,
            "breakaway": self.force,
            "gap": self.displacement,
            "yield": self.force,
            "preload": self.force,
        }
        self.acceleration = self.displacement / seconds**2

    def line(self, name: str, parts: list[_Read]) -> list[object]:
        """The parts of a line."""
        x = Fraction(0)
        written: list[object] = []
        faults = Faults()
        for keys, part in parts:
            with faults.gather(*keys):
                if isinstance(part, RodKeys):
                    length = self.rods.all[self._next].length
                    written.append(self._rod(part, length))
                    x += length
                elif isinstance(part, SceneTable):
                    table = self._convert(part)
                    self.nodes += [str(table["name"])] if "name" in table else []
                    if "motion" in table:
                        ends = table.get("name"), (name, x)
                        self.moved |= {at: str(table["motion"]) for at in ends if at is not None}
                    written.append(table)
                else:
                    written.append(part)
        faults.refuse()
        self.lines[name] = x
        return written

    def _rod(self, part: RodKeys, length: Fraction) -> dict[str, object]:
        table = self.rods.part(self._next, length / self.rods.first.length)
        self._next += 1
        table |= self._convert(part, "rod", "impedance", "speed", "strain", *part.material_keys())
        if part.strain is not None:
            table["strain"] = self._strain(part.strain)
        return table

    def _strain(self, value: object) -> Fraction:
        """Of a rod at first: a number, in torsion an angle per length."""
        with key_context("strain"):
            if self.kind != "torsional":
                return exact(value)
            return read_quantity(value, "rate of twist") * self.rods.first.length

    def _convert(self, part: SceneTable, *without: str) -> dict[str, object]:
        table: dict[str, object] = {}
        for field, value in part:
            key = _WRITTEN.get(field, field)
            if value is None or key in without:
                continue
            if key not in self._units:
                table[key] = value
                continue
            least = None if key in ("velocity", "preload") else 1 if key == "mass" else 0
            dimension, unit = self.names[_MEASURES.get(key, key)], self._units[key]
            with key_context(key):
                if key in ("gap", "yield") and isinstance(value, list):
                    table[key] = [read_quantity(each, dimension) / unit for each in value]
                else:
                    table[key] = read_quantity(value, dimension, least) / unit
        return table

    def load_unit(self, load: Mapping[str, Any]) -> LoadUnit:
        """What a load does depends on where it is."""
        if "at" not in load:
            return LoadUnit(self.names["force"], self.names["force rate"], self.force)
        with key_context("at"):
            found = place(load["at"], self.lines)
        if found.x is None and found.name not in self.nodes:
            names = "".join(f"{show(name)}, " for name in self.nodes[:_MOST_NAMED])
            raise refusal(f'{show(load["at"])} is not a node; write {names}or a place such as "1.2 m"', "at")
        at: object = found.name if isinstance(found, PlaceInMetres) and found.x is None else (found.line, found.x)
        unit = self.displacement / self.rods.seconds
        added = {"at": PlaceInUnits(found.dimensionless(self.rods.first.length), load["at"])}
        if len(added["at"]) > LONGEST:
            raise refusal(f"{show(load['at'])} has too many digits; write a place of fewer", "at")
        match self.moved.get(at):
            case "velocity":
                return LoadUnit(self.names["velocity"], self.names["acceleration"], unit, {}, added)
            case "acceleration":
                size = unit / self.rods.seconds
                return LoadUnit(self.names["acceleration"], self.names["jerk"], size, {}, added)
        return LoadUnit(self.names["force"], self.names["force rate"], self.force, {}, added)
