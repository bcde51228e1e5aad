"""Chains with contacts, drawn: what strikes what, what parts, what only touches, and what does so at one instant.

Nasty sizes are always among them: lengths that are equal or nearly so, equal impedances, no gap and tiny gaps, chains
that are their own mirror image (events at one instant), negative gears, horizons just after something arrives, and
numbers whose doubles lie below them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from random import Random
from typing import Any

from hypothesis import strategies as st

Choose = Callable[[Sequence[Any]], Any]
"""Takes one of some things."""

LENGTHS = [1, 1, 1, "3/2", "1.000000001", "0.7", "1/2", 2]
IMPEDANCES = [1, 1, 1, 2, "1/2", "1.001", "3/10"]
SPEEDS = [1, 1, 1, 1, 2, "3/4"]
MASSES = [1, "1/2", 2, 5, "1.001"]
VELOCITIES = [0, 0, 1, -1, "1/2", "0.3"]
STRAINS = [0, 0, 0, 0, "1/3", "-1/4"]
GAPS = [0, 0, 0, "1/4", "1/3", "0.1", "1e-9", 1]
DASHPOTS = ["1/10", 1, "0.3"]
SPRINGS = [1, "1/4", "4.001"]
RATIOS = [1, -1, 2, "-1/2"]
HORIZONS = [4, 4, 6, "2.000000001", "4.000000001", "3.7"]


def seeded(seed: int) -> dict[str, Any]:
    """The table of a scene; another one for every seed."""
    return scene(Random(seed).choice)


@st.composite
def striking(draw: st.DrawFn) -> dict[str, Any]:
    """The table of a scene, by Hypothesis."""
    return scene(lambda things: draw(st.sampled_from(things)))


def scene(choose: Choose) -> dict[str, Any]:
    """Bodies in a row with contacts between them, an end or none at either side, and perhaps a branch."""
    if choose([0, 0, 0, 1]):
        parts = _mirrored(choose)
    else:
        parts = _begun(choose) + _body(choose)
        for _ in range(choose([1, 1, 2, 2, 3])):
            parts += _meeting(choose, parts, _body(choose))
        parts += _ended(choose, parts)
    names = _named(parts, "n")
    system: dict[str, Any] = {"type": "chain", "parts": parts}
    stems = [name for name, key in names if key != "motion"]
    lines = {"": parts}
    if stems and choose([0, 0, 1]):
        first = [_rod(choose, 0)]
        branch = first + _meeting(choose, first, _body(choose)) if choose([0, 1]) else [*first, _mass(choose, 0)]
        names += _named(branch, "b")
        lines["side"] = branch
        system["branch"] = [{"from": choose(stems), "name": "side", "ratio": choose(RATIOS), "parts": branch}]
    loads = [_load(choose, name) for name, _ in names if choose([0, 0, 1])]
    output: dict[str, Any] = {"until": choose(HORIZONS)}
    output |= {quantity: _places(choose, lines) for quantity in ("strain", "velocity", "displacement")}
    return {"name": "drawn", "system": system, "load": loads, "output": output}


def _rod(choose: Choose, velocity: Any) -> dict[str, Any]:
    rod = {"rod": choose(LENGTHS), "velocity": velocity, "strain": choose(STRAINS)}
    return rod | {"impedance": choose(IMPEDANCES), "speed": choose(SPEEDS)}


def _mass(choose: Choose, velocity: Any) -> dict[str, Any]:
    mass = {"mass": choose(MASSES), "velocity": velocity}
    return mass | {key: choose([0, 0, 0, *sizes]) for key, sizes in (("dashpot", DASHPOTS), ("spring", SPRINGS))}


def _body(choose: Choose) -> list[Any]:
    """What moves as one at first: a mass, or rods with masses or springs beside them."""
    v = choose(VELOCITIES)
    match choose(["mass", "rod", "rod", "rod", "mass rod", "rod mass", "rod rod", "rod mass rod", "rod link rod"]):
        case "mass":
            return [_mass(choose, v)]
        case "rod":
            return [_rod(choose, v)]
        case "mass rod":
            return [_mass(choose, v), _rod(choose, v)]
        case "rod mass":
            return [_rod(choose, v), _mass(choose, v)]
        case "rod rod":
            return [_rod(choose, v), {"joint": True, "dashpot": choose([0, *DASHPOTS])}, _rod(choose, v)]
        case "rod mass rod":
            return [_rod(choose, v), _mass(choose, v), _rod(choose, v)]
    link = {"spring": choose(SPRINGS), "dashpot": choose([0, *DASHPOTS])}
    return [_rod(choose, v), link, _rod(choose, v)]


def _contact(choose: Choose) -> Any:
    gap = choose(GAPS)
    return {"contact": gap} if gap else "contact"


def _rigid(part: Any) -> bool:
    return part == "fixed" or "mass" in part or "motion" in part


def _meeting(choose: Choose, before: list[Any], after: list[Any]) -> list[Any]:
    """A contact, and what comes after it; two rigid bodies do not meet."""
    between = [_rod(choose, 0)] if _rigid(before[-1]) and _rigid(after[0]) else []
    return [*between, _contact(choose), *after]


def _begun(choose: Choose) -> list[Any]:
    match choose(["", "", "fixed", "motion", "absorbing", "wall", "moving wall"]):
        case "wall":
            return ["fixed", _contact(choose), _rod(choose, choose(VELOCITIES))]
        case "moving wall":
            return [_motion(choose), _contact(choose), _rod(choose, choose(VELOCITIES))]
        case "fixed" | "absorbing" as end:
            return [end, _rod(choose, 0)]
        case "motion":
            return [_motion(choose), _rod(choose, 0)]
    return []


def _ended(choose: Choose, parts: list[Any]) -> list[Any]:
    match choose(["", "", "fixed", "absorbing", "wall", "moving wall"]):
        case "wall" | "moving wall" as end:
            wall = "fixed" if end == "wall" else _motion(choose)
            return [*([_rod(choose, 0)] if _rigid(parts[-1]) else []), _contact(choose), wall]
        case "fixed" | "absorbing" as end:
            return [_rod(choose, 0), end]
    return []


def _motion(choose: Choose) -> dict[str, Any]:
    return {"motion": choose(["velocity", "acceleration"]), "velocity": choose(VELOCITIES)}


def _mirrored(choose: Choose) -> list[Any]:
    """A body that others strike from both sides at once."""
    half = _body(choose)
    half += _meeting(choose, half, [_rod(choose, 0)])
    return half + [{"joint": True, "dashpot": choose([0, 1])}] + [_turned(part) for part in reversed(half)]


def _turned(part: Any) -> Any:
    if not isinstance(part, dict) or "velocity" not in part:
        return part
    return {**part, "velocity": str(-Fraction(str(part["velocity"])))}


def _named(parts: list[Any], prefix: str) -> list[tuple[str, str]]:
    names = []
    for k, part in enumerate(parts):
        if isinstance(part, dict) and (key := next((key for key in ("mass", "joint", "motion") if key in part), None)):
            parts[k] = {**part, "name": f"{prefix}{len(names)}"}
            names.append((f"{prefix}{len(names)}", key))
    return names


def _load(choose: Choose, at: str) -> dict[str, Any]:
    times = choose([[0], [0, 1], ["1/3", "1.1"], [0, "2.000000001"]])
    keys = choose([("steps",), ("ramps",), ("steps", "ramps")])
    return {"at": at, "times": times} | {key: [choose([1, -1, "-1/2", "0.2"]) for _ in times] for key in keys}


def _places(choose: Choose, lines: dict[str, list[Any]]) -> list[str]:
    """Of each line a place with a side: an end of a rod, or inside of it."""
    found = []
    for line, parts in lines.items():
        lengths = [Fraction(str(part["rod"])) for part in parts if isinstance(part, dict) and "rod" in part]
        rod = choose(range(len(lengths)))
        begin, x = sum(lengths[:rod], Fraction(0)), choose([Fraction(0), Fraction(1), Fraction(2, 5)])
        found.append(f"{line}{line and ':'}{begin + lengths[rod] * x}{'+' if x == 0 else '-'}")
    return found
