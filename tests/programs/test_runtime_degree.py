"""The degree of parameters at run time: the first whose march misses nothing from the start on, judged anew here."""

import numpy as np
import pytest
from flint import fmpq
from numpy.polynomial import chebyshev

from tests.support.marches import scheme_of
from tests.support.shaken import SAMPLES
from wavesym import Scene, model
from wavesym.errors import CostError
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.march.plan import march_plan
from wavesym.programs.march.space import BODY
from wavesym.programs.request import Request
from wavesym.programs.runtime import degree as choosing
from wavesym.programs.runtime.degree import LEAST, degrees
from wavesym.programs.runtime.making import runtime_program
from wavesym.programs.runtime.network import free_network
from wavesym.programs.runtime.plan import as_one_load, runtime_plan
from wavesym.programs.schemes.march import Marching
from wavesym.scene import lower

# found among 600 drawn scenes: only windows far from the start miss anything at degree 27
NARROW = lower(
    Scene(
        name="narrow",
        system={
            "type": "drive",
            "m": 3,
            "kappa": ["711/10000", "161/5000", "8393/400"],
            "inertia": ["15067/1250", "10357/2000", "7111/5000", "195601/5000"],
        },
        load=[{"body": 1, "times": [0, "5/4"], "steps": [1, -1]}],
        output={"until": "323/7", "tolerance": "1e-6", "velocity": ["1/2"]},
    )
)
STIFF = lower(
    Scene(
        name="stiff",
        system={"type": "building", "m": 2, "kappa": [1, 60, "1/3"], "base": "ground"},
        load=[{"spacing": "3/4", "samples": SAMPLES}],
        output={"until": 18, "drift": [1]},
    )
)
BRANCHED = lower(Scene.from_toml("stepped_shaft").with_({"output.until": 6}))
COLLISION = Scene.from_toml("collision_m4").with_({"output.until": 4})


def missed(plan, degree):
    """Of each window what its polynomials miss of the integral of their law, relative to the largest wave so far.

    The velocity of a body is a sum of waves; integrated, its law gives it, but for one term beyond the degree.
    """
    scheme = scheme_of(plan, degree)
    block = Marching(scheme, plan.windows).block(0, plan.windows)
    waves, first = block.waves, scheme.deepest
    total = np.zeros(plan.windows)
    for joint in plan.joints:
        space = joint.space
        for p, panel in enumerate(plan.panels if space.law == BODY else ()):
            arrived = [waves[first - (back := plan.tracks[t].steps) : len(waves) - back, t, p] for t in joint.arrive]
            speed = (waves[first:, joint.sends[0], p] + arrived[0]) / float(space.ports[0].ratio)
            acting = sum(float(port.push) * a for port, a in zip(space.ports, arrived, strict=True))
            law = float(space.rates[0, 0]) * speed + float(space.input_rates[0, 0]) * acting
            bent = float(panel.length) / 2 * chebyshev.chebint(law, axis=-1)
            # loads, which do not arrive, are parabolas
            np.testing.assert_allclose(bent[:, 4:-1], speed[:, 4:], rtol=0, atol=1e-13 * np.max(np.abs(waves)))
            total += np.abs(bent[:, -1])
    means = np.max(np.abs(waves[first:, ..., 0]), axis=(1, 2))
    sizes = np.maximum.accumulate(np.maximum(means, np.max(np.abs(block.starts), axis=(1, 2))))
    return total / np.where(sizes > 0, sizes, 1)


def first_that_misses_nothing(plan, share):
    degree = LEAST
    while np.max(missed(plan, degree)) > share:
        degree += degree // 4
    return degree


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("model", "share", "expected"),
    [(NARROW, 1e-6 / (24 * 47), 33), (STIFF, 1e-13, None), (STIFF, 1e-5, None), (BRANCHED, 1e-12, None)],
    ids=["narrow", "stiff", "roughly", "branched"],
)
def test_it_is_the_first_degree_that_misses_nothing(model, share, expected):
    plan = march_plan(model, DOUBLE)
    degree = first_that_misses_nothing(plan, share)
    assert choosing._enough(plan, LEAST, share) == degree > LEAST
    assert degree == (expected or degree)


def test_every_window_counts():
    """At the degree before all that begins is fine: only late windows miss more than their share."""
    share = 1e-6 / (24 * 47)
    late = missed(march_plan(NARROW, DOUBLE), 27) > share
    assert late.any()
    assert not late[:20].any()


def test_a_window_misses_what_is_said_of_it():
    """To a hair of it one window or another misses too much, or none does."""
    plan = march_plan(STIFF, DOUBLE)
    for degree in (LEAST, 12, 20):
        most = np.max(missed(plan, degree))
        assert choosing._misses(plan, degree, 0.999999 * most)
        assert not choosing._misses(plan, degree, 1.000001 * most)


def planned(scene, names):
    model = lower(scene)
    return runtime_plan(model, free_network(model, names, ()), as_one_load(model), DOUBLE)


@pytest.mark.parametrize(
    ("scene", "names"), [(COLLISION, ("kappa",)), (Scene.from_toml("stepped_shaft"), ("mass",))], ids=["named", "parts"]
)
def test_lighter_bodies_need_no_lower_degree(scene, names):
    made, share, tolerance = planned(scene, names), 1e-10, fmpq(1, 10**8)
    found = [degrees(made, share, tolerance, most and fmpq(most)) for most in (None, 1, 4, 16)]
    assert len({each.first for each in found}) == 1
    largest = [each.largest for each in found]
    assert largest == sorted(largest)
    assert largest[0] < largest[-1]
    for light in choosing._light(made, fmpq(16)):
        rates = [joint.space.rate for joint in light.joints if joint.space.law == BODY]
        assert len(set(rates)) > 1 or len(rates) == 1 or rates[0] >= 16
        assert np.max(missed(light, largest[-1])) <= share


@pytest.mark.parametrize(
    ("asked", "found"), [(None, fmpq(2)), (fmpq(1, 100), fmpq(1, 5)), (fmpq(3), fmpq(3))], ids=["usual", "less", "more"]
)
def test_it_is_enough_for_the_scene_itself(asked, found):
    assert choosing.largest_kappa(planned(COLLISION, ("kappa",)), asked) == found
    assert choosing.largest_kappa(planned(COLLISION, ("velocity",)), asked) is None


def test_bodies_that_move_together_may_be_given_other_velocities():
    """Nothing moves against anything in the scene, and no degree would be too low."""

    def degree(velocity):
        scene = COLLISION.with_({"system.velocity": velocity})
        request = Request(runtime=("kappa", "velocity"))
        return runtime_program(lower(scene), request, ()).constants["degree"]

    assert np.max(missed(planned(COLLISION.with_({"system.velocity": [1, 1]}), ("kappa",)).own, LEAST)) < 1e-15
    assert degree([1, 1]) >= degree([1, "-1/2"]) > LEAST


def test_whose_rates_are_too_much_is_said(monkeypatch):
    monkeypatch.setattr(choosing, "_HIGHEST", 40)
    with pytest.raises(CostError, match=r"^output.until: rates to 100 for kappa up to 100 need polynomials of degree"):
        model(Scene.from_toml("drive_m1"), ["kappa"])
    plan = march_plan(NARROW, DOUBLE)
    monkeypatch.setattr(choosing, "_HIGHEST", 20)
    with pytest.raises(
        CostError,
        match=r"^output.until: rates to [\d.]+ need .* the limit is .* \(a shorter horizon helps\)$",
    ):
        choosing._enough(plan, LEAST, 1e-12)
