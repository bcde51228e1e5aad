"""How near true waves are to polynomials: the jumps of their derivatives, and what interpolation misses of them."""

from fractions import Fraction
from math import factorial, log, sqrt

import numpy as np
import pytest
from flint import ctx, fmpq, fmpq_series

from tests.support.truth import Truth
from wavesym.programs.march import tail as tails
from wavesym.programs.march.plan import plan
from wavesym.programs.march.tail import Tail, tail, tail_after
from wavesym.scene import Scene, lower

ALL = {"times": [0, "1/3"], "a": [1, "-1/2"], "b": ["3/2", 1]}


def building(until=3, load=ALL, base="ground", kappa=(1, "1/2", 3), **outputs):
    return Scene(
        name="made",
        system={"type": "building", "m": 2, "kappa": kappa, "base": base},
        load=[load],
        output={"until": until, "tolerance": "1e-3", **(outputs or {"strain": [0]})},
    )


def test_jumps_are_those_of_loads_and_start():
    assert tails._jumps(plan(lower(building()))) == [0, 1 + 1 / 2, (3 / 2 + 1) / 2 * 2]
    # a second load of an opposite kind changes what is new, not what was there
    assert tails._jumps(plan(lower(building(base="force")))) == [1.5, 2.5, 0]
    bars = {"type": "collision", "m": 4, "kappa": [1, 2], "velocity": [1, "-1/2"]}
    scene = Scene(name="made", system=bars, output={"until": 1, "strain": [2]})
    assert tails._jumps(plan(lower(scene))) == [2 * (1 / 2 + 1 / 2 + 1 / 4 + 1 / 4), 0, 0]


def grown(rate, windows, jumps, order):
    """[x^order] of Q(x) after so many windows: what arrives has met a body on each of them, G times as much."""
    ctx.cap, before = order + 1, ctx.cap
    try:
        x = fmpq_series([0, rate])
        passed = (1 + x) / (1 - x)
        total = (passed - 1) * fmpq_series([fmpq(*Fraction(jump).as_integer_ratio()) for jump in jumps])
        for _ in range(windows):
            total *= passed
        return float(total[order])
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
def test_the_tail_is_that_of_its_derivatives_and_the_degree_the_least(scene):
    """Once more by power series, exact; the tail that is claimed is above it, as it takes any r for the best one."""
    prepared = plan(lower(scene))
    smooth = tail(prepared, 0)
    jumps, rate = tails._jumps(prepared), prepared.rate
    assert smooth.size <= 2.0**-80 * sum(jumps)

    def claimed(degree):
        k, lengths = degree + 1, [1 / 3, 2 / 3]
        mass = float(sum(node.mass for node in prepared.junctions))
        impedance = float(min(node.right for node in prepared.junctions[:-1]))
        energies = [
            sqrt(mass / 2 / impedance) * len(lengths) * prepared.windows * grown(rate, prepared.windows, jumps, order)
            for order in (k, k + 1)
        ]
        largest = energies[0] / sqrt(lengths[0]) + energies[1] * sqrt(lengths[1])
        return 2 * (lengths[1] / 4) ** k / factorial(k) * largest

    exact = claimed(smooth.degree)
    assert exact <= smooth.size <= 600 * exact
    # one degree less would not have been enough
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
def test_true_waves_are_polynomials_up_to_their_tail(load, wanted, monkeypatch):
    """Where a tail is as large as can be seen: interpolated at Chebyshev points, no wave is further away."""
    monkeypatch.setattr(tails, "_SMALL", log(wanted))
    places = ["1/7", "8/7"]
    scene = building(4, load, kappa=(1, "1/2", "3/2"), strain=places, velocity=places)
    prepared = plan(lower(scene))
    smooth = tail(prepared, 0)
    assert 0 < smooth.size <= wanted * sum(tails._jumps(prepared))
    cosines = np.cos(np.pi * (np.arange(smooth.degree + 1) + 0.5) / (smooth.degree + 1))
    fine = np.linspace(-0.999, 0.999, 12)
    worst = 0.0
    # what a node sends is seen 1/7 later, or comes from the next one and was sent 6/7 before
    for rod, wave in enumerate(waves(scene, places)):
        for sign, delay in ((1, Fraction(1, 7)), (-1, Fraction(6, 7))):
            for window in range(3):
                for panel in prepared.panels:
                    low = window + delay + Fraction(int(panel.start.p), int(panel.start.q))
                    half = Fraction(int(panel.length.p), int(panel.length.q)) / 2
                    at = [wave(low + half * (1 + Fraction(u)), sign) for u in [*cosines, *fine]]
                    fitted = np.polynomial.Chebyshev.fit(cosines, at[: len(cosines)], smooth.degree, domain=[-1, 1])
                    worst = max(worst, np.max(np.abs(fitted(fine) - at[len(cosines) :])))
        assert rod < 2
    assert 0 < worst <= smooth.size


def test_interpolation_misses_what_it_is_said_to():
    """x^k on a panel of length h: 2 (h/4)^k/k! of its k-th derivative, k!, and no more."""
    k, h = 7, 2 / 3
    nodes = h / 2 * np.cos(np.pi * (np.arange(k) + 0.5) / k)
    missed = np.prod(np.linspace(-h / 2, h / 2, 999)[:, np.newaxis] - nodes, axis=1)
    assert np.max(np.abs(missed)) == pytest.approx(2 * (h / 4) ** k, rel=1e-12)


def test_without_bodies_waves_are_as_the_loads():
    prepared = plan(lower(building("1/2", strain=[0])))
    alone = type(prepared)(**{**vars(prepared), "junctions": prepared.junctions[:1]})
    assert alone.rate == 0
    assert tail(alone, 0) == Tail(3, 0.0)
    assert tail_after(prepared, 0, 3, [0.0, 0.0]) == Tail(2, 0.0)


def test_a_longer_march_has_a_longer_tail():
    """Laguerre functions: what has met n bodies has a degree of about sqrt(n), and never less than the loads."""
    found = [tail_after(plan(lower(building())), 0, n, [0.0, 1.0, 1.0]).degree for n in (1, 10, 100, 1000)]
    assert found == sorted(found)
    assert found[-1] < 600
    assert tail_after(plan(lower(building(kappa=(1, "1e-30", "1e-30")))), 0, 1, [1.0] * 5).degree >= 5
