"""Contacts that open and close, against published and elementary numbers."""

from __future__ import annotations

from math import comb, exp, factorial, sqrt

import pytest
from flint import arb, ctx, fmpq

from tests.support.touching import FIXED, at, body, contact, line, q, rod, seen, told, values
from wavesym.exact.reference import Reference


def kinds(model):
    return [(x, kind) for x, kind, _ in told(model)]


def test_a_bar_stopped_by_a_wall():
    """ANSYS VM85: gap 0.64 in, 100 in/s, E 30e6 psi, rho 7.3e-4, L 10 000 in; printed 4.9329 in and 14 799 psi."""
    young, density, length, way = 30e6, 7.3e-4, 10_000, q("0.64")
    speed = sqrt(young / density)
    moving = rod(length, speed=speed, velocity=-100, impedance=young / speed)
    probes = [seen(0, 0, "displacement"), seen(0, 1, "displacement"), seen(0, "1/2", "strain")]
    model = line([FIXED, contact(way), moving], "0.15", probes)
    (closes, opens) = told(model)
    assert closes[:2] == ("0", "closes")
    assert at(closes[2], "0.0064")
    assert opens[1] == "opens"
    assert at(opens[2], q("0.0064") + 2 * length / q(speed))
    tau = 0.0557288286231625
    assert tau == pytest.approx(0.0064 + length / speed, rel=1e-14)
    near, far, strain = Reference(model).values([tau])
    assert near[0] - far[0] == pytest.approx(4.93288286231625, rel=1e-13)
    assert -strain[0] * young == pytest.approx(14798.6485869487, rel=1e-13)


def test_a_bar_dropped_on_rigid_ground():
    """Doyen, Ern, Piperno 2011, in the falling frame: E 900, rho 1, L 10, g 10, from 5 above the ground."""
    model = line([body(acceleration=10), contact(5), rod(10, 30, 30)], 20, [seen(0, 0, "displacement")])
    found = told(model)
    expected = [start + q("16/3") * k for k in range(4) for start in map(q, (1, "5/3", "11/3", "13/3"))]
    inside = [tau for tau in expected if tau <= 20]
    assert [kind for _, kind, _ in found] == ["closes", "opens"] * (len(inside) // 2) + ["closes"] * (len(inside) % 2)
    assert all(at(event, tau) for (_, _, event), tau in zip(found, inside, strict=True))
    taus = [q("1/2"), q(2), q("7/3"), q(3), q(5)]
    (moved,) = values(model, taus)
    heights = [5 + u - 5 * tau**2 for u, tau in zip(moved, taus, strict=True)]
    for height, known in zip(heights, ("15/4", "5/3", "40/9", "40/9", "40/9"), strict=True):
        assert abs(height - q(known)) < fmpq(1, 10**30)


@pytest.mark.parametrize("a", ["1/2", 1, "7/3", "1/40"])
def test_a_mass_thrown_on_a_free_rod(a):
    """Whatever its mass: the contact ends at 2, and the restitution is (1 - e^-2a)/a - e^-2a."""
    model = line([body(1 / q(a), velocity=1), contact(), rod()], 6, [seen(0, 0), seen(0, 0, "displacement")])
    ((x, kind, event),) = told(model)
    assert (x, kind) == ("0", "opens")
    assert at(event, 2)
    # the body's velocity by the momentum that the rod has: in flight, a rod's mean velocity is what its end moves in 2
    (_, moved) = values(model, [3, 5])
    rod_velocity = float((moved[1] - moved[0]).p) / float((moved[1] - moved[0]).q) / 2
    number = float(q(a).p) / float(q(a).q)
    body_velocity = 1 - number * rod_velocity
    assert body_velocity == pytest.approx(exp(-2 * number), rel=1e-14)
    restitution = (1 - exp(-2 * number)) / number - exp(-2 * number)
    assert rod_velocity - body_velocity == pytest.approx(restitution, rel=1e-12, abs=1e-14)
    if a == "1/2":
        assert restitution == pytest.approx(0.896361676485673, rel=1e-14)


@pytest.mark.parametrize(("short", "long"), [(1, 2), (1, "3/2"), ("1/3", 1), (1, "1.000000001")])
def test_two_bars_part_when_the_longer_one_has_answered(short, long):
    """The force lasts 2 l1/c, the ends are pulled apart at 2 l2/c; then V1 = 0, V2 = v1 l1/l2."""
    l1, l2 = q(short), q(long)
    strain = [seen(1, 0, "strain"), seen(0, 0, "displacement"), seen(1, 1, "displacement")]
    model = line([rod(l1, velocity=1), contact(), rod(l2)], 8 * l2, strain)
    ((_, kind, event),) = told(model)
    assert kind == "opens"
    assert at(event, 2 * l2)
    later = [l1, 3 * l1 / 2, 2 * l1, l1 + l2, 4 * l2, 6 * l2]
    force, first, second = values(model, later)
    assert force[:4] == [-q("1/2"), -q("1/2"), 0, 0]
    assert abs(first[5] - first[4]) < fmpq(1, 10**30)
    assert abs(second[5] - second[4] - 2 * l1) < fmpq(1, 10**30)  # v1 l1/l2 over 2 l2


def test_equal_bars_part_at_once():
    ((_, kind, event),) = told(line([rod(velocity=1), contact(), rod()], 8))
    assert kind == "opens"
    assert at(event, 2)


@pytest.mark.parametrize("beta", ["1/4", "1/2", 3])
def test_a_split_hopkinson_bar_that_only_touches_its_specimen(beta):
    """The stress that has passed after the n-th arrival is 1 - R^(2n) of what came."""
    r = (1 - q(beta)) / (1 + q(beta))
    watched = [seen(2, "1/20", "strain")]
    model = line([rod(10, velocity=2), contact(), rod(1, beta), contact(), rod(20)], 12, watched)
    assert kinds(model) == []
    (found,) = values(model, ["3/2", 3, 5, 7])
    for value, known in zip(found, [0] + [-(1 - r ** (2 * n)) for n in (1, 2, 3)], strict=True):
        assert abs(value - known) < fmpq(1, 10**30)


def struck(tau, alpha):
    """What presses a rigid mass on a fixed bar: Laguerre polynomials on their fronts, in the published closed form."""

    def p(t):
        total = arb(0)
        for k in range(20):
            since = t - 2 * k
            if since < 0:
                break
            x = 2 * alpha * since
            laguerre = sum(((-1) ** j * comb(k, j) * x**j / factorial(j) for j in range(k + 1)), arb(0))
            total += (-alpha * since).exp() * laguerre
        return total

    return p(tau) + (p(tau - 2) if tau > 2 else 0)


@pytest.mark.quick(3)
@pytest.mark.parametrize("ratio", range(1, 9))
def test_a_rigid_mass_on_a_fixed_bar(ratio):
    """The contact ends where the closed form says, and for some ratios the bar strikes again."""
    model = line([body(ratio, velocity=1), contact(), rod(), FIXED], 12)
    found = told(model)
    assert found[0][1] == "opens"
    with ctx.workprec(256):
        alpha = arb(1) / ratio
        low, high = arb(2), arb(2)
        while struck(high, alpha) > 0:
            low, high = high, high + fmpq(1, 64)
        for _ in range(200):
            half = ((low + high) / 2).mid()
            low, high = (half, high) if struck(half, alpha) > 0 else (low, half)
        assert abs(found[0][2].tau - low) < fmpq(1, 10**55)
    again = [kind for _, kind, _ in found[1:]]
    assert again == (["closes", "opens"] if ratio in (1, 4, 6, 7) else [])
