"""Means, root mean squares and last values against closed forms, and against sums of many values."""

from __future__ import annotations

from dataclasses import replace
from math import exp, nextafter, pi, sqrt

import numpy as np
import pytest
from flint import arb, fmpq
from hypothesis import given, settings
from scipy.integrate import trapezoid

import wavesym
from tests.support.chains import chains
from tests.support.scenes import scenes
from wavesym.errors import CostError, WavesymError
from wavesym.exact import output_piece as module
from wavesym.exact.extremes import BOUND, extremes_and_averages
from wavesym.exact.output_piece import Averages, Piece, averages
from wavesym.numbers.doubles import midpoint
from wavesym.results.response import Response
from wavesym.scene import Scene, lower

GUN = [{"motion": "velocity", "name": "gun"}, {"rod": 4}, "absorbing"]


def averaged(until: object, **load: object) -> Averages:
    """Those of what a load is: nothing comes back from the end."""
    scene = Scene(
        name="drawn",
        system={"type": "chain", "parts": GUN},
        load=[{"at": "gun"} | load],
        output={"until": until, "velocity": ["gun"]},
    )
    ((_, found),) = extremes_and_averages(lower(scene))
    return found


@pytest.mark.parametrize("until", [2, 2.5, "7/3", nextafter(2.0, 3.0)])
def test_a_step_and_a_ramp(until: object) -> None:
    """1 up to tau = 2; then it falls by 1 a unit of tau."""
    found = averaged(until, times=[0, 2], steps=[1, 0], ramps=[0, -1])
    end = float(fmpq(*map(int, until.split("/"))) if isinstance(until, str) else until)
    after = end - 2
    assert midpoint(found.mean) == pytest.approx((end - after**2 / 2) / end, rel=1e-15)
    square = 2 + (1 - (1 - after) ** 3) / 3
    assert midpoint(found.rms) == pytest.approx(sqrt(square / end), rel=1e-15)
    assert midpoint(found.residual) == pytest.approx(1 - after, rel=1e-15)


def test_a_wave_of_whole_periods_has_mean_0_and_rms_of_its_amplitude_over_root_2() -> None:
    """A mass on a spring: displacement (1 - cos w t)/w^2 under a step, w = 2 pi by a spring of rational stiffness."""
    stiffness = fmpq(int(4 * pi**2 * 10**12), 10**12)
    parts = [{"mass": 1, "name": "m", "spring": str(stiffness)}, {"rod": 1, "impedance": "1e-9"}, "absorbing"]
    scene = Scene(
        name="drawn",
        system={"type": "chain", "parts": parts},
        load=[{"at": "m", "times": [0], "steps": [1]}],
        output={"until": 3, "velocity": ["m"], "displacement": ["m"]},
    )
    (_, velocity), (_, displacement) = extremes_and_averages(lower(scene))
    w = 2 * pi
    assert abs(midpoint(velocity.mean)) < 1e-8
    assert midpoint(velocity.rms) == pytest.approx(1 / w / sqrt(2), rel=1e-7)
    assert midpoint(displacement.mean) == pytest.approx(1 / w**2, rel=1e-7)
    assert midpoint(displacement.rms) == pytest.approx(sqrt(1.5) / w**2, rel=1e-7)


def test_a_rod_that_a_mass_strikes() -> None:
    """v = exp(-tau/m) on an endless rod."""
    parts = [{"mass": 2, "name": "hammer", "velocity": 1}, {"rod": 1}, "absorbing"]
    scene = Scene(name="s", system={"type": "chain", "parts": parts}, output={"until": 3, "velocity": ["hammer"]})
    ((_, found),) = extremes_and_averages(lower(scene))
    assert midpoint(found.mean) == pytest.approx(2 / 3 * (1 - exp(-1.5)), rel=1e-15)
    assert midpoint(found.rms) == pytest.approx(sqrt((1 - exp(-3)) / 3), rel=1e-15)
    assert midpoint(found.residual) == pytest.approx(exp(-1.5), rel=1e-15)


TINY = 1e-290
"""Below this numbers have fewer digits."""


def wrong(scene: Scene) -> float:
    """By how much averages differ from sums of values, in parts of what sums may be wrong by: jumps between samples."""
    model = lower(scene)
    try:
        found = extremes_and_averages(model)
        taus = np.linspace(0, model.horizon(), 4001)
        values = Response(model)(taus)
    except WavesymError:
        return 0.0
    worst = 0.0
    for (extreme, each), row in zip(found, values, strict=True):
        largest = max(abs(end.value) for end in extreme)
        least = min(end.value for end in extreme)
        assert least - BOUND * largest <= midpoint(each.mean) <= max(end.value for end in extreme) + BOUND * largest
        if largest < TINY:
            continue
        parts = row / largest  # whose squares are no more than numbers can be
        allowed = (float(np.abs(np.diff(parts)).sum()) + 2) / 4000 + 1e-12  # of a trapezoidal sum of bounded variation
        sums = [trapezoid(parts, taus), sqrt(trapezoid(parts**2, taus) * model.horizon())]
        ours = [midpoint(each.mean) / largest, midpoint(each.rms) / largest]
        errors = [abs(total / model.horizon() - our) for total, our in zip(sums, ours, strict=True)]
        worst = max(worst, errors[0] / allowed, errors[1] ** 2 / allowed, errors[1] / (20 * sqrt(allowed)))
        assert row[-1] == pytest.approx(midpoint(each.residual), rel=1e-13, abs=1e-13 * largest)
        assert each.radius <= arb(largest) * arb(2) ** -56
    return worst


@settings(max_examples=12, deadline=None)
@given(scenes())
def test_averages_of_drawn_scenes_are_those_of_values(scene: Scene) -> None:
    assert wrong(scene) <= 2


@settings(max_examples=12, deadline=None)
@given(chains())
def test_averages_of_drawn_chains_are_those_of_values(table: dict[str, object]) -> None:
    try:
        scene = Scene(**table)
    except WavesymError:
        return
    assert wrong(scene) <= 2


def test_radii_count() -> None:
    """p = t on a piece of length 2, known to 1/8: the mean to 1/8, and the square."""
    piece = Piece(fmpq(0), fmpq(2), (arb(0), arb(1)), arb("0.125"), from_zero=False, last=True)
    found = averages([piece], fmpq(2))
    assert found.mean.contains(arb("0.124"))
    assert not found.mean.contains(arb("0.126"))
    assert (found.rms**2).contains(arb(1) / 3)
    assert found.residual.contains(arb("1.124"))


def test_a_broken_integral_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    integral = module._integral
    monkeypatch.setattr(module, "_integral", lambda polynomial: integral(polynomial) * (1 + arb(2) ** -30))
    found = averaged(3, times=[0], steps=[1])
    assert midpoint(found.mean) != 1.0


def test_averages_of_a_program_are_near_those_that_are_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene.from_toml("drive_m1")
    true = wavesym.summary(scene)

    def refused(_: object) -> None:
        raise CostError("refused")

    monkeypatch.setattr("wavesym.results.summary.extremes_and_averages", refused)
    found = wavesym.summary(scene)
    assert not found.proved
    for ours, theirs in zip(found.outputs, true.outputs, strict=True):
        largest = abs(theirs.largest.value)
        for name in ("mean", "rms", "residual"):
            assert getattr(ours, name) == pytest.approx(getattr(theirs, name), abs=1e-3 * largest)
        assert replace(ours, mean=0, rms=0, residual=0).name == theirs.name


def test_of_samples_they_are_those_of_the_samples() -> None:
    scene = Scene.from_toml("building_m2")
    found = wavesym.summary(scene, at_samples=True)
    values = wavesym.run(scene, samples=1001).values
    for output, row in zip(found.outputs, values, strict=True):
        assert output.mean == pytest.approx(row.mean(), rel=1e-12)
        assert output.rms == pytest.approx(sqrt((row**2).mean()), rel=1e-12)
        assert output.residual == row[-1]
