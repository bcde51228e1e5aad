"""The march: within its bound of the truth, conservative, and loud where its degree is too low."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.generated import assemble, numpy_text
from wavesym.errors import CostError, ToleranceError
from wavesym.exact.silence import silent
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.choice import choose
from wavesym.programs.march.bound import judge
from wavesym.programs.march.evaluator import marched
from wavesym.programs.march.operator import operator
from wavesym.programs.march.plan import plan
from wavesym.programs.march.run import LEFT, RIGHT, Run
from wavesym.running.compiled import imported
from wavesym.scene import Scene, lower
from wavesym.verification.characteristics import integrate
from wavesym.verification.graph import graph
from wavesym.verification.reference import known


def program(scene, made):
    return assemble(made).evaluate


def building(until, load, m=2, base="force", kappa="3/5", tolerance="1e-6", **outputs):
    outputs = outputs or {"strain": ["1/3", "1+"], "velocity": [m], "displacement": ["1/2"]}
    system = {"type": "building", "m": m, "kappa": [kappa] * (m + 1), "base": base}
    return Scene(name="scene", system=system, load=[load], output={"until": until, "tolerance": tolerance, **outputs})


SHORT_PULSE = {"times": [0, 2], "a": [1, -1], "b": [0, 0]}
KINKS = {"times": [0, "1/3", "5/2", "37/10"], "a": [1, 0, -1, 0], "b": [0, "1/2", 0, "-1/2"]}


def check(scene):
    """Values at every arrival and its neighbours, and between."""
    truth = known(lower(scene))
    made = marched(lower(scene))
    values = program(scene, made)(np.array(truth.taus))
    for output, row, proved in zip(truth.outputs, values, made.outputs, strict=True):
        # the reference is rounded too
        assert output.error(row) <= proved.bound + 2.0**-53
        assert proved.bound < 1e-7


@pytest.mark.parametrize("name", ["building_m2", "building_half_roof", "collision_m4", "drive_equal", "drive_m1"])
def test_built_in_scenes_are_within_the_bound(name):
    check(Scene.from_toml(name))


@pytest.mark.parametrize("base", ["force", "ground"])
@pytest.mark.parametrize("load", [SHORT_PULSE, KINKS], ids=["pulse", "kinks"])
def test_buildings_are_within_the_bound(base, load):
    check(building("29/3", load, base=base))


kappas = st.sampled_from(["1/20", "1/2", 1, "11/10", 3])
times = st.lists(st.sampled_from(["0", "1/3", "1/2", "1", "7/4", "5/2"]), min_size=1, max_size=3, unique=True)
weights = st.sampled_from([1, -1, "1/2", "-2/3"])


@st.composite
def scenes(draw):
    kind = draw(st.sampled_from(["collision", "drive", "building"]))
    load = {"times": sorted(draw(times), key=Fraction)}
    listed = [draw(weights) for _ in load["times"]]
    if kind == "collision":
        m, loads = 6, []
        system = {"velocity": ["1", "1/2", draw(st.sampled_from(["0", "-1/2"]))], "kappa": [draw(kappas)] * 3}
    elif kind == "drive":
        m = draw(st.integers(1, 3))
        system = {"kappa": [draw(kappas) for _ in range(m)], "inertia": [draw(kappas) for _ in range(m + 1)]}
        loads = [load | {"body": draw(st.integers(1, m + 1)), "steps": listed}]
    else:
        m = draw(st.integers(2, 3))
        system = {"kappa": [draw(kappas) for _ in range(m + 1)], "base": draw(st.sampled_from(["force", "ground"]))}
        loads = [load | {"a": listed, "b": [draw(weights) for _ in listed]}]
    output = {
        "until": draw(st.sampled_from(["1/2", "4", "13/2"])),
        "strain": ["1/3", 0],
        "velocity": ["2/7", m],
        "displacement": [1, "5/8"],
    }
    return Scene(name="scene", system={"type": kind, "m": m, **system}, load=loads, output=output)


@settings(max_examples=15)
@given(scenes())
def test_random_scenes_are_within_the_bound(scene):
    check(scene)


def test_long_horizons_agree_with_direct_integration():
    scene = building(60, KINKS, m=3)
    made = marched(lower(scene))
    taus = np.random.default_rng(1).uniform(0, 60, 200)
    coarse, fine = (integrate(graph(lower(scene)), made.tau_max, steps) for steps in (64, 128))
    for probe, row in zip(lower(scene).probes, program(scene, made)(taus), strict=True):
        expected = fine.at(probe, taus.tolist())
        error = np.abs(expected - coarse.at(probe, taus.tolist())).max() / 4  # of fourth order
        assert np.abs(row - expected).max() <= error + 1e-12 * np.abs(expected).max()


def energy(prepared, degree, waves, ends):
    """That of rods, by Gauss's rule, and bodies; after a window."""
    points, gauss = np.polynomial.legendre.leggauss(degree + 1)
    basis = np.polynomial.chebyshev.chebvander(points, degree).T
    total = 0.0
    for column, node in enumerate(prepared.junctions):
        total += float(node.mass) * ends[-1, column] ** 2 / 2
        for number, panel in enumerate(prepared.panels):
            for direction, impedance in ((LEFT, node.left), (RIGHT, node.right)):
                values = waves[direction, number, column + 1] @ basis
                total += float(impedance) * float(panel.length) / 2 * (gauss @ values**2)
    return total


@pytest.mark.parametrize(
    "scene",
    [
        building(400, SHORT_PULSE, m=3),
        Scene(
            name="scene",
            system={"type": "drive", "m": 2, "kappa": [1, "1/3"], "inertia": [1, 2, "1/2"]},
            load=[{"body": 1, "times": [0, "1/2"], "steps": [1, -1]}],
            output={"until": 400, "strain": [0]},
        ),
        Scene(
            name="scene",
            system={"type": "collision", "m": 4, "kappa": ["1/10", 1], "velocity": [1, 0]},
            output={"until": 400, "strain": [2]},
        ),
    ],
    ids=["building", "drive", "collision"],
)
def test_free_systems_keep_their_energy(scene):
    prepared, degree = plan(lower(scene)), marched(lower(scene)).degree
    blocks = list(Run(prepared, degree).blocks())
    found = [energy(prepared, degree, block.after[-1], block.ends[-1]) for block in blocks]
    assert found[0] > 0
    np.testing.assert_allclose(found, found[0], rtol=1e-13)


def test_the_degree_grows_with_the_horizon_and_suffices():
    degrees = [marched(lower(building(until, SHORT_PULSE, m=2))).degree for until in (20, 200, 2000)]
    assert degrees == sorted(degrees)
    assert degrees[-1] < 3 * math.sqrt(1.2 * 2000)


def test_a_degree_that_is_too_low_is_never_silent():
    scene = building(300, SHORT_PULSE)
    low = marched(lower(scene), degree=16)
    assert low.error_bound > 1e-3  # what is lost is in the bound
    with pytest.raises(ArithmeticError, match="degree 16 is too low"):
        program(scene, low)(300.0)
    truth = program(scene, marched(lower(scene)))(np.linspace(290, 300, 101))
    coarse = np.abs(truth).max()
    # and it was lost indeed: without the alarm the values are wrong
    text = numpy_text(lower(scene), low).replace("if self._leak >", "if 0 * self._leak >")
    error = np.abs(imported(text, "made").evaluate(np.linspace(290, 300, 101)) - truth).max() / coarse
    assert 1e-9 < error < low.error_bound


def test_truncation_is_bounded_by_what_is_missed():
    """At a degree where truncation is most of the error, the bound still holds."""
    scene = building(12, KINKS, kappa=4)
    truth = known(lower(scene))
    exact = np.array([output.values for output in truth.outputs])
    for degree in (10, 14):
        verdict = judge(plan(lower(scene)), degree, DOUBLE)
        assert verdict.truncated > verdict.rounded
        made = marched(lower(scene), degree=degree)
        text = numpy_text(lower(scene), made).replace("if self._leak >", "if 0 * self._leak >")
        errors = np.abs(imported(text, "made").evaluate(np.array(truth.taus)) - exact).max(axis=1)
        assert (errors <= verdict.errors).all()
        assert (errors > 1e-15).all()


def test_the_operator_solves_the_equation():
    """q' + 2 q = 2 p for p = u + 1 on [-1, 1], in twice as fine a variable: q = u + 1/2 + c exp(-2 u)."""
    rate, degree = 2.0, 30
    table = operator(fmpq(4), degree)  # rate 2 on a panel of length 2
    p = np.zeros(degree + 2)
    p[:2] = 1, 1
    y = np.zeros(degree + 2)
    p[0] *= 2
    for k in range(degree, 0, -1):
        y[k] = table.ratio[k] * (p[k - 1] - p[k + 1] + y[k + 1])
    q = np.zeros(degree + 1)
    q[0] = (1 - table.slack) * (0.7 - np.dot(table.first, y[:-1]))
    end = q[0] * (1 - table.loss) + np.dot(table.last, y[:-1])
    for k in range(1, degree + 1):
        q[k] = y[k] - table.ratio[k] * (2 * q[0] if k == 1 else q[k - 1])
    u = np.linspace(-1, 1, 11)
    exact = u + 1 - 1 / rate + (0.7 + 1 / rate) * np.exp(-rate * (u + 1))
    np.testing.assert_allclose(np.polynomial.chebyshev.chebval(u, q), exact, atol=1e-14)
    assert end == pytest.approx(exact[-1], abs=1e-14)
    assert all(0 < e < 1 for e in table.ratio[1:])


def test_only_the_light_cone_is_marched():
    load = {"times": [0], "a": [1], "b": [0]}
    wide = marched(lower(building(6, load, m=40, strain=["21/2"])))
    tight = marched(lower(building(6, load, m=20, strain=["21/2"])))
    assert wide == tight
    assert len(wide.plan.junctions) == 12
    assert wide.outputs[0].bound == 0.0  # the base is out of reach
    assert (program(building(6, load, m=40, strain=["21/2"]), wide)(np.linspace(0, 6, 99)) == 0.0).all()


def test_what_is_zero_by_symmetry_is_exactly_zero():
    """Two equal halves: the middle stands still, though rounding alone could not tell; beside it all moves."""
    scene = Scene(
        name="scene",
        system={"type": "collision", "m": 4, "kappa": ["3/7", "3/7"], "velocity": [1, -1]},
        output={"until": 12, "strain": [0, 2], "velocity": [2, "199/100"], "displacement": [2]},
    )
    made = marched(lower(scene))
    assert [output.bound == 0 for output in made.outputs] == [True, False, True, False, True]
    values = program(scene, made)(np.linspace(0, 12, 1001))
    assert np.any(values != 0, axis=1).tolist() == [False, True, False, True, False]
    assert silent(lower(scene), fmpq(12)) == [True, False, True, False, True]


def test_what_cannot_be_had_is_refused():
    with pytest.raises(ToleranceError, match=r"march: rounding leaves a bound of \S+ to tau = 50 for"):
        choose(lower(building(50, SHORT_PULSE, tolerance="1e-14")), "march")
    many = [Fraction(k, 17) for k in range(17)]
    with pytest.raises(CostError, match="17 different fractional parts, at most 16 expected"):
        marched(lower(building(2, {"times": many, "a": [1] * 17, "b": [0] * 17})))
    with pytest.raises(CostError, match="polynomials of degree"):
        marched(lower(building(10**8, SHORT_PULSE)))


def test_single_precision_has_a_bound_of_its_own():
    scene = building(5, KINKS, tolerance="1e-2")
    made = marched(lower(scene), SINGLE)
    assert 1e-6 < made.error_bound < 1e-2
    truth = known(lower(scene))
    taus = [tau for tau in truth.taus if float(np.float32(tau)) == tau]
    values = program(scene, made)(np.array(taus, np.float32))
    assert values.dtype == np.float32
    picked = np.isin(truth.taus, taus)
    for output, row, proved in zip(truth.outputs, values, made.outputs, strict=True):
        assert np.abs(row - output.values[picked]).max() <= proved.bound * output.scale


@pytest.mark.parametrize("exponent", [-290, -200, 200, 280])
def test_bounds_do_not_depend_on_the_size_of_the_loads(exponent):
    """Energies are squares: those of tiny or huge waves are beyond the doubles that the bound is added up in."""

    def marching(size):
        scene = Scene(
            name="scene",
            system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
            load=[{"body": 1, "times": [0], "steps": [size]}],
            output={"until": 12, "strain": ["1/2"], "displacement": [1]},
        )
        return marched(lower(scene))

    ordinary, made = marching(1), marching(f"1e{exponent}")
    for output, other in zip(made.outputs, ordinary.outputs, strict=True):
        assert output.bound == other.bound
        assert output.largest == pytest.approx(other.largest * 10.0**exponent, rel=1e-14)
