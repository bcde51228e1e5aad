"""Modes are stepped exactly: against matrix exponentials, balls, published peaks, and as a stream in C."""

from dataclasses import replace

import numpy as np
import pytest
from flint import arb, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st

from tests.support import oscillators
from tests.support.assembly import exact
from tests.support.oscillators import by_exponentials, evaluator, storeys, uniform
from wavesym.errors import UnservedError
from wavesym.mechanics.loads import AppliedLoad
from wavesym.numbers.doubles import midpoint, rational
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.modes import rounding
from wavesym.programs.modes.loads import LinearLoads, linear_loads
from wavesym.programs.modes.modal_system import ModalSystem, Stepper, mode_step, scheme_tables
from wavesym.programs.modes.records import RecordResponse
from wavesym.programs.modes.stepping import SteppedModes
from wavesym.programs.schemes.modes import ModesScheme

KINDS = [(0, 0), (1e-9, 0.3), (0.2, 0), (0.7, 1), (0.7, 1 + 1e-9), (1.3, 0.05), (2, 4), (3, 300), (11, 0.9)]
FREQUENCY, DAMPING = zip(*KINDS, strict=True)
UNEVEN = LinearLoads(
    tuple(map(exact, ("0", "0.3", "1", "1.1", "4"))),
    tuple(tuple(map(exact, row)) for row in ((0, 0), (1, 0), ("0.5", -2), ("0.5", 1), (-1, 1))),
    (exact("0.25"), exact(0)),
)


def turned(frequency, damping, s):
    """What the scheme says of one mode."""
    numbers = np.array([[frequency], [damping]], float)
    one = ModalSystem(*numbers, *np.ones((3, 1, 1)), np.zeros((1, 1, 3)))
    scheme = evaluator(one, uniform([0, 1], fmpq(1)), 2.0).scheme
    return [float(part[0, 0]) for part in scheme._mode_functions(np.array([s]))]


@given(
    st.sampled_from([0.0, 1e-12, 1e-3]) | st.floats(1e-4, 1e3),
    st.sampled_from([0.0, 1.0, 1 - 2.0**-50, 1 + 2.0**-50]) | st.floats(0, 3) | st.floats(3, 1e3),
    st.floats(1e-6, 50),
)
def test_a_step_is_as_exact_as_is_said(w, zeta, s):
    """In the size |y|/T + |v|, T = min(1/w, s), that the bound of rounding counts in."""
    with ctx.workprec(900):
        made = mode_step(w, zeta, rational(s))
        true = [made.p11, made.p12, made.p21, made.p22, made.one0 + made.one1, made.one1 * arb(rational(s))]
        true = [midpoint(value) for value in true]
    reach = min(1 / w if w else s, s)
    sizes = [1, reach, 1 / reach, 1, reach * reach, s * reach * reach]
    wrong = [abs(a - b) / size for a, b, size in zip(turned(w, zeta, s), true, sizes, strict=True)]
    assert max(wrong) <= rounding._STEP / 2 * (1 + w * s) * 2.0**-53


def test_without_its_series_a_slow_step_would_be_wrong(monkeypatch):
    """What differences of nearly equal numbers leave of the displacement under a force that grows."""
    right = turned(1e-4, 0.1, 1.0)[5]
    monkeypatch.setattr(ModesScheme, "SLOW", 0.0)
    assert right == pytest.approx(1 / 6, rel=1e-4)
    assert abs(turned(1e-4, 0.1, 1.0)[5] - right) > 1e-9


@pytest.mark.parametrize("tau", [0.0, 0.1, 0.3, 0.999, 1.05, 3.9, 4.0, 7.5])
def test_any_oscillator_under_uneven_loads_is_right_at_any_tau(tau):
    system = oscillators.oscillators(FREQUENCY, DAMPING, loads=2, outputs=4)
    found = evaluator(system, UNEVEN, 8.0).scheme.evaluate(tau)
    np.testing.assert_allclose(found, by_exponentials(system, UNEVEN, tau), rtol=0, atol=4e-12)


def test_values_are_the_same_in_any_order_and_company():
    """In blocks of panels, one by one, and with many at the same place of their panels."""
    system = oscillators.oscillators(FREQUENCY, DAMPING, loads=1, outputs=2)
    samples = [0, *(((k * k) % 7 - 3) for k in range(1300))]
    scheme = evaluator(system, uniform(samples, fmpq(1, 3)), 500.0).scheme
    taus = np.random.default_rng(1).permutation(np.concatenate([np.arange(0, 1300, 7) / 3, np.linspace(0, 500, 999)]))
    together = scheme.evaluate(taus)
    largest = np.abs(together).max(axis=1)
    for k in range(0, len(taus), 97):
        np.testing.assert_allclose(scheme.evaluate(taus[k]) / largest, together[:, k] / largest, rtol=0, atol=1e-13)
    assert np.isnan(scheme.evaluate([-1e-9, 500.1])).all()


def test_whoever_goes_through_a_record_steps_each_block_once(monkeypatch):
    """Twice before, once for the mark at its end; values are those of a scheme that keeps marks alone."""
    system = oscillators.oscillators(FREQUENCY, DAMPING, loads=1, outputs=2)
    loads, stepped = uniform([0, *(((k * k) % 7 - 3) for k in range(1300))], fmpq(1, 3)), []
    made = evaluator(system, loads, 500.0)
    step = SteppedModes._step_states
    monkeypatch.setattr(SteppedModes, "_step_states", lambda *args: stepped.append(args[2]) or step(*args))
    found = np.concatenate([outputs for _, outputs in made.scheme.starts()])
    assert stepped == [0, 512, 1024]
    stepped.clear()
    backwards = [made.scheme.states(block, 512 * block + 100)[-1] for block in (2, 1, 0)]
    assert stepped == [512, 0]
    plain = ModesScheme(scheme_tables(system, loads, DOUBLE), made.constants, 500.0, np.float64)
    times = [float(time) for time in loads.times]
    np.testing.assert_allclose(found.T, plain.evaluate(times), rtol=0, atol=1e-11)
    for scheme in (made.scheme, plain):  # of the states of a block only the mark at its end stays in memory
        assert [mark.base for mark in scheme._marks] == [None] * 3
    for block, state in zip((2, 1, 0), backwards, strict=True):
        np.testing.assert_array_equal(state, plain.states(block, 512 * block + 100)[-1])


@pytest.mark.parametrize("real", [DOUBLE, SINGLE])
def test_rounding_is_bounded(real):
    """The values of NumPy are within it of those in balls, which step the same numbers."""
    rounded = storeys(3, 6, 0.02)
    system = replace(rounded, **{k: v.astype(f"f{real.bytes}").astype(float) for k, v in vars(rounded).items()})
    samples = [exact((7 * k * k + 3 * k) % 17 - 8) for k in range(1, 61)]
    loads = uniform([0, *samples], fmpq(5, 4))
    made = evaluator(system, loads, 75.0, real)
    true = Stepper(system, fmpq(5, 4)).outputs([(sample,) for sample in samples])
    found = made.scheme.evaluate([float(time) for time in loads.times[1:]])
    wrong = np.abs(found - [[midpoint(value) for value in row] for row in true]).max(axis=1)
    assert np.all(wrong <= made.rounding.errors)
    assert np.all(made.rounding.errors < (1e-11 if real is DOUBLE else 5e-3) * made.rounding.largest)
    assert np.all(wrong > 0)


class OneMode(SteppedModes):
    """One mode on equal panels, all of which are stepped at once."""

    BLOCK = 1 << 20

    def _step_states(self, state, first, last):
        from scipy.signal import lfilter  # slow to import

        p11, p12, p21, p22, one, two = (float(part[0, 0]) for part in self._mode_functions(self._length))
        ramp, start = self.load[:2, first:last, 0].astype(float)
        y, v = one * start + two * ramp, p12 * start + one * ramp
        past = [1, -p11 - p22, p11 * p22 - p12 * p21]
        made = np.zeros((last - first + 1, 2, 1), self.real)
        made[1:, 0, 0] = lfilter([1, -p22], past, y) + lfilter([0, p12], past, v)
        made[1:, 1, 0] = lfilter([1, -p11], past, v) + lfilter([0, p21], past, y)
        return made


@pytest.mark.parametrize(
    ("turn", "damping", "count", "fast"),
    [(np.pi, 0.02, 3200, False), (0.0056, 0.5, 170_000, True)],
    ids=["a mode in resonance", "a force that changes long before a mode feels it"],
)
def test_what_rounded_times_do_is_bounded(turn, damping, count, fast):
    """Nothing else counts after many panels, as what they lost is damped away: times are absolute.

    A load of 1, -1, 1, ..., of which a mode turns by `turn` in a panel; displacements, or velocities if it is `fast`.
    Just after tau = 512 a rounding is as large as it can be.
    """
    spacing = fmpq(520_000, 1000 * count + 1)
    h, ones = float(spacing), np.ones(1)
    w = float(np.float32(turn / h))
    until = float(np.float32(h * count))
    tables = {"frequency": w * ones, "damping": np.float32(damping) * ones, "push": ones, "direct": np.zeros(3)}
    tables |= {"moved": ones * (not fast), "moving": ones * fast, "kind": np.zeros(count, int), "length": h * ones}
    tables |= {"time": h * np.arange(count + 1), "slope": np.zeros(1)}
    tables["sample"] = np.array([0.0, *[1.0, -1.0] * (count // 2)])
    taus = np.linspace(until - 12 * h, until, 2000, dtype=np.float32)
    exact, made = (OneMode(tables, {"loads": 1}, until, real) for real in (np.float64, np.float32))
    wrong = np.abs(made.evaluate(taus) - exact.evaluate(taus)).max()
    one = np.ones((1, 1))
    system = ModalSystem(
        w * ones, tables["damping"], one, one * (not fast), one * fast, tables["direct"].reshape(1, 1, 3)
    )
    rows = [(fmpq(0),), *[(fmpq(1),), (fmpq(-1),)] * (count // 2)]
    loads = LinearLoads(tuple(spacing * k for k in range(count + 1)), tuple(rows), (fmpq(0),))
    (bound,) = rounding.rounding_errors(system, loads, made, until, SINGLE).errors
    assert wrong <= bound <= 15 * wrong


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("period", "at_samples", "between"),
    [(0.5, 2.67389, 2.68706), (1, 5.96616, 5.96716), (2, 7.46497, 7.46629)],
)
def test_an_oscillator_under_el_centro_has_the_published_peak(period, at_samples, between):
    """Published: 2.674, 5.966, 7.465 in, with 2 % of critical damping; and what a finer look finds."""
    one = np.ones((1, 1))
    w = 2 * np.pi / period
    system = ModalSystem(w * one[0], 0.02 * one[0], -oscillators.INCHES_OF_G * one, one, 0 * one, np.zeros((1, 1, 3)))
    record = oscillators.el_centro()
    scheme = evaluator(system, uniform(record, fmpq(1, 50)), (len(record) - 1) / 50).scheme
    taus = np.arange(len(record)) / 50
    assert np.abs(scheme.evaluate(taus)).max() == pytest.approx(at_samples, abs=6e-6)
    finer = np.linspace(0, taus[-1], 64 * (len(record) - 1) + 1)
    assert np.abs(scheme.evaluate(finer)).max() == pytest.approx(between, abs=1e-5)


def test_many_records_at_once_are_what_each_is_alone():
    system = storeys(2, 4, 0.05)
    samples = np.random.default_rng(2).uniform(-1, 1, (3, 150)).round(6)
    samples[:, 0] = 0
    response = RecordResponse(system, 3 / 7, parts=2)
    made = response.respond(samples[:, :, None])
    known_of_all = response.block_states(samples[:, :, None])
    at, s = np.array([0, 5, 63, 64, 65, 127, 147]), np.linspace(0.0, 3 / 7, 7)
    for number, record in enumerate(samples):
        loads = uniform(record.tolist(), fmpq(3, 7))
        alone = evaluator(system, loads, float(loads.times[-1])).scheme
        size = 1e-12 * np.abs(made[number]).max()
        taus = np.arange(1, 2 * 149 + 1) * (3 / 14)
        taus[-1] = alone_end = float(loads.times[-1])
        assert alone_end == pytest.approx(149 * 3 / 7)
        np.testing.assert_allclose(made[number].T, alone.evaluate(taus), rtol=0, atol=size)
        known = response.step_states(samples[:, :, None], known_of_all, np.full(7, number), at)
        between = alone.evaluate(at * 3 / 7 + s)
        for output in range(len(between)):
            found = response.value_at(known, s, np.full(7, output))
            np.testing.assert_allclose(found, between[output], rtol=0, atol=size)
            each = np.einsum("ck,ck->c", known, response.reads(s)[:, :, output])
            np.testing.assert_allclose(each, between[output], rtol=0, atol=size)


def test_loads_are_put_together_from_their_ramps():
    ramps = [("b", 1, 2), ("b", 3, -2), ("r", 3, "1/2"), ("b", 7, 5)]
    made = linear_loads(
        [AppliedLoad(s, exact(t), exact(w)) for s, t, w in ramps], [("a", "b"), ("s", "r")], exact(6), str
    )
    assert [str(time) for time in made.times] == ["0", "1", "3"]
    assert [[str(value) for value in row] for row in made.samples] == [["0", "0"], ["0", "0"], ["4", "0"]]
    assert [str(slope) for slope in made.slopes] == ["0", "1/2"]
    with pytest.raises(UnservedError, match=r"weight=3\), and modes support no jump"):
        linear_loads([AppliedLoad("a", exact(0), exact(3))], [("a", "b")], exact(6), str)


@pytest.mark.parametrize(
    ("times", "told", "spacing"),
    [
        (["0", "0.4", "1"], None, "1/5"),
        (["0", "0.4", "1"], "0.1", "1/10"),
        (["0", "0.4", "1"], "0.3", "1/5"),
        (["0"], None, "3/500"),
        (["0", "0.123", "0.423", "1.023"], None, "3/10"),  # nothing moves before the first
    ],
)
def test_the_step_of_a_stream_is_what_all_times_have_in_common(times, told, spacing):
    begins = len(times) == 4
    samples = [(fmpq(0 if k < 1 + begins else k),) for k in range(len(times))]
    loads = LinearLoads(tuple(map(exact, times)), tuple(samples), (fmpq(0),))
    assert loads.spacing(exact(6), exact(told) if told else None) == exact(spacing)
