"""The exact solver against what is known without it: closed forms, conservation, symmetry, a grid; faults in it."""

from fractions import Fraction
from math import exp, factorial, floor

import numpy as np
import pytest

import wavesym
from tests.support import truth
from tests.support.truth import Truth

EPSILON = 2.0**-50  # of a few roundings of a double


def scene(system, load=(), until=10, **outputs):
    return wavesym.Scene(name="known", system=system, load=list(load), output={"until": until, **outputs})


def solved(scene):
    return Truth(scene, scene.output.until)


def near(value, expected, error=EPSILON):
    return float(abs(value - expected)) <= error * abs(expected)


COLLISION = {"type": "collision", "m": 4, "kappa": ["1/10", "1/5"], "velocity": [1, "-1/2"]}
DRIVE = {"type": "drive", "m": 2, "kappa": ["1/2", "1/3"], "inertia": [1, 2, 3]}
BUILDING = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"]}


def test_a_contact_opens_when_it_is_known_to():
    bodies = solved(scene(COLLISION, strain=[2]))
    opens, ulp = Fraction(8.901878478505666), Fraction(2) ** -49
    assert bodies.value(0, opens - ulp) < 0 < bodies.value(0, opens + ulp)


@pytest.mark.parametrize("w", [Fraction(1, 5), Fraction(3, 5)])
def test_a_disc_turns_and_the_next_one_follows(w):
    shaft = scene(
        {"type": "drive", "m": 1, "kappa": ["1/2"], "inertia": [3, 1]},
        [{"body": 1, "times": ["1/5"], "steps": [2]}],
        velocity=[0, 1],
        strain=["1/3"],
        displacement=[0],
    )
    start, k, g = Fraction(1, 5), 0.5, 1.5
    at = solved(shaft).value
    first = -2 * np.expm1(-k * float(w))
    assert near(at(1, start + w), first)
    assert near(at(0, start + Fraction(1, 3) + w), -first)
    # what arrives is 2 - 2 exp(-k w)
    second = 4 * (-np.expm1(-g * float(w)) - g * (exp(-k * float(w)) - exp(-g * float(w))) / (g - k))
    assert near(at(2, start + 1 + w), second, 1e-13)
    turned = 2 * float(w) + 4 * np.expm1(-k * float(w))
    assert near(at(3, start + w), turned, 1e-13)


def test_a_moment_on_the_last_disc_counts_against_rotation():
    shaft = scene(DRIVE, [{"body": 3, "times": [0], "steps": [1]}], velocity=[2])
    rate = 1 / 3 * 2 / 3  # kappa_2 J_2 / J_3
    size = 1 / 2 * 1 / 3  # kappa_1 J_1 / J_3
    assert near(solved(shaft).value(0, Fraction(1, 2)), size * np.expm1(-rate / 2) / rate)


@pytest.mark.parametrize("w", [Fraction(1, 3), Fraction(3, 4)])
def test_a_body_is_struck(w):
    at = solved(scene(COLLISION, strain=[2, "1+"], velocity=[2, 1], displacement=[1])).value
    assert near(at(0, w), -0.75)
    assert near(at(2, w), 0.25)
    assert near(at(3, w), 1)
    assert near(at(3, 1 + w), 1 + 0.75 * np.expm1(-0.2 * float(w)))
    # 2 b - q, where b = 1/2 - 3/4
    assert near(at(1, 1 + w), -0.5 - 1 - 0.75 * np.expm1(-0.2 * float(w)))
    moved = 1 + 0.25 * float(w) - 3.75 * np.expm1(-0.2 * float(w))
    assert near(at(4, 1 + w), moved, 1e-14)


@pytest.mark.parametrize("base", ["force", "ground"])
def test_a_floor_follows_the_base(base):
    load = {"times": [0, "5/2"], "a": [1, 3], "b": ["1/2", 0]}
    at = solved(scene(BUILDING | {"base": base}, [load], strain=[0], velocity=[1, 0])).value
    w = 0.5
    if base == "force":
        assert near(at(0, Fraction(5, 2)), (1 + 2.5 / 2 + 3) / 0.25)  # at a jump the value after it
        # q' + 2 k q = 2 k b, b = -(1 + w/2)/kappa_0
        rate = 1.2
        steady = -4 * (1 + w / 2 - 1 / (2 * rate))
        assert near(at(1, Fraction(3, 2)), steady + 4 * (1 - 1 / (2 * rate)) * exp(-rate * w))
    else:
        assert near(at(2, Fraction(3)), 3 + 9 / 4 + 3 / 2)
        # the rod carries w + w^2/4 to the floor
        rate = 1.2
        steady = w**2 / 4 + (1 - 1 / (2 * rate)) * (w - 1 / rate)
        assert near(at(1, Fraction(3, 2)), steady + (1 - 1 / (2 * rate)) / rate * exp(-rate * w), 1e-14)


def test_a_front_is_felt_far_away_however_little():
    kappa = [Fraction(k + 1, 7) for k in range(9)]
    load = {"times": ["1/3"], "a": ["1e-300"], "b": [0]}
    tall = solved(scene({"type": "building", "m": 8, "kappa": kappa, "base": "ground"}, [load], displacement=[8]))
    arrival, w = Fraction(25, 3), Fraction(1, 2**40)
    first = Fraction(10) ** -300 * w**10 / factorial(10)  # seven floors and the roof integrate once each
    for k in kappa[1:]:
        first *= 2 * k
    assert tall.arrivals(0) == [arrival]
    assert tall.value(0, arrival).is_zero()
    assert float(tall.value(0, arrival + w) * first.denominator / first.numerator) == pytest.approx(1, abs=1e-10)


GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(10)
HALF = [(Fraction(float(x)) + 1) / 4 for x in GAUSS]  # the left half of a rod; waves meet in the middle


def momentum_and_energy(system, load, taus):
    """Of a chain whose rods weigh kappa times as much as their bodies, by quadrature along the rods."""
    m = system["m"]
    bodies = [1, 3] if system["type"] == "collision" else range(m + 1)
    places = [i + x + half for i in range(m) for half in (0, Fraction(1, 2)) for x in HALF]
    exact = solved(scene(system, load, strain=places, velocity=[*places, *bodies]))
    if system["type"] == "collision":
        rods, masses = [1] * m, [1 / float(Fraction(k)) for k in system["kappa"]]
    else:
        masses = system["inertia"]
        rods = [float(Fraction(k)) * j for k, j in zip(system["kappa"], masses, strict=False)]
    weights = np.repeat(rods, 2 * len(WEIGHTS)) * np.tile(WEIGHTS / 4, 2 * m)
    for tau in taus:
        values = np.array([float(exact.value(k, tau)) for k in range(len(exact.scene.outputs))])
        strain, velocity, body = np.split(values, [len(places), 2 * len(places)])
        momentum = weights @ velocity + masses @ body
        yield momentum, weights @ (velocity**2 + strain**2) + masses @ body**2


def test_a_free_collision_keeps_momentum_and_energy():
    taus = [n + Fraction(1, 2) for n in range(6)]
    momentum, energy = zip(*momentum_and_energy(COLLISION, [], taus), strict=True)
    assert np.allclose(momentum, 12 - 0.5 * 7, rtol=1e-12)
    assert np.allclose(energy, 12 + 0.25 * 7, rtol=1e-12)


@pytest.mark.slow
def test_moments_change_the_momentum_of_a_drive_and_then_leave_it():
    loads = [{"body": 1, "times": [0, 2], "steps": [1, -1]}, {"body": 3, "times": [1, 2], "steps": [3, -3]}]
    found = momentum_and_energy(DRIVE, loads, [Fraction(5, 2), Fraction(13, 2), Fraction(19, 2)])
    momentum, energy = zip(*found, strict=True)
    assert np.allclose(momentum, 0.5 * (2 - 3), rtol=1e-12)
    assert np.allclose(energy, energy[0], rtol=1e-12)


@pytest.mark.quick(1)
@pytest.mark.parametrize("wrong", ["a", "b"])
def test_a_wrong_sign_is_caught(monkeypatch, wrong):
    right = truth.Node.moves

    def moves(self, a, b, *load):
        return right(self, a * (-1 if wrong == "a" else 1), b * (-1 if wrong == "b" else 1), *load)

    monkeypatch.setattr(truth.Node, "moves", moves)
    with pytest.raises(AssertionError):
        test_a_free_collision_keeps_momentum_and_energy()
    with pytest.raises(AssertionError):
        test_moments_change_the_momentum_of_a_drive_and_then_leave_it()


def test_a_mirror_shows_the_same():
    places = [0, "1/3", 1, 2, "17/5", 6]
    mirrored = [6 - Fraction(x) for x in places]
    chain = {"type": "collision", "m": 6, "kappa": ["1/2", 2, "1/3"], "velocity": [3, 1, 0]}
    image = {"type": "collision", "m": 6, "kappa": ["1/3", 2, "1/2"], "velocity": [0, -1, -3]}
    strains = [f"{x}-" for x in places], [f"{x}+" for x in mirrored]
    one = solved(scene(chain, strain=strains[0], velocity=places, displacement=places))
    other = solved(scene(image, strain=strains[1], velocity=mirrored, displacement=mirrored))
    for k in range(18):
        for tau in (Fraction(1, 3), Fraction(3), Fraction(77, 10)):
            seen = other.value(k, tau)
            assert one.value(k, tau).overlaps(seen if k < 6 else -seen)


def test_what_cancels_is_exactly_zero():
    chain = {"type": "drive", "m": 2, "kappa": [1, 1], "inertia": [1, 1, 1]}
    loads = [{"body": body, "times": ["1/3"], "steps": [1]} for body in (1, 3)]
    twisted = solved(scene(chain, loads, velocity=[1, "1/2"], strain=["1-", "1+"]))
    middle = twisted.scene.outputs.index(next(o for o in twisted.scene.outputs if o.name == "velocity@1"))
    assert twisted.arrivals(middle) == []
    assert twisted.largest(middle, Fraction(10)) == (0, 0)
    assert twisted.value(middle, Fraction(19, 3)).is_zero()
    pulse = [{"times": [0, 1], "a": [1, -1], "b": [0, 0]}]
    base = solved(scene(BUILDING | {"base": "force"}, pulse, strain=[0]))
    assert base.arrivals(0) == [0, 1]
    assert base.value(0, Fraction(1, 2)) == 4
    assert base.value(0, Fraction(1)).is_zero()


@pytest.mark.parametrize("bits", [40, 80, 300])
def test_values_are_as_exact_as_asked(bits):
    exact = solved(scene(COLLISION, strain=["1+"]))
    value, better = (exact.value(0, Fraction(9.7), bits=b) for b in (bits, 500))
    assert value.rel_accuracy_bits() >= bits
    assert value.overlaps(better)


@pytest.mark.parametrize("until", [Fraction(1, 2), Fraction(7, 2), Fraction(10)])
def test_the_largest_value_lies_between_its_bounds(until):
    load = {"times": [0, "1/3"], "a": [1, "-1/2"], "b": ["-1/4", "1/2"]}
    exact = solved(scene(BUILDING | {"base": "force"}, [load], strain=["1/3"], velocity=[0, "3/2"], displacement=[2]))
    for k in range(4):
        lower, upper = (float(bound) for bound in exact.largest(k, until))
        taus = [until * i / 500 for i in range(501)]
        taus += [tau - late for tau in exact.arrivals(k) if 0 < tau <= until for late in (0, Fraction(1, 2**60))]
        sampled = max(float(abs(exact.value(k, tau))) for tau in taus)
        assert lower <= upper <= 1.002 * lower
        assert sampled <= upper * (1 + EPSILON)
        assert lower <= sampled * 1.01


def on_a_grid(system, sources, until, steps):
    """Strain right of x = 0, 1, ... and velocity there at tau = 0, 1/steps, ..., by the trapezoidal rule at each body.

    `system` is a list of (mass, rod to its right); `sources` by body the force as a function of tau.
    """
    count, h = len(system), 1 / steps
    right = np.zeros((count + 1, steps))  # waves on their way in the rod right of each body, the last to arrive first
    left = np.zeros((count + 1, steps))
    q, history = np.zeros(count), []
    before = np.array([force(0.0) for force in sources])
    impedance = np.array([0.0, *(rod for _, rod in system[:-1]), 0.0])
    masses = np.array([mass for mass, _ in system])
    for k in range(floor(until * steps) + 1):
        turn = k % steps
        a = np.concatenate(([0.0], right[: count - 1, turn]))
        b = np.concatenate((left[: count - 1, turn], [0.0]))
        now = np.array([force(k * h) for force in sources]) + 2 * impedance[:-1] * a + 2 * impedance[1:] * b
        drag = (impedance[:-1] + impedance[1:]) / masses
        if k:
            q = (q * (1 - drag * h / 2) + h / 2 * (before + now) / masses) / (1 + drag * h / 2)
        before = now
        history.append((2 * b - q, q.copy()))
        # what is sent now arrives in a unit; b - q left of body i travels in rod i - 1
        left[: count - 1, turn], right[: count - 1, turn] = (q - a)[1:], (q - b)[:-1]
    return np.array(history)


def test_a_grid_comes_near():
    """A train under a smooth moment: the trapezoidal rule is right to the second order."""
    kappa, inertia = [0.5, 0.25, 2], [1, 2, 3, 0.5]
    shafts = [k * j for k, j in zip(kappa, inertia, strict=False)]
    moment = 2.0
    exact = solved(
        scene(
            {"type": "drive", "m": 3, "kappa": kappa, "inertia": inertia},
            [{"body": 2, "times": [0], "steps": [int(moment)]}],
            strain=[0, "1+", "2+"],
            velocity=[0, 1, 2, 3],
        )
    )
    forces = [lambda _: 0.0, lambda _: shafts[0] * moment, lambda _: 0.0, lambda _: 0.0]
    steps = 200
    history = on_a_grid([*zip(inertia, [*shafts, 0.0], strict=True)], forces, 10, steps)
    for tau in (Fraction(3, 2), Fraction(7, 2), Fraction(19, 2)):
        strain, velocity = history[int(tau * steps)]
        values = [float(exact.value(k, tau)) for k in range(7)]
        assert np.allclose(values[:3], strain[:3], atol=1e-4)
        assert np.allclose(values[3:], velocity, atol=1e-4)
