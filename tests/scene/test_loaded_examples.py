"""examples/ with real loads: what their pages say follows from something else, too."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import pairwise
from math import exp, log, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

import wavesym
from wavesym.exact.modes.frequencies import frequencies
from wavesym.scene import Scene, lower

EXAMPLES = Path(wavesym.__file__).parents[1] / "examples"
FOLDERS = {
    "frames": {"steel": "png", "concrete": "png"},
    "wall": {"wall": "png"},
    "drive_train": {"drive_train": "png", "torque": "csv"},
    "soil": {"soil": "png"},
}
LARGEST_PICTURE = 300_000  # bytes
THE_SAME = 1e-12


def scene(name: str, folder: str = "") -> Scene:
    return Scene.from_toml(EXAMPLES / (folder or name) / f"{name}.toml")


def page(folder: str) -> str:
    """Its text in one line."""
    return " ".join((EXAMPLES / folder / "README.md").read_text(encoding="utf-8").split())


def seconds(named: Scene) -> float:
    """One tau."""
    assert named.scale
    return float(named.scale.seconds)


@pytest.mark.parametrize("folder", FOLDERS)
def test_they_are_all_there(folder: str) -> None:
    text = page(folder)
    scenes = {name for name, ending in FOLDERS[folder].items() if ending == "png"}
    files = {f"{name}.{ending}" for name, ending in FOLDERS[folder].items()} | {f"{name}.toml" for name in scenes}
    assert {path.name for path in (EXAMPLES / folder).iterdir()} == files | {"README.md"}
    assert all(f"({name})" in text for name in files)
    for name in scenes:
        assert (EXAMPLES / folder / f"{name}.png").stat().st_size < LARGEST_PICTURE
        assert re.search(rf"wavesym plot {name}\.toml .*?-o {name}\.png", text)
    assert f"({folder}/README.md)" in (EXAMPLES / "README.md").read_text(encoding="utf-8")


def test_columns_without_mass_would_swing_as_a_textbook_says() -> None:
    """Ten equal masses on equal springs: w = 2 sqrt(k/M) sin(pi/42)."""
    steel, concrete = 20 * 12 * 210e9 * 57680e-8 / 3.5**3, 20 * 12 * 21e9 * 520833e-8 / 3.2**3
    light = [pi / (sqrt(k / mass) * sin(pi / 42)) for k, mass in ((steel, 350e3), (concrete, 430e3))]
    heavy = []
    for name in ("steel", "concrete"):
        model = lower(scene(name, "frames"))
        heavy.append(2 * pi / float(frequencies(model.network, 1)[0]) * seconds(scene(name, "frames")))
    more = [100 * (heavy / light - 1) for heavy, light in zip(heavy, light, strict=True)]
    assert (
        f"T1 would be {light[0]:.3f} s and {light[1]:.3f} s; their mass adds {more[0]:.1f} and {more[1]:.1f} %"
        in page("frames")
    )


def test_the_blast_is_that_of_the_curves() -> None:
    """Reflected pressure (kPa) and impulse (kPa ms over the cube root of kg): Swisdak's fits for 2 < Z <= 40."""
    z = log(3 / 3 ** (1 / 3))
    pressure = exp(np.polyval([-0.0099, 0.14247, -0.8232, 2.293, -2.64, -1.733, 8.8396], z)) / 1000
    impulse = 3 ** (1 / 3) * exp(np.polyval([-0.01123, 0.101, -1.3466, 6.7853], z)) / 1000
    text = page("wall")
    assert f"a peak of {pressure:.2f} MPa and an impulse of {impulse:.2f} MPa ms" in text
    assert f"= {2 * impulse / pressure:.1f} ms" in text
    assert f"from 4 m^2, is {4 * pressure:.1f} MN that falls to 0 in {2 * impulse / pressure:.1f} ms" in text


def test_the_wall_is_a_dashpot_until_the_neighbours_answer() -> None:
    wall = scene("wall")
    mass, half, force, over = 30e3, 1.5 * sqrt(5 / 6 * 12.5e9 * 2500), 3.8e6, 1.1e-3
    storey = 3 / sqrt(5 / 6 * 12.5e9 / 2500)
    rate = 2 * half / mass
    assert f"l/c = {1000 * storey:.2f} ms" in page("wall")
    assert over < storey

    def speed(t: float) -> float:
        """M v' + 2 Z v = F: of a step, less what a ramp takes away, and gives back from its end on."""

        def ramp(w: float) -> float:
            return force / over / (mass * rate) * (w - (1 - exp(-rate * w)) / rate) if w > 0 else 0.0

        return force / (mass * rate) * (1 - exp(-rate * t)) - ramp(t) + ramp(t - over)

    response = wavesym.evaluator(wall)
    times = np.array([0.2e-3, 0.8e-3, 1.1e-3, 1.9e-3, 2.8e-3])
    floor, roof, *_ = response(times / seconds(wall))
    assert floor == pytest.approx([1000 * speed(t) for t in times], rel=1e-9)
    assert not roof.any()
    assert response([0.0])[3][0] == pytest.approx(force / mass, rel=THE_SAME)
    assert f"{1000 * max(map(speed, np.linspace(0, 2e-3, 20001))):.1f} mm/s" in page("wall")


def test_the_engine_passes_the_shaft_when_it_says() -> None:
    drive = scene("drive_train")
    first = float(frequencies(lower(drive).network, 2)[1]) / (2 * pi) / seconds(drive)
    passed = 60 * first / 3
    times = np.linspace(0, 4, 400001)
    rpm = 200 * (times / 4) ** 2 * (3 - times / 2)
    when = times[np.searchsorted(rpm, passed)]
    text = page("drive_train")
    assert f"1/T1 = {first:.2f} Hz, at {passed:.1f} rpm, which the engine passes at {when:.2f} s" in text


def on(parts: list[object], at: str, unit: str, velocity: str) -> Scene:
    """The layers of soil.toml on a base, under a pulse of that unit at a place; the velocity at another."""
    said = scene("soil").physical
    assert said
    layers = [part for part in said.fields_in_units["system"]["parts"] if part == "free" or "rod" in part]
    return Scene(
        name="s",
        units={"kind": "shear"},
        system={"type": "chain", "parts": [*parts, *layers]},
        load=[{"at": at, "spacing": "40 ms", "samples": [0, 1, -2, "1/2", 0], "unit": unit}],
        output={"until": "1 s", "velocity": [velocity]},
    )


def test_a_dashpot_that_moves_with_the_outcrop_is_rock_below() -> None:
    """The same as 30 m of rock with an absorbing end, and the force 2 Z v on it, 30 ms earlier."""
    rock = {"rod": "30 m", "impedance": "2400 kN*s/m", "speed": "1000 m/s"}
    dashpot = on([{"motion": "velocity", "name": "out"}, {"dashpot": "2400 kN*s/m"}], "out", "m/s", "40 m")
    absorbing = on(["absorbing", rock], "0 m", "kN", "70 m")
    times = np.linspace(0, 0.95, 300)
    above = wavesym.evaluator(dashpot)(times / seconds(dashpot))[0]
    below = wavesym.evaluator(absorbing)((times + 0.03) / seconds(absorbing))[0]
    assert above == pytest.approx(2400 * below, rel=0, abs=THE_SAME * np.max(np.abs(above)))
    assert np.max(np.abs(above)) > 2


def test_the_first_of_the_wave_at_the_surface_is_a_product() -> None:
    """Before the first echo within a layer, that of the clay, 100 ms later."""
    soil = scene("soil").with_(
        {
            "load": [{"at": "outcrop", "times": ["0 s"], "steps": ["1 m/s^2"]}],
            "output.until": "0.3 s",
            "output.strain": [],
        }
    )
    impedances = [2400, 840, 456, 272]
    product = Fraction(1)
    for below, above in pairwise(impedances):
        product *= Fraction(2 * below, below + above)
    times = np.array([0.14, 0.17, 0.24])
    outcrop, _, surface = wavesym.evaluator(soil)(times / seconds(soil))
    assert outcrop == pytest.approx(100 * times, rel=THE_SAME)
    assert surface == pytest.approx([100 * float(product) * max(t - 0.15, 0) for t in times], rel=THE_SAME)
    assert f"= {float(product):.2f} times what the outcrop does, 150 ms later" in page("soil")
