"""Exact tables of chains: against named systems, against a Laplace expansion of their text, and published numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from math import factorial
from typing import Any

import pytest
from flint import ctx, fmpq, fmpq_poly
from hypothesis import assume, given, settings

import wavesym
from tests.exact.test_chain_truth import STEPPED
from tests.support.chains import chains
from tests.support.drawn import scenes
from tests.support.laplace import Laplace, Ratio
from wavesym.derivation.increments import Increment, combine
from wavesym.derivation.table import Function, full_table
from wavesym.documents.named_table import named_table
from wavesym.errors import CostError, UnservedError
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.tables.ball import Balls, segments
from wavesym.exact.tables.network_joints import NetworkJoints
from wavesym.exact.tables.network_table import NetworkTable, RuledNetwork, network_table
from wavesym.exact.tables.signal import Signal, signals, signals_at
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Bar, Link, Network, Point
from wavesym.scene import Scene, lower
from wavesym.scene.explicit_text import explicit_text
from wavesym.scene.lowering import named_chain

UNTIL = 3
NOWHERE = fmpq(0)


# ---- named systems


def named_rows(model: Model, chain: Chain) -> dict[tuple[object, ...], object]:
    """The rows of the paper's recurrences, with the tau at which waves leave their nodes for intervals."""
    table = full_table(chain, None, model.until)
    found = {}
    for row in table.rows():
        tau = chain.leaves(row.function, row.rod, table.interval * (row.interval - 1))
        source = "start" if row.source == "impact" else row.source
        found[row.function, row.rod, source, tau, row.rate, row.power] = row.value
    return found


def network_rows(model: Model) -> dict[tuple[object, ...], object]:
    return {tuple(row[:-1]): row.value for row in network_table(model.network, None, model.until).rows()}


NAMED = ["collision_m4", "drive_m1", "drive_equal", "building_m2", "building_half_roof"]


@pytest.mark.parametrize("name", NAMED)
def test_the_law_of_joints_makes_the_tables_of_the_paper(name: str) -> None:
    """Clocks, lags and recurrences on the one hand, joints and exact instants on the other."""
    scene = Scene.from_toml(name)
    model = lower(scene)
    assert network_rows(model) == named_rows(model, scene.system.chain) != {}


@settings(max_examples=8)
@given(scenes())
def test_any_named_system_has_one_table(scene: Scene) -> None:
    model = lower(scene).shorten(fmpq(5))
    chain = named_chain(scene)
    assert chain is not None
    assert network_rows(model) == named_rows(model, chain)
    for intervals, until in ((None, model.until), (3, NOWHERE), (0, NOWHERE), (None, fmpq(1, 2))):
        ours, theirs = named_table(chain, model.network, intervals, until), full_table(chain, intervals, until)
        assert ours.interval == theirs.interval
        assert ours.responses == theirs.responses  # those of empty intervals, too


@pytest.mark.parametrize("name", NAMED)
def test_a_named_system_that_is_written_out_has_the_same_table(name: str, tmp_path) -> None:
    """Up to naming: what a chain calls the force on a node is so much of what the system calls a moment."""
    scene = Scene.from_toml(name)
    file = tmp_path / "explicit.toml"
    file.write_text(explicit_text(scene))
    model, explicit = lower(scene), lower(Scene.from_toml(str(file)))
    named = network_table(model.network, None, model.until).responses
    written = network_table(explicit.network, None, model.until).responses
    seen = 0
    for source, response in named.items():
        if source == "start":
            assert written["start"] == response
            seen += 1
            continue
        ((place, unit),) = [(p, u) for p in model.network.points for u in p.loads if u.source == source]
        names = [(f"{place.place}:{kind}", power) for power, kind in enumerate(("step", "ramp"))]
        if names[0][0] not in written:  # nothing acts there in this scene
            continue
        seen += 1
        # what moves by its acceleration has steps of that where its velocity has ramps
        accelerated = any(p.motion == "acceleration" for p in explicit.network.points)
        coefficients = [k * c for k, c in enumerate(unit.coefficients) if k] if accelerated else unit.coefficients
        for function, increments in response.items():
            parts: dict[object, list[tuple[fmpq, Increment]]] = {}
            for name_, power in names:
                if power < len(coefficients) and coefficients[power] != 0:
                    for tau, increment in written[name_][function]:
                        parts.setdefault(tau, []).append((coefficients[power], increment))
            total = {tau: combine(part) for tau, part in parts.items()}
            assert {tau: each for tau, each in total.items() if each} == dict(increments)
    assert seen
    assert signals(model) == signals(explicit)


def test_the_law_of_a_named_node_is_that_of_its_joint() -> None:
    """inertia D + radiation, times what makes the impedances on both sides of a rod one."""
    for name in NAMED:
        scene = Scene.from_toml(name)
        model = lower(scene)
        for node, joint in zip(scene.system.chain.nodes, model.network.joints, strict=True):
            law = JointLaw.assemble(model.network, joint)
            if law.motions[0] is None:
                assert law.mass[0] * node.radiation == law.damping[0][0] * node.inertia
                assert (law.mass[0] == 0) == (node.inertia == 0)


# ---- a Laplace expansion, from the text alone


def transform(increment: Increment) -> Ratio:
    """sum of value k!/(s + g)**(k + 1)."""
    total = Ratio(0)
    for rate, powers in increment.items():
        for k, value in enumerate(powers):
            total = total + Ratio(value * factorial(k), fmpq_poly([rate, 1]) ** (k + 1))
    return total


def difference(signal: Signal, table: Mapping[str, Any], until: Fraction | int) -> dict[object, Ratio]:
    """What the transform of an output differs by from that of the expansion, by delay; rational functions of s."""
    true = dict(Laplace(table, until).terms(*signal.name.split("@")).series)
    found = {Fraction(str(arrival.time)): transform(arrival.increment) for arrival in signal.arrivals}
    last = Fraction(until)  # of what begins at the end of the horizon only the first value is seen
    times = {time for time in true.keys() | found.keys() if time < last}
    gap = {time: found.get(time, Ratio(0)) - true.get(time, Ratio(0)) for time in times}
    return {time: each for time, each in gap.items() if each}


def served(table: Mapping[str, Any]) -> tuple[Signal, ...]:
    """The outputs of a scene; Hypothesis draws another where a polynomial does not split."""
    try:
        return signals(lower(Scene(**table)))
    except UnservedError:
        assume(False)
        raise


@settings(max_examples=25)
@given(chains(UNTIL))
def test_any_chain_has_the_transform_of_its_text(table: dict[str, Any]) -> None:
    """Not to some digits: the same rational functions of s, delay by delay."""
    for signal in served(table):
        assert difference(signal, table, UNTIL) == {}


LINKED: dict[str, Any] = {
    "name": "linked",
    "system": {
        "type": "chain",
        "parts": [
            {"mass": 1, "dashpot": 4, "spring": 6, "velocity": 1, "name": "overdamped"},
            {"rod": 1},
            {"mass": 2, "name": "middle"},
            {"rod": "1.001", "speed": 2, "strain": "1/3"},
            {"joint": True, "name": "held", "spring": 3},
            {"rod": "0.999", "impedance": 3},
            {"spring": "4/3"},
            {"rod": "1/2"},
            {"mass": 1, "velocity": -1},
            {"rod": 1, "dashpot": 1},
            {"mass": 1, "dashpot": 1, "name": "last"},
        ],
        "branch": [
            {
                "from": "middle",
                "name": "side",
                "ratio": "-3/2",
                "parts": [{"rod": "1/2"}, {"motion": "acceleration", "velocity": "1/2", "name": "pulled"}],
            },
        ],
    },
    "load": [
        {"at": "middle", "times": [0, "1/3"], "steps": [1, -2], "ramps": [0, 1]},
        {"at": "pulled", "spacing": "0.7", "samples": [0, 1, "-1/2"]},
    ],
    "output": {
        "until": 3,
        "strain": ["1-", "1+", "side:1/3"],
        "velocity": ["overdamped", "held", "3-", "3+", "last"],
        "displacement": ["middle", "pulled", "2"],
    },
}
"""Poles twice over, springs and dashpots whose joints split, and an end that is pulled."""


def polynomials_split(table: Mapping[str, Any]) -> bool:
    joints = NetworkJoints(lower(Scene(**table)).network)
    try:
        return all(joints.response(number) for number in range(len(joints.network.joints)))
    except UnservedError:
        return False


@pytest.mark.quick(1)
@pytest.mark.parametrize("table", [STEPPED, LINKED], ids=["stepped", "linked"])
def test_to_twenty_digits(table: dict[str, Any]) -> None:
    until = table["output"]["until"]
    made = Laplace(table, until)
    assert polynomials_split(table)
    for signal in signals(lower(Scene(**table))):
        assert difference(signal, table, until) == {}
        terms = made.terms(*signal.name.split("@"))
        balls = Balls(segments(signal, 400))
        for tau in (Fraction(1, 7), Fraction(1), Fraction(2003, 1000), Fraction(29, 10)):
            true = terms.value(tau)
            with ctx.workprec(400):
                assert abs(balls.evaluate(fmpq(*tau.as_integer_ratio())) - true) < 1e-20 * (1 + abs(true))


# ---- faults: each is seen


def faulty(table: dict[str, Any], fault: Mapping[int, Mapping[str, Any]]) -> bool:
    """Whether the expansion sees that bars have been changed."""
    model = lower(Scene(**table))
    bars = tuple(replace(bar, **fault.get(k, {})) for k, bar in enumerate(model.network.bars))
    wrong = RuledNetwork(replace(model.network, bars=bars))
    found = signals_at(wrong, model.probes, model.loads, model.until)
    return any(difference(signal, table, Fraction(str(model.until))) for signal in found)


def test_a_gear_ratio_squared_is_seen() -> None:
    one = fmpq(1)
    assert not faulty(STEPPED, {3: {"ratios": (fmpq(-2), one)}})
    assert faulty(STEPPED, {3: {"ratios": (fmpq(4), one)}})
    assert faulty(STEPPED, {3: {"ratios": (fmpq(2), one)}}), "and its sign"


def test_an_impedance_on_the_wrong_side_is_seen() -> None:
    assert not faulty(STEPPED, {0: {"impedance": fmpq(1)}, 1: {"impedance": fmpq(2)}})
    assert faulty(STEPPED, {0: {"impedance": fmpq(2)}, 1: {"impedance": fmpq(1)}})


@pytest.mark.parametrize("place", ["arrives", "radiates"])
def test_a_rod_end_of_another_law_is_seen(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from wavesym.derivation.recurrence import joint_rule

    true = joint_rule()
    wrong = true._replace(**{place: (getattr(true, place)[0], 3 * getattr(true, place)[1])})
    monkeypatch.setattr("wavesym.exact.joints.joint_law.joint_rule", lambda: wrong)
    assert faulty(STEPPED, {})


# ---- published and elementary numbers, as fractions


def rows(parts: list[Any], until: object, load: tuple[Mapping[str, Any], ...] = ()) -> dict[tuple[object, ...], object]:
    """(function, rod, source, tau, rate, power) -> value."""
    system = {"type": "chain", "parts": parts}
    scene = wavesym.Scene(name="known", system=system, load=load, output={"until": until, "velocity": [0]})
    return {tuple(row[:-1]): row.value for row in wavesym.tables(scene)}


# ---- how far, how large, and what is refused


def test_so_many_departures_of_each_wave() -> None:
    network = lower(Scene(**STEPPED)).network
    table, long = network_table(network, 3, NOWHERE), network_table(network, None, fmpq(6))
    for source, response in table.responses.items():
        for function, increments in response.items():
            assert len(increments) == 3, (source, function)
            assert list(increments) == list(long.responses[source][function][:3])


def test_names_of_rods_are_used() -> None:
    parts = [{"mass": 1, "velocity": 1}, {"rod": 1, "name": "first"}, {"rod": 2, "impedance": 2}]
    assert {key[1] for key in rows(parts, 4)} == {"first", 2}


@pytest.mark.parametrize("until", [6, 14])
def test_the_size_is_told_before(until: int) -> None:
    """Never less than there is, and not much more: families that a load does not reach count as if it did."""
    network = lower(Scene(**STEPPED)).network
    ruled = RuledNetwork(network)
    table = network_table(network, None, fmpq(until))
    for source, response in table.responses.items():
        last = dict.fromkeys(range(len(network.joints)), fmpq(until))
        made = sum(len(powers) for each in response.values() for _, one in each for powers in one.values())
        assert made <= ruled.forecast.size(source, last).coefficients <= 1.5 * made


def refusal(network: Network, until: object = 4, intervals: int | None = None) -> str:
    with pytest.raises((CostError, UnservedError)) as caught:
        network_table(network, intervals, fmpq(until))
    return str(caught.value)


def test_what_would_be_large_is_counted_first(monkeypatch: pytest.MonkeyPatch) -> None:
    def solved(*_: object) -> None:
        raise AssertionError("solved")

    monkeypatch.setattr(RuledNetwork, "_velocities", solved)
    monkeypatch.setattr("wavesym.exact.tables.forecast.MOST_FRONTS", 2000)
    parts = [{"mass": 1, "name": "a"}]
    for k in range(12):
        parts += [{"rod": f"{100 + k}/100"}, {"mass": f"{k + 2}/{k + 1}"}]
    system = {"type": "chain", "parts": parts}
    load = [{"at": "a", "times": [0], "steps": [1]}]
    many = lower(Scene(name="many", system=system, load=load, output={"until": 4, "velocity": [0]})).network
    assert "output.until: fronts leave the ends of rods more than 2000 times by tau =" in refusal(many, 60)
    assert refusal(many, 4, 300).startswith("--intervals: fronts leave")
    parts = [{"mass": 1, "name": "a"}, {"rod": 1}, {"mass": "1/3"}, {"rod": 1}, {"mass": "5/7"}, {"rod": 1}]
    system = {"type": "chain", "parts": parts}
    few = lower(Scene(name="few", system=system, load=load, output={"until": 4, "velocity": [0]})).network
    assert re.match(
        r"output.until: the tables would .* the limit is .* \(a shorter horizon.* helps\)", refusal(few, 600)
    )


def test_a_joint_that_does_not_split_is_named_with_its_polynomial() -> None:
    parts = [
        {"mass": 1, "spring": 1, "name": "bob"},
        {"rod": 1},
        {"rod": 2, "impedance": 3},
        {"spring": 5},
        {"mass": 7},
    ]
    network = lower(
        Scene(name="no", system={"type": "chain", "parts": parts}, output={"until": 4, "velocity": [0]})
    ).network
    assert refusal(network) == (
        "system: the joint at bob has the polynomial s^2 + s + 1, and exact tables support only those "
        "with factors s + g, g rational (take pieces, march or `run`)"
    )
    held = replace(network, points=(replace(network.points[0], stiffness=fmpq(0)), *network.points[1:]))
    assert "the joint at x = 3-, x = 3+ has the polynomial 21 s^2 + 35 s + 15," in refusal(held)


@pytest.mark.parametrize("speed", [0, 1])
def test_contacts_are_refused(speed: int) -> None:
    """Also where nothing is loaded and a bar flies at constant speed, so that there are no fronts to meet one."""
    one = fmpq(1)
    points = tuple(Point(fmpq(0), velocity=fmpq(speed * (x < 2)), place=str(x)) for x in range(4))
    bars = Bar(0, 1, one, one, one, velocity=fmpq(speed)), Bar(2, 3, one, one, one)
    network = Network(points, bars, (Link(1, 2, contact=True, gap=one, place="1"),))
    line = (
        "system: the contact at 1 opens and closes, which tables, closed form and march do not support "
        "(take pieces or `run`)"
    )
    assert refusal(network) == line
    model = replace(lower(Scene.from_toml("stepped_shaft")), network=network, loads=(), probes=())
    with pytest.raises(UnservedError, match="the contact at 1 opens"):
        signals(model)


def test_only_what_matters_is_asked() -> None:
    """A joint that does not split is no hindrance to outputs that it cannot reach."""
    parts = [{"mass": 1, "velocity": 1, "name": "a"}, {"rod": 3}, {"mass": 1, "spring": 1}]
    far = {"type": "chain", "parts": parts}
    near = lower(Scene(name="near", system=far, output={"until": 5, "velocity": ["a"]}))
    assert len(signals(near)[0].arrivals) == 1
    with pytest.raises(UnservedError, match="the joint at x = 3 has"):
        signals(near.shorten(fmpq(6)))


def test_a_table_keeps_its_order() -> None:
    table = network_table(lower(Scene(**STEPPED)).network, None, fmpq(6))
    assert isinstance(table, NetworkTable)
    keys = [(row.function, row.rod, row.interval) for row in table.rows() if row.source == "start"]
    assert keys == sorted(keys)
    assert Function("q", 0) not in table.responses["start"]


MOVING: list[Any] = [
    {"mass": 1, "velocity": 1, "name": "a"},
    {"dashpot": "3/2"},
    {"mass": 1, "velocity": 1},
    {"rod": 1, "impedance": 4, "velocity": 1},
]


@pytest.mark.parametrize("end", ["free", "fixed"])
def test_a_point_without_a_rod_is_watched_itself(end: str) -> None:
    """All of it moves on as one, or until a fixed end is felt."""
    output = {"until": 3, "velocity": ["a"], "displacement": ["a"]}
    table = {"name": "moving", "system": {"type": "chain", "parts": [*MOVING, end]}, "output": output}
    velocity, displacement = signals(lower(Scene(**table)))
    assert (velocity.arrivals[0].increment, displacement.arrivals[0].increment) == ({0: [1]}, {0: [0, 1]})
    assert [arrival.time for arrival in velocity.arrivals] == ([0] if end == "free" else [0, 1])
    for signal in (velocity, displacement):
        assert difference(signal, table, 3) == {}


def test_what_is_absorbed_does_not_come_back() -> None:
    """Two waves leave a body, and no more; so many departures of each are no endless search."""
    parts = ["absorbing", {"rod": 1}, {"mass": 1, "velocity": 1}, {"rod": 2}, "absorbing"]
    system = {"type": "chain", "parts": parts}
    network = lower(Scene(name="gone", system=system, output={"until": 9, "velocity": [0]})).network
    for table in (network_table(network, 5, NOWHERE), network_table(network, None, fmpq(9))):
        assert {(row.function, row.rod, row.interval) for row in table.rows()} == {("f", 2, 0), ("g", 1, 0)}
