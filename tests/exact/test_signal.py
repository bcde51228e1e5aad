"""Signals: exact sums of arrivals against the exact solver, and where the horizon cuts them, in double and single."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import ctx, fmpq
from hypothesis import given, settings

import wavesym
from tests.support.drawn import scenes
from tests.support.truth import Truth
from wavesym.errors import CostError
from wavesym.exact.tables.ball import Balls, segments
from wavesym.exact.tables.signal import signals
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.scene import lower

DRIVE = {"type": "drive", "m": 2, "kappa": ["1/2", "1/3"], "inertia": [1, 2, 3]}
COLLISION = {"type": "collision", "m": 6, "kappa": ["1/10", 2, "1/5"], "velocity": [1, "1/3", "-1/2"]}


def scene(until, system=DRIVE, load=({"body": 1, "times": [0, "1/3"], "steps": [1, 2]},), **outputs):
    given_loads = [] if system is COLLISION else list(load)
    return wavesym.Scene(name="cut", system=system, load=given_loads, output={"until": until, **outputs})


@settings(max_examples=15, deadline=None)
@given(scenes())
def test_signals_are_the_exact_solution(drawn):
    """The same instants, and at each of them, and between, the same value to 50 digits."""
    end = Fraction(lower(drawn).horizon())
    exact = Truth(drawn, end)
    with ctx.workprec(512):
        for number, signal in enumerate(signals(lower(drawn))):
            assert signal.name == drawn.outputs[number].name
            instants = exact.arrivals(number)
            seen = [arrival.time for arrival in signal.arrivals]
            # of what begins at the end of the horizon only a jump is seen
            assert seen == [rational(t) for t in instants if t < end or rational(t) in seen]
            balls = Balls(segments(signal, ctx.prec))
            for tau in [*instants, *(end * k / 7 for k in range(8))]:
                value = balls.evaluate(rational(tau))
                assert value.overlaps(exact.value(number, tau, 200))
                assert value.rad() < fmpq(1, 10**50)


@pytest.mark.parametrize("until", [2, "7/3", "1/3"])
def test_a_jump_at_the_end_of_the_horizon_is_seen(until):
    made = scene(until, COLLISION, strain=["1/3", 2, "5+"], velocity=["1/3", 3, 5], displacement=[1])
    tau = Fraction(lower(made).horizon())  # a double at 1/3 or just above
    exact = Truth(made, tau)
    with ctx.workprec(300):
        for number, signal in enumerate(signals(lower(made))):
            assert Balls(segments(signal, ctx.prec)).evaluate(rational(tau)).overlaps(exact.value(number, tau, 200))


def arrivals(made, real=DOUBLE):
    return [[arrival.time for arrival in signal.arrivals] for signal in signals(lower(made), real=real)]


def test_what_only_begins_at_the_end_is_left_out():
    """In a building that is pulled at its base the strain jumps at once, and velocity bends a rod later."""
    building = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"}
    load = [{"times": [0], "a": [1], "b": [0]}]
    jump, bend = arrivals(scene(1, building, load, strain=["1-"], velocity=[1]))
    assert (jump, bend) == ([fmpq(1)], [])
    later = arrivals(scene(Fraction(1) + Fraction(1, 2**40), building, load, strain=["1-"], velocity=[1]))
    assert later == [[fmpq(1)], [fmpq(1)]]
    moved = arrivals(scene(1, building, load, displacement=[0, 1]))
    assert moved == [[fmpq(0)], []]


def test_a_horizon_is_the_first_number_that_is_not_below_it():
    for until in (Fraction(1, 3), Fraction(2), Fraction(89, 10), Fraction(1) + Fraction(1, 2**30), Fraction(10**9)):
        double, single = (lower(scene(until, strain=["1/2"])).horizon(real) for real in (DOUBLE, SINGLE))
        assert Fraction(math.nextafter(double, 0)) < until <= Fraction(double)
        below = np.nextafter(np.float32(single), np.float32(0))
        assert float(np.float32(single)) == single
        assert Fraction(float(below)) < until <= Fraction(single)


def test_in_single_precision_the_horizon_reaches_further():
    """What the body sends back arrives at 5/3, after an `until` that is a little less, but before the next single."""
    made = scene(Fraction(5, 3) - Fraction(1, 10**9), COLLISION, strain=["5/3"])
    assert arrivals(made, DOUBLE) == [[fmpq(1, 3)]]
    assert arrivals(made, SINGLE) == [[fmpq(1, 3), fmpq(5, 3)]]


def test_a_body_that_moves_at_first_counts_from_the_start():
    made = scene(3, COLLISION, strain=["1/2"], velocity=["1/2", "5/2"], displacement=["5/2"])
    strain, velocity, other, displacement = signals(lower(made))
    assert strain.arrivals[0].time > 0
    assert velocity.arrivals[0].increment == {fmpq(0): [fmpq(1)]}
    assert other.arrivals[0].increment == {fmpq(0): [fmpq(1, 3)]}
    assert displacement.arrivals[0].increment == {fmpq(0): [fmpq(0), fmpq(1, 3)]}


def test_tables_that_would_be_large_are_refused_before_they_are_made(monkeypatch):
    def made(*_):
        raise AssertionError("a table was begun")

    monkeypatch.setattr("wavesym.exact.tables.network_table.departures", made)
    with pytest.raises(
        CostError,
        match=r"^output.until: the tables would hold .* the limit is 1.0e\+01",
    ):
        signals(lower(scene(40, strain=["1/2"])), most=10)
