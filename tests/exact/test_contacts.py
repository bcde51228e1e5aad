"""Contacts that open and close: against an exact solver of its own, and what must hold of every chain."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb, ctx, fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.parting import Rod, Struck
from tests.support.touching import FIXED, at, body, contact, line, q, rod, seen, told, values
from wavesym.errors import CostError, WavesymError
from wavesym.exact.arrivals import identically_zero
from wavesym.exact.breakpoints import Breakpoints
from wavesym.exact.contacts import cost, guards
from wavesym.exact.contacts import schedule as room
from wavesym.exact.contacts.cluster import Cluster, Touch
from wavesym.exact.contacts.course import Course
from wavesym.exact.contacts.events import contact_schedule, events
from wavesym.exact.contacts.guards import BranchEnd
from wavesym.exact.contacts.schedule import GrazingError
from wavesym.exact.joints.enclosure import Enclosure, scale_terms
from wavesym.exact.reference import Reference
from wavesym.pictures.field import Field
from wavesym.scene import Scene, lower

DELAYS = [1, 1, "1/2", "3/2", "1.000000001"]
IMPEDANCES = [1, 1, 2, "1/3"]
GAPS = [0, 0, "1/3", "1/7", "1e-12", 1]
VELOCITIES = [0, 0, 1, -1, "1/2"]


@st.composite
def bars(draw):
    """Bars in a line: (delay, impedance, velocity) of each, and what is between them."""
    number = draw(st.integers(1, 3))
    rods = [tuple(q(draw(st.sampled_from(each))) for each in (DELAYS, IMPEDANCES, VELOCITIES)) for _ in range(number)]
    gap = st.sampled_from(GAPS).map(q)
    ends = [draw(st.one_of(st.sampled_from(["free", "fixed"]), gap)) for _ in range(2)]
    inner = [draw(st.one_of(st.just("joint"), gap, gap)) for _ in range(number - 1)]
    return rods, [ends[0], *inner, ends[1]]


def drawn(rods, between, until=7):
    parts = []
    if between[0] == "fixed" or isinstance(between[0], fmpq):
        parts.append(FIXED)
    for k, place in enumerate(between):
        if isinstance(place, fmpq):
            parts.append(contact(place))
        if k < len(rods):
            delay, impedance, velocity = rods[k]
            parts.append(rod(delay, impedance, 1, velocity))
    if between[-1] == "fixed" or isinstance(between[-1], fmpq):
        parts.append(FIXED)
    return line(parts, until)


def fraction(value):
    return Fraction(int(value.p), int(value.q)) if isinstance(value, fmpq) else value


def agree(rods, between, until=7):
    """Whether the events are those of the other solver, all of them."""
    other = Struck([Rod(*map(fraction, each)) for each in rods], list(map(fraction, between)))
    places = [k for k, place in enumerate(between) if isinstance(place, fmpq)]
    truth = sorted((tau, str(places.index(k)), kind) for k, kind, tau in other.events(Fraction(until)))
    found = told(drawn(rods, between, until))
    return len(found) == len(truth) and all(
        (x, kind) == known[1:] and at(event, known[0]) for (x, kind, event), known in zip(found, truth, strict=True)
    )


@settings(max_examples=40)
@given(bars())
def test_bars_strike_and_part_when_an_exact_solver_says(chain):
    assert agree(*chain)


TRAIN = (
    [(q(1), q(1), q(1)), (q("3/2"), q(2), q(0)), (q(1), q(1), q(-1))],
    [q("1/3"), q("1/7"), q("2/5"), q("1/2")],
)


def test_a_train_between_walls():
    assert agree(*TRAIN, until=20)


@pytest.mark.slow
def test_five_hundred_events():
    assert len(told(drawn(*TRAIN, until=70))) > 500
    assert agree(*TRAIN, until=70)


def test_two_contacts_close_at_one_instant():
    same = [(q(1), q(1), q(1)), (q(1), q(1), q(0)), (q(1), q(1), q(-1))]
    assert agree(same, ["free", q("1/4"), q("1/4"), "free"])


@pytest.mark.parametrize("length", [1, "1.000000001"])
@pytest.mark.parametrize("gap", [0, "1e-12", 1, 2])
def test_events_at_a_front_or_just_after_it(length, gap):
    """A gap of 1 or 2 closes just as a front arrives."""
    assert agree([(q(1), q(1), q(1)), (q(length), q(1), q(0))], ["fixed", q(gap), "free"])


@pytest.mark.parametrize("late", [0, "1e-30", "-1e-30"])
def test_an_event_at_the_end_of_the_horizon_counts(late):
    """It is seen at the end, as a jump is; what comes later is not."""
    model = line([rod(velocity=1), contact("1/2"), rod()], q("1/2") - q(late))
    assert len(told(model)) == (0 if late == "1e-30" and Reference(model).tau_max < 0.5 else 1)
    assert len(told(line([rod(velocity=1), contact("1/2"), rod()], "0.4"))) == 0


# ---- faults put in on purpose


def differs():
    """Whether a fault shows: in other events, or in a bound that cannot be had."""
    room.outcome.cache_clear()
    try:
        return not agree(*TRAIN)
    except (ArithmeticError, IndexError, WavesymError):
        return True


def test_a_force_of_the_wrong_sign_is_seen(monkeypatch):
    made = Cluster.from_law

    def wrong(*arguments):
        cluster = made(*arguments)
        pushes = {n: [(k, -factor) for k, factor in push] for n, push in cluster.pushes.items()}
        return replace(cluster, pushes=pushes)

    monkeypatch.setattr(Cluster, "from_law", wrong)
    assert differs()


def test_a_gap_of_the_wrong_sign_is_seen(monkeypatch):
    rate = Touch.rate_terms
    monkeypatch.setattr(Touch, "rate_terms", lambda touch, velocities: scale_terms(rate(touch, velocities), fmpq(-1)))
    assert differs()


def test_an_event_that_is_late_is_seen(monkeypatch):
    end = Course._branch_end

    def late(*arguments):
        found = end(*arguments)
        return found and BranchEnd(found.length + fmpq(1, 1000), found.spread)

    monkeypatch.setattr(Course, "_branch_end", late)
    assert differs()


@pytest.fixture(autouse=True)
def _afresh():
    yield
    room.outcome.cache_clear()


# ---- what must hold of every chain

STRIKING = [body(2, velocity=1), contact(), rod(), body("1/2"), contact("1/5"), rod("3/2", 2), FIXED]


def moved(parts, taus, watched, until=6):
    return values(line(parts, until, watched), taus)


def same(one, other):
    return all(
        abs(a - b) < fmpq(1, 10**30)
        for row, line in zip(one, other, strict=True)
        for a, b in zip(row, line, strict=True)
    )


TAUS = [q(k) / 7 for k in range(42)]


def test_a_contact_that_never_opens_or_never_closes_changes_nothing():
    pressed = [body(2, velocity=1), rod(8), contact(), rod(8, 2)]
    joined = [body(2, velocity=1), rod(8), rod(8, 2)]
    assert told(line(pressed, 6)) == []
    watched = [seen(0, "1/2"), seen(1, "1/3")]
    assert same(moved(pressed, TAUS, watched), moved(joined, TAUS, watched))
    apart = [body(2, velocity=1), rod(), contact(100), rod(1, 2)]
    assert same(moved(apart, TAUS, [seen(0, "1/2")]), moved([body(2, velocity=1), rod()], TAUS, [seen(0, "1/2")]))


@pytest.mark.slow
def test_splitting_a_rod_changes_nothing():
    split = [*STRIKING[:2], rod("1/3"), rod("2/3"), *STRIKING[3:]]
    whole = moved(STRIKING, TAUS, [seen(0, 0), seen(1, "1/2")])
    assert same(whole, moved(split, TAUS, [seen(0, 0), seen(2, "1/2")]))


@pytest.mark.slow
def test_a_mirror_changes_only_signs():
    mirrored = [FIXED, rod("3/2", 2), contact("1/5"), body("1/2"), rod(), contact(), body(2, velocity=-1)]
    one = moved(STRIKING, TAUS, [seen(0, "1/3"), seen(1, "1/2")])
    other = moved(mirrored, TAUS, [seen(1, "2/3"), seen(0, "1/2")])
    assert same(one, [[-value for value in row] for row in other])


@pytest.mark.slow
def test_outputs_of_single_precision_and_fields_know_of_contacts():
    from wavesym.numbers.reals import SINGLE

    model = line(STRIKING, 6)
    assert [(e.x, e.kind) for e in events(model, SINGLE)] == [(e.x, e.kind) for e in events(model)]
    import numpy as np

    velocity, _ = Field(model).values_at(0, np.zeros(3), np.array([0.25, 1.5, 5.5]))
    (exact,) = values(model, ["1/4", "3/2", "11/2"])
    assert velocity == pytest.approx([float(v.p) / float(v.q) for v in exact], abs=1e-12)
    assert identically_zero(model, q(6)) == [False]
    assert Breakpoints(model, q(6)).stretches > 20


def test_a_gap_that_is_touched_exactly_stays_open():
    """A body thrown against its weight that just reaches a rod: rational data tell that nothing happens."""
    assert told(line([body(1, velocity=1, force=-1), contact("1/2"), rod()], "3/2")) == []
    struck = told(line([body(1, velocity=1, force=-1), contact(q("1/2") - fmpq(1, 10**40)), rod()], "3/2"))
    assert [kind for _, kind, _ in struck] == ["closes", "opens"]


def test_a_contact_that_no_bits_decide_is_refused_with_the_instant(monkeypatch):
    """The same where nothing is known exactly."""
    monkeypatch.setattr(guards, "first_fall", lambda p, low, high: (low, high) if p(high) < p(low) else None)
    monkeypatch.setattr(room, "_ATTEMPTS", ((384, True), (768, False)))
    model = line([body(1, velocity=1, force=-1), contact("1/2"), rod()], "3/2")
    inexact = Enclosure.from_polynomial

    def blurred(exact):
        known = inexact(exact)
        return Enclosure(known.polynomial, arb(2) ** -300) if exact.length() > 1 else known

    monkeypatch.setattr("wavesym.exact.contacts.steady_motion.Enclosure.from_polynomial", blurred)
    with pytest.raises(
        GrazingError, match=r"^contact at 0: \d+ bits do not show the sign of its gap at tau = (1|0\.9+\d*) "
    ):
        events(model)


def energy(parts, tau):
    """Of all rods and bodies: Z/2 (p^2 + r^2) over each rod, from its waves at places between all fronts."""
    model = line(parts, 8)
    network = model.network
    cuts = sorted({fmpq(k, 64) for k in range(65)})
    total = 0.0
    watched = [
        seen(k, place, kind) for k in range(len(network.bars)) for place in cuts for kind in ("velocity", "strain")
    ]
    rows = values(line(parts, 8, watched), [tau])
    numbers = [float(row[0].p) / float(row[0].q) for row in rows]
    for k, bar in enumerate(network.bars):
        each = numbers[130 * k : 130 * k + 130]
        density = [(v * v + e * e) / 2 for v, e in zip(each[::2], each[1::2], strict=True)]
        mean = (sum(density[1:-1]) + (density[0] + density[-1]) / 2) / 64
        total += float(bar.impedance.p) / float(bar.impedance.q) * mean * float(bar.length.p) / float(bar.length.q)
    return total


@pytest.mark.slow
def test_energy_is_lost_where_a_body_strikes_only_at_fronts_and_never_grows():
    """Rods that strike each other lose none; on a grid of a rod it is had but for its fronts."""
    parts = [FIXED, contact("1/3"), rod(velocity=-1), contact("1/8"), rod("3/2", 2), FIXED]
    begun = energy(parts, q(0))
    assert begun == pytest.approx(0.5, rel=0.05)
    for tau in (1, 2, "7/2", 5, 7):
        assert energy(parts, q(tau)) == pytest.approx(begun, rel=0.05)


def test_bouncing_ever_faster_ends_with_the_count(monkeypatch):
    """A body that is pressed on a bar comes back sooner each time, and fronts of all bounces go on for ever."""
    monkeypatch.setattr(cost, "MOST_SERIES", 90)
    with pytest.raises(CostError, match=r"openings and closings of contacts make more than 90 stretches by tau = "):
        events(line([body(1, velocity=1, force=3), contact("1/10"), rod(), FIXED], 400))


def test_what_swings_too_fast_is_foretold(monkeypatch):
    """What nothing damps swings on: each stretch bears exp(20) of its rate."""
    monkeypatch.setattr(cost, "_RECKONED", 32)
    parts = [body(1, velocity=1, stiffness=10**12), contact("1/4"), rod()]
    with pytest.raises(
        CostError,
        match=r"at a rate of 1e\+06, .* make 32 stretches .* would be 4.* by tau = 8, the limit",
    ):
        events(line(parts, 8))


@pytest.mark.slow
def test_a_cap_with_hardly_any_mass_is_served():
    """It answers at a rate of 1.25e6, and dies away: no stretch is cut for it then."""
    for mass in ("1e-6", 0, "1e-2"):
        parts = [body(mass, stiffness=4, damping="1/4"), contact(), rod(velocity=-1), rod(1, 2)]
        assert events(line(parts, 3))


def test_waves_that_contacts_were_found_with_are_those_of_the_chain_moved_anew():
    model = line([body(1, velocity=1, force="1/2"), contact("1/10"), rod(), rod("1/2", 2), FIXED], 6)
    last = tuple(model.joints_in_reach(model.until).items())
    known = room.schedule(model.network, model.loads, last)
    assert known.changes
    with ctx.workprec(2 * known.bits):
        anew = room.replay(model.network, known.stages, known.breakpoints, model.loads)
    for bits in (64, 256):
        kept = room.waves(model.network, model.loads, known, bits)
        for end, wave in kept.sent.items():
            until = known.ends[model.network.joint_of[model.network.point_at(end)]]
            for tau in (until * k / 60 for k in range(60)):
                (one, since), (other, after) = wave.locate(tau), anew.sent[end].locate(tau)
                with ctx.workprec(bits):
                    assert one.evaluate(since).overlaps(other.evaluate(after))
                    assert one.evaluate(since).rad() < arb(2) ** (20 - bits)


def test_light_cones_take_a_contact_for_closed():
    far = [rod(1, velocity=1), contact("1/2"), rod(), contact("1/2"), rod(), contact("1/2"), rod(velocity=-1)]
    near = line(far, "3/2", [seen(0, "1/2")])
    assert len(near.contacts(near.until)) == 2
    with ctx.workprec(64):
        assert all(event.tau <= arb(near.until) for event in events(near))
    assert {event.x for event in events(near)} <= {"0", "1"}


def test_what_would_be_known_too_little_is_found_with_more_bits(monkeypatch, thorough):
    """Instants found with twice the bits lie within those found before, and waves are known as much better."""
    text = {"spring": 50, "yield": [5, 0]}
    parts = [{"mass": 2, "velocity": 4}, {"spring": 90, "only": "push"}, {"rod": 1}, {"joint": True, **text}]
    output = {"until": 6 if thorough else 3, "velocity": ["1/2"]}
    model = lower(Scene(name="pile", system={"type": "chain", "parts": parts}, output=output))
    found = []
    for kept in (64, 420):
        room.outcome.cache_clear()
        monkeypatch.setattr(room, "_KEPT_BITS", kept)
        found.append(contact_schedule(model, model.until))
    room.outcome.cache_clear()
    once, twice = found
    assert (once.bits, twice.bits) == (448, 896)
    assert len(once.changes) == len(twice.changes) > 2
    for one, other in zip(once.changes, twice.changes, strict=True):
        assert one.link == other.link
        assert abs(one.low - other.low) < fmpq(1, 2**200)
    errors = [max(known.error for wave in each.waves.sent.values() for known in wave.stretches) for each in found]
    assert errors[1] < errors[0] * arb(2) ** -300
