"""Outputs from waves: their signs, places and errors, by hand-made waves and against the exact solver."""

from fractions import Fraction
from itertools import pairwise

import pytest
from flint import arb, arb_poly, ctx, fmpq
from hypothesis import given, settings

import wavesym
from tests.support.drawn import scenes
from tests.support.truth import Truth
from wavesym.errors import CostError
from wavesym.exact import motion as room
from wavesym.exact.joints.enclosure import Enclosure, weighted_sum
from wavesym.exact.joints.network_waves import SentWave
from wavesym.exact.motion import Motion
from wavesym.exact.tables.ball import Balls, is_zero
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import End
from wavesym.numbers.doubles import rational
from wavesym.scene import lower

DRIVE = {"type": "drive", "m": 3, "kappa": ["1/2", 2, "1/3"], "inertia": [1, 2, 3, "1/2"]}
LOAD = [{"body": 2, "times": [0, "7/3"], "steps": [1, "-1/2"]}]


def drive(until, load=LOAD, **outputs):
    return wavesym.Scene(name="motion", system=DRIVE, load=load, output={"until": until, **outputs})


def made(scene):
    return Motion(lower(scene), rational(scene.output.until))


def enclosures(motion, place, taus):
    balls = Balls(motion.segments(place, ctx.prec))
    return [balls.evaluate(tau) for tau in taus]


@pytest.fixture(autouse=True)
def _precision():
    with ctx.workprec(128):
        yield


@settings(max_examples=15, deadline=None)
@given(scenes())
def test_outputs_are_where_they_are_said_to_be(drawn):
    """At 192 bits, with 48 terms, balls are small and yet hold what the exact solver knows, at fronts too."""
    ctx.prec = 192
    motion, exact = made(drawn), Truth(drawn, drawn.output.until)
    until = drawn.output.until
    for number, place in enumerate(motion.probes):
        fronts = exact.arrivals(number)
        assert {rational(front) for front in fronts} <= {*motion.starts(place), rational(until)}
        before = [front - Fraction(1, 2**40) for front in fronts if front]
        taus = [*fronts, *before, *(until * k / 11 for k in range(12))]
        balls = enclosures(motion, place, [rational(tau) for tau in taus])
        for tau, ball in zip(taus, balls, strict=True):
            assert ball.overlaps(exact.value(number, tau, 200))
            assert ball.rad() < fmpq(1, 10**9)


def by_hand(scene, right, left):
    """The motion of a scene whose waves are given: those that nodes send right, and left, a list of one a unit."""
    motion = made(scene)
    waves = motion.waves(53)
    for side, known in ((0, right), (1, left)):
        for x, stretches in known.items():
            held = Enclosure(arb_poly(), arb(0))
            starts = [fmpq(n) for n in range(-1, len(stretches))]
            waves.sent[End(x if side == 0 else x - 1, side)] = SentWave(starts, [held, *stretches])
    motion._solved = dict.fromkeys((53, *(2**k for k in range(6, 14))), waves)  # at every precision
    motion._smooth_starts = [None] * len(motion.probes)  # they begin as they like
    return motion


def waves(count, *powers, error=0):
    return [Enclosure(arb_poly([fmpq(c) for c in powers]), arb(error))] * count


@pytest.mark.parametrize(
    ("output", "expected"),
    [
        # at 1/4 in rod 2: 3 + 5 u sent right by node 1 a quarter ago, 7 + 11 u sent left by node 2 three quarters ago
        ({"strain": ["5/4"]}, lambda u: 7 + 11 * (u - fmpq(3, 4)) - (3 + 5 * (u - fmpq(1, 4)))),
        ({"velocity": ["5/4"]}, lambda u: 7 + 11 * (u - fmpq(3, 4)) + (3 + 5 * (u - fmpq(1, 4)))),
        ({"strain": ["1+"]}, lambda u: 7 + 11 * (u - 1) - (3 + 5 * u)),
        ({"strain": ["2-"]}, lambda u: 7 + 11 * u - (3 + 5 * (u - 1))),
    ],
)
def test_strain_is_the_difference_of_the_waves_and_velocity_their_sum(output, expected):
    """One polynomial in tau for the whole of a wave: as each panel has its own start, the waves are cut to it here."""
    sides = {}
    for name, (start, slope) in {"right": (3, 5), "left": (7, 11)}.items():
        sides[name] = [Enclosure(arb_poly([start + slope * n, slope]), arb(0)) for n in range(4)]
    motion = by_hand(drive(3, **output), {1: sides["right"]}, {2: sides["left"]})
    (place,) = motion.probes
    for tau in (fmpq(1), fmpq(5, 4), fmpq(3, 2), fmpq(7, 4), fmpq(2), fmpq(13, 5)):
        (ball,) = enclosures(motion, place, [tau])
        assert abs(ball - expected(tau)) < fmpq(1, 2**100)


@pytest.mark.parametrize("output", [{"strain": ["5/4"]}, {"velocity": ["5/4"]}])
@pytest.mark.parametrize(("one", "other"), [(fmpq(1, 8), fmpq(1, 16)), (fmpq(1, 2), fmpq(1, 2)), (fmpq(1), fmpq(0))])
def test_both_waves_errors_are_in_the_value(output, one, other):
    motion = by_hand(drive(2, **output), {1: waves(3, 2, error=one)}, {2: waves(3, 5, error=other)})
    (ball,) = enclosures(motion, motion.probes[0], [fmpq(3, 2)])
    assert ball.rad() >= one + other
    assert ball.rad() < one + other + fmpq(1, 2**20)


def test_errors_of_all_that_is_summed_are_in_a_value():
    """Of a drift, which reads both ends of its rod, and of any sum: none takes the place of another."""
    parts = [(fmpq(2), Enclosure(arb_poly([1]), arb(1))), (fmpq(-3), Enclosure(arb_poly([1]), arb(fmpq(1, 4))))]
    for terms in (parts, parts[::-1], [*parts, (fmpq(1), Enclosure(arb_poly(), arb(0)))]):
        for total in (room._sum(terms), weighted_sum(terms)):
            assert total.evaluate(fmpq(0)).contains(-1 + fmpq(11, 4))
            assert total.evaluate(fmpq(0)).contains(-1 - fmpq(11, 4))
            assert total.error < fmpq(12, 4)


def test_errors_of_velocity_pile_up_in_displacement():
    """Waves that are too large, or too small, all the time: no less is told of the displacement, and little more."""
    right, left = waves(6, 2, error=fmpq(1, 8)), waves(6, 5, error=fmpq(1, 16))
    motion = by_hand(drive(5, displacement=["5/4"]), {1: right}, {2: left})
    (place,) = motion.probes
    taus = [fmpq(k, 8) for k in range(3, 41)]
    for tau, ball in zip(taus, enclosures(motion, place, taus), strict=True):
        # nothing is sent before tau = 0
        moved = 2 * (tau - fmpq(1, 4)) + 5 * max(tau - fmpq(3, 4), fmpq(0))
        off = (tau - fmpq(1, 4)) / 8 + max(tau - fmpq(3, 4), fmpq(0)) / 16
        assert ball.contains(arb(moved + off) - fmpq(1, 2**40))
        assert ball.contains(arb(moved - off) + fmpq(1, 2**40))
        assert ball.rad() < off + fmpq(1, 2**20)


BLOW = {"type": "collision", "m": 4, "kappa": [1, 2], "velocity": [1, 0]}


@pytest.mark.parametrize("quantity", ["strain", "velocity", "displacement"])
@pytest.mark.parametrize(("system", "load", "place"), [(DRIVE, LOAD, "3/2"), (BLOW, [], "5/2")])
def test_what_begins_without_a_jump_is_exactly_0_there(system, load, place, quantity):
    """A body moves, from rest, as a moment begins; what a blow sends off jumps, and only displacements do not."""
    motion = made(wavesym.Scene(name="motion", system=system, load=load, output={"until": 3, quantity: [place]}))
    first, later = enclosures(motion, motion.probes[0], [fmpq(1, 2), fmpq(1, 2) + fmpq(1, 2**20)])
    assert (first == 0) == (system is DRIVE or quantity == "displacement")
    assert not later.contains(0)


def test_a_displacement_begins_at_0_and_goes_on_where_it_was():
    steady = [Enclosure(arb_poly([1, 2 + n]), arb(0)) for n in range(4)]
    motion = by_hand(drive(3, displacement=["5/4"]), {1: steady}, {2: steady})
    segments = motion.segments(motion.probes[0], ctx.prec)
    assert Balls(segments).evaluate(fmpq(0)) == 0
    for one, other in pairwise(segments):
        assert one.evaluate(other.start - one.start).overlaps(other.evaluate(fmpq(0)))
        assert other.evaluate(fmpq(0)).rad() < fmpq(1, 2**90)


def test_places_with_sides_lie_in_the_rod_on_that_side():
    strain = drive(2, strain=["0", "1/3", "1-", "1+", "3"], velocity=[0, 1, 3], displacement=["5/2"])
    rods = [(probe.rod, probe.place) for probe in made(strain).probes]
    expected = [(1, 0), (1, "1/3"), (1, 1), (2, 0), (3, 1), (1, 0), (1, 1), (3, 1), (3, "1/2")]
    assert rods == [(rod, rational(Fraction(lag))) for rod, lag in expected]


def test_segments_start_where_an_output_can_bend():
    motion = made(drive("7/2", strain=["4/3"]))
    (place,) = motion.probes  # a load at 0 and at 1/3, seen 1/3 and 2/3 later
    assert motion.starts(place) == [fmpq(k, 3) for k in range(11)]
    motion = made(drive(1, [{"body": 2, "times": ["1/2"], "steps": [1]}], strain=["5/4"]))
    (place,) = motion.probes
    assert motion.starts(place) == [fmpq(0), fmpq(1, 4), fmpq(3, 4)]
    assert motion.segments(place, ctx.prec)[0].evaluate(fmpq(1, 8)) == 0


@pytest.mark.parametrize("quantity", ["strain", "velocity", "displacement"])
def test_segments_for_some_taus_are_those_of_all(quantity):
    motion = made(drive(6, **{quantity: ["4/3"]}))
    (place,) = motion.probes
    every = {segment.start: segment.families for segment in motion.segments(place, ctx.prec)}
    taus = [fmpq(0), fmpq(1, 3), fmpq(5, 2), fmpq(29, 10), fmpq(6)]
    some = motion.segments(place, ctx.prec, taus)
    assert [segment.start for segment in some] == sorted({segment.start for segment in some})
    assert len(some) == (len(every) if quantity == "displacement" else 5)
    for segment in some:
        (found,), (expected,) = segment.families.values(), every[segment.start].values()
        assert [str(c) for c in found.coeffs()] == [str(c) for c in expected.coeffs()]
    for tau in taus:
        assert str(Balls(some).evaluate(tau)) == str(Balls(motion.segments(place, ctx.prec)).evaluate(tau))


def test_of_what_begins_at_the_end_only_the_first_value_is_seen():
    motion = made(drive(3, strain=["1+"]))
    last = motion.segments(motion.probes[0], ctx.prec)[-1]
    assert last.start == 3
    (polynomial,) = last.families.values()
    assert polynomial.length() == 1
    exact = Truth(drive(3, strain=["1+"]), Fraction(3))
    assert last.evaluate(fmpq(0)).overlaps(exact.value(0, Fraction(3)))


def test_loads_after_the_horizon_are_not_there():
    late = [{"body": 2, "times": ["1/2", "29/10", "31/10"], "steps": [1, 2, 3]}]
    motion = made(drive(3, late, strain=["1/2"]))
    assert motion._breakpoints.joints[0][:4] == [fmpq(0), fmpq(1, 2), fmpq(9, 10), fmpq(1)]
    at_the_end = made(drive(3, [{"body": 2, "times": [3], "steps": [1]}], velocity=[1]))
    assert at_the_end._acting == (AppliedLoad("M2", fmpq(3), fmpq(1)),)


def test_more_bits_make_smaller_balls_and_fewer_do_not_spoil_them():
    motion = made(drive(4, strain=["1/3"]))
    (place,) = motion.probes
    (first,) = enclosures(motion, place, [fmpq(7, 2)])
    with ctx.workprec(256):
        (better,) = enclosures(motion, place, [fmpq(7, 2)])
        assert better.rad() < first.rad() * fmpq(1, 2**100)
    (again,) = enclosures(motion, place, [fmpq(7, 2)])
    assert again.overlaps(better)
    assert again.rad() <= first.rad()


def test_nothing_is_zero_but_what_has_no_terms():
    still = made(drive(1, strain=["5/2"]))
    assert is_zero(still.segments(still.probes[0], ctx.prec))
    moving = made(drive(4, strain=["5/2"]))
    assert not is_zero(moving.segments(moving.probes[0], ctx.prec))


def test_too_many_windows_are_refused_before_the_first(monkeypatch):
    def begun(*_, **__):
        raise AssertionError("waves were begun")

    monkeypatch.setattr(room, "NetworkWaves", begun)
    why = r"^output.until: 4 nodes times 5000 units of tau are 20004 stretches to keep, the limit is 20000"
    with pytest.raises(CostError, match=why):
        made(drive(5000, strain=["1/2"]))
    made(drive("4999.9", strain=["1/2"]))


def test_values_that_would_take_minutes_are_refused_before_the_first(monkeypatch):
    def begun(*_, **__):
        raise AssertionError("waves were begun")

    monkeypatch.setattr(room, "NetworkWaves", begun)
    motion = made(drive(2000, strain=["1/2"]))
    motion.refuse_long(1)
    with pytest.raises(
        CostError, match=r"^output: 1000000 values of 1 outputs to tau = 2000 would take about \d+ s, the limit is 60"
    ):
        motion.refuse_long(1_000_000)


@pytest.mark.parametrize("light", ["1e-290", "1e-300"])
def test_bodies_too_light_for_any_bits_are_refused_in_a_line(light):
    """Terms of their series are more than a float holds where they are raised to the power of 3/2."""
    parts = ["fixed", {"rod": 1}, {"mass": light, "name": "a"}]
    system = {"type": "chain", "parts": parts, "gravity": "1e-300", "initial": "static"}
    scene = wavesym.Scene.model_validate({"name": "light", "system": system, "output": {"until": 3, "force": ["1/2"]}})
    with pytest.raises(CostError, match=r"1048576 bits .*heavier bodies help"):
        scene.run()


@pytest.mark.parametrize("quantity", ["strain", "displacement"])
@pytest.mark.parametrize("taus", [3, 1000])
def test_the_seconds_told_are_those_of_segments_and_values(quantity, taus, monkeypatch):
    """Counted apart, a second for each: of a displacement all segments are needed for any value."""
    motion = made(drive("39/10", [{"body": 2, "times": [0, "1/2"], "steps": [1, 1]}], **{quantity: ["1/2", "3/2"]}))
    terms = motion.waves(ctx.prec).sent[End(0, 1)].stretches[1].polynomial.length()
    made_for = sum(len(motion.segments(place, ctx.prec)) for place in motion.probes)
    expected = made_for if quantity == "displacement" else min(made_for, 2 * taus)
    assert terms == motion.terms(motion.first_bits) > 16
    monkeypatch.setattr(room, "MOST_SECONDS", -1)
    for composed, evaluated, seconds in ((1, 0, expected * terms**1.5), (0, 1, 2 * taus * terms)):
        monkeypatch.setattr(room, "_COMPOSED", composed)
        monkeypatch.setattr(room, "_EVALUATED", evaluated)
        with pytest.raises(CostError, match=rf"would take about {seconds:.0f} s, the limit"):
            motion.refuse_long(taus)


def test_outputs_of_one_place_share_what_is_shifted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A displacement asks for the waves of the strain before it; at another place nothing is shared."""
    count = 0
    shift = room.shift

    def counted(known: Enclosure, by: fmpq) -> Enclosure:
        nonlocal count
        count += 1
        return shift(known, by)

    def shifts(*places: str) -> tuple[int, list[arb]]:
        nonlocal count
        parts = [{"mass": 1, "velocity": 1}, {"rod": 1}, {"mass": 2, "spring": 1, "velocity": 0}]
        output = {"until": 12, "displacement": places[:1], "strain": places[1:]}
        model = lower(wavesym.Scene(name="bar", system={"type": "chain", "parts": parts}, output=output))
        moving = Motion(model, model.until)
        count = 0
        *_, last = (moving.segments(probe, 192) for probe in model.probes)
        return count, [segment.families[fmpq(0)](arb(fmpq(1, 100))) for segment in last]

    monkeypatch.setattr(room, "shift", counted)
    alone, values = shifts("2/3", "1/3")
    shared, same = shifts("2/3", "2/3")
    assert shared < 0.75 * alone
    assert all(one.overlaps(other) and other.rad() == one.rad() for one, other in zip(values, same, strict=True))
