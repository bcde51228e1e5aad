"""Parameters of scenes with units: what is given anew is what a scene with these numbers says."""

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from flint import fmpq

import wavesym
from tests.scene.test_physical_scenes import BUILDING, CHAIN, COLLISION, DRIVE, STOREY
from wavesym.programs.runtime import making
from wavesym.running import sets


def drive():
    """Another shaft, other discs and other moments."""
    first = deepcopy(DRIVE)
    first["output"] = {"until": "1.5 ms", "tolerance": "1e-11", "velocity": [2], "force": ["1/2"], "strain": ["3/2"]}
    first["load"] = [{"body": 1, "times": ["0 s", "0.7 ms"], "steps": ["15 N*m", "0 N*m"], "ramps": ["1 kN*m/s"] * 2}]
    other = deepcopy(first)
    other["system"]["disc"] = [{"inertia": f"{inertia} kg*m^2"} for inertia in (0.5, 0.2, 0.7)]
    other["system"]["shaft"] = [shaft | {"diameter": "70 mm"} for shaft in DRIVE["system"]["shaft"]]
    other["load"][0] |= {"steps": ["11 N*m", "3 N*m"], "ramps": ["0.5 N*m/ms", "250 N*m/s"]}
    shaft = np.pi / 32 * 0.07**4 * 7850 * 1.2
    return first, other, {"kappa": [shaft / 0.5, shaft / 0.2], "inertia": [0.5, 0.2, 0.7], "load": [11, 3, 500, 250]}


def building(base):
    """Lighter floors and other accelerations."""
    first = deepcopy(BUILDING)
    first["system"] |= {"base": base} | ({"foundation_mass": "100 t"} if base == "force" else {})
    first["output"] = {"until": "200 ms", "tolerance": "1e-11", "velocity": [2], "force": [0, "3/2"], "drift": [1]}
    other = deepcopy(first)
    (storey,) = other["system"]["storey"]
    other["system"]["storey"] = [storey | {"count": 1, "floor_mass": f"{mass} t"} for mass in (100, 50)]
    other["load"][0] |= {"a": ["1 m/s^2", "2 m/s^2"], "b": ["3 m/s^3", "0.5 g/s"]}
    below = 10.871 / (100 if base == "force" else 350)
    return first, other, {"kappa": [below, 0.10871, 0.21742], "load": [1, 2, 3, 4.903325]}


def collision():
    """A lighter body, and one that comes from the other side."""
    first = deepcopy(COLLISION)
    first["output"] = {"until": "2 ms", "tolerance": "1e-11", "velocity": [1], "force": [2], "displacement": [1]}
    other = deepcopy(first)
    other["system"]["body"][0]["mass"] = "3 kg"
    other["system"]["body"][1]["velocity"] = "-2 m/s"
    rod = 1.2 * 8e-4 * 7850
    return first, other, {"kappa": [rod / 3, rod / 12], "velocity": [5, -2]}


def chain():
    """Another hammer, spring and arm."""
    first = deepcopy(CHAIN)
    first["output"] |= {"until": "1 ms", "tolerance": "1e-11", "force": ["0.6 m"], "acceleration": ["hammer"]}
    first["load"] = [
        {"at": "hammer", "times": ["0 s", "0.3 ms"], "steps": ["2 kN", "0 N"], "ramps": ["0 N/s", "5 kN/ms"]}
    ]
    first["system"]["parts"][1] = {"rod": "1.2 m", "impedance": "8 kN*s/m", "speed": "5 km/s"}
    other = deepcopy(first)
    other["system"]["parts"][0] |= {"mass": "5 kg", "velocity": "3 m/s"}
    other["system"]["parts"][2] |= {"mass": "4 kg", "spring": "80 kN/mm"}
    other["system"]["branch"][0]["parts"][0]["impedance"] = "1 kN*s/m"
    other["load"][0] |= {"steps": ["-1 kN", "1 kN"], "ramps": ["1 N/s", "0 N/s"]}
    # each mass and each rod has a velocity of its own
    numbers = {"mass": [5, 4], "spring": [80e6], "impedance": [8000, 1000], "velocity": [3, 0, 0, 0]}
    return first, other, numbers | {"load": [-1000, 1000, 1, 0]}


def storeys():
    """Unequal storeys are a chain on a ground that moves."""
    first = deepcopy(BUILDING)
    first["system"]["storey"] = [STOREY, STOREY | {"stiffness": "1356 MN/m", "column_mass": "21.742 t"}]
    first["output"] = {"until": "100 ms", "tolerance": "1e-11", "velocity": [2], "force": [0], "drift": [1]}
    other = deepcopy(first)
    other["system"]["storey"][0]["floor_mass"] = "100 t"
    other["load"][0] |= {"a": ["1 m/s^2", "2 m/s^2"], "b": ["3 m/s^3", "0.5 g/s"]}
    return first, other, {"mass": [100e3, 350e3], "load": [1, 2, 3, 4.903325]}


CASES = {
    "drive": (drive, {"kappa": "", "inertia": "kg*m^2", "load": "N*m"}),
    "ground": (lambda: building("ground"), {"kappa": "", "load": "m/s^2"}),
    "force": (lambda: building("force"), {"kappa": "", "load": "m/s^2"}),
    "collision": (collision, {"kappa": "", "velocity": "m/s"}),
    "chain": (
        chain,
        {"mass": "kg", "spring": "N/m", "impedance": "N*s/m", "velocity": "m/s", "load": "N"},
    ),
    "storeys": (storeys, {"mass": "kg", "load": "m/s^2"}),
}


@pytest.fixture(autouse=True)
def sooner(monkeypatch):
    """Compiled sooner."""
    monkeypatch.setattr(sets, "FAST", ("-O1",))


def missed(case):
    """The largest error of any output, relative to its largest value, of the other scene; and the model."""
    first, other, numbers = CASES[case][0]()
    model = wavesym.model(wavesym.Scene(**first), runtime=list(numbers))
    tau = np.linspace(0, model.tau_max, 41)
    true = wavesym.evaluator(wavesym.Scene(**other))(tau)
    errors = np.abs(model.run(tau, **numbers)[0] - true)
    return np.max(errors / np.max(np.abs(true), axis=1, keepdims=True)), model


@pytest.mark.parametrize(
    "case",
    [
        "collision",
        *(pytest.param(base, marks=pytest.mark.slow) for base in ("drive", "ground", "force", "chain", "storeys")),
    ],
)
def test_another_set_is_another_scene(case):
    error, model = missed(case)
    assert error < 1e-10
    until = CASES[case][0]()[0]["output"]["until"]
    assert model.tau_max * model.seconds_per_tau == pytest.approx(float(until.removesuffix(" ms")) / 1000)
    assert {name: units[0] for name, units in model.units.items()} == CASES[case][1]


@pytest.mark.slow
@pytest.mark.parametrize("factor", ["load", "force"])
def test_loads_and_forces_that_change_with_discs_are_seen(factor, monkeypatch):
    def forgetful(*given, free_network=making.free_network):
        free = free_network(*given)
        return replace(free, factors=free.factors._replace(**{factor: fmpq(1)}))

    monkeypatch.setattr(making, "free_network", forgetful)
    assert missed("drive")[0] > 1e-3


def test_the_header_has_units_and_the_clock(tmp_path):
    first, _, _ = drive()
    wavesym.generate(wavesym.Scene(**first), tmp_path, runtime=["inertia", "load"])
    header = (tmp_path / "good.h").read_text()
    assert "#define GOOD_SECONDS_PER_TAU" in header
    assert "[1] steps[1] of the torque on disc 1, t = 0.0007 s [N*m]" in header
    assert "[2] inertia_3 [kg*m^2]" in header
