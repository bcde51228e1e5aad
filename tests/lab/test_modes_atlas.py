"""The curves of the atlas for modes: promises kept against tables in balls, finite elements, and the march."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from wavesym.exact.reference import Reference
from wavesym.lab.atlas import modal
from wavesym.lab.atlas.attempts import ROUNDED
from wavesym.lab.stability import FAMILIES
from wavesym.scene import lower


def quietly(_):
    pass


def broken_promises(family):
    return [point for point in family.points if point.error > point.bound + ROUNDED]


def slope(points):
    """How fast what is proved falls, from the middle of a curve to its end, as a power of the number of modes."""
    middle, last = points[len(points) // 2], points[-1]
    return math.log(last.bound / middle.bound) / math.log(last.x / middle.x)


# against the number of modes


def check_counts(family, within):
    """Strains fall as 1/n^2 at least, motion as 1/n^3 or faster."""
    assert not broken_promises(family)
    for panel in family.panels:
        slopes = [slope(family.curve(panel, name)) for name in ("acceleration@2", "force@0", "drift@1", "relative@2")]
        assert slopes[:2] == pytest.approx([-2, -2], abs=within)
        assert max(slopes[2:]) < -3


@pytest.mark.slow
def test_the_number_of_modes():
    check_counts(modal.mode_counts(quietly, spacings=[Fraction(5, 2)], digits=(1, 3, 4, 5)), within=0.1)


@pytest.mark.slow
def test_the_number_of_modes_as_drawn():
    check_counts(modal.mode_counts(quietly), within=0.1)


def test_a_bound_that_is_too_small_is_seen(monkeypatch):
    honest = modal.by_modes

    def boasting(model, taus):
        form, values = honest(model, taus)
        return replace(form, outputs=tuple(replace(one, bound=one.bound / 10**4) for one in form.outputs)), values

    monkeypatch.setattr(modal, "by_modes", boasting)
    family = modal.mode_counts(quietly, spacings=[Fraction(5, 2)], digits=(1, 3))
    assert broken_promises(family) == list(family.points)


# against damping


def check_damping(family):
    for panel in family.panels:
        modes, elements, doubt = (family.curve(panel, name) for name in (modal.MODES, modal.ELEMENTS, modal.DOUBT))
        for ours, theirs, unsure in zip(modes, elements, doubt, strict=True):
            assert ours.error <= ours.bound + unsure.error
            assert unsure.error < theirs.error
            assert unsure.error < 1e-8 or ours.x < 1 / 20


@pytest.mark.slow
def test_damping_as_drawn():
    check_damping(modal.damping(quietly))


def of_elements(ratio, panel=modal.ALL):
    scene = modal.shaken_building(
        modal.SPACING, modal.SAMPLES, modal.TOLERANCE, modal.damping_of(panel, ratio), drift=[1], relative=[2]
    )
    return lower(scene), modal.extrapolate(lower(scene))


@pytest.mark.slow
def test_what_is_extrapolated_is_right_within_its_own_curve():
    """Without damping there are tables in balls to tell."""
    model, found = of_elements(Fraction(0))
    right = np.array(Reference(model).values(found.taus.tolist()))
    sizes = np.abs(right).max(axis=1)
    assert modal.largest_error(found.limit, right, sizes) <= modal.largest_error(found.coarser, found.limit, sizes)


@pytest.mark.quick(1)
@pytest.mark.parametrize("panel", modal.PANELS)
def test_a_ratio_that_is_off_is_seen(panel):
    """By one part in 1000, far above what modes and elements differ by."""
    _, found = of_elements(Fraction(1, 20), panel)
    model, _ = of_elements(Fraction(1001, 20_000), panel)
    form, values = modal.by_modes(model, found.taus)
    assert modal.largest_error(values, found.limit, np.abs(found.limit).max(axis=1)) > 20 * form.error_bound


# against the spacing of a record


def check_spacings(family):
    assert not broken_promises(family)
    assert not any(point.refusal for point in family.curve("", "modes"))
    for march, hat in zip(family.curve("", "march"), family.curve("", "march of one hat"), strict=True):
        assert bool(march.refusal) == (march.x > 16)
        assert bool(hat.refusal) == (hat.x > 10**6)
        assert not hat.error > 1e-13


@pytest.mark.slow
def test_spacings_as_drawn():
    family = modal.spacings(quietly)
    check_spacings(family)
    assert "different remainders" in family.curve("", "march")[-1].refusal


def test_so_many_samples_are_a_whole_number_of_rods():
    parts = [modal.spacing(q) for q in modal.PARTS]
    assert [spacing.denominator for spacing in parts] == list(modal.PARTS)
    assert Fraction("4.995") in parts


def test_the_command_draws_them():
    assert {"modes", "damping", "spacings"} <= FAMILIES.keys()
