"""Chains for the march: a drive whose shafts differ, one of every kind of joint, and small ones drawn."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support import chains
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.scene import Scene

DRIVE: dict[str, Any] = {
    "type": "chain",
    "parts": [
        {"mass": 1, "name": "motor"},
        {"rod": 1},
        {"mass": 2},
        {"rod": "3/2"},
        {"mass": "1/2"},
        {"rod": 2},
        {"mass": 3, "name": "end"},
    ],
}
# a joint of each kind: moved, gears and a branch, a spring without mass, two bodies on a spring, a body, absorbing
EVERY: dict[str, Any] = {
    "type": "chain",
    "parts": [
        {"motion": "acceleration", "velocity": "1/4", "name": "ground"},
        {"rod": 1, "spring": "1/2", "dashpot": "1/10"},
        {"mass": 1, "name": "floor"},
        {"rod": "1/2", "speed": 2, "impedance": "1/3", "strain": "1/5"},
        {"joint": True, "spring": 2, "name": "seat"},
        {"rod": "3/4"},
        {"mass": "1/2", "velocity": 0, "dashpot": "1/10", "name": "gear"},
        {"spring": 40, "dashpot": "1/7"},
        {"mass": 2, "name": "hung"},
    ],
    "branch": [
        {
            "from": "gear",
            "name": "side",
            "ratio": -2,
            "parts": [
                {"rod": "1/2", "velocity": 1},
                {"mass": "1/3", "velocity": 0, "dashpot": "1/5"},
                {"rod": "1/4"},
                {"rod": 1, "impedance": 3},
                "absorbing",
            ],
        }
    ],
}
LOADS = [
    {"at": "ground", "spacing": "1/3", "samples": [0, 1, "-1/2", 0]},
    {"at": "gear", "times": [0, "0.7"], "steps": [1, -2], "ramps": [0, "1/2"]},
]


def drive(until: object = 24, **output: object) -> Scene:
    """Shafts of lengths 1, 3/2 and 2 between four discs, under a moment on the first."""
    load = [{"at": "motor", "times": [0, 4], "steps": [1, -1]}]
    watched = {"strain": ["1-", "5/2+"], "velocity": ["motor", "end"], "displacement": ["end"]}
    return Scene(name="drive", system=DRIVE, load=load, output={"until": until, "tolerance": 1e-8, **watched, **output})


def every(until: object = 3, **output: object) -> Scene:
    """One of every kind of joint, with loads at instants that leave remainders."""
    watched = {
        "strain": ["1-", "1/4", "side:1/2-"],
        "velocity": ["floor", "hung", "ground", "side:3/2"],
        "displacement": ["seat", "hung"],
    }
    return Scene(
        name="every", system=EVERY, load=LOADS, output={"until": until, "tolerance": 1e-6, **watched, **output}
    )


@st.composite
def small(draw: st.DrawFn, until: object = "5/2") -> dict[str, Any]:
    """Chains as `chains` draws them, where nearly equal lengths have a common measure that is not too small."""

    def measured(part: Any) -> Any:
        return part | {"rod": "33/32"} if isinstance(part, dict) and part.get("rod") == "1.001" else part

    table: dict[str, Any] = draw(chains.chains(until=until))
    lines = [table["system"], *table["system"].get("branch", ())]
    for line in lines:
        line["parts"] = list(map(measured, line["parts"]))
    # places that 1.001 had made are elsewhere now
    for quantity in ("strain", "velocity", "displacement"):
        table["output"][quantity] = [place.replace("1.001", "33/32") for place in table["output"][quantity]]
    return table


def instants(model: Model, most: int = 12) -> NDArray[np.float64]:
    """At, hardly before and hardly after instants at which outputs may jump, and between them."""
    fronts = np.array(Reference(model).breakpoints())
    some = fronts[np.linspace(0, len(fronts) - 1, min(most, len(fronts))).astype(int)]
    end = model.horizon()
    taus = np.unique([*some, *np.nextafter(some, -1), *np.nextafter(some, 2 * end), *np.linspace(0, end, 7)])
    return np.asarray(taus[(taus >= 0) & (taus <= end)])


def exact(model: Model, taus: NDArray[np.float64]) -> NDArray[np.float64]:
    """The outputs from power series in balls, correctly rounded."""
    return np.array(Reference(model).values(taus.tolist()))


@st.composite
def bodies(draw: st.DrawFn, until: object = "5/2") -> dict[str, Any]:
    """Bodies with one rod to four, alike or nearly, with gears and dashpots; between two of them another joint."""

    def rod() -> dict[str, Any]:
        made = {"rod": draw(st.sampled_from([1, 1, "1/2", "3/2"]))}
        return made | {"impedance": draw(st.sampled_from([1, 1, 2, "1/3"])), "velocity": draw(begun)}

    def body(name: str) -> dict[str, Any]:
        mass, dashpot = (
            draw(st.sampled_from(sizes)) for sizes in ([1, 1, "1.0000001", "1/2", 3], [0, 0, "1/3", "1.001"])
        )
        return {"mass": mass, "dashpot": dashpot, "velocity": draw(begun), "name": name}

    begun = st.sampled_from([0, 0, 1, "-1/2"])
    other = draw(
        st.sampled_from(
            [
                [{"joint": True}],
                [{"joint": True, "dashpot": 2}],
                [{"mass": 1, "spring": 3, "velocity": 0}],
                [{"spring": 2}],
                [],
            ]
        )
    )
    last = [rod(), body("c")] if other else []
    branches = [
        {
            "from": "b",
            "name": f"side{n}",
            "ratio": draw(st.sampled_from([1, 2, -1, "-1/2"])),
            "parts": [rod(), *draw(st.sampled_from([[], ["fixed"], [body(f"far{n}")]]))],
        }
        for n in range(draw(st.integers(0, 2)))
    ]
    load = [
        {"at": at, "times": [draw(st.sampled_from([0, "1/3"]))], "steps": [1], "ramps": ["-1/2"]}
        for at in draw(st.sampled_from([["a"], ["b"], ["a", "b"]]))
    ]
    parts = [body("a"), rod(), body("b"), *([rod(), *other] if other else [rod()]), *last]
    watched = {"velocity": ["a", "b"], "displacement": ["b"], "strain": ["1/4"]}
    return {
        "name": "bodies",
        "system": {"type": "chain", "parts": parts, "branch": branches},
        "load": load,
        "output": {"until": until, "tolerance": "1e-3", **watched},
    }
