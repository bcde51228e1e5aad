"""A scene of a named system, written out as a chain, part by part: the same network, loads and outputs, as TOML."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.fields.loads import Load
from wavesym.model.network import Network, Point
from wavesym.scene.lowering import lower
from wavesym.scene.outputs import QUANTITIES
from wavesym.scene.scene import Scene


def explicit_text(scene: Scene) -> str:
    """The lines of a scene file, for a collision, a drive or a building; CostError for what is written out already."""
    return "".join(f"{line}\n" for line in _lines(scene))


def _lines(scene: Scene) -> Iterator[str]:
    if scene.system.type == "chain":
        raise UnservedError("system.type: chain given, collision, drive or building expected (a chain is written out)")
    model = lower(scene)
    yield f"# {scene.name}, a {scene.system.type}, written out part by part."
    parted = model.labels.system.get("contacts") == "open"
    if joined := [] if parted else [x for x, node in enumerate(model.named.nodes) if node.contact]:
        at = ", ".join(map(str, joined))
        yield f"# Its contacts are closed, as in the paper's formal model: the rods are joined at {at}."
    yield f"name = {json.dumps(scene.name)}"
    yield ""
    yield "[system]"
    yield 'type = "chain"'
    yield "parts = ["
    yield from (f"  {part}," for part in _parts(model.network))
    yield "]"
    for load in scene.load:
        yield ""
        yield "[[load]]"
        yield from _load(load, model.network)
    yield ""
    yield "[output]"
    yield f"until = {_number(model.until)}"
    yield f"tolerance = {_number(model.tolerance)}"
    for quantity in QUANTITIES:
        if positions := getattr(scene.output, quantity):
            if quantity == "relative" and not any(point.motion for point in model.network.points):
                raise UnservedError(
                    'output.relative: given with base = "force", "ground" expected (of a chain that is written out, '
                    "displacements are relative to an end that moves as it is told)"
                )
            yield f"{quantity} = {json.dumps([position.written for position in positions])}"


def _parts(network: Network) -> Iterator[str]:
    rods = {bar.left: bar for bar in network.bars}
    touching = {network.links[number].left for number in network.contacts}
    for number, point in enumerate(network.points):
        if point.motion:
            yield _table({"motion": json.dumps("acceleration" if _accelerated(point) else "velocity")})
        elif point.mass:
            yield _table({"mass": _number(point.mass), **_other("dashpot", point.damping), **_moving(point.velocity)})
        elif point.damping:
            yield _table({"joint": "true", **_other("dashpot", point.damping)})
        if number in touching:
            yield '"contact"'
        elif number in rods:
            bar = rods[number]
            impedance = {} if bar.impedance == 1 else {"impedance": _number(bar.impedance)}
            yield _table({"rod": _number(bar.length), **impedance, **_moving(bar.velocity)})


def _accelerated(point: Point) -> bool:
    """Whether its loads are accelerations, whose velocities are 0 at first."""
    return point.motion is not None and all(not load.coefficients[0] for load in point.loads)


def _load(load: Load, network: Network) -> Iterator[str]:
    """A load as steps and ramps of what acts on a node, or of how it moves."""
    units = {unit.source: (x, unit.coefficients) for x, point in enumerate(network.points) for unit in point.loads}
    place = 0
    sums: dict[fmpq, list[fmpq]] = {}
    for applied in load.units():
        place, coefficients = units[applied.source]
        if _accelerated(network.points[place]):
            coefficients = tuple(k * c for k, c in enumerate(coefficients) if k)
        terms = sums.setdefault(applied.time, [fmpq(0), fmpq(0)])
        for k, c in enumerate(coefficients):
            terms[k] += applied.weight * c
    times = sorted(sums)
    yield f"at = {place}"
    yield f"times = {_listed(times)}"
    for k, name in enumerate(("steps", "ramps")):
        if not k or any(sums[time][k] for time in times):
            yield f"{name} = {_listed(sums[time][k] for time in times)}"


def _table(values: dict[str, str]) -> str:
    return f"{{ {', '.join(f'{key} = {value}' for key, value in values.items())} }}"


def _moving(velocity: fmpq) -> dict[str, str]:
    return _other("velocity", velocity)


def _other(key: str, value: fmpq) -> dict[str, str]:
    return {key: _number(value)} if value else {}


def _listed(values: Iterable[fmpq]) -> str:
    return f"[{', '.join(map(_number, values))}]"


def _number(value: fmpq) -> str:
    return str(value) if value.q == 1 else f'"{value}"'
