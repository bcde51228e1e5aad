"""The atlas: every curve held to its promise, every guard forced, pictures that are the same for the same numbers."""

import math

import pytest

import wavesym
from wavesym.coefficients.table import MOST_COEFFICIENTS
from wavesym.errors import CostError, ToleranceError
from wavesym.evaluators.choice import choose
from wavesym.evaluators.motion import MOST_WINDOWS
from wavesym.report.atlas import endurance, extremes, fronts, gaps, limits, reflections
from wavesym.report.atlas.drawing import draw
from wavesym.report.atlas.family import Axis, Family, Point, to_csv
from wavesym.report.saving import save


def quiet(_):
    """No progress."""


def outside(family):
    """The points whose error is above what was proved for them."""
    return [point for point in family.points if point.error > point.bound * (1 + 1e-6)]


@pytest.mark.slow
def test_reflections():
    family = reflections.family(quiet)
    assert outside(family) == []
    for panel in family.panels:
        closed = family.curve(panel, "closed")
        assert max(point.error for point in closed) > 1e-3  # the picture shows it fail
        assert all(point.refused for point in closed if not point.bound <= 1e-10)
        assert all(point.bound <= 1e-10 for point in family.curve(panel, "pieces") if not point.refused)


@pytest.mark.slow
def test_gaps():
    family = gaps.family(quiet)
    assert outside(family) == []
    for panel in family.panels:
        assert family.x.zero in {point.x for point in family.points if point.panel == panel}  # rates that are equal
        assert max(point.error for point in family.curve(panel, "closed")) > 1e-3
        assert max(point.error for point in family.curve(panel, "pieces")) < 1e-12


@pytest.mark.slow
def test_extreme_kappa():
    family = extremes.family(quiet)
    assert outside(family) == []
    assert all(point.refused or point.error < 1e-10 for point in family.points)


@pytest.mark.slow
def test_the_limit_of_lumped_masses():
    """O(kappa) for the drive, O(sqrt kappa) for the collision, never for rod 1 on a pushed base."""
    family = limits.family(quiet)

    def order(name):
        (curve,) = [c for c in family.curves(family.panels[0]) if c.startswith(name)]
        coarse, fine = family.curve(family.panels[0], curve)[-2:]
        return math.log(coarse.error / fine.error) / math.log(coarse.x / fine.x)

    assert order("drive") == pytest.approx(1, abs=0.05)
    assert order("collision") == pytest.approx(0.5, abs=0.1)
    assert order("building, base force, rod 1") == pytest.approx(0, abs=0.05)


@pytest.mark.slow
def test_rivals_at_fronts():
    family = fronts.family(quiet)
    (near,) = [panel for panel in family.panels if panel.startswith("at fronts")]
    best = {curve: min(point.error for point in family.curve(near, curve)) for curve in family.curves(near)}
    assert best["central differences"] > 1e-2  # these never converge there
    assert best["modal superposition"] > 1e-2
    assert min(error for curve, error in best.items() if curve.startswith("characteristics")) < 1e-6


@pytest.mark.slow
def test_the_march_to_1e5():
    family = endurance.family(quiet)
    for panel in family.panels:
        used = [point for point in family.points if point.panel == panel and not point.refused]
        assert used
        assert outside(family) == []
        assert max(point.error for point in used) < 1e-11
        low = [point for point in family.curve(panel, "error") if point.refused]
        assert max(point.error for point in low) > 1e-7  # and the program said so


def drive(until, kappa="1/2", tolerance="1e-10"):
    system = {"type": "drive", "m": 1, "kappa": [kappa], "inertia": [1, 2]}
    load = [{"body": 1, "times": [0], "steps": [1]}]
    output = {"until": until, "tolerance": tolerance, "strain": ["1/2"]}
    return wavesym.Scene(name="drive", system=system, load=load, output=output)


def test_guards_that_know_their_bound():
    for name, scene in (
        ("closed", drive(60)),
        ("pieces", drive(20, tolerance="1e-17")),
        ("march", drive(500, tolerance="1e-13")),
    ):
        with pytest.raises(ToleranceError, match=f"{name}: "):
            choose(scene, name)


def test_guards_that_count_the_cost_first():
    with pytest.raises(CostError, match="coefficients"):
        choose(drive(MOST_COEFFICIENTS), "closed")
    with pytest.raises(CostError, match="windows"):
        choose(drive(MOST_WINDOWS), "pieces")
    with pytest.raises(CostError, match="degree"):
        choose(drive(1000, kappa=10**7), "march")


def test_the_same_numbers_make_the_same_bytes(tmp_path):
    points = tuple(Point("panel", curve, x, error, 1e-3) for curve in ("a", "b") for x, error in ((1, 1e-4), (2, 1e-9)))
    family = Family("name", "title", Axis("x"), "y", points)
    for name in ("one.svg", "two.svg"):
        save(draw(family), tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()
    assert to_csv(family).splitlines()[1] == "panel,a,1,0.0001,0.001,"
