"""The march of a chain: within its bound of the exact motion, where a bound is likeliest to be wrong."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings

from tests.support.drives import DRIVE, drive, every, exact, instants, small
from tests.support.laplace import Laplace
from wavesym.errors import CostError, UnservedError, WavesymError
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.choice import choose
from wavesym.programs.making import program
from wavesym.programs.rings.evaluator import RingMarch, ring_march
from wavesym.programs.rings.plan import ring_plan
from wavesym.scene import Scene, lower

HALF_ULP = 2.0**-53


def in_bounds(model: Model, made: RingMarch, taus: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Errors of all outputs in parts of what is allowed; the true values were rounded once."""
    found = program(model, made).evaluate(taus)
    allowed = np.array([output.bound * output.largest for output in made.outputs])
    error = np.maximum(np.max(np.abs(found - true), axis=1) - HALF_ULP * np.max(np.abs(true), axis=1), 0)
    return np.where(error == 0, 0, error / np.where(allowed > 0, allowed, 5e-324))


def test_a_drive_with_shafts_1_3_half_and_2_to_24() -> None:
    model = lower(drive())
    made = choose(model, "march").evaluator
    assert isinstance(made, RingMarch)
    assert (made.plan.step, made.plan.windows) == (fmpq(1, 2), 49)
    assert 0 < made.error_bound < 1e-8
    taus = instants(model, 16)
    assert np.all(in_bounds(model, made, taus, exact(model, taus)) <= 1)


@pytest.mark.parametrize("real", [DOUBLE, SINGLE], ids=["double", "single"])
def test_every_kind_of_joint(real) -> None:
    model = lower(every(2))
    made = ring_march(model, real)
    taus = instants(model, 12 if real is DOUBLE else 5)
    if real is SINGLE:
        taus = np.unique(taus.astype(np.float32).astype(np.float64))
        taus = taus[taus <= made.tau_max]
    assert made.error_bound < (1e-9 if real is DOUBLE else 0.5)
    assert np.all(in_bounds(model, made, taus, exact(model, taus)) <= 1)


@settings(max_examples=12)
@given(small())
def test_drawn_chains_against_a_laplace_expansion(table) -> None:
    """Which shares nothing with the march, nor with the series that other programs are made of."""
    try:
        model = lower(Scene(**table))
        made = ring_march(model)
    except WavesymError:
        return
    taus = instants(model, 4)[::2]
    expansion = Laplace(table, model_until(model))
    terms = [expansion.terms(*probe.name.split("@")) for probe in model.probes]
    true = np.array([[float(each.value(Fraction(tau)).mid()) for tau in taus.tolist()] for each in terms])
    assert np.all(in_bounds(model, made, taus, true) <= 1)


def model_until(model: Model) -> Fraction:
    return Fraction(int(model.until.p), int(model.until.q))


@pytest.mark.parametrize("until", ["1/3", "7/3", "100000001/100000000", 5])
def test_horizons_hardly_after_an_arrival(until) -> None:
    """Of a delay 1/3: windows do not begin at doubles; and of what has hardly begun only the first values count."""
    parts = [{"mass": 1, "velocity": 1}, {"rod": "1/3"}, {"rod": 1, "impedance": 2}, {"mass": "1/2"}]
    scene = Scene(
        name="late",
        system={"type": "chain", "parts": parts},
        output={"until": until, "velocity": [0, "4/3"], "strain": ["1/3-", "5/6"]},
    )
    model = lower(scene)
    made = ring_march(model)
    taus = instants(model, 25)
    assert np.all(in_bounds(model, made, taus, exact(model, taus)) <= 1)


def test_windows_that_never_begin_at_a_whole_number_again() -> None:
    """A step of 1.234567: a cycle would have a million windows, the horizon has nine."""
    parts = [{"mass": 1, "velocity": 1}, {"rod": "1.234567"}, "fixed"]
    output = {"until": 10, "strain": [0, "1.234567"]}
    model = lower(Scene(name="odd", system={"type": "chain", "parts": parts}, output=output))
    made = ring_march(model)
    assert made.plan.cycle[0] == 9
    taus = instants(model, 20)
    assert np.all(in_bounds(model, made, taus, exact(model, taus)) <= 1)


@pytest.mark.parametrize("stiffness", ["1/1000000", 1, 1000])
def test_springs_soft_and_stiff(stiffness) -> None:
    parts = [{"rod": 1, "velocity": 1}, {"mass": 1, "velocity": 0, "spring": stiffness}, {"rod": "1/2"}]
    scene = Scene(name="sprung", system={"type": "chain", "parts": parts}, output={"until": 3, "velocity": ["1-", 0]})
    model = lower(scene)
    made = ring_march(model)
    taus = instants(model, 6)
    assert made.error_bound < 1e-8
    assert np.all(in_bounds(model, made, taus, exact(model, taus)) <= 1)


def test_a_spring_of_a_million() -> None:
    """It swings 160 times a unit of tau; a Laplace expansion has it in closed form."""
    parts = [{"rod": 1, "velocity": 1}, {"mass": 1, "velocity": 0, "spring": 10**6}, {"rod": "7/6"}]
    output = {"until": "1.3", "tolerance": "1e-5", "velocity": ["1-", 0], "strain": ["1/3"]}
    table = {"name": "stiff", "system": {"type": "chain", "parts": parts}, "output": output}
    model = lower(Scene(**table))
    made = ring_march(model)
    assert made.plan.step == fmpq(1, 6)
    assert made.error_bound < 1e-6
    taus = np.linspace(0, 1.3, 14)
    expansion = Laplace(table, model_until(model))
    terms = [expansion.terms(*probe.name.split("@")) for probe in model.probes]
    true = np.array([[float(each.value(Fraction(tau)).mid()) for tau in taus.tolist()] for each in terms])
    assert np.all(in_bounds(model, made, taus, true) <= 1)


@pytest.mark.parametrize("times", [["1e-9"], ["1/2", "0.5000001"], ["1/3", "2/3", "0.7", "1.1"]])
def test_loads_at_nasty_times(times) -> None:
    """Panels that are very short, which cost much of the bound, and many."""
    parts = [
        {"mass": 1},
        {"rod": 1},
        {"mass": "1/2", "dashpot": "1/3", "name": "b"},
        {"rod": "3/2", "impedance": "1/4"},
    ]
    signs = [(-1) ** k for k in range(len(times))]
    scene = Scene(
        name="nasty",
        system={"type": "chain", "parts": [*parts, {"spring": 3}, {"mass": 1, "name": "hung"}]},
        load=[{"at": "b", "times": times, "steps": signs, "ramps": [1] * len(times)}],
        output={"until": 3, "velocity": ["b", "hung"], "strain": ["1+"], "displacement": ["hung"]},
    )
    model = lower(scene)
    made = ring_march(model)
    assert made.error_bound < 1e-5
    taus = instants(model, 20)
    assert np.all(in_bounds(model, made, taus, exact(model, taus)) <= 1)


@pytest.mark.parametrize("dashpot", [1, "1.000000001", "0.999999999"])
def test_a_dashpot_near_the_impedance(dashpot) -> None:
    """One that is equal to it sends back exactly 0; the others send 1e-9 of what arrives, and not rounding."""
    parts = [{"mass": 4, "velocity": 1}, {"rod": 1}, {"joint": True, "dashpot": dashpot}]
    scene = Scene(
        name="end",
        system={"type": "chain", "parts": parts},
        output={"until": 6, "strain": ["1/2"], "velocity": ["1/2"]},
    )
    model = lower(scene)
    made = ring_march(model)
    strain, velocity = program(model, made).evaluate(np.linspace(0, 6, 97))
    assert velocity.any()
    assert np.array_equal(strain, -velocity) == (dashpot == 1)
    taus = instants(model)
    assert np.all(in_bounds(model, made, taus, exact(model, taus)) <= 1)


def test_what_stays_0_is_0() -> None:
    parts = [{"mass": 4, "velocity": 1}, {"rod": 1}, "fixed"]
    scene = Scene(name="bar", system={"type": "chain", "parts": parts}, output={"until": 6, "velocity": ["1", 0]})
    made = ring_march(lower(scene))
    fixed, free = program(lower(scene), made).evaluate([0.5, 2.5, 6.0])
    assert not fixed.any()
    assert free.all()
    assert (made.outputs[0].bound, made.outputs[0].largest) == (0, 0)


def test_a_chain_that_stays_at_rest_asks_for_no_higher_degree() -> None:
    parts = [{"mass": 1, "spring": "1/40"}, {"rod": 3, "impedance": "3/20", "spring": 7}, "absorbing"]
    scene = Scene(name="rest", system={"type": "chain", "parts": parts}, output={"until": 10, "velocity": [0]})
    made = ring_march(lower(scene), SINGLE)
    assert made.error_bound == 0
    assert made.degree < 30


def refused(scene: Scene, error: type[WavesymError], **changes: object) -> str:
    with pytest.raises(error) as raised:
        ring_march(replace(lower(scene), **changes))
    line = str(raised.value)
    assert "\n" not in line
    return line


def chain(*lengths: object, spring: object = 0, load: list | None = None, until: object = 3) -> Scene:
    parts = [{"mass": 1, "name": "hit", "spring": spring}, *({"rod": length} for length in lengths)]
    load = load or [{"at": "hit", "times": [0], "steps": [1]}]
    return Scene(
        name="made", system={"type": "chain", "parts": parts}, load=load, output={"until": until, "velocity": [0]}
    )


def test_the_finest_step_is_a_64th() -> None:
    assert ring_march(lower(chain(1, "65/64"))).plan.step == fmpq(1, 64)
    line = refused(chain(1, "66/65"), CostError)
    assert "delays 1, 66/65 have the common measure 1/65, 65 to the shortest, at most 64 expected" in line
    # what is out of reach does not count
    assert ring_march(lower(chain(3, 3, "1.001", until=2))).plan.step == 3


def test_contacts_are_refused() -> None:
    model = lower(drive())
    touching = replace(model.network, links=(Link(0, 1, contact=True, place="3/2"),))
    assert "the contact at 3/2 opens and closes" in refused(drive(), UnservedError, network=touching)


def test_springs_too_stiff_are_refused_with_the_figure() -> None:
    line = refused(chain(2, spring=10**6), CostError)
    assert "joints as fast as 1e+03 on a step of 2 need polynomials of degree" in line
    assert "e+06 bytes of tables, at most 4.2e+06 expected in a march" in line
    assert re.search(r"polynomials of degree \d\.\d+e\+\d\d to", refused(chain(2, spring=10**160), CostError))


def test_rings_too_long_are_refused_whatever_the_joints() -> None:
    line = refused(chain(1, "1e-9"), CostError)
    assert "the rings of a march on a step of 1/1000000000 would have" in line


def test_load_times_with_many_remainders_are_refused() -> None:
    load = [{"at": "hit", "times": [f"{k}/17" for k in range(1, 18)], "steps": [1] * 17}]
    assert "leave 17 different remainders of the step 1, at most 16 expected" in refused(chain(1, load=load), CostError)


def test_marches_that_take_long_are_refused() -> None:
    assert "would cost" in refused(chain(1, "65/64", until=10**6), CostError)


def test_chains_take_no_given_loads() -> None:
    with pytest.raises(UnservedError, match="--windows: chain given"):
        choose(lower(drive()), "march", windows=10)


def test_auto_takes_the_march_where_pieces_end() -> None:
    """And would take pieces before."""
    parts = [part for part in DRIVE["parts"] if part != {"mass": 2}]
    scene = Scene(
        name="far",
        system={"type": "chain", "parts": parts},
        output={"until": 900, "tolerance": "1e-4", "strain": [0]},
        load=[{"at": "motor", "times": [0], "steps": [1]}],
    )
    choice = choose(lower(scene))
    assert choice.name == "march"
    assert "pieces: " in choice.reason


def test_the_light_cone_ends_in_what_is_held() -> None:
    """Of a train of many rods only those that can be felt are marched; what stands beyond them sends nothing new."""
    parts = [{"mass": 1, "velocity": 1, "name": "hit"}, *({"rod": 1, "velocity": 1} for _ in range(40))]
    scene = Scene(
        name="train",
        system={"type": "chain", "parts": parts},
        load=[{"at": "hit", "times": ["1/2"], "steps": [-1]}],
        output={"until": "9/2", "velocity": ["2"], "displacement": ["2"]},
    )
    model = lower(scene)
    assert len(ring_plan(model).joints) < 10
    made = ring_march(model)
    taus = instants(model)
    assert np.all(in_bounds(model, made, taus, exact(model, taus)) <= 1)
