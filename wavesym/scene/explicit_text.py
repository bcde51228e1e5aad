"""A scene of a named system, written out as a chain, part by part: the same network, loads and outputs, as TOML."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.fields.loads import Load
from wavesym.mechanics.network import Network, Point
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.scene.explicit_numbers import Dimensionless, InUnits, number_text
from wavesym.scene.lowering import lower
from wavesym.scene.scene import Scene
from wavesym.systems.parts import ChainPart, MassPart, MotionPart, RodPart
from wavesym.systems.place import Position


def explicit_text(scene: Scene) -> str:
    """The lines of a scene file, for a collision, a drive or a building; CostError for what is written out already."""
    return "".join(f"{line}\n" for line in _lines(scene))


def _lines(scene: Scene) -> Iterator[str]:
    system_fields = scene.physical.fields_in_units["system"] if scene.physical else {}
    if system_fields.get("type", scene.system.type) == "chain":
        raise UnservedError(
            "system.type: a chain has all of its parts written already; write collision, drive or building"
        )
    scene = scene.in_lines
    model, parts = lower(scene), scene.system.parts
    numbers = InUnits(scene.physical.scale, parts) if scene.physical else Dimensionless()
    yield f"# {scene.name}, a {system_fields.get('type', scene.system.type)}, written out part by part."
    parted = model.labels.system.get("contacts") == "open"
    if joined := [] if parted else [point.place for point in model.network.points if point.is_glued]:
        at = ", ".join(joined)
        yield f"# Its contacts are closed, as in the paper's formal model: the rods are joined at {at}."
    yield from numbers.remarks
    yield f"name = {json.dumps(scene.name)}"
    yield ""
    if scene.physical:
        yield "[units]"
        units = {"kind": scene.physical.scale.kind, **scene.physical.fields_in_units["units"]}
        yield from (f"{key} = {json.dumps(value)}" for key, value in units.items())
        yield ""
    yield "[system]"
    yield 'type = "chain"'
    said = scene.system.model_dump(mode="json")
    yield from (f"{key} = {_value(said[key])}" for key in ("damping", "speed_adjustment") if said.get(key))
    yield "parts = ["
    yield from (f"  {part}," for part in _parts(parts, numbers))
    yield "]"
    for load in scene.load:
        yield ""
        yield "[[load]]"
        if load.name:
            yield f"name = {_value(load.name)}"
        yield from _load(load, model.network, numbers)
    yield ""
    yield "[output]"
    yield f"until = {numbers.time(model.until)}"
    yield f"tolerance = {number_text(model.tolerance)}"
    for quantity in QUANTITIES:
        if positions := getattr(scene.output, quantity):
            if quantity == "relative" and not any(point.motion for point in model.network.points):
                raise UnservedError(
                    'output.relative: base = "force" has no foundation that moves; write base = "ground"'
                )
            if quantity == "stress":
                raise UnservedError("output.stress: what is written out has no sections; take force")
            places = [position.text if quantity == "drift" else numbers.position(position) for position in positions]
            yield f"{quantity} = {_list_text(map(_place, places, positions))}"


def _parts(parts: Sequence[ChainPart | str], numbers: Dimensionless) -> Iterator[str]:
    """The parts of a preset; a mass moves at first as the rod before it does."""
    rods, velocity = 0, Fraction(0)
    for part in parts:
        match part:
            case RodPart():
                rods, velocity = rods + 1, part.velocity
                yield _table({**numbers.rod(rods - 1, part), **_moving(velocity, numbers)})
            case MassPart():
                yield _table({"mass": numbers.mass(part.mass), **_moving(velocity, numbers)})
            case MotionPart():
                yield _table({"motion": json.dumps(part.motion)})
            case "contact":
                yield '"contact"'


def _is_acceleration(point: Point) -> bool:
    """Whether a prescribed velocity is the integral of loads, which are accelerations."""
    return point.motion == "velocity" and all(not load.coefficients[0] for load in point.loads)


def _load(load: Load, network: Network, numbers: Dimensionless) -> Iterator[str]:
    """A load as steps and ramps of what acts on a node, or of how it moves."""
    units = {unit.source: (x, unit.coefficients) for x, point in enumerate(network.points) for unit in point.loads}
    place = 0
    sums: dict[fmpq, list[fmpq]] = {}
    for applied in load.units():
        place, coefficients = units[applied.source]
        if _is_acceleration(network.points[place]):
            coefficients = tuple(k * c for k, c in enumerate(coefficients) if k)
        terms = sums.setdefault(applied.time, [fmpq(0), fmpq(0)])
        for k, c in enumerate(coefficients):
            terms[k] += applied.weight * c
    times = sorted(sums)
    yield f"at = {numbers.place(place)}"
    yield f"times = {_list_text(map(numbers.time, times))}"
    moved = network.points[place].motion is not None
    for k, name in enumerate(("steps", "ramps")):
        if not k or any(sums[time][k] for time in times):
            yield f"{name} = {_list_text(numbers.load(sums[time][k], k, moved) for time in times)}"


def _place(written: str, position: Position) -> str:
    """A place, with its name for people where it has one."""
    return _value({"at": written, "name": position.title} if position.title else written)


def _value(value: object) -> str:
    """Text, numbers, lists and tables as TOML."""
    if isinstance(value, Mapping):
        return _table({key: _value(each) for key, each in value.items()})
    return json.dumps(value, ensure_ascii=False)


def _table(values: Mapping[str, str]) -> str:
    return f"{{ {', '.join(f'{key} = {value}' for key, value in values.items())} }}"


def _moving(velocity: Fraction, numbers: Dimensionless) -> dict[str, str]:
    return {"velocity": numbers.velocity(velocity)} if velocity else {}


def _list_text(values: Iterable[str]) -> str:
    return f"[{', '.join(values)}]"
