"""A scene with [units], rewritten as one without; what was said is kept, so that it can be changed and printed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from pydantic_core import PydanticCustomError

from wavesym.fields.numbers import exact
from wavesym.fields.quantity_fields import plain, read_quantity, tidy
from wavesym.fields.table import Fault, Faults, key_context, key_path, refusal, show
from wavesym.mechanics.length import LengthUnit
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.scene.outputs import LONGEST_HORIZON, Output
from wavesym.scene.physical.chain import PhysicalChain
from wavesym.scene.physical.description import describe
from wavesym.scene.physical.loads import Acts, dimensionless, read
from wavesym.scene.physical.places import place
from wavesym.scene.physical.scale import Results, Scale, UnitsTable
from wavesym.systems import PHYSICAL, SYSTEMS, ExplicitChain, ExplicitPreset, SystemTable
from wavesym.systems.dimensionless import DimensionlessSystem
from wavesym.systems.place import read_titled_place

_QUANTITY = re.compile(r"\s*[+-]?[\d./eE+-]+\s+(?!percent)[A-Za-z]")
_LENGTHS = {each.name for each in QUANTITIES.values() if each.place_quantity}
"""Outputs whose places are lengths on a chain; a drift counts rods."""


@dataclass(frozen=True)
class PhysicalScene:
    """What a scene with units `said`, the `fields` of the one without, and what their numbers are.

    `inputs` is of each load what 1 is in the unit of results, and that unit.
    """

    fields_in_units: dict[str, Any]
    fields: dict[str, Any]
    scale: Scale
    kappa: tuple[Fraction, ...]
    inputs: tuple[tuple[Fraction, str], ...] = ()

    @property
    def length(self) -> LengthUnit | None:
        """The unit of results that places are lengths in; None where they count rods."""
        return (
            self.scale.results.length(self.scale.lengths[0])
            if self.fields_in_units["system"]["type"] == "chain"
            else None
        )

    @property
    def system(self) -> dict[str, str]:
        """What it is made of, by key."""
        return {key: describe(value) for key, value in self.fields_in_units["system"].items() if key != "type"}

    @property
    def loads(self) -> tuple[str, ...]:
        """A line for each load."""
        loads = self.fields_in_units.get("load", ())
        return tuple(describe({key: value for key, value in load.items() if key != "name"}) for load in loads)


def physical(fields: Mapping[str, Any], faults: Faults) -> PhysicalScene:
    """The fields of a scene with [units], rewritten; those of loads and outputs in which anything is wrong left out.

    What is wrong is kept in `faults`. Raises them, as an error of a validator, where it is the system.
    """
    units = _units(fields["units"], faults)
    found = _system_or_none(fields, units, faults)
    if found is None:
        faults.refuse()
        raise AssertionError("a system that is wrong has faults")
    results = Results.from_table(units, found.kind, faults)
    made = dict(fields)
    with faults.gather("system"), _of_quantities(fields["system"]):  # before loads and places on it
        length = results.length(found.lengths[0]) if found.lines is not None else None
        made["system"] = _table(found.system).model_validate(found.system, context=length)
    if not isinstance(made["system"], SystemTable):
        faults.refuse()
    seconds = found.rods.seconds
    table = dict(fields)
    inputs = []
    sound = len(faults.found)
    if isinstance(loads := fields.get("load"), list | tuple):
        table["load"], made["load"] = [], []
        for k, load in enumerate(loads):
            with faults.gather("load", k):
                table["load"].append(read(load, found.load_unit))
                made["load"].append(_load(table["load"][-1], found, seconds))
        if len(faults.found) > sound:
            made["load"] = ()
    if isinstance(output := fields.get("output"), Mapping):
        made["output"] = _output(output, found, seconds, faults)
    if made.get("load", ()) != ():
        for acting in (found.load_unit(load) for load in table["load"] if isinstance(load, Mapping)):
            size, text = results.unit_of(acting.dimension)
            inputs.append((acting.size / size, text))
    scale = Scale(found.kind, seconds, found.displacement, found.force, found.lengths, results, found.rods)
    return PhysicalScene(plain(table), made, scale, found.kappa, tuple(inputs))


def _units(table: object, faults: Faults) -> UnitsTable:
    """The table of units; what is wrong with it is kept, and left out."""
    with faults.gather("units"):
        return UnitsTable.model_validate(table)
    known = table if isinstance(table, Mapping) else {}
    return UnitsTable.model_validate({key: known[key] for key in UnitsTable.model_fields if key in known})


def _system_or_none(fields: Mapping[str, Any], units: UnitsTable, faults: Faults) -> DimensionlessSystem | None:
    """The system; None where it is wrong, and then unknown keys of outputs are told of, too."""
    with faults.gather():
        return _system(fields.get("system"), units)
    others = Faults()
    with others.gather("output"):
        Output.model_validate(fields.get("output", {}))
    faults.found += [fault for fault in others.found if fault.what.startswith("unknown key")]
    return None


def acts(fields: Mapping[str, Any]) -> Acts:
    """What loads of a scene with [units], whose fields are sound, act as."""
    return _system(fields["system"], UnitsTable.model_validate(fields["units"])).load_unit


@contextmanager
def _of_quantities(quantities: Mapping[str, Any]) -> Iterator[None]:
    """What is wrong with a number that nobody wrote, such as a kappa, is said of the quantities that make it."""
    faults = Faults()
    with faults.gather():
        yield
    for number, (what, keys) in enumerate(faults.found):
        if keys and keys[0] not in quantities:
            faults.found[number] = Fault(f"its quantities make {key_path(keys)}: {what}", ())
    faults.refuse()


def _table(system: Mapping[str, object]) -> type[SystemTable]:
    """What takes a system without units: one that is named may have been written out."""
    known = SYSTEMS[str(system["type"])]
    return ExplicitPreset if "parts" in system and known is not ExplicitChain else known


def _system(table: object, units: UnitsTable) -> DimensionlessSystem:
    if not isinstance(table, Mapping):
        raise refusal(f"{show(table)} is not a table; write [system]", "system")
    kind = table.get("type")
    if kind == "chain":
        with key_context("units"):
            moved = units.chain_kind()
        with key_context("system"):
            return PhysicalChain.model_validate(table).without_units(moved)
    if not isinstance(kind, str) or kind not in PHYSICAL:
        *others, last = (f'"{name}"' for name in (*PHYSICAL, "chain"))
        what = "missing" if kind is None else f"{show(kind)} is not a system"
        raise refusal(f"{what}; write {', '.join(others)} or {last}", "system", "type")
    if units.kind is not None:
        raise refusal(f"only chains have a choice, a {kind} has none; leave it out", "units", "kind")
    with key_context("system"):
        return PHYSICAL[kind].model_validate(table).without_units()


def _load(load: object, found: DimensionlessSystem, seconds: Fraction) -> object:
    return dimensionless(load, found.load_unit(load), seconds) if isinstance(load, Mapping) else load


def _output(output: Mapping[str, Any], found: DimensionlessSystem, seconds: Fraction, faults: Faults) -> dict[str, Any]:
    """The outputs, without those in which anything is wrong, which is kept in `faults`."""
    made = dict(output)
    if "until" in output:
        made.pop("until")
        with faults.gather("output", "until"):
            made["until"] = _horizon(output["until"], seconds)
    for quantity in _LENGTHS & output.keys() if found.lines is not None else ():
        if isinstance(places := output[quantity], list | tuple):
            sound = len(faults.found)
            made[quantity] = list(places)
            for k, at in enumerate(places):
                with faults.gather("output"):
                    made[quantity][k] = _position(at, found, quantity, k)
            if len(faults.found) > sound:
                del made[quantity]
    return made


def _horizon(value: object, seconds: Fraction) -> object:
    """A time; a number is one of tau."""
    try:
        return exact(value)
    except PydanticCustomError:
        tau = read_quantity(value, "time", 1) / seconds
    if tau > LONGEST_HORIZON:
        most = f"{tidy(LONGEST_HORIZON * seconds)} s ({LONGEST_HORIZON} of tau) or less"
        raise refusal(f"{show(value)} is {tidy(tau)} of tau, too long a horizon; write {most}")
    return tau


def _position(at: object, found: DimensionlessSystem, quantity: str, k: int) -> object:
    assert found.lines is not None  # places are lengths
    with key_context(quantity, k):
        written, title = read_titled_place(at) if isinstance(at, Mapping) else (at, "")
        return place(written, found.lines).position(found.rods.first.length)._replace(title=title)


def forgotten_units(fields: Mapping[str, Any]) -> str:
    """A quantity with a unit in a scene without [units], as it is written; empty where there is none."""
    coming: list[object] = [fields.get(key) for key in ("output", "load", "system")]
    while coming:
        match coming.pop():
            case str() as text if _QUANTITY.match(text):
                return text
            case Mapping() as table:
                coming += reversed(list(table.values()))
            case list() | tuple() as values:
                coming += reversed(values)
    return ""
