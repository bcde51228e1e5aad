"""Friction on the ground against closed forms and a grid of characteristics that knows nothing of events."""

from __future__ import annotations

import random
from collections.abc import Callable
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import pairwise
from math import sin

import numpy as np
import pytest
from flint import arb, ctx, fmpq

import wavesym
from wavesym.errors import WavesymError
from wavesym.exact.contacts.schedule import GrazingError

PUSHED = """
name = "pushed"
[system]
type = "chain"
parts = ["fixed", { spring = 1 }, { mass = 1, name = "block", friction = "1/2" }]
[[load]]
at = "block"
times = [0, 2, 12]
ramps = [1, -1, -1]
[output]
until = 13
displacement = ["block"]
"""
THROWN = """
name = "thrown"
[system]
type = "chain"
parts = ["fixed", { spring = 1 }, { mass = 1, velocity = 10, name = "block", friction = 1 }]
[output]
until = 30
displacement = ["block"]
"""
RODS = """
name = "rods"
[system]
type = "chain"
parts = [{{ mass = 2, name = "ram" }}, {{ rod = 1 }}, {held}, {{ rod = "3/2", impedance = 2 }}, "free"]
[[load]]
at = "ram"
spacing = 1
samples = [0, "1/2", 1, 0, -2, -1, "3/10", 0]
[output]
until = 9
velocity = ["ram"]
strain = ["1/2"]
"""


def scene(tmp_path, text):
    path = tmp_path / "scene.toml"
    path.write_text(text)
    return wavesym.Scene.from_toml(str(path))


def assert_events(result, expected):
    assert [event.kind for event in result.events] == [kind for kind, _ in expected]
    for event, (_, tau) in zip(result.events, expected, strict=True):
        assert event.tau.overlaps(tau)
        assert event.tau.rad() < arb(2) ** -200


def test_a_block_on_a_spring_that_is_thrown(tmp_path):
    """It turns at atan 10 + k pi; amplitudes fall by 2 R/K each time, until the spring does not overcome R."""
    result = scene(tmp_path, THROWN).run(times=[30])
    turns = [arb(10).atan() + k * arb.pi() for k in range(6)]
    assert_events(result, [*(("slips", tau) for tau in turns[:5]), ("sticks", turns[5])])
    assert result["displacement@block"][0] == pytest.approx(11 - 101**0.5, rel=1e-15)


def test_a_block_that_is_pushed_ever_harder(tmp_path):
    """It slips when the load is R, turns twice, sticks; and slips again as the load falls, at rest until then."""
    result = scene(tmp_path, PUSHED).run(times=[11])
    turn = arb(2) + arb.pi() - arb(fmpq(3, 4))
    rest = 11 + 2 * arb(fmpq(3, 4)).sin()
    assert_events(result, [("slips", arb(fmpq(1, 2))), ("slips", turn), ("sticks", turn + arb.pi()), ("slips", rest)])
    assert result["displacement@block"][0] == pytest.approx(3.5 - 2 * np.sin(0.75), rel=1e-15)


@pytest.mark.parametrize(
    ("held", "same"),
    [
        ('{ joint = true, name = "held", friction = 1000000 }', '{ joint = true, name = "held", friction = 999 }'),
        ('{ joint = true, name = "held", friction = 0 }', '{ joint = true, name = "held" }'),
        ('{ mass = 1, name = "held", friction = 0 }', '{ mass = 1, name = "held" }'),
    ],
)
def test_friction_that_never_slips_or_is_none(tmp_path, held, same):
    values = [scene(tmp_path, RODS.format(held=part)).run(samples=37) for part in (held, same)]
    assert not values[0].events
    for name in values[0].outputs:
        assert np.array_equal(values[0][name], values[1][name])


@pytest.mark.parametrize("part", ["{ joint = true, friction = 1000 }", "{ mass = 3, friction = 1000 }"])
def test_what_never_slips_is_fixed(tmp_path, part):
    """The rod on its other side never moves, and the ram sees a wall: bit for bit the scene that ends there."""
    fixed = RODS.replace(', {{ rod = "3/2", impedance = 2 }}, "free"', "").format(held='"fixed"')
    held, wall = (scene(tmp_path, text).run(samples=37) for text in (RODS.format(held=part), fixed))
    assert not held.events
    for name in held.outputs:
        assert np.array_equal(held[name], wall[name])


def test_a_step_through_a_collar(tmp_path):
    """2 Z a - 2 Z v = R: a step of velocity 1 leaves 7/8."""
    text = RODS.replace('"3/2", impedance = 2', "1").replace("mass = 2", "joint = true")
    text = text.replace('spacing = 1\nsamples = [0, "1/2", 1, 0, -2, -1, "3/10", 0]', "times = [0]\nsteps = [1]")
    text = text.format(held='{ joint = true, name = "collar", friction = "1/4" }').replace('["ram"]', '["collar"]')
    result = scene(tmp_path, text).run(times=[0.5, 1.5])
    assert_events(result, [("slips", arb(1))])
    assert result["velocity@collar"].tolist() == [0, 0.875]


def random_chain(seed):
    """Nodes (mass, friction, velocity), rods (length, impedance), the node that a load acts on and its samples."""
    rng = random.Random(seed)
    count = rng.randint(2, 4)
    nodes = [
        (
            mass := rng.choice([Fraction(0), Fraction(1, 2), Fraction(1), Fraction(2)]),
            rng.choice([Fraction(0), Fraction(1, 8), Fraction(1, 4), Fraction(1, 3), Fraction(3)]),
            Fraction(rng.randint(-2, 2)) if mass and rng.random() < 0.3 else Fraction(0),
        )
        for _ in range(count)
    ]
    rods = [
        (rng.choice([Fraction(1), Fraction(3, 2), Fraction(1, 2)]), Fraction(rng.randint(1, 4), 2))
        for _ in range(count - 1)
    ]
    return nodes, rods, rng.randrange(count), [Fraction(rng.randint(-8, 8), 4) for _ in range(8)]


def written(nodes, rods, at, samples):
    parts = []
    for k, (mass, friction, velocity) in enumerate(nodes):
        kind = f'mass = "{mass}", velocity = "{velocity}"' if mass else "joint = true"
        parts.append(f'{{ {kind}, friction = "{friction}", name = "n{k}" }}')
        parts += [f'{{ rod = "{length}", impedance = "{z}" }}' for length, z in rods[k : k + 1]]
    numbers = ", ".join(f'"{each}"' for each in samples)
    names = ", ".join(f'"n{k}"' for k in range(len(nodes)))
    return f"""
name = "random"
[system]
type = "chain"
parts = [{", ".join(parts)}]
[[load]]
at = "n{at}"
spacing = 1
samples = [{numbers}]
[output]
until = 9
velocity = [{names}]
"""


def on_a_grid(nodes, rods, at, samples, steps):
    """Velocities of nodes (9 steps, nodes): waves in delay lines, and for each node an implicit Euler step.

    (m/h + sum of Z) v + f = m/h v_before + sum of 2 Z a + F, f in R sign(v): v is 0 where the right side is within R.
    """
    lines = [np.zeros((2, int(length * steps))) for length, _ in rods]
    load = np.interp((np.arange(9 * steps) + 1) / steps, np.arange(len(samples)), [float(each) for each in samples])
    velocity = [float(each[2]) for each in nodes]
    found = []
    for step in range(9 * steps):
        arriving = [line[:, step % line.shape[1]].copy() for line in lines]
        for k, (mass, friction, _) in enumerate(nodes):
            inertia = float(mass) * steps
            right, slow = inertia * velocity[k] + (load[step] if k == at else 0.0), inertia
            for rod, side in ((k, 0), (k - 1, 1)):
                if 0 <= rod < len(rods):
                    right += 2 * float(rods[rod][1]) * arriving[rod][side]
                    slow += float(rods[rod][1])
            velocity[k] = np.sign(right) * max(abs(right) - float(friction), 0.0) / slow
        for k, line in enumerate(lines):
            now = step % line.shape[1]
            line[1, now], line[0, now] = velocity[k] - arriving[k][0], velocity[k + 1] - arriving[k][1]
        found.append(list(velocity))
    return np.array(found)


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", [1, 3, 5])
def test_random_chains_against_a_grid(tmp_path, seed):
    """An error of first order halves with the step: the finer grid is off by about what it differs by."""
    chain, steps = random_chain(seed), 64
    result = scene(tmp_path, written(*chain)).run(times=[k + 3 / 8 for k in range(9)])
    values = np.array([result[name] for name in result.outputs]).T
    coarse, fine = (on_a_grid(*chain, n)[[int((k + 3 / 8) * n) - 1 for k in range(9)]] for n in (steps, 2 * steps))
    allowed = 4 * np.max(np.abs(coarse - fine)) + 1 / steps
    assert result.events
    assert np.max(np.abs(values - fine)) < allowed
    nodes, *others = chain
    slippery = [(mass, friction / 2, velocity) for mass, friction, velocity in nodes]
    wrong = on_a_grid(slippery, *others, 2 * steps)[[int((k + 3 / 8) * 2 * steps) - 1 for k in range(9)]]
    assert np.max(np.abs(values - wrong)) > allowed


def test_pieces_follow_friction(tmp_path):
    pushed = scene(tmp_path, RODS.format(held='{ mass = 1, name = "held", friction = "1/3" }'))
    taus = np.linspace(0, 9, 50)
    exact, piecewise = pushed.run(times=taus), wavesym.evaluator(pushed)
    assert exact.events
    for known, found in zip([exact[name] for name in exact.outputs], piecewise(taus), strict=True):
        assert np.max(np.abs(known - found)) <= 1.01 * piecewise.error_bound * np.max(np.abs(known))


@pytest.mark.parametrize(
    ("held", "message"),
    [
        ('{ mass = 1, friction = 1 }, "contact", { joint = true, friction = 2 }', "nothing says what each takes"),
        ("{ mass = 1, friction = -1 }", "negative"),
        ("{ mass = 1, friction = 1 }, { dashpot = 1 }, { joint = true }", "dashpot ties"),
    ],
)
def test_refused_friction(tmp_path, held, message):
    with pytest.raises(WavesymError, match=message):
        scene(tmp_path, RODS.format(held=held))


def test_others_refuse_friction(tmp_path):
    rubbed = scene(tmp_path, RODS.format(held='{ mass = 1, name = "held", friction = "1/3" }'))
    for refuse in (wavesym.modes, wavesym.frf):
        with pytest.raises(WavesymError, match=r"(rubs|friction) at 1"):
            refuse(rubbed)


def test_what_sticks_from_the_start_is_no_event() -> None:
    """A joint that is held at once while its rods come on."""
    rod = {"rod": 1, "velocity": 1}
    parts = [rod, {"joint": True, "friction": 100, "name": "held"}, rod]
    output = {"until": 3, "velocity": ["held"]}
    result = wavesym.run(wavesym.Scene(name="held", system={"type": "chain", "parts": parts}, output=output))
    assert result.events == ()
    assert not np.any(result["velocity@held"])


def test_masses_that_friction_holds_for_good_are_one():
    def moved(parts):
        load = [{"at": "a", "times": [0, 1], "steps": [1, "-1/2"]}]
        output = {"until": 6, "velocity": ["a"], "strain": ["0"]}
        system = {"type": "chain", "parts": ["fixed", {"rod": 1}, *parts]}
        return wavesym.run(wavesym.Scene(name="held", system=system, load=load, output=output))

    two = moved([{"mass": 1, "name": "a"}, {"friction": 1000}, {"mass": "1/2"}])
    one = moved([{"mass": "3/2", "name": "a"}])
    assert two.events == ()
    for name in one.outputs:
        assert np.array_equal(one[name], two[name])


def test_a_block_and_a_plate_share_their_momentum() -> None:
    parts = [{"mass": 2, "velocity": 1, "name": "block"}, {"friction": "1/4"}, {"mass": 3, "name": "plate"}]
    output = {"until": 8, "velocity": ["block", "plate"], "displacement": ["block", "plate"]}
    result = wavesym.run(wavesym.Scene(name="block", system={"type": "chain", "parts": parts}, output=output))
    (stuck,) = result.events
    assert stuck.kind == "sticks"
    assert stuck.double == 4.8  # (1/4) t = (2 * 3/5) 1
    assert result["velocity@block"][-1] == result["velocity@plate"][-1] == 0.4
    assert result["displacement@block"][-1] - result["displacement@plate"][-1] == pytest.approx(2.4, rel=1e-15)


@pytest.mark.quick(1)
@pytest.mark.parametrize("until", [7, 20])
def test_a_mass_on_a_belt_goes_with_it_until_its_spring_is_as_strong(until: int) -> None:
    parts = ["fixed", {"spring": 1}, {"mass": 1, "name": "m"}, {"friction": "1/4"}, {"motion": "velocity", "name": "b"}]
    load = [{"at": "b", "times": [0], "steps": ["1/5"]}]
    scene = wavesym.Scene(
        name="belt", system={"type": "chain", "parts": parts}, load=load, output={"until": until, "displacement": ["m"]}
    )
    sticks, slips = wavesym.run(scene).events  # and then swings about 1/4, as friction has one limit
    assert (sticks.kind, slips.kind) == ("sticks", "slips")
    assert sticks.double == pytest.approx(np.arcsin(0.8), rel=1e-15)  # (1/4) sin t = 1/5
    assert slips.double == pytest.approx(np.arcsin(0.8) + 0.75, rel=1e-15)  # from (1/4) (1 - 3/5) on to 1/4


def breaking(parts: list[object], until: int, load: list[object] | None = None) -> wavesym.Result:
    output = {"until": until, "velocity": ["m"], "displacement": ["m"]}
    system = {"type": "chain", "parts": parts}
    return wavesym.run(wavesym.Scene(name="breaking", system=system, load=load or [], output=output))


@pytest.mark.slow
def test_what_sticks_and_slips_for_long_is_followed_with_more_bits() -> None:
    """After 80 cycles 896 bits are lost, and its instants are still those of the closed form."""
    belt = {"motion": "velocity", "velocity": "1/4"}
    mass = {"mass": 1, "name": "m", "velocity": "1/4"}
    parts = ["fixed", {"spring": 1}, mass, {"friction": "1/2", "breakaway": 1}, belt]
    slips = [event.tau for event in breaking(parts, 650).events if event.kind == "slips"]
    with ctx.workprec(300):
        cycle = 4 + 2 * (arb.pi() - arb(2).atan())
        for number, tau in enumerate(slips):
            assert tau.overlaps(4 + number * cycle)
            assert tau.rad() < arb(2) ** -200
    assert len(slips) == 81


@pytest.mark.quick(1)
@pytest.mark.parametrize("flipped", [False, True])
def test_a_mass_on_a_belt_sticks_and_slips_for_ever(flipped: bool) -> None:
    """Its cycle in closed form: it sticks while the spring gets longer by 2 D, D = (R_s - R_k)/K, and slips for
    (2/w) (pi - atan(D w/V))."""
    speed = {"velocity": "-1/5" if flipped else "1/5"}
    rubs, belt = {"friction": "1/4", "breakaway": "3/5"}, {"motion": "velocity", **speed}
    parts = ["fixed", {"spring": 4}, {"mass": 1, "name": "m", **speed}, rubs, belt]
    events = breaking(parts[::-1] if flipped else parts, 13).events
    assert [event.kind for event in events] == ["slips", "sticks"] * 3 + ["slips"]
    with ctx.workprec(300):
        stick = arb(fmpq(7, 8))
        for before, after in pairwise(events):
            known = after.tau - before.tau
            assert known.overlaps(arb.pi() - stick.atan() if after.kind == "sticks" else stick)
            assert known.rad() < arb(2) ** -200


@pytest.mark.parametrize(
    ("velocity", "load", "expected", "last"),
    [
        (0, {"times": [0], "ramps": [1]}, [("slips", "2")], 5),  # v' = tau - 1/2 from 2 to 4
        (1, {"times": [0, 3], "steps": ["-3/2", "-1"]}, [("sticks", "1/2"), ("slips", "3")], -2),
        (1, {"times": [0], "steps": ["-5/2"]}, [("slips", "1/3")], "-22/3"),
    ],
)
def test_a_block_breaks_away_at_its_limit_at_rest_and_turns_only_beyond_it(
    velocity: int, load: dict[str, object], expected: list[tuple[str, str]], last: object
) -> None:
    """Rational instants are exact. One limit of 1/2 would not hold the second block at all."""
    block = {"mass": 1, "name": "m", "velocity": velocity, "friction": "1/2", "breakaway": 2}
    result = breaking([block], 4, [{"at": "m", **load}])
    assert_events(result, [(kind, arb(fmpq(*Fraction(tau).as_integer_ratio()))) for kind, tau in expected])
    assert result["velocity@m"][-1] == pytest.approx(float(Fraction(str(last))), rel=1e-15)


def at_its_limit(more: Fraction) -> list[object]:
    """(u + 5/4)^2 + v^2 = 169/16: it comes to rest at u = 2, where it takes 2, with a limit of 2 and some more."""
    limit = f"{2 + more}"
    return ["fixed", {"spring": 1}, {"mass": 1, "velocity": 3, "friction": "5/4", "breakaway": limit, "name": "m"}]


def up_to_its_limit(more: Fraction) -> list[object]:
    """While it sticks it takes sin(tau) of the other mass, with a limit of 1 and some more."""
    held = {"mass": 1, "velocity": 0, "friction": "1/2", "breakaway": f"{1 + more}", "name": "m"}
    return [held, {"spring": 1}, {"mass": 1, "velocity": 1}]


@pytest.mark.quick(1)
@pytest.mark.parametrize("scene", [at_its_limit, up_to_its_limit])
def test_what_takes_just_as_much_as_its_limit_at_rest_is_refused(scene: Callable[[Fraction], list[object]]) -> None:
    parts = scene(Fraction(0))
    with pytest.raises(GrazingError, match="do not show whether it sticks or slips"):
        breaking(parts, 10)


@pytest.mark.quick(2)
@pytest.mark.parametrize("digits", [12, 46])
@pytest.mark.parametrize("scene", [at_its_limit, up_to_its_limit])
def test_what_takes_nearly_its_limit_at_rest_is_held_below_and_slips_above_it(
    scene: Callable[[Fraction], list[object]], digits: int
) -> None:
    """However near: a limit that bears less by 10^-46 releases."""
    for more, kinds in ((1, {at_its_limit: ["sticks"], up_to_its_limit: []}), (-1, {})):
        parts = scene(Fraction(more, 10**digits))
        result = breaking(parts, 10)
        assert [event.kind for event in result.events] == kinds.get(scene, ["slips", "sticks"])
        moves = result["displacement@m"][-1] - {at_its_limit: 2.0, up_to_its_limit: 0.0}[scene]
        assert (abs(moves) > 0.2) == (more < 0)


@pytest.mark.quick(1)
@pytest.mark.parametrize("digits", [30, 49, 90])
def test_a_rest_known_to_be_below_the_limit_is_one_however_near(digits: int) -> None:
    """A mass of 1 - 2 a with a velocity of 3 (1 + a) comes to rest below 2, by 4.15 a^2."""
    a = Decimal(1).scaleb(-digits)
    with localcontext() as context:
        context.prec = 100
        moving = {"mass": str(1 - 2 * a), "velocity": str(3 + 3 * a)}
    fixed, spring, mass = at_its_limit(Fraction(0))
    result = breaking([fixed, spring, mass | moving], 10)
    assert [event.kind for event in result.events] == ["sticks"]
    assert result["displacement@m"][-1] == pytest.approx(2, abs=1e-15)


def test_a_velocity_that_touches_0_again_and_again_is_followed(thorough: bool) -> None:
    """From tau = 1 on u = tau - 1 - sin(tau - 1): it is at rest, and pulled by just its friction, after each 2 pi."""
    parts = ["fixed", {"spring": 1}, {"mass": 1, "velocity": 0, "friction": 1, "name": "m"}]
    until = 15 if thorough else 8
    result = breaking(parts, until, [{"at": "m", "times": [0], "ramps": [1]}])
    assert_events(result, [("slips", arb(1))])
    assert result["displacement@m"][-1] == pytest.approx(until - 1 - sin(until - 1), rel=1e-15)


def test_a_limit_at_rest_that_is_that_of_sliding_changes_nothing() -> None:
    parts = ["fixed", {"spring": 1}, {"mass": 1, "velocity": 10, "name": "m", "friction": 1}]
    one, same = breaking(parts, 30), breaking([*parts[:2], parts[2] | {"breakaway": 1}], 30)
    assert [event.double for event in one.events] == [event.double for event in same.events]
    assert np.array_equal(one["displacement@m"], same["displacement@m"])


@pytest.mark.parametrize(
    ("held", "message"),
    [
        ("{ joint = true, friction = 1, breakaway = 2 }", "more than one thing"),
        ("{ mass = 1, friction = 1, breakaway = 2 }, { spring = 1, yield = 1 }, { mass = 1 }", "more than one thing"),
        ('{ mass = 1, friction = 1, breakaway = 2 }, "contact"', "more than one thing"),
        ("{ mass = 1 }, { friction = 1, breakaway = 2 }, { mass = 1 }", "more than one thing"),
        ("{ mass = 1, friction = 2, breakaway = 1 }", "less than friction"),
        ("{ mass = 1, breakaway = 1 }", "write friction = R"),
    ],
)
def test_refused_limits_at_rest(tmp_path, held, message):
    with pytest.raises(WavesymError, match=message):
        scene(tmp_path, RODS.format(held=held))
