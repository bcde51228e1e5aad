"""Response spectra against closed forms, a matrix exponential, and an integrator."""

from __future__ import annotations

from itertools import pairwise
from math import cos, exp, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import wavesym
from wavesym.cli import main
from wavesym.results import spectrum
from wavesym.results.spectrum import PER_DECADE, _peaks, spectra
from wavesym.scene import Scene, builtin_text, lower

PERIODS = np.array([0.5, 1.0, 1.7, 4.0, 11.0])


def peaks(values, step, damping, periods=PERIODS):
    return _peaks([np.asarray([values])], [step], periods, damping)[0]


@pytest.mark.parametrize("damping", [0.0, 0.02, 0.3, 0.9])
def test_a_step(damping):
    """1 + exp(-pi z / sqrt(1 - z^2)), whatever the period."""
    found = peaks(np.ones(4001), 0.01, damping)
    assert found == pytest.approx([1 + exp(-pi * damping / sqrt(1 - damping**2))] * len(PERIODS), rel=2e-5)


@pytest.mark.parametrize("period", [0.6, 1.0, 1.7, 3.0])
def test_a_sine_pulse(period):
    """Of a pulse sin(pi t), 0 < t < 1, in closed form: the shock spectrum of an undamped oscillator."""
    step = 1 / 512
    t = np.arange(0, 6, step)
    found = peaks(np.where(t <= 1, np.sin(pi * t), 0.0), step, 0.0, np.array([period]))[0]
    w = 2 * pi / period
    beta = pi / w
    fine = np.linspace(0, 1, 20001)
    during = (np.sin(pi * fine) - beta * np.sin(w * fine)) / (1 - beta**2)
    end, slope = during[-1], pi * (cos(pi) - cos(w)) / (1 - beta**2)
    assert found == pytest.approx(max(np.abs(during).max(), sqrt(end**2 + (slope / w) ** 2)), rel=2e-5)


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.5])
@pytest.mark.parametrize("period", [0.31, 2.0, 300.0])
def test_a_broken_line_is_stepped_exactly(damping, period):
    """Against exp of the matrix of the oscillator with a and its slope as two more states."""
    values, step, w = np.array([0.3, -1.0, 0.7, 0.1, -0.4, 0.0]), 0.11, 2 * pi / period
    matrix = np.array([[0, 1, 0, 0], [-w * w, -2 * damping * w, -1, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
    moved, state = [0.0], np.zeros(2)
    for before, after in pairwise(values):
        state = (expm(matrix * step) @ [*state, before, (after - before) / step])[:2]
        moved.append(state[0])
    tops = spectrum._tops(np.array([*[0.0] * 2, *moved[1:]])[:, None])[0]
    assert peaks(values, step, damping, np.array([period]))[0] == pytest.approx(w * w * tops, rel=1e-10)


def test_published_peaks_on_the_ground_of_el_centro():
    """Chopra's 2.674, 5.966 and 7.465 in, 2 % damped, are read at samples; between them it is up to half a % more."""
    file = Path(wavesym.__file__).parents[1] / "examples" / "records" / "elcentro_1940_ns_peknold.at2"
    record = [0.0, *(float(word) for line in file.read_text().splitlines()[4:] for word in line.split())]
    parts, periods = 64, np.array([0.5, 1.0, 2.0])
    ground = np.interp(np.arange((len(record) - 1) * parts + 1) / parts, np.arange(len(record)), record)
    moved = peaks(ground * 9.80665 / 0.0254, 0.02 / parts, 0.02, periods) * (periods / (2 * pi)) ** 2
    assert moved == pytest.approx([2.68706, 5.96716, 7.46629], abs=6e-6)


def floor(until=40, **changes):
    """A body at the end of a rod that nothing comes back from: under a step it moves as exp(-tau/M)/M."""
    parts = [{"mass": "3/2", "name": "floor"}, {"rod": 1}, "absorbing"]
    load = {"at": "floor", "times": [0, "5/3"], "steps": [1, -2]}
    fields = {"name": "room", "system": {"type": "chain", "parts": parts}, "load": [load]}
    return Scene(**fields, output={"until": until, "acceleration": ["floor"]} | changes)


@pytest.mark.quick(1)
@pytest.mark.parametrize("damping", [0.05, 0.2])
def test_a_floor_of_a_scene(damping):
    """Its jump is no ramp of one step; every spectrum is within the change that is told of it."""
    found = spectra(lower(floor()), damping)
    from scipy.integrate import solve_ivp  # slow to import

    mass = 1.5

    def acceleration(t):
        return (np.exp(-t / mass) - np.where(t >= 5 / 3, 2 * np.exp(-(t - 5 / 3) / mass), 0)) / mass

    assert found.outputs == tuple(found) == ("acceleration@floor",)
    assert found["acceleration@floor"].tolist() == found.values[0].tolist()
    assert found.change < 2e-3
    for k in (0, len(found.periods) // 2, len(found.periods) - 1):
        w = 2 * pi / found.periods[k]
        largest, state = 0.0, np.zeros(2)
        for low, high in ((0, 5 / 3), (5 / 3, 40)):
            solved = solve_ivp(
                lambda t, y, w=w, e=(1e-12 if low else -1e-12): [
                    y[1],
                    -2 * damping * w * y[1] - w * w * y[0] - acceleration(t + e if t in (5 / 3,) else t),
                ],
                (low, high - 1e-12),
                state,
                rtol=1e-8,
                atol=1e-11,
                max_step=found.periods[k] / 40,
                dense_output=True,
            )
            state = solved.y[:, -1]
            largest = max(largest, np.abs(solved.sol(np.linspace(low, high - 1e-12, 40001))[0]).max())
        assert found.values[0, k] == pytest.approx(w * w * largest, abs=found.change * found.values.max())


@pytest.mark.slow
def test_periods_are_the_same_numbers_in_all_scenes():
    short, long = (spectra(lower(floor(until)), 0.05).periods for until in (30, 40))
    assert short == pytest.approx(long[: len(short)], rel=1e-15)
    assert short[0] >= 2
    assert long[-1] <= 20
    assert np.diff(np.log10(long)) == pytest.approx(1 / PER_DECADE)


def test_too_long_a_step_is_seen_in_what_is_told(monkeypatch):
    fine = spectra(lower(floor()), 0.05)
    monkeypatch.setattr(spectrum, "_PER_PERIOD", 3)
    monkeypatch.setattr(spectrum, "_PER_STEP", 1)
    monkeypatch.setattr(spectrum, "_LEAST", 1)
    coarse = spectra(lower(floor()), 0.05)
    assert coarse.change > 20 * fine.change
    assert np.abs(coarse.values - fine.values).max() > 3 * fine.change * fine.values.max()
    assert np.abs(coarse.values - fine.values).max() < coarse.change * fine.values.max()


def test_a_jump_that_is_stepped_over_is_seen(monkeypatch):
    right = spectra(lower(floor()), 0.05)
    monkeypatch.setattr(spectrum, "jumps", lambda _: [])
    monkeypatch.setattr(spectrum, "_LEAST", 1)
    wrong = spectra(lower(floor()), 0.05)
    assert np.abs(wrong.values - right.values).max() > 3 * right.change * right.values.max()


def test_the_command_prints_csv_and_draws(tmp_path, capsys):
    scene = tmp_path / "room.toml"
    scene.write_text(
        'name = "room"\n[system]\ntype = "building"\nm = 2\nbase = "ground"\nkappa = [1, 1, 1]\n'
        '[[load]]\nspacing = "1/2"\nsamples = [0, 1, -1, 0]\n[output]\nuntil = 12\nacceleration = [1, 2]\n'
    )
    picture = tmp_path / "floors.svg"
    assert main(["spectrum", str(scene), "--damping", "0.02"]) == 0
    captured = capsys.readouterr()
    header, *rows = captured.out.splitlines()
    columns = [f"pseudo-acceleration of acceleration@{k} at damping 0.02" for k in (1, 2)]
    assert header == ",".join(["period", *columns])
    found = spectra(lower(Scene.from_toml(scene)), 0.02)
    assert [[float(x) for x in row.split(",")] for row in rows] == np.vstack([found.periods, found.values]).T.tolist()
    assert "damping 0.02" in captured.err
    assert main(["spectrum", str(scene), "--damping", "0.02", "-o", str(picture)]) == 0
    drawn = picture.read_text()
    assert "<svg" in drawn
    assert main(["spectrum", str(scene), "--damping", "0.02", "-o", str(picture)]) == 0
    assert picture.read_text() == drawn
    table = tmp_path / "floors.csv"
    assert main(["spectrum", str(scene), "--damping", "0.02", "-o", str(table)]) == 0
    assert table.read_text() == captured.out
    assert capsys.readouterr().out == ""  # what is asked for as a file goes there


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["building_m2"], "output.acceleration: none, and a response spectrum needs one"),
        (["building_m2", "--damping", "1"], "--damping"),
        (["building_m2", "-o", "floors.txt"], "floors.txt"),
    ],
)
def test_a_wrong_request_is_one_line(arguments, said, capsys):
    assert main(["spectrum", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert said in captured.err
    assert len(captured.err.splitlines()) == 1


def test_too_short_a_horizon_is_refused():
    with pytest.raises(
        wavesym.WavesymError, match=r"^output.until: 3 tau is too short for a response spectrum; write 4.* tau"
    ):
        spectra(lower(floor(3)), 0.05)


def test_a_scene_without_accelerations_is_refused_by_its_file(tmp_path, capsys):
    file = tmp_path / "mine.toml"
    file.write_text(builtin_text("building_m2"))
    assert main(["spectrum", str(file)]) == 2
    expected = "output.acceleration: none, and a response spectrum needs one; write acceleration = [PLACE]"
    assert capsys.readouterr().err == f"{file}: {expected}\n"


def test_undamped_oscillators_swing_on():
    assert peaks([1, 1, *[0] * 999], 0.05, 0.0, np.array([2.0]))[0] == pytest.approx(2 * sin(pi / 2 * 0.075), rel=2e-2)
