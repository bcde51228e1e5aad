"""What is proved of a march under loads that are given while it runs: sums of single loads; and marches so driven."""

from fractions import Fraction
from itertools import product
from math import cos, pi, sqrt

import numpy as np
import pytest
from flint import fmpq

from tests.support.generated import numpy_text
from tests.support.rounded import Rounded
from tests.support.truth import Truth
from wavesym.errors import WavesymError
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.march import given as proving
from wavesym.programs.march.bound import Roundings, largest_wave, reading_weights
from wavesym.programs.march.evaluator import marched
from wavesym.programs.march.given import SMOOTH, batch_size, given
from wavesym.programs.march.plan import LEFT, RIGHT, plan
from wavesym.programs.march.run import Block, Run
from wavesym.programs.march.sampler import OutputSampler
from wavesym.programs.march.tail import tail_after
from wavesym.running.compiled import imported
from wavesym.scene import Scene, lower

OUTPUTS = {"strain": ["1/3"], "velocity": [1], "displacement": ["3/2"]}
DRIVE = {"type": "drive", "m": 2, "kappa": [1, "1/3"], "inertia": [1, 2, "1/2"]}
TOWER = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"]}


def scene(system, load, until=6, **outputs):
    output = {"until": until, "tolerance": "1e-3", **(outputs or OUTPUTS)}
    return Scene(name="made", system=system, load=load, output=output)


def pushed(base, *times):
    times = times or (0, "1/3")
    return scene(TOWER | {"base": base}, [{"times": times, "a": [1] * len(times), "b": [0] * len(times)}])


def turned():
    return scene(DRIVE, [{"body": 2, "times": [0, "1/2"], "steps": [1, -2]}])


SCENES = pytest.mark.parametrize(
    "made_from", [pushed("force"), pushed("ground"), turned()], ids=["force", "ground", "drive"]
)


def alone(prepared, run, channel, where, order, windows):
    """A march under one Chebyshev polynomial, on one panel of one window: its blocks, window by window."""
    size, (window, panel) = run.degree + 1, where
    gain, half = float(channel.gain), float(prepared.panels[panel].length) / 2
    shape = gain * np.polynomial.Chebyshev.basis(order)
    if channel.order:
        shape = half * shape.integ(lbnd=-1)
    column = prepared.loaded[channel.force]
    waves = np.zeros((2, len(prepared.panels), len(prepared.junctions) + 2, size))
    q = np.zeros(len(prepared.junctions))
    for n in range(windows):
        before, waves = waves, np.zeros_like(waves)
        forces = np.zeros((len(prepared.panels), len(q)))
        a, b = before[RIGHT, :, :-2], before[LEFT, :, 2:]
        balance = run.alpha * a + run.beta * b
        for p in range(len(prepared.panels)):
            if (n, p) == where:
                balance[p, column, : len(shape.coef)] += shape.coef
                forces[p, column] = np.sum(np.abs(shape.coef)) * (size + 7) * sqrt(size + 1)
            elif channel.order and (n, p) > where:
                balance[p, column, 0] += shape(1.0)
                added = (n - window + 1) * (len(prepared.panels) + 1) if n > window else (size + 7) * sqrt(size + 1)
                forces[p, column] = abs(shape(1.0)) * added
        moved, starts, ends = run.moved(balance, q)
        q, excess = ends[-1], moved[..., -1] - balance[..., -1]
        waves[LEFT, :, 1:-1], waves[RIGHT, :, 1:-1] = moved - a, moved - b
        yield Block(*(part[np.newaxis] for part in (before, waves, starts, ends, excess, forces)))


@SCENES
@pytest.mark.parametrize(
    ("degree", "real", "scale"),
    [(9, DOUBLE, fmpq(1)), (24, DOUBLE, fmpq(1)), (24, SINGLE, fmpq(1, 2**115))],
    ids=["truncation", "rounding", "underflow"],
)
def test_what_is_proved_is_the_sum_over_all_single_loads(made_from, degree, real, scale):
    """Each on its own window, to the last one; where truncation, rounding, or underflow is most of it."""
    prepared, windows, unit = plan(lower(made_from)), 3, float(real.roundoff)
    run = Run(prepared, degree)
    roundings = Roundings(prepared, run, real, scale)
    weights = [reading_weights(degree, displaced=False), reading_weights(degree, displaced=True)]
    watches = [OutputSampler(prepared, output, degree) for output in prepared.outputs]
    energies, values, integrals = np.zeros(windows), np.zeros(3), np.zeros((windows, 3))
    places = list(product(range(windows), range(len(prepared.panels))))
    assert batch_size(prepared) == len(prepared.channels) * len(prepared.panels) * 5
    for channel, where, order in product(prepared.channels, places, range(5)):
        largest = 4 / pi if order else 1.0  # what a coefficient of a load up to 1 can be
        for n, block in enumerate(alone(prepared, run, channel, where, order, windows)):
            if n < where[0]:  # nothing moves, and nothing is computed for it
                continue
            energies[n] += largest * float(np.sum(roundings.of(block)))
            for o, watch in enumerate(watches):
                integrals[n, o] += largest * watch.size(block, weights[1], summed=True)[0]
                if n == windows - 1:
                    values[o] += largest * watch.size(block, weights[0], summed=False)[0]
    proved = proving._given(prepared, degree, real, windows, scale)
    assert proved.windows == windows
    smooth = tail_after(prepared, degree, windows, [windows * jump for jump in proving._jumps(prepared)])
    stretches, lost = 2 * len(prepared.panels) + 2, 4 * (degree + 3) ** 2 * float(real.smallest / scale)
    for o, output in enumerate(prepared.outputs):
        right, left = output.heard
        assert (right.way, left.way) == (RIGHT, LEFT)
        impedance = float(prepared.junctions[right.column].right)
        if right.summed:
            expected = 2 * np.sum(np.cumsum(energies)) / sqrt(impedance)
            expected += unit * (24 * stretches * np.sum(integrals[:, o])) + windows * stretches * lost
            expected += 2 * unit * (np.arange(1, windows + 1) @ integrals[:, o])
        else:
            expected = 2 * largest_wave(smooth, prepared, np.sum(energies) / sqrt(impedance))
            expected += 12 * unit * values[o] + lost
        assert proved.errors[o] == pytest.approx(1.01 * expected, rel=1e-9, abs=0)


def test_what_is_proved_is_printed_rounded_up_and_grows_with_gains():
    prepared = plan(lower(pushed("force")))
    (exact,) = {proving._given(prepared, 20, DOUBLE, 4, fmpq(1)).errors[0]}
    assert exact <= given(prepared, 20, DOUBLE, 4).errors[0] <= 1.1 * exact
    large = given(prepared.scaled(fmpq(2) ** 40), 20, DOUBLE, 4).errors[0]
    assert exact * 2**40 <= large <= 1.1 * exact * 2**40


@pytest.mark.parametrize("base", ["force", "ground"])
def test_jumps_are_those_of_polynomials_at_both_ends_of_their_panels(base):
    prepared = plan(lower(pushed(base)))
    found = proving._jumps(prepared)
    (channel,) = prepared.channels
    expected = np.zeros(SMOOTH + 3)
    for panel in prepared.panels:
        for k in range(SMOOTH + 1):
            shape = np.polynomial.Chebyshev.basis(k)
            for order in range(SMOOTH + 1):
                there = 2 * abs(float(channel.gain)) * 4 / pi * abs(shape.deriv(order)(1.0) if order else 1.0)
                expected[order + channel.order] += there / (float(panel.length) / 2) ** order
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    assert found[0] == 0 if base == "ground" else found[0] > 0


def steps(system, windows, times, random):
    """Loads of the class, in a scene: steps between -1 and 1 at the starts of panels, which add up to no more."""
    at = [Fraction(n) + t for n in range(windows) for t in times]
    levels = [Fraction(int(level), 8) for level in random.integers(-8, 9, len(at))]
    changes = [one - other for one, other in zip(levels, [0, *levels[:-1]], strict=True)]
    if system["type"] == "drive":
        return scene(system, [{"body": 2, "times": at, "steps": changes}], windows)
    return scene(system, [{"times": at, "a": changes, "b": [0] * len(at)}], windows)


@pytest.mark.parametrize(
    "system", [TOWER | {"base": "force"}, TOWER | {"base": "ground"}, DRIVE], ids=["force", "ground", "drive"]
)
def test_no_march_is_wrong_by_more_than_proved(system):
    """At a degree at which truncation is what is wrong: at random, and against the exact solution."""
    degree, windows = 8, 5
    for seed in range(3):
        made_from = steps(system, windows, [Fraction(0), Fraction(1, 2)], np.random.default_rng(seed))
        made = marched(lower(made_from), degree=degree)
        proved = given(made.plan, degree, DOUBLE, windows)
        text = numpy_text(lower(made_from), made).replace("if self._leak >", "if 0 * self._leak >")
        taus = np.linspace(0, windows, 41)[:-1] + 1 / 64
        truth = Truth(made_from, Fraction(windows))
        for o, row in enumerate(imported(text, "made").evaluate(taus)):
            error = max(abs(float(truth.value(o, Fraction(tau)) - value)) for tau, value in zip(taus, row, strict=True))
            assert 1e-13 < error <= proved.errors[o]


def test_what_is_proved_is_settled_where_rounding_is_most_of_it():
    prepared = plan(lower(pushed("force")))
    assert not given(prepared, 9, DOUBLE, 20).settled
    assert given(prepared, 30, DOUBLE, 20).settled
    assert given(prepared, 20, SINGLE, 20).settled


def test_a_march_that_will_be_driven_has_the_degree_for_it():
    made = marched(lower(pushed("force")), windows=200)
    assert made.given.windows == 200
    assert made.given.settled
    assert made.degree > marched(lower(pushed("force"))).degree
    assert made.given == given(made.plan, made.degree, DOUBLE, 200)
    assert marched(lower(pushed("force")), windows=1).degree >= marched(lower(pushed("force"))).degree
    collision = {"type": "collision", "m": 4, "kappa": [1, 2], "velocity": [1, 0]}
    with pytest.raises(WavesymError, match="--windows: no load can be given here"):
        marched(lower(scene(collision, [])), windows=3)


def test_what_reaches_an_output_on_a_later_window_is_modelled_too():
    tower = TOWER | {"m": 5, "kappa": [1] * 6, "base": "ground"}
    short = scene(tower, [{"times": [0], "a": [1], "b": [0]}], 2, velocity=[1])
    assert len(marched(lower(short)).plan.junctions) == 4
    assert len(marched(lower(short), windows=20).plan.junctions) == 6


def series(values, cosines):
    """As `given` in C: the series of the values at the points of a panel."""
    degree, made = len(values) - 1, []
    for k in range(degree + 1):
        total = 0
        for j in range(degree + 1):
            turn = j * k % (2 * degree)
            term = values[degree - j] * cosines[turn if turn <= degree else 2 * degree - turn]
            total += term._scaled(0.5) if j in (0, degree) else term
        made.append((total if k in (0, degree) else 2 * total) / Rounded(float(degree)))
    return made


@pytest.mark.parametrize("degree", [8, 20, 41])
def test_a_load_is_rounded_no_more_than_counted(degree):
    """Of a load up to 1, in the norm that counts c_0 twice: 4 times twice its force, as on a node without mass."""
    prepared = plan(lower(pushed("force", 0)))
    run = Run(prepared, degree)
    block = next(proving._windows(prepared, run, 1))
    cosines = Rounded.table([cos(pi * j / degree) for j in range(degree + 1)])
    for k in range(SMOOTH + 1):
        values = [Rounded(cos(pi * k * (degree - j) / degree)) for j in range(degree + 1)]
        c = series(values, cosines)
        assert float(c[k].value) == pytest.approx(1.0)
        error = np.array([(c * Rounded.wrong(4.0)).error for c in c])
        norm = sqrt(2 * error[0] ** 2 + np.sum(error[1:] ** 2))
        claimed = 4 * 2 * block.forces[k, 0, 0]
        assert norm <= claimed <= 80 * norm
