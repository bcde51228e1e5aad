"""What holds in every system, whatever its numbers: the tables by another route, and identities that are exact.

Identities compare the exact tables of one scene with the node law on windows of another: neither route knows of the
other, and of the identity.
"""

from fractions import Fraction
from functools import partial

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.drawn import loads, ratios, scenes, systems
from tests.support.physical_time import differences
from wavesym.derivation.table import full_table
from wavesym.exact.motion import Motion
from wavesym.exact.tables.ball import segments, values
from wavesym.exact.tables.signal import signals
from wavesym.numbers.doubles import rational
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower
from wavesym.verification.programs import compare_programs
from wavesym.verification.reference import known_outputs

UNTIL = 5
TAUS = [k / 16 for k in range(16 * UNTIL + 1)]
UNIT = 2.0**-53


def made(
    system, load, places=(0, Fraction(1, 3), Fraction(3, 4), 1), quantities=("strain", "velocity", "displacement")
):
    """A scene watched at places of its first rod; strains at the left of its right end."""
    output = {quantity: [f"{x}-" if x == 1 and quantity == "strain" else x for x in places] for quantity in quantities}
    return Scene(name="drawn", system=system, load=load, output={"until": UNTIL, **output})


def tables(scene, taus=TAUS):
    """By the exact tables, each value rounded once."""
    return np.array([values(partial(segments, signal), taus) for signal in signals(lower(scene))])


def windows(scene, taus=TAUS):
    """By the node law on windows, each value rounded once."""
    until = lower(scene).horizon()
    motion = Motion(lower(scene), rational(until))
    return np.array([values(partial(motion.segments, place), taus) for place in motion.probes])


def assert_same(found, *parts):
    """`found` is the sum of `parts`, all rounded once, and the sum is too."""
    expected = sum(parts)
    allowed = UNIT * (np.abs(found) + (len(parts) + 1) * sum(map(np.abs, parts)))
    assert (np.abs(found - expected) <= allowed).all()


def weighed(load, factor):
    def times_factor(key, numbers):
        return [factor * each for each in numbers] if key in ("a", "b", "steps", "ramps") else numbers

    return [{key: times_factor(key, numbers) for key, numbers in table.items()} for table in load]


@st.composite
def loaded(draw, kinds=("drive", "building")):
    system = draw(systems(kinds=kinds, largest=3))
    return system, draw(loads(system))


@settings(max_examples=25)
@given(systems())
def test_tables_and_the_node_law_have_the_same_coefficients(system):
    drawn = Scene(name="drawn", system=system, output={"until": 1, "velocity": [0]}).system.chain
    table = full_table(drawn, 5, fmpq(0))
    assert any(True for _ in table.rows())
    assert not list(differences(drawn, table))


@settings(max_examples=15)
@given(scenes())
def test_tables_and_the_node_law_have_the_same_values(scene):
    taus = [tau for tau in TAUS if tau <= scene.output.until]
    np.testing.assert_array_equal(tables(scene, taus), windows(scene, taus))


def check_generated(scene):
    truth = known_outputs(lower(scene))
    for outcome in compare_programs(scene, truth, [None] * len(truth.outputs), [Request()]):
        assert outcome.passed, outcome


@settings(max_examples=4)
@given(scenes())
def test_generated_code_is_within_its_bound(scene):
    check_generated(scene)


@pytest.mark.slow
@settings(max_examples=100)
@given(scenes(tolerance="1e-13"))
def test_generated_code_is_within_its_bound_in_many_systems(scene):
    check_generated(scene)


@settings(max_examples=7)
@given(loaded(), st.data())
def test_loads_superpose(drawn, data):
    system, one = drawn
    other = data.draw(loads(system))
    assert_same(tables(made(system, one + other)), windows(made(system, one)), windows(made(system, other)))


@settings(max_examples=5)
@given(systems(kinds=("building",), largest=3))
def test_the_ground_is_followed_at_once(system):
    load = [{"times": [0, 1], "a": [1, -3], "b": [Fraction(1, 2), 0]}]
    scene = made({**system, "base": "ground"}, load, places=(0,), quantities=("velocity", "displacement"))
    tau, after = np.array(TAUS), np.maximum(np.array(TAUS) - 1, 0)
    velocity, displacement = tables(scene)
    assert_same(velocity, tau, tau**2 / 4, -3 * after)
    np.testing.assert_allclose(displacement, tau**2 / 2 + tau**3 / 12 - 1.5 * after**2, rtol=0, atol=1e-14)


@settings(max_examples=7)
@given(systems(kinds=("collision",)))
def test_a_collision_in_the_mirror(system):
    """Places, velocities and displacements turn round, so strains stay."""
    m = system["m"]
    mirror = {**system, "kappa": system["kappa"][::-1], "velocity": [-v for v in system["velocity"][::-1]]}
    places = (Fraction(1, 3), Fraction(2), Fraction(11, 4))
    there = (m - x for x in places)
    found = tables(made(system, [], places))
    expected = windows(made(mirror, [], tuple(there)))
    np.testing.assert_array_equal(found, np.repeat([1, -1, -1], 3)[:, np.newaxis] * expected)


@settings(max_examples=7)
@given(loaded(kinds=("drive",)))
def test_a_drive_in_the_mirror(drawn):
    """J_0i = kappa_i J_i; moments are in units of the first shaft's, and that on the last body counts against it."""
    system, load = drawn
    m, inertia = system["m"], system["inertia"]
    shafts = [kappa * j for kappa, j in zip(system["kappa"], inertia, strict=False)]
    kappa = [shaft / j for shaft, j in zip(shafts[::-1], inertia[::-1], strict=False)]
    mirror = {**system, "kappa": kappa, "inertia": inertia[::-1]}
    body = load[0]["body"]
    sign = -1 if body in (1, m + 1) else 1
    turned = [{**each, "body": m + 2 - body} for each in weighed(load, sign * shafts[0] / shafts[-1])]
    places = (0, Fraction(1, 3), m)
    found = tables(made(system, load, places))
    expected = windows(made(mirror, turned, tuple(m - x for x in places)))
    np.testing.assert_array_equal(found, np.repeat([-1, 1, 1], 3)[:, np.newaxis] * expected)


@settings(max_examples=7)
@given(systems(kinds=("drive",)), st.data())
def test_reciprocity(system, data):
    """A moment at A turns B as it would turn A at B; all are in the same units, and the last has another sign."""
    m = system["m"]
    a, b = (data.draw(st.integers(0, m)) for _ in range(2))

    def turning(at, seen):
        load = [{"body": at + 1, "times": [0], "steps": [-1 if at == m else 1]}]
        return made(system, load, (seen,), ("velocity", "displacement"))

    np.testing.assert_array_equal(tables(turning(a, b)), windows(turning(b, a)))


@settings(max_examples=7)
@given(ratios(2), st.sampled_from(["force", "ground"]))
def test_nearly_equal_storeys_move_nearly_alike(kappa, base):
    """Rates that merge are the limit of rates that do not: the tables differ altogether, the motion by the gap."""
    load = [{"times": [0], "a": [1], "b": [0]}]
    gap = Fraction(1, 10**9)

    def storeys(gap):
        system = {"type": "building", "m": 2, "kappa": [1, kappa[0], kappa[0] * (1 + gap)], "base": base}
        return tables(made(system, load))

    equal, nearly = storeys(0), storeys(gap)
    assert (equal != nearly).any()
    # by the gap times what a body can do in this time; no power of 1/gap is left
    allowed = float(gap) * 20 * UNTIL * max(1, float(kappa[0])) * np.abs(equal).max(axis=1, keepdims=True)
    assert (np.abs(equal - nearly) <= allowed).all()
