"""The reference: both of its routes against the exact solver, and no work where it would take too long."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx, fmpq

import wavesym
from tests.support.truth import Truth
from wavesym.errors import CostError, RangeError
from wavesym.exact import motion, reference
from wavesym.exact.reference import Reference, beginning
from wavesym.numbers import balls
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.scene import lower

BUILDING = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"}


def scene(until="16/3", tolerance="1e-10", times=("1/7", 2), **outputs):
    load = {"times": list(times), "a": [1, "-1/3"], "b": ["1/2", 1]}
    watched = outputs or {"strain": ["1/2", 2], "velocity": [1], "displacement": ["5/3"]}
    output = {"until": until, "tolerance": tolerance, **watched}
    return wavesym.Scene(name="watched", system=BUILDING, load=[load], output=output)


@pytest.fixture(params=["tables", "windows"])
def route(request, monkeypatch):
    """Tables of coefficients, or waves on windows where there may be none."""
    monkeypatch.setattr(reference, "_MODERATE", 10**6 if request.param == "tables" else 0)
    return request.param


def truth(made, tau_max):
    longer = made.model_copy(update={"output": made.output.model_copy(update={"until": Fraction(tau_max)})})
    return Truth(longer, Fraction(tau_max))


@pytest.mark.parametrize("real", [DOUBLE, SINGLE])
def test_both_routes_are_right_to_the_last_bit(route, real):
    watched = scene()
    made = Reference(lower(watched), real)
    assert (made.signals is None) == (route == "windows")
    exact = truth(watched, made.tau_max)
    third = math.nextafter(1 / 7 + 1 / 2, 1)
    taus = [0.0, 0.1, third, math.nextafter(third, 0), 2.5, 3.0, 4.9, made.tau_max, 2.5]
    for number, row in enumerate(made.values(taus)):
        for tau, value in zip(taus, row, strict=True):
            ball_of = exact.value(number, Fraction(tau), 200)
            mantissa, exponent = (int(part) for part in ball_of.mid().man_exp())
            assert value == float(Fraction(mantissa) * Fraction(2) ** exponent), (number, tau)


def test_largest_values_are_lower_bounds(route):
    watched = scene()
    made = Reference(lower(watched))
    exact = truth(watched, made.tau_max)
    for number, size in enumerate(made.largest()):
        low, high = exact.largest(number, Fraction(made.tau_max))
        assert size <= high
        assert size > low / 2
    assert Reference(lower(scene(until="1/8"))).largest() == [arb(0)] * 4  # before the first load


def test_breakpoints_are_the_first_doubles_that_feel_them(route):
    watched = scene()
    made = Reference(lower(watched))
    exact = truth(watched, made.tau_max)
    found = made.breakpoints()
    assert found == sorted(set(found))
    fronts = {tau for number in range(4) for tau in exact.arrivals(number) if tau < made.tau_max}
    doubles = {tau: next(double for double in found if double >= tau) for tau in fronts}
    assert all(Fraction(math.nextafter(double, 0)) < tau for tau, double in doubles.items() if double)


def test_windows_are_asked_only_for_the_segments_that_are_needed(monkeypatch):
    monkeypatch.setattr(reference, "_MODERATE", 0)
    composed = []
    values = motion._values

    def counted(waves, terms, start, shifts):
        composed.append(start)
        return values(waves, terms, start, shifts)

    monkeypatch.setattr(motion, "_values", counted)
    Reference(lower(scene(strain=["1/2"]))).values([1.0, 1.001, 3.9])
    assert len(composed) == 2


def refused(*_, **__):
    raise AssertionError("work was begun")


def test_values_that_would_take_long_are_refused_before_work(monkeypatch):
    monkeypatch.setattr(reference, "_MODERATE", 0)
    monkeypatch.setattr(motion, "NetworkWaves", refused)
    with pytest.raises(CostError, match=r"^output: 10000000 values of 4 outputs to tau = .* \(fewer outputs, samples"):
        Reference(lower(scene())).values([1.0] * 10**7)


def test_more_bits_than_can_be_had_are_a_cost(monkeypatch):
    monkeypatch.setattr(balls.precise, "__defaults__", (128, 64))
    with pytest.raises(CostError, match=r"^output.until: for values right to the last bit, more than 64 bits"):
        Reference(lower(scene())).values([1.0])


def test_values_beyond_all_doubles_are_said_to_be(route):
    huge = {"times": [0], "a": ["1e300"], "b": [0]}
    output = {"until": 1, "strain": ["1/2"]}
    system = {**BUILDING, "kappa": ["1e-9", 1, 1]}
    with pytest.raises(RangeError, match="largest double"):
        Reference(lower(wavesym.Scene(name="huge", system=system, load=[huge], output=output))).values([0.75])


def test_a_beginning_is_as_much_of_the_horizon_as_is_known_soon(monkeypatch):
    short, long = lower(scene(until=20)), lower(scene(until=5000))
    assert beginning(short) == short
    begun = beginning(long)
    assert 8 <= begun.until < 5000
    assert reference.waves_size(begun) <= reference._QUICK < reference.waves_size(long.shorten(2 * begun.until))
    assert begun.network is long.network
    monkeypatch.setattr(reference, "_QUICK", 0)
    assert beginning(long).until == 8
    assert beginning(lower(scene(until=7))).until == 7


def test_a_response_is_defined_on_its_horizon_only():
    response = wavesym.evaluator(scene())
    end = response.tau_max
    assert Fraction(math.nextafter(end, 0)) < Fraction(16, 3) <= Fraction(end)
    assert response.outputs == ("strain@1/2", "strain@2", "velocity@1", "displacement@5/3")
    assert response.error_bound == 2.0**-53
    taus = np.array([[-5e-324, 0.0, 1.5], [end, math.nextafter(end, 9), math.nan]])
    found = response(taus)
    assert found.shape == (4, 2, 3)
    assert np.array_equal(np.isnan(found[0]), [[True, False, False], [False, True, True]])
    assert np.array_equal(found[:, 0, 2], response(1.5))
    with ctx.workprec(200):
        exact = truth(scene(), end).value(2, Fraction(end), 100)
        assert abs(arb(found[2, 1, 0]) - exact) <= abs(exact) * fmpq(1, 2**53)
