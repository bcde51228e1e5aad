"""Waves put by hand into a march, on a panel of a billionth: read from exact instants, not from rounded ones."""

from fractions import Fraction
from functools import cache
from itertools import pairwise

import numpy as np
from flint import fmpq, fmpq_poly

from tests.support.generated import numpy_text
from tests.targets.test_march_hand import March, library
from wavesym.programs.march.bound import reading_weights
from wavesym.programs.march.evaluator import marched
from wavesym.programs.march.run import LEFT, RIGHT
from wavesym.running.compiled import imported
from wavesym.scene import Scene, lower

FIRST = Fraction(1, 3)
SHORT = Fraction(1, 10**9)
DELAYS = [Fraction(0), Fraction(2, 7), Fraction(1, 2), Fraction(1)]
DEGREE = 8
SCENE = Scene(
    name="made",
    system={"type": "building", "m": 1 + 1, "kappa": [1, 1, 1], "base": "force"},
    load=[{"times": [FIRST, FIRST + SHORT], "a": [1, 1], "b": [0, 0]}],
    output={
        "until": 3,
        "tolerance": "1e-3",
        "strain": [0, "2/7", "1/2", "1-"],
        "velocity": DELAYS,
        "displacement": DELAYS,
    },
)
CUTS = [Fraction(0), FIRST, FIRST + SHORT, Fraction(1)]


@cache
def made():
    return marched(lower(SCENE), degree=DEGREE)


def waves():
    """Of both windows, [0] the one before: steep on the short panel, at random."""
    plan = made().plan
    assert [Fraction(int(panel.start.p), int(panel.start.q)) for panel in plan.panels] == CUTS[:-1]
    shape = 2, 2, len(plan.panels), len(plan.junctions) + 2, DEGREE + 1
    return np.random.default_rng(1).uniform(-1, 1, shape)


CHEBYSHEV = [fmpq_poly([1]), fmpq_poly([0, 1])]
for _ in range(DEGREE):
    CHEBYSHEV.append(2 * fmpq_poly([0, 1]) * CHEBYSHEV[-1] - CHEBYSHEV[-2])


def exact(number):
    return fmpq(*Fraction(number).as_integer_ratio())


def series(c):
    return sum((exact(value) * CHEBYSHEV[k] for k, value in enumerate(c.tolist())), fmpq_poly())


def sent(both, direction, node, since):
    """The wave that a node sent at an instant of this window, or before it of the one before: the panel, and u."""
    half, since = (1, since) if since >= 0 else (0, since + 1)
    panel = max(p for p in range(3) if CUTS[p] <= since)
    u = 2 * (since - CUTS[panel]) / (CUTS[panel + 1] - CUTS[panel]) - 1
    return both[half, direction, panel, node + 1], u


def wave(both, direction, node, delay, t):
    c, u = sent(both, direction, node, t - delay)
    return series(c)(exact(u))


def integral(both, direction, node, delay, t):
    """From the start of the window to t."""
    fronts = {cut + delay - back for cut in CUTS for back in (0, 1)}
    edges = sorted({Fraction(0), t} | {front for front in fronts if 0 < front < t})
    total = fmpq(0)
    for low, high in pairwise(edges):
        c, begin = sent(both, direction, node, low - delay)
        (_, end), whole = sent(both, direction, node, (low + high) / 2 - delay), series(c).integral()
        end = begin + 2 * (end - begin)
        total += exact((high - low) / (end - begin)) * (whole(exact(end)) - whole(exact(begin)))
    return total


def expected(both, t):
    """All outputs t after the start of the window, and how wrong a program may have each of them."""
    values, allowed, weights = [], [], [reading_weights(DEGREE, displaced=part) for part in (False, True)]
    for quantity in ("strain", "velocity", "displacement"):
        for delay in DELAYS:
            places = (LEFT, 1, 1 - delay), (RIGHT, 0, delay)  # all are in the first rod
            if quantity == "displacement":
                left, right = (integral(both, *place, t) for place in places)
                sizes = 2.0**-53 * 24 * 8 * np.max(np.abs(both) @ weights[1])
            else:
                left, right = (wave(both, *place, t) for place in places)
                sizes = 2.0**-53 * 12 * 2 * np.max(np.abs(both) @ weights[0])
            values.append(float(left - right if quantity == "strain" else left + right))
            allowed.append(sizes)
    return np.array(values), np.array(allowed)


def instants():
    """Where a wave passes from panel to panel, and beside it; and on the short panel."""
    fronts = {cut + delay - back for cut in CUTS for delay in DELAYS for back in (0, 1)}
    near = {float(front + SHORT * part) for front in fronts for part in (0, Fraction(1, 3), Fraction(5, 7))}
    near |= {np.nextafter(t, -1) for t in near} | {0.0, 0.25, 0.999}
    return sorted(t for t in near if 0 <= t < 1)


@cache
def right():
    return [(t, *expected(waves(), Fraction(t))) for t in instants()]


def missed(read):
    """By how much of what is allowed the outputs are wrong, at worst."""
    both = waves()
    return max(np.max(np.abs(read(both, t) - values) / allowed) for t, values, allowed in right())


def in_numpy(text):
    scheme = imported(text, "made")._PROGRAM

    def read(both, t):
        n, at = np.zeros(1, int), np.array([t])
        for output in range(scheme.outputs):
            sums, values = (scheme._heard(output, summed=summed) for summed in (True, False))
            yield (scheme._gathered(both, sums, n, at) + scheme._arrived(both, values, n, at))[0]

    return lambda both, t: np.array(list(read(both, t)))


def in_c(change):
    run = March(*library(SCENE, degree=DEGREE, change=change))
    run.window.value = 0

    def read(both, t):
        state = np.frombuffer(run.state, np.float64)[-both.size :].reshape(both.shape)
        half = np.frombuffer(run.state, np.int32)[1]
        state[half], state[1 - half] = both[1], both[0]
        return run.read(t)

    return read


def generated():
    return numpy_text(lower(SCENE), made())


def test_waves_are_read_from_exact_instants_in_numpy():
    assert missed(in_numpy(generated())) <= 1


def test_without_the_excess_they_would_not_be_in_numpy():
    exact_w = "((t - self.start[s]) + self.excess[s])"
    assert exact_w in generated()
    assert missed(in_numpy(generated().replace(exact_w, "(t - self.start[s])"))) > 1e5


def test_waves_are_read_from_exact_instants_in_c():
    assert missed(in_c(None)) <= 1


def test_without_the_excess_they_would_not_be_in_c():
    assert missed(in_c(("const real w = (t - start[s]) + excess[s]", "const real w = t - start[s]"))) > 1e5
