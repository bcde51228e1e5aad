"""How near true waves are to polynomials: the jumps of their derivatives, and what interpolation misses of them."""

from dataclasses import replace
from fractions import Fraction
from math import factorial, log, sqrt

import numpy as np
import pytest
from flint import ctx, fmpq_series

from tests.support.truth import Truth
from wavesym.numbers.doubles import fraction, nearest, rational
from wavesym.programs.march import bound as bounds
from wavesym.programs.march import tail as tails
from wavesym.programs.march.bound import smoothness
from wavesym.programs.march.plan import march_plan
from wavesym.programs.march.tail import Tail, tail_of
from wavesym.scene import Scene, lower

ALL = {"times": [0, "1/3"], "a": [1, "-1/2"], "b": ["3/2", 1]}


def building(until=3, load=ALL, base="ground", kappa=(1, "1/2", 3), **outputs):
    return Scene(
        name="made",
        system={"type": "building", "m": 2, "kappa": kappa, "base": base},
        load=[load],
        output={"until": until, "tolerance": "1e-3", **(outputs or {"strain": [0]})},
    )


def rate_of(plan):
    return max(joint.space.norm for joint in plan.joints)


def jumps_of(plan):
    return list(bounds._jumps(plan, rate_of(plan)))


def test_jumps_are_those_of_loads_and_start() -> None:
    """A ground of velocity b + c tau + ... sends as much, a force on a light base half as much."""
    assert jumps_of(march_plan(lower(building()))) == pytest.approx([0, 1 + 1 / 2, (3 / 2 + 1) / 2 * 2], rel=1e-9)
    # a second load of an opposite kind changes what is new, not what was there
    assert jumps_of(march_plan(lower(building(base="force")))) == pytest.approx([1.5, 2.5, 0], rel=1e-9)
    bars = {"type": "collision", "m": 4, "kappa": [1, 2], "velocity": [1, "-1/2"]}
    (begun, *none) = jumps_of(march_plan(lower(Scene(name="made", system=bars, output={"until": 1, "strain": [2]}))))
    # where they touch waves of 1/2 and -1/4 meet: each side sends 3/4 less, or more, than it did
    assert begun == pytest.approx(sqrt(2) * 3 / 4, rel=1e-9)
    assert none == [0, 0]


@pytest.mark.parametrize("mass", [3, "1/5"])
@pytest.mark.parametrize(("moved", "rods"), [(1, 0), (1, 1), (2, -1)])
def test_a_body_jumps_by_what_it_is_faster_than_its_rods_and_by_what_acts(mass, moved, rods) -> None:
    """Of impedance S = 1 + 2 in all; in the root of energy, of which g r makes what jumps in the next derivative.

    If it is faster by v, rods are sent sqrt(S) v more than they had, and M q' = -S v is sqrt(S) g v of x, g = S/M, half
    of which goes on. A force of 1 makes q' jump by 1/M, as a wave that arrives would of 2 g sqrt(S) times its size.
    """
    one, other = ({"rod": 1, "impedance": z, "velocity": rods} for z in (1, 2))
    parts = [one, {"mass": mass, "velocity": moved, "name": "b"}, other, "absorbing"]
    load = [{"at": "b", "times": [0], "steps": [1]}]
    system, output = {"type": "chain", "parts": parts}, {"until": "1/2", "velocity": ["b"]}
    plan = march_plan(lower(Scene(name="made", system=system, load=load, output=output)))
    acts, rate = 1 / (2 * sqrt(3)), rate_of(plan)
    assert rate == pytest.approx(3 / float(Fraction(mass)), rel=1e-9)
    wanted = [acts + 3 / 2 * sqrt(3) * abs(moved - rods), 0, 0]
    assert jumps_of(plan) == pytest.approx(wanted, rel=1e-9)


def grown(rate, crossings, jumps, order):
    """[x^order] of s(x) after so many crossings and two more, each G times as much."""
    ctx.cap, before = order + 1, ctx.cap
    try:
        x = fmpq_series([0, rational(rate)])
        passed, total = (1 + x) / (1 - x), fmpq_series([rational(jump) for jump in jumps])
        for _ in range(crossings + 2):
            total *= passed
        return nearest(total[order])
    finally:
        ctx.cap = before


SHAFTS = Scene(
    name="made",
    system={"type": "drive", "m": 2, "kappa": [1, "1/20"], "inertia": [1, 1, 3]},
    load=[{"body": 1, "times": [0, "1/3"], "steps": [1, 1]}],
    output={"until": 5, "strain": [0]},
)


@pytest.mark.parametrize(
    "scene", [building(1), building(3), building("59/2"), building(9, kappa=(1, "1/9", "1/20")), SHAFTS]
)
def test_the_tail_is_that_of_its_derivatives_and_the_degree_the_least(scene) -> None:
    """Once more by power series, exact; the tail that is claimed is above it, as it takes any r for the best one."""
    plan = march_plan(lower(scene))
    smooth, jumps, rate = smoothness(plan, 0), jumps_of(plan), rate_of(plan)
    assert smooth.size <= 2.0**-80 * sum(jumps)

    def claimed(degree):
        k = degree + 1
        added = (plan.windows + 2) * 2 / sqrt(2 * rate)
        energies = [added * grown(rate, plan.crossings, jumps, order) for order in (k, k + 1)]
        return 2 * (2 / 3 / 4) ** k / factorial(k) * (energies[0] / sqrt(1 / 3) + energies[1] * sqrt(2 / 3))

    exact = claimed(smooth.degree)
    assert exact <= smooth.size <= 600 * exact
    # a few degrees less would not have been enough
    assert claimed(smooth.degree - 4) * 600 > 2.0**-80 * sum(jumps)


def waves(scene, places):
    """The waves to the right and to the left, by exact values of strains and velocities there."""
    truth = Truth(scene, Fraction(scene.output.until))
    for o in range(len(places)):

        def wave(tau, sign, o=o):
            strain, velocity = truth.value(o, tau), truth.value(o + len(places), tau)
            return float((velocity - sign * strain) / 2)

        yield wave


@pytest.mark.parametrize("wanted", [1e-2, 1e-5])
@pytest.mark.parametrize("load", [ALL, {"times": [0], "a": [1], "b": [0]}], ids=["panels", "step"])
def test_true_waves_are_polynomials_up_to_their_tail(load, wanted, monkeypatch) -> None:
    """Where a tail is as large as can be seen: interpolated at Chebyshev points, no wave is further away."""
    monkeypatch.setattr(tails, "_SMALL", log(wanted))
    places = ["1/7", "8/7"]
    scene = building(4, load, kappa=(1, "1/2", "3/2"), strain=places, velocity=places)
    plan = march_plan(lower(scene))
    smooth = smoothness(plan, 0)
    assert 0 < smooth.size <= wanted * sum(jumps_of(plan))
    cosines = np.cos(np.pi * (np.arange(smooth.degree + 1) + 0.5) / (smooth.degree + 1))
    fine = np.linspace(-0.999, 0.999, 12)
    worst = 0.0
    # what a node sends is seen 1/7 later, or comes from the next one and was sent 6/7 before
    for wave in waves(scene, places):
        for sign, delay in ((1, Fraction(1, 7)), (-1, Fraction(6, 7))):
            for window in range(3):
                for panel in plan.panels:
                    low, half = window + delay + fraction(panel.start), fraction(panel.length) / 2
                    at = [wave(low + half * (1 + Fraction(u)), sign) for u in [*cosines, *fine]]
                    fitted = np.polynomial.Chebyshev.fit(cosines, at[: len(cosines)], smooth.degree, domain=[-1, 1])
                    worst = max(worst, np.max(np.abs(fitted(fine) - at[len(cosines) :])))
    assert 0 < worst <= smooth.size


def test_interpolation_misses_what_it_is_said_to() -> None:
    """x^k on a panel of length h: 2 (h/4)^k/k! of its k-th derivative, k!, and no more."""
    k, h = 7, 2 / 3
    nodes = h / 2 * np.cos(np.pi * (np.arange(k) + 0.5) / k)
    missed = np.prod(np.linspace(-h / 2, h / 2, 999)[:, np.newaxis] - nodes, axis=1)
    assert np.max(np.abs(missed)) == pytest.approx(2 * (h / 4) ** k, rel=1e-12)


def test_without_a_state_waves_are_as_the_loads() -> None:
    plan = march_plan(lower(building("1/2", strain=[0])))
    alone = replace(plan, joints=plan.joints[:1])
    assert rate_of(alone) == 0
    assert smoothness(alone, 0) == Tail(3, 0.0)
    assert smoothness(alone, 9) == Tail(9, 0.0)


def test_a_longer_march_has_a_longer_tail() -> None:
    """Laguerre functions: what has met n bodies has a degree of about sqrt(n), and never less than the loads."""
    found = [tail_of(0, [0.0, 1.0, 1.0], 2.0, n, 1.0 + n, [1 / 3, 2 / 3]).degree for n in (1, 10, 100, 1000)]
    assert found == sorted(found)
    assert found[-1] < 600
    assert tail_of(0, [1.0] * 5, 1e-30, 1, 1.0, [1.0]).degree >= 5
    assert tail_of(30, [1.0, 0.0, 0.0], 1e-3, 1, 1.0, [1.0]).degree == 30
