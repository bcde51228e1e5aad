"""Chains whose links have corners, drawn: one-sided springs, backlash, what yields and what rubs, with rods and masses.

Nasty sizes are always among them: equal and nearly equal numbers, limits of 0, limits that nothing reaches, chains that
are their own mirror image (events at one instant), loads that turn just as a front arrives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from random import Random
from typing import Any

Choose = Callable[[Sequence[Any]], Any]
"""Takes one of some things."""

Mix = Callable[[int], dict[str, Any]]
"""Draws a chain by its seed."""

LENGTHS = [1, 1, "1/2", "3/2", "1.000000001", "0.7"]
IMPEDANCES = [1, 1, 2, "1/2", "1.001"]
MASSES = [1, 1, "1/2", 2, "1.001"]
VELOCITIES = [0, 0, 1, -1, "1/2", "0.3"]
SPRINGS = [1, 4, "9/2", "4.001"]
GAPS = [0, "1/4", "1/3", "0.1", "1e-9", 1]
LIMITS = [0, "1/8", "1/4", "1/3", "0.7", 1, 1000]
LAWS = ["push", "pull", "both", "yield", "unequal", "linear"]


def spring(choose: Choose, kinds: Sequence[str] = LAWS) -> dict[str, Any]:
    """A spring with a law."""
    table, kind = {"spring": choose(SPRINGS)}, choose(kinds)
    match kind:
        case "push" | "pull":
            return table | {"only": kind, "gap": choose(GAPS)}
        case "both":
            low, high = choose([("-1/4", "1/8"), (0, 0), ("-1e-9", "1/3"), ("1/8", "1/2"), ("-1/3", "1/3")])
            return table | {"gap": [low, high]}
        case "yield":
            return table | {"yield": choose(LIMITS[1:])}
        case "unequal":
            return table | {"yield": [choose(LIMITS), choose(LIMITS[1:])]}
    return table


def seeded(seed: int, kinds: Sequence[str] = LAWS) -> dict[str, Any]:
    """The table of a scene with friction and some kinds of springs; another one for every seed."""
    choose = Random(seed).choice
    parts: list[Any] = [_node(choose, 0, kinds)]
    for _ in range(choose([1, 2, 2, 3])):
        rubs = "friction" in parts[-1]
        if choose([0, 1]) or rubs or _massless(parts[-1]):
            parts.append({"rod": choose(LENGTHS), "impedance": choose(IMPEDANCES)})
            if choose([0, 0, 0, 1]) and not rubs:
                parts[-1] |= spring(choose, kinds)
            parts.append(_node(choose, len(parts), kinds, not _sprung(parts[-1])))
        else:
            parts.append(spring(choose, kinds))
            parts.append(_mass(choose, len(parts)))
    if choose([0, 1]):
        parts += [{"rod": 1} if "friction" in parts[-1] else spring(choose, kinds), "fixed"]
    elif _massless(parts[-1]) and not choose([0, 1]):
        parts.append({"rod": 1})
    if choose([0, 0, 0, 1]):
        parts = _mirrored(parts)
    return _scene(choose, parts, choose([3, "7/2", "2.000000001"]))


def breaking_chain(seed: int) -> dict[str, Any]:
    """One with friction that bears more at rest, of masses on the ground, between rods and springs; or on a belt."""
    choose = Random(seed).choice
    if choose([0, 0, 1]):
        belt = {"motion": "velocity", "name": "n0", "velocity": choose([1, "1/4", "-0.3"])}
        parts: list[Any] = [belt, _breaking(choose), _mass(choose, 1) | {"dashpot": 0}]
    else:
        parts = [
            choose(["fixed", _mass(choose, 0), {"motion": "velocity", "name": "n0", "velocity": choose([1, "1/4"])}])
        ]
        parts += [choose([_rod(choose, 0), {"spring": choose(SPRINGS)}])]
        parts.append(_mass(choose, 1) | {"dashpot": choose([0, "1/5"])} | _breaking(choose))
    for number in range(2, choose([2, 3, 4])):
        parts += [_rod(choose, 0), _mass(choose, number) | {"dashpot": 0} | choose([{}, _breaking(choose)])]
    parts += choose([[], [{"spring": choose(SPRINGS)}, "fixed"], [_rod(choose, 0)], [_rod(choose, 0), "fixed"]])
    return _scene(choose, parts, choose([4, 6, "7.000000001"]))


def _breaking(choose: Choose) -> dict[str, Any]:
    limit = choose(LIMITS[1:-1])
    return {
        "friction": limit,
        "breakaway": str(Fraction(str(limit)) * Fraction(choose(["1", "1.001", "3/2", "2", "4"]))),
    }


def touching_chain(seed: int) -> dict[str, Any]:
    """One with contacts in the joints of its springs: a rod strikes what stands on springs, and is struck."""
    choose = Random(seed).choice
    parts: list[Any] = [_rod(choose, choose([1, "1/2", "0.3", 0])), _contact(choose), _held(choose, 2)]
    if choose([0, 1]):
        parts += [spring(choose), _mass(choose, len(parts) + 1)]
    for _ in range(choose([0, 1, 1])):
        parts += [_rod(choose, 0), _contact(choose), _held(choose, len(parts) + 2)]
    if choose([0, 1]):
        parts.append(_rod(choose, 0))
    if choose([0, 1, 1]):
        parts.append(choose(["free", "fixed"]) if "rod" in parts[-1] else spring(choose))
        parts += ["fixed"] * ("spring" in parts[-1] and isinstance(parts[-1], dict))
    return _scene(choose, parts, choose([4, "7/2", "5.000000001"]))


def _rod(choose: Choose, velocity: Any) -> dict[str, Any]:
    return {"rod": choose(LENGTHS), "impedance": choose(IMPEDANCES), "velocity": velocity}


def _contact(choose: Choose) -> dict[str, Any]:
    return {"contact": choose([0, 0, "1/4", "0.1", "1e-9"])}


def _held(choose: Choose, number: int) -> dict[str, Any]:
    """A mass or a joint that a spring with a law may hold."""
    if choose([0, 1]):
        law = spring(choose, ["yield", "unequal", "linear"])
        return {"joint": True, "name": f"n{number}", "dashpot": choose(["1/5", 1])} | law
    node = _mass(choose, number)
    if choose([0, 1, 1]):
        node.pop("dashpot", None)
        node |= spring(choose)
    return node


def sliding_chain(seed: int) -> dict[str, Any]:
    """One with friction between its parts: masses, joints without mass, an end that moves, ends of a rod."""
    choose = Random(seed).choice
    parts: list[Any] = []
    if choose([0, 1]):
        parts = [_side(choose, 1), _rod(choose, choose([0, 1, "0.3"]))]
    limit = choose(LIMITS[1:])
    match choose(["between", "between", "belt", "rod"]):
        case "between":
            sides = [_side(choose, len(parts) + 1), _side(choose, len(parts) + 3)]
            between = {"friction": limit} | ({"spring": choose(SPRINGS)} if choose([0, 0, 1]) else {})
            parts += [sides[0], between, sides[1]]
            if not _braced(parts, 0 if len(parts) == 3 else 2):
                parts.insert(len(parts) - 3, _rod(choose, 1)) if len(parts) > 3 else parts.insert(0, _rod(choose, 1))
            if _massless(sides[1]) or choose([0, 1]):
                parts += [_rod(choose, 0), choose(["free", "fixed"])]
        case "belt":
            parts += [_mass(choose, len(parts) + 1) | {"dashpot": 0}, {"friction": limit}]
            parts += [{"motion": choose(["velocity", "acceleration"]), "velocity": 0, "name": "belt"}]
            if len(parts) == 3:
                parts = ["fixed", spring(choose, ["linear"]), *parts]
        case "rod":
            parts += [_mass(choose, len(parts) + 1) | {"dashpot": 0}]
            parts += [_rod(choose, 0) | {"friction": limit}, _side(choose, len(parts) + 2)]
    table = _scene(choose, parts, choose([3, "7/2", 5]))
    if isinstance(parts[-1], dict) and parts[-1].get("name") == "belt":
        load = {"at": "belt", "times": [0, choose([1, "1.1"])]}
        table["load"].append(
            load | choose([{"steps": ["1/2", -1]}, {"ramps": ["1/3", -1]}, {"steps": [1, 0], "ramps": [0, "-1/2"]}])
        )
    return table


def _side(choose: Choose, number: int) -> dict[str, Any]:
    """A mass or a joint beside friction."""
    if choose([0, 0, 1]):
        return {"joint": True, "name": f"n{number}"}
    return _mass(choose, number) | {"dashpot": 0}


def _braced(parts: list[Any], first: int) -> bool:
    """Whether what stands there has a mass, or a rod."""
    return not _massless(parts[first]) or (first > 0 and "rod" in parts[first - 1])


def rubbing_masses(seed: int) -> dict[str, Any]:
    """Two masses that may rub on the ground, with springs between them and to the ground."""
    choose = Random(seed).choice
    first = _mass(choose, 1) | {"dashpot": 0, "friction": choose(LIMITS[1:])}
    if choose([0, 1]):
        first |= spring(choose)
    last = _mass(choose, 3) | {"dashpot": 0}
    if choose([0, 0, 1]):
        last |= spring(choose)
    elif choose([0, 0, 1]):
        last["friction"] = choose(LIMITS[1:])
    end = choose([[], [{"rod": choose(LENGTHS)}, "fixed"], [spring(choose), "fixed"]])
    return _scene(choose, [first, spring(choose), last, *end], choose([3, "7/2"]))


def friction_beside_contacts(seed: int) -> dict[str, Any]:
    """A rod strikes what rubs on the ground: a mass or a joint, beside springs, rods, other contacts and friction."""
    choose = Random(seed).choice
    parts: list[Any] = choose([[], ["fixed"], [_mass(choose, 0)]])
    parts += [_rod(choose, choose([1, "1/2", "0.3", 0])), _contact(choose)]
    if light := choose([0, 0, 1]):
        node = {"joint": True, "name": "n2"}
    else:
        node = _mass(choose, 2) | {"dashpot": 0} | choose([{}, {}, spring(choose)])
    parts.append(node | {"friction": choose(LIMITS[1:])})
    follows = choose(["rod", "fixed", "contact"] if light else ["", "rod", "fixed", "contact", "spring", "friction"])
    match follows:
        case "rod" | "fixed":
            parts += [_rod(choose, 0), *["fixed"] * (follows == "fixed")]
        case "contact" if not light:
            parts += [_contact(choose), _rod(choose, choose([0, -1])), choose(["free", "fixed"])]
        case "contact":
            parts += [_rod(choose, 0), _contact(choose), _rod(choose, choose([0, -1]))]
        case "spring":
            parts += [spring(choose), _mass(choose, 4) | {"dashpot": 0}]
        case "friction":
            parts += [{"friction": choose(LIMITS[1:])}, _mass(choose, 4) | {"dashpot": 0}]
    return _scene(choose, parts, choose([3, 4, "5.000000001"]))


def light_friction(seed: int) -> dict[str, Any]:
    """Friction of a joint without mass on the ground, or on another part, beside springs and friction of others."""
    choose = Random(seed).choice
    parts: list[Any] = choose([[], ["fixed"], [_mass(choose, 0)]])
    parts += [_rod(choose, choose([1, 0, "0.3"])), {"joint": True, "name": "n2"} | choose([{}, spring(choose)])]
    if choose([0, 1]):
        parts[-1] |= {"friction": choose(LIMITS[1:])}
        parts += [spring(choose), _mass(choose, 4) | {"dashpot": 0}]
    else:
        parts += [{"friction": choose(LIMITS[1:])}, _mass(choose, 4) | {"dashpot": 0} | choose([{}, spring(choose)])]
    parts[-1] |= choose([{}, {"friction": choose(LIMITS[1:])}])
    parts += choose([[], [_rod(choose, 0)], [spring(choose), "fixed"]])
    return _scene(choose, parts, choose([3, 4, "5.000000001"]))


def damped_chain(seed: int) -> dict[str, Any]:
    """One with dashpots beside its springs that yield."""
    table, choose = seeded(seed), Random(seed).choice
    for part in table["system"]["parts"]:
        if "yield" in part:
            part["dashpot"] = choose(["1/5", "1", "3/2"])
    return table


def engaging_chain(seed: int, draw: Mix | None = None) -> dict[str, Any]:
    """One with dashpots that act while springs with gaps do; drawn otherwise, by default, as with friction alone."""
    table, choose = (draw or seeded)(seed), Random(seed).choice
    for part in table["system"]["parts"]:
        if "only" in part or "gap" in part:
            part["dashpot"] = choose(["1/5", "1", "3/2", 20])
    return table


def closed_chain(seed: int) -> dict[str, Any]:
    """One whose energy goes where it slides or yields, and nowhere else."""
    table = seeded(seed)
    table["load"] = []
    for part in table["system"]["parts"]:
        if isinstance(part, dict):
            part.pop("dashpot", None)
            if "mass" in part:
                part["velocity"] = 1 if not part["velocity"] else part["velocity"]
    return table


def _massless(part: Any) -> bool:
    return "joint" in part


def _sprung(part: Any) -> bool:
    return "gap" in part or "only" in part or "yield" in part


def _mass(choose: Choose, number: int) -> dict[str, Any]:
    mass = {"mass": choose(MASSES), "velocity": choose(VELOCITIES), "name": f"n{number}"}
    return mass | {"dashpot": choose([0, 0, "1/5"])}


def _node(choose: Choose, number: int, kinds: Sequence[str], friction: bool = True) -> dict[str, Any]:
    """A mass or a joint, with friction or a spring to the ground, or neither."""
    massless = number and choose([0, 0, 1])
    node = {"joint": True, "name": f"n{number}"} if massless else _mass(choose, number)
    match choose(["", "", "friction", "spring"]):
        case "friction" if friction:
            node.pop("dashpot", None)
            return node | {"friction": choose(LIMITS[1:])}
        case "spring":
            node.pop("dashpot", None)
            return node | spring(choose, kinds)
    return node


def _mirrored(parts: list[Any]) -> list[Any]:
    """The same on both sides of a rod, and what moves to the right on one side moves to the left on the other."""
    half = [part for part in parts if part != "fixed"]
    while not (isinstance(half[-1], dict) and ("mass" in half[-1] or "joint" in half[-1])):
        half.pop()
    turned = []
    for part in reversed(half):
        turned.append(dict(part))
        if "velocity" in part:
            turned[-1]["velocity"] = str(-Fraction(str(part["velocity"])))
        if "name" in part:
            turned[-1]["name"] = f"m{part['name'][1:]}"
        if ("mass" in part or "joint" in part) and _sprung(part):
            turned[-1] |= _other_way(part)
    return [*half, {"rod": 1}, *turned]


def _other_way(part: dict[str, Any]) -> dict[str, Any]:
    """The law of a spring to the ground, seen from the other side."""
    if "only" in part:
        return {"only": "pull" if part["only"] == "push" else "push"}
    for key, sign in (("gap", -1), ("yield", 1)):
        if isinstance(part.get(key), list):
            return {key: [str(sign * Fraction(str(each))) for each in reversed(part[key])]}
    return {}


def _scene(choose: Choose, parts: list[Any], until: Any) -> dict[str, Any]:
    names = [part["name"] for part in parts if isinstance(part, dict) and "name" in part]
    loads = []
    if choose([0, 1, 1]):
        times = choose([[0, 1], ["1/3", "1.1"], [0, "2"], [1, "2.000000001"]])
        keys = choose([("steps",), ("ramps",), ("steps", "ramps")])
        load = {"at": choose(names), "times": times}
        loads = [load | {key: [choose([1, -1, "-1/2", 2]) for _ in times] for key in keys}]
    output = {"until": until, "tolerance": 1e-9, "displacement": names, "velocity": names}
    return {"name": "drawn", "system": {"type": "chain", "parts": parts}, "load": loads, "output": output}
