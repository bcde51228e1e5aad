"""Acceleration, force, drift and relative motion: what they are, from what velocities and displacements do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx, fmpq
from hypothesis import HealthCheck, assume, given, settings

import wavesym
from tests.support.chains import chains
from tests.support.drawn import loads, systems
from wavesym.derivation.increments import Increment, add, start, trim
from wavesym.errors import CostError
from wavesym.exact.arrivals import identically_zero
from wavesym.exact.motion import Motion
from wavesym.exact.tables.ball import Balls
from wavesym.exact.tables.signal import Signal, signals
from wavesym.mechanics import gauge
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import rational
from wavesym.scene import Scene, lower

UNTIL = "61/13"  # no front comes then
FEW = settings(max_examples=10, suppress_health_check=list(HealthCheck))


def watched(system: Mapping[str, Any], load: list[Any], **outputs: object) -> Model:
    return lower(Scene(name="drawn", system=system, load=load, output={"until": UNTIL, **outputs}))


def derived(increment: Increment) -> Increment:
    """The derivative of sum exp(-g w) F[g,k] w**k."""
    found: Increment = {}
    for rate, powers in increment.items():
        add(found, {rate: [k * c for k, c in enumerate(powers)][1:]})
        add(found, {rate: powers}, -rate)
    return trim(found)


def gains(signal: Signal) -> dict[fmpq, Increment]:
    return {arrival.time: arrival.increment for arrival in signal.arrivals}


def total(parts: Mapping[Signal, fmpq]) -> dict[fmpq, Increment]:
    """A sum of signals, each with its factor."""
    found: dict[fmpq, Increment] = {}
    for signal, factor in parts.items():
        for arrival in signal.arrivals:
            add(found.setdefault(arrival.time, {}), arrival.increment, factor)
    return {time: kept for time, increment in found.items() if (kept := trim(increment))}


class Frozen(Signal):
    """A signal that keys a table."""

    __hash__ = object.__hash__


@given(systems(largest=3).flatmap(lambda system: loads(system).map(lambda load: (system, load))))
@FEW
def test_of_a_named_system_all_are_exactly_what_motion_makes_of_them(drawn: Any) -> None:
    system, load = drawn
    m = system["m"]
    heavy = range(1, m, 2) if system["type"] == "collision" else range(system["type"] == "building", m + 1)
    places = [*range(m + 1), "1/3"]
    asked: dict[str, Any] = {"velocity": places, "displacement": places, "drift": range(1, m + 1)}
    asked |= {"acceleration": list(heavy), "strain": ["1/3"], "force": ["1/3"]}
    if system["type"] == "building":
        asked["relative"] = places
    asked = {quantity: [str(place) for place in found] for quantity, found in asked.items()}
    model = watched(system, load, **asked)
    found = {signal.name: Frozen(signal.name, signal.arrivals) for signal in signals(model)}
    started = {"collision": system.get("velocity", ())}.get(system["type"], [Fraction(0)] * (m + 1))
    for n, x in enumerate(heavy):
        moving = gains(found[f"velocity@{x}"])
        begun = rational(started[n])
        assert all(start(gain) == (begun if time == 0 else 0) for time, gain in moving.items())
        expected = {time: kept for time, gain in moving.items() if (kept := derived(gain))}
        assert gains(found[f"acceleration@{x}"]) == expected
    place = {x: found[f"displacement@{x}"] for x in places}
    for k in range(1, m + 1):
        assert gains(found[f"drift@{k}"]) == total({place[k]: fmpq(1), place[k - 1]: fmpq(-1)})
    for x in places if "relative" in asked else ():
        assert gains(found[f"relative@{x}"]) == (total({place[x]: fmpq(1), place[0]: fmpq(-1)}) if x else {})
    impedance = model.network.bars[0].impedance
    assert gains(found["force@1/3"]) == total({found["strain@1/3"]: impedance})


def integrated(model: Model, bits: int) -> list[tuple[arb, arb]]:
    """What each acceleration adds to its velocity on each stretch, and what the velocity gains: both in balls."""
    motion = Motion(model, rational(model.horizon()))
    found = []
    with ctx.workprec(bits):
        for speed, rate in zip(motion.probes[::2], motion.probes[1::2], strict=True):
            velocity = Balls(motion.segments(speed, bits))
            pieces = motion.segments(rate, bits)
            ends = [*(piece.start for piece in pieces[1:]), motion.until]
            for piece, end in zip(pieces, ends, strict=True):
                if piece.start < end:
                    gained = piece.families[fmpq(0)].integral()(arb(end - piece.start))
                    found.append((gained, velocity.evaluate(end) - velocity.evaluate(piece.start)))
    return found


def accelerated(scene: Mapping[str, Any]) -> Model:
    """A scene's masses, velocity and acceleration of each in turn."""
    model = lower(Scene(**scene))
    heavy = [number for number, point in enumerate(model.network.points) if point.mass != 0]
    pairs = [
        Probe(f"{quantity}{n}", quantity, 0, fmpq(0), n) for n in heavy for quantity in ("velocity", "acceleration")
    ]
    shown = (replace(probe, **seen(model, probe)) for probe in pairs)
    return model.watching(shown)


def seen(model: Model, probe: Probe) -> dict[str, Any]:
    """Where a point is shown by a rod, as scenes say it."""
    if probe.quantity == "acceleration":
        return {}
    for number, bar in enumerate(model.network.bars):
        for side, point in enumerate((bar.left, bar.right)):
            if point == probe.point and bar.ratios[side] == 1:
                return {"rod": number + 1, "place": fmpq(side), "point": None}
    return {}


def agree(model: Model) -> bool:
    """Whether they do, with as many bits as it takes to see it."""
    for bits in (256, 512, 1024):
        missed = [gained - moved for gained, moved in integrated(model, bits)]
        if not all(ball.contains(0) for ball in missed):
            return False
        if all(ball.rad() < 1e-8 for ball in missed):
            return True
    return False


@given(chains(until="43/13"))
@FEW
def test_in_any_chain_the_integral_of_an_acceleration_is_its_velocity(scene: dict[str, Any]) -> None:
    model = accelerated(scene)
    assume(model.probes)
    try:
        assert agree(model)
    except CostError:
        assume(False)


PARTS = [
    {"motion": "acceleration", "name": "base"},
    {"rod": 1, "impedance": 2},
    {"mass": 1, "name": "first", "dashpot": "1/10"},
    {"rod": "3/2", "spring": 3, "dashpot": "1/4"},
    {"mass": "1/2", "spring": 2, "name": "gear"},
    {"spring": 2, "dashpot": "1/3"},
    {"mass": "1/3", "name": "hung"},
    {"rod": 1, "speed": 2},
    "contact",
    {"mass": 2, "name": "struck", "dashpot": "1/5"},
    "contact",
    {"rod": 1},
]
BRANCH = {"from": "gear", "name": "a", "ratio": -2, "parts": [{"rod": "1/2"}, {"mass": 1, "name": "tip"}]}
LOADS = [
    {"at": "base", "times": [0, 2], "ramps": [1, -1]},
    {"at": "gear", "times": ["1/2", 2], "steps": [1, -1]},
    {"at": "hung", "times": [1], "ramps": ["1/5"]},
]
ALL: dict[str, Any] = {
    "name": "everything",
    "system": {"type": "chain", "parts": PARTS, "branch": [BRANCH]},
    "load": LOADS,
    "output": {"until": "87/13", "velocity": ["hung"]},
}


def test_contacts_included() -> None:
    model = accelerated(ALL)
    assert len(model.network.corners) == 2
    assert agree(model)


@pytest.mark.parametrize(
    "part",
    [
        ('yield ReadingTerm(_ONE, Gauge("load"', 'yield ReadingTerm(-_ONE, Gauge("load"'),
        ("yield ReadingTerm(-body.damping,", "yield ReadingTerm(body.damping,"),
        ("yield ReadingTerm(-body.stiffness,", "yield ReadingTerm(body.stiffness,"),
        ("(1, -1)[side]", "(1, 1)[side]"),
        ("[side] * bar.ratios[side] *", "[side] *"),
        ("(link.right, link.ratio) if", "(link.right, -link.ratio) if"),
        ("else (link.left, 1 / link.ratio)", "else (link.left, -1 / link.ratio)"),
        ("pull = link.ratio if point == link.left else -_ONE", "pull = _ONE if point == link.left else _ONE"),
        ("_times(ratio / network.points[point].mass", "_times(2 * ratio / network.points[point].mass"),
    ],
)
def test_a_wrong_factor_is_seen(part: tuple[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    right, wrong = part
    text = open(gauge.__file__, encoding="utf-8").read()  # noqa: SIM115
    assert text.count(right) == 1
    changed: dict[str, Any] = {"__name__": gauge.__name__}
    exec(compile(text.replace(right, wrong), gauge.__file__, "exec"), changed)
    monkeypatch.setattr("wavesym.mechanics.model.readings", changed["readings"])
    assert not agree(accelerated(ALL))


def test_what_cancels_is_nothing_whatever_moves() -> None:
    """The ground moves relative to itself by nothing, and a rod that none strains does not drift."""
    chain = {"type": "chain", "parts": [{"motion": "velocity", "name": "base"}, {"rod": 1}, {"mass": 1}, {"rod": 2}]}
    load = [{"at": "base", "times": [0], "steps": [1]}]
    model = watched(chain, load, relative=["base", "3"], drift=["2"])
    assert model.sums[model.probes[1]] == ()
    assert identically_zero(model, rational(model.horizon())) == [False, True, False]
    values = wavesym.evaluator(Scene(name="a", system=chain, load=load, output={"until": 4, "relative": ["base"]}))
    assert values([0.0, 1.0, 4.0]).tolist() == [[0.0, 0.0, 0.0]]


def test_equal_pulls_on_both_sides_do_not_accelerate() -> None:
    """Waves arrive at the mass in the middle, and it never moves: no number of bits tells, a transform does."""
    push = [{"at": at, "times": ["1/3"], "steps": [sign]} for at, sign in (("one", 1), ("other", -1))]
    ends = [
        {"mass": 1, "name": "one"},
        {"rod": 1},
        {"mass": 3, "name": "middle"},
        {"rod": 1},
        {"mass": 1, "name": "other"},
    ]
    model = watched({"type": "chain", "parts": ends}, push, acceleration=["middle", "one"], drift=["1"])
    assert identically_zero(model, rational(model.horizon())) == [True, False, False]
