"""The least and the greatest value of outputs, against closed forms, published numbers, and values anywhere."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from itertools import pairwise
from math import atan2, cos, exp, inf, nextafter, pi, sin, sqrt

import numpy as np
import pytest
from flint import arb, arb_poly, ctx, fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

import wavesym
from tests.support.chains import chains
from tests.support.scenes import scenes
from wavesym.errors import CostError, WavesymError
from wavesym.exact import extremes as module
from wavesym.exact.contacts.events import events
from wavesym.exact.extremes import NOTHING, TrueExtreme, extremes
from wavesym.exact.motion import Motion
from wavesym.exact.reference import Reference
from wavesym.numbers.doubles import rational
from wavesym.scene import Scene, lower

GUN = [{"motion": "velocity", "name": "gun"}, {"rod": 4}, "absorbing"]
EXACT = 2.0**-51


def chain(parts, until, load=(), **watched):
    return Scene(
        name="drawn", system={"type": "chain", "parts": parts}, load=list(load), output={"until": until} | watched
    )


def found(parts, until, load=(), **watched):
    """The least and the greatest value of each output."""
    return extremes(lower(chain(parts, until, load, **watched)))


def shaped(until, x=0, quantity="velocity", **load):
    """Those of what a load is, x later: nothing comes back from the end."""
    ((least, greatest),) = found(GUN, until, [{"at": "gun"} | load], **{quantity: [str(x)]})
    return least, greatest


def near(value, tau, reached=True):
    return TrueExtreme(pytest.approx(value, rel=EXACT, abs=0), pytest.approx(tau, rel=EXACT, abs=0), reached)


# where a load is what is seen: (3.1) again, x later


def test_a_top_between_samples_is_found():
    least, greatest = shaped(6, x="1/3", times=[0, 1, 2], ramps=[1, "-5/2", "3/2"])
    assert greatest == near(1, 4 / 3)
    assert least == near(-0.5, 7 / 3)


def test_a_limit_before_a_jump_counts_as_greatest():
    least, greatest = shaped(6, x=1, times=[0, 2], ramps=[1, -1], steps=[0, -5])
    assert greatest == near(2, 3, reached=False)
    assert least == near(-3, 3)


def test_a_limit_before_a_jump_counts_as_least():
    least, greatest = shaped(6, x=1, times=[0, 2], ramps=[-1, 1], steps=[0, 5])
    assert least == near(-2, 3, reached=False)
    assert greatest == near(3, 3)


def test_the_first_instant_of_a_plateau_is_told():
    least, greatest = shaped(8, x="1/2", times=[0, 1, 2, 5], ramps=[0, 1, -1, 0], steps=[-1, 0, 0, -1])
    assert greatest == near(0, 0)
    assert least == near(-1, 0.5)
    least, greatest = shaped(8, x="1/2", times=[0, 1, 2, 5], ramps=[0, 1, -1, 0], steps=[0, 0, 0, -3])
    assert greatest == near(1, 2.5)
    assert least == near(-2, 5.5)


def test_the_first_of_two_equal_tops_is_told():
    times, ramps = [0, 1, 2, 3, 4], [1, -2, 2, -2, 1]
    least, greatest = shaped(9, x="3/4", times=times, ramps=ramps)
    assert greatest == near(1, 1.75)
    assert least == near(0, 0)


def test_the_higher_of_two_nearly_equal_tops_is_told():
    more = Fraction(1, 2**50)
    _, greatest = shaped(9, times=[0, 1, 2, 3], ramps=[1, -2, 2 + more, -1 - more])
    assert greatest.tau == 3


def test_a_greatest_value_at_the_horizon():
    _, greatest = shaped("5/2", times=[0], ramps=["1/3"])
    assert greatest == near(2.5 / 3, 2.5)


def test_a_jump_at_the_horizon_counts():
    least, greatest = shaped(3, x=1, times=[0, 2], ramps=[1, 0], steps=[0, 4])
    assert greatest == near(6, 3)
    least, greatest = shaped(3, x=1, times=[0, 2], ramps=[1, 0], steps=[0, -4])
    assert greatest == near(2, 3, reached=False)
    assert least == near(-2, 3)


def test_a_jump_after_the_horizon_does_not_count():
    _, greatest = shaped("2999/1000", x=1, times=[0, 2], ramps=[1, 0], steps=[0, 4])
    assert greatest == near(1.999, 2.999)


def test_a_greatest_value_at_the_start():
    least, greatest = shaped(3, times=[0], steps=[2], ramps=[-1])
    assert greatest == near(2, 0)
    assert least == near(-1, 3)


def test_a_jump_that_no_double_hits_counts_from_the_next():
    third = Fraction(1, 3)
    _, greatest = shaped(3, times=[third], steps=[1], ramps=[-1])
    assert greatest == near(1, 1 / 3)
    assert Fraction(greatest.tau) >= third


def test_what_is_constant_and_what_is_nothing():
    assert shaped(3, times=[0], steps=["1/3"]) == (TrueExtreme(1 / 3, 0.0), TrueExtreme(1 / 3, 0.0))
    assert shaped(3, x=4, times=[0], steps=[1]) == NOTHING
    ((least, greatest),) = found([{"rod": 1}, "free"], 4, strain=["1"])
    assert (least, greatest) == NOTHING


@pytest.mark.parametrize("size", ["1e-290", "1e290"])
def test_values_of_any_size(size):
    _, greatest = shaped(6, x="1/3", times=[0, 1], ramps=[size, "-" + size], quantity="displacement")
    assert greatest.value == pytest.approx(float(size) * (0.5 + 14 / 3), rel=EXACT)


def test_a_top_of_a_cubic():
    """Under the acceleration 1 - tau a place that starts at rest moves by tau^2/2 - tau^3/6: 2/3 at 2."""
    parts = [{"motion": "acceleration", "name": "gun"}, {"rod": 9}, "absorbing"]
    load = [{"at": "gun", "times": [0], "steps": [1], "ramps": [-1]}]
    ((least, greatest),) = found(parts, 4, load, displacement=["1/4"])
    assert greatest == near(2 / 3, 2.25)
    assert least == near(15 / 4 * 15 / 4 / 2 * (1 - 5 / 4), 4)


# known solutions


@pytest.mark.parametrize(("mass", "spring"), [("1/2", 2), (3, "1/4"), ("7/5", 40)])
def test_a_mass_on_a_spring_that_an_endless_rod_damps(mass, spring):
    """M u'' + u' + K u = 0: every half period a top, smaller each time."""
    parts = [{"mass": mass, "spring": spring, "velocity": 1}, {"rod": 2}, "absorbing"]
    (speed, moved) = found(parts, 30, displacement=["0"], velocity=["0"])
    m, k = float(Fraction(mass)), float(Fraction(spring))
    decay = 1 / (2 * m)
    w = sqrt(k / m - decay**2)
    first = atan2(w, decay) / w
    assert moved[1] == near(exp(-decay * first) * sin(w * first) / w, first)
    assert moved[0] == near(-exp(-decay * (first + pi / w)) * sin(w * first) / w, first + pi / w)
    slowest = 2 * first
    assert speed[0] == near(exp(-decay * slowest) * (cos(w * slowest) - decay / w * sin(w * slowest)), slowest)
    assert speed[1] == near(1, 0)


@pytest.mark.parametrize("mass", [1, 2, 4])
def test_a_rod_that_a_mass_strikes(mass):
    """Saint-Venant 1883: the largest stress at the fixed end is 2 (1 + exp(-2/mass)), at 3, for a mass below 5.6."""
    ((least, _),) = found([{"mass": mass, "velocity": 1}, {"rod": 1}, "fixed"], 5, strain=[1])
    assert least == near(-2 * (1 + exp(-2 / mass)), 3)


def test_plateaus_behind_a_split_hopkinson_bar():
    """With a quarter of the impedance between two bars the stress passed is 1 - 0.6^(2 n) from the n-th arrival on."""
    parts = [{"motion": "velocity", "name": "gun"}, {"rod": 6}, {"rod": 1, "impedance": "1/4"}, {"rod": 2}, "absorbing"]
    for until, passed, since in ((8, 0.64, 7), (10, 0.8704, 9), ("25/2", 0.953344, 11)):
        ((least, greatest),) = found(parts, until, [{"at": "gun", "times": [0], "steps": [1]}], strain=["7+"])
        assert (least, greatest) == (TrueExtreme(-passed, since), TrueExtreme(0.0, 0.0))


def test_a_bar_dropped_on_rigid_ground():
    """Doyen, Ern, Piperno 2011: in its middle -1/3 while the wave from the ground has not come back, and 1/9 once."""
    parts = [{"motion": "acceleration", "name": "ground"}, {"contact": 5}, {"rod": 10, "speed": 30, "impedance": 30}]
    ((least, greatest),) = found(parts, 2, [{"at": "ground", "times": [0], "steps": [10]}], strain=[5])
    values = wavesym.evaluator(chain(parts, 2, [{"at": "ground", "times": [0], "steps": [10]}], strain=[5]))(
        np.linspace(0, 2, 5001)
    )[0]
    assert least.value <= values.min() + EXACT
    assert least.value == pytest.approx(values.min(), abs=1e-3)
    assert greatest.value == pytest.approx(values.max(), abs=1e-3)


def test_what_ends_where_a_contact_opens():
    """The force of a mass on a fixed bar goes to 0, and the contact opens: that 0 is taken, at the event.

    Saint-Venant: that is w after 2, with 2 (w - 1) = exp(-2).
    """
    parts = [{"mass": 1, "velocity": 1}, "contact", {"rod": 1}, "fixed"]
    scene = chain(parts, 4, strain=["0+"])
    (opens,) = wavesym.evaluator(scene).events
    ((least, greatest),) = extremes(lower(scene))
    assert opens.double == pytest.approx(3 + exp(-2) / 2, rel=1e-15)
    assert greatest == near(0, opens.double)
    assert least == near(-2 - exp(-2), 2)


def test_only_what_is_vague_is_left_out(monkeypatch):
    """A hammer that rebounds and strikes again, at instants that are no rationals: on short stretches."""
    model = lower(chain([{"mass": "7/2", "velocity": 1}, "contact", {"rod": 1}, "fixed"], 8, strain=["0+"]))
    motion = Motion(model, rational(model.horizon()))
    segments = motion.segments(model.probes[0], motion.first_bits)
    vague = [(low, high) for low, high in pairwise(segments) if low.vague]
    assert vague
    assert float(vague[0][0].start) == pytest.approx(events(model)[0].double, rel=1e-15)
    assert all(high.start - low.start < fmpq(1, 2**230) for low, high in vague)
    assert not segments[-1].vague
    right = extremes(model)
    monkeypatch.setattr(Motion, "_vague", lambda self, starts: [False] * len(starts))
    with pytest.raises(CostError, match="bits would be needed"):
        extremes(model)
    assert right[0][1] == near(0, events(model)[0].double)


# values anywhere


def assert_extremes_of(scene):
    """No value lies beyond, and each is taken at its instant, or just before it."""
    response = wavesym.evaluator(scene)
    ranges = extremes(lower(scene))
    taus = np.linspace(0, response.tau_max, 301)
    values = response(taus)
    for row, (least, greatest) in zip(values, ranges, strict=True):
        size = max(abs(least.value), abs(greatest.value))
        assert least.value - EXACT * size <= row.min()
        assert row.max() <= greatest.value + EXACT * size
    for k, pair in enumerate(ranges):
        size = max(abs(each.value) for each in pair)
        for each in pair:
            tau = each.tau if each.reached else nextafter(each.tau, -inf)
            # a double is up to 2^-53 of itself beside the instant, and slopes are moderate
            assert response(tau)[k] == pytest.approx(each.value, rel=0, abs=1e-11 * size)


@settings(max_examples=8)
@given(scenes(longest=False))
def test_no_value_of_a_drawn_scene_lies_beyond(scene):
    with suppress(wavesym.RangeError):
        assert_extremes_of(scene)


@settings(max_examples=6)
@given(chains(until=5))
def test_no_value_of_a_drawn_chain_lies_beyond(table):
    assert_extremes_of(Scene(**table))


@settings(max_examples=40)
@given(st.lists(st.fractions(-1, 1, max_denominator=12), min_size=1, max_size=9), st.sampled_from([1, -1]))
def test_tops_of_polynomials(powers, sign):
    """Of any polynomial on [-1, 1], against NumPy's roots of its derivative."""
    coefficients = [arb(fmpq(p.numerator, p.denominator)) * sign for p in powers]
    tops = list(module._tops(coefficients, arb(0), arb(-100), arb(2) ** -60))
    polynomial = np.polynomial.Polynomial([sign * float(p) for p in powers])
    roots = polynomial.deriv().roots() if len(powers) > 1 else np.array([])
    inside = roots[np.abs(roots) < 1 + 1e-9]
    candidates = np.concatenate([[-1.0, 1.0], np.clip(inside.real, -1, 1)])
    assert max(float(value.mid()) for value, _ in tops) == pytest.approx(polynomial(candidates).max(), abs=1e-12)


@pytest.mark.parametrize("points", module._POINTS)
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("bend", [1, 300])
def test_a_top_that_no_sample_is_near_is_kept(points, sign, bend):
    """The top of a parabola, 1, lies in the middle between two samples, which are m d^2 / 8 lower; another piece is
    higher than these, and lower than the top."""
    d = fmpq(2, points - 1)
    middle = 7 * d + d / 2
    lower = bend * d**2 / 8
    parabola = [1 - bend * middle**2 / 2, bend * middle, -fmpq(bend) / 2]
    pieces = [
        module.Piece(fmpq(k), fmpq(k + 1), tuple(arb(sign * c) for c in powers), arb(0), False, k == 1)
        for k, powers in enumerate((parabola, [1 - lower / 2]))
    ]
    with ctx.workprec(128):
        found = module._extremes_of(pieces, max(piece.largest for piece in pieces))
    highest = found[1 if sign > 0 else 0]
    assert highest == near(sign, float((1 + middle) / 2))


def test_a_short_stiff_rod_beside_a_light_mass_costs_no_bits(monkeypatch):
    """As a drill string with collars: what comes after the horizon was moved, too, where series bear it no more."""
    parts = [{"mass": 7, "name": "top"}, {"rod": 1}, {"rod": "1/15", "impedance": 7}, {"mass": "1/28", "name": "bit"}]
    load = [{"at": at, "times": [when], "steps": [1]} for at, when in (("top", 0), ("bit", "1.06"))]
    output = {"until": "3.18", "velocity": ["top", "bit"]}
    model = lower(Scene(name="string", system={"type": "chain", "parts": parts}, load=load, output=output))
    asked, segments = [], Motion.segments

    def spied(self, probe, bits, taus=None):
        asked.append(bits)
        return segments(self, probe, bits, taus)

    monkeypatch.setattr(Motion, "segments", spied)
    extremes(model)
    motion = Motion(model, rational(model.horizon()))
    assert asked == [motion.first_bits] * 2
    assert motion.first_bits <= 1024
    assert all(
        motion._breakpoints.joints[number][-1] <= until + fmpq(1, 15)
        for number, until in model.joints_in_reach(motion.until).items()
    )


def test_too_long_a_horizon_is_refused_in_one_line():
    with pytest.raises(CostError, match="a shorter horizon"):
        extremes(lower(Scene.from_toml("building_m2").with_({"output.until": 1000})))


# seen to fail


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("name", "value"), [("_POINTS", (3, 3)), ("_NEWTON", 1), ("_EQUAL", arb(2) ** -1), ("_NEGLIGIBLE", arb(2) ** -2)]
)
def test_a_search_that_is_broken_is_seen(name, value, monkeypatch):
    scene = Scene.from_toml("building_m2").with_({"output.until": 12})
    right = extremes(lower(scene))
    monkeypatch.setattr(module, name, value)
    if name == "_POINTS":  # fewer points alone leave more to do, and nothing out
        assert extremes(lower(scene)) == right
        monkeypatch.setattr(module.np, "arange", lambda n, *_, a=np.arange: a(n) * 0 if n > 8 else a(n))
    try:
        wrong = extremes(lower(scene))
    except (WavesymError, IndexError):
        return
    assert wrong != right


@pytest.mark.parametrize("seed", range(4))
def test_what_is_trimmed_is_in_the_radius(seed):
    """Numbers of many bits that cancel, and powers that hardly count."""
    random = np.random.default_rng(seed)
    with ctx.workprec(2000):
        c = [arb(fmpq(int(random.integers(-(10**9), 10**9)), 3 * 10**6)) * arb(2) ** (300 - 9 * k) for k in range(80)]
        middles = [each.mid() for each in c]
        flat, radius = arb(2) ** -64, arb(2) ** -80
        polynomial, more = module._trim(arb_poly(middles), radius, flat)
        assert polynomial.degree() < 79
        assert radius < more < flat
        assert all(int(each.man_exp()[0]).bit_length() < 600 for each in polynomial.coeffs())
        for t in (-1, 1, *(fmpq(int(random.integers(-99, 99)), 100) for _ in range(20))):
            assert abs(polynomial(arb(t)) - arb_poly(middles)(arb(t))) <= more - radius


@pytest.mark.slow
def test_a_light_mass_beside_a_stiff_rod_does_not_wait():
    """Each of its pieces has thousands of bits, of which an extreme needs few: took minutes."""
    parts = [{"rod": 1}, {"mass": "1/300", "name": "n", "velocity": 1}, {"rod": "1/10", "impedance": 10}, {"mass": 1}]
    model = lower(
        Scene(name="light", system={"type": "chain", "parts": parts}, output={"until": "3/10", "velocity": ["n"]})
    )
    ((least, greatest),) = extremes(model)
    taus = np.linspace(0, 0.3, 301)
    (values,) = Reference(model).values([*taus.tolist(), least.tau])
    assert greatest.value == values[0] == 1
    assert least.value == pytest.approx(values[-1], rel=1e-15)
    assert least.value <= min(values)
