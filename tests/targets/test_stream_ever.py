"""Streams for ever: 10^9 windows, leapt over, and steps counted; and the alarm, on both sides of what may be lost."""

import ctypes
from fractions import Fraction

import numpy as np
import pytest

import wavesym
from tests.support.streamed import built
from wavesym import api
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
void rig_leap(stream *state, const stream *from, long long windows);
void rig_tick(stream *state, double dtau, long long steps);
int rig_instants(const stream *state);

size_t rig_size(void)
{
    return sizeof(stream);
}

int rig_instants(const stream *state)
{
    return state->breakpoints;
}

/* The same waves, so many windows later: rings have gone around. */
void rig_leap(stream *state, const stream *from, long long windows)
{
    *state = *from;
    for (int track = 0; track < TRACKS; ++track) {
        const int shift = (int)(windows % slots[track] * RIG_PANELS % slots[track]);
        const int later = (int)(windows % entries[track]);
        state->at[track] = (from->at[track] + shift) % slots[track];
        state->turn[track] = (from->turn[track] + later) % entries[track];
        for (int slot = 0; slot < slots[track]; ++slot) {
            for (int power = 0; power < SIZE; ++power) {
                state->waves[first_slot[track] + (slot + shift) % slots[track]][power] =
                    from->waves[first_slot[track] + slot][power];
            }
        }
        for (int breakpoint = 0; breakpoint < from->breakpoints; ++breakpoint) {
            const int first = RIG_SLOTS + breakpoint * ENTRIES + first_entry[track];
            for (int slot = 0; slot < entries[track]; ++slot) {
                for (int power = 0; power < SIZE; ++power) {
                    state->waves[first + (slot + later) % entries[track]][power] = from->waves[first + slot][power];
                }
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
        while ((then.high - panel) + (then.low - panel_low) >= 0) {
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
        made = sources(api.program(SCENE, Request(stream=True)), "c")
        assert change[0] in made["rig.c"]
        self.c = library(made["rig.c"].replace(*change) + FIELDS, ("-O1",), ("rig.h", made["rig.h"]))
        self.c.rig_size.restype = ctypes.c_size_t
        self.c.rig_step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p]
        self.c.rig_leap.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_longlong]
        self.c.rig_tick.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_longlong]
        self.c.rig_instants.argtypes = [ctypes.c_void_p]

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

    def leapt(self, state, windows):
        made = self.state()
        self.c.rig_leap(address(made), address(state), windows)
        return made


def driven(model, state, steps, begin=0):
    """All outputs under a load that changes at every step, in the middle of waves."""
    found = []
    for k in range(begin, begin + steps):
        status, out = model.step(state, 0.1 if k % 3 else 0.0, float(k * k % 7) - 3)
        found.append([status, *out])
    return np.array(found)


def differs(model, windows):
    """Whether a stream that has leapt over so many windows goes on in another way."""
    state = model.started()
    driven(model, state, 70)
    later = model.leapt(state, windows)
    return not np.array_equal(driven(model, state, 200, 70), driven(model, later, 200, 70))


@pytest.mark.quick(1)
@pytest.mark.parametrize("windows", [1, BILLION - 1, 10**18 + 3])
def test_a_billion_windows_later_every_bit_is_the_same(windows):
    assert not differs(Open(), windows)


@pytest.mark.slow
def test_instants_that_rounding_moves_are_one():
    """0.1 as a double is not a tenth: after 50 000 steps instants have moved by 3e-13, and are others twice."""
    model = Open()
    state = model.started()
    for k in range(50_000):
        model.step(state, 0.1, float(k % 7))
    assert 8 <= model.c.rig_instants(address(state)) <= 24


@pytest.mark.slow
@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("state->at[k] + 1 < slots[k]", "state->at[k] + 1 < slots[k] - (k == 0)"),
        ("const int slot = state->at[number] - panels;", "const int slot = (state->at[number] - panels + 1) % 2;"),
        (
            "const int slot = state->turn[number] - windows;",
            "const int slot = state->turn[number] - (state->turn[number] > 0 ? windows : 0);",
        ),
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


def jumped(model, size):
    """A moment of 1 that jumps by so much: the status, what is said to be lost in the end, and the true error."""
    stream = model.start()
    codes = [stream.step(0.0, [1.0])[0], stream.step(float(LATE), [1.0])[0], stream.step(0.0, [1.0 + size])[0]]
    taus = [float(LATE) + k / 64 for k in range(1, 150)]
    found = []
    for _ in taus:
        code, out = stream.step(1 / 64, [1.0 + size])
        codes.append(code)
        found.append(out)
    load = {"body": 1, "times": [0, str(LATE)], "steps": [1, Fraction(size)]}
    true = wavesym.evaluator(LOOSE.with_({"load": [load]}))(taus)
    error = np.max(np.abs(np.array(found).T - true) / np.max(np.abs(true), axis=1, keepdims=True))
    return max(codes), stream.lost, error


def test_the_alarm_is_on_the_right_side_of_the_tolerance():
    """Where there is room for no instant: of jumps from small to large the first ones lose less, and are silent; the
    others may lose it, and are told."""
    model = built(LOOSE, room=0)
    told = [jumped(model, 2.0**power) for power in range(-11, 4, 2)]
    alarms = [status == 2 for status, _, _ in told]
    assert alarms == sorted(alarms)
    assert {status for status, _, _ in told} == {0, 2}
    for status, lost, error in told:
        assert error < lost < 1000 * error
        assert status == 2 or error < 1e-3
