"""What is marched, by hand: the laws of nodes, their masses, panels, loads and outputs."""

from math import inf

import pytest
from flint import fmpq

from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.march.load_events import LoadEvent
from wavesym.programs.march.plan import LEFT, RIGHT, Channel, HeardWave, MarchPanel, Watched, plan
from wavesym.programs.march.run import Run, operator_count
from wavesym.scene import Scene, lower

DRIVE = {"type": "drive", "m": 2, "kappa": ["1/2", "1/3"], "inertia": [1, 2, 3]}
TOWER = {"type": "building", "m": 3, "kappa": ["1/4", "1/2", "1/3", 2]}
RAMPS = {"times": ["1/3", "5/2"], "a": [1, 2], "b": [3, "-1/2"]}


def planned(system, load=(), until="7/2", real=DOUBLE, **outputs):
    output = {"until": until, "tolerance": "1e-8", **(outputs or {"displacement": ["5/4"]})}
    return plan(lower(Scene(name="made", system=system, load=list(load), output=output)), real)


def numbers(*values):
    return [fmpq(*map(int, value.split("/"))) if isinstance(value, str) else fmpq(value) for value in values]


def test_masses_are_those_of_rods_and_bodies_and_laws_follow_from_them():
    """Energy is Z times both waves squared, and M q**2/2: so Z and M are as the masses of rods and bodies."""
    systems = [
        (DRIVE, ["1/2", "2/3"], [1, 2, 3]),  # kappa times the disc's inertia
        (TOWER | {"base": "ground"}, [1, 1, 1], [0, 2, 3, "1/2"]),  # equal rods, kappa less mass; the ground is held
        (TOWER | {"base": "force"}, [1, 1, 1], [0, 2, 3, "1/2"]),
        ({"type": "collision", "m": 4, "kappa": [3, "1/7"], "velocity": [2, 1]}, [1] * 4, [0, "1/3", 0, 7, 0]),
    ]
    for system, rods, bodies in systems:
        nodes = planned(system).junctions
        scale = nodes[0].right / numbers(*rods)[0]
        rods, bodies = [0, *numbers(*rods), 0], numbers(*bodies)
        for x, (node, mass) in enumerate(zip(nodes, bodies, strict=True)):
            left, right = scale * rods[x], scale * rods[x + 1]
            assert (node.left, node.right, node.mass) == (left, right, scale * mass)
            held = x == 0 and system.get("base") == "ground"
            assert (node.alpha, node.beta) == (
                (0, 0) if held else (2 * left / (left + right), 2 * right / (left + right))
            )
            assert node.rate == ((left + right) / (scale * mass) if mass else None)


def test_rods_begin_with_half_their_velocity_each_way():
    collision = {"type": "collision", "m": 4, "kappa": [3, "1/7"], "velocity": [2, "-1/3"]}
    made = planned(collision)
    assert list(made.rods) == numbers(0, 1, 1, "-1/6", "-1/6", 0)
    assert made.junctions[1].motion == 2
    assert made.junctions[3].motion == fmpq(-1, 3)
    # what comes into the light cone is what is in the rods there
    cut = planned(collision, until="1/2", displacement=["5/2"])
    assert (cut.first, list(cut.rods)) == (2, numbers(1, "-1/6", "-1/6"))


def test_panels_begin_where_loads_do():
    loads = [{"body": 1, "times": ["1/3", "5/2"], "steps": [1, "-1/2"]}, {"body": 3, "times": [0], "steps": [2]}]
    made = planned(DRIVE, loads)
    assert made.panels == tuple(MarchPanel(*numbers(*pair)) for pair in ((0, "1/3"), ("1/3", "1/6"), ("1/2", "1/2")))
    none = tuple(numbers(0, 0))
    # moments over g = kappa_1 J_1/J_i and the like; on the last body they count against rotation
    assert made.events == (
        LoadEvent(0, 0, 2, (fmpq(-3, 2), *none)),
        LoadEvent(0, 1, 0, (fmpq(1), *none)),
        LoadEvent(2, 2, 0, (fmpq(1, 2), *none)),
    )
    assert made.loaded == (0, 1, 2)
    gains = numbers(1, "3/7", "-3/4")
    assert made.channels == tuple(Channel(f"M{k + 1}", k, gain, 0) for k, gain in enumerate(gains))
    assert list(made.changes(2)) == [(2, 0, (fmpq(-1, 2), *none))]
    # what begins at the end of the horizon counts, what begins later does not
    assert len(planned(DRIVE, loads, until="5/2").events) == 3
    later = planned(DRIVE, loads, until="249/100")
    assert [len(later.events), len(later.panels)] == [2, 2]
    assert later.windows == 3
    assert planned(DRIVE, loads, until=3).windows == 4


def test_accelerations_are_integrated_where_the_ground_moves():
    made = planned(TOWER | {"base": "ground"}, [RAMPS])
    begun, more = tuple(numbers(0, 1, "3/2")), tuple(numbers(0, 2, "-1/4"))
    assert list(made.changes(0)) == []
    assert list(made.changes(1)) == [(0, 0, begun)]
    assert list(made.changes(2)) == [(2, 0, more)]
    since = fmpq(13, 6)
    total = (since + fmpq(3, 2) * since**2, 1 + 3 * since + 2, fmpq(5, 4))
    assert made.events == (LoadEvent(0, 1, 0, begun), LoadEvent(2, 2, 0, total))
    assert made.channels == (Channel("a", 0, fmpq(1), 1),)
    pushed = planned(TOWER | {"base": "force"}, [RAMPS])
    assert pushed.channels == (Channel("a", 0, fmpq(-4), 0),)
    assert pushed.events[0].powers == tuple(numbers(-4, -12, 0))
    assert pushed.events[1].powers == tuple(numbers(-38, -10, 0))


def waves_of_rod(name, sign, left_node, right_node, delay, summed=False):
    """The wave to the right of the node on the left, `sign` times, and that to the left of the other."""
    to_the_right = HeardWave(RIGHT, left_node, delay, fmpq(sign), summed)
    return Watched(name, (to_the_right, HeardWave(LEFT, right_node, 1 - delay, fmpq(1), summed)))


def test_outputs_have_the_waves_of_their_rod():
    outputs = {"strain": ["1/2", "1-", "1+"], "velocity": [0, 2], "displacement": ["7/4"]}
    made = planned(DRIVE, until=4, **outputs)
    assert made.outputs == (
        waves_of_rod("strain@1/2", -1, 0, 1, fmpq(1, 2)),
        waves_of_rod("strain@1-", -1, 0, 1, fmpq(1)),
        waves_of_rod("strain@1+", -1, 1, 2, fmpq(0)),
        waves_of_rod("velocity@0", 1, 0, 1, fmpq(0)),
        waves_of_rod("velocity@2", 1, 1, 2, fmpq(1)),
        waves_of_rod("displacement@7/4", 1, 1, 2, fmpq(3, 4), summed=True),
    )
    # columns count from the first node of the light cone
    tall = {"type": "drive", "m": 40, "kappa": [1] * 40, "inertia": [1] * 41}
    cut = planned(tall, until="3/2", velocity=["41/2"])
    assert (cut.first, len(cut.junctions)) == (19, 4)
    assert cut.outputs[0] == waves_of_rod("velocity@41/2", 1, 1, 2, fmpq(1, 2))
    # and what is beyond them is felt after that, or never
    assert (cut.valid, made.valid) == (1.5, inf)


def test_what_is_driven_longer_has_a_wider_light_cone():
    tall = {"type": "drive", "m": 40, "kappa": [1] * 40, "inertia": [1] * 41}
    output = {"until": "3/2", "tolerance": "1e-8", "velocity": ["41/2"]}
    made = Scene(name="made", system=tall, load=[{"body": 1, "times": [0], "steps": [1]}], output=output)
    for windows, nodes, valid in (
        (0, 4, 1.5),
        (1, 4, 1.5),
        (5, 10, 5.0),
        (19, 38, 19.0),
        (20, 40, 20.0),
        (21, 41, inf),
    ):
        cone = plan(lower(made), DOUBLE, windows)
        assert (len(cone.junctions), cone.valid) == (nodes, valid)


def test_tolerances_are_no_less_than_what_rounding_makes():
    for real, least in ((DOUBLE, 2.0**-53), (SINGLE, 2.0**-24)):
        made = planned(DRIVE, until=9, real=real)
        assert made.tolerance == max(1e-8, 64 * least)
        assert made.trusted == pytest.approx(max(1e-8 / 100, least * 3 * 10), rel=1e-12)


def test_the_largest_rate_and_the_operators_are_those_of_the_bodies():
    made = planned(DRIVE, [{"body": 1, "times": ["1/3"], "steps": [1]}])
    assert made.rate == fmpq(7, 12)
    assert operator_count(made) == len(Run(made, 8).operators) == 6
    same = planned({"type": "drive", "m": 2, "kappa": [1, 1], "inertia": [2, 4, 2]})
    assert operator_count(same) == 3
    still = {"type": "collision", "m": 4, "kappa": [1, 3], "velocity": [1, 1]}
    assert planned(still).rate == 6
