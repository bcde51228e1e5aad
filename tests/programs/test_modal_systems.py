"""Modal systems of models: their outputs against exact waves and finite elements, and what is left out, proved."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh

from tests.support.drawn import systems
from tests.support.modal import building, by_elements, chain, samples
from wavesym.errors import CostError, ToleranceError, UnservedError
from wavesym.exact.reference import Reference
from wavesym.mechanics.damping import Damping
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.modes.evaluator import modal_system
from wavesym.programs.modes.loads import Roughness, roughness
from wavesym.programs.modes.modal_system import scheme_tables
from wavesym.programs.modes.rounding import rounding_errors
from wavesym.programs.modes.stepping import SteppedModes
from wavesym.programs.modes.truncation import ModalModes
from wavesym.programs.modes.undamped_modes import UndampedModes
from wavesym.scene import Scene, lower

PULSE = {"times": [0, "7/3", "5/2"], "a": [0, 0, 0], "b": [1, -3, 2]}
PUSH = {"at": "n", "times": [0, "7/3", "5/2"], "ramps": [1, -3, 2]}
ALL = {"strain": ["0", "1/2", "1-", "1+"], "velocity": ["1/2", 1], "displacement": ["1.3", 2], "acceleration": [1, 2]}
MORE = {"force": [0], "drift": [1, 2], "relative": [2]}

UNDAMPED = {
    "ground": building(["1", "1/4", "3/5"], [samples(6)], until=6, tolerance="1e-3", **ALL, **MORE),
    "force": building(["1/2", "1/4", "3/5"], [PULSE], base="force", tolerance="1e-3", **MORE),
    "force, accelerations": building(
        ["1/2", "1/4", "3/5"], [PULSE], base="force", tolerance="1/2", acceleration=[1, 2]
    ),
    "one storey": building(["1", "3/5"], [samples(9)], tolerance="1e-4", strain=[0, 1], acceleration=[1]),
    "heavy": building(["1", "1e-3", "1e-3"], [samples(6)], until=5, tolerance="1e-1", **ALL),
    "a chain with a branch": chain(
        ["fixed", {"rod": 1}, {"mass": 1, "name": "n"}, {"rod": "1/2", "impedance": 2}, {"joint": True}],
        [PUSH],
        [{"from": "n", "name": "a", "ratio": -2, "parts": [{"rod": "1/3"}, {"mass": "1/2", "spring": 1}]}],
        tolerance="1e-3",
        strain=["0", "1+", "a:0", "a:1/3"],
        velocity=["3/2", "a:1/6"],
        displacement=["n", "a:1/3"],
        acceleration=["n"],
        until=7,
    ),
    "nothing holds it": chain(
        [{"mass": 1, "name": "n"}, {"rod": 1}, {"mass": 2}, {"rod": 1, "speed": 2}, {"mass": 1, "name": "e"}],
        [PUSH],
        tolerance="1e-4",
        strain=["0", "1-"],
        velocity=["n", "e"],
        displacement=["n", "3/2"],
        acceleration=["e"],
        until=9,
    ),
    "pushed where there is no mass": chain(
        [{"motion": "acceleration", "name": "m"}, {"rod": 1}, {"joint": True, "name": "n"}, {"rod": 1}, {"mass": 1}],
        [PUSH, {"at": "m", "times": ["1/2"], "ramps": ["1/3"]}],
        tolerance="1e-2",
        strain=["0", "1-", "1+"],
        displacement=["3/2"],
        relative=["2"],
        until=6,
    ),
}


def scheme(model, made):
    tables = scheme_tables(made.system, made.loads, DOUBLE)
    return SteppedModes(tables, {"loads": len(made.sources)}, model.horizon(), np.float64)


def values(model, made, taus):
    return scheme(model, made).evaluate(taus)


def rounding(model, made):
    return rounding_errors(made.system, made.loads, scheme(model, made), model.horizon(), DOUBLE).errors


def with_modes(model, count):
    """The first `count` modes, and what the others can add."""
    built = UndampedModes(model)
    known = built.project(count)
    errors = built.errors(known, count)
    rest = np.zeros(count)
    return ModalModes(built.system(known, count), built.sources, built.loads, errors, errors, known.w, rest)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", UNDAMPED)
def test_outputs_are_those_of_waves_but_for_what_is_left_out(name):
    """With few modes and with enough, errors are within the bound, which meets the tolerance."""
    model = UNDAMPED[name]
    taus = np.linspace(0, model.horizon(), 75)
    exact = np.array(Reference(model).values(taus.tolist()))
    made = modal_system(model)
    assert np.all(made.bounds <= float(fmpq(model.tolerance)))
    assert np.all(made.largest <= 1.1 * np.abs(exact).max(axis=1))
    for few in (made, with_modes(model, 3 * len(model.network.bars))):
        error = np.abs(values(model, few, taus) - exact).max(axis=1)
        assert np.all(error <= few.errors + rounding(model, few))


@pytest.mark.slow
@settings(max_examples=40)
@given(st.data())
def test_drawn_chains_under_drawn_loads_are_within_the_bound(data):
    """Equal and nearly equal parameters, a storey to three, loads that are linear between drawn instants."""
    table = data.draw(systems(("drive", "building"), largest=3))
    times = sorted(data.draw(st.lists(st.fractions(0, 4, max_denominator=7), min_size=1, max_size=4, unique=True)))
    slopes = st.integers(-5, 5).filter(bool)
    ramps = data.draw(st.lists(slopes, min_size=len(times), max_size=len(times)))
    load = {"times": times, "ramps": ramps, "body": 1}
    if table["type"] == "building":
        load = {"times": times, "b": ramps}
    place = st.fractions(0, table["m"], max_denominator=5)
    output = {name: [data.draw(place)] for name in ("velocity", "displacement")}
    output["strain"] = [data.draw(place.filter(lambda x: x.denominator > 1 or x in (0, table["m"])))]
    model = lower(Scene(name="a", system=table, load=[load], output={"until": 5, **output}))
    taus = np.linspace(0, 5, 41)
    exact = np.array(Reference(model).values(taus.tolist()))
    for count in (5 * table["m"], 60):
        made = with_modes(model, count)
        error = np.abs(values(model, made, taus) - exact).max(axis=1)
        assert np.all(error <= made.errors + (rounding(model, made) if made.sources else 0))


def test_a_bound_can_fail():
    """It is no more than 40 times what is wrong, and a mode less is more wrong than the bound."""
    model = building(["1", "1/4", "3/5"], [samples(9)], strain=["0"])
    model = model.watching(model.probes[:1])
    taus = np.linspace(0, 10, 101)
    exact = np.array(Reference(model).values(taus.tolist()))
    made = with_modes(model, 40)
    error = np.abs(values(model, made, taus) - exact).max()
    assert made.errors / 40 < error <= made.errors
    without = made.system.displacement_weights.copy()
    without[0, 6] = 0
    assert (
        np.abs(
            values(model, replace(made, system=replace(made.system, displacement_weights=without)), taus) - exact
        ).max()
        > made.errors
    )
    assert np.abs(values(model, with_modes(model, 12), taus) - exact).max() > made.errors


DAMPED = {
    "a ratio": Damping((fmpq(1, 20),)),
    "a list": Damping((fmpq(1, 50), fmpq(1, 5), fmpq(11, 10))),
    "critical": Damping((fmpq(1),)),
    "more": Damping((fmpq(3),)),
    "nearly critical": Damping((fmpq(99, 100),)),
    "Rayleigh": Damping((fmpq(1, 20),), (1, 2)),
    "a little of Rayleigh": Damping((fmpq(1, 1000),), (1, 3)),
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", DAMPED)
def test_damped_modes_beyond_those_taken_are_within_the_bound(name):
    model = replace(building(["1", "1/4", "3/5"], [samples(9)], **ALL, **MORE), damping=DAMPED[name])
    taus = np.linspace(0, 10, 101)
    many = values(model, with_modes(model, 200), taus)
    for count in (8, 40):
        few = with_modes(model, count)
        assert np.all(np.abs(values(model, few, taus) - many).max(axis=1) <= few.errors)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["a ratio", pytest.param("a list", marks=pytest.mark.slow), "Rayleigh"])
def test_damped_outputs_are_those_of_finite_elements(name):
    """Linear elements, extrapolated; each of their modes is damped and stepped by SciPy."""
    from scipy.signal import lsim  # slow to import

    damping = DAMPED[name]
    load = samples(9)
    model = replace(building(["1", "1/4", "3/5"], [load], tolerance="1e-4", relative=[1, 2]), damping=damping)
    spacing = 0.7
    times = np.arange(0, 10, spacing / 50)
    ground = np.interp(times, spacing * np.arange(len(load["samples"])), load["samples"])
    by_resolution = []
    for resolution in (12, 24):
        whole, mass, stiffness = by_elements(replace(model, damping=None), resolution)
        squares, shapes = eigh(stiffness, mass)
        pulled = whole.sum(axis=1)  # by the ground, whose motion all else shares
        w = np.sqrt(squares)
        if damping.modes:
            i, j = (w[n - 1] for n in damping.modes)
            ratios = float(damping.ratios[0]) * (i * j / w + w) / (i + j)
        else:
            given = [float(ratio) for ratio in damping.ratios]
            ratios = np.array([given[min(n, len(given) - 1)] for n in range(len(w))])
        total = 0
        for n in range(12):
            made = lsim(([1], [1, 2 * ratios[n] * w[n], w[n] ** 2]), -shapes[:, n] @ pulled * ground, times)[1]
            total = total + np.outer(shapes[[0, 1], n], made)
        by_resolution.append(total)
    expected = (4 * by_resolution[1] - by_resolution[0]) / 3
    made = modal_system(model)
    difference = np.abs(values(model, made, times)[-2:] - expected).max(axis=1)
    assert np.all(difference <= 2e-4 * np.abs(expected).max(axis=1))


def test_outputs_that_are_0_are_exactly_0():
    """At a free end, and where nothing has come to; they have no error and are no hindrance to the others."""
    bars = ["fixed", {"rod": 1}, {"mass": 1, "name": "n"}, {"rod": 1}, {"rod": 1}, "free"]
    model = chain(bars, [PUSH], tolerance="1e-3", until="3/2", strain=["3", "1+"], velocity=["n", "2.7"])
    made = modal_system(model)
    assert made.bounds[0] == made.bounds[3] == 0
    assert np.all(made.bounds[1:3] > 0)
    assert not values(model, made, np.linspace(0, 1.5, 9))[[0, 3]].any()


SYMMETRIC = ["free", {"rod": "1/2"}, {"mass": 1, "name": "l"}, {"rod": 1}, {"mass": 2, "name": "c"}]
SYMMETRIC += [{"rod": 1}, {"mass": 1, "name": "r"}, {"rod": "1/2"}, "free"]


def both(sign, late="1"):
    """A load on the left and one on the right."""
    right = {"times": [0, late, 2], "ramps": [sign, -2 * sign, sign]}
    return [{"at": "l", "times": [0, 1, 2], "ramps": [1, -2, 1]}, {"at": "r", **right}]


@pytest.mark.parametrize(
    "damping",
    [
        Damping((fmpq(1, 20),)),
        *(pytest.param(d, marks=pytest.mark.slow) for d in (None, Damping((fmpq(1, 20),), (1, 2)))),
    ],
)
def test_outputs_that_are_0_by_symmetry_are_exactly_0(damping):
    """In the middle, under opposite loads; strain there under equal ones; at one of equal branches. Elsewhere not."""
    watched = {"velocity": ["c", "1/3"], "displacement": ["c"], "acceleration": ["c"], "until": 20, "tolerance": "1e-2"}
    model = replace(chain(SYMMETRIC, both(-1), **watched), damping=damping)
    made = modal_system(model)
    found = values(model, made, np.linspace(0, 20, 41))
    zero = [probe.name.endswith("@c") for probe in model.probes]
    assert zero.count(True) == 3
    assert not made.bounds[zero].any()
    assert not found[zero].any()
    assert made.bounds[~np.array(zero)].all()
    branches = [{"from": "c", "name": name, "parts": [{"rod": 1}, {"mass": 1, "name": f"m{name}"}]} for name in "xyz"]
    loads = [{**load, "at": f"m{name}"} for name, load in zip("xy", both(-1), strict=True)]
    star = chain(SYMMETRIC, loads, branches, velocity=["c", "mx", "mz"], until=20, tolerance="1e-2")
    assert (modal_system(replace(star, damping=damping)).bounds > 0).tolist() == [False, True, False]


@pytest.mark.parametrize(
    "loads", [both(-1, "999/1000"), *(pytest.param(both(sign), marks=pytest.mark.slow) for sign in (-2, 1))]
)
def test_outputs_that_are_nearly_0_have_a_bound(loads):
    model = chain(SYMMETRIC, loads, velocity=["c"], until=9, tolerance="1/10")
    made = modal_system(replace(model, damping=Damping((fmpq(1, 20),))))
    assert made.bounds[0] > 0
    assert made.largest[0] > 1e-5


def test_what_no_number_of_modes_tells_from_0_is_refused_early(monkeypatch):
    """Of loads that nearly cancel: not after thousands of modes, but after the first."""
    model = chain(SYMMETRIC, both(-1.0000000001), velocity=["c"], until=9, tolerance="1e-3")
    counts, every = [], UndampedModes.project

    def counted(built, count):
        counts.append(count)
        return every(built, count)

    monkeypatch.setattr(UndampedModes, "project", counted)
    with pytest.raises(ToleranceError, match="would not tell the largest value of velocity@c from 0"):
        modal_system(model)
    assert max(counts) < 200


def test_equal_frequencies_are_damped_alike_or_refused():
    """Two branches that are the same, against exact waves; a list of ratios does not say which mode it means."""
    same = [{"from": "g", "name": name, "parts": [{"rod": 1}, {"mass": 1, "name": f"m{name}"}]} for name in "ab"]
    parts = ["fixed", {"rod": 1}, {"mass": 1, "name": "g"}, {"rod": 1}, {"mass": 1}]
    model = chain(parts, [{**PUSH, "at": "ma"}], same, velocity=["g", "mb"], strain=["a:0"], until=8, tolerance="1e-3")
    taus = np.linspace(0, 8, 57)
    exact = np.array(Reference(model).values(taus.tolist()))
    made = modal_system(model)
    assert np.any(np.diff(made.frequencies) == 0)
    error = np.abs(values(model, made, taus) - exact).max(axis=1)
    assert np.all(error <= made.errors + rounding(model, made))
    with pytest.raises(
        UnservedError, match=r"^system.damping: 0.05 and 0.1 for modes 2 and 3, which have one frequency, 0.860334"
    ):
        modal_system(replace(model, damping=Damping((fmpq(1, 20), fmpq(1, 20), fmpq(1, 10)))))


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        ("a ratio", "1e-5"),
        *(pytest.param(name, "1e-10", marks=pytest.mark.slow) for name in ("a ratio", "a list", "Rayleigh")),
    ],
)
def test_damped_modes_move_before_a_wave_arrives(name, tolerance):
    """A horizon that ends when the first wave arrives has the values of one that ends later."""
    watched = {"displacement": [1, 2], "drift": [2], "relative": [2], "tolerance": tolerance}
    short, long = (
        replace(building(["1", "1", "1"], [samples(9)], until=until, **watched), damping=DAMPED[name])
        for until in (2, 3)
    )
    taus = np.linspace(0, 2, 21)
    made, later = modal_system(short), modal_system(long)
    found, expected = values(short, made, taus), values(long, later, taus)
    assert np.all(np.abs(found[1:]).max(axis=1) > 1e-3)
    assert np.all(np.abs(found - expected).max(axis=1) <= made.errors + later.errors + 1e-12)
    still = replace(short, damping=Damping((fmpq(0),)))
    assert not values(still, modal_system(still), taus)[2].any()  # displacement@2


def test_motion_that_is_told_has_a_largest_value():
    """No mode has a part in it, and it is known to the last digits, also where it is all that is asked for."""
    model = building(["1", "1"], [PULSE], until=3, velocity=[0], displacement=[0])
    made = modal_system(model)
    assert np.all(made.errors == 0)
    assert np.all(made.bounds == 0)
    # each ramp of the acceleration, integrated twice and thrice
    ramps = ((0.0, 1.0), (7 / 3, -3.0), (5 / 2, 2.0))
    expected = [sum(b * (3 - t) ** n / (2, 6)[n - 2] for t, b in ramps) for n in (2, 3)]
    np.testing.assert_allclose(np.abs(values(model, made, [3.0])[:, 0]), np.abs(expected), rtol=1e-12)
    assert np.all(made.largest > 0.999 * np.abs(expected))


def test_what_modes_do_not_serve_is_refused():
    step = {"times": [0], "a": [1], "b": [0]}
    with pytest.raises(UnservedError, match="jumps"):
        modal_system(building(["1", "1"], [step]))
    with pytest.raises(UnservedError, match="at tau = 0 is not supported by modes"):
        modal_system(chain(["fixed", {"rod": 1, "velocity": 1}, {"mass": 1, "name": "n"}], [PUSH]))
    told = chain([{"motion": "velocity", "name": "n"}, {"rod": 1}, {"mass": 1}], [PUSH])
    with pytest.raises(UnservedError, match="the motion at n prescribes a velocity"):
        modal_system(told)
    with pytest.raises(
        ToleranceError,
        match=r"1e-13 cannot be met; write .* or more \(modes: 4000 modes.*a bound of about .* for velocity@1/2",
    ):
        modal_system(building(["1", "1"], [samples(9)], tolerance="1e-13", velocity=["1/2"]))


def test_many_rods_are_refused_at_once():
    with pytest.raises(CostError, match=r"^system: 400 rods in modes, the limit is 129"):
        modal_system(building(["1"] * 401, [samples(3)]))


def test_no_load_is_no_motion():
    """Outputs are exactly 0; of a building the system is ready for its load."""
    for model in (building(["1", "1"]), chain(["free", {"rod": 1}, {"mass": 1}, {"rod": 1}, "fixed"])):
        made = modal_system(model)
        assert made.errors.tolist() == made.bounds.tolist() == [0]
        assert not values(model, made, np.linspace(0, 10, 5)).any()
    assert modal_system(building(["1", "1"])).sources == (("a", "b"),)


@pytest.mark.parametrize("count", [5, 60, 700])
def test_kinks_in_step_are_not_underestimated(count):
    """The largest partial sum of kinks at any frequency, against many frequencies; and it is worth its work."""
    draw = np.random.default_rng(count)
    kinks = draw.normal(size=count)
    rough = Roughness(0.7 * np.arange(count), kinks, tuple(range(count)), 1.0)
    w = np.sort(draw.uniform(0, 2 * np.pi / 0.7, 400))
    sums = np.abs(np.cumsum(kinks * np.exp(-1j * np.outer(w, rough.times)), axis=1)).max(axis=1)
    assert sums.max() <= rough.in_step <= 2 * sums.max()
    assert rough.in_step <= np.abs(kinks).sum() * (1 + 1e-6)
    some = 0.3
    total = max(
        sum(abs(kinks[k]) * np.exp(-some * (rough.times[n] - rough.times[k])) for k in range(n + 1))
        for n in range(min(count, 60))
    )
    assert total <= rough.fading(some)
    if count <= 60:
        assert rough.fading(some) == pytest.approx(total)
    assert rough.fading(1.0) <= np.abs(kinks).sum() * (1 + 1e-6)
    assert rough.fading(1e9) == pytest.approx(np.abs(kinks).max())
    assert Roughness(rough.times, kinks, None, inf).in_step == pytest.approx(np.abs(kinks).sum())


def test_roughness_is_that_of_the_load():
    """Changes of slope at their times: of 0, 2, 1, then constant in steps of 1/2."""
    model = building(["1", "1"], [{"spacing": "1/2", "samples": [0, 2, 1]}])
    (rough,) = roughness(UndampedModes(model).loads)
    assert rough.times.tolist() == [0, 0.5, 1]
    assert rough.kinks.tolist() == [4, -6, 2]
    assert (rough.steps, rough.steepest) == ((0, 1, 2), 4)
