"""The curves of the atlas for chains that are written out: against counts, closed forms and matrix exponentials."""

import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import expm

from wavesym.exact.contacts.events import events
from wavesym.lab.atlas import chains, evaluators
from wavesym.lab.atlas.attempts import ROUNDED
from wavesym.lab.atlas.scenes import TOLERANCE
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import lower


def quietly(_):
    pass


def served(family, curve="pieces"):
    """The points of a curve that would be used; none of them breaks its promise."""
    points = [point for point in family.points if point.curve == curve and not point.refusal]
    assert all(point.error <= min(point.bound, TOLERANCE) + ROUNDED for point in points)
    return points


@pytest.mark.parametrize("gap", [Fraction(1), Fraction(1, 3), Fraction(1, 1000), Fraction(1, 10**18)])
def test_knots_are_the_ways_back_and_forth(gap):
    """The middle mass is met at 0, when all begins, and at 1 + 2 i + 2 j (1 + gap)."""
    ways = {1 + 2 * i + 2 * j * (1 + gap) for i in range(10) for j in range(10)}
    model = lower(evaluators.nearly_equal(gap))
    assert evaluators.most_breakpoints(model) == 1 + sum(way <= evaluators.LENGTHS_UNTIL for way in ways)


def test_steps_of_a_common_grid():
    counts = [
        evaluators.common_steps(lower(evaluators.nearly_equal(Fraction(gap)))) for gap in ("1", "1/2", "1/1000", "0")
    ]
    assert counts == [20, 40, 20_000, 20]


def test_lengths():
    family = evaluators.lengths(quietly, gaps=[Fraction(1, 2), Fraction(0)])
    assert len(served(family)) == 2


@pytest.mark.parametrize("ratio", [Fraction(1, 10**6), Fraction(1), Fraction(1000)])
def test_a_spring_swings_as_it_should(ratio):
    """Until the wall is felt, at tau = 2, the rod is a dashpot of 1: a matrix exponential, in doubles."""
    k = float(ratio)
    matrix = np.zeros((5, 5))  # velocities, displacements, and 1 for the force
    matrix[0, 2:] = -k, k, 1
    matrix[1, :4] = 0, -1, k, -k
    matrix[2, 0] = matrix[3, 1] = 1
    taus = np.linspace(0.1, 1.9, 7)
    begin = np.array([0, 0, 0, 0, 1.0])
    truth = np.array([(expm(matrix * tau) @ begin)[:2] for tau in taus]).T
    program = make(lower(evaluators.sprung_masses(ratio)), Request(evaluator="pieces"))
    np.testing.assert_allclose(program.evaluate(taus)[1:], truth, rtol=0, atol=3e-10)


@pytest.mark.slow
def test_stiffness():
    family = evaluators.stiffness(quietly, exponents=(-6, 0, 3))
    assert len(served(family)) == 3


@pytest.mark.parametrize("gap", [Fraction(1), Fraction(-1), Fraction(1, 10**8), Fraction(-1, 10**18), Fraction(0)])
def test_echoes_are_powers_of_the_reflection(gap):
    """Each to a bit or two of its own size, however small it is beside the pulse."""
    rho = gap / (2 + gap)
    for echo, power in zip(evaluators.echoes(1 + gap), (1, 2), strict=True):
        assert echo == pytest.approx(float(abs(rho) ** power), rel=2.0**-51, abs=0)


def test_dashpots():
    family = evaluators.dashpots(quietly, gaps=[Fraction(1, 10**6), Fraction(0)])
    assert len(served(family)) == 4
    assert [point.error for point in family.points if "echo" in point.curve and point.x == 0] == [0] * 4


def test_a_dropped_bar_meets_the_ground_when_it_should():
    """In its own frame: gap 1/2, acceleration 1/9, so 3; a wave there and back, 2; free, a whole period is 16."""
    found = events(lower(chains.dropped_bar(40)))
    instants = [3, 5, 11, 13]
    assert [event.double for event in found] == [at + 16 * k for k in range(3) for at in instants if at + 16 * k <= 40]
    assert chains.widths(found) == [0.0] * len(found)


def test_contacts():
    family = chains.contacts(quietly, {"wagons": chains.wagons(12)})
    widths, radii = (family.curve("wagons", name) for name in (chains.WIDTH, chains.RADIUS))
    assert [point.error for point in widths[:2]] == [0, pytest.approx(2.0**-254)]
    assert max(point.error for point in widths) < 2.0**-220
    assert 0 < radii[1].error < 2.0**-370 < radii[-1].error < 2.0**-220
    kept = served(family, chains.PIECES)
    assert len(kept) == len(widths) > 8
    assert [point.error for point in kept] == sorted(point.error for point in kept)


@pytest.mark.slow
def test_every_refusal_has_its_reason():
    panels = {name: (scene, places[:2]) for name, (scene, places) in chains.REFUSALS.items()}
    family = chains.refusals(quietly, panels)
    assert len(served(family)) == 8
    assert all(math.isnan(point.error) <= bool(point.refusal) for point in family.points)


@pytest.mark.slow
def test_knots_without_end_are_refused_in_no_time():
    scene, places = chains.REFUSALS["horizon, lengths 1, 1.414213562 and 1.732050808"]
    family = chains.refusals(quietly, {"horizon": (scene, places[-1:])})
    assert "fronts meet joints" in family.curve("horizon", "pieces")[0].refusal
