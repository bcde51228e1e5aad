"""No program errs by more than it says, in scenes drawn to be uncomfortable; `tests.support.attack` tries more."""

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from tests.support.attack import attack
from tests.support.scenes import as_toml, scenes

# whole scenes are printed; to shrink one would take minutes
PHASES = [Phase.explicit, Phase.generate]


def holds(scene, precision):
    missed = [str(outcome) for outcome in attack(scene, precision) if outcome.worst > 1]
    assert not missed, "\n".join([*missed, as_toml(scene)])


@settings(max_examples=8, phases=PHASES)
@given(scenes("double", longest=False))
def test_doubles_hold_their_bounds(scene):
    holds(scene, "double")


@settings(max_examples=8, phases=PHASES)
@given(scenes("single", longest=False))
def test_floats_hold_their_bounds(scene):
    holds(scene, "single")


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["double", "single"])
def test_many_programs_hold_their_bounds(precision):
    @settings(max_examples=150, phases=PHASES, suppress_health_check=[HealthCheck.nested_given])
    @given(scenes(precision))
    def test(scene):
        holds(scene, precision)

    test()
