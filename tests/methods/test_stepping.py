"""Exponentials of matrices against SciPy's, and steps from event to event against these; also where cases meet."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from wavesym.methods import stepping
from wavesym.methods.stepping import Systems, exponential, step_systems

FREQUENCIES = st.sampled_from([0.0, 1e-9, 1e-3, 0.5, 1.0, 40.0])
RATIOS = st.sampled_from([0.0, 0.05, 1 - 1e-9, 1.0, 1 + 1e-9, 3.0])


def oscillator(frequency, ratio):
    """Displacement and velocity under a load and its slope: (4, 4)."""
    return np.array([[0, 1, 0, 0], [-(frequency**2), -2 * ratio * frequency, 1, 0], [0, 0, 0, 1], [0, 0, 0, 0.0]])


@settings(max_examples=20)
@given(st.lists(st.tuples(FREQUENCIES, RATIOS), min_size=1, max_size=4), st.sampled_from([1e-6, 0.3, 1.0, 20.0]))
def test_exponentials_are_those_of_scipy(oscillators, time):
    matrices = np.array([time * oscillator(*each) for each in oscillators])
    for matrix, found in zip(matrices, exponential(matrices), strict=True):
        right = expm(matrix)
        np.testing.assert_allclose(
            found, right, rtol=0, atol=1e-12 * max(1.0, np.linalg.norm(matrix, 1)) * np.abs(right).max()
        )


@settings(max_examples=12)
@given(
    st.lists(st.fractions(0, 5, max_denominator=7), max_size=4, unique=True),
    st.lists(st.tuples(FREQUENCIES, RATIOS), min_size=1, max_size=3),
)
def test_steps_between_events_are_exact(times, oscillators):
    """Each event starts a motion of its own, and these add up."""
    events = sorted({Fraction(0), *times} - {Fraction(5)})
    matrix = np.array([oscillator(*each) for each in oscillators])
    jumps = np.random.default_rng(7).normal(size=(len(events), len(matrix), 4))
    readings = np.random.default_rng(8).normal(size=(2, len(matrix), 4))
    taus, values = step_systems([Systems(matrix, jumps, readings)], events, 5.0, 0.4)
    assert np.all(np.diff(taus) <= 0.4 + 1e-12)
    assert all(0 <= np.min(abs(taus - float(event))) < 1e-15 for event in events)
    for tau, column in list(zip(taus, values.T, strict=True))[:: max(1, len(taus) // 5)]:
        right = np.zeros(2)
        for event, jump in zip(events, jumps, strict=True):
            if event <= tau:
                x = [expm(each * (tau - float(event))) @ one for each, one in zip(matrix, jump, strict=True)]
                right += np.einsum("obs,bs->o", readings, x)
        np.testing.assert_allclose(column, right, rtol=0, atol=1e-9 * max(1.0, np.abs(right).max()))


def test_too_short_a_series_is_seen(monkeypatch):
    matrix = np.array([oscillator(1.0, 0.05)])
    monkeypatch.setattr(stepping, "_TERMS", 6)
    assert np.abs(exponential(matrix)[0] - expm(matrix[0])).max() > 1e-8
    with pytest.raises(AssertionError):
        test_steps_between_events_are_exact.hypothesis.inner_test([Fraction(1, 2)], [(1.0, 0.05)])
