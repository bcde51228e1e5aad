"""What is marched, by hand: the laws of joints, tracks, panels, loads and outputs."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import pytest
from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.numbers.doubles import rational
from wavesym.programs.march.plan import LoadEvent, MarchOutput, OutputTerm, Panel, Stretch, largest_number, march_plan
from wavesym.programs.march.space import BLOCK, BODY, SCATTERER
from wavesym.scene import Scene, lower

DRIVE = {"type": "drive", "m": 2, "kappa": ["1/2", "1/3"], "inertia": [1, 2, 3]}
TOWER = {"type": "building", "m": 3, "kappa": ["1/4", "1/2", "1/3", 2]}
RAMPS = {"times": ["1/3", "5/2"], "a": [1, 2], "b": [3, "-1/2"]}
TALL = {"type": "drive", "m": 40, "kappa": [1] * 40, "inertia": [1] * 41}
LOADS = [{"body": 1, "times": ["1/3", "5/2"], "steps": [1, "-1/2"]}, {"body": 3, "times": [0], "steps": [2]}]


def planned(system, load=(), until="7/2", **outputs):
    output = {"until": until, "tolerance": "1e-8", **(outputs or {"displacement": ["5/4"]})}
    return march_plan(lower(Scene(name="made", system=system, load=list(load), output=output)))


def numbers(*values):
    return [fmpq(*map(int, value.split("/"))) if isinstance(value, str) else fmpq(value) for value in values]


def chained(*parts, **outputs):
    return planned({"type": "chain", "parts": list(parts)}, **(outputs or {"velocity": [0]}))


def test_the_laws_of_named_systems_are_those_of_their_bodies() -> None:
    """(mass, rate) by hand: impedances on both sides over the mass."""
    systems = [
        (DRIVE, [(1, "1/2"), (2, "7/12"), (3, "2/9")], []),
        (TOWER | {"base": "ground"}, [(2, 1), (3, "2/3"), ("1/2", 2)], [0]),
        (TOWER | {"base": "force"}, [(2, 1), (3, "2/3"), ("1/2", 2)], [0]),
        ({"type": "collision", "m": 4, "kappa": [3, "1/7"], "velocity": [2, 1]}, [("1/3", 6), (7, "2/7")], [0, 2, 4]),
    ]
    for system, bodies, others in systems:
        joints = planned(system).joints
        assert [n for n, joint in enumerate(joints) if joint.space.law == SCATTERER] == others
        found = [(joint.space.weights[0], joint.space.rate) for joint in joints if joint.space.law == BODY]
        assert found == [tuple(numbers(*each)) for each in bodies]
        # a force alone moves a body with drive * force, and rods push with twice their impedance
        for joint in joints:
            if joint.space.law == BODY:
                assert joint.space.drive == 1 / (joint.space.rate * joint.space.weights[0])
                assert [port.push for port in joint.space.ports] == [2 * p.impedance for p in joint.space.ports]


@pytest.mark.parametrize(
    ("middle", "laws"),
    [
        ([{"mass": 1}], {BODY}),
        ([{"mass": 1, "dashpot": 3}], {BODY}),
        ([{"joint": True, "dashpot": 3}], {BODY, SCATTERER}),
        ([{"mass": 1, "spring": 3}], {BODY, BLOCK}),
        ([{"joint": True, "spring": 3}], {BODY, BLOCK}),
        ([{"mass": 1}, {"spring": 3}, {"mass": 2}], {BODY, BLOCK}),
        ([{"dashpot": 3}], {BODY, SCATTERER}),
    ],
)
def test_a_joint_is_a_body_where_it_is_one_mass_without_springs(middle, laws) -> None:
    made = chained({"mass": 1}, {"rod": 1}, *middle, {"rod": 1}, {"mass": 1}, velocity=["0"], displacement=["2"])
    assert {joint.space.law for joint in made.joints if any(port.impedance for port in joint.space.ports)} == laws


def test_rods_begin_with_half_their_velocity_each_way() -> None:
    collision = {"type": "collision", "m": 4, "kappa": [3, "1/7"], "velocity": [2, "-1/3"]}
    made = planned(collision)
    assert [track.initial_value for track in made.tracks] == numbers(*[1] * 4, *["-1/6"] * 4, 0)
    assert [value for joint in made.joints for value in joint.space.initial_state] == [2, fmpq(-1, 3)]
    # what comes into the light cone is what is in the rods there
    cut = planned(collision, until="1/2", displacement=["5/2"])
    assert [track.initial_value for track in cut.tracks] == numbers(1, 1, *["-1/6"] * 4, 0)
    assert len(cut.joints) == 2


def test_panels_begin_where_loads_do() -> None:
    made = planned(DRIVE, LOADS)
    assert made.panels == tuple(Panel(*numbers(*pair)) for pair in ((0, "1/3"), ("1/3", "1/6"), ("1/2", "1/2")))
    none = tuple(numbers(0, 0))
    # on the last body a moment counts against rotation
    assert made.events == (
        LoadEvent(0, 0, 1, (fmpq(-1), *none), (fmpq(-1), *none)),
        LoadEvent(0, 1, 0, (fmpq(1, 2), *none), (fmpq(1, 2), *none)),
        LoadEvent(2, 2, 0, (fmpq(1, 4), *none), (fmpq(-1, 4), *none)),
    )
    assert made.loaded_points == (0, 2)
    assert [joint.forces for joint in made.joints] == [(0,), (-1,), (1,)]
    # what begins at the end of the horizon counts, what begins later does not
    assert len(planned(DRIVE, LOADS, until="5/2").events) == 3
    later = planned(DRIVE, LOADS, until="249/100")
    assert [len(later.events), len(later.panels)] == [2, 2]
    assert later.windows == 3
    assert planned(DRIVE, LOADS, until=3).windows == 4
    twice = made.scale(fmpq(2))
    assert [event.powers[0] for event in twice.events] == [-2, 1, fmpq(1, 2)]
    assert largest_number(twice) == 2 * largest_number(made) == 2


def test_accelerations_are_integrated_where_the_ground_moves() -> None:
    made = planned(TOWER | {"base": "ground"}, [RAMPS])
    begun, more = tuple(numbers(0, 1, "3/2")), tuple(numbers(0, 2, "-1/4"))
    since = fmpq(13, 6)
    total = (since + fmpq(3, 2) * since**2, 1 + 3 * since + 2, fmpq(5, 4))
    assert made.events == (LoadEvent(0, 1, 0, begun, begun), LoadEvent(2, 2, 0, total, more))
    pushed = planned(TOWER | {"base": "force"}, [RAMPS])
    assert pushed.events[0].powers == tuple(numbers(-4, -12, 0))
    assert pushed.events[1].powers == tuple(numbers(-38, -10, 0))


def waves_of_rod(name, sign, rod, delay, summed=False):
    """The wave to the right of the end on the left, `sign` times, and that to the left of the other."""
    to_the_right = OutputTerm(2 * rod, fmpq(sign), delay, summed)
    return MarchOutput(name, (to_the_right, OutputTerm(2 * rod + 1, fmpq(1), 1 - delay, summed)))


def test_outputs_have_the_waves_of_their_rod() -> None:
    outputs = {"strain": ["1/2", "1-", "1+"], "velocity": [0, 2], "displacement": ["7/4"]}
    made = planned(DRIVE, until=4, **outputs)
    assert made.outputs == (
        waves_of_rod("strain@1/2", -1, 0, fmpq(1, 2)),
        waves_of_rod("strain@1-", -1, 0, fmpq(1)),
        waves_of_rod("strain@1+", -1, 1, fmpq(0)),
        waves_of_rod("velocity@0", 1, 0, fmpq(0)),
        waves_of_rod("velocity@2", 1, 1, fmpq(1)),
        waves_of_rod("displacement@7/4", 1, 1, fmpq(3, 4), summed=True),
    )
    # tracks count from the first rod of the light cone
    cut = planned(TALL, until="3/2", velocity=["41/2"])
    assert len(cut.joints) == 4
    assert cut.outputs[0] == waves_of_rod("velocity@41/2", 1, 2, fmpq(1, 2))


def test_the_step_is_the_common_measure_of_the_delays() -> None:
    made = chained({"mass": 1}, {"rod": "3/2"}, {"mass": 1}, {"rod": 1, "speed": 2}, {"rod": "5/4"})
    assert made.step == fmpq(1, 4)
    assert [track.steps for track in made.tracks if track.steps] == [6, 6, 2, 2, 5, 5]
    assert (made.windows, made.cycle, made.crossings) == (15, (4, 1), 8)


CUTS = [
    (0, [0], [(0, 0, 0)]),
    (1, [0], [(0, 1, 0)]),
    ("1/4", [0], [("-3/4", 1, 0), ("1/4", 0, 0)]),
    (0, [0, "1/3"], [(0, 0, 0), ("1/3", 0, 1)]),
    (1, [0, "1/3"], [(0, 1, 0), ("1/3", 1, 1)]),
    ("2/3", [0, "1/3"], [(0, 1, 1), ("2/3", 0, 0)]),
    ("1/2", [0, "1/3"], [("-1/6", 1, 1), ("1/2", 0, 0), ("5/6", 0, 1)]),
    ("1/6", [0, "1/3"], [("-1/2", 1, 1), ("1/6", 0, 0), ("1/2", 0, 1)]),
    ("5/6", [0, "1/3"], [("-1/6", 1, 0), ("1/6", 1, 1), ("5/6", 0, 0)]),
    ("7/3", [0], [("-2/3", 3, 0), ("1/3", 2, 0)]),
]


def exact(number):
    return rational(Fraction(number))


@pytest.mark.parametrize("step", [1, "1/7"])
@pytest.mark.parametrize(("delay", "panels", "expected"), CUTS)
def test_stretches_cover_the_window_once(delay, panels, expected, step) -> None:
    step = exact(step)
    cuts = [*map(exact, panels), fmpq(1)]
    panels = tuple(Panel(step * low, step * (high - low)) for low, high in pairwise(cuts))
    made = replace(planned(DRIVE), step=step, panels=panels)
    found = made.stretches(step * exact(delay))
    assert found == tuple(Stretch(step * exact(start), back, p) for start, back, p in expected)
    ends = [*(stretch.start for stretch in found[1:]), step]
    assert all(s.start + panels[s.panel].length >= end > s.start for s, end in zip(found, ends, strict=True))


@pytest.mark.parametrize(("or_pieces", "instead"), [(True, "take pieces or modes"), (False, "take modes")])
def test_a_chain_without_rods_is_refused_with_what_serves_it(or_pieces, instead) -> None:
    parts = [{"mass": 1, "name": "a", "velocity": 1}, {"spring": 1}, {"mass": 1}]
    model = lower(Scene(name="made", system={"type": "chain", "parts": parts}, output={"until": 1, "velocity": ["a"]}))
    with pytest.raises(UnservedError, match=f"no rod, .*; {instead}$"):
        march_plan(model, or_pieces=or_pieces)
