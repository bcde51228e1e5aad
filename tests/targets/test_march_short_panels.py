"""Waves put by hand into a march, on a panel of a billionth: read from exact instants, not from rounded ones."""

import ctypes
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from flint import fmpq, fmpq_poly

from tests.support.generated import numpy_text, program_files
from wavesym.programs.march.bound import reading_weights
from wavesym.programs.march.evaluator import march
from wavesym.running.compilation import import_text
from wavesym.running.toolchain import compiler
from wavesym.scene import Scene, lower

RIGHT, LEFT = 0, 1  # tracks of the first rod

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
    return march(lower(SCENE), degree=DEGREE)


def waves():
    """Of both windows, [0] the one before: steep on the short panel, at random."""
    plan = made().plan
    assert [Fraction(int(panel.start.p), int(panel.start.q)) for panel in plan.panels] == CUTS[:-1]
    assert [track.steps for track in plan.tracks[:2]] == [1, 1]
    shape = 2, len(plan.tracks), len(plan.panels), DEGREE + 1
    return np.random.default_rng(1).uniform(-1, 1, shape)


CHEBYSHEV = [fmpq_poly([1]), fmpq_poly([0, 1])]
for _ in range(DEGREE):
    CHEBYSHEV.append(2 * fmpq_poly([0, 1]) * CHEBYSHEV[-1] - CHEBYSHEV[-2])


def exact(number):
    return fmpq(*Fraction(number).as_integer_ratio())


def series(c):
    return sum((exact(value) * CHEBYSHEV[k] for k, value in enumerate(c.tolist())), fmpq_poly())


def sent(both, track, since):
    """What was sent at an instant of this window, or before it of the one before: the panel, and u."""
    half, since = (1, since) if since >= 0 else (0, since + 1)
    panel = max(p for p in range(3) if CUTS[p] <= since)
    u = 2 * (since - CUTS[panel]) / (CUTS[panel + 1] - CUTS[panel]) - 1
    return both[half, track, panel], u


def wave(both, track, delay, t):
    c, u = sent(both, track, t - delay)
    return series(c)(exact(u))


def integral(both, track, delay, t):
    """From the start of the window to t."""
    fronts = {cut + delay - back for cut in CUTS for back in (0, 1)}
    edges = sorted({Fraction(0), t} | {front for front in fronts if 0 < front < t})
    total = fmpq(0)
    for low, high in pairwise(edges):
        c, begin = sent(both, track, low - delay)
        (_, end), whole = sent(both, track, (low + high) / 2 - delay), series(c).integral()
        end = begin + 2 * (end - begin)
        total += exact((high - low) / (end - begin)) * (whole(exact(end)) - whole(exact(begin)))
    return total


def expected(both, t):
    """All outputs t after the start of the window, and how wrong a program may have each of them."""
    values, allowed, weights = [], [], [reading_weights(DEGREE, displaced=part) for part in (False, True)]
    for quantity in ("strain", "velocity", "displacement"):
        for delay in DELAYS:
            places = (LEFT, 1 - delay), (RIGHT, delay)  # all are in the first rod
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
    module = import_text(text, "made")
    scheme = module._PROGRAM
    assert scheme.deepest == 1

    def read(both, t):
        waves = np.concatenate([both, np.zeros((2, 1, *both.shape[2:]))], axis=1)
        nothing = np.zeros((1, scheme.panels, 1))
        window = module.WindowBlock(scheme, 0, waves, nothing, nothing, np.zeros(scheme.outputs))
        return window.read_places(np.zeros(1, int), np.zeros(1, int), np.array([t]))[:, 0]

    return read


DRIVER = """
#include "made.c"

void put(const real *both, real t, real *out);

void put(const real *both, real t, real *out)
{
    march state;
    start_march(&state);
    state.window = 1;
    for (int place = 0; place < 2 * TRACKS * PANELS * SIZE; ++place) {
        const int number = place / (PANELS * SIZE) % TRACKS;
        const int slot = ring[number] + place / (TRACKS * PANELS * SIZE) % (steps[number] + 1);
        state.waves[slot][place / SIZE % PANELS][place % SIZE] = both[place];
    }
    for (int k = 0; k < OUTPUTS; ++k) {
        state.total[k] = 0;
    }
    read_at(&state, t, out);
}
"""


def in_c(change):
    sources = {**program_files(lower(SCENE), made(), "c"), "driver.c": DRIVER}
    if change:
        assert change[0] in sources["made.c"]
        sources["made.c"] = sources["made.c"].replace(*change)
    with TemporaryDirectory() as folder:
        for file, text in sources.items():
            Path(folder, file).write_text(text)
        compiler().run(["-std=c99", "-O1", "-fPIC", "-shared", "driver.c", "-o", "made.so", "-lm"], Path(folder))
        library = ctypes.CDLL(str(Path(folder, "made.so")))
    library.put.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p]

    def read(both, t):
        out = np.empty(len(SCENE.outputs))
        library.put(np.ascontiguousarray(both).ctypes.data, t, out.ctypes.data)
        return out

    return read


def generated():
    return numpy_text(lower(SCENE), made())


def test_waves_are_read_from_exact_instants_in_numpy():
    assert missed(in_numpy(generated())) <= 1


def test_without_the_excess_they_would_not_be_in_numpy():
    exact_w = "((t - scheme.start[s, phase]) + scheme.excess[s, phase])"
    assert exact_w in generated()
    assert missed(in_numpy(generated().replace(exact_w, "(t - scheme.start[s, phase])"))) > 1e5


def test_waves_are_read_from_exact_instants_in_c():
    assert missed(in_c(None)) <= 1


def test_without_the_excess_they_would_not_be_in_c():
    assert (
        missed(in_c(("(t - start[s * CYCLE + phase]) + excess[s * CYCLE + phase]", "t - start[s * CYCLE + phase]")))
        > 1e5
    )
