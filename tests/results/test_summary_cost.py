"""What took half a minute without a word: it is served, or refused, in a part of that."""

from __future__ import annotations

from random import Random
from time import process_time
from typing import Any

import pytest

from wavesym import api
from wavesym.errors import CostError
from wavesym.scene import Scene

STEEL = {"E": "206 GPa", "rho": "7850 kg/m^3"}
STRING = Scene(
    name="string",
    units={"length": "mm"},
    system={
        "type": "chain",
        "parts": [
            {"mass": "20 t", "name": "top"},
            {"rod": "3000 m", "A": "3404 mm^2", **STEEL},
            {"rod": "150 m", "A": "20000 mm^2", **STEEL},
            {"rod": "60 m", "A": "28000 mm^2", **STEEL},
            {"mass": "500 kg", "spring": "50 MN/m", "name": "bit"},
        ],
    },
    load=[{"at": "top", "times": ["0 s", "1 s"], "steps": ["10 kN", "-5 kN"]}],
    output={"until": "12 s", "tolerance": 1e-6, "velocity": ["top", "bit"], "force": ["top", "bit"]},
)


def tower() -> Scene:
    """Twenty damped storeys under 5000 samples."""
    storey = {"count": 20, "height": "3.5 m", "stiffness": "277 MN/m", "column_mass": "11 t", "floor_mass": "350 t"}
    draw = Random(3)
    samples = [0, *(round(draw.uniform(-1, 1), 4) for _ in range(4998)), 0]
    return Scene(
        name="tower",
        units={"length": "mm"},
        system={"type": "building", "base": "ground", "damping": 0.05, "storey": [storey]},
        load=[{"spacing": "0.01 s", "samples": samples, "unit": "m/s^2"}],
        output={"until": "50 s", "tolerance": 1e-4, "drift": [1, 10, 20], "acceleration": [20]},
    )


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("scene", "once"),
    [pytest.param(tower(), 24, id="tower"), pytest.param(STRING, 32, id="string", marks=pytest.mark.slow)],
)
def test_a_summary_takes_a_part_of_what_it_took(scene: Scene, once: float) -> None:
    start = process_time()
    assert api.summary(scene).outputs
    assert process_time() - start < once / 2


@pytest.mark.slow
def test_sixteen_bodies_in_contact_are_refused_in_a_part_of_what_it_took() -> None:
    """A run of 21 s, once."""
    parts: list[Any] = []
    for k in range(16):
        parts += [{"mass": [1, "3/2", 2][k % 3], "velocity": int(k == 0)}, {"rod": 1}, {"contact": "1/10"}]
    system = {"type": "chain", "parts": [*parts[:-1], "free"]}
    scene = Scene(name="train", system=system, output={"until": 60, "tolerance": 1e-6, "velocity": ["0"]})
    start = process_time()
    with pytest.raises(CostError, match="the limit is 10000"):
        api.run(scene)
    assert process_time() - start < 21 / 2
