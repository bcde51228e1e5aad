"""Explicit chains against a Laplace expansion that knows nothing of the package: to the last bit, and in programs."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings

import wavesym
from tests.support.chains import chains
from tests.support.generated import files
from tests.support.laplace import Laplace, Terms
from wavesym.exact.reference import Reference
from wavesym.running.compilation import import_text
from wavesym.scene import lower

UNTIL = 3
STEPPED = {
    "name": "stepped",
    "system": {
        "type": "chain",
        "parts": [
            {"mass": 4, "velocity": 1, "name": "hammer"},
            {"rod": 1},
            {"rod": "3/2", "impedance": 2},
            {"mass": "1/2", "dashpot": "1/10", "name": "gear"},
            {"rod": "1.001"},
            "fixed",
        ],
        "branch": [
            {"from": "gear", "name": "a", "ratio": -2, "parts": [{"rod": 1, "impedance": "1/2"}, {"mass": 1}]},
        ],
    },
    "load": [{"at": "hammer", "times": [0, 2], "steps": [1, -1]}],
    "output": {"until": 8, "strain": ["1/2", "1-", "5/2+", "a:0"], "velocity": ["hammer", "gear", "a:1"]},
}
FLOORS = {
    "name": "floors",
    "system": {
        "type": "chain",
        "parts": [
            {"motion": "acceleration", "name": "ground"},
            {"rod": 1, "spring": "1/2", "dashpot": "1/10"},
            {"mass": 1, "name": "floor"},
            {"rod": 1, "dashpot": "1/5"},
            {"mass": 1, "name": "roof"},
            {"spring": 40},
            {"rod": "1/2", "speed": 2, "impedance": "1.001"},
        ],
    },
    "load": [{"at": "ground", "spacing": "0.3", "samples": [0, 1, "-1/2", 0]}],
    "output": {"until": 3, "displacement": ["roof"], "strain": ["9/4", "1-"], "velocity": ["2+", "floor"]},
}


def expected(scene: wavesym.Scene, table: dict[str, Any]) -> list[Terms]:
    """The outputs of a scene from its text."""
    made = Laplace(table, scene.output.until)
    return [made.terms(*output.name.split("@")) for output in scene.outputs]


def instants(terms: list[Terms], until: Fraction, most: int) -> list[float]:
    """Just before, at and just after arrivals, as doubles have them, and between them."""
    arrivals = sorted({arrival for each in terms for arrival in each.arrivals if arrival <= until})
    some = [arrivals[k * len(arrivals) // most] for k in range(most)] if len(arrivals) > most else arrivals
    late = [float(arrival) if float(arrival) >= arrival else math.nextafter(float(arrival), 9e9) for arrival in some]
    every = {math.nextafter(tau, way) for tau in late for way in (tau, -9e9, 9e9)} | {float(until), float(until) * 0.37}
    return sorted(tau for tau in every if 0 <= tau <= until)


def wrong_values(table: dict[str, Any], most: int = 5) -> list[tuple[str, float, float, arb]]:
    """Values that the reference does not round correctly."""
    scene = wavesym.Scene(**table)
    terms = expected(scene, table)
    taus = instants(terms, scene.output.until, most)
    found = []
    for output, each, values in zip(scene.outputs, terms, Reference(lower(scene)).values(taus), strict=True):
        for tau, value in zip(taus, values, strict=True):
            true = each.value(Fraction(tau))
            allowed = abs(value) * 2.0**-53 + 1e-24 if each.series else 0
            if not abs(true - value) <= allowed:
                found.append((output.name, tau, value, true))
    return found


def missed(table: dict[str, Any], tolerance: str = "1e-10") -> float:
    """By how much of its printed bound the generated NumPy program is wrong, at worst."""
    scene = wavesym.Scene(**{**table, "output": {**table["output"], "tolerance": tolerance}})
    terms = expected(scene, table)
    made = import_text(files(lower(scene), "numpy", "pieces")[f"{scene.name}.py"], "made")
    taus = instants(terms, scene.output.until, 6)
    assert float(tolerance) >= made.ERROR_BOUND
    worst = 0.0
    everywhere = np.abs(made.evaluate(np.array([*taus, *np.linspace(0, float(scene.output.until), 4001)])))
    for each, values, largest in zip(terms, made.evaluate(np.array(taus)), everywhere.max(axis=1), strict=True):
        true = [each.value(Fraction(tau)) for tau in taus]
        if not largest:
            assert all(value.contains(0) for value in true)
            continue
        far = max(float(abs(exact - float(value))) for exact, value in zip(true, values, strict=True))
        worst = max(worst, far / largest / made.ERROR_BOUND)
    return worst


@pytest.mark.quick(1)
@pytest.mark.parametrize("table", [STEPPED, FLOORS], ids=["stepped", "floors"])
def test_a_chain_is_right_to_the_last_bit(table: dict[str, Any]) -> None:
    assert wrong_values(table, most=8) == []


@settings(max_examples=8)
@given(chains(UNTIL))
def test_any_chain_is_right_to_the_last_bit(table: dict[str, Any]) -> None:
    assert wrong_values(table) == []


@settings(max_examples=12)
@given(chains(UNTIL))
def test_generated_programs_keep_their_bound(table: dict[str, Any]) -> None:
    assert missed(table) <= 1


@pytest.mark.parametrize("table", [STEPPED], ids=["stepped"])
def test_the_program_of_a_chain_keeps_its_bound(table: dict[str, Any]) -> None:
    assert missed(table) <= 1


ONE = {"system": {"type": "chain", "parts": [{"mass": 1, "name": "a"}, {"rod": 1}]}}


@pytest.mark.parametrize(
    ("load", "tau", "value"),
    [
        # q' + q = 1, until what is sent comes back from the free end: q' + q = 2 a
        ({"steps": [1]}, Fraction(1), 1 - (-arb(1)).exp()),
        ({"ramps": [1]}, Fraction(1), (-arb(1)).exp()),
        ({"steps": [1]}, Fraction(3), 1 - (-arb(3)).exp() + 2 * (1 - 2 * (-arb(1)).exp())),
    ],
)
def test_the_expansion_itself(load: dict[str, Any], tau: Fraction, value: arb) -> None:
    """A body at the end of a rod, by hand; poles of the first and second order."""
    made = Laplace({**ONE, "load": [{"at": "a", "times": [0], **load}]}, 4)
    assert abs(made.terms("velocity", "a").value(tau) - value) < 1e-14
