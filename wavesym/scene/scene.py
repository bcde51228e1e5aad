"""A scene: what the user said, validated, every number exact."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from fractions import Fraction
from functools import cached_property
from os import PathLike
from typing import Any, Self

from pydantic import (
    Field,
    PrivateAttr,
    SerializeAsAny,
    SerializerFunctionWrapHandler,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from wavesym.errors import SceneError
from wavesym.fields.loads import Load
from wavesym.fields.shapes import ShapedLoad, usual_tolerance
from wavesym.fields.table import Fault, Faults, SceneTable, key_context, refusal, scene_error, show
from wavesym.numbers.doubles import common_measure, fraction, rational
from wavesym.scene.describe import describe
from wavesym.scene.key_lines import key_lines, line_of
from wavesym.scene.loads import loads
from wavesym.scene.names import Name
from wavesym.scene.outputs import NoOutput, Observable, Output, check_stresses, observables
from wavesym.scene.paths import replace_at_path
from wavesym.scene.physical.scale import Scale, UnitsTable
from wavesym.scene.physical.scene import PhysicalScene, forgotten_units, physical
from wavesym.scene.report import ReportTable
from wavesym.scene.scene_file import read_toml
from wavesym.systems import SYSTEMS, ExplicitChain, Preset, SystemTable


def _may_follow(fault: Fault, faults: Faults) -> bool:
    """Whether a fault may be one only since a table was left out in which others were found."""
    left_out = {keys[:2] for _, keys in faults.found}
    return fault.keys[:2] in left_out or fault.keys[:1] == ("load",) or fault.keys == ("output",)


class Scene(SceneTable):
    """A chain, its loads, and what to watch of it: `Scene(name=..., system={...}, load=[...], output={...})`.

    The fields are those of a scene file. Without `units` all is dimensionless: x in rod lengths, tau = c t / l; with
    them (`units={}`) quantities are text such as "3.5 m", and `system`, `load`, `output` are the scene without.
    Numbers may be int, Fraction, Decimal, float (the shortest decimal that reads back to it) or text such as "1/3". The
    path of a record counts from the current folder. Without `output` there are frequencies (`wavesym.modes`), and no
    more. Raises SceneError, which says all that is wrong.

    >>> import wavesym
    >>> scene = wavesym.Scene(
    ...     name="disc",
    ...     system={"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 2]},
    ...     load=[{"body": 1, "times": [0], "steps": ["1/3"]}],
    ...     output={"until": 4, "strain": ["1/2"]},
    ... )
    >>> scene.system.inertia
    (Fraction(1, 1), Fraction(2, 1))
    """

    name: Name = Field(description="an identifier of C")
    units: UnitsTable | None = None
    system: SerializeAsAny[Preset | ExplicitChain] = Field(description="a table")
    load: tuple[SerializeAsAny[Load], ...] = ()
    output: Output = Field(description="a table")
    title_block: ReportTable | None = Field(default=None, alias="report")

    _physical: PhysicalScene | None = PrivateAttr(default=None)
    _straight: bool = PrivateAttr(default=False)  # loads of a shape act as straight lines

    def __init__(self, /, **fields: Any) -> None:
        faults, fields = Faults(), {"output": NoOutput(), **fields}
        if "units" not in fields and (quantity := forgotten_units(fields)):
            what = f"missing, and {show(quantity)} has a unit; write the line [units] before [system]"
            faults.found.append(Fault(what, ("units",)))
            fields = {**fields, "units": {}}
        try:
            found = physical(fields, faults) if "units" in fields else None
            if found is not None and faults.found:  # what does not hang together with these is told, too
                others = Faults()
                with others.gather():
                    super().__init__(**found.fields)
                faults.found += [fault for fault in others.found if not _may_follow(fault, faults)]
                faults.refuse()
            super().__init__(**(fields if found is None else found.fields))
            check_stresses(self.output, self.outputs, self.system, found.scale if found else None)
        except (PydanticCustomError, ValidationError) as error:
            raise scene_error(error) from None
        self._physical = found

    @classmethod
    def from_toml(cls, source: str | PathLike[str]) -> Self:
        """The scene in a file, on standard input (`-`), built in (by name), or in a text of some lines.

        A built-in scene goes before a file of the same name; `./NAME` is the file. Raises SceneError.

        >>> import wavesym
        >>> wavesym.Scene.from_toml("drive_m1").name
        'drive_m1'
        """
        return cls._read(*read_toml(source))

    @classmethod
    def _read(cls, file: str, text: str, fields: dict[str, Any]) -> Self:
        if "scene" in fields and "system" not in fields:
            raise SceneError("this is a sweep, not a scene; `wavesym sweep` takes it", file=file)
        try:
            scene = cls(**fields)
        except SceneError as error:
            lines = key_lines(text)
            raise error.in_file(file, lambda path: line_of(path, lines)) from None
        vars(scene)["text"] = text  # in place of what the property would say; scenes that differ in it are equal
        return scene

    @cached_property
    def text(self) -> str:
        """What it was read from; of one that was made in Python its fields as JSON."""
        return self.model_dump_json(indent=2)

    def with_(self, changes: Mapping[str, object]) -> Self:
        """The same scene with other values: `scene.with_({"system.kappa[1]": "1/3", "output.until": 40})`.

        Paths are those of messages, indices count from 0. Raises SceneError, as for a scene that is written so.

        >>> import wavesym
        >>> scene = wavesym.Scene.from_toml("drive_m1")
        >>> scene.with_({"system.kappa[0]": "1/2", "output.until": 5}).system.kappa
        (Fraction(1, 2),)
        """
        fields = self.model_dump()
        for path, value in changes.items():
            fields = replace_at_path(fields, path, value)
        return type(self)(**fields)

    def refuse_without_output(self, file: str = "scene") -> None:
        """SceneError for a scene that says nothing of outputs, which frequencies alone do without."""
        if isinstance(self.output, NoOutput):
            raise SceneError("missing; write a table", "output", file)

    def __repr__(self) -> str:
        until = self.output.until
        horizon = self.scale.clock.format(rational(until)) if self.scale else f"tau = {until}"
        horizon = "" if isinstance(self.output, NoOutput) else horizon
        return f"Scene({describe(self.name, self.system, self.load, horizon)})"

    __str__ = __repr__

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """What was said. Without units there are none to tell of: so scenes keep the hash that they have had."""
        without = {"output"} if isinstance(self.output, NoOutput) else set[str]()
        if self._physical is not None:
            fields = deepcopy(dict(self._physical.fields_in_units))
        else:
            fields = handler(self)
            without |= {"units"} if self.title_block else {"units", "report"}
        if self._is_shaped and "tolerance" not in self.output.model_fields_set:
            fields["output"] = {key: value for key, value in fields["output"].items() if key != "tolerance"}
        return {key: value for key, value in fields.items() if key not in without}

    @property
    def scale(self) -> Scale | None:
        """What its numbers are in units, where it has any."""
        return self._physical.scale if self._physical else None

    @property
    def physical(self) -> PhysicalScene | None:
        """What it said in units, where it has any."""
        return self._physical

    def dimensionless(self) -> Scene:
        """The same scene without units, as all that is computed takes it."""
        return Scene.model_construct(name=self.name, system=self.system, load=self.load, output=self.output)

    @field_validator("system", mode="wrap")
    @classmethod
    def _read_system(cls, table: object, _: object) -> SystemTable:
        if isinstance(table, SystemTable):
            return table
        *others, last = (f'"{name}"' for name in SYSTEMS)
        choice = f"{', '.join(others)} or {last}"
        if not isinstance(table, Mapping):
            raise refusal(f"{show(table)} is not a table; write [system]")
        if "type" not in table:
            raise refusal(f"missing; write {choice}", "type")
        if not isinstance(name := table["type"], str) or name not in SYSTEMS:
            raise refusal(f"{show(table['type'])} is not a system; write {choice}", "type")
        with key_context():
            return SYSTEMS[name].model_validate(table)

    @field_validator("load", mode="wrap")
    @classmethod
    def _read_loads(cls, tables: object, _: object, info: ValidationInfo) -> tuple[Load, ...]:
        # without a system there is nothing to check against; that it is wrong is said first
        return loads(tables, info.data["system"]) if "system" in info.data else ()

    @model_validator(mode="after")
    def _check_outputs(self) -> Self:
        rods = sum(station.right is not None for station in self.system.lines[""])
        vars(self)["output"] = self.output.of_every_rod(rods)
        _ = self.outputs
        if self._is_shaped:
            damping = getattr(self.system, "damping", None)  # of modes, which take lines alone
            self._shape_loads(straight=damping is not None and damping.acts)
        return self

    @property
    def _is_shaped(self) -> bool:
        return any(isinstance(load, ShapedLoad) for load in self.load)

    def _shape_loads(self, *, straight: bool) -> None:
        """Fit loads of a shape to horizon, tolerance and travel times."""
        self._straight = straight
        of_scene = (self.output.until, self.tolerance, self._measure)
        each = (
            load.truncate(*of_scene, straight=straight) if isinstance(load, ShapedLoad) else load for load in self.load
        )
        vars(self)["load"] = tuple(each)

    @property
    def in_lines(self) -> Scene:
        """The same scene, its loads of a shape as straight lines between samples; itself, if it has none."""
        return self.straighten(Fraction(0))

    def straighten(self, coarsest: Fraction) -> Scene:
        """The same, where a tolerance is enough that need be no smaller."""
        if self._straight or not self._is_shaped:
            return self
        other = self.model_copy()
        vars(other).pop("tolerance", None)
        other._straight = True
        vars(other)["tolerance"] = max(coarsest, other.tolerance)
        other._shape_loads(straight=True)
        return other

    @cached_property
    def tolerance(self) -> Fraction:
        """As it is written; else the usual one, or, where shapes act as lines, what these meet with a few samples."""
        if "tolerance" in self.output.model_fields_set or not self._straight:
            return self.output.tolerance
        return usual_tolerance(self.load, self.output.until, self.output.tolerance, self._measure)

    @cached_property
    def _measure(self) -> Fraction:
        """The common measure of the travel times of all rods in tau; 0 without any."""
        system = self.system
        bars = system.drawing.bars if isinstance(system, ExplicitChain) else system.network(()).bars
        return fraction(common_measure(bar.delay for bar in bars))

    @cached_property
    def outputs(self) -> tuple[Observable, ...]:
        """The outputs: strains, velocities, displacements, each in the order of the scene."""
        return observables(self.output, self.system, self.load)
