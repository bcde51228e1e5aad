"""The march's weights of rounding and underflow against a count, operation by operation, of what programs do."""

import numpy as np
import pytest
from flint import fmpq

from tests.support.generated import assemble
from tests.support.rounded import Rounded
from wavesym.programs.march.bound import _constants, _norm
from wavesym.programs.march.evaluator import marched
from wavesym.programs.march.operator import PanelOperator, operator
from wavesym.programs.march.plan import plan
from wavesym.programs.march.run import Run
from wavesym.programs.schemes.march import MarchScheme, PanelBodies
from wavesym.scene import Scene, lower

TABLES = ("ratio", "first", "last", "slack", "loss", "leak")


def inputs(degree):
    """p = alpha a + beta b + load, and the velocity at the start; one run for each coefficient, and for that, alone."""
    unit = np.eye(degree + 2)
    waves = [(Rounded(row / 2), Rounded(row / 2)) for row in unit[:-1]]
    p = [Rounded.wrong(1.0) * a + Rounded.wrong(1.0) * b + Rounded(0 * unit[0]) for a, b in waves]
    return Rounded.array(p), Rounded(unit[-1])


def test_p_is_rounded_four_times():
    p, _ = inputs(3)
    assert (np.array([number.error for number in p]) == 4 * np.eye(4, 5)).all()


def in_c(of):
    """The function `moved` of the C."""
    degree = len(of.ratio) - 1
    e, first, last, slack, loss = (Rounded.table(t) for t in (of.ratio, of.first, of.last, of.slack, of.loss))
    p, velocity = inputs(degree)
    q = [0] * (degree + 1)
    y = begun = ended = 0
    for k in range(degree, 0, -1):
        y = e[k] * (((2 * p[0] if k == 1 else p[k - 1]) - (p[k + 1] if k < degree else 0)) + y)
        q[k] = y
        begun += first[k] * y
        ended += last[k] * y
    begun = velocity - begun
    q[0] = begun - slack[()] * begun
    velocity = q[0] + (ended - loss[()] * q[0])
    before = 2 * q[0]
    for k in range(1, degree + 1):
        q[k] = before = q[k] - e[k] * before
    return q, velocity


def march(step, degree):
    """The march of two discs of that step on a panel, in NumPy."""
    scene = Scene(
        name="made",
        system={"type": "drive", "m": 1, "kappa": [step], "inertia": [1, 1]},
        load=[{"body": 1, "times": [0], "steps": [1]}],
        output={"until": "1/2", "tolerance": "1e-2", "strain": ["1/2"]},
    )
    program = assemble(marched(lower(scene), degree=degree))
    return MarchScheme(program.tables, program.constants, program.tau_max, np.float64)


def in_numpy(step, degree):
    """The scheme, with numbers that count in place of its own; of its two bodies the first."""
    made = march(step, degree)
    for name in TABLES:
        setattr(made, name, Rounded.table(getattr(made, name)))
    body = PanelBodies(made, 0)
    both = [inputs(degree) for _ in body.nodes]
    q, velocity, _ = body.moved(np.stack([p for p, _ in both]), Rounded.array([velocity for _, velocity in both]))
    return q[0], velocity[0]


def norms(q, end):
    """Of what is counted, as in `_Constants`: per |p|, |start|, smallest number; in the norm that counts c_0 twice."""
    twice = np.ones(len(q))
    twice[0] = np.sqrt(2)
    errors = twice[:, np.newaxis] * np.array([number.error for number in q])
    lost = twice * [number.underflow for number in q]
    coefficients = np.linalg.norm(errors[:, :-1] / twice, 2), np.linalg.norm(errors[:, -1]), np.linalg.norm(lost)
    return np.array([coefficients, (np.linalg.norm(end.error[:-1] / twice), end.error[-1], end.underflow)])


@pytest.mark.parametrize(
    ("step", "degree"), [("1/1000", 8), ("1/10", 21), ("1/10", 33), ("1", 8), ("1", 21), ("8", 21), ("100", 13)]
)
def test_constants_are_no_less_than_a_count_and_little_more(step, degree):
    of = operator(fmpq(step), degree)
    claimed = np.array(_constants(of))
    c, numpy = norms(*in_c(of)), norms(*in_numpy(step, degree))
    assert (claimed >= c).all()
    assert (claimed >= numpy).all()
    if fmpq(step) <= 1:  # of light bodies errors cancel, and the constants do not count with it
        assert (claimed[:, :2] <= 2.1 * np.maximum(c, numpy)[:, :2]).all()
        assert (claimed[:, 2] <= 9 * np.maximum(c, numpy)[:, 2]).all()


@pytest.mark.parametrize(("step", "degree"), [("100", 2), ("1000", 2), ("1000", 3), ("1000000", 3), ("1000000", 4)])
def test_constants_are_no_less_than_a_count_where_degrees_are_far_too_low(step, degree):
    """Of odd degree `slack` is nearly 1, of even degree `loss` is below -1."""
    claimed = np.array(_constants(operator(fmpq(step), degree)))
    assert (claimed >= norms(*in_c(operator(fmpq(step), degree)))).all()
    assert (claimed >= norms(*in_numpy(step, degree))).all()


@pytest.mark.parametrize(("slack", "loss", "degree"), [(0, 0, 64), (0, 0, 100), (1, -100, 3), (1, 100, 8)])
def test_what_sums_and_the_mean_lose_is_counted_by_itself(slack, loss, degree):
    """With tables of nearly 0, where what the coefficients may lose does not reach the value at the end."""
    tiny = (0.0,) + (2.0**-40,) * degree
    of = PanelOperator(2.0**-40, tiny, tiny, tiny, slack, loss, 2.0**-40)
    *_, claimed = _constants(of).end
    *_, counted = norms(*in_c(of))[1]
    assert counted <= claimed <= 25 * counted


def test_what_one_coefficient_loses_is_handed_on_to_all_below_it():
    """With ratios of 1, to which those of light bodies come; a product that underflows is then lost in all of them."""
    degree = 64
    one = (0.0,) + (1.0,) * degree
    of = PanelOperator(1.0, one, one, one, 0.0, 0.0, 2.0**-40)
    *_, claimed = _constants(of).coefficients
    *_, counted = norms(*in_c(of))[0]
    assert counted <= claimed <= 100 * counted


def test_an_upper_bound_of_a_norm_is_one_and_near():
    random = np.random.default_rng(1)
    for matrix in (*random.uniform(0, 1, (20, 7, 5)), np.eye(4), np.diag([1.0, 1e-9, 3, 1e3]), np.ones((3, 1))):
        norm = np.linalg.norm(matrix, 2)
        assert norm <= _norm(matrix) * (1 + 1e-12)
        assert _norm(matrix) <= 1.01 * norm


def own(since, start, half, powers):
    """A load on a panel as a series, as in C; `start` is by how much that begins later than the panel of the event."""
    c = [Rounded.wrong(power) for power in powers]
    half = Rounded.wrong(half)
    middle = (Rounded(float(since)) + Rounded.wrong(start)) + half
    square = (half * half)._scaled(0.5)
    first = (c[0] + middle * c[1]) + (middle * middle + square) * c[2]
    return [first, half * (c[1] + 2 * (middle * c[2])), square * c[2]]


@pytest.mark.parametrize(
    ("a", "b"), [([1, 0], [0, 0]), ([0, 0], [1, 0]), ([1, "-1/2"], ["1/3", 2]), (["1/1000", -1], [1, -1])]
)
def test_a_load_is_as_large_and_as_wrong_as_it_is_said_to_be(a, b):
    """It is four roundings of twice its size: as large as it is, as wrong, and rounded once more when it is added."""
    scene = Scene(
        name="made",
        system={"type": "building", "m": 2, "kappa": [1, 1, 1], "base": "ground"},
        load=[{"times": ["1/3", "5/2"], "a": a, "b": b}],
        output={"until": 7, "tolerance": "1e-2", "strain": ["1/2"]},
    )
    prepared = plan(lower(scene))
    (block,) = Run(prepared, 8).blocks()
    cuts = [float(panel.start) for panel in prepared.panels]
    compared = 0
    for window, p in np.ndindex(prepared.windows, len(cuts)):
        begun = [event for event in prepared.events if (event.window, event.panel) <= (window, p)]
        if not begun:
            assert block.forces[window, p, 0] == 0
            continue
        event, half = begun[-1], float(prepared.panels[p].length) / 2
        series = own(window - event.window, cuts[p] - cuts[event.panel], half, list(map(float, event.powers)))
        sizes, errors = np.array([c.value for c in series]), np.array([c.error for c in series])
        norm, wrong = (np.sqrt(2 * c[0] ** 2 + np.sum(c[1:] ** 2)) for c in (sizes, errors))
        force = block.forces[window, p, 0]
        assert norm <= 2 * force
        assert norm + wrong <= 4 * 2 * force
        assert block.forces[window, p, 1] == 0
        compared += norm > 0
    assert compared > 10
