"""The curves of the atlas for parameters at run time: bounds are kept, and light bodies refused."""

from fractions import Fraction

import pytest

from wavesym.lab.atlas import runtime
from wavesym.lab.stability import FAMILIES


def quietly(_):
    pass


def check(family):
    """No error is larger than what is proved, and where there is a value there is an estimate."""
    errors, estimates = ([point for point in family.points if point.curve == name] for name in ("error", "estimate"))
    assert [point.x for point in errors] == [point.x for point in estimates]
    for error, estimate in zip(errors, estimates, strict=True):
        if error.refusal:
            assert error.refusal == "bodies too light"
            assert not error.error <= 1
        else:
            assert error.error <= error.bound < 1e-6
            assert error.error <= estimate.error
    return errors


@pytest.mark.slow
def test_against_kappa():
    errors = check(runtime.by_kappa(quietly, [Fraction(1, 1000), Fraction(3), Fraction(1000)], [1]))
    assert [bool(point.refusal) for point in errors] == [False, False, True]


@pytest.mark.slow
def test_against_reflections():
    short, long = check(runtime.by_reflections(quietly, [Fraction(1)], [2, 50]))
    assert short.bound < long.bound


def test_the_atlas_has_them():
    assert {"runtime_kappa", "runtime_reflections"} <= set(FAMILIES)
