"""What to watch: positions, how long and how exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    BeforeValidator,
    FailFast,
    Field,
    PlainSerializer,
    PlainValidator,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
    model_validator,
)

from wavesym.fields.loads import Load
from wavesym.fields.numbers import Exact, Positive
from wavesym.fields.table import Faults, SceneTable, WrittenDecimal, as_list, refusal, show
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.scene.physical.scale import Scale
from wavesym.systems import SystemTable
from wavesym.systems.output_places import EVERY, OutputPlaces
from wavesym.systems.place import MisplacedError, Place, Position, position_of

# Beyond it even the integer part of an argument costs a double most of its digits.
LONGEST_HORIZON = 10**9
MOST_OUTPUTS = 5_000
"""Histories of as many, of 1001 values each, take about 40 s."""


@dataclass(frozen=True)
class Observable:
    """An output: a quantity at x (in rod lengths); of a drift x is the number of its rod.

    `side` is the side as it matters: -1 or +1 for the strain at a rigid body inside the chain, 0 elsewhere. `title` is
    its name for people, if it has one.
    """

    quantity: str
    x: Fraction
    side: int
    name: str
    place: Place = field(compare=False)
    title: str = ""


def _serialize_position(at: Position) -> str | dict[str, str]:
    return {"at": at.text, "name": at.title} if at.title else at.text


Positioned = Annotated[
    Position, PlainValidator(position_of), PlainSerializer(_serialize_position, return_type=str | dict[str, str])
]
Positions = Annotated[tuple[Positioned, ...], FailFast(), BeforeValidator(as_list)]


def _drifts(value: object) -> tuple[object, ...]:
    if isinstance(value, str) and value != EVERY:
        raise refusal(f'{show(value)} is not a list; write [1, 2, 3], or "{EVERY}"')
    return (EVERY,) if value == EVERY else as_list(value)


Drifts = Annotated[
    tuple[Positioned, ...], FailFast(), BeforeValidator(_drifts, json_schema_input_type=Literal["all"] | list[Any])
]


class Output(SceneTable):
    """The outputs, the horizon (in tau), and the largest error allowed relative to an output's largest value."""

    instead: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("moment", "torque"), "write force, which is a moment in shafts"),
        "rotation": "write displacement, which is an angle in shafts",
    }

    until: Positive = Field(description='the horizon, a positive number (in a scene with units such as "5 s")')
    tolerance: Exact = Fraction(1, 10**10)
    strain: Positions = ()
    velocity: Positions = ()
    displacement: Positions = ()
    acceleration: Positions = ()
    force: Positions = ()
    drift: Drifts = ()
    relative: Positions = ()
    stress: Positions = ()

    @model_validator(mode="before")
    @classmethod
    def _refuse_many(cls, table: object) -> object:
        """Before any of them is looked at."""
        lists = (table.get(quantity) for quantity in QUANTITIES) if isinstance(table, Mapping) else ()
        count = sum(len(positions) for positions in lists if isinstance(positions, list | tuple))
        if count > MOST_OUTPUTS:
            raise refusal(f"{count} positions, the limit is {MOST_OUTPUTS}; write fewer, or split the scene")
        return table

    @field_validator("until")
    @classmethod
    def _check_horizon(cls, until: Fraction) -> Fraction:
        if until > LONGEST_HORIZON:
            # the longest intervals of a system are 2 long
            cost = f"{show(until)} would cost at least {show(until // 2)} intervals of every function"
            raise refusal(f"{cost}; write a horizon of {LONGEST_HORIZON} or less")
        return until

    @field_validator("tolerance")
    @classmethod
    def _check_tolerance(cls, tolerance: Fraction) -> Fraction:
        if not 0 < tolerance < 1:
            raise refusal(f"{show(tolerance)} is not between 0 and 1; write a tolerance such as 1e-10")
        return tolerance

    @model_validator(mode="after")
    def _require_positions(self) -> Self:
        if not isinstance(self, NoOutput) and not any(getattr(self, quantity) for quantity in QUANTITIES):
            *others, last = QUANTITIES
            raise refusal(f"no positions; write at least one of {', '.join(others)} or {last}")
        return self

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without new quantities that are not asked for: so scenes keep the hash that they have had."""
        fields: dict[str, Any] = handler(self)
        return {key: value for key, value in fields.items() if value or key not in QUANTITIES or QUANTITIES[key].usual}

    def of_every_rod(self, count: int) -> Self:
        """The same with a drift for each of the rods of the main line, where it says "all"."""
        if [position.text for position in self.drift] != [EVERY]:
            return self
        return self.model_copy(update={"drift": tuple(position_of(k) for k in range(1, count + 1))})


class NoOutput(Output):
    """What stands for a missing [output] where outputs do not matter."""

    until: Positive = Fraction(1)


def observables(output: Output, system: SystemTable, loads: Sequence[Load]) -> tuple[Observable, ...]:
    """The outputs in order, checked against the chain; raises the error of `table.refusal`."""
    seen: dict[tuple[str, Place], str] = {}
    watching = OutputPlaces(system, loads)
    found, faults = [], Faults()
    for quantity in QUANTITIES:
        positions: tuple[Position, ...] = getattr(output, quantity)
        for k, position in enumerate(positions):
            text = show(WrittenDecimal(position.text))
            with faults.gather("output", quantity, k):
                try:
                    place = watching.place(position, quantity)
                except MisplacedError as error:
                    raise refusal(str(error)) from None
                if (quantity, place) in seen:
                    raise refusal(f"{text} is the same place as {seen[quantity, place]}; write another")
                seen[quantity, place] = text
                name = f"{quantity}@{position.text}"
                found.append(Observable(quantity, place.x, place.side, name, place, position.title))
    faults.refuse()
    return tuple(found)


def check_stresses(output: Output, found: Sequence[Observable], system: SystemTable, scale: Scale | None) -> None:
    """Refuse stresses of rods whose section nobody knows; raises the error of `table.refusal`."""
    stresses, faults = (each for each in found if each.quantity == "stress"), Faults()
    for k, (position, observable) in enumerate(zip(output.stress, stresses, strict=True)):
        place, text = observable.place, show(WrittenDecimal(position.text))
        with faults.gather("output", "stress", k):
            if scale is None:
                raise refusal(f"{text} has no section without [units]; write force")
            if scale.rods.all[place.rod - 1].section is None:
                raise refusal(f"{text} is on a rod of unknown section; write {_SECTIONS[scale.kind]}, or take force")
            here = [station for station in system.lines[place.line] if station.x == place.x and not position.side]
            beside = [rod for station in here for rod in (station.left, station.right) if rod is not None]
            if len({scale.rods.all[rod].section for rod in beside}) > 1:
                raise refusal(f'{text} has two sides; write "{position.text}-" or "{position.text}+"')
    faults.refuse()


_SECTIONS = {
    "longitudinal": "its A, E and rho",
    "shear": "its A, G and rho, of a storey shear = { k, G, A }",
    "torsional": "its diameter",
}
