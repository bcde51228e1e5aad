"""Steps of a controller that are no whole panels: speeds adjusted, so that each step costs the same, for ever."""

from __future__ import annotations

import ctypes
import math
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st

import wavesym
from tests.support.characteristics import Shafts
from tests.support.streamed import StreamModel
from wavesym import Scene, api
from wavesym.cli import main
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import fraction, nearest
from wavesym.programs.request import Request
from wavesym.programs.stream.adjustment import fit_speeds
from wavesym.running.native import address, library
from wavesym.scene import lower
from wavesym.targets.files import sources

G, RHO = 79e9, 7850.0
INERTIA, DASHPOTS = ("12", "20", "30"), (0, 40, 60)
STEP = Fraction(1, 2000)  # s
COUNTED = """
size_t plant_size(void);
int plant_instants(const stream *state);
long long plant_solved(void);

size_t plant_size(void)
{
    return sizeof(stream);
}

int plant_instants(const stream *state)
{
    return state->breakpoints;
}

long long plant_solved(void)
{
    return solved;
}
"""
SOLVE = """
static void step_joint_of(stream *state, int joint, joint_on_panel *on, const real *acting, int at_rest, real span)
{
"""


def drive(*lengths: str, adjustment: str = "1 %", until: str = "60 ms", damped: bool = False) -> Scene:
    """Three discs on two shafts, of which the second is thinner; as a chain, dashpots in place of two."""
    shafts = [
        {"diameter": diameter, "G": "79 GPa", "rho": "7850 kg/m^3", "rod" if damped else "length": length}
        for length, diameter in zip(lengths, ("100 mm", "80 mm"), strict=True)
    ]
    system: dict[str, Any] = {"speed_adjustment": adjustment} if adjustment else {}
    if damped:
        dashpots = [{"joint": True, "dashpot": f"{c} N*m*s/rad"} for c in DASHPOTS[1:]]
        discs = [{"mass": f"{INERTIA[0]} kg*m^2"}, *dashpots]
        system |= {"type": "chain", "parts": [discs[0], shafts[0], discs[1], shafts[1], discs[2]]}
    else:
        system |= {"type": "drive", "shaft": shafts, "disc": [{"inertia": f"{j} kg*m^2"} for j in INERTIA]}
    ends = [0, f"{sum(float(length.split()[0]) for length in lengths)} m"] if damped else [0, 2]
    return Scene(
        name="plant",
        units={"time": "ms", "moment": "kN*m", **({"kind": "torsional"} if damped else {})},
        system=system,
        load=[{"at" if damped else "body": "0 m" if damped else 1, "times": ["0 s"], "steps": ["2 kN*m"]}],
        output={
            "until": until,
            "tolerance": 1e-8,
            "velocity": ["0 m", ends[1]] if damped else ends,
            "force": [f"{float(lengths[0].split()[0]) / 2} m"] if damped else [0.5],
        },
    )


def in_tau(scene: Scene) -> fmpq:
    """The step of the controller."""
    clock = lower(scene).clock
    assert clock
    return fmpq(STEP.numerator, STEP.denominator) / clock.seconds


def fitted(scene: Scene) -> Model:
    return fit_speeds(replace(lower(scene), endless=True), in_tau(scene))


class Plant:
    """The stream of a scene for steps of a controller, whose joints are counted as they are solved."""

    def __init__(self, scene: Scene) -> None:
        made = sources(api.program(scene, Request(stream=True, step=in_tau(scene))), "c")
        text = made["plant.c"]
        assert text.count(SOLVE) == 1
        text = text.replace(SOLVE, f"\nstatic long long solved = 0;\n{SOLVE}    ++solved;\n") + COUNTED
        self._c = library(text, ("-O1",), ("plant.h", made["plant.h"]))
        self._c.plant_size.restype, self._c.plant_solved.restype = ctypes.c_size_t, ctypes.c_longlong
        self._c.plant_step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p]
        self._c.plant_instants.argtypes = [ctypes.c_void_p]
        self._state = np.zeros(self._c.plant_size(), np.uint8)
        self._c.plant_init(ctypes.c_void_p(address(self._state)))
        # as a program computes it: from the constant in the header
        (seconds,) = re.findall(r"PLANT_SECONDS_PER_TAU (\S+)", made["plant.h"])
        self._dtau = float(STEP) / float(seconds)

    def step(self, moment: float) -> tuple[int, np.ndarray, int]:
        """A moment that is held: the status, the outputs, and how many joints were solved."""
        load, out = np.array([moment]), np.zeros(3)
        before = self._c.plant_solved()
        self._c.plant_step(address(self._state), 0.0, address(load), address(out))
        status = self._c.plant_step(address(self._state), self._dtau, address(load), address(out))
        return status, out, self._c.plant_solved() - before

    @property
    def instants(self) -> int:
        """Inside of panels, for which room is taken."""
        return int(self._c.plant_instants(address(self._state)))


def by_characteristics(scene: Scene, *, damped: bool) -> tuple[Shafts, int]:
    """The shafts with the travel times that the stream has, and how many panels a step is."""
    model = fitted(scene)
    assert model.clock
    seconds = fraction(model.clock.seconds)
    delays = [fraction(bar.delay) * seconds for bar in model.network.bars]
    panel = STEP
    for delay in delays:
        panel = _common(panel, delay)
    steps = STEP / panel
    assert steps.denominator == 1
    impedance = [math.sqrt(G * RHO) * math.pi * d**4 / 32 for d in (0.1, 0.08)]
    panels = [int(delay / panel) for delay in delays]
    discs = ((INERTIA[0], "0", "0"), DASHPOTS) if damped else (INERTIA, (0, 0, 0))
    return Shafts(*discs, impedance, panels, float(panel)), int(steps)


def _common(a: Fraction, b: Fraction) -> Fraction:
    return Fraction(math.gcd(a.numerator * b.denominator, b.numerator * a.denominator), a.denominator * b.denominator)


MOMENTS = np.random.default_rng(3).uniform(-2, 2, 20_000)


@pytest.mark.parametrize(
    ("lengths", "count", "damped"),
    [
        (("2 m", "2 m"), 400, False),
        pytest.param(("2 m", "3.1 m"), 400, False, marks=pytest.mark.slow),
        pytest.param(("2 m", "2 m"), 20_000, True, marks=pytest.mark.slow),
        pytest.param(("2 m", "3.1 m"), 2000, True, marks=pytest.mark.slow),
        pytest.param(("2.3456 m", "1.7 m"), 2000, True, marks=pytest.mark.slow),
    ],
)
def test_adjusted_steps_are_true_and_cost_the_same_for_ever(lengths: tuple[str, str], count: int, damped: bool) -> None:
    """A step of 0.5 ms is 0.79 of what a wave takes: room was out after a thousand, each slower than the one before."""
    scene = drive(*lengths, damped=damped)
    plant, (shafts, panels) = Plant(scene), by_characteristics(scene, damped=damped)
    found, true, solved, status = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count, int), 0
    for k, moment in enumerate(MOMENTS[:count]):
        now, found[k], solved[k] = plant.step(moment)
        status = max(status, now)
        for _ in range(panels):
            velocities = shafts.go_on([1e3 * moment, 0, 0])
        true[k] = velocities[0], velocities[2], shafts.moment_in_middle(0) / 1e3
    assert status == 0
    assert plant.instants == 0
    assert set(solved[1:]) == {solved[1]}
    missed = np.max(np.abs(found - true), axis=0) / np.max(np.abs(true), axis=0)
    assert np.max(missed) < 1e-9


def test_without_an_adjustment_each_step_is_slower_and_room_is_out() -> None:
    """What the test above would see."""
    plant = Plant(drive("2 m", "2 m", adjustment=""))
    every = [plant.step(moment) for moment in MOMENTS[:200]]
    assert max(status for status, _, _ in every) == 2
    assert every[100][2] > 2 * every[5][2]
    assert plant.instants > 50


def test_parameters_at_run_time_have_the_adjusted_speeds() -> None:
    """With the scene's own numbers a stream that is built when it starts is the one that was built before."""
    scene = drive("2 m", "2 m")
    both = [
        StreamModel(api.program(scene, Request(stream=True, step=in_tau(scene), runtime=names))).start()
        for names in ((), ("kappa", "inertia"))
    ]
    for moment in MOMENTS[:50]:
        ran = []
        for stream in both:
            stream.step(0.0, [moment])
            ran.append(stream.step(nearest(in_tau(scene)), [moment])[1])
        assert ran[1] == pytest.approx(ran[0], rel=1e-9, abs=1e-12)


@given(
    st.lists(st.fractions("1/5", 5, max_denominator=97), min_size=1, max_size=5),
    st.fractions("1/20", 3, max_denominator=997),
    st.sampled_from([Fraction(1, 1000), Fraction(1, 100), Fraction(1, 20)]),
)
def test_no_speed_changes_by_more_than_is_allowed(delays: list[Fraction], step: Fraction, most: Fraction) -> None:
    """And then a step and all travel times are whole panels, the first of them no less than one."""
    rods = [{"rod": delay} for delay in delays]
    table = {"type": "chain", "parts": [{"mass": 1, "name": "a"}, *rods, {"mass": 1}], "speed_adjustment": str(most)}
    load = [{"at": "a", "times": [0], "steps": [1]}]
    try:
        scene = Scene(name="any", system=table, load=load, output={"until": 3, "velocity": ["a"]})
    except wavesym.SceneError:  # too little for a common measure
        return
    model = lower(scene)
    found = fit_speeds(model, fmpq(step.numerator, step.denominator))
    if found is model:
        return
    panel = step
    for before, after in zip(model.network_as_written.bars, found.network.bars, strict=True):
        assert abs(after.speed / before.speed - 1) <= fmpq(most.numerator, most.denominator)
        panel = _common(panel, fraction(after.delay))
    assert found.written_speeds == tuple(bar.speed for bar in model.network_as_written.bars)
    assert (step / panel).denominator == 1
    assert step / panel <= 8 or panel >= Fraction(1, 1024) or min(delays) <= 64 * panel
    assert sum(note.startswith("system.speed_adjustment") for note in found.labels.notes) == 1


def test_what_the_message_says_is_what_makes_steps_whole_panels(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """And a line says by how much each speed is changed, as the header does."""
    monkeypatch.chdir(tmp_path)
    text = (tmp_path / "plant.toml").write_text
    text(drive_text := DRIVE_TEXT)
    assert main(["generate", "plant.toml", "--stream", "--step", "0.5 ms", "-o", "made"]) == 0
    said = capsys.readouterr().err
    assert "each is slower than the one before, and there is room to the horizon only" in said
    (remedy,) = re.findall(r'(speed_adjustment = "[^"]*") under \[system\]', said)
    text(drive_text.replace("[system]", f"[system]\n{remedy}"))
    assert main(["generate", "plant.toml", "--stream", "--step", "0.5 ms", "-o", "made"]) == 0
    said = capsys.readouterr().err
    assert "slower" not in said
    (changes,) = re.findall(r"speeds of waves in rods are changed, (.*), so that a step of 0.5 ms and all", said)
    assert f"speeds_changed_by = {changes}" in (tmp_path / "made/plant.h").read_text()
    assert changes.startswith("all by ")


DRIVE_TEXT = """
name = "plant"
[units]
time = "ms"
moment = "kN*m"
[system]
type = "drive"
shaft = [{ length = "2 m", diameter = "100 mm", G = "79 GPa", rho = "7850 kg/m^3" }]
disc = [{ inertia = "12 kg*m^2" }, { inertia = "20 kg*m^2" }]
[[load]]
body = 1
times = ["0 s"]
steps = ["2 kN*m"]
[output]
until = "60 ms"
velocity = [1]
"""


@pytest.mark.parametrize(("speed", "panels"), [("3200 m/s", 4), ("4000 m/s", 1)])
def test_a_shaft_takes_its_wave_speed_in_place_of_a_modulus(speed: str, panels: int) -> None:
    """Then its travel time has a common measure with a step of half a millisecond, and nothing has to be changed."""
    scene = Scene.from_toml(DRIVE_TEXT.replace('G = "79 GPa"', f'speed = "{speed}"'))
    model = lower(scene)
    assert model.clock
    assert model.clock.seconds == fmpq(2) / int(speed.split()[0])
    program = api.program(scene, Request(stream=True, step=in_tau(scene)))
    assert program.constants["breakpoints"] == 0
    assert program.constants["panel"] <= float(in_tau(scene)) / panels
    same = Scene.from_toml(DRIVE_TEXT.replace("79 GPa", f"{7850 * int(speed.split()[0]) ** 2} Pa"))
    assert lower(same).network == model.network
    for wrong, line in (('speed = "1 m/s", G = "79 GPa"', "stands beside G"), ("", "or speed in its place")):
        with pytest.raises(wavesym.SceneError, match=line):
            Scene.from_toml(DRIVE_TEXT.replace('G = "79 GPa",', f"{wrong}," if wrong else ""))
