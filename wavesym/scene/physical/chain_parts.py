"""The parts of a chain in physical units, as tables of a scene: which keys they have; quantities are read later.

What a key measures depends on how waves move the rods, which `[units]` says for the whole chain.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any, ClassVar

from pydantic import Field, create_model

from wavesym.fields.numbers import exact
from wavesym.fields.quantity_fields import missing, one_of, read_quantity
from wavesym.fields.table import SceneTable, key_context, refusal, show
from wavesym.systems.dimensionless import Kind
from wavesym.systems.elastic import ElasticRod, round_section
from wavesym.systems.parts import ChainPart, ContactPart, JointPart, LinkPart, MassPart, MotionPart, PartName


class RodKeys(SceneTable):
    """Keys of a rod of any kind. Its wave speed may stand for its modulus, with its impedance for all it is made of."""

    key: ClassVar[str] = "rod"
    dimensions: ClassVar[Mapping[str, str]]
    """Of its modulus, its section and its density, by their keys."""

    rod: Any = Field(description='a length such as "1.2 m"')
    impedance: Any = None
    speed: Any = None
    velocity: Any = None
    strain: Any = None
    spring: Any = None
    friction: Any = None
    breakaway: Any = None
    dashpot: Any = None
    only: Any = Field(None, description='"push" or "pull"')
    gap: Any = Field(None, description="how far it gets shorter or longer before it acts, or two such numbers")
    yields: Any = Field(None, alias="yield", description="the largest pull and push, or two such numbers")
    preload: Any = Field(None, description="what the spring pulls at first")
    loss: Any = None
    name: PartName | None = None

    def elastic(self, dashpot: str) -> ElasticRod:
        """As waves see it; `dashpot` is the dimension of impedances. Raises the error of `table.refusal`."""
        with key_context("rod"):
            length = read_quantity(self.rod, "length", 1)
        written = [key for key in self.material_keys() if getattr(self, key) is not None]
        if self.impedance is None and (written or self.speed is None):
            values = self._si_values()
            return self._rod(length, *(values[key] for key in self.dimensions))
        if written:
            raise self._repetition(written[0], "impedance")
        impedance, speed = self._si_value("impedance", dashpot), self._si_value("speed", "velocity")
        return ElasticRod(length, impedance / speed * length, impedance * speed / length)

    def _si_value(self, key: str, dimension: str, least: int = 1) -> Fraction:
        value = getattr(self, key)
        if value is None:
            raise missing(dimension, key)
        with key_context(key):
            return read_quantity(value, dimension, least)

    def _si_values(self) -> dict[str, Fraction]:
        """Modulus, section and density by their keys; with a wave speed c the modulus is rho c^2."""
        modulus, section, density = self.dimensions
        if self.speed is None:
            return {key: self._si_value(key, dimension) for key, dimension in self.dimensions.items()}
        if getattr(self, modulus) is not None:
            raise self._repetition(modulus, "speed")
        values = {key: self._si_value(key, self.dimensions[key]) for key in (section, density)}
        return values | {modulus: values[density] * self._si_value("speed", "velocity") ** 2}

    def _repetition(self, key: str, other: str) -> Exception:
        """The error for a key that says again what another one says."""
        modulus, section, density = self.dimensions
        ways = f"impedance and speed, or speed, {density} and {section}, or {modulus}, {section} and {density}"
        return refusal(f"stands beside {other}; a rod has {ways}: leave the other out", key)

    @classmethod
    def material_keys(cls) -> tuple[str, ...]:
        """The keys that say what it is made of."""
        return tuple(key for key in cls.model_fields if key not in RodKeys.model_fields)

    def _rod(self, length: Fraction, modulus: Fraction, section: Fraction, density: Fraction) -> ElasticRod:
        return ElasticRod.from_area(length, modulus, section, density)


class LongitudinalRod(RodKeys):
    """It is stretched: E A and rho A."""

    dimensions: ClassVar[Mapping[str, str]] = {"E": "modulus", "A": "area", "rho": "density"}

    A: Any = None
    E: Any = None
    rho: Any = None


class ShearRod(RodKeys):
    """It is sheared: k G A and rho A."""

    dimensions: ClassVar[Mapping[str, str]] = {"G": "modulus", "A": "area", "rho": "density"}

    A: Any = None
    G: Any = None
    rho: Any = None
    k: Any = None

    def _rod(self, length: Fraction, modulus: Fraction, section: Fraction, density: Fraction) -> ElasticRod:
        return ElasticRod.from_area(length, modulus, section, density, sheared=True)

    def _si_values(self) -> dict[str, Fraction]:
        values = super()._si_values()
        if self.k is None:
            return values
        if self.speed is not None:
            raise refusal("stands beside speed, which is that of its waves, k and all; leave k out", "k")
        with key_context("k"):
            factor = exact(self.k)
            if factor <= 0:
                raise refusal(f"{show(self.k)} is not positive; write a number above 0")
        return {**values, "G": factor * values["G"]}


class TorsionalRod(RodKeys):
    """It is twisted: G J and rho J, J as it is or that of a round rod with a bore."""

    dimensions: ClassVar[Mapping[str, str]] = {"G": "modulus", "J": "second moment of area", "rho": "density"}

    J: Any = None
    diameter: Any = None
    bore: Any = None
    G: Any = None
    rho: Any = None

    def _si_value(self, key: str, dimension: str, least: int = 1) -> Fraction:
        if key != "J":
            return super()._si_value(key, dimension, least)
        if one_of(self, "J", "diameter") == "diameter":
            bore = None if self.bore is None else self._si_value("bore", "length", 0)
            return round_section(self._si_value("diameter", "length"), bore)
        if self.bore is not None:
            raise refusal("stands beside J; write one of them", "bore")
        return super()._si_value(key, dimension)

    def _rod(self, length: Fraction, modulus: Fraction, section: Fraction, density: Fraction) -> ElasticRod:
        diameter = None if self.diameter is None else self._si_value("diameter", "length")
        return ElasticRod.from_polar_moment(length, modulus, section, density, diameter)


def _keys(part: type[ChainPart]) -> type[SceneTable]:
    """The keys that a part has without units, too: what stands there is read later."""
    fields: dict[str, Any] = {
        name: (Any, Field(... if known.is_required() else None, alias=known.alias, description=known.description))
        for name, known in part.model_fields.items()
    }
    fields |= {"name": (PartName | None, None)} if "name" in fields else {}
    name = f"{part.__name__.removesuffix('Part')}Keys"
    return create_model(name, __base__=SceneTable, __doc__=part.__doc__, **fields)


RODS: Mapping[Kind, type[RodKeys]] = {
    "longitudinal": LongitudinalRod,
    "torsional": TorsionalRod,
    "shear": ShearRod,
}
OTHERS: Mapping[str, type[SceneTable]] = {
    part.key: _keys(part) for part in (MassPart, JointPart, MotionPart, ContactPart, LinkPart)
}
"""The other parts, by the keys that they are known by; a spring is the last, as others have one beside them."""
