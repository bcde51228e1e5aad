"""What collocation allows for rounding is a bound of it, on panels whose polynomials miss nothing."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from wavesym.exact.reference import Reference, beginning
from wavesym.methods.quadrature import gauss
from wavesym.scene import Scene, lower
from wavesym.verification.collocation import integrate
from wavesym.verification.problem import corner_problem

UNIT = Fraction(1, 2**53)


@pytest.mark.quick(1)
@pytest.mark.parametrize("points", [24, 48])
@pytest.mark.parametrize("name", ["damped_building", "drive_m1", "geared_drive"])
def test_it_allows_what_rounding_does(name: str, points: int) -> None:
    model = lower(Scene.from_toml(name))
    exact = Reference(beginning(model))
    taus = np.linspace(0.0, exact.tau_max, 173)[:-1] + exact.tau_max / 977
    motion = integrate(corner_problem(model), exact.tau_max, points)
    errors = np.max(np.abs(motion.outputs(taus) - np.array(exact.values(taus.tolist()))), axis=1)
    assert np.all(errors <= motion.output_roundoff)
    assert np.all(motion.output_roundoff < 1e-12 * np.maximum(np.max(np.abs(motion.outputs(taus)), axis=1), 1.0))


@pytest.mark.parametrize("points", [6, 48])
def test_the_rule_of_gauss_is_rounded_once(points: int) -> None:
    """Powers are integrated over [0, 1], and from 0 to each point, as exactly as doubles have points and weights."""
    rule = gauss(points)
    nodes, weights = ([Fraction(value) for value in each.tolist()] for each in (rule.nodes, rule.weights))
    until = [[Fraction(value) for value in row] for row in rule.until.tolist()]
    for power in (0, 1, 5, points - 1):
        values = [node**power for node in nodes]
        assert abs(dot(weights, values) - Fraction(1, power + 1)) < 4 * UNIT
        for row, node in zip(until, nodes, strict=True):
            assert abs(dot(row, values) - node ** (power + 1) / (power + 1)) < 4 * UNIT


def dot(one: list[Fraction], other: list[Fraction]) -> Fraction:
    return sum((a * b for a, b in zip(one, other, strict=True)), Fraction(0))
