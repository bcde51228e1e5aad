"""Amplitudes over a box of parameters are those of all its sets, and hardly more."""

import numpy as np
import pytest
from click.testing import CliRunner

import wavesym
from wavesym.cli.frf import frf
from wavesym.errors import CostError, UnservedError, WavesymError
from wavesym.results import response_ranges

OSCILLATOR = wavesym.Scene(
    name="oscillator",
    system={"type": "chain", "parts": ["fixed", {"spring": 3, "dashpot": "1/4"}, {"mass": 2, "name": "m"}]},
    load=[{"at": "m", "times": [0], "steps": [1]}],
    output={"until": 5, "displacement": ["m"]},
)
SHAKEN = wavesym.Scene(
    name="shaken",
    system={
        "type": "chain",
        "parts": [
            {"motion": "acceleration", "name": "g"},
            {"rod": 1},
            {"mass": 2, "name": "a", "dashpot": "1/5"},
            {"rod": "1/2", "impedance": 2},
            {"mass": 1, "name": "top", "spring": "1/2"},
        ],
    },
    load=[{"at": "g", "times": [0], "steps": [1]}],
    output={"until": 5, "displacement": ["top"], "strain": ["0"], "acceleration": ["a"]},
)
BOX = {
    "system.parts[2].mass": ("7/4", "9/4"),
    "system.parts[2].dashpot": ("3/20", "1/4"),
    "system.parts[4].spring": ("3/8", "5/8"),
}


def test_an_oscillator_has_the_range_of_its_closed_form():
    """1/|k - m w^2 + i c w| over masses and springs, through resonance."""
    at = np.array([0.3, 1.0, 1.25, 2.0])
    box = {"system.parts[2].mass": ("1.6", "2.2"), "system.parts[1].spring": ("2.5", "3.5")}
    found = wavesym.frf(OSCILLATOR, at, ranges=box)
    m, k = np.meshgrid(np.linspace(1.6, 2.2, 301), np.linspace(2.5, 3.5, 301))
    for w, low, high in zip(at, found.low[0], found.high[0], strict=True):
        every = 1 / np.abs(k - m * w * w + 0.25j * w)
        assert low <= every.min() * (1 + 1e-12)
        assert high >= every.max() * (1 - 1e-12)
        assert low >= every.min() - 0.11 * every.max()
        assert high <= 1.11 * every.max()


def test_sets_drawn_from_a_box_are_within_it():
    """Their responses alone, by exact numbers; some come near the ends."""
    at = [0.05, 0.4, 0.9, 1.7]
    found = wavesym.frf(SHAKEN, at, ranges=BOX)
    random = np.random.default_rng(28)
    most, least = np.zeros(found.high.shape), np.full(found.low.shape, np.inf)
    for number in range(40):
        ends = [(float(fraction_of(a)), float(fraction_of(b))) for a, b in BOX.values()]
        drawn = [low + (high - low) * t for (low, high), t in zip(ends, random.random(3).tolist(), strict=True)]
        if number < 8:
            drawn = [pair[(number >> k) & 1] for k, pair in enumerate(ends)]
        scene = SHAKEN.with_({path: repr(value) for path, value in zip(BOX, drawn, strict=True)})
        amplitude = wavesym.frf(scene, at).amplitude
        most, least = np.maximum(most, amplitude), np.minimum(least, amplitude)
    assert np.all(most <= found.high * (1 + 1e-12))
    assert np.all(least >= found.low * (1 - 1e-12))
    assert np.all(found.high <= 1.25 * most)


@pytest.mark.parametrize(("low", "high"), [("1e-10", "2"), ("1e-6", "1e6"), ("1e-30", "1"), ("1", "1e30")])
def test_a_mass_whose_ball_reaches_down_to_0_is_a_mass(low, high):
    """|2 + i w m|: a ball of wide ranges has its radius rounded up to more than its middle."""
    parts = ["absorbing", {"rod": 1}, {"mass": 1, "name": "a"}, {"rod": 1}, "absorbing"]
    load = [{"at": "a", "times": [0], "steps": [1]}]
    system = {"type": "chain", "parts": parts}
    scene = wavesym.Scene(name="s", system=system, load=load, output={"until": 5, "velocity": ["a"]})
    found = wavesym.frf(scene, [1.0], ranges={"system.parts[2].mass": (low, high)})
    ends = [1 / abs(2 + 1j * float(mass)) for mass in (high, low)]
    assert found.low[0, 0] <= ends[0]
    assert found.low[0, 0] >= ends[0] - 0.11 * ends[1]
    assert ends[1] * (1 - 1e-12) <= found.high[0, 0] <= 1.11 * ends[1]


@pytest.mark.parametrize(
    ("box", "low", "high"),
    [
        ({"system.parts[1].spring": ("1e-30", "1/2")}, 1, 2),
        ({"system.parts[1].spring": ("3/2", "1e30")}, 1.01e-30, 2),
        ({"system.parts[2].mass": ("1e-30", "1/2"), "system.parts[1].spring": ("1", "1e30")}, 1.01e-30, 2),
        ({"system.parts[1].spring": (0.25, 0.5)}, 4 / 3, 2),
    ],
)
def test_a_spring_whose_ball_reaches_down_to_0_is_a_spring(box, low, high):
    """1/|k - m| at w = 1; a link that is not exactly 0 is there, and wide ranges of two numbers cost no more parts."""
    scene = OSCILLATOR.with_({"system.parts[1].dashpot": "0", "system.parts[2].mass": "1"})
    found = wavesym.frf(scene, [1.0], ranges=box)
    assert low - 0.11 * high <= found.low[0, 0] <= low
    assert high * (1 - 1e-12) <= found.high[0, 0] <= 1.11 * high


def fraction_of(text):
    above, _, below = text.partition("/")
    return float(above) / float(below or 1)


def test_a_box_of_one_set_is_its_response():
    found = wavesym.frf(OSCILLATOR, [0.7], ranges={"system.parts[2].mass": ("2", "2")})
    (true,) = wavesym.frf(OSCILLATOR, [0.7]).amplitude[0]
    assert found.low[0, 0] <= true <= found.high[0, 0]
    assert found.high[0, 0] - found.low[0, 0] < 1e-14 * true


@pytest.mark.parametrize(
    ("scene", "path", "ends", "error", "message"),
    [
        (SHAKEN, "system.parts[1].rod", ("1", "2"), UnservedError, "over masses, springs and dashpots only"),
        (SHAKEN, "system.parts[3].impedance", ("1", "2"), UnservedError, "over masses, springs and dashpots only"),
        (OSCILLATOR, "system.parts[1].spring", ("0", "2"), WavesymError, "begin above 0"),
        (OSCILLATOR, "system.parts[1].spring", ("1", "two"), WavesymError, "write two numbers, in one unit"),
        (OSCILLATOR, "system.parts[1].spring", ("1", "1/0"), WavesymError, "write two numbers, in one unit"),
        (OSCILLATOR, "system.parts[1].spring", ("2", "1"), WavesymError, "first end is above the second"),
        (
            OSCILLATOR.with_({"system.parts[1].dashpot": "0"}),
            "system.parts[2].mass",
            ("1.9", "2.1"),
            CostError,
            "a natural frequency lies in the box",
        ),
    ],
)
def test_what_has_no_enclosure_is_refused(scene, path, ends, error, message, monkeypatch, thorough):
    if not thorough:
        monkeypatch.setattr(response_ranges, "_MOST_PARTS", 64)
    with pytest.raises(error, match=message):
        wavesym.frf(scene, [np.sqrt(1.5)], ranges={path: ends})


def test_the_command_has_two_columns_of_each_output(tmp_path):
    file = tmp_path / "oscillator.toml"
    file.write_text(
        'name = "oscillator"\n[system]\ntype = "chain"\n'
        'parts = ["fixed", { spring = 3, dashpot = "1/4" }, { mass = 2, name = "m" }]\n'
        '[[load]]\nat = "m"\ntimes = [0]\nsteps = [1]\n[output]\nuntil = 5\ndisplacement = ["m"]\n'
    )
    asked = [str(file), "--from", "0.5", "--to", "1", "--points", "2", "--range", "system.parts[2].mass=1..2"]
    found = CliRunner().invoke(frf, asked)
    assert found.exit_code == 0
    head, *rows = found.stdout.splitlines()
    assert head == "omega,displacement@m.low,displacement@m.high"
    assert len(rows) == 2
    assert CliRunner().invoke(frf, [*asked, "--peaks"]).exit_code == 2
    twice = CliRunner().invoke(frf, [*asked, *asked[-2:]])
    assert "has a range already" in str(twice.exception)
