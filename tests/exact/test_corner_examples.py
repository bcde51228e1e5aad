"""Cases of the examples of links with corners that have a closed form, against that."""

from __future__ import annotations

import tomllib
from itertools import pairwise
from math import acos, atan, atan2, cos, hypot, log, pi, sin, sqrt
from pathlib import Path
from typing import Any

import pytest

import wavesym

FOLDER = Path(__file__).parents[2] / "examples" / "corners"


def table_of(name: str) -> dict[str, Any]:
    return tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))


def assert_happens(scene: wavesym.Scene, unit: float, expected: list[tuple[str, float]]) -> None:
    """What happens, and when, in s; `unit` is tau = 1."""
    found = wavesym.run(scene).events
    assert [event.kind for event in found] == [kind for kind, _ in expected]
    assert [event.double * unit for event in found] == pytest.approx([time for _, time in expected], rel=1e-12)


def test_a_drill_string_that_is_a_torsional_pendulum_sticks_and_slips_in_its_period() -> None:
    """2 D/V + (2/w) (pi - atan(D w/V)), with D = (S - R)/K, for a table that turns with V."""
    table, inertia, stiffness, speed, drop = table_of("drill_string"), 374, 471, 5, 2000
    parts = table["system"]["parts"]
    parts[1], parts[2]["mass"] = {"spring": f"{stiffness} N*m/rad"}, f"{inertia} kg*m^2"
    table["output"] = {"until": "30 s", "displacement": ["bit"]}
    slips = [event.double for event in wavesym.run(wavesym.Scene(**table)).events if event.kind == "slips"]
    swing, wound = sqrt(stiffness / inertia), drop / stiffness
    period = 2 * wound / speed + 2 / swing * (pi - atan(wound * swing / speed))
    assert [after - before for before, after in pairwise(slips)] == pytest.approx(
        [period] * (len(slips) - 1), rel=1e-12
    )


@pytest.mark.slow
def test_the_teeth_of_a_pinion_on_a_rigid_shaft_part_and_strike_as_it_swings_and_flies() -> None:
    """It swings on its teeth by K, flies across the play under the torque, and swings on the other flank."""
    table, inertia, stiffness, torque, play, turn = table_of("gears_with_backlash"), 0.5, 200e3, 500, 0.01, 0.02
    table["system"]["parts"][2:] = ["fixed"]
    table["output"] = {"until": "32 ms", "displacement": ["motor"]}
    rate, rest = sqrt(stiffness / inertia), torque / stiffness
    # one flank: u = rest (1 - cos w t), and from the turn on about -rest
    place, speed = rest * (1 - cos(rate * turn)), rest * rate * sin(rate * turn)
    swing, phase = hypot(place + rest, speed / rate), atan2(speed / rate, place + rest)
    parted = turn + (phase + acos(rest / swing)) / rate
    speed = -swing * rate * sin(acos(rest / swing))
    # free, with torque/inertia against it
    flown = (speed + sqrt(speed**2 + 2 * torque / inertia * play)) / (torque / inertia)
    speed -= torque / inertia * flown
    # the other flank, about -play - rest, and back
    swing, phase = hypot(rest, speed / rate), atan2(speed / rate, rest)
    times = [parted, parted + flown, parted + flown + 2 * (pi + phase) / rate]
    assert_happens(wavesym.Scene(**table), 1.0, list(zip(["releases", "engages", "releases"], times, strict=True)))


def test_a_ram_that_stays_on_the_pile_drives_it_into_plastic_soil_in_closed_form() -> None:
    """The ram M sends V exp(-t Z/M) down; soil of K = 2 Z (Z + c)/M and R = 3/4 Z V yields after log(4/3) M/Z and
    holds after log(8/3) M/Z: until then the toe goes R/K + 3/4 (1 - log 2) V M/(Z + c), before the head reflects."""
    table, ram, speed, damping = table_of("smith_pile"), 2000, 4, 225e3
    wave = sqrt(30e9 / 2500)
    impedance = 0.09 * sqrt(30e9 * 2500)
    stiffness, limit = 2 * impedance * (impedance + damping) / ram, 0.75 * impedance * speed
    parts = table["system"]["parts"]
    parts[4] = {"joint": True, "name": "shaft"}
    parts[7] |= {"spring": f"{stiffness!r} N/m", "yield": ["0 N", f"{limit!r} N"]}
    del parts[1:3]
    table["output"] = {"until": "6.8 ms", "displacement": ["toe"]}
    scene = wavesym.Scene(**table)
    late, decay = 12 / wave, ram / impedance
    expected = [("yields", late + decay * log(4 / 3)), ("holds", late + decay * log(8 / 3))]
    assert_happens(scene, 6 / wave, expected)
    deepest = wavesym.summary(scene)["displacement@toe"].max.value
    gone = limit / stiffness + 0.75 * (1 - log(2)) * speed * ram / (impedance + damping)
    assert deepest == pytest.approx(1e3 * gone, rel=1e-12)
