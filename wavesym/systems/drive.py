"""System II: m shafts between m + 1 rigid discs under moments that step (4.4), or ramp.

In units a shaft has the moment of inertia and the torsional stiffness of a rod: rho J l, and G J / l. Then
l/c = l sqrt(rho/G), and kappa = moment of inertia of a shaft / that of the disc on its left. Angles are counted in
radians, moments in G J / l of the first shaft.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, FailFast, Field, SerializerFunctionWrapHandler, model_serializer

from wavesym.fields.damping import ModalDamping, without_damping
from wavesym.fields.loads import Load, LoadKinds, SampledLoad, TimedLoad
from wavesym.fields.numbers import Integer, Numbers, Positives
from wavesym.fields.quantity_fields import Bore, Density, Inertia, Length, Modulus, SecondMoment, Speed, one_of
from wavesym.fields.shapes import ShapedLoad
from wavesym.fields.table import SceneTable, as_list, key_context, refusal, show, without_usual
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Family, Node, Parameters, Quantity, Rod, System, UnitLoad, single
from wavesym.records.load import RecordedLoad
from wavesym.systems.dimensionless import DimensionlessSystem, LoadUnit
from wavesym.systems.elastic import ElasticRod, Rods, round_section
from wavesym.systems.parts import Table
from wavesym.systems.preset import Preset
from wavesym.systems.speed_adjustment import SpeedAdjustment, adjustment_choice, without_adjustment


def _families(ramps: bool, m: Quantity, p: Parameters) -> tuple[Family, ...]:
    def shaft(i: Quantity) -> Rod:
        return Rod(tau0=0, x0=i - 1)

    def moment(number: Quantity, sign: int = 1) -> tuple[UnitLoad, ...]:
        # the A_i of (4.4), in units of G J_01 theta_0 / l
        size = sign * p.kappa[1] * p.inertia[1] / p.inertia[number]
        return (UnitLoad("M", number, (size,)), *([UnitLoad("R", number, (0, size))] if ramps else []))

    def pull(i: Quantity) -> Quantity:
        """What shaft i does to disc i + 1."""
        return 2 * p.kappa[i] * p.inertia[i] / p.inertia[i + 1]

    return (
        single(0, lambda: Node(None, shaft(1), inertia=1, alpha=0, beta=2 * p.kappa[1], loads=moment(1))),
        Family(
            1,
            m - 1,
            1,
            lambda i: Node(
                shaft(i), shaft(i + 1), inertia=1, alpha=pull(i), beta=2 * p.kappa[i + 1], loads=moment(i + 1)
            ),
        ),
        # the last moment counts against positive rotation, as in the paper
        single(m, lambda: Node(shaft(m), None, inertia=1, alpha=pull(m), beta=0, loads=moment(m + 1, sign=-1))),
    )


def _indices(m: int) -> Mapping[str, range]:
    return {"kappa": range(1, m + 1), "inertia": range(1, m + 2)}


DRIVE = System("drive", partial(_families, False), _indices, smallest=1)
DRIVE_RAMPS = System("drive-ramps", partial(_families, True), _indices, smallest=1)
"""With ramps of the moments, which the paper does not have, beside their steps."""


class OnBody(Load):
    """(3.1): the moment on a body of a drive."""

    body: Integer = Field(description="the number of a body, 1 to m + 1")

    def fault(self, m: int) -> tuple[str, str] | None:
        """A body that there is not."""
        if 1 <= self.body <= m + 1:
            return None
        return f"{show(self.body)} is not the number of a body; write 1 to {m + 1}", "body"

    @property
    def sources(self) -> tuple[str, str]:
        """A step and a ramp of it."""
        return f"M{self.body}", f"R{self.body}"

    @property
    def action(self) -> str:
        """What it acts as, for people."""
        return f"torque on disc {self.body}"


class Moment(OnBody, TimedLoad):
    """sum_k (steps_k + ramps_k (tau - times_k)) H(tau - times_k)."""

    steps: Numbers = ()
    ramps: Numbers = ()

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return without_usual(handler(self), name="", ramps=[])


class SampledMoment(OnBody, SampledLoad):
    """A moment that is linear between its samples."""


class RecordedMoment(OnBody, RecordedLoad):
    """A moment that is a record."""


class ShapedMoment(OnBody, ShapedLoad):
    """A moment of one shape."""


def drive_parts(shafts: Sequence[Table], discs: Sequence[Fraction]) -> list[object]:
    """From left to right a disc, as a mass, then of each shaft a rod and the disc behind it."""
    first, *others = ({"mass": disc} for disc in discs)
    return [first, *(part for pair in zip(shafts, others, strict=True) for part in pair)]


class Drive(Preset):
    """m shafts between m + 1 rigid discs at x = 0, 1, ... m."""

    variants: ClassVar[tuple[System, ...]] = (DRIVE,)
    companions: ClassVar[tuple[System, ...]] = (DRIVE_RAMPS,)
    counts: ClassVar[Mapping[str, str]] = {"kappa": "m", "inertia": "m + 1"}
    load_kinds: ClassVar[LoadKinds] = (Moment, SampledMoment, RecordedMoment, ShapedMoment)

    type: Literal["drive"] = Field(description='"drive"')
    kappa: Positives = Field(description="a list of m positive numbers")
    inertia: Positives = Field(description="a list of m + 1 positive numbers")
    damping: ModalDamping = None
    speed_adjustment: SpeedAdjustment = Fraction(0)

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return without_adjustment(without_damping(handler(self)))

    @property
    def choices(self) -> Mapping[str, str]:
        """How its modes are damped, and how much speeds may change."""
        damping = {"damping": self.damping.description} if self.damping else {}
        return {**damping, **adjustment_choice(self.speed_adjustment)}

    def named_chain(self, loads: Sequence[Load]) -> Chain:
        """The chain as the paper has it, with ramps where a load needs them."""
        ramped = any(not isinstance(load, Moment) or load.ramps for load in loads)
        return replace(self.chain, system=DRIVE_RAMPS) if ramped else self.chain

    @property
    def tables(self) -> list[object]:
        """Its parts, in units of the first disc."""
        discs = [inertia / self.inertia[0] for inertia in self.inertia]
        shafts = [{"rod": 1, "impedance": k * disc} for k, disc in zip(self.kappa, discs, strict=False)]
        return drive_parts(shafts, discs)


class Round(SceneTable):
    """What twists: a polar moment of area, or the diameter (and bore) of a round shaft; its modulus, or wave speed."""

    length: Length = Field(description='a length such as "1.2 m"')
    J: SecondMoment | None = None
    diameter: Length | None = None
    bore: Bore | None = None
    G: Modulus | None = None
    speed: Speed | None = None
    rho: Density = Field(description='a density such as "7850 kg/m^3"')

    def rod(self) -> ElasticRod:
        """As a rod. Raises the error of `table.refusal`."""
        if one_of(self, "J", "diameter") == "J" and self.bore is not None:
            raise refusal("stands beside J; write one of them", "bore")
        moment = self.J if self.diameter is None else round_section(self.diameter, self.bore)
        assert moment is not None  # one of the two is given
        return ElasticRod.from_polar_moment(self.length, self._modulus(), moment, self.rho, self.diameter)

    def _modulus(self) -> Fraction:
        """G, with a wave speed c rho c^2. Raises the error of `table.refusal`."""
        if self.G is None and self.speed is None:
            raise refusal('missing; write a modulus such as "80 GPa", or speed in its place', "G")
        if self.G is not None and self.speed is not None:
            raise refusal("stands beside G; write one of them", "speed")
        return self.G or self.rho * (self.speed or 1) ** 2


class Disc(SceneTable):
    """A rigid disc."""

    inertia: Inertia = Field(description='a moment of inertia such as "12 kg*m^2"')


class PhysicalDrive(SceneTable):
    """Shafts from left to right, and one more disc than shafts."""

    type: str
    shaft: Annotated[tuple[Round, ...], FailFast(), BeforeValidator(as_list)] = Field(description="a list of shafts")
    disc: Annotated[tuple[Disc, ...], FailFast(), BeforeValidator(as_list)] = Field(description="a list of discs")
    damping: Any = None
    speed_adjustment: Any = None

    def without_units(self) -> DimensionlessSystem:
        """As a drive without units, where a wave takes longer through one shaft than another part by part."""
        rods = self._rods()
        first, discs = rods.first, [disc.inertia for disc in self.disc]
        kappa = tuple(rod.mass / disc for rod, disc in zip(rods.all, discs, strict=False))
        if rods.in_step:
            table: dict[str, object] = {"type": "drive", "m": len(kappa), "kappa": kappa, "inertia": discs}
            force = first.stiffness / kappa[0]  # its chain has masses in units of the first disc
        else:
            parts = drive_parts(rods.parts, [disc / first.mass for disc in discs])
            table, force = {"type": "drive", "parts": parts}, first.stiffness
        if self.damping is not None:
            table["damping"] = self.damping
        if self.speed_adjustment is not None:
            table["speed_adjustment"] = self.speed_adjustment

        def acting(load: Mapping[str, Any]) -> LoadUnit:
            if rods.in_step:
                return LoadUnit("moment", "moment rate", first.stiffness)
            return self._on_node(load, first.stiffness)

        return DimensionlessSystem(
            kind="torsional",
            rods=rods,
            system=table,
            displacement=Fraction(1),
            force=force,
            lengths=tuple(rod.length for rod in rods.all),
            load_unit=acting,
            kappa=kappa,
        )

    def _on_node(self, load: Mapping[str, Any], unit: Fraction) -> LoadUnit:
        """A moment on a body as one on a node; on the last body it counts against positive rotation."""
        bodies = len(self.disc)
        body = load.get("body")
        if not isinstance(body, int) or not 1 <= body <= bodies:
            raise refusal(f"{show(body)} is not the number of a body; write 1 to {bodies}", "body")
        signed = -unit if body == bodies else unit
        return LoadUnit("moment", "moment rate", signed, {"body": "at"}, {"at": body - 1})

    def _rods(self) -> Rods:
        """The shafts. Raises the error of `table.refusal`."""
        if not self.shaft:
            raise refusal("no shaft; write at least one [[system.shaft]]", "shaft")
        if len(self.disc) != len(self.shaft) + 1:
            raise refusal(f"{len(self.disc)} discs; write {len(self.shaft) + 1} (one more than shafts)", "disc")
        rods = []
        for k, shaft in enumerate(self.shaft):
            with key_context("shaft", k):
                rods.append(shaft.rod())
        return Rods.from_rods(rods)
