"""Many sets of a chain's parameters: side by side each is what its chain is alone."""

import numpy as np
import pytest

import wavesym
from tests.running.test_model_chains import EVERY, HARD, NUMBERS, exact, frame, model_of
from tests.targets.test_runtime_batch import Batch, check_neighbours


def flat(make, numbers):
    return [float(value) for name in NUMBERS[make] for value in numbers[name]]


def drawn(make, count, seed=5, spread=1.0):
    """Sets about the scene's own, of which some are nasty."""
    random = np.random.default_rng(seed)
    own = NUMBERS[make]
    sets = {
        name: np.array(values) * 10 ** random.uniform(-spread, spread, (count, len(values)))
        for name, values in own.items()
    }
    for name, values in sets.items():
        values[:3] = own[name], HARD[make][name], np.where(np.array(own[name]) == 0, 0, 1)
    return sets


@pytest.mark.slow
@EVERY
@pytest.mark.parametrize("flags", [("-O2", "-march=native"), ("-O1", "-DNAME_PLAIN")])
def test_sets_side_by_side_are_what_they_are_alone(make, flags, tmp_path):
    made = Batch(make(NUMBERS[make]), list(NUMBERS[make]), tmp_path, flags)
    assert made.width == 8
    sets = drawn(make, 8)
    some = [[value for name in sets for value in sets[name][k].tolist()] for k in range(8)]
    light, wrong = flat(make, NUMBERS[make]), flat(make, NUMBERS[make])
    light[0], wrong[0] = 1e-7, -1.0
    assert check_neighbours(made, some, [wrong, light]) == [1, 2]


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        ("all->rates[k], lane) = law->rates[k]", "all->rates[k], 0) = law->rates[k]"),
        ("panel] + degree + 1, higher - degree + SPARE - 1)", "panel] + degree + 1, 0 * higher)"),
        ("AT((x)[(set) / SETS], (set) % SETS)", "AT((x)[(set) / SETS], 0)"),
    ],
)
def test_a_mistake_is_seen(change, tmp_path):
    made = Batch(frame(NUMBERS[frame]), list(NUMBERS[frame]), tmp_path, changes=[change])
    sets = drawn(frame, 8)
    some = [[value for name in sets for value in sets[name][k].tolist()] for k in range(8)]
    with pytest.raises(AssertionError):
        check_neighbours(made, some, [])


@pytest.mark.slow
@EVERY
def test_misfits_are_sums_of_squares(make):
    model, random = model_of(make), np.random.default_rng(1)
    sets = drawn(make, 19)
    tau = random.uniform(0, model.tau_max, 170)
    data = model.run(tau)[0] + 0.01 * random.standard_normal((len(model.outputs), len(tau)))
    data[0, ::3] = np.nan
    sums = np.nansum((model.run(tau, **sets) - data) ** 2, axis=(1, 2))
    assert model.misfit(tau, data)(**sets) == pytest.approx(sums, rel=1e-10, abs=0)


@pytest.mark.slow
def test_derivatives_by_a_load_that_is_0_are_as_good():
    """What that load would move needs degrees that the motion itself does not."""
    model, tau = model_of(frame), np.linspace(0, 4.5, 19)
    numbers = NUMBERS[frame] | {"dashpot": [8, 40], "impedance": [11, 2], "load": [0, 0.5]}
    with_it = NUMBERS[frame] | {"dashpot": [8, 40], "impedance": [11, 2], "load": [1, 0]}
    slope = model.gradients(tau, **numbers).by["load"][0, 0]  # as motion is linear in loads, that of load 1 alone
    true = wavesym.evaluator(frame(exact(with_it)))(tau)
    assert np.all(np.max(np.abs(slope - true), axis=1) <= 1e-9 * np.max(np.abs(true), axis=1) + 1e-13)


ENDS = wavesym.Scene(
    name="ends",
    system={
        "type": "chain",
        "parts": [
            {"mass": 1, "name": "hammer"},
            {"rod": 1, "impedance": "3/10"},
            {"rod": "1/3", "impedance": "7/10"},
        ],
    },
    load=[{"at": "hammer", "times": [0], "steps": [1]}],
    output={"until": 5, "tolerance": "1e-11", "velocity": [0], "strain": ["4/3"]},
)
TOUCHING = wavesym.Scene(
    name="touching",
    system={"type": "collision", "m": 4, "kappa": [1, 2], "velocity": [1, -1]},
    output={"until": 6, "tolerance": "1e-11", "strain": ["0+", "1+"]},
)


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "names"), [(ENDS, ["mass", "impedance"]), (TOUCHING, ["kappa", "velocity"])])
def test_what_is_always_0_does_not_count(scene, names):
    """The strain of a free end: without that knowledge there was rounding in it, and no estimate of the others."""
    model = wavesym.model(scene, runtime=names)
    silent = [k for k, name in enumerate(model.outputs) if name in ("strain@4/3", "strain@0+")]
    values = model.run(np.linspace(0, model.tau_max, 50))[0]
    assert not values[silent].any()
    assert np.all(np.max(np.abs(values), axis=1)[[k for k in (0, 1) if k not in silent]] > 0.1)
    assert model.check().estimate[0] < 1e-10
    assert model.bounds()[0, silent] == 0


@pytest.mark.slow
@pytest.mark.parametrize("until", ["2", "2.0000001", "2.001", "2.1"])
def test_what_lies_beyond_the_horizon_does_not_count(until):
    """An output that is reached just before the end is small; what its polynomials are later on is no part of it."""
    scene = wavesym.Scene(
        name="gears",
        system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
        load=[{"body": 1, "times": [0], "steps": [1]}],
        output={"until": until, "tolerance": "1e-11", "velocity": [0, 2]},
    )
    model = wavesym.model(scene, runtime=["kappa"])
    tau = np.linspace(0, model.tau_max, 101)
    true = wavesym.evaluator(scene)(tau)
    largest, wrong = np.max(np.abs(true), axis=1), np.max(np.abs(model.run(tau)[0] - true), axis=1)
    assert np.all(wrong <= model.check().estimate[0] * largest)
    # and side by side
    apart = model.misfit(tau, true)
    assert np.isfinite(apart(kappa=np.ones((9, 2)))).all()
