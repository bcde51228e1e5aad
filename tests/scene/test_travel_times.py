"""Layers as they were measured under a record: speeds adjusted for a common measure, and damping in place of a loss."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st

import wavesym
from wavesym import Scene, SceneError, ToleranceError, UnservedError, api
from wavesym.cli import main
from wavesym.documents.inspection.units import in_units
from wavesym.mechanics.network import Bar
from wavesym.mechanics.travel_times import FINEST, adjust_speeds, percent, speed_change
from wavesym.numbers.doubles import common_measure
from wavesym.pictures.page.headline import first_modes, neglected_effects
from wavesym.programs.making import make
from wavesym.scene import lower
from wavesym.scene.explicit_text import explicit_text

LAYERS = (("12 m", 451, 902), ("7.3 m", 333, 632.7), ("5 m", 210, 357))  # m, m/s, kN s/m
TWO_RODS = """
name = "two"
units = { kind = "shear" }
[system]
type = "chain"
speed_adjustment = "1 %"
parts = [{ rod = "12 m", speed = "451 m/s", impedance = "902 kN*s/m" },
  { rod = "7.3 m", speed = "333 m/s", impedance = "633 kN*s/m" }, { mass = "3 t", name = "surface" }]
[[load]]
at = "0 m"
times = ["0 s"]
steps = ["1 kN"]
[output]
until = "0.1 s"
velocity = ["surface"]
"""
ROCK = 2400.0  # kN s/m
STEP = 0.02  # s
SAMPLES = (0, *np.sin(np.arange(1, 60) ** 1.5 / 7).round(3).tolist(), 0)


def column(
    base: Sequence[object] = ({"dashpot": f"{ROCK} kN*s/m"},),
    rod: dict[str, str] | None = None,
    until: str = "4 s",
    **system: object,
) -> Scene:
    """Layers on rock, under what its outcrop does."""
    rods = [
        {"rod": length, "speed": f"{speed} m/s", "impedance": f"{z} kN*s/m", **(rod or {})}
        for length, speed, z in LAYERS
    ]
    return Scene(
        name="column",
        units={"kind": "shear"},
        system={
            "type": "chain",
            "parts": [{"motion": "acceleration", "name": "outcrop"}, *base, *rods, "free"],
            **system,
        },
        load=[{"at": "outcrop", "spacing": f"{STEP} s", "samples": list(SAMPLES), "unit": "m/s^2"}],
        output={"until": until, "tolerance": 1e-4, "velocity": ["24.3 m"]},
    )


def by_transfer_function(times: np.ndarray) -> np.ndarray:
    """The surface's velocity by the transfer function of layers (Kramer, 7.2) and Fourier sums, as engineers have it.

    With u = A exp(i k x) + B exp(-i k x) in each layer, x from its top, going down from the surface, where A = B.
    """
    count = 1 << 14
    samples = np.zeros(count)
    fine = 8  # samples between those that are joined by lines
    t = np.arange(count) * STEP / fine
    samples = np.interp(t, np.arange(len(SAMPLES)) * STEP, SAMPLES, right=0.0)
    w = 2 * np.pi * np.fft.rfftfreq(count, STEP / fine)
    up, down = np.ones(w.size, complex), np.ones(w.size, complex)
    for k, (length, speed, z) in reversed(list(enumerate(LAYERS))):
        turn = np.exp(1j * w * float(length.split()[0]) / speed)
        up, down = up * turn, down / turn
        if k:
            ratio = z / LAYERS[k - 1][2]
            up, down = (up * (1 + ratio) + down * (1 - ratio)) / 2, (up * (1 - ratio) + down * (1 + ratio)) / 2
    # in the rock 2 A is the outcrop: its velocity V = u' + (Z/rock) (A - B) w i
    base, pull = up + down, (up - down) * LAYERS[0][2] / ROCK
    accelerations = np.fft.irfft(2 * np.fft.rfft(samples) / (base + pull), count)
    velocities = np.concatenate([[0], np.cumsum((accelerations[1:] + accelerations[:-1]) / 2) * STEP / fine])
    return np.asarray(np.interp(times, t, velocities))


@pytest.mark.slow
def test_layers_as_measured_run_under_a_record_once_speeds_may_change_a_little() -> None:
    """Refused with what to write; written so it answers as the layers do by their transfer function."""
    with pytest.raises(ToleranceError, match="travel times of the rods have no common measure") as caught:
        wavesym.summary(column(until="20 s"))
    (written,) = re.findall(r'speed_adjustment = "([^"]*)" under \[system\]', str(caught.value))
    assert written == "0.5 %"
    scene = column(speed_adjustment=written)
    result = wavesym.run(scene, samples=801)
    expected = by_transfer_function(result.time)
    assert np.abs(result["velocity@24.3 m"] - expected).max() < 0.01 * np.abs(expected).max()
    (note,) = lower(scene).labels.notes
    changed = fmpq(re.findall(r"changed by 0\.(\d+) %", note)[0]) / 10000
    bars = lower(scene).network.bars, lower(column()).network.bars
    assert 0 < speed_change(*reversed(bars)) <= changed <= fmpq(1, 200)
    assert [bar.impedance for bar in bars[0]] == [bar.impedance for bar in bars[1]]


def test_a_speed_adjustment_that_is_too_little_says_how_much_is_enough() -> None:
    with pytest.raises(SceneError, match=r'0.001 % is too little for .*; write "[^"]*" or more') as caught:
        column(speed_adjustment="0.001 %")
    assert caught.value.path == "system.speed_adjustment"
    (enough,) = re.findall(r'write "([^"]*)" or more', str(caught.value))
    lower(column(speed_adjustment=enough))
    with pytest.raises(SceneError, match=r'50 of a speed is out of range; write "0.5 %", or another up to "20 %"'):
        column(speed_adjustment=50)


DEEP = [("6.8 m", 489), ("2.6 m", 461), ("4.5 m", 441), ("7.6 m", 415), ("2.5 m", 383), ("7.9 m", 341), ("6.1 m", 322)]


def deep(adjustment: str, until: str = "20 s") -> Scene:
    """Twelve layers on rock that have no common measure, under a record."""
    layers = [*DEEP, ("5.4 m", 317), ("3.3 m", 273), ("2.2 m", 251), ("6.7 m", 233), ("4.7 m", 211)]
    rods = [{"rod": h, "speed": f"{c} m/s", "rho": "1800 kg/m^3", "A": "1 m^2"} for h, c in layers]
    parts = [{"motion": "acceleration", "name": "rock"}, {"dashpot": "2400 kN*s/m"}, *rods, "free"]
    samples = ["0", *(str(value) for value in SAMPLES[1:-1] * 12), "0"]
    return Scene(
        name="deep",
        units={"kind": "shear"},
        system={"type": "chain", "parts": parts, "speed_adjustment": adjustment},
        load=[{"at": "rock", "spacing": "0.02 s", "samples": samples, "unit": "m/s^2"}],
        output={"until": until, "velocity": ["rock"], "tolerance": "1e-6"},
    )


def test_a_column_whose_windows_are_too_short_says_which_adjustment_is_enough(thorough: bool) -> None:
    """One short line, and what it says is served; a bound that is no tolerance has nothing to do with it."""
    with pytest.raises(ToleranceError) as caught:
        make(lower(deep("0.2 %")))
    line = str(caught.value)
    assert line.startswith("system.speed_adjustment: it leaves travel times a common measure of ")
    assert len(line) < 260
    assert line.endswith(" or take `wavesym frf` for the response at frequencies")
    (enough,) = re.findall(r'speed_adjustment = "([^"]*)" under \[system\]', line)
    assert wavesym.frf(deep("0.2 %"), [1.0]).outputs
    with pytest.raises(ToleranceError, match=r"^output.tolerance: 1e-20 cannot be met"):
        make(lower(deep("0.2 %", "0.1 s").with_({"output.tolerance": "1e-20"})))
    if thorough:  # seconds
        assert make(lower(deep(enough))).error_bound <= 1e-6
        with pytest.raises(ToleranceError, match=r"^system.speed_adjustment: .* to 600 s; write a shorter horizon, or"):
            make(lower(deep("20 %", "600 s")))


def test_a_scene_keeps_what_was_written() -> None:
    scene = column(speed_adjustment="0.5 %")
    assert scene.with_({}).model_dump() == scene.model_dump()
    assert scene.model_dump()["system"]["speed_adjustment"] == "0.5 %"
    assert "333 m/s" in str(scene.model_dump()["system"]["parts"])
    bare = {"type": "chain", "parts": [{"rod": 1}, {"rod": "1.2345678"}, "fixed"], "speed_adjustment": "1/100"}
    output = {"until": 1, "velocity": ["1"]}
    again = Scene(name="bare", system=bare, output=output)
    assert Scene(**again.model_dump()) == again
    assert again.system.parts[1].speed == 1


@given(st.lists(st.fractions("1/50", 50, max_denominator=997), min_size=1, max_size=12), st.fractions("1/1000", "1/5"))
def test_adjusted_travel_times_are_whole_windows(delays: list, most) -> None:
    """No speed changes by more than is allowed, or than a refusal says; the shortest is 64 windows at most."""
    bars = [Bar(k, k + 1, fmpq(2), 2 / fmpq(d.numerator, d.denominator), fmpq(3)) for k, d in enumerate(delays)]
    allowed = fmpq(most.numerator, most.denominator)
    try:
        adjusted = adjust_speeds(bars, allowed)
    except wavesym.CostError as error:
        (enough,) = re.findall(r'write "([\d.]+) %" or more', str(error))
        allowed = fmpq(*map(int, float(enough).as_integer_ratio())) / 100
        adjusted = adjust_speeds(bars, allowed)
    times = [bar.delay for bar in adjusted]
    assert common_measure(times) * FINEST >= min(times) * fmpq(99, 100)
    assert speed_change(bars, adjusted) <= allowed
    assert all(new.impedance == 3 and new.length == 2 for new in adjusted)


def test_speeds_change_by_little_where_few_windows_are_enough_whatever_is_allowed() -> None:
    """Under 20 % they changed by 18 %, to a window as long as the shortest travel time."""
    before = lower(column()).network.bars
    change = speed_change(before, lower(column(speed_adjustment="20 %")).network.bars)
    assert 0 < change < fmpq(1, 100)
    bars = [Bar(k, k + 1, fmpq(1), 1 / delay, fmpq(1)) for k, delay in enumerate(map(fmpq, (100, 301, 499)))]
    assert speed_change(bars, adjust_speeds(bars, fmpq(1, 5))) == speed_change(bars, adjust_speeds(bars, fmpq(1, 200)))
    # 0.5 % takes more than 16 windows here: the least change of so few, which is less than is allowed
    bars = [Bar(k, k + 1, fmpq(1), 1 / delay, fmpq(1)) for k, delay in enumerate(map(fmpq, (1757, 2875, 2236, 1970)))]
    after = adjust_speeds(bars, fmpq(1, 5))
    assert fmpq(1, 200) < speed_change(bars, after) < fmpq(1, 50)
    assert min(bar.delay for bar in after) / common_measure([bar.delay for bar in after]) <= 16


def test_percent_is_rounded_up() -> None:
    assert [percent(fmpq(*ratio)) for ratio in ((1, 200), (12345, 10**7), (9991, 10**6))] == ["0.5 %", "0.13 %", "1 %"]


def test_a_loss_is_refused_in_time_with_what_does_run(thorough: bool) -> None:
    """Beside a dashpot: one in each rod; else damping. As it is written there the scene runs."""
    lossy = column(rod={"loss": "5 %"}, speed_adjustment="0.5 %")
    with pytest.raises(UnservedError, match="for these write in its place dashpot = ") as caught:
        wavesym.summary(lossy)
    said = re.findall(r'dashpot = ("[^"]*") in rod (\d)', str(caught.value))
    assert [number for _, number in said] == ["1", "2", "3"]
    held = column(base=(), rod={"loss": "5 %"})
    with pytest.raises(UnservedError, match=r"for these write damping = 0.025 under"):
        wavesym.summary(held)
    if not thorough:
        return
    damped = column(speed_adjustment="0.5 %").with_(
        {f"system.parts[{int(number) + 1}].dashpot": dashpot.strip('"') for dashpot, number in said}
    )
    wavesym.summary(damped)
    # at that frequency both take about as much
    (hertz,) = map(float, re.findall(r"as much at ([\d.]+) Hz", str(caught.value)))
    still, both = wavesym.frf(column(), [hertz]), [wavesym.frf(each, [hertz]) for each in (lossy, damped)]
    name = "velocity@24.3 m"
    lost = [1 - abs(each[name][0] / still[name][0]) for each in both]
    assert lost[0] == pytest.approx(lost[1], rel=0.2)
    assert lost[0] > 0.005

    wavesym.summary(column(base=(), damping="0.025", until="2 s"))


def test_storeys_that_differ_take_a_speed_adjustment_too() -> None:
    storeys = [
        {"height": height, "stiffness": stiffness, "column_mass": "10 t", "floor_mass": "300 t"}
        for height, stiffness in (("4.2 m", "500 MN/m"), ("3.5 m", "678 MN/m"))
    ]
    system = {"type": "building", "base": "ground", "storey": storeys, "speed_adjustment": "0.5 %"}
    building = Scene(name="frame", units={}, system=system, output={"until": "1 s", "drift": [1]})
    delays = [bar.delay for bar in lower(building).network.bars]
    assert common_measure(delays) * FINEST >= min(delays)
    written_out = [bar.delay for bar in lower(Scene.from_toml(explicit_text(building))).network.bars]
    assert [delay / delays[0] for delay in delays] == [delay / written_out[0] for delay in written_out]


@pytest.mark.parametrize("command", [["tables"], ["formula", "--output", "velocity@surface"], ["inspect"]])
def test_every_command_tells_that_speeds_were_changed(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Some gave values of the changed chain without a word."""
    path = tmp_path / "two.toml"
    path.write_text(TWO_RODS)
    assert main([command[0], str(path), *command[1:]]) == 0
    told = capsys.readouterr()
    assert "speeds of waves are changed by" in (told.out if command == ["inspect"] else told.err)
    assert "speeds of waves are changed by" not in told.out or command == ["inspect"]


def transfer_of_layers(hertz: np.ndarray) -> np.ndarray:
    """The surface's velocity over the outcrop's acceleration, by transfer matrices of the layers as they are written.

    Of velocity and force over i w, from the free surface down: (1, 0) there.
    """
    found = []
    for w in 2 * np.pi * hertz:
        moved, force = 1.0 + 0j, 0j
        for length, speed, z in reversed(LAYERS):
            angle = w * float(length.split()[0]) / speed
            cos, sin = np.cos(angle), np.sin(angle)
            moved, force = cos * moved + sin * force / (z * w), cos * force - z * w * sin * moved
        found.append(1 / (1j * w * (moved + force / (1j * w * ROCK))))
    return np.array(found)


@pytest.mark.parametrize("command", [["modes"], ["frf", "--points", "3"]])
def test_frequencies_and_responses_take_speeds_as_they_are_written(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """They need no common measure: nothing differs from the same scene without the key, and nothing is to be told."""
    told = []
    for name, text in (("two", TWO_RODS), ("plain", TWO_RODS.replace("speed_adjustment", "# "))):
        (tmp_path / f"{name}.toml").write_text(text)
        assert main([command[0], str(tmp_path / f"{name}.toml"), *command[1:]]) == 0
        told.append(capsys.readouterr())
    assert told[0].out == told[1].out
    assert told[0].err == told[1].err


def test_adjusted_columns_respond_as_their_layers_do() -> None:
    """Whether or not a motion in time, whose speeds are changed, was asked for first."""
    hertz = np.linspace(0.5, 60, 40)
    expected = transfer_of_layers(hertz)
    for marched in (False, True):
        scene = column(speed_adjustment="0.5 %", until="0.1 s")
        if marched:
            assert lower(scene).written_speeds
        assert wavesym.frf(scene, hertz)["velocity@24.3 m"] == pytest.approx(expected, rel=1e-12)
    assert lower(scene).written_speeds, "a march has the model of frequencies"


def test_periods_are_those_of_the_speeds_as_written() -> None:
    """Those of a page and of `inspect`, and ranges."""
    scenes = [column((), speed_adjustment=adjusted, damping="0.02", until="0.1 s") for adjusted in ("1 %", "0 %")]
    stiff = {"system.parts[1].speed": ("451 m/s", "460 m/s")}
    pages, ranges = ([each(scene) for scene in scenes] for each in (first_modes, partial(_ranges, stiff)))
    assert pages[0] == pages[1] != []
    assert ranges[0] == ranges[1]
    inspected = [json.loads(api.inspect(scene, "model", "json"))["modes"] for scene in scenes]
    assert inspected[0] == inspected[1]
    seconds = [next(in_units(scene.physical, lower(scene))).values["periods"].value for scene in scenes]
    assert (
        seconds[0] == seconds[1] == pytest.approx([*(row.period for row in pages[0][:3]), *seconds[0][3:]], rel=1e-14)
    )


def _ranges(box: dict[str, tuple[str, str]], scene: Scene) -> str:
    return wavesym.modes(scene, 3, ranges=box).text()


def test_generated_programs_say_by_how_much_speeds_were_changed(tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(TWO_RODS)
    scene = Scene.from_toml(tmp_path / "two.toml")
    written = wavesym.generate(scene, tmp_path / "two")
    assert any(path.suffix == ".h" for path in written)
    bars = (lower(Scene.from_toml(text)).network.bars for text in (TWO_RODS.replace("speed_adj", "# "), TWO_RODS))
    change = percent(speed_change(*bars))
    for path in (tmp_path / "two").glob("two.[hj]*"):
        assert re.search(rf"speeds_changed_by\W+{change} or less", path.read_text()), path


def test_a_result_says_that_speeds_were_changed() -> None:
    found = Scene.from_toml(TWO_RODS).run(samples=3)
    (note,) = found.notes
    assert "speeds of waves are changed by" in note
    assert note in found._repr_html_()
    assert "of waves whose speeds are changed by" in found.accuracy
    assert any("other speeds than were written, by " in line for line in neglected_effects(lower(found.scene)))
    assert "of waves whose speeds are changed by" in str(wavesym.summary(Scene.from_toml(TWO_RODS)))
    assert Scene.from_toml(TWO_RODS.replace("speed_adjustment", "# ")).run(samples=3).notes == ()
