"""`sample` of pieces against `eval`: the same instants, the same pieces and, without contraction, the same bits."""

import ctypes
import platform

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import wavesym
from tests.support.generated import files
from wavesym.lab.timing import least
from wavesym.running.native import library
from wavesym.scene import lower

DOUBLES = ctypes.POINTER(ctypes.c_double)
UNTIL = 6.0
SCENE = wavesym.Scene(
    name="sampled",
    system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
    load=[{"times": [0], "a": [1], "b": [0]}],
    output={"until": 6, "tolerance": "1e-6", "strain": ["1/2", "3/2"], "velocity": ["1/2"]},
)
# each pair of start and step; fronts lie at quarters and halves, which some of these meet
GRIDS = (
    (0.0, 0.1),
    (0.0, 0.25),
    (UNTIL, -0.1),
    (5.75, -0.25),
    (1.0, 0.0),
    (0.4999999999999999, 1e-17),
    # steps as small as roundings, or a few of them
    (5.5 - 20 * 2.0**-54, 0.7 * 2.0**-54),
    (3.75 + 17 * 2.0**-51, -1.3 * 2.0**-51),
    (0.75 - 15 * 2.0**-50, 2.0**-50),
    (-0.35, 0.1),
    (6.2, -0.013),
    (float("nan"), 0.1),
    (0.0, float("nan")),
    (1e300, -1e300),
    (0.0, float("inf")),
)
BUILDS = [
    ("-Os", "-DSAMPLED_PLAIN", "-ffp-contract=off"),  # one by one
    ("-Os", "-ffp-contract=off"),  # in runs, of which nothing is known ahead
    pytest.param(("-O2", "-DSAMPLED_PLAIN", "-ffp-contract=off"), marks=pytest.mark.slow),  # in runs of plain numbers
    pytest.param(("-O2", "-ffp-contract=off"), marks=pytest.mark.slow),  # the narrowest vectors
    pytest.param(("-O3", "-march=native", "-ffp-contract=off"), marks=pytest.mark.slow),
    ("-O3", "-march=native", "-ffp-contract=fast"),
]


def built(made, *flags):
    """The library of generated C."""
    return library(made["sampled.c"], flags, ("sampled.h", made["sampled.h"]))


def evaluated(loaded, taus, outputs):
    call = loaded.sampled_eval
    call.argtypes = [ctypes.c_double, DOUBLES]
    columns = np.empty((len(taus), outputs))
    for tau, column in zip(taus, columns, strict=True):
        call(tau, column.ctypes.data_as(DOUBLES))
    return columns.T


def sampled(loaded, tau0, dtau, count, outputs):
    """Status and samples; what lies behind the last of them must stay as it was."""
    call = loaded.sampled_sample
    call.argtypes = [ctypes.c_double, ctypes.c_double, ctypes.c_size_t, DOUBLES]
    out = np.full(outputs * count + 64, 7.0)
    status = call(tau0, dtau, count, out.ctypes.data_as(DOUBLES))
    assert (out[outputs * count :] == 7.0).all()
    return status, out[: outputs * count].reshape(outputs, count)


def instants(tau0, dtau, count):
    """tau0 + k dtau, both operations rounded."""
    with np.errstate(all="ignore"):
        return np.arange(count) * np.float64(dtau) + np.float64(tau0)


@pytest.fixture(scope="module")
def made():
    return files(lower(SCENE), "c", "pieces")


@pytest.mark.quick(1)
@pytest.mark.parametrize("flags", BUILDS, ids=" ".join)
def test_short_runs_have_the_bits_of_single_values(made, flags):
    """Every count to 40, both ways, across fronts, beyond both ends, at NaN and infinity."""
    loaded = built(made, *flags)
    for tau0, dtau in GRIDS:
        taus = instants(tau0, dtau, 41)
        expected = evaluated(loaded, taus.tolist(), 3)
        inside = (taus >= 0) & (taus <= UNTIL)
        np.testing.assert_array_equal(np.isnan(expected), np.broadcast_to(~inside, expected.shape))
        for count in range(1, 41):
            status, found = sampled(loaded, tau0, dtau, count, 3)
            assert status == int(not inside[:count].all())
            np.testing.assert_array_equal(found, expected[:, :count], f"{tau0} {dtau} {count}")


@pytest.mark.parametrize("flags", BUILDS, ids=" ".join)
def test_long_runs_have_the_bits_of_single_values(made, flags):
    """1000 samples a unit of tau, onward and back: whole blocks of vectors, and what is left of them."""
    loaded = built(made, *flags)
    for tau0, dtau in ((0.0, 0.001), (UNTIL, -0.001), (0.0005, 0.0009765625)):
        expected = evaluated(loaded, instants(tau0, dtau, 5999).tolist(), 3)
        _, found = sampled(loaded, tau0, dtau, 5999, 3)
        np.testing.assert_array_equal(found, expected, f"{tau0} {dtau}")


@pytest.mark.slow
@pytest.mark.skipif(platform.machine() not in {"x86_64", "AMD64", "aarch64"}, reason="vectors are not known here")
def test_small_code_is_not_much_slower(made):
    """Eight times as slow where samples were computed one by one."""

    def timed(*flags):
        call, out = built(made, *flags).sampled_sample, np.empty(3 * 10_000)
        call.argtypes = [ctypes.c_double, ctypes.c_double, ctypes.c_size_t, DOUBLES]
        return lambda: call(0.0, UNTIL / 10_000, 10_000, out.ctypes.data_as(DOUBLES))

    usual, small = least([timed("-O2"), timed("-Os")])
    assert small < 2 * usual


@given(data=st.data())
@settings(max_examples=60)
def test_runs_end_where_single_values_change_pieces(made, data):
    """Samples at fronts or a few roundings from them, both ways, from before the first to behind the last."""
    loaded = built(made, *BUILDS[-1])
    tau0 = data.draw(st.one_of(st.just(0.0), st.just(UNTIL), st.floats(-UNTIL, 2 * UNTIL)))
    front = data.draw(st.integers(0, 24)) / 4
    steps = data.draw(st.integers(1, 300))
    dtau = (front - tau0) / steps
    for _ in range(data.draw(st.integers(0, 3))):
        dtau = float(np.nextafter(dtau, data.draw(st.sampled_from([-1.0, 1.0]))))
    count = data.draw(st.integers(1, 400))
    expected = evaluated(loaded, instants(tau0, dtau, count).tolist(), 3)
    _, found = sampled(loaded, tau0, dtau, count, 3)
    np.testing.assert_array_equal(found, expected)


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("return instants_of(t, k) - middle;", "return k * t->dtau + (t->tau0 - middle);"),
        ("tau >= edge : tau < edge", "tau >= edge : tau <= edge"),
        ("(16 / exact)", "(0 / exact)"),
        ("nearest) >= edge)", "nearest) > edge)"),
        ("exact * (real)0.75;", "exact * 0;"),
    ],
)
def test_other_roundings_and_later_fronts_are_seen(made, right, wrong):
    """Where tau_k is not rounded by itself, a run goes on behind its piece, or it ends as if nothing were rounded, the
    comparison above fails."""
    text = made["sampled.c"]
    assert right in text
    loaded = built({**made, "sampled.c": text.replace(right, wrong)}, "-O2", "-ffp-contract=off")
    differ = 0
    for tau0, dtau, count in ((0.1, 0.0011, 5000), (0.0, 0.0625, 90), (5.5 - 2.0**-50, 2.0**-54, 60)):
        expected = evaluated(loaded, instants(tau0, dtau, count).tolist(), 3)
        _, found = sampled(loaded, tau0, dtau, count, 3)
        differ += int((found != expected).sum())
    assert differ
