"""The atlas: every curve keeps its promise, every guard can be made to refuse, and what is compared with is right.

What is slow runs the curves as `wavesym stability` draws them.
"""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx, fmpq

from wavesym.cli import main
from wavesym.errors import CostError, ToleranceError
from wavesym.exact.motion import MOST_STRETCHES, Motion
from wavesym.exact.tables.ball import Balls, segments
from wavesym.exact.tables.signal import signals
from wavesym.lab import stability
from wavesym.lab.atlas import evaluators, other_methods
from wavesym.lab.atlas.attempts import ROUNDED, truth
from wavesym.lab.atlas.drawing import draw
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, to_csv
from wavesym.lab.atlas.scenes import TOLERANCE, atlas_scene, drive, with_tolerance
from wavesym.methods import characteristics, differences, discrete, elements, laplace
from wavesym.methods.advice import springs
from wavesym.pictures.saving import save
from wavesym.programs import pieces
from wavesym.programs.choice import choose
from wavesym.scene import lower


def quietly(_):
    pass


def of(family, curve, valued=True):
    return [point for point in family.points if point.curve == curve and not (valued and math.isnan(point.error))]


def broken_promises(family):
    """Points whose error is above what was proved, and points that would be used and have no good value."""
    above = [point for point in family.points if point.error > point.bound + ROUNDED]
    wrong = [point for point in family.points if not point.refusal and not point.error <= TOLERANCE]
    return above + wrong


def closed_fails(family):
    return max(point.error for point in of(family, "closed")) > 1e-3


# reflections and gaps of rates


def test_reflections():
    family = evaluators.reflections(quietly, kappas=[Fraction(1, 2)], counts=(1, 5, 10, 30))
    assert not broken_promises(family)
    assert closed_fails(family)
    assert not any(point.refusal for point in of(family, "pieces"))
    assert [bool(point.refusal) for point in of(family, "closed")] == [False, False, True, True]


@pytest.mark.slow
def test_reflections_as_drawn():
    family = evaluators.reflections(quietly)
    assert not broken_promises(family)
    for panel in family.panels:
        closed = family.curve(panel, "closed")
        assert closed[0].error < 1e-15
        assert closed[-1].error > 1e3
        assert not any(point.refusal for point in family.curve(panel, "pieces"))
        assert max(point.error for point in family.curve(panel, "march")) < TOLERANCE


def check_gaps(family):
    assert not broken_promises(family)
    assert not any(point.refusal for point in of(family, "pieces"))
    for panel in family.panels:
        *near, merged = family.curve(panel, "closed")
        assert max(point.error for point in near if not math.isnan(point.error)) > 1e3
        assert merged.x == 0
        assert merged.error < 1e-10


def test_gaps():
    check_gaps(
        evaluators.gaps(quietly, gaps=[Fraction(1), Fraction(1, 10**6), Fraction(1, 10**16), Fraction(0)], counts=[5])
    )


@pytest.mark.slow
def test_gaps_as_drawn():
    check_gaps(evaluators.gaps(quietly))


@pytest.mark.parametrize("gap", [Fraction(0), Fraction(1, 10**16)])
def test_tables_are_exact_whatever_the_gap(gap):
    """Against power series, which know no rates, to 30 digits: far more than 1e-16 or its powers leave of doubles."""
    scene = drive([Fraction(1), Fraction(1, 2) + gap], [1, 2, 1], 6)
    (signal,) = signals(lower(scene))
    motion = Motion(lower(scene), fmpq(6))
    with ctx.workprec(1200):  # the tables have powers of 1e16
        tables, series = Balls(segments(signal, ctx.prec)), Balls(motion.segments(motion.probes[0], ctx.prec))
        for k in range(1, 48):
            difference = tables.evaluate(fmpq(k, 8)) - series.evaluate(fmpq(k, 8))
            assert difference.contains(0)
            assert difference.rad() < arb(fmpq(1, 10**30))


# extreme kappa


def test_extreme_kappa():
    family = evaluators.kappa(quietly, exponents=(-6, 0, 2, 6))
    assert not broken_promises(family)
    assert all(math.isnan(point.error) for point in of(family, "march", valued=False) if point.x == 1e6)
    assert [point.refusal for point in of(family, "closed")][1:] == ["", "", ""]


@pytest.mark.slow
def test_extreme_kappa_as_drawn():
    family = evaluators.kappa(quietly)
    assert not broken_promises(family)
    assert not any(point.refusal for point in of(family, "pieces"))


# the limit kappa -> 0


ORDERS = {
    "drive": (1, 0.05),
    "collision": (0.5, 0.1),
    "building on moving ground": (1, 0.05),
    "building, base force, rod 1": (0, 0.05),
    "building, base force, rod 2": (1, 0.05),
}


@pytest.mark.slow
def test_orders_of_the_limit_of_masses_and_springs():
    check_orders(other_methods.springs(quietly, kappas=other_methods.KAPPAS[2:4]))


@pytest.mark.slow
def test_orders_as_drawn():
    check_orders(other_methods.springs(quietly))


def check_orders(family):
    found = other_methods.orders(family.points)
    assert len(found) == len(ORDERS)
    for (name, (order, within)), (shown, slope) in zip(ORDERS.items(), found.items(), strict=True):
        assert shown.startswith(name)
        assert slope == pytest.approx(order, abs=within)
    # rod 1 swings between 0 and twice the mean, as numerics section 7 has it
    assert [point.error for point in family.points if "rod 1" in point.curve][-1] == pytest.approx(1, abs=0.05)


def test_masses_and_springs_swing_as_they_should():
    """Two equal discs: s'' = -2 kappa s - kappa; a foundation that is pushed strains rod 1 by a/kappa_0 at once."""
    t, two = springs(lower(drive([Fraction(1, 50)], [1, 1], 40)), 0.0)
    np.testing.assert_allclose(two[0], (np.cos(np.sqrt(2 / 50) * t) - 1) / 2, atol=1e-12)
    system = {"type": "building", "m": 2, "kappa": ["1/4", "1/5", "1/5"], "base": "force"}
    pushed = atlas_scene(system, [{"times": [0], "a": [1], "b": [0]}], 4, strain=["1/2"])
    np.testing.assert_allclose(np.abs(springs(lower(pushed), 0.0)[1]), 4, rtol=1e-12)


# other methods at fronts


@pytest.mark.slow
def test_other_methods_at_fronts():
    known = truth(other_methods.jumping(), per_unit=40, around=other_methods.AROUND)
    for method, resolution, part in (
        (elements.NEWMARK, 200, 1 / 3),
        (differences.METHOD, 500, 1e-4),
        (discrete.MODAL, 50, 1 / 2),
        (laplace.METHOD, 3000, 1e-4),
    ):
        at, away = other_methods.errors(method, resolution, known)
        assert at > 0.1
        assert away < part * at
    assert max(other_methods.errors(characteristics.FOURTH, 500, known)) < 1e-9


@pytest.mark.slow
def test_other_methods_as_drawn():
    """Four of six never converge at a front, and the others do; the title counts them."""
    family = other_methods.fronts(quietly)
    assert "4 of 6" in family.title
    last = {name: family.curve(other_methods.AT, name)[-1].error for name in family.curves(other_methods.AT)}
    assert len(last) == 6
    assert sum(error > 0.1 for error in last.values()) == 4
    assert sum(error < 1e-6 for error in last.values()) == 2


# guards: each evaluator refuses outside its proven range


def guarded(until, kappa="1/2", tolerance="1e-10"):
    scene = drive([Fraction(kappa)], [1, 2], until)
    return with_tolerance(scene, Fraction(tolerance))


@pytest.mark.parametrize(
    ("name", "scene", "why"),
    [
        ("closed", guarded(60), "closed: loses all digits after tau = "),
        ("pieces", guarded(20, tolerance="1e-17"), "pieces: rounding leaves"),
        ("march", guarded(500, tolerance="1e-13"), "march: rounding leaves"),
    ],
    ids=["closed", "pieces", "march"],
)
def test_guards_that_know_their_bound(name, scene, why):
    with pytest.raises(ToleranceError, match=why):
        choose(lower(scene), name)


@pytest.mark.parametrize(
    ("name", "scene", "why"),
    [
        ("closed", guarded(10**7), "coefficients"),  # of the tables
        ("pieces", guarded(MOST_STRETCHES), "stretches"),
        ("march", guarded(1000, kappa="1e7"), "degree"),
    ],
    ids=["tables", "stretches", "march"],
)
def test_guards_that_count_the_cost_first(name, scene, why):
    with pytest.raises(CostError, match=why):
        choose(lower(scene), name)


def test_pieces_refuse_tables_that_are_too_large(monkeypatch):
    choose(lower(guarded(6)), "pieces")
    monkeypatch.setattr(pieces, "MOST_BYTES", 1000)
    with pytest.raises(CostError, match="pieces would take"):
        choose(lower(guarded(6)), "pieces")


# pictures, tables and the command


FAMILY = CurveFamily(
    "example",
    "An example",
    Axis("gap", zero=1e-5, falling=True),
    "error",
    (
        AtlasPoint("one", "closed", 1.0, 1e-12, 1e-11),
        AtlasPoint("one", "closed", 0.1, 1e3, math.inf, "closed: loses all digits"),
        AtlasPoint("one", "closed", 0.01, math.nan, math.inf, "too costly"),
        AtlasPoint("one", "closed", 0.0, 1e-15, 1e-14),
        AtlasPoint("two", "pieces", 1.0, 0.0, 1e-15),
    ),
)


@pytest.mark.slow
def test_the_same_numbers_make_the_same_bytes(tmp_path):
    for name in ("first.svg", "second.svg"):
        save(draw(FAMILY), tmp_path / name)
    first = (tmp_path / "first.svg").read_text()
    assert first == (tmp_path / "second.svg").read_text()
    assert "<dc:date>" not in first


def test_a_table_has_what_is_drawn():
    lines = to_csv(FAMILY).splitlines()
    assert lines[0] == "panel,curve,x,error,bound,refused"
    assert lines[1] == "one,closed,1,1e-12,1e-11,"
    assert lines[2] == "one,closed,0.1,1e+03,,closed: loses all digits"
    assert lines[3] == "one,closed,0.01,,,too costly"
    assert len(lines) == 1 + len(FAMILY.points)


def test_the_command_writes_a_picture_and_a_table_for_each_family(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(stability, "FAMILIES", {"example": lambda progress: progress("at work") or FAMILY})
    assert main(["stability", "-o", str(tmp_path / "atlas")]) == 0
    written = capsys.readouterr()
    assert [line.rpartition("/")[2] for line in written.out.splitlines()] == ["example.svg", "example.csv"]
    assert written.err == ""  # progress is for terminals
    assert {path.name for path in (tmp_path / "atlas").iterdir()} == {"example.svg", "example.csv"}
