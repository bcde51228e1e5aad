"""The proved bound of a model of a chain: no error is larger, whatever the parameters, and whatever is wrong."""

import numpy as np
import pytest

import wavesym
from tests.running.test_chain_sets import drawn
from tests.running.test_model_chains import EVERY, HARD, NUMBERS, exact, frame, model_of, shaft, tree
from tests.support.built_model import BuiltModel
from tests.support.faults import BLOCKS, BODIES, POINTS

slow = pytest.mark.slow


def check(made, make, numbers):
    """Bounds are no smaller than errors."""
    status, bound = made.bound(*(value for values in numbers.values() for value in values))
    assert status == 0
    wrong = made.errors(make(exact(numbers)))
    assert np.all(wrong <= bound)
    return bound, wrong


@EVERY
@pytest.mark.parametrize("flags", [("-O1",), ("-O3", "-march=native", "-ffp-contract=fast")])
@slow
def test_no_error_is_larger(make, flags, tmp_path):
    made = BuiltModel(make(NUMBERS[make]), list(NUMBERS[make]), tmp_path, flags=flags)
    bound, _ = check(made, make, {name: [float(value) for value in of] for name, of in NUMBERS[make].items()})
    assert np.all(bound < 1e-8)
    check(made, make, {name: [float(value) for value in of] for name, of in HARD[make].items()})
    sets = drawn(make, 9, seed=11, spread=1.5)
    for k in range(2, 9):
        numbers = {name: values[k].tolist() for name, values in sets.items()}
        if made.build(*(value for values in numbers.values() for value in values)) == 0:
            check(made, make, numbers)


@slow
def test_from_python():
    found = model_of(tree).bounds(mass=[[1, 1], [-1, 1]])
    assert found.shape == (2, len(model_of(tree).outputs))
    assert np.all(found[0] < 1e-8)
    assert np.isnan(found[1]).all()


@pytest.mark.parametrize(("heavier", "faster"), [(0, -700), (0, -600), (0, 600), (0, 900), (-200, -400), (200, 600)])
@slow
def test_bounds_do_not_depend_on_units(heavier, faster):
    """The equations are linear in what begins and acts, and in all masses and forces; powers of 2 are exact."""
    model = model_of(tree)
    powers = {"velocity": faster, "load": heavier + faster}
    scaled = {name: np.ldexp(of, powers.get(name, heavier)) for name, of in model.parameters.items()}
    usual, bounds = model.bounds(), model.bounds(**scaled)
    assert np.all(np.isfinite(usual) & (usual > 0))
    assert np.all((bounds > 0.999 * usual) & (bounds < 1.001 * usual))


@slow
def test_what_underflows_is_in_the_bound():
    """Forces that are hardly numbers: digits are lost against the same in other units, and bounds know it."""
    linked = [{"mass": 1, "velocity": 1, "dashpot": 1}, {"rod": 1}, {"mass": 2, "spring": 2}, {"rod": 1}]
    scene = wavesym.Scene(
        name="faint",
        system={"type": "chain", "parts": [*linked, {"mass": 1, "velocity": "-1/2"}]},
        output={"until": 4, "velocity": ["1/3", "4/3"], "strain": ["1/2"]},
    )
    names = ["mass", "dashpot", "spring", "impedance", "velocity"]
    model = wavesym.model(scene, runtime=names)
    tau = np.linspace(0, 4, 101)
    usual, bounds = model.run(tau)[0], model.bounds()[0]
    largest = np.max(np.abs(usual), axis=1)
    lost = 0.0
    for power in range(-860, -780, 4):
        scaled = {name: np.ldexp(model.parameters[name], -220 if name == "velocity" else power) for name in names}
        wrong = np.max(np.abs(np.ldexp(model.run(tau, **scaled)[0], 220) - usual), axis=1) / largest
        refused = model.check(**scaled).status[0] != 0
        assert refused or np.all(wrong <= (model.bounds(**scaled)[0] + bounds) * 1.1)
        lost = lost if refused else max(lost, np.max(wrong))
    assert lost > 1e-9


def linked(until=4, **output):
    """A mass, and two rods that a dashpot links."""
    parts = [{"mass": 1, "velocity": 1, "name": "a"}, {"rod": 1}, {"dashpot": 1}, {"rod": 1, "impedance": 2}, "free"]
    output = output or {"velocity": ["1/2", "3/2"]}
    return wavesym.Scene(name="linked", system={"type": "chain", "parts": parts}, output={"until": until, **output})


@pytest.mark.parametrize("power", [-520, -515, -500, 500, 515, 700, 1015])
@slow
def test_what_products_of_parameters_lose_is_refused(power):
    """In other units nothing changes, or the chain would be another one: then no value is given, and no bound."""
    model = wavesym.model(linked(), ["mass", "dashpot", "impedance"])
    tau = np.linspace(0, 4, 101)
    scaled = {name: np.ldexp(1.1 * of, power) for name, of in model.parameters.items()}
    usual = model.run(tau, **{name: 1.1 * of for name, of in model.parameters.items()})
    status, bounds = model.check(**scaled).status[0], model.bounds(**scaled)
    assert status == (0 if abs(power) < 505 else 1)
    assert np.isnan(bounds).all() if status else np.all(bounds < 1e-10)
    assert status or np.max(np.abs(model.run(tau, **scaled) - usual)) < 1e-13


@slow
def test_an_output_whose_weight_underflows_is_not_silent():
    """The acceleration of a mass by a spring, stiffness over mass: nothing is left of it, and that is said."""
    parts = [{"mass": 1, "velocity": 1, "name": "a"}, {"spring": 1}, {"mass": 1, "velocity": 0}, {"rod": 1}, "free"]
    scene = wavesym.Scene(
        name="faint", system={"type": "chain", "parts": parts}, output={"until": 4, "acceleration": ["a"]}
    )
    model = wavesym.model(scene, ["mass", "spring"])
    faint = {"mass": [1e200, 1], "spring": [1e-200]}
    assert model.check(**faint).status[0] == 0
    assert model.bounds(**faint)[0, 0] == np.inf
    assert model.check(**faint).estimate[0] == np.inf


@slow
def test_what_a_chain_cannot_tell_is_not_claimed():
    """What moves 1e-20 as far as the waves that it sends back, is 0 in doubles; what nothing has reached is 0, too."""
    heavy = {"mass": [[1e20], [1.0]]}
    parts = [{"mass": 1, "name": "a"}, {"rod": 1}, {"mass": 1, "name": "b"}, {"rod": 1}, "free"]
    scene = wavesym.Scene(
        name="heavy",
        system={"type": "chain", "parts": [{"rod": 1, "velocity": 1}, {"mass": 1, "velocity": 0, "name": "b"}]},
        output={"until": 4, "velocity": ["b"]},
    )
    late = wavesym.Scene(
        name="late",
        system={"type": "chain", "parts": parts},
        load=[{"at": at, "times": [0], "steps": [1]} for at in "ab"],
        output={"until": "3/2", "velocity": ["a", "7/4"]},
    )
    estimate = wavesym.model(scene, ["mass"]).check(**heavy).estimate
    told = wavesym.model(late, ["mass", "load"]).check(load=[[1, 0], [0, 1], [1, 1]]).estimate
    assert estimate[0] == np.inf
    assert estimate[1] < 1e-9
    assert np.all(told < 1e-9)


def pressed(p):
    """With a force on what springs link."""
    return frame(p).with_({"load[0].at": "box"})


FAULTS = {
    pressed: BLOCKS,
    frame: [*BLOCKS[:5], *BODIES[:5]],
    tree: [*BLOCKS[:5], BLOCKS[6], *BODIES[:5], POINTS[0]],
    shaft: [*BODIES[:5], *POINTS],
}
"""Those that change what the chain does."""


@pytest.mark.parametrize(
    ("make", "change"),
    [
        pytest.param(make, change, marks=() if change is BLOCKS[0] and make is pressed else slow)
        for make, changes in FAULTS.items()
        for change in changes
    ],
)
def test_what_is_computed_wrong_is_in_the_bound(make, change, tmp_path):
    numbers = NUMBERS.get(make, NUMBERS[frame])
    made = BuiltModel(make(numbers), list(numbers), tmp_path, [change])
    bound, wrong = check(made, make, {name: [float(value) for value in of] for name, of in numbers.items()})
    assert np.max(wrong) > 1e-12
    assert np.all(bound >= wrong)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "changes",
    [
        (
            BLOCKS[3],
            ("larger(apart[port], here)", "larger(apart[port], 0 * here)"),
            ("w->energy += w->length[panel] *", "w->energy += 0 * w->length[panel] *"),
        ),
        (BLOCKS[4], ("rest += MAGNITUDE(missed)", "rest += 1e-12 * MAGNITUDE(missed)")),
        (BLOCKS[0], ("w->energy += w->weight[first + i] *", "w->energy += 1e-9 * w->weight[first + i] *")),
        (
            BLOCKS[2],
            ("apart[port] + w->moves[port] *", "apart[port] + 1e-9 * w->moves[port] *"),
            ("larger(apart[port], here)", "larger(apart[port], 0 * here)"),
        ),
    ],
)
def test_a_mistake_in_the_bound_is_seen(changes, tmp_path):
    made = BuiltModel(frame(NUMBERS[frame]), list(NUMBERS[frame]), tmp_path, changes)
    with pytest.raises(AssertionError):
        check(made, frame, {name: [float(value) for value in of] for name, of in NUMBERS[frame].items()})


def rods(p):
    """Two rods of different impedance between masses: at their joint absolute values add up to more than 1."""
    return wavesym.Scene(
        name="rods",
        system={
            "type": "chain",
            "parts": [
                {"mass": p["mass"][0], "name": "a"},
                {"rod": 1},
                {"rod": 1, "impedance": 2},
                {"mass": p["mass"][1], "name": "b"},
            ],
        },
        load=[{"at": "a", "times": [0], "steps": [1]}],
        output={"until": 100, "tolerance": "1e-12", "velocity": ["a", "b"], "strain": ["1/2"]},
    )


TWO = {"mass": [1.0, 0.5]}
ROUGH = BODIES[3]


@slow
def test_errors_do_not_grow_from_joint_to_joint(tmp_path):
    """As long as all waves at an instant have a norm, which joints do not enlarge; without it they do."""
    bounds = []
    for changes in ([], [("error = all < error ? all : error;", "(void)all;")]):
        folder = tmp_path / str(len(changes))
        folder.mkdir()
        bounds.append(check(BuiltModel(rods(TWO), ["mass"], folder, changes), rods, TWO)[0])
    assert np.all(10 * bounds[0] < bounds[1])


@pytest.mark.parametrize("share", ["1", "1e-9"])
@slow
def test_a_mistake_in_that_norm_is_seen(share, tmp_path):
    made = BuiltModel(
        rods(TWO), ["mass"], tmp_path, [ROUGH, ("w->steady * w->energy", f"{share} * w->steady * w->energy")]
    )
    if share == "1":
        assert np.max(check(made, rods, TWO)[1]) > 1e-12
    else:
        with pytest.raises(AssertionError):
            check(made, rods, TWO)
