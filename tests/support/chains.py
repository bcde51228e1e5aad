"""Small explicit chains drawn by Hypothesis, as the tables that their texts are; sizes and lengths nearly coincide."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from hypothesis import strategies as st

LENGTHS = [1, 1, 1, "3/2", "1.001", "1.000000001", "1/2", 2]
IMPEDANCES = [1, 1, 1, 2, "1/2", "1.001", "1/4"]
SPEEDS = [1, 1, 1, 2, "1/2"]
MASSES = [1, "1/2", 2, "1.001", 40]
DASHPOTS = [0, 0, 1, "1/10", "1.001", 3]
SPRINGS = [0, 0, 1, "1/4", "1.001", 4]
RATIOS = [1, 2, -1, "-1/2", "1.001", -3]
BEGUN = [0, 0, 1, "-1/2"]


@st.composite
def _rod(draw, begun: bool) -> dict[str, Any]:
    rod = {"rod": draw(st.sampled_from(LENGTHS))}
    for key, sizes in (("impedance", IMPEDANCES), ("speed", SPEEDS)):
        if (size := draw(st.sampled_from(sizes))) != 1:
            rod[key] = size
    if begun:
        rod |= {key: draw(st.sampled_from(BEGUN)) for key in ("velocity", "strain")}
    if draw(st.integers(0, 4)) == 0:
        rod |= {"spring": draw(st.sampled_from(SPRINGS)), "dashpot": draw(st.sampled_from(DASHPOTS))}
    return rod


@st.composite
def _held(draw) -> dict[str, Any]:
    """A dashpot and a spring of a node."""
    return {"dashpot": draw(st.sampled_from(DASHPOTS)), "spring": draw(st.sampled_from(SPRINGS))}


@st.composite
def _link(draw) -> dict[str, Any]:
    return {"spring": draw(st.sampled_from(SPRINGS[2:])), "dashpot": draw(st.sampled_from(DASHPOTS))}


@st.composite
def _mass(draw) -> dict[str, Any]:
    mass = {"mass": draw(st.sampled_from(MASSES)), "velocity": draw(st.sampled_from(BEGUN))}
    return mass | (draw(_held()) if draw(st.booleans()) else {})


@st.composite
def _between(draw) -> list[dict[str, Any]]:
    """What two rods have between them."""
    kind = draw(st.sampled_from(["joint", "mass", "held", "link", "mass link", "link mass", "link joint link"]))
    parts: list[dict[str, Any]] = []
    for each in kind.split():
        match each:
            case "mass":
                parts.append(draw(_mass()))
            case "link":
                parts.append(draw(_link()))
            case "held":
                parts.append({"joint": True} | draw(_held()))
            case "joint":
                parts.append({"joint": True} | ({} if kind == "joint" else {"dashpot": 1}))
    return parts


@st.composite
def _end(draw) -> list[Any]:
    """A line's last parts."""
    kind = draw(st.sampled_from(["", "free", "fixed", "absorbing", "mass", "held", "motion", "link"]))
    match kind:
        case "":
            return []
        case "mass":
            return [draw(_mass())]
        case "held":
            return [{"joint": True} | draw(_held())]
        case "motion":
            return [
                {
                    "motion": draw(st.sampled_from(["velocity", "acceleration"])),
                    "velocity": draw(st.sampled_from(BEGUN)),
                }
            ]
        case "link":
            return [draw(_link()), draw(st.one_of(st.just("fixed"), _mass()))]
    return [kind]


@st.composite
def _line(draw, rods: int, begun: bool) -> list[Any]:
    """Rods with something between them, and an end."""
    parts = [draw(_rod(begun))]
    for _ in range(rods - 1):
        parts += [*draw(_between()), draw(_rod(begun))]
    return [*parts, *draw(_end())]


def _named(parts: list[Any], prefix: str) -> list[tuple[str, str]]:
    """Gives names to all nodes that can have one; each with the key that says what it is."""
    names = []
    for part in parts:
        if isinstance(part, dict) and (key := next((k for k in ("mass", "joint", "motion") if k in part), None)):
            part["name"] = f"{prefix}{len(names)}"
            names.append((part["name"], key))
    return names


@st.composite
def _load(draw, at: str) -> dict[str, Any]:
    if draw(st.integers(0, 3)) == 0:
        return {"at": at, "spacing": draw(st.sampled_from(["1/3", "0.7"])), "samples": [0, 1, "-1/2"]}
    times = draw(st.sampled_from([[0], ["1/3"], [0, 1], [0, "1.001"]]))
    size = st.sampled_from([1, "-1/2", "1e-3"])
    load = {"at": at, "times": times}
    for key in draw(st.sampled_from([("steps",), ("ramps",), ("steps", "ramps")])):
        load[key] = [draw(size) for _ in times]
    return load


def long(parts: list[Any]) -> Fraction:
    """The length of a line."""
    return sum((Fraction(part["rod"]) for part in parts if isinstance(part, dict) and "rod" in part), Fraction(0))


@st.composite
def _places(draw, lines: dict[str, list[Any]], count: int) -> list[str]:
    """Places with a side: joints, and inside of rods."""
    found: dict[tuple[str, Fraction], str] = {}
    for _ in range(count):
        line = draw(st.sampled_from(sorted(lines)))
        lengths = [Fraction(part["rod"]) for part in lines[line] if isinstance(part, dict) and "rod" in part]
        rod = draw(st.integers(0, len(lengths) - 1))
        x = sum(lengths[:rod], Fraction(0)) + lengths[rod] * draw(
            st.sampled_from([Fraction(0), Fraction(1), Fraction(2, 5)])
        )
        found[line, x] = f"{line}{line and ':'}{x}{draw(st.sampled_from('-+'))}"
    return list(found.values())


@st.composite
def chains(draw, until: int | str = 4) -> dict[str, Any]:
    """The table of a scene."""
    begun = draw(st.integers(0, 2)) == 0
    rods = draw(st.integers(1, 3))
    main = draw(_line(rods, begun))
    main = [*reversed(draw(_end())), *main]
    # beside a spring, absorbing means nothing
    if main[0] == "free" and draw(st.booleans()):
        main = main[1:]
    names = _named(main, "n")
    lines = {"": main}
    system: dict[str, Any] = {"type": "chain", "parts": main}
    stems = [name for name, key in names if key != "motion"]
    if stems and rods < 3 and draw(st.booleans()):
        branch = draw(_line(draw(st.integers(1, 3 - rods)), begun))
        if draw(st.integers(0, 4)) == 0:
            branch = [draw(_link()), *branch]
        names += _named(branch, "b")
        lines["side"] = branch
        ratio = draw(st.sampled_from(RATIOS))
        system["branch"] = [{"from": draw(st.sampled_from(stems)), "name": "side", "ratio": ratio, "parts": branch}]
    loads = []
    if names:
        loads = [draw(_load(name)) for name in draw(st.lists(st.sampled_from([n for n, _ in names]), max_size=2))]
    output: dict[str, Any] = {"until": until}
    output["strain"] = draw(_places(lines, 2))
    output["velocity"] = draw(_places(lines, 2))
    output["displacement"] = [*draw(_places(lines, 1))]
    return {"name": "drawn", "system": system, "load": loads, "output": output}
