"""Ranges of frequencies over a box, against frequencies inside it."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import wavesym
from wavesym import Scene
from wavesym.cli import main
from wavesym.errors import UnservedError, WavesymError

CHAIN = Scene(
    name="chain",
    system={
        "type": "chain",
        "parts": [
            "fixed",
            {"spring": 3},
            {"mass": 2},
            {"rod": 1, "speed": 1},
            {"mass": "1/2", "spring": "1/4"},
            {"rod": "1/3", "impedance": 2},
        ],
    },
    output={"until": 1, "velocity": ["1/2"]},
)
BOX = {
    "system.parts[1].spring": (1, 5),
    "system.parts[2].mass": (1, 4),
    "system.parts[3].speed": (Fraction(1, 2), 2),
    "system.parts[4].spring": (0, 2),
}


@settings(max_examples=30, deadline=None)
@given(st.tuples(*(st.fractions(0, 1, max_denominator=50) for _ in BOX)))
def test_every_frequency_inside_is_in_its_range(parts: tuple[Fraction, ...]) -> None:
    ranges = wavesym.modes(CHAIN, 4, ranges={path: (str(low), str(high)) for path, (low, high) in BOX.items()})
    inside = {path: low + part * (high - low) for part, (path, (low, high)) in zip(parts, BOX.items(), strict=True)}
    for each, mode in zip(ranges, wavesym.modes(CHAIN.with_(inside), 4), strict=True):
        assert each.low <= mode.omega + mode.radius
        assert mode.omega - mode.radius <= each.high


def test_the_ends_are_reached() -> None:
    (first,) = wavesym.modes(CHAIN, 1, ranges={"system.parts[2].mass": ("1", "4")})
    ends = [wavesym.modes(CHAIN.with_({"system.parts[2].mass": mass}), 1)[0].omega for mass in (4, 1)]
    assert (first.low, first.high) == pytest.approx(ends, rel=1e-15)


def test_a_range_the_wrong_way_round_is_noticed() -> None:
    with pytest.raises(WavesymError, match="the first end is above the second"):
        wavesym.modes(CHAIN, 1, ranges={"system.parts[2].mass": ("4", "1")})


@pytest.mark.parametrize(
    ("path", "ends"), [("system.parts[5].impedance", ("1", "2")), ("system.parts[5].rod", ("1", "2"))]
)
def test_what_frequencies_do_not_follow_one_way_is_refused(path: str, ends: tuple[str, str]) -> None:
    with pytest.raises(UnservedError, match="frequencies may rise or fall with it"):
        wavesym.modes(CHAIN, 1, ranges={path: ends})
    damped = CHAIN.with_({"system.parts[2].dashpot": 1})
    with pytest.raises(UnservedError, match="dashpots make frequencies complex"):
        wavesym.modes(damped, 1, ranges={"system.parts[2].mass": ("1", "2")})


def test_a_density_beside_a_speed_is_refused() -> None:
    """G = rho c^2 goes with it, and where rods differ frequencies go either way."""
    layer = {"rod": "4 m", "speed": "180 m/s", "A": "1 m^2", "rho": "1800 kg/m^3"}
    below = {"rod": "6 m", "speed": "240 m/s", "A": "1 m^2", "rho": "1900 kg/m^3"}
    held = {"type": "chain", "parts": ["free", layer, below, "fixed"]}
    column = Scene(name="column", units={"kind": "shear"}, system=held, output={"until": "1 s", "velocity": ["0 m"]})
    with pytest.raises(UnservedError, match="beside a speed it changes mass and stiffness together"):
        wavesym.modes(column, 1, ranges={"system.parts[1].rho": ("1800 kg/m^3", "1900 kg/m^3")})
    slower = {"system.parts[1].speed": ("150 m/s", "180 m/s")}
    assert wavesym.modes(column, 1, ranges=slower)[0].low < wavesym.modes(column, 1)[0].omega


def test_the_command_takes_quantities(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:  # type: ignore[no-untyped-def]
    file = tmp_path / "frame.toml"
    file.write_text(
        'name = "frame"\n[units]\n[system]\ntype = "building"\nbase = "ground"\n[[system.storey]]\ncount = 3\n'
        'height = "3.5 m"\nstiffness = "678 MN/m"\ncolumn_mass = "10.871 t"\nfloor_mass = "350 t"\n'
    )
    box = [
        "--range",
        "system.storey[0].floor_mass=300 t..400 t",
        "--range",
        "system.storey[0].stiffness=6e8 N/m..700 MN/m",
    ]
    assert main(["modes", str(file), "--count", "2", "--format", "json", *box]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["complete"]
    for row in found["modes"]:
        assert row["hz"]["low"] < row["hz"]["high"]
        assert row["period"]["low"] == pytest.approx(1 / row["hz"]["high"])
    assert main(["modes", str(file), "--range", "x"]) == 2
    assert "write PATH=A..B" in capsys.readouterr().err
