"""Chains whose contacts stand beside what is stiff, drawn: cushions, caps with hardly any mass, thin layers, twins.

A body with a cushion, or with a light mass at its end, strikes bars; rates are up to some 1500 a unit of time. Equal
and nearly equal bodies, gaps that close just as a front arrives, and horizons just after one are always among them.
"""

from __future__ import annotations

from random import Random
from typing import Any

from tests.support.striking import Choose

CUSHIONS = [(100, "1/8"), (60, "1/10"), (200, "1/5"), (150, "1/7")]
CAPS = [None, None, "1/500", "1/1000", "1/200"]
LIGHT = ["1/200", "1/400", "1/100"]
LAYERS = ["1/20", "1/10", "0.0501"]
LENGTHS = [1, 1, "1.000000001", "3/4"]
IMPEDANCES = [1, 1, 2, "1/3", "1.001"]
MASSES = [1, 1, "1.001", 2, "1/2"]
GAPS = [0, 0, "1/7", "1/4", 1, "1e-9"]
HORIZONS = ["2.2", "2.000000001", "1.8", "2.142857143"]


def seeded(seed: int) -> dict[str, Any]:
    """The table of a scene; another one for every seed."""
    return scene(Random(seed).choice)


def scene(choose: Choose) -> dict[str, Any]:
    """What strikes, a contact, what is struck, perhaps a second contact behind it, and an end."""
    parts = [*_striker(choose), _contact(choose), *_bars(choose)]
    if choose([0, 0, 1]):
        parts += [_contact(choose), *_cushion(choose, 0)[::-1], {"rod": choose(LENGTHS)}]
    parts += choose([[], ["fixed"], ["absorbing"]])
    load = []
    named = next((part["name"] for part in parts if isinstance(part, dict) and "name" in part), None)
    if named and choose([0, 0, 1]):
        load = [{"at": named, "times": [0, "1/2"], "steps": [choose([1, -1]), "1/3"]}]
    output = {"until": choose(HORIZONS), "velocity": ["0+"], "strain": ["1/3"]}
    return {"name": "cushioned", "system": {"type": "chain", "parts": parts}, "load": load, "output": output}


def _contact(choose: Choose) -> Any:
    gap = choose(GAPS)
    return {"contact": gap} if gap else "contact"


def _mass(choose: Choose, velocity: Any) -> dict[str, Any]:
    return {"mass": choose(MASSES), "velocity": velocity}


def _cushion(choose: Choose, velocity: Any) -> list[Any]:
    """A spring and a dashpot, and the cap at its end."""
    spring, dashpot = choose(CUSHIONS)
    cap = choose(CAPS)
    end = {"joint": True} if cap is None else {"mass": cap, "velocity": velocity}
    return [{"spring": spring, "dashpot": dashpot}, end]


def _striker(choose: Choose) -> list[Any]:
    rod = {"rod": choose(LENGTHS), "impedance": choose(IMPEDANCES), "velocity": 1}
    ram = {**_mass(choose, 1), "name": "ram"}
    match choose(["ram", "ram", "rod", "light", "layer", "twins"]):
        case "ram":
            return [ram, *_cushion(choose, 1)]
        case "rod":
            return [rod, *_cushion(choose, 1)]
        case "light":
            return [rod, {"mass": choose(LIGHT), "velocity": 1}]
        case "layer":
            return [ram, {**rod, "rod": choose(LAYERS)}]
    return [ram, rod, {**ram, "name": "twin"}, {**rod}]


def _bars(choose: Choose) -> list[Any]:
    first = {"rod": choose(LENGTHS), "impedance": choose(IMPEDANCES)}
    match choose(["bar", "bar", "layer", "light", "body"]):
        case "layer":
            return [first, {"rod": choose(LAYERS), "impedance": "1/5"}, {**first}]
        case "light":
            return [first, {"mass": choose(LIGHT)}, {**first}]
        case "body":
            return [first, _mass(choose, 0), {**first}]
    return [first]
