"""Loads of a given shape: how far polynomials and lines are from the shape, and what comes out of a chain."""

from __future__ import annotations

import json
from fractions import Fraction
from math import exp, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import wavesym
from wavesym import api
from wavesym.documents.summary import summary_text
from wavesym.errors import CostError, SceneError
from wavesym.fields.shapes import ShapedLoad
from wavesym.numbers.doubles import rational
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower

PACE = {"sine": "frequency", "half-sine": "duration", "exponential": "duration", "ricker": "frequency"}


def scene(tolerance: object = "1/1000000", until: object = 3, **load: object) -> Scene:
    """A rod without end, so that the force in it is the load a while ago."""
    parts = [{"joint": True, "name": "head"}, {"rod": 1}, "absorbing"]
    return Scene(
        name="rod",
        system={"type": "chain", "parts": parts},
        load=[{"at": "head", **load}],
        output={"until": until, "force": ["1/2"], "tolerance": tolerance},
    )


def value(shape: str, pace: float, t: float) -> float:
    """A load of amplitude 1 at a time after its start, written down once more."""
    match shape:
        case "sine":
            return sin(2 * pi * pace * t)
        case "half-sine":
            return sin(pi * t / pace) if t < pace else 0.0
        case "exponential":
            return exp(-t / pace)
    a = pi * pace * (t - 2 / pace)
    return (1 - 2 * a * a) * exp(-a * a)


@given(
    st.sampled_from(sorted(PACE)),
    st.sampled_from(["1/3", "1", "7/2", "0.3000001"]),
    st.sampled_from(["0", "1/7", "1"]),
    st.sampled_from([Fraction(1, 100), Fraction(1, 10_000)]),
)
def test_the_force_in_a_rod_is_the_shape_within_what_it_says(
    shape: str, pace: str, start: str, tolerance: Fraction
) -> None:
    written = scene(tolerance, **{"shape": shape, "amplitude": -2, PACE[shape]: pace, "start": start})
    begin = 0.5 + float(Fraction(start))
    tau = np.linspace(0, 3, 1201)
    # on the way to where an exponential jumps, rounding of tau decides
    tau = tau[np.abs(tau - begin) > 1e-9]
    expected = [2 * value(shape, float(Fraction(pace)), t - begin) if t > begin else 0.0 for t in tau]
    for made, most in ((written, Fraction(2, 10**15)), (written.in_lines, tolerance / 2)):
        (load,) = made.load
        assert isinstance(load, ShapedLoad)
        assert load.error <= most
        off = np.abs(wavesym.run(made, tau).values[0] - expected)
        assert off.max() <= 2 * float(load.error) + 1e-13


@pytest.mark.parametrize("straight", [True, False])
def test_samples_too_far_apart_are_noticed(straight: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """With half as many samples the error is above what is said; that of polynomials is where doubles show it."""
    made = scene("1/100", shape="sine", amplitude=1, frequency=1)
    made = made.in_lines if straight else made
    (load,) = made.load
    assert isinstance(load, ShapedLoad)
    said, step = float(load.error), load.step
    assert said < (1e-2 if straight else 2e-17)
    monkeypatch.setattr(ShapedLoad, "step", property(lambda self: 2 * step))
    coarse = scene("1/100", shape="sine", amplitude=1, frequency=1)
    tau = np.linspace(0.5, 3, 2000)
    off = np.abs(wavesym.run(coarse.in_lines if straight else coarse, tau).values[0] + np.sin(2 * pi * (tau - 0.5)))
    assert off.max() > max(said, 1e-14)


@pytest.mark.parametrize("shape", sorted(PACE))
def test_a_body_under_a_shape_to_1e_13(shape: str) -> None:
    """Its values, and those of the program that is made, against a sum over its unit responses; straight lines would
    take tens of millions of samples."""
    parts = [{"mass": 1, "name": "ram"}, {"rod": 1}, "absorbing"]
    made = Scene(
        name="ram",
        system={"type": "chain", "parts": parts},
        load=[{"at": "ram", "shape": shape, "amplitude": 1, PACE[shape]: "7/5"}],
        output={"until": 3, "velocity": ["ram"], "tolerance": "1e-13"},
    )
    tau = np.linspace(0, 3, 61)
    # v' + v = p: Gauss's rule on the two sides of where half a sine ends
    nodes, weights = np.polynomial.legendre.leggauss(60)
    expected = []
    for t in tau:
        total = 0.0
        for low, high in ((0.0, min(t, 1.4)), (min(t, 1.4), t)):
            s = (low + high) / 2 + (high - low) / 2 * nodes
            pushes = np.array([value(shape, 1.4, each) for each in s])
            total += (high - low) / 2 * float(np.sum(weights * np.exp(s - t) * pushes))
        expected.append(total)
    largest = np.abs(expected).max()
    for values in (wavesym.run(made, tau).values[0], api.program(made, Request()).evaluate(tau)[0]):
        assert np.abs(values - expected).max() <= 1e-13 * largest + 2e-15


def test_a_pile_under_half_a_sine() -> None:
    """PileWave.jl, "Simple sine wave": c = 5000 m/s, radius 0.2 m, 20 MPa for 1 ms at the head, the toe fixed.

    At 4 ms the force is F sin(pi z/5) for z < 5 m: 1 477 265.464392366 N at 1 m and 4 m, F = 2 513 274.1228718353 N.
    """
    rod = {"rod": "10 m", "A": "0.12566370614359172 m^2", "E": "30 GPa", "rho": "1200 kg/m^3"}
    pile = Scene(
        name="pile",
        units={},
        system={"type": "chain", "parts": [{"joint": True, "name": "head"}, rod, "fixed"]},
        load=[{"at": "head", "shape": "half-sine", "amplitude": "2513274.1228718353 N", "duration": "1 ms"}],
        output={"until": "5 ms", "force": ["1 m", "2.5 m", "4 m"], "tolerance": "1/1000000"},
    )
    forces = wavesym.run(pile, [0.004]).values[:, 0]
    assert np.abs(forces) == pytest.approx([1477265.464392366, 2513274.1228718353, 1477265.464392366], rel=1e-15)
    (note,) = lower(pile).labels.notes
    assert note == (
        "load[0]: half-sine as 2 polynomials of degree 16 through 33 samples, within 1.0e-17 of its amplitude, "
        "one every 0.0005 s"
    )


@pytest.mark.parametrize(
    ("load", "message"),
    [
        (
            {"shape": "saw", "amplitude": 1},
            'load[0].shape: "saw" is not a shape',
        ),
        ({"shape": "sine", "amplitude": 1}, "load[0].frequency: missing, and a sine has it; write a positive number"),
        (
            {"shape": "sine", "amplitude": 1, "frequency": 0},
            "load[0].frequency: 0 is not positive; write a number above 0",
        ),
        (
            {"shape": "sine", "amplitude": 1, "frequency": 1, "duration": 1},
            "load[0].duration: not of a sine; write frequency",
        ),
        ({"shape": "sine", "frequency": 1}, "load[0].amplitude: missing"),
        (
            {"shape": "sine", "amplitude": 1, "frequency": 1, "start": -1},
            "load[0].start: -1 is before the start; write a time of 0 or later",
        ),
    ],
)
def test_a_wrong_shape_gets_one_line(load: dict[str, object], message: str) -> None:
    with pytest.raises(SceneError) as caught:
        scene(**load)
    assert message in str(caught.value)


def test_too_many_samples_are_refused_where_they_would_act_alone() -> None:
    fine = scene("1e-10", shape="sine", amplitude=1, frequency=1)
    with pytest.raises(
        CostError,
        match=r"load: 1332901 samples of a sine .* \(output.tolerance = 7.1e-08 or more, or fewer periods help",
    ):
        wavesym.run(fine.in_lines)
    with pytest.raises(CostError, match=r"load: 114241 samples of a sine, the limit is 50000 \(fewer periods help\)"):
        wavesym.run(scene(shape="sine", amplitude=1, frequency=1000))
    assert wavesym.frf(fine, [2.0])["force@1/2"] == pytest.approx(-np.exp(-1j), rel=1e-15)


@pytest.mark.parametrize("shape", sorted(PACE))
def test_a_scene_without_a_tolerance_takes_one_that_few_samples_meet(shape: str) -> None:
    """The usual one was refused for most shapes: for millions of samples."""
    written = scene("1e-10", shape=shape, amplitude=1, **{PACE[shape]: 1}).model_dump()
    del written["output"]["tolerance"]
    made = Scene(**written).in_lines
    (load,) = made.load
    assert isinstance(load, ShapedLoad)
    assert len(load.samples) <= 2000
    assert "tolerance" not in made.model_dump()["output"]
    assert Scene(**made.model_dump()).in_lines == made
    assert 1e-10 < made.tolerance <= Fraction(1, 100)
    model = lower(made)
    assert model.tolerance == rational(made.tolerance)
    tau = np.linspace(0, 3, 301)
    off = max(
        abs(-value(shape, 1, t - 0.5) * (t >= 0.5) - f)
        for t, f in zip(tau, wavesym.run(made, tau).values[0], strict=True)
    )
    assert off <= float(made.tolerance)
    (note,) = (each for each in api.scene_notes(made) if "none is written" in each)
    assert f"output.tolerance is {float(made.tolerance):g}" in note
    longer = made.with_({"output.until": 30}).in_lines
    assert longer.tolerance >= made.tolerance
    assert len(longer.load[0].samples) <= 2000
    assert Scene(**written).tolerance == Fraction(1, 10**10)
    fine = scene("1e-6", shape=shape, amplitude=1, **{PACE[shape]: 1}).in_lines
    assert lower(fine).tolerance == rational(Fraction(1, 10**6))


def test_a_shape_is_kept_as_it_was_written() -> None:
    made = scene("1/1000", shape="ricker", amplitude="1/3", frequency="5/2")
    again = Scene(**made.model_dump())
    assert again == made
    assert lower(again).labels.sha256 == lower(made).labels.sha256
    assert repr(made) == "Scene('rod', chain, 1 rod, ricker load, until tau = 3)"
    louder = made.with_({"load[0].amplitude": "2/3"})
    tau = np.linspace(0, 3, 50)
    assert wavesym.run(louder, tau).values == pytest.approx(2 * wavesym.run(made, tau).values)


@pytest.mark.slow
@pytest.mark.parametrize("shape", sorted(PACE))
def test_drives_and_buildings_take_shapes(shape: str) -> None:
    drive = Scene.from_toml("drive_m1").model_dump()
    drive["load"] = [{"body": 1, "shape": shape, "amplitude": 1, PACE[shape]: 1}]
    drive["output"]["tolerance"] = "1/100"
    assert np.isfinite(wavesym.run(Scene(**drive), [2.0]).values).all()
    building = Scene.from_toml("building_m2").model_dump()
    building["load"] = [{"shape": shape, "amplitude": 1, PACE[shape]: 1}]
    building["output"]["tolerance"] = "1/100"
    assert np.isfinite(wavesym.run(Scene(**building), [2.0]).values).all()


@pytest.mark.parametrize(("delays", "step"), [(("1/7", "2/7"), Fraction(1, 7)), (("1/7", "100003/700001"), None)])
def test_samples_meet_where_travel_times_have_a_common_measure(delays: tuple[str, str], step: Fraction | None) -> None:
    """A multiple of it, as here they may be 0.18 apart; of one that is fine by chance a part of the period."""
    parts = [{"joint": True, "name": "head"}, *({"rod": 1, "speed": 1 / Fraction(each)} for each in delays), "fixed"]
    made = Scene(
        name="rods",
        system={"type": "chain", "parts": parts},
        load=[{"at": "head", "shape": "sine", "amplitude": 1, "frequency": "1/2"}],
        output={"until": 3, "force": ["1/2"], "tolerance": "1/6"},
    )
    (load,) = made.in_lines.load
    assert isinstance(load, ShapedLoad)
    assert load.step == (step or Fraction(1, 10))
    assert load.error <= Fraction(1, 24) + Fraction(1, 2**90)
    (curved,) = made.load
    assert curved.step == (5 * step if step else Fraction(2, 3))


def test_a_summary_says_of_what_its_bound_is() -> None:
    """It said that extremes were right to 1e-16, proved: those of the lines, not of the shape."""
    found = wavesym.summary(scene("1/100", shape="half-sine", amplitude=1, duration=1).in_lines)
    of_lines = "of straight lines between 41 samples of the half-sine load[0], within 0.00077 of its amplitude"
    assert str(found).splitlines()[-1].endswith(f"proved, {of_lines}")
    (acting,) = json.loads(summary_text(found, "json"))["shapes"]
    error = pytest.approx(pi**2 / 12800)
    assert acting == {"load": "load[0]", "shape": "half-sine", "degree": 1, "samples": 41, "error": error}
    assert "shapes" not in json.loads(summary_text(wavesym.summary(Scene.from_toml("drive_m1")), "json"))


def test_half_a_sine_in_units_takes_few_samples() -> None:
    """1581 of them, each of which meets the joints again and again, took a summary 100 s."""
    parts = [{"mass": "2 t", "name": "ram"}, {"rod": "12 m", "E": "35 GPa", "A": "0.1225 m^2", "rho": "2450 kg/m^3"}]
    made = Scene(
        name="pile",
        units={"time": "ms"},
        system={"type": "chain", "parts": parts},
        load=[{"at": "ram", "shape": "half-sine", "amplitude": "500 kN", "duration": "5 ms"}],
        output={"until": "20 ms", "force": ["1 m"]},
    )
    (load,), (lines,) = made.load, made.in_lines.load
    assert isinstance(load, ShapedLoad)
    assert isinstance(lines, ShapedLoad)
    assert load.count == 33
    assert lines.count <= 500
    assert made.in_lines.tolerance == Fraction(1, 20_000)
