"""Frequency responses against closed forms, a dense dynamic stiffness, and transforms of histories."""

from __future__ import annotations

import csv
import json
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest
from flint import acb, acb_series, arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import trapezoid

import wavesym
from wavesym import Scene
from wavesym.cli import main
from wavesym.errors import UnservedError
from wavesym.exact.modes.harmonic import Amplitudes
from wavesym.mechanics.network import Network
from wavesym.results import amplitude_polynomials, resonance
from wavesym.results.transfer import Transfer, harmonic_load
from wavesym.scene import lower

ULP = 2.0**-52


def rod(**joint: object) -> Scene:
    """A held rod of impedance and delay 1, a unit force on its end."""
    return Scene(
        name="rod",
        system={"type": "chain", "parts": ["fixed", {"rod": 1}, {"joint": True, "name": "tip", **joint}]},
        load=[{"at": "tip", "times": [0], "steps": [1]}],
        output={
            "until": 1,
            "strain": ["0"],
            "velocity": ["1/3"],
            "displacement": ["tip", "1/2"],
            "force": ["1/4"],
            "drift": [1],
        },
    )


def test_a_rod_answers_as_its_closed_form() -> None:
    w = np.array([0.3, 1.5, 2.0, 7.7, 100.0])
    found = wavesym.frf(rod(), w)
    expected = {
        "strain@0": 1 / np.cos(w),
        "velocity@1/3": 1j * np.sin(w / 3) / np.cos(w),
        "displacement@tip": np.tan(w) / w,
        "displacement@1/2": np.sin(w / 2) / np.cos(w) / w,
        "force@1/4": np.cos(w / 4) / np.cos(w),
        "drift@1": np.tan(w) / w,
    }
    for name, values in expected.items():
        # numpy's functions are right to some ulps, and w is rounded before it is multiplied
        assert found[name] == pytest.approx(values, rel=200 * ULP)
    assert found.bound < 3 * ULP
    assert np.all(found.phase[0][np.cos(w) < 0] == 180)


def test_at_rest_a_rod_is_a_spring() -> None:
    assert wavesym.frf(rod(), [0.0]).values[:, 0] == pytest.approx([1, 0, 1, 0.5, 1, 1])


def test_a_layer_on_rock_amplifies_by_the_ratio_of_impedances() -> None:
    """A layer of impedance 1 on a half space of impedance 4: |surface/outcrop| = 1/|cos w + i sin(w)/4|."""
    parts = [{"joint": True, "name": "rock", "dashpot": 4}, {"rod": 1}, "free"]
    load = [{"at": "rock", "times": [0], "steps": [1]}]  # 1/4 of the force of an outcrop's velocity 1
    scene = Scene(
        name="soil",
        system={"type": "chain", "parts": parts},
        load=load,
        output={"until": 1, "velocity": ["1"], "tolerance": 1e-9},
    )
    w = np.linspace(0.1, 20, 50)
    assert 4 * wavesym.frf(scene, w)["velocity@1"] == pytest.approx(1 / (np.cos(w) + 1j * np.sin(w) / 4), rel=1e-13)
    (peak,) = wavesym.frf(scene, w).peaks()
    assert peak.low <= 1 <= peak.high
    assert peak.high - peak.low < 1e-8
    assert abs(np.cos(peak.frequency)) < 1e-4


def dense(network: Network, point: int, w: float) -> NDArray[np.complex128]:
    """How far points move under a unit force, from the dynamic stiffness written out as a matrix."""
    k = np.zeros((len(network.points),) * 2, complex)
    for number, each in enumerate(network.points):
        k[number, number] += float(each.stiffness) + 1j * w * float(each.damping) - w * w * float(each.mass)
    for bar in network.bars:
        ends, ratios = [bar.left, bar.right], np.array([float(r) for r in bar.ratios])
        z, angle = float(bar.impedance) * w, w * float(bar.delay)
        block = z * np.array([[np.cos(angle), -1], [-1, np.cos(angle)]]) / np.sin(angle)
        k[np.ix_(ends, ends)] += ratios[:, None] * block * ratios
    for link in network.links:
        ends, ratios = [link.left, link.right], np.array([float(link.ratio), 1.0])
        resist = float(link.stiffness) + 1j * w * float(link.damping)
        k[np.ix_(ends, ends)] += ratios[:, None] * (resist * np.array([[1, -1], [-1, 1]])) * ratios
    free = [number for number, each in enumerate(network.points) if each.motion is None]
    moved = np.zeros(len(network.points), complex)
    moved[free] = np.linalg.solve(k[np.ix_(free, free)], np.eye(len(network.points))[free, point])
    return moved


NUMBER = st.sampled_from(["1/7", "1/2", "1", "1", "1", "10001/10000", "3", "20"])
ROD = st.fixed_dictionaries(
    {"rod": NUMBER, "impedance": NUMBER}, optional={"spring": NUMBER, "dashpot": NUMBER, "speed": NUMBER}
)
NODE = st.fixed_dictionaries({"mass": NUMBER}, optional={"spring": NUMBER, "dashpot": NUMBER})
LINK = st.fixed_dictionaries({"spring": NUMBER}, optional={"dashpot": NUMBER})
END = st.sampled_from(["free", "fixed", "absorbing"])


@st.composite
def trees(draw: st.DrawFn) -> Scene:
    """A chain with a geared branch, a force somewhere, all nodes watched."""
    names = iter("abcdefghijklmnop")

    def line(*, first: bool) -> list[object]:
        parts: list[object] = [draw(END)] if first else []
        for _ in range(draw(st.integers(1, 3))):
            parts.append(draw(ROD))
            parts.append({**draw(NODE), "name": next(names)})
            if draw(st.booleans()):
                parts += [draw(LINK), {**draw(NODE), "name": next(names)}]
        return [*parts, draw(ROD), draw(END)]

    main_line, branch = line(first=True), line(first=False)
    system = {
        "type": "chain",
        "parts": main_line,
        "branch": [{"from": "a", "name": "side", "ratio": draw(st.sampled_from(["2", "-1/3", "1"])), "parts": branch}],
    }
    nodes = [part["name"] for part in (*main_line, *branch) if isinstance(part, dict) and "name" in part]
    return Scene(
        name="tree",
        system=system,
        load=[{"at": draw(st.sampled_from(nodes)), "times": [0], "steps": [1]}],
        output={"until": 1, "displacement": nodes},
    )


@settings(max_examples=60, deadline=None)
@given(trees(), st.sampled_from([0.01, 0.7, 1.3, 4.0, 17.0, 40.0]))
def test_any_tree_answers_as_its_matrix(scene: Scene, w: float) -> None:
    network = lower(scene).network
    driven = next(number for number, point in enumerate(network.points) if point.loads)
    names = {point.name: number for number, point in enumerate(network.points)}
    found, moved = wavesym.frf(scene, [w]), dense(network, driven, w)
    # rounding of the matrix: doubles, times how much nearly equal terms cancel in it
    size = np.max(np.abs(moved))
    for name in found:
        assert abs(found[name][0] - moved[names[name.partition("@")[2]]]) < 1e-7 * size


@pytest.mark.parametrize("lost", ["resistance", "coupling"])
def test_the_comparison_finds_what_is_missing(lost: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A bar that resists, or takes its far end along, a millionth too much."""
    through, coupling = Amplitudes._branch_fraction, Amplitudes._coupling

    def broken(self: Amplitudes, branch):  # type: ignore[no-untyped-def]
        n, d = through(self, branch)
        return (n * (1 + 2**-16), d) if lost == "resistance" else (n, d)

    monkeypatch.setattr(Amplitudes, "_branch_fraction", broken)
    if lost == "coupling":
        monkeypatch.setattr(Amplitudes, "_coupling", lambda self, branch: coupling(self, branch) * (1 + 2**-16))
    scene = Scene(
        name="tree",
        system={
            "type": "chain",
            "parts": ["fixed", {"rod": 1}, {"mass": 1, "name": "a"}, {"rod": 2}, {"mass": 1, "name": "b"}],
        },
        load=[{"at": "b", "times": [0], "steps": [1]}],
        output={"until": 1, "displacement": ["a", "b"]},
    )
    network = lower(scene).network
    found, moved = wavesym.frf(scene, [1.3]), dense(network, 2, 1.3)
    assert np.max(np.abs(found.values[:, 0] - moved[1:])) > 1e-7 * np.max(np.abs(moved))


def test_it_is_the_transform_of_a_history(thorough: bool) -> None:
    """A pulse that is linear between samples, and what it does, which dies away: both as Fourier integrals."""
    until, spacing = 40, 0.5
    samples = [0, 1, 3, 2, -1, 0]
    base = rod(dashpot="4/5")
    load = [{"at": "tip", "spacing": spacing, "samples": samples}]
    scene = Scene(name="rod", system=base.system, load=load, output={"until": until, "displacement": ["1/2"]})
    fine = 4000 if thorough else 1000
    times = np.linspace(0, until, fine * until + 1)
    history = scene.run(times)["displacement@1/2"]
    pulse = np.interp(times, spacing * np.arange(len(samples)), samples)
    for w in (0.4, 1.9):
        turns = np.exp(-1j * w * times)
        expected = trapezoid(history * turns, times) / trapezoid(pulse * turns, times)
        # rule of trapezes: both are kinked at multiples of its step alone, and their second derivatives are below 10
        assert wavesym.frf(scene, [w]).values[0, 0] == pytest.approx(expected, abs=20 * until / fine**2)


def frame(damping: object, tolerance: float = 1e-5) -> Scene:
    """A building on moving ground."""
    scene = Scene.from_toml("building_m2").with_({"system.base": "ground"})
    return scene.with_({"system.damping": damping, "output.tolerance": tolerance}) if damping else scene


def elements(scene: Scene, count: int) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies, shapes and shares of a building on moving ground, its rods as `count` linear elements each."""
    network = lower(scene).network
    size = count * len(network.bars) + 1
    k, m = np.zeros((size, size)), np.zeros((size, size))
    for number, bar in enumerate(network.bars):
        z, h = float(bar.impedance), float(bar.delay) / count
        for e in range(count * number, count * (number + 1)):
            k[e : e + 2, e : e + 2] += z / h * np.array([[1, -1], [-1, 1]])
            m[e : e + 2, e : e + 2] += z * h / 6 * np.array([[2, 1], [1, 2]])
    for number, point in enumerate(network.points):
        m[count * number, count * number] += float(point.mass)
    factor = np.linalg.cholesky(m[1:, 1:])
    inverse = np.linalg.inv(factor)
    squares, vectors = np.linalg.eigh(inverse @ k[1:, 1:] @ inverse.T)
    shapes = inverse.T @ vectors
    shares = shapes.T @ (m[1:, 1:] @ np.ones(size - 1) + m[1:, 0])
    return np.sqrt(squares), shapes, shares


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "damping", [{"modes": [1, 2], "ratio": "1/20"}, ["1/20"], ["1/10", "1/50", "1/5"]], ids=["rayleigh", "one", "list"]
)
def test_damped_modes_answer_as_those_of_finite_elements(damping: object) -> None:
    count, scene = 60, frame(damping)
    n, shapes, shares = elements(scene, count)
    if isinstance(damping, dict):
        a, b = 2 / 20 * n[0] * n[1] / (n[0] + n[1]), 2 / 20 / (n[0] + n[1])
        ratios = (a / n + b * n) / 2
    else:
        given = [float(Fraction(ratio)) for ratio in damping]  # type: ignore[attr-defined]
        ratios = np.array([*given, *[given[-1]] * len(n)])[: len(n)]
    for w in (0.2, 0.9, 2.5):
        relative = shapes @ (-shares / (n * n - w * w + 2j * ratios * n * w))  # under the acceleration 1
        expected = relative[3 * count // 2 - 1] - 1 / w**2
        # two points a wave fewer than elements: an error of (w h)^2/24 of each frequency
        assert wavesym.frf(scene, [w])["displacement@1.5"][0] == pytest.approx(expected, rel=2e-3)


def test_ratios_of_every_mode_are_rayleighs() -> None:
    """The same damping, once in closed form and once as a list for the first modes: others hardly move here."""
    n = [mode.omega for mode in wavesym.modes(frame(None), 40)]
    a, b = 2 / 500 * n[0] * n[1] / (n[0] + n[1]), 2 / 500 / (n[0] + n[1])
    ratios = [(a / w + b * w) / 2 for w in n]
    w = [0.2, 0.3, 1.1]
    rayleigh = wavesym.frf(frame({"modes": [1, 2], "ratio": "1/500"}), w)
    listed = wavesym.frf(frame(ratios), w)
    for name in ("displacement@0.5", "displacement@1.5", "velocity@1.5"):
        assert listed[name] == pytest.approx(rayleigh[name], rel=1e-5)


def test_modes_left_out_may_be_damped_more_than_all_before() -> None:
    """Forty ratios of 1/100, then 5: what is left out after 32 modes, or 64, has the greatest ratio there is."""
    n, w = (np.arange(200_000) + 0.5) * np.pi, 8.0
    ratios = np.where(np.arange(len(n)) < 40, 0.01, 5.0)
    expected = np.sum(2 / (n * n - w * w + 2j * ratios * n * w))  # sin(n) = 1 or -1 at the tip, the mass is 1/2
    rest = 20 * w / np.pi**3 / len(n) ** 2
    damping = {"system.damping": ["1/100"] * 40 + ["500 %"], "output.tolerance": 1e-4}
    damped = rod().with_(damping | {f"output.{quantity}": [] for quantity in ("strain", "velocity", "force", "drift")})
    found = wavesym.frf(damped, [w])
    value = found["displacement@tip"][0]
    assert abs(value - expected) <= found.bound * abs(value) + rest
    assert rest < 1e-9


def test_equal_frequencies_with_ratios_of_their_own_are_refused() -> None:
    """Which of the modes of three equal arms is the second, and which the third, is open."""
    parts = ["fixed", {"rod": 1}, {"mass": 1, "name": "hub"}, {"rod": 1}, "fixed"]
    arm = {"from": "hub", "name": "arm", "parts": [{"rod": 1}, "fixed"]}
    star = Scene(
        name="star",
        system={"type": "chain", "parts": parts, "branch": [arm], "damping": ["1/100", "1/10", "1/5"]},
        load=[{"at": "hub", "times": [0], "steps": [1]}],
        output={"until": 1, "tolerance": 1e-4, "displacement": ["1/3"]},
    )
    with pytest.raises(
        UnservedError, match=r"system.damping: 0.1 and 0.2 for modes 2 and 3, which have one frequency, 3.14159"
    ):
        wavesym.frf(star, [1.0])
    assert np.isfinite(wavesym.frf(star.with_({"system.damping": ["1/100", "1/10", "1/10"]}), [1.0]).values).all()


@pytest.mark.parametrize("damping", [None, "1/20", {"modes": [1, 2], "ratio": "1/20"}], ids=["none", "one", "rayleigh"])
def test_what_stands_on_the_ground_moves_as_it_does_at_frequency_0(damping: object) -> None:
    made = Scene.from_toml("building_m2").with_(
        {"system.base": "ground", "system.damping": damping, "output.tolerance": 1e-6, "output.acceleration": [1, 2]}
    )
    found = wavesym.frf(made, [0.0, 0.5])
    assert found["acceleration@1"][0] == found["acceleration@2"][0] == 1
    assert np.isnan(found["velocity@0.5"][0])
    assert found.poles == (0.0,)


def test_a_band_may_begin_at_0() -> None:
    """A rod on moving ground, with a mass and a dashpot on top: 1/(cos w - (m w - i c) sin w) in closed form."""
    parts = [{"motion": "acceleration", "name": "g"}, {"rod": 1}, {"mass": "1/2", "dashpot": "1/10", "name": "top"}]
    scene = Scene(
        name="tower",
        system={"type": "chain", "parts": parts},
        load=[{"at": "g", "times": [0], "steps": [1]}],
        output={"until": 1, "acceleration": ["top"], "displacement": ["top"]},
    )
    w = np.linspace(0, 2, 200_001)
    expected = np.abs(1 / (np.cos(w) - (w / 2 - 0.1j) * np.sin(w)))
    peaks = wavesym.frf(scene, [0.0, 2.0]).peaks()
    assert expected.max() <= peaks["acceleration@top"].high <= expected.max() * (1 + 1e-6)
    assert peaks["acceleration@top"].frequency == pytest.approx(w[expected.argmax()], abs=1e-5)
    assert (peaks["displacement@top"].frequency, peaks["displacement@top"].amplitude) == (0.0, np.inf)


def test_a_free_chain_has_strains_near_frequency_0() -> None:
    """A force on one end of a free rod: strain sin(w/2)/sin(w) at its middle, which has no value at 0, but a limit."""
    scene = Scene(
        name="bar",
        system={"type": "chain", "parts": [{"joint": True, "name": "a"}, {"rod": 1}, "free"]},
        load=[{"at": "a", "times": [0], "steps": [1]}],
        output={"until": 1, "strain": ["1/2"], "velocity": ["1/2"]},
    )
    peaks = wavesym.frf(scene, [0.0, 1.5]).peaks()
    expected = np.sin(0.75) / np.sin(1.5)
    assert peaks["strain@1/2"].low <= expected * (1 + ULP)
    assert expected * (1 - ULP) <= peaks["strain@1/2"].high < expected * (1 + 1e-9)
    assert (peaks["velocity@1/2"].frequency, peaks["velocity@1/2"].amplitude) == (0.0, np.inf)


@pytest.mark.slow
@settings(max_examples=6, deadline=None)
@given(trees())
def test_no_amplitude_is_above_its_peak(scene: Scene) -> None:
    response = wavesym.frf(scene, np.linspace(0.1, 3, 400))
    peaks = response.peaks()
    for name, row in zip(response, response.amplitude, strict=True):
        assert np.nanmax(row) <= peaks[name].high * (1 + 4 * ULP)
        if peaks[name].high < np.inf:
            assert peaks[name].high - peaks[name].low <= 1e-9 * peaks[name].high
            there = wavesym.frf(scene, [peaks[name].frequency])[name][0]
            assert abs(there) == pytest.approx(peaks[name].amplitude, rel=1e-9)


def test_a_narrow_peak_between_points_is_not_missed() -> None:
    """A dashpot of 1/10 000 at the end: the strain at the support rises to 10 000 within 1/10 000 of frequency."""
    response = wavesym.frf(rod(dashpot="1/10000"), np.linspace(1, 3, 5))
    assert response.amplitude[0].max() < 20
    peak = response.peaks()["strain@0"]
    assert peak.low <= 10_000 <= peak.high < 10_001
    assert peak.frequency == pytest.approx(np.pi / 2, abs=1e-6)


LAYER = Scene(
    name="layer",
    system={"type": "chain", "parts": [{"joint": True, "name": "rock", "dashpot": 4}, {"rod": 1}, "free"]},
    load=[{"at": "rock", "times": [0], "steps": [1]}],
    output={"until": 1, "velocity": ["1"]},
)


def test_the_place_of_a_peak_is_enclosed(capsys: pytest.CaptureFixture[str]) -> None:
    """A layer on rock, 1/|4 cos w + i sin w|: 1 at pi/2 and, as high, at 3 pi/2; it rises before the first."""
    (peak,) = wavesym.frf(LAYER, [0.0, 4.0]).peaks()
    with ctx.workprec(128):
        assert peak.frequency_low < arb.pi() / 2 < peak.frequency_high
    assert peak.frequency_high - peak.frequency_low <= 2 * ULP
    assert peak.frequency_low <= peak.frequency <= peak.frequency_high
    (rise,) = wavesym.frf(LAYER, [0.25, 1.0]).peaks()
    assert (rise.frequency_low, rise.frequency, rise.frequency_high) == (1.0, 1.0, 1.0)
    (both,) = wavesym.frf(LAYER, [1.0, 5.0]).peaks()
    assert both.frequency_low < np.pi / 2
    assert both.frequency_high > 3 * np.pi / 2
    json_peak = json.loads(wavesym.frf(LAYER, [0.0, 4.0]).peaks().json())["peaks"][0]
    assert (json_peak["frequency_low"], json_peak["frequency_high"]) == (peak.frequency_low, peak.frequency_high)


def test_the_rest_of_a_taylor_polynomial_is_there() -> None:
    """Power series are cut at ctx.cap terms: what bounds the rest is the last of these, not a 0 behind it."""
    model = lower(LAYER)
    found = amplitude_polynomials.transfer_fractions(
        Transfer(model, harmonic_load(model, ("rock:step",))), arb(1).union(arb(2))
    )
    assert found is not None
    assert len(found.divisor) <= ctx.cap
    assert found.divisor[-1].real.rad() > 0


@pytest.mark.slow
def test_what_nothing_damps_has_no_greatest_amplitude() -> None:
    peak = wavesym.frf(rod(), [1.0, 2.0]).peaks()["strain@0"]
    assert 0 < peak.frequency_high - peak.frequency_low <= 2 * ULP
    assert peak.frequency_low <= np.pi / 2 <= peak.frequency_high
    assert (peak.amplitude, peak.high) == (np.inf, np.inf)
    assert peak.frequency == pytest.approx(np.pi / 2)
    spring = Scene(
        name="bob",
        system={"type": "chain", "parts": ["fixed", {"rod": 1}, {"mass": 1}, {"spring": 9}, {"mass": 1, "name": "a"}]},
        load=[{"at": "a", "times": [0], "steps": [1]}],
        output={"until": 1, "displacement": ["1-"]},
    )
    assert wavesym.frf(spring, [1.0]).poles == ()
    free = Scene.from_toml("drive_m1")
    assert wavesym.frf(free, [0.0, 1.0], load=0).poles == (0.0,)


@pytest.mark.parametrize(("low", "high"), [(0.1, 1.0), (2.0, 6.0)])
def test_a_pole_is_where_it_is_to_the_last_digit(low: float, high: float) -> None:
    """w tan w = 1 of a mass before a held rod: places of poles were those of an interval, 13 digits of 17 printed."""
    system = {"type": "chain", "parts": [{"mass": 1, "name": "a"}, {"rod": 1}, "fixed"]}
    load = [{"at": "a", "times": [0], "steps": [1]}]
    made = Scene(name="s", system=system, load=load, output={"until": 1, "displacement": ["a"]})
    (peak,) = wavesym.frf(made, low=low, high=high, points=2).peaks()
    with mpmath.workdps(40):
        expected = float(mpmath.findroot(lambda w: w * mpmath.tan(w) - 1, 0.86 if high < 2 else 3.43))
    assert (peak.frequency, peak.amplitude) == (expected, np.inf)


@pytest.mark.quick(2)
@pytest.mark.parametrize("beside", [0, -1, -20, 1])
def test_a_band_that_ends_just_before_a_pole_has_a_greatest_amplitude(beside: int) -> None:
    """A held rod under a force at its end moves tan(w)/w: pi/2 lies 2e-17 above 1.5707963267948966."""
    below = float(np.pi / 2)
    high = below + beside * float(np.spacing(below))
    system = {"type": "chain", "parts": ["fixed", {"rod": 1}, {"joint": True, "name": "end"}]}
    load = [{"at": "end", "times": [0], "steps": [1]}]
    made = Scene(name="s", system=system, load=load, output={"until": 1, "displacement": ["end"]})
    (peak,) = wavesym.frf(made, low=1, high=high, points=2).peaks()
    with ctx.workprec(200):
        w = arb(repr(high))  # as it is written
        expected = float((w.tan() / w).mid())
    if beside > 0:
        assert peak.amplitude == float("inf")
    else:
        assert peak.low <= expected * (1 + 1e-15)
        assert expected <= peak.high <= expected * (1 + 1e-9)
        assert (peak.frequency, peak.amplitude) == (high, pytest.approx(expected, rel=1e-15))


def test_units_are_those_of_one_unit_of_the_load() -> None:
    """A mass of 100 kg on a rod that weighs nothing to speak of: 1 kN moves it by 1/(k - m w^2)."""
    parts = [
        "fixed",
        {"rod": "1 m", "A": "1 cm^2", "E": "210 GPa", "rho": "1e-6 kg/m^3"},
        {"mass": "100 kg", "name": "bob", "dashpot": "300 N*s/m"},
    ]
    scene = Scene(
        name="bob",
        units={"force": "kN", "length": "mm"},
        system={"type": "chain", "parts": parts},
        load=[{"at": "bob", "times": ["0 s"], "steps": ["3 kN"]}],
        output={"until": "1 us", "displacement": ["bob"]},
    )
    f = np.array([10.0, 70.0, 200.0])
    w = 2 * np.pi * f
    found = wavesym.frf(scene, f)
    per = {"N": 1.0, "kN": 1e3}[found.load_unit]
    assert found.units == ("mm",)
    assert found["displacement@bob"] == pytest.approx(1e3 * per / (2.1e7 - 100 * w**2 + 300j * w), rel=1e-8)
    assert found.frequency_label == "frequency [Hz]"
    assert found.notes[-1].startswith(f"per {found.load_unit} of bob: displacement in mm; right to ")
    row = json.loads(found.json())["outputs"][0]
    assert row["unit"] == "mm"
    assert row["amplitude"] == pytest.approx(
        [abs(complex(*each)) for each in zip(row["real"], row["imag"], strict=True)]
    )
    assert row["phase"] == pytest.approx(np.degrees(-np.arctan2(300 * w, 2.1e7 - 100 * w**2)), rel=1e-8)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["drive_m1"], "there are 2 loads; name one of 0 (M1), 1 (M2)"),
        (["drive_m1", "--load", "M3"], "M3 is no load of this scene; it has 0 (M1), 1 (M2)"),
        (["collision_m4"], "a frequency response needs a [[load]]"),
        (["building_m2", "--from", "2", "--to", "1"], "no band of frequencies"),
        (
            ["building_m2", "--to", "1", "--at", "x.txt"],
            "--at excludes --from, --to and --points; write one or the other",
        ),
        (
            ["building_m2", "--points", "100000000"],
            "--points: 100000000 of them, the limit is 1000000 (fewer points help)",
        ),
    ],
)
def test_a_request_that_is_none_gets_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["frf", *arguments]) == 2
    said = capsys.readouterr()
    assert message in said.err
    assert said.out == ""


def test_the_command_writes_tables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    at = tmp_path / "at.txt"
    at.write_text("# rad per tau\n0.25\n1e0\n")
    assert main(["frf", "building_m2", "--at", str(at)]) == 0
    said = capsys.readouterr()
    rows = list(csv.DictReader(said.out.splitlines()))
    found = wavesym.frf(Scene.from_toml("building_m2"), [0.25, 1.0])
    assert [float(row["omega"]) for row in rows] == [0.25, 1.0]
    assert [float(row["velocity@0.5.imag"]) for row in rows] == found["velocity@0.5"].imag.tolist()
    assert "right to 2.2e-16 of each output's largest amplitude here, proved" in said.err
    out = tmp_path / "out.json"
    assert main(["frf", "building_m2", "--to", "2", "--peaks", "--format", "json", "-o", str(out)]) == 0
    (first, *_) = json.loads(out.read_text())["peaks"]
    assert first["high"] is None
    assert list(found.to_pandas().columns) == list(found.outputs)


@pytest.mark.slow
def test_a_picture_has_a_panel_for_each_quantity(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out.svg"
    assert main(["frf", "building_m2", "-o", str(out)]) == 0
    text = out.read_text()
    assert all(each in text for each in ("strain", "velocity", "displacement", "phase"))
    capsys.readouterr()


def drill_string(parts: int) -> Scene:
    """Rods of alternating impedance between two discs, the lower one in mud."""
    rods = [{"rod": "1/16", "impedance": 1 if k % 2 else "9/8"} for k in range(parts)]
    system = {"type": "chain", "parts": [{"mass": "1/4", "name": "top"}, *rods, {"mass": "1/50", "name": "bit"}]}
    system["parts"][-1]["dashpot"] = "1/20"
    load = [{"at": "bit", "times": [0], "steps": [1]}]
    return Scene(name="drill", system=system, load=load, output={"until": 1, "velocity": ["top", "bit"]})


@pytest.mark.parametrize("low", [1e-9, 1e-3, 0.2])
def test_a_band_that_begins_near_0_under_an_acceleration(low: float) -> None:
    """A ball of frequencies without 0 in it has a square with 0 in it; the ground goes by 1/w^2."""
    parts = [{"motion": "acceleration", "name": "g"}, {"rod": 1}, {"mass": 1, "name": "top"}]
    load = [{"at": "g", "times": [0], "steps": [1]}]
    output = {"until": 5, "displacement": ["top"]}
    scene = wavesym.Scene(name="s", system={"type": "chain", "parts": parts}, load=load, output=output)
    peak = wavesym.frf(scene, [low, 0.5]).peaks()["displacement@top"]
    largest = max(1 / (w * w * abs(np.cos(w) - w * np.sin(w))) for w in (low, 0.5))
    assert peak.low <= largest * (1 + 1e-12)
    assert largest * (1 - 1e-12) <= peak.high <= largest * (1 + 1e-9)


FLAT = {
    "an end that goes as it is told to": ([{"motion": "acceleration", "name": "j"}, {"rod": 1}, {"mass": 3}], 1),
    "waves that do not come back": (
        ["absorbing", {"rod": 1}, {"joint": True, "name": "j"}, {"rod": 1}, "absorbing"],
        "1/2",
    ),
}


@pytest.mark.quick(2)
@pytest.mark.parametrize("band", [(0.0, 0.5), (0.1, 7.0), (0.3, 0.30000000001)])
@pytest.mark.parametrize("name", FLAT)
def test_an_amplitude_that_is_the_same_everywhere_is_found_at_once(
    name: str, band: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It was halved down to 1e-10 everywhere, and called infinite at frequencies that the end holds."""
    monkeypatch.setattr(resonance, "_MOST", 4000)
    parts, amplitude = FLAT[name]
    outputs = {"acceleration": ["j"]} if amplitude == 1 else {"velocity": ["j", "3/2"], "strain": ["1/2"]}
    load = [{"at": "j", "times": [0], "steps": [1]}]
    scene = Scene(name="flat", system={"type": "chain", "parts": parts}, load=load, output={"until": 5, **outputs})
    for peak in wavesym.frf(scene, list(band)).peaks():
        assert peak.low <= float(Fraction(amplitude)) <= peak.high < peak.low * (1 + 1e-9)
        assert peak.frequency == pytest.approx(band[0], abs=1e-11)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("low", "high"), [(0.0, 1e6), (1e-6, 1e6), (1e-6, 1e8), (1e-3, 1e6)])
def test_no_resonance_is_missed_in_a_band_that_is_very_wide(low: float, high: float) -> None:
    """The ball of a part whose ends differ by 2^30 and more has 0 in it, where no slope and no bend are known."""
    parts = [{"mass": 2, "name": "a"}, {"spring": 3}, {"mass": 1, "name": "b", "dashpot": "1/2"}]
    load = [{"at": "a", "times": [0], "steps": [1]}]
    scene = Scene(
        name="s", system={"type": "chain", "parts": parts}, load=load, output={"until": 5, "acceleration": ["b"]}
    )
    w = np.linspace(2, 2.2, 200_001)
    largest = np.abs(3 * w**2 / ((3 - 2 * w**2) * (3 - w**2 + 0.5j * w) - 9)).max()
    (peak,) = wavesym.frf(scene, [low, high]).peaks()
    assert peak.low <= largest * (1 + 1e-9)
    assert largest <= peak.high <= largest * (1 + 1e-9)


@pytest.mark.slow
def test_an_acceleration_beside_a_velocity_without_limit_at_0() -> None:
    """Times i w a ball near 0 had 0 in it, and its power series no inverse: a traceback."""
    parts = [{"motion": "acceleration", "name": "a"}, {"rod": 1}, {"joint": True, "name": "b"}]
    parts += [{"rod": 2, "impedance": 2}, "absorbing"]
    load = [{"at": "a", "times": [0], "steps": [1]}]
    output = {"until": 5, "velocity": ["b"], "acceleration": ["b"]}
    scene = Scene(name="s", system={"type": "chain", "parts": parts}, load=load, output=output)
    velocity, acceleration = wavesym.frf(scene, [0.0, 30.0]).peaks()
    assert (velocity.frequency, velocity.high) == (0.0, np.inf)
    # what arrives at rod 2 never comes back: 1/(cos w + i 2 sin w), which is largest where cos w = 1
    assert acceleration.low <= 1 <= acceleration.high < 1 + 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("parts", [14, 50])
def test_peaks_of_many_parts_against_transfer_matrices(parts: int) -> None:
    """(u, force) from the free top to the bit, in doubles, at 40 000 frequencies."""
    w = np.linspace(0.5, 15, 40_001)
    u, force = np.ones(len(w), complex), -(w**2) / 4 * np.ones(len(w), complex)
    for k in range(parts):
        z = 1 if k % 2 else 9 / 8
        c, s = np.cos(w / 16), np.sin(w / 16)
        u, force = u * c + force * s / (z * w), force * c - z * w * u * s
    held = force - w**2 / 50 * u + 1j * w / 20 * u
    right = {"velocity@top": np.abs(w / held), "velocity@bit": np.abs(w * u / held)}
    for peak in wavesym.frf(drill_string(parts), [0.5, 15.0]).peaks():
        seen = right[peak.name].max()
        assert peak.low <= peak.amplitude <= peak.high < peak.low * (1 + 1e-9)
        assert seen <= peak.high * (1 + 1e-12)
        assert peak.amplitude == pytest.approx(seen, rel=1e-4)


def test_taylor_polynomials_enclose_a_response_and_its_slopes() -> None:
    lowered = lower(drill_string(6), in_time=False)
    transfer = Transfer(lowered, harmonic_load(lowered, ["bit:step"], None))
    with ctx.workprec(128):
        for middle, radius in ((2.0, 0.03), (7.5, 0.01), (11.0, 0.002)):
            ball = arb(middle, radius)
            fractions = amplitude_polynomials.transfer_fractions(transfer, ball)
            assert fractions is not None
            around = [
                amplitude_polynomials.coefficients(each, 3)
                for each in amplitude_polynomials.power_series(transfer, ball, fractions)
            ]
            for part in (-1, -0.5, 0.3, 1):
                w = acb(arb(middle + part * radius))
                here = [amplitude_polynomials.coefficients(each, 3) for each in transfer(acb_series([w, 1], prec=3))]
                for known, exact in zip(around, here, strict=True):
                    assert all(known[k].contains(exact[k].mid()) for k in range(3))
                    assert known[0].is_finite()
                    assert abs(known[0]).rad() < 0.1 * abs(exact[0])


def lossy(loss: object, *parts: object, **outputs: list[object]) -> Scene:
    rods = [{"rod": 1, "loss": loss}, {"rod": 1, "impedance": 2, "loss": "1/10"}]
    load = [{"at": "g", "times": [0], "steps": [1]}]
    system = {"type": "chain", "parts": [*parts[:1], *rods, *parts[1:]]}
    return Scene(name="lossy", system=system, load=load, output={"until": 1, **outputs})


def test_rods_with_a_loss_have_a_complex_modulus() -> None:
    """Two layers on a shaken base, and on a pushed joint, by transfer matrices in complex doubles."""
    taken = {"displacement": [2, "1/2"], "strain": ["1/4", "3/2"], "force": ["1/4", "3/2"]}
    w = np.array([0.4, 1.3, 2.2])
    shaken = lossy("1/50", {"motion": "acceleration", "name": "g"}, "free", **taken)
    pushed = lossy("1/50", {"joint": True, "dashpot": "1/3", "name": "g"}, "free", **taken)
    layers = [(1.0, 1 + 0.02j), (2.0, 1 + 0.1j)]

    def at(place: float) -> tuple[np.ndarray, np.ndarray]:
        """(u, du/dx) at a place where the free surface moves by 1; the modulus is Z (1 + i loss)."""
        u, force, x = np.ones(3, complex), np.zeros(3, complex), 2.0
        for z, modulus in reversed(layers):
            k, e = w / np.sqrt(modulus), z * modulus
            way = min(1.0, x - place)
            u, force = (
                u * np.cos(k * way) - force * np.sin(k * way) / (e * k),
                force * np.cos(k * way) + (e * k * u * np.sin(k * way)),
            )
            x -= way
            if x <= place:
                return u, force / e
        raise AssertionError

    base, slope = at(0.0)
    right = {f"displacement@{p}": at(float(Fraction(p)))[0] for p in ("2", "1/2")}
    for p, (z, modulus) in zip(("1/4", "3/2"), layers, strict=True):
        right[f"strain@{p}"] = at(float(Fraction(p)))[1]
        right[f"force@{p}"] = z * modulus * right[f"strain@{p}"]
    by_motion, by_force = wavesym.frf(shaken, w), wavesym.frf(pushed, w)
    held = -layers[0][0] * layers[0][1] * slope + 1j * w / 3 * base
    for name, value in right.items():
        assert by_motion[name] == pytest.approx(value / base / -(w**2), rel=1e-12)
        assert by_force[name] == pytest.approx(value / held, rel=1e-12)


def test_a_loss_is_for_frequency_responses_alone() -> None:
    scene = lossy("2 %", {"joint": True, "name": "g"}, "free", velocity=[1])
    assert scene == lossy("1/50", {"joint": True, "name": "g"}, "free", velocity=[1])
    for refused in (wavesym.run, wavesym.summary, wavesym.modes, wavesym.evaluator):
        with pytest.raises(UnservedError, match="a loss of a rod is for frequency responses"):
            refused(scene)
    damped = scene.with_({"system.damping": "1/20"})
    with pytest.raises(UnservedError, match="rods have a loss already; write one of both"):
        wavesym.frf(damped, [0.5])
    peak = wavesym.frf(scene, [0.5, 2.5]).peaks()["velocity@1"]
    sampled = np.abs(wavesym.frf(scene, np.linspace(0.5, 2.5, 801).round(6))["velocity@1"]).max()
    assert peak.low <= peak.amplitude <= peak.high
    assert peak.amplitude == pytest.approx(sampled, rel=1e-4)


def test_the_command_serves_a_loss(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """That of a layer on a dashpot: the notes that it puts are those of a scene whose loads do not act."""
    (tmp_path / "lossy.toml").write_text("""
        name = "lossy"
        load = [{ at = "g", times = [0], steps = [1] }]
        output = { until = 1, velocity = [1] }
        system.type = "chain"
        system.parts = [{ joint = true, dashpot = 4, name = "g" }, { rod = 1, loss = "5 %" }, "free"]
    """)
    assert main(["frf", str(tmp_path / "lossy.toml"), "--from", "1", "--to", "2", "--points", "2"]) == 0
    rows = capsys.readouterr().out.splitlines()[1:]
    w = np.array([1.0, 2.0])
    root = np.sqrt(1 + 0.05j)  # of the modulus, and so the speed
    free = 1j * w / np.cos(w / root) / (4j * w - w * root * np.tan(w / root))
    for row, right in zip(rows, free, strict=True):
        assert complex(*map(float, row.split(",")[1:])) == pytest.approx(right, rel=1e-12)


def test_without_a_band_it_goes_to_the_fifth_mode_without_dashpots() -> None:
    """Of soil on rock, which nothing but a dashpot holds, the first of these has no strain, and the fifth 4 pi."""
    scene = Scene(
        name="soil",
        system={
            "type": "chain",
            "parts": [{"motion": "acceleration", "name": "rock"}, {"dashpot": 3}, {"rod": 1}, "free"],
        },
        load=[{"at": "rock", "spacing": 1, "samples": [0, 1, 0]}],
        output={"until": 1, "velocity": [1]},
    )
    frequency = wavesym.frf(scene, points=9).frequency
    assert frequency[0] > 0
    assert frequency[-1] == float(f"{4 * np.pi:.3g}")


@pytest.mark.parametrize("seed", range(4))
def test_a_polynomial_is_below_what_is_above_its_top_and_not_below_what_is_not(seed: int) -> None:
    """(1 + a s)/(1 + b s + c s^2) near its top, which no bound by absolute values of coefficients tells from more."""
    draw = np.random.default_rng(seed)
    a, b, c = draw.normal(size=3) + 1j * draw.normal(size=3)
    powers = [[acb(1.0), acb(a)], [acb(1.0), acb(b), acb(c)]]
    half = 0.05
    s = np.linspace(-half, half, 400_001)
    largest = float((np.abs((1 + a * s) / (1 + b * s + c * s * s)) ** 2).max())
    with ctx.workprec(200):
        fractions = amplitude_polynomials.TransferFractions([powers[0]], powers[1])
        assert fractions.stays_below(0, arb(largest * (1 + 1e-9)), arb(half))
        assert not fractions.stays_below(0, arb(largest * (1 - 1e-9)), arb(half))


def test_equal_peaks_of_many_parts_take_few_intervals(monkeypatch: pytest.MonkeyPatch) -> None:
    """Resonances of nearly one height were followed to where their tops are points."""
    counts = [0]

    def counted(transfer: object, w: arb) -> object:
        counts[0] += 1
        return fractions(transfer, w)

    fractions = amplitude_polynomials.transfer_fractions
    monkeypatch.setattr(resonance, "transfer_fractions", counted)
    (_, bit) = wavesym.frf(drill_string(14), [0.5, 15.0]).peaks()
    assert bit.low <= 20.0 * (1 + 1e-12)
    assert bit.high >= 20.0 * (1 - 1e-9)
    assert counts[0] < 150
