"""The march in C, driven by hand: what it refuses changes nothing, and what is too rough is reported at once."""

import ctypes
from functools import cache
from math import inf, nan
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from tests.support.generated import program_files
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.march.evaluator import marched
from wavesym.running.toolchain import compiler
from wavesym.scene import Scene, lower

SIZE = """
#include "made.h"
size_t made_size(void);
size_t made_size(void)
{
    return sizeof(made_state);
}
"""
OUTPUTS = {"strain": ["1/3", "1+"], "velocity": ["8/5"], "displacement": [0, "1/2", 1]}


def scene(system, load=(), until=9, **outputs):
    output = {"until": until, "tolerance": "1e-3", **(outputs or OUTPUTS)}
    return Scene(name="made", system=system, load=list(load), output=output)


def building(base, until=9, **outputs):
    system = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": base}
    load = {"times": [0, "1/3", "5/2"], "a": [1, 0, "-1/2"], "b": ["-1/4", "1/2", 0]}
    return scene(system, [load], until, **outputs)


DRIVE = scene(
    {"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    [{"body": 1, "times": [0, "1/3"], "steps": [1, -2]}, {"body": 3, "times": ["5/2"], "steps": [1]}],
)
SCENES = {"force": building("force"), "ground": building("ground"), "drive": DRIVE}
EACH = pytest.mark.parametrize("name", SCENES)


class March:
    """A march of a library that was compiled; its state as bytes."""

    def __init__(self, library, made):
        self._library, self.made = library, made
        self._real = np.float32 if made.real is SINGLE else np.float64
        library.made_size.restype, library.made_energy.restype = ctypes.c_size_t, ctypes.c_double
        self._read = library.made_read
        self._read.argtypes = [
            ctypes.c_void_p,
            ctypes.c_float if made.real is SINGLE else ctypes.c_double,
            ctypes.c_void_p,
        ]
        self.state = ctypes.create_string_buffer(library.made_size())
        self.start()

    def start(self):
        self._library.made_init(self.state)

    def readable(self, t):
        out = np.empty(len(self.made.plan.outputs), self._real)
        status = self._read(self.state, self.window.value + t, out.ctypes.data_as(ctypes.c_void_p))
        assert status == int(np.isnan(out).all())
        return status == 0

    @property
    def ended(self):
        """Whether nothing can be read any more."""
        return not self.readable(0.5)

    def energy(self):
        return self._library.made_energy(self.state)

    @property
    def shape(self):
        return len(self.made.plan.channels), len(self.made.plan.panels), self.made.degree + 1

    @property
    def reach(self):
        return 2.0 ** (127 - 40 if self.made.real is SINGLE else 1023 - 40)

    @property
    def window(self):
        return ctypes.c_int.from_buffer(self.state)

    def advance(self, loads=None):
        if loads is None:
            return self._library.made_advance(self.state, None)
        values = np.ascontiguousarray(np.broadcast_to(loads, self.shape), self._real)
        return self._library.made_advance(self.state, values.ctypes.data_as(ctypes.c_void_p))

    def read(self, t):
        out = np.empty(len(self.made.plan.outputs), self._real)
        assert self._read(self.state, self.window.value + t, out.ctypes.data_as(ctypes.c_void_p)) == 0
        return out

    def values(self):
        return np.array([self.read(t) for t in np.arange(16) / 16])


@cache
def library(name, real=DOUBLE, degree=None, change=None):
    """Compiled once; the folder may go when it is loaded. With a change, one text stands for another in the C."""
    made_from = SCENES[name] if isinstance(name, str) else name
    made = marched(lower(made_from), real, degree)
    sources = {**program_files(lower(made_from), made, "c"), "size.c": SIZE}
    if change:
        assert change[0] in sources["made.c"]
        sources["made.c"] = sources["made.c"].replace(*change)
    with TemporaryDirectory() as folder:
        for file, text in sources.items():
            Path(folder, file).write_text(text)
        compiler().run(
            ["-std=c99", "-O1", "-fPIC", "-shared", "made.c", "size.c", "-o", "made.so", "-lm"], Path(folder)
        )
        return ctypes.CDLL(str(Path(folder, "made.so"))), made


def march(name, real=DOUBLE, degree=None):
    return March(*library(name, real, degree))


def same(one, other, windows=3):
    """Two marches go on alike, bit by bit."""
    for loads in np.random.default_rng(2).uniform(-1, 1, (windows, *one.shape[:2], 1)):
        assert one.advance(loads) == other.advance(loads) == 0
        np.testing.assert_array_equal(one.values(), other.values())


@EACH
@pytest.mark.parametrize("real", [DOUBLE, SINGLE], ids=["double", "single"])
def test_loads_that_are_no_numbers_are_refused_and_change_nothing(name, real):
    """On any source, at any point."""
    one, other = march(name, real), march(name, real)
    for window in range(2):
        state = one.state.raw
        for place in np.ndindex(one.shape):
            for bad in (nan, inf, -inf, 1.01 * one.reach, -1.01 * one.reach):
                loads = np.ones(one.shape)
                loads[place] = bad
                assert one.advance(loads) == 2
                assert one.state.raw == state
        assert one.window.value == window - 1
        same(one, other, 1)
    same(one, other)


@pytest.mark.parametrize("factor", [1.0, -1.0])
def test_what_overflows_is_refused_and_changes_nothing(factor):
    """Loads within reach that move more than that: kappa_0 is 1/4."""
    one, other = march("force"), march("force")
    same(one, other)
    before = one.values()
    assert one.advance(factor * 0.9 * one.reach) == 2
    assert one.window.value == 2
    assert np.isfinite(one.values()).all()
    np.testing.assert_array_equal(one.values(), before)
    same(one, other)


def test_what_overflows_is_refused_before_anything_has_moved():
    one, other = march("force"), march("force")
    assert one.advance(0.9 * one.reach) == 2
    same(one, other)


@pytest.mark.parametrize("name", ["ground", "drive"])
def test_what_grows_beyond_reach_ends_the_march(name):
    """Until it is begun anew."""
    one, other = march(name), march(name)
    status = [one.advance(0.3 * one.reach) for _ in range(12)]
    spoilt = status.index(2)
    assert status == [0] * spoilt + [2] * (12 - spoilt)
    assert 1 < one.window.value == spoilt
    assert one.ended
    one.start()
    same(one, other)


def test_a_displacement_may_be_what_grows_beyond_reach():
    """Turned by one load, discs drift apart from where they were at less than they may."""
    one, pushed = march("drive"), np.array([0.2, 0, 0])[:, np.newaxis, np.newaxis]
    status, largest = [one.advance(pushed * one.reach)], 0.0
    while 2 not in status and len(status) < 200:
        largest = max(largest, np.max(np.abs(one.read(0.5)[:3])))
        status.append(one.advance(0.0))
    assert status[-1] == 2
    assert len(status) > 5
    assert largest < 0.5 * one.reach
    assert one.ended


def rough(one, source, panel, size, order):
    """A load of 1 with a T_k on a panel, order k from the highest down; 1 everywhere else."""
    points = one.shape[2]
    loads = np.zeros(one.shape)
    loads[source] = 1.0
    loads[source, panel] += (
        size * (-1.0) ** np.arange(points)
        if order == 0
        else size * np.cos(np.pi * (points - 1 - order) * (1 - np.arange(points) / (points - 1)))
    )
    return loads


@EACH
def test_a_load_too_rough_for_its_points_is_reported_at_once(name):
    sources, panels, _ = march(name).shape
    for source, panel, order in [(s, p, k) for s in range(sources) for p in range(panels) for k in (0, 1)]:
        one = march(name)
        assert one.advance(0.5) == 0
        assert one.advance(rough(one, source, panel, 0.5, order)) == 1
        assert one.advance(0.5) == 1  # and from then on
        assert one.window.value == 2
        assert one.advance(1e9) == 1  # even where it is little beside what moves now
        one.start()
        assert one.advance(0.5) == 0
        fine = march(name)
        assert fine.advance(0.5) == fine.advance(rough(fine, source, panel, 1e-9, order)) == 0
        assert fine.advance(rough(fine, source, panel, 0.5, 4)) == 0


def test_how_rough_a_load_may_be():
    """The tolerance of it, however large it is: where it acts on a node without mass it is what moves."""
    for size, status in ((0.95e-3, 0), (1.1e-3, 1)):
        for order in (0, 1):
            for scale in (1.0, 2.0**-80, 2.0**80):
                one = march("force")
                assert one.advance(scale * rough(one, 0, 1, size, order)) == status


def test_energy_is_that_of_rods_and_bodies_and_is_kept():
    """Two bodies of masses 10 and 1/2, and the rods on both sides of each."""
    system = {"type": "collision", "m": 4, "kappa": ["1/10", 2], "velocity": [1, "-1/2"]}
    one = march(scene(system))
    for _ in range(9):
        assert one.advance() == 0
        assert one.energy() == pytest.approx((12 * 1 + 2.5 / 4) / 2, rel=1e-12)


def test_a_chain_that_is_cut_ends_where_more_would_be_felt():
    system = {"type": "building", "m": 9, "kappa": [1] * 10, "base": "ground"}
    load = {"times": [0], "a": [1], "b": [0]}
    one = march(scene(system, [load], "21/8", velocity=[1]))
    assert (one.made.plan.valid, len(one.made.plan.junctions)) == (21 / 8, 4)
    assert [one.advance(1.0) for _ in range(4)] == [0, 0, 0, 2]
    assert np.isfinite(one.read(5 / 8)).all()
    assert one.ended is False
    assert not one.readable(5 / 8 + 2**-40)
    assert march("ground").made.plan.valid == inf


def test_smooth_loads_never_ring():
    """On thousands of windows, far beyond the horizon that it was made for."""
    shafts = {"type": "drive", "m": 3, "kappa": ["1/100"] * 3, "inertia": [1] * 4}
    load = {"body": 1, "times": [0], "steps": [1]}
    one = march(
        Scene(name="made", system=shafts, load=[load], output={"until": 130, "tolerance": "1e-4", "strain": ["1/2"]})
    )
    points = (1 - np.cos(np.pi * np.arange(one.shape[2]) / (one.shape[2] - 1))) / 2
    worst = max(one.advance(np.sin(0.7 * (window + points))) for window in range(10_000))
    assert worst == 0
    assert np.isfinite(one.values()).all()


@pytest.mark.parametrize(("real", "last"), [(DOUBLE, 2**31 - 2), (SINGLE, 2**24 - 1)], ids=["double", "single"])
def test_windows_end_before_their_number_overflows(real, last):
    one = march("force", real)
    assert one.window.value == -1
    assert one.advance(1.0) == 0
    one.window.value = last - 1
    assert one.advance(1.0) == 0
    assert one.window.value == last
    before = one.state.raw
    for loads in (1.0, None):
        assert one.advance(loads) == 2
        assert one.state.raw == before
    # tau = window + t is a number of its own there
    assert np.isfinite(one.read(0.0)).all()
