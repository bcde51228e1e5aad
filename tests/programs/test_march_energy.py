"""What a window of the march loses, in energy, and what that makes of values: against true errors and worst cases."""

from dataclasses import replace
from fractions import Fraction
from math import pi, sqrt

import numpy as np
import pytest
from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.march.bound import Roundings, _constants, largest_wave
from wavesym.programs.march.evaluator import marched
from wavesym.programs.march.plan import MarchPanel, plan
from wavesym.programs.march.run import LEFT, RIGHT, Block, Run
from wavesym.programs.march.tail import Tail, tail
from wavesym.scene import Scene, lower

LOAD = {"body": 1, "times": [0], "steps": [1]}


def drive(kappa, load=LOAD, inertia=(1, 2)):
    return Scene(
        name="made",
        system={"type": "drive", "m": len(inertia) - 1, "kappa": kappa, "inertia": inertia},
        load=[load],
        output={"until": "1/2", "strain": ["1/2"]},
    )


def blank(prepared, degree, windows=1):
    """A block in which nothing moves."""
    waves = windows, 2, len(prepared.panels), len(prepared.junctions) + 2, degree + 1
    nodes = windows, len(prepared.panels), len(prepared.junctions)
    return Block(np.zeros(waves), np.zeros(waves), *(np.zeros(nodes) for _ in range(4)))


def chebyshev(k):
    """T_k as a polynomial."""
    one, two = fmpq_poly([1]), fmpq_poly([0, 1])
    for _ in range(k):
        one, two = two, 2 * fmpq_poly([0, 1]) * two - one
    return one


def exact(step, p, u):
    """The q of q' + L q = L p, L = step/2, that is 0 at -1: at points u of [-1, 1], p a polynomial."""
    with ctx.workprec(400):
        steady, rest = fmpq_poly(), p
        while rest:
            steady += rest
            rest = rest.derivative() * (-2 / step)
        at_start, near = arb(steady(fmpq(-1))), arb_poly(steady)
        return np.array([float(near(arb(x)) - at_start * (-arb(step) / 2 * (arb(x) + 1)).exp()) for x in u])


@pytest.mark.parametrize("degree", [8, 9, 14])
@pytest.mark.parametrize("step", ["1/1000", "1", "4", "30"])
def test_truncation_is_no_less_than_what_a_step_loses(step, degree):
    """A disc, on which T_d arrives."""
    prepared = plan(lower(drive([step])))
    run, node = Run(prepared, degree), prepared.junctions[0]
    step = fmpq(*Fraction(step).as_integer_ratio())
    assert node.rate == step
    block = blank(prepared, degree)
    p = np.zeros((1, len(prepared.junctions), degree + 1))
    p[0, 0, degree] = 1
    q, _, end = run.moved(p, np.zeros(len(prepared.junctions)))
    block.excess[0] = q[..., -1] - p[..., -1]
    lost, _ = Roundings(prepared, run, DOUBLE).of(block)
    points, gauss = np.polynomial.legendre.leggauss(200)
    truth = exact(step, chebyshev(degree), [*points, 1.0])
    error = np.polynomial.chebyshev.chebval(points, q[0, 0]) - truth[:-1]
    energy = float(node.left + node.right) / 2 * (gauss @ error**2)
    energy += float(node.mass) / 2 * (end[0, 0] - truth[-1]) ** 2
    assert lost[0] >= sqrt(energy)
    if step < 1 and degree % 2 == 0:  # at the end the whole of 2 eps
        assert lost[0] <= 1.01 * sqrt(energy)


@pytest.mark.parametrize("real", [DOUBLE, SINGLE], ids=["double", "single"])
def test_what_a_window_loses_is_added_up_by_nodes_and_panels(real):
    """Once more, node by node, for waves at random; sizes such that each part is seen."""
    scene = Scene(
        name="made",
        system={"type": "collision", "m": 4, "kappa": ["1/10", 3], "velocity": [1, 0]},
        output={"until": 6, "strain": [2]},
    )
    prepared, degree = plan(lower(scene)), 9
    third = fmpq(1, 3)
    prepared = replace(prepared, panels=(MarchPanel(fmpq(0), third), MarchPanel(third, 2 * third)))
    run = Run(prepared, degree)
    random = np.random.default_rng(1)
    unit, smallest = float(real.roundoff), float(real.smallest)
    for scale in (1.0, smallest / unit):
        block = blank(prepared, degree, windows=2)
        for values in vars(block).values():
            values[:] = scale * random.uniform(-1, 1, values.shape)
        block.excess[:] *= random.choice([1, unit], block.excess.shape)
        block.forces[:] = np.abs(block.forces)
        lost, inexact = Roundings(prepared, run, real).of(block)
        expected = np.zeros((2, 2))
        for window in range(2):
            for p, panel in enumerate(prepared.panels):
                energies = np.zeros(2)
                for c, node in enumerate(prepared.junctions):
                    a, b = block.before[window, RIGHT, p, c], block.before[window, LEFT, p, c + 2]
                    sent = block.after[window, :, p, c + 1]
                    size = [sqrt(2 * w[0] ** 2 + sum(w[1:] ** 2)) for w in (a, b, *sent)]
                    arriving = abs(float(node.alpha)) * size[0] + abs(float(node.beta)) * size[1]
                    arriving += 2 * block.forces[window, p, c]
                    start = abs(block.starts[window, p, c])
                    if node.rate is None:
                        q, end = 4 * unit * arriving + 16 * smallest * sqrt(degree + 2), 0.0
                    else:
                        step = node.rate * panel.length
                        made = _constants(run.operators[step])
                        q, end = (
                            unit * (of_p * arriving + of_start * start) + spare * smallest
                            for of_p, of_start, spare in made
                        )
                        leak = float(step) / (4 * (degree + 1))
                        eps = leak * (abs(block.excess[window, p, c]) + q + 4 * unit * arriving)
                        energies[0] += float(node.mass) * (float(step) * (2 * eps) ** 2 + (2 * eps) ** 2 / 2)
                    for impedance, wave in ((node.left, size[2]), (node.right, size[3])):
                        energies[1] += pi / 4 * float(panel.length * impedance) * (q + unit * wave) ** 2
                    energies[1] += float(node.mass) * end**2 / 2
                expected[:, window] += np.sqrt(energies)
        np.testing.assert_allclose([lost, inexact], expected, rtol=1e-12)


def test_l2_of_a_series_is_bounded_by_its_norm():
    """The factor pi/4 of a panel's length is needed: T_k comes within 1.3 of it, and nothing exceeds it."""
    points, gauss = np.polynomial.legendre.leggauss(40)
    basis = np.polynomial.chebyshev.chebvander(points, 30)
    gram = (basis * gauss[:, np.newaxis]).T @ basis / 2  # of a panel of length 1
    twice = np.diag([sqrt(0.5), *np.ones(30)])
    assert 0.6 < np.linalg.norm(twice @ gram @ twice, 2) <= pi / 4


def worst(degree):
    """The polynomial whose value at 1 is largest for its L2 norm, which is 1."""
    c = (2 * np.arange(degree + 1) + 1) / 2
    return np.polynomial.Legendre(c / sqrt(np.sum(c)))


@pytest.mark.parametrize("degree", [0, 1, 7, 40])
def test_no_wave_is_larger_than_its_energy_allows_and_one_is_as_large(degree):
    prepared = plan(lower(drive([1], LOAD | {"times": [0, "1/7"], "steps": [1, 1]})))
    shortest = 1 / 7
    points, gauss = np.polynomial.legendre.leggauss(degree + 1)
    found = 3.0 * worst(degree)
    energy = sqrt(shortest / 2 * (gauss @ found(points) ** 2))
    assert largest_wave(Tail(degree, 0.0), prepared, energy) == pytest.approx(found(1.0), rel=1e-12)


def test_the_tail_of_a_wave_counts_twice_over():
    """A constant and a tail that takes it away but at one point, where it doubles it: no energy, and twice the tail."""
    prepared = plan(lower(drive([1])))
    assert largest_wave(Tail(0, 0.5), prepared, 0.0) == pytest.approx(2 * 0.5)
    # a polynomial of degree K all of whose L2 norm the tail takes away
    assert largest_wave(Tail(5, 0.5), prepared, 0.0) == pytest.approx(0.5 + worst(5)(1.0) * 0.5 * sqrt(2))


def test_an_error_of_the_degree_of_the_program_is_covered_too():
    """Of heavy discs on a few windows the tail ends early; what rounds goes on to the last coefficient."""
    made = marched(lower(drive(["1/1000"])))
    worst_error = worst(made.degree)(1.0) * sqrt(2)  # of energy 1 on a window
    assert largest_wave(tail(made.plan, made.degree), made.plan, 1.0) * (1 + 1e-12) >= worst_error
