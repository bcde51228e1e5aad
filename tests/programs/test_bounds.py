"""No program errs by more than it says, in scenes drawn to be uncomfortable; `tests.support.attack` tries more."""

import pytest
from hypothesis import Phase, given, settings

from tests.support.attack import attack
from tests.support.scenes import as_toml, scenes

# the scene is printed whole; to shrink it would take minutes
DRAWN = {"phases": [Phase.generate], "report_multiple_bugs": False}


def check(scene, precision):
    missed = [str(outcome) for outcome in attack(scene, precision) if outcome.worst > 1]
    assert not missed, "\n".join([*missed, as_toml(scene)])


@settings(max_examples=3, **DRAWN)
@given(scenes("double", longest=False))
def test_doubles_hold_their_bounds(scene):
    check(scene, "double")


@settings(max_examples=3, **DRAWN)
@given(scenes("single", longest=False))
def test_floats_hold_their_bounds(scene):
    check(scene, "single")


@pytest.mark.slow
@settings(max_examples=40, **DRAWN)
@given(scenes("double"))
def test_many_doubles_hold_their_bounds(scene):
    check(scene, "double")


@pytest.mark.slow
@settings(max_examples=40, **DRAWN)
@given(scenes("single"))
def test_many_floats_hold_their_bounds(scene):
    check(scene, "single")
