"""Waves of networks: where they are said to be, from knot to knot."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from flint import arb, arb_poly, ctx, fmpq

import wavesym
from tests.support.truth import Truth
from wavesym.errors import CostError
from wavesym.exact import breakpoints as room
from wavesym.exact.breakpoints import Breakpoints
from wavesym.exact.joints.enclosure import Enclosure
from wavesym.exact.joints.network_waves import NetworkWaves, SentWave
from wavesym.exact.reference import Reference
from wavesym.mechanics.network import Bar, End, Link, Network, Point
from wavesym.numbers.doubles import rational
from wavesym.scene import lower

SYSTEMS = {
    "collision": {"type": "collision", "m": 6, "kappa": ["1/10", 2, "1/5"], "velocity": [1, "1/3", "-1/2"]},
    "drive": {"type": "drive", "m": 3, "kappa": ["1/2", 2, "1/3"], "inertia": [1, 2, 3, "1/2"]},
    "force": {"type": "building", "m": 2, "kappa": ["1/4", "3/5", 2], "base": "force"},
    "ground": {"type": "building", "m": 3, "kappa": ["1/4", 3, "1/5", 1], "base": "ground"},
}
LOADS = {
    "drive": [{"body": 1, "times": [0, "7/3"], "steps": [1, "-1/2"]}, {"body": 4, "times": ["3/2"], "steps": [2]}],
    "force": [{"times": ["1/3", "5/2"], "a": [1, -2], "b": ["1/2", 1]}],
    "ground": [{"times": ["1/3", "3/2"], "a": [1, -2], "b": ["1/2", 1]}],
}


def watched(name):
    """A scene with velocity and strain on either side of every node."""
    system = SYSTEMS[name]
    m, collision = system["m"], system["type"] == "collision"
    nodes = range(m + 1)
    divided = [x for x in nodes if 0 < x < m and (x % 2 or not collision)]
    strain = [str(x) for x in nodes if x not in divided] + [f"{x}{side}" for x in divided for side in "-+"]
    output = {"until": 4, "velocity": list(nodes), "strain": strain}
    return wavesym.Scene(name=name, system=system, load=LOADS.get(name, []), output=output)


@pytest.mark.parametrize("terms", [4, 12, 60])
@pytest.mark.parametrize("name", SYSTEMS)
def test_waves_are_where_they_are_said_to_be(name, terms):
    """In a rod the velocity is p + r and the strain r - p: half their difference goes right, half their sum left."""
    scene = watched(name)
    model = lower(scene)
    exact = Truth(scene, scene.output.until)
    number = {(o.quantity, o.x, o.side): k for k, o in enumerate(scene.outputs)}
    loosest = arb(0)
    with ctx.workprec(256):
        waves = NetworkWaves(model.network, Breakpoints(model, model.until).joints, model.loads, terms)
        for tau in (fmpq(k) + part for k in range(4) for part in (fmpq(0), fmpq(5, 14), fmpq(5, 7))):
            at = Fraction(int(tau.p), int(tau.q))
            for x in range(scene.system.m + 1):
                velocity = exact.value(number["velocity", x, 0], at, 200)
                for bar, side, way in ((x - 1, 1, -1), (x, 0, 1)):
                    if not 0 <= bar < scene.system.m:
                        continue
                    divided = ("strain", x, way) in number
                    strain = exact.value(number["strain", x, way if divided else 0], at, 200)
                    sent, offset = waves.sent[End(bar, side)].locate(tau)
                    found = sent.evaluate(offset)
                    assert found.overlaps((velocity - way * strain) / 2), (tau, x, way)
                    loosest = loosest.max(found.rad())
    assert terms < 60 or loosest < fmpq(1, 10**15)


@pytest.mark.parametrize("error", [fmpq(1), fmpq(1, 8)])
def test_a_wave_is_anywhere_within_its_error(error):
    value = Enclosure(arb_poly([3, 2]), arb(error)).evaluate(fmpq(5))
    assert value.contains(13 + arb(error))
    assert value.contains(13 - arb(error))
    assert Enclosure(arb_poly([3, 2]), arb(0)).evaluate(fmpq(5)) == 13


def test_the_wave_at_a_stretchs_start_is_the_one_that_begins_there():
    stretches = [Enclosure(arb_poly([k]), arb(0)) for k in range(3)]
    wave = SentWave([fmpq(-1), fmpq(0), fmpq(1, 3)], stretches)
    for tau, place, offset in ((fmpq(-1, 2), 0, fmpq(1, 2)), (fmpq(0), 1, fmpq(0)), (fmpq(1, 3), 2, fmpq(0))):
        assert wave.locate(tau) == (stretches[place], offset)


def test_what_a_rod_holds_at_the_start():
    bar = Bar(0, 1, fmpq(1), fmpq(3), fmpq(1), velocity=fmpq(5), strain=fmpq(1, 2))
    right, left = bar.initial_wave(0), bar.initial_wave(1)
    assert right + left == 5  # velocity
    assert (left - right) / 3 == fmpq(1, 2)  # strain


def test_at_rest_is_what_goes_on_as_it_is():
    still = Point(fmpq(1))
    bars = (Bar(0, 1, fmpq(1), fmpq(1), fmpq(1)), Bar(1, 2, fmpq(1), fmpq(1), fmpq(2)))
    assert all(map(Network((still, still, still), bars).at_rest, Network((still, still, still), bars).joints))
    moving = Network((Point(fmpq(1), velocity=fmpq(1)), still, still), bars)
    assert [moving.at_rest(joint) for joint in moving.joints] == [False, True, True]
    strained = (Bar(0, 1, fmpq(1), fmpq(1), fmpq(1), strain=fmpq(1)), bars[1])
    pulled = Network((still, still, still), strained)
    assert [pulled.at_rest(joint) for joint in pulled.joints] == [False, False, True]
    linked = Network((still, Point(fmpq(1), velocity=fmpq(1))), bars[:1], (Link(0, 1, fmpq(1)),))
    assert not linked.at_rest(linked.joints[0])


def chain(lengths, until, output=None, load=None):
    parts = [{"mass": 1, "name": "a"}]
    for length in lengths:
        parts += [{"rod": length}, {"mass": 1}]
    return lower(
        wavesym.Scene(
            name="knots",
            system={"type": "chain", "parts": parts},
            load=load or [{"at": "a", "times": [0], "steps": [1]}],
            output={"until": until, **(output or {"velocity": ["a"]})},
        )
    )


def test_knots_are_sums_of_delays():
    """Every way from the loaded body and back: 2 a + 2 b ... for rods a, b, as far as it is felt in time."""
    model = chain([1, "3/2"], 6)
    joints = Breakpoints(model, model.until).joints
    first = {2 * a + 3 * b for a in range(4) for b in range(3) if not (b and not a) and 2 * a + 3 * b <= 6}
    assert joints[0][:-1] == sorted(fmpq(k) for k in first)
    assert [k for k in joints[2] if k <= 5][1:4] == [fmpq(5, 2), fmpq(9, 2)][:3] + joints[2][3:4]


@pytest.mark.parametrize(
    ("lengths", "most"), [([1, "1.001"], 320), ([1, "1.414213562", "1.732050808"], 1000), ([1, 1], 70)]
)
def test_nearly_equal_lengths_cost_their_knots(lengths, most):
    model = chain(lengths, 20)
    assert Breakpoints(model, model.until).stretches < most


def test_too_many_knots_are_refused_with_their_count(monkeypatch):
    monkeypatch.setattr(room, "MOST_BREAKPOINTS", 100)
    model = chain([1, "1.414213562", "1.732050808"], 20)
    with pytest.raises(CostError, match=r"fronts meet joints more than 100 times by tau = \d"):
        _ = Breakpoints(model, model.until).stretches


def test_equal_lengths_have_windows():
    model = chain([2, 2], 5, load=[{"at": "a", "times": ["1/2"], "steps": [1]}])
    joints = Breakpoints(model, model.until).joints
    assert joints[0] == [fmpq(k, 2) for k in (0, 1, 4, 5, 8, 9, 12)]
    (probe,) = model.probes
    assert Breakpoints(model, model.until).of_output(model.sums[probe]) == [fmpq(k, 2) for k in (0, 1, 4, 5, 8, 9)]


def test_only_what_can_be_felt_is_moved():
    model = chain([1] * 9, 3, {"velocity": [2]})
    assert sorted(Breakpoints(model, model.until).joints) == [0, 1, 2, 3, 4, 5]
    assert model.joints_in_reach(rational(3))[5] == 0


def test_an_absorbing_end_sends_exactly_nothing():
    """Not little: exact impedances cancel exactly, at a joint of equal rods and at the end that takes all."""
    parts = [{"mass": 1, "name": "a"}, {"rod": 1, "impedance": "1.7"}, {"joint": True}, {"rod": 1, "impedance": "1.7"}]
    load = [{"at": "a", "times": [0], "steps": [1]}]
    system = {"type": "chain", "parts": [*parts, "absorbing"]}
    model = lower(wavesym.Scene(name="ends", system=system, load=load, output={"until": 8, "velocity": ["a"]}))
    with ctx.workprec(128):
        waves = NetworkWaves(model.network, Breakpoints(model, model.until).joints, model.loads, 32)
    for bar in (0, 1):
        for known in waves.sent[End(bar, 1)].stretches:
            assert known.polynomial.length() == 0
            assert known.error == 0


def test_a_rod_that_is_longer_than_the_horizon_costs_nothing():
    """Its window is cut at the horizon; half of infinity is a dashpot: 1 - exp(-tau)."""
    model = chain(["1e12"], 6, load=[{"at": "a", "times": ["5/2"], "steps": [1]}])
    assert max(Breakpoints(model, model.until).joints[0]) == 7
    (values,) = Reference(model).values([2.5, 3.5, 6.0])
    assert values == pytest.approx([0.0, *(1 - math.exp(2.5 - tau) for tau in (3.5, 6.0))], rel=1e-15)
