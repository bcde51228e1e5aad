"""A drive in physical units: shafts that turn, between discs.

A shaft has the moment of inertia and the torsional stiffness of a rod: rho J l, and G J / l. Then l/c = l sqrt(rho/G),
and kappa = moment of inertia of a shaft / that of the disc on its left. Angles are counted in radians, moments in
G J / l of the first shaft.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated, Any

from pydantic import BeforeValidator, FailFast, Field

from wavesym.fields.table import SceneTable, listed, placed, shown, wrong
from wavesym.scene.physical.elastic import ElasticRod, Rods
from wavesym.scene.physical.measured import Bore, Density, Inertia, Length, Modulus, SecondMoment, one_of
from wavesym.scene.physical.rewritten import LoadUnit, Rewritten
from wavesym.scene.physical.rounding import polar_moment


class Round(SceneTable):
    """What twists: a polar moment of area, or the diameter (and bore) of a round shaft."""

    length: Length = Field(description='a length such as "1.2 m"')
    J: SecondMoment | None = None
    diameter: Length | None = None
    bore: Bore | None = None
    G: Modulus = Field(description='a modulus such as "80 GPa"')
    rho: Density = Field(description='a density such as "7850 kg/m^3"')

    def rod(self) -> ElasticRod:
        """As a rod. Raises the error of `table.wrong`."""
        if one_of(self, "J", "diameter") == "J" and self.bore is not None:
            raise wrong("stands beside J; write one of them", "bore")
        moment = self.J if self.diameter is None else self._polar(self.diameter)
        assert moment is not None  # one of the two is given
        return ElasticRod(
            self.length,
            self.rho * moment * self.length,
            self.G * moment / self.length,
            self.diameter and self.diameter**2,
        )

    def _polar(self, diameter: Fraction) -> Fraction:
        bore = self.bore or Fraction(0)
        if bore >= diameter:
            raise wrong("as wide as the shaft or wider; write a bore below the diameter", "bore")
        return polar_moment(diameter, bore)


class Disc(SceneTable):
    """A rigid disc."""

    inertia: Inertia = Field(description='a moment of inertia such as "12 kg*m^2"')


class PhysicalDrive(SceneTable):
    """Shafts from left to right, and one more disc than shafts."""

    type: str
    shaft: Annotated[tuple[Round, ...], FailFast(), BeforeValidator(listed)] = Field(description="a list of shafts")
    disc: Annotated[tuple[Disc, ...], FailFast(), BeforeValidator(listed)] = Field(description="a list of discs")
    damping: Any = None

    def rewritten(self) -> Rewritten:
        """As a drive without units, where a wave takes longer through one shaft than another part by part."""
        rods = self._rods()
        first, discs = rods.first, [disc.inertia for disc in self.disc]
        kappa = tuple(rod.mass / disc for rod, disc in zip(rods.all, discs, strict=False))
        if rods.in_step:
            table: dict[str, object] = {"type": "drive", "m": len(kappa), "kappa": kappa, "inertia": discs}
            force = first.stiffness / kappa[0]  # its chain has masses in units of the first disc
        else:
            parts: list[object] = [{"mass": discs[0] / first.mass}]
            for number, disc in enumerate(discs[1:]):
                parts += [rods.part(number, Fraction(1)), {"mass": disc / first.mass}]
            table, force = {"type": "drive", "parts": parts}, first.stiffness
        if self.damping is not None:
            table["damping"] = self.damping

        def acting(load: Mapping[str, Any]) -> LoadUnit:
            if rods.in_step:
                return LoadUnit("moment", "moment rate", first.stiffness)
            return self._on_node(load, first.stiffness)

        return Rewritten(
            kind="torsional",
            rods=rods,
            system=table,
            displacement=Fraction(1),
            force=force,
            lengths=tuple(rod.length for rod in rods.all),
            acting=acting,
            kappa=kappa,
        )

    def _on_node(self, load: Mapping[str, Any], unit: Fraction) -> LoadUnit:
        """A moment on a body as one on a node; on the last body it counts against positive rotation."""
        bodies = len(self.disc)
        body = load.get("body")
        if not isinstance(body, int) or not 1 <= body <= bodies:
            raise wrong(f"{shown(body)} is not the number of a body; write 1 to {bodies}", "body")
        signed = -unit if body == bodies else unit
        return LoadUnit("moment", "moment rate", signed, {"body": "at"}, {"at": body - 1})

    def _rods(self) -> Rods:
        """The shafts. Raises the error of `table.wrong`."""
        if not self.shaft:
            raise wrong("no shaft; write at least one [[system.shaft]]", "shaft")
        if len(self.disc) != len(self.shaft) + 1:
            raise wrong(f"{len(self.disc)} discs; write {len(self.shaft) + 1} (one more than shafts)", "disc")
        rods = []
        for k, shaft in enumerate(self.shaft):
            with placed("shaft", k):
                rods.append(shaft.rod())
        return Rods.of(rods)
