"""The bound of a model, term by term: errors, in fractions, that are larger than it would be without the term."""

import ctypes
from fractions import Fraction

import numpy as np
import pytest

import wavesym
from tests.support.builds import LANGUAGES
from tests.support.built_model import BuiltModel, written
from tests.support.faults import BODIES
from wavesym.running.native import library

STAR = wavesym.Scene(
    name="star",
    system={
        "type": "chain",
        "parts": [{"mass": 1, "velocity": 1}, {"rod": "3/7"}, {"joint": True, "name": "j"}, {"rod": "3/7"}, "free"],
        "branch": [{"from": "j", "name": "side", "parts": [{"rod": "3/7"}, "free"]}],
    },
    output={"until": 3, "tolerance": "1e-9", "velocity": ["j"]},
)
"""A mass, its joint 0, on a rod that ends where two others begin: joint 1, with ports 1, 2, 3."""
STEP = Fraction(3, 7)
ROUNDING = Fraction(1, 2**53)
PARTS = """
const int degree_of = STAR_DEGREE, lanes_of = LANES;
static star_work work;
static star_model model;
static laws law;
static errors w;
static progress now;
int start_star(const star_parameters *p);
int start_star(const star_parameters *p)
{
    const int status = start_model(&now, &work, &model, p, &law);
    start_errors(&work.set, &law, &w);
    tabulate_degree(&now, STAR_DEGREE);
    return status;
}
void send_from(int joint, const double *arriving, double *sent, double *wrong);
void send_from(int joint, const double *arriving, double *sent, double *wrong)
{
    double apart[STAR_PORTS] = {0};
    places at;
    locate(0, &at);
    for (int port = first_port[joint], k = 0; port < first_port[joint + 1]; ++port, ++k) {
        work.set.waves[at.arrived[arrive[port]]][0][0] = arriving[k];
    }
    march_window(&now);
    add_of_point(&now, &at, &w, joint, 0, first_port[joint + 1] - first_port[joint], apart);
    for (int port = first_port[joint], k = 0; port < first_port[joint + 1]; ++port, ++k) {
        sent[k] = work.set.waves[at.sent[send[port]]][0][0];
        wrong[k] = apart[port];
    }
}
double move_mass(const double *velocity, const double *arriving);
double move_mass(const double *velocity, const double *arriving)
{
    double apart[STAR_PORTS] = {0};
    const double before = w.energy;
    places at;
    locate(0, &at);
    for (int k = 0; k <= STAR_DEGREE; ++k) {
        work.set.path[0][0][k] = velocity[k];
        work.set.waves[at.arrived[arrive[0]]][0][k] = arriving[k];
        work.set.waves[at.sent[send[0]]][0][k] = velocity[k] - arriving[k];
    }
    w.missed = nothing;
    add_of_hub(&now, &at, &w, 0, 0, 1, apart);
    return (w.energy - before) + total_of(&w.missed);
}
double read_term(int k, int window, double tau, double *lost);
double read_term(int k, int window, double tau, double *lost)
{
    double value;
    for (int j = 0; j < STAR_DEGREE + 2; ++j) {
        model.series[j] = j == k;
    }
    model.degree[window] = STAR_DEGREE;
    model.place[window] = 0;
    model.built = 1;
    w.degree = -1;
    start_reading(&w, STAR_DEGREE);
    *lost = w.reading[k];
    return star_model_eval(&model, tau, &value) ? not_a_number() : value;
}
"""


class Star:
    """C of the scene, or spoiled, for a mass and impedances."""

    def __init__(self, folder, change, mass, *impedances):
        written(STAR, ["mass", "impedance"], folder, [change] if change else [], parts=["bound"])
        header, source = ((folder / f"star.{suffix}").read_text() for suffix in ("h", "c"))
        self.library = library(source + PARTS, (*LANGUAGES["c99"][1:], "-O0"), ("star.h", header))
        self.degree, self.lanes = (ctypes.c_int.in_dll(self.library, name).value for name in ("degree_of", "lanes_of"))
        self.library.move_mass.restype = self.library.read_term.restype = ctypes.c_double
        assert self._call("start_star", np.array([mass, *impedances])) == 0

    def _call(self, name, *given):
        arguments = (ctypes.c_void_p(each.ctypes.data) if isinstance(each, np.ndarray) else each for each in given)
        return getattr(self.library, name)(*arguments)

    def sent(self, arriving):
        """What joint 1 sends, and how much of it may be wrong at once."""
        sent, wrong = np.empty(3), np.empty(3)
        self._call("send_from", 1, np.array(arriving), sent, wrong)
        return list(map(Fraction, sent)), list(map(Fraction, wrong))

    def moved(self, velocity, arriving):
        """The energy of errors that a panel adds on which the mass has this velocity."""
        return Fraction(self._call("move_mass", np.array(velocity), np.array(arriving)))

    def read(self, k, window, tau):
        """T_k at tau, and how much of it reading may lose."""
        lost = ctypes.c_double()
        value = self._call("read_term", k, window, ctypes.c_double(tau), ctypes.byref(lost))
        return Fraction(value), Fraction(lost.value)


@pytest.mark.parametrize("change", [None, ("magnitude(ratio[port]) * exact * sums[side]", "0 * sums[side]")])
def test_what_an_end_sends_is_checked_as_exactly_as_is_said(change, tmp_path):
    """Two waves cancel but for rounding: the third end sends 0 in doubles, and should send what that lost."""
    impedances = (0.1, 0.7, 1.3)
    star = Star(tmp_path, change, 1.0, *impedances)
    one, two, three = map(Fraction, impedances)
    held, cancelled = True, 0
    for a in np.random.default_rng(3).uniform(1, 2, 40):
        arriving = [a, -0.2 * a / 1.4, 0.0]
        sent, allowed = star.sent(arriving)
        a, b, c = map(Fraction, arriving)
        moved = 2 * (one * a + two * b + three * c) / (one + two + three)
        wrong = [abs(out - (moved - came)) for out, came in zip(sent, (a, b, c), strict=True)]
        cancelled += sent[2] == 0 < wrong[2]
        held = held and all(error <= most for error, most in zip(wrong, allowed, strict=True))
    assert cancelled > 5
    assert held == (change is None)


def chebyshev(k, u):
    before, now = Fraction(1), u
    for _ in range(k - 1):
        before, now = now, 2 * u * now - before
    return now


@pytest.mark.parametrize("change", [None, (" + 6 * ((real)k + 1) * ((real)k + 2)", "")])
def test_reading_a_high_degree_loses_no_more_than_is_said(change, tmp_path):
    """Near the end of a panel, where T_k is steep, and both the place there and the recurrence are rounded."""
    star = Star(tmp_path, change, 1.0, 1.0, 1.0, 1.0)
    held = True
    for window in (0, 6):
        for part in np.linspace(0.9, 0.999, 12):
            tau = float((window + Fraction(part)) * STEP)
            u = 2 * (Fraction(tau) / STEP - window) - 1
            value, lost = star.read(star.degree, window, tau)
            held = held and abs(value - chebyshev(star.degree, u)) <= lost
    assert held == (change is None)


@pytest.mark.parametrize("change", [None, ("(real)(degree / LANES + 4)", "0")])
def test_what_sums_at_the_ends_of_a_panel_lose_is_in_the_energy(change, tmp_path):
    """All that is added to the first term is just below half a rounding of it, and lost: the mass jumps unseen."""
    mass = 1e12
    star = Star(tmp_path, change, mass, 1.0, 1.0, 1.0)
    rate, little = Fraction(1, int(mass)), 0.99 * float(ROUNDING)
    energy, apart, end = Fraction(0), Fraction(0), Fraction(1)
    for term in (little, -little / 2):
        velocity = [1.0, *(term * (k % star.lanes == 0) for k in range(1, star.degree + 1))]
        x = [*map(Fraction, velocity), Fraction(0), Fraction(0)]
        # x' is what makes the series of x that of its integral, and what arrives is what makes it so
        slope = [Fraction(0)] * (star.degree + 3)
        for k in range(star.degree, 0, -1):
            slope[k - 1] = 4 * k / STEP * x[k] + slope[k + 1]
        slope[0] /= 2
        arriving = [float((slope[k] + rate * x[k]) / (2 * rate)) for k in range(star.degree + 1)]
        energy += star.moved(velocity, arriving)
        slope = [2 * rate * Fraction(a) - rate * b for a, b in zip(arriving, x, strict=False)] + [Fraction(0)] * 2
        slope[0] *= 2
        missed = [abs(x[k] - STEP / (4 * k) * (slope[k - 1] - slope[k + 1])) for k in range(1, star.degree + 2)]
        jump = abs(sum((-1) ** k * c for k, c in enumerate(x)) - end)
        end = sum(x)
        apart += 2 * sum(missed) + jump
    assert apart > star.degree * ROUNDING
    assert (energy**2 >= Fraction(mass) / 2 * apart**2) == (change is None)


HEAVY = wavesym.Scene(
    name="heavy",
    system={"type": "chain", "parts": [{"mass": 1000, "name": "m"}, {"rod": 1}, "absorbing"]},
    load=[{"at": "m", "times": [0], "steps": [1]}],
    output={"until": 2, "tolerance": "1e-9", "velocity": ["m"]},
)
DRIVEN = BODIES[6]


@pytest.mark.parametrize("change", [None, ("root_above(1 + 2 * fast) + 1 + fast", "1 + fast")])
def test_what_a_series_misses_counts_at_both_ends_of_a_panel(change, tmp_path):
    """A heavy mass is pushed too hard, by 1e-7: what its series misses it has twice at the end, as it starts right."""
    made = BuiltModel(HEAVY, ["mass"], tmp_path, [DRIVEN, *([change] if change else [])])
    status, bound = made.bound(1000)
    wrong = made.errors(HEAVY)
    assert status == 0
    assert wrong > 0.9e-7
    assert (wrong <= bound) == (change is None)
