"""Streams for ever: 10^9 steps, leapt over and counted; and the alarm, on both sides of what may be lost."""

import ctypes
from fractions import Fraction

import numpy as np
import pytest

import wavesym
from tests.support.streamed import built
from wavesym.compiler import stream_program
from wavesym.programs.request import Request
from wavesym.running.native import address, library
from wavesym.targets.files import sources

BILLION = 10**9
HELD = {"body": 1, "times": [0], "steps": [1]}
SCENE = wavesym.Scene(
    name="rig",
    system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    load=[HELD],
    output={"until": 12, "tolerance": "1e-9", "strain": ["1/2"], "velocity": [2], "displacement": [0]},
)
FIELDS = """
size_t rig_size(void);
void rig_leap(stream *state, const stream *from, long long panels);
void rig_tick(stream *state, double dtau, long long steps);

size_t rig_size(void)
{
    return sizeof(stream);
}

/* The same waves, so many panels later: rings have gone around, and with them the panels of a window. */
void rig_leap(stream *state, const stream *from, long long panels)
{
    *state = *from;
    state->phase = (int)((from->phase + panels) % RIG_PANELS);
    for (int k = 0; k < RIG_PANELS; ++k) {
        state->missed[(k + panels) % RIG_PANELS] = from->missed[k];
    }
    for (int track = 0; track < TRACKS; ++track) {
        const int turn = (int)(panels % slots[track]);
        state->at[track] = (from->at[track] + turn) % slots[track];
        for (int slot = 0; slot < slots[track]; ++slot) {
            for (int power = 0; power < SIZE; ++power) {
                state->waves[first_slot[track] + (slot + turn) % slots[track]][power] =
                    from->waves[first_slot[track] + slot][power];
            }
        }
    }
}

/* The clock of step alone. */
void rig_tick(stream *state, double dtau, long long steps)
{
    pair then = {state->time, state->time_low};
    for (; steps > 0; --steps) {
        then = plus(then, dtau, 0);
        while (then.high > panel || (!(then.high < panel) && then.low >= panel_low)) {
            then = plus(then, -panel, -panel_low);
        }
    }
    state->time = then.high;
    state->time_low = then.low;
}
"""


class Open:
    """A stream whose fields are looked into."""

    def __init__(self, change=("", "")):
        made = sources(stream_program(SCENE, Request(stream=True)), "c")
        assert change[0] in made["rig.c"]
        self.c = library(made["rig.c"].replace(*change) + FIELDS, ("-O1",), ("rig.h", made["rig.h"]))
        self.c.rig_size.restype = ctypes.c_size_t
        self.c.rig_step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p]
        self.c.rig_leap.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_longlong]
        self.c.rig_tick.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_longlong]

    def state(self):
        return np.zeros(self.c.rig_size(), np.uint8)

    def started(self):
        made = self.state()
        self.c.rig_init(ctypes.c_void_p(address(made)))
        return made

    def step(self, state, dtau, load):
        out = np.empty(3)
        status = self.c.rig_step(address(state), dtau, address(np.array([load])), address(out))
        return status, out

    def leapt(self, state, panels):
        made = self.state()
        self.c.rig_leap(address(made), address(state), panels)
        return made


def driven(model, state, steps, begin=0):
    """All outputs under a load that changes at every step, in the middle of waves."""
    found = []
    for k in range(begin, begin + steps):
        status, out = model.step(state, 0.1 if k % 3 else 0.0, float(k * k % 7) - 3)
        found.append([status, *out])
    return np.array(found)


def differs(model, panels):
    """Whether a stream that has leapt over so many panels goes on in another way."""
    state = model.started()
    driven(model, state, 70)
    later = model.leapt(state, panels)
    return not np.array_equal(driven(model, state, 200, 70), driven(model, later, 200, 70))


@pytest.mark.parametrize("panels", [1, BILLION - 1, 10**18 + 3])
def test_a_billion_panels_later_every_bit_is_the_same(panels):
    assert not differs(Open(), panels)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("state->at[k] + 1 < slots[k]", "state->at[k] + 1 < slots[k] - (k == 0)"),
        ("const int slot = state->at[number] - panels;", "const int slot = (state->at[number] - panels + 1) % 2;"),
    ],
)
def test_a_leap_would_see_a_ring_that_goes_wrong(right, wrong):
    assert differs(Open((right, wrong)), BILLION + 1)


@pytest.mark.slow
@pytest.mark.parametrize("dtau", [0.1, 1 / 3])
def test_the_clock_is_right_after_ten_million_steps(dtau):
    """What dtau is as a double adds up, and nothing else."""
    model, count = Open(), BILLION // 100
    state = model.started()
    model.c.rig_tick(address(state), dtau, count)
    high, low = np.frombuffer(state[:16].tobytes())
    missed = (Fraction(float(high)) + Fraction(float(low)) - count * Fraction(dtau)) % Fraction(1, 8)
    assert min(missed, Fraction(1, 8) - missed) < Fraction(1, 10**24)


LOOSE = SCENE.with_({"output.tolerance": "1e-3", "output.until": 6, "output.displacement": []})
LATE = Fraction(33, 16)  # in the middle of a panel


def jumped(size):
    """A moment of 1 that jumps by so much: the status, the most that is said to be lost, and the true error."""
    stream = built(LOOSE).start()
    codes = [stream.step(0.0, [1.0])[0], stream.step(float(LATE), [1.0])[0], stream.step(0.0, [1.0 + size])[0]]
    taus = [float(LATE) + k / 64 for k in range(1, 150)]
    found, lost = [], stream.lost
    for _ in taus:
        code, out = stream.step(1 / 64, [1.0 + size])
        codes.append(code)
        found.append(out)
        lost = max(lost, stream.lost)  # less once larger waves follow
    load = {"body": 1, "times": [0, str(LATE)], "steps": [1, Fraction(size)]}
    true = wavesym.evaluator(LOOSE.with_({"load": [load]}))(taus)
    error = np.max(np.abs(np.array(found).T - true) / np.max(np.abs(true), axis=1, keepdims=True))
    return max(codes), lost, error


def test_the_alarm_is_on_the_right_side_of_the_tolerance():
    """Of jumps from small to large the first ones lose less, and are silent; the others lose it, and are told."""
    told = [jumped(2.0**power) for power in range(-5, 4, 2)]
    alarms = [status == 2 for status, _, _ in told]
    assert alarms == sorted(alarms)
    assert {status for status, _, _ in told} == {0, 2}
    for status, lost, error in told:
        assert (status == 2) == (lost > 1e-3)
        assert lost / 40 < error < 10 * lost
    silent = max(error for status, _, error in told if status == 0)
    alarming = min(error for status, _, error in told if status == 2)
    assert silent < 10 * 1e-3
    assert alarming > 1e-3 / 40
