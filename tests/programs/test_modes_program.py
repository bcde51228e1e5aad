"""Modes of scenes as programs: within their bounds of values that are exact, or of elements ever finer; and chosen."""

import ctypes
import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq

import wavesym
from tests.support import oscillators
from tests.support.assembly import exact
from tests.support.oscillators import by_exponentials
from wavesym.cli import main
from wavesym.errors import ToleranceError, UnservedError
from wavesym.mechanics.damping import Damping
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs import choice
from wavesym.programs.choice import attempts, choose
from wavesym.programs.making import make
from wavesym.programs.modes import evaluator
from wavesym.programs.modes.evaluator import modes
from wavesym.programs.request import Request, unmet_tolerance
from wavesym.results.response import Response
from wavesym.running.compilation import import_text
from wavesym.running.native import library
from wavesym.scene import lower
from wavesym.targets.files import files

SAMPLES = [0, *((7 * k * k + 3 * k) % 17 - 8 for k in range(1, 20))]
WATCHED = {
    "strain": ["1/2", "1+"],
    "velocity": [0, 2],
    "displacement": ["1/2", 1],
    "acceleration": [1],
    "force": ["1/3"],
    "drift": [2],
}
SCENES = {
    "building": {
        "system": {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "ground"},
        "load": [{"spacing": "5/7", "samples": SAMPLES}],
        "output": WATCHED | {"relative": [2]},
    },
    "drive, which nothing holds": {
        "system": {"type": "drive", "m": 2, "kappa": ["1/4", "3/5"], "inertia": [1, 2, "1/2"]},
        "load": [
            {"body": 1, "spacing": "5/7", "samples": SAMPLES},
            {"body": 3, "times": ["1/3", 4], "ramps": ["1/2", -1]},
        ],
        "output": WATCHED,
    },
    "chain of unequal rods with a spring": {
        "system": {
            "type": "chain",
            "parts": [
                {"motion": "acceleration", "name": "ground"},
                {"rod": 1},
                {"mass": 3, "spring": "1/5"},
                {"rod": "3/2", "impedance": 2},
                {"mass": "1/2", "name": "top"},
            ],
        },
        "load": [{"at": "ground", "spacing": "5/7", "samples": SAMPLES}, {"at": "top", "times": [2], "ramps": [1]}],
        "output": {"strain": ["1/2", "1+"], "velocity": ["top"], "displacement": [1], "relative": ["top"]},
    },
}


def scene(name="building", tolerance="1e-4", until=12, **output):
    of = SCENES[name]
    return wavesym.Scene(
        name="shaken",
        system=of["system"],
        load=of["load"],
        output={**of["output"], "until": until, "tolerance": tolerance, **output},
    )


def wrong(model, real, right, taus):
    """How far modes are from values that are right, and from what they may be at most, of each output."""
    made = modes(model, real)
    errors = np.abs(made.scheme.evaluate(taus).astype(float) - right).max(axis=1)
    return made, errors, np.array([output.bound * output.largest for output in made.outputs])


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SCENES)
def test_modes_are_within_their_bounds_and_motion_is_nearly_exact(name):
    given = scene(name)
    model = lower(given)
    taus = np.linspace(0, model.horizon(), 97)
    response = wavesym.evaluator(given)
    right = response(taus)
    assert response.program is None
    made, errors, bounds = wrong(model, DOUBLE, right, taus)
    assert np.all(errors <= bounds)
    assert made.error_bound <= 1e-4
    largest = np.abs(right).max(axis=1)
    assert np.all([output.largest for output in made.outputs] <= largest * 1.2)
    bodies = [k for k, each in enumerate(made.outputs) if each.name.startswith(("displacement@1", "relative"))]
    bodies = [k for k in bodies if "/" not in made.outputs[k].name]
    assert bodies
    assert np.all(errors[bodies] <= 1e-11 * largest[bodies])


def test_floats_are_within_their_bounds():
    given = scene(tolerance="1/20")
    taus = np.linspace(0, 12, 97, dtype=np.float32).astype(float)
    _, errors, bounds = wrong(lower(given), SINGLE, wavesym.evaluator(given)(taus), taus)
    assert np.all(errors <= bounds)
    assert np.all(bounds > 0)


def test_a_frequency_that_is_off_is_beyond_the_bounds(monkeypatch):
    right = evaluator.modal_system

    def off(model):
        made = right(model)
        return replace(made, system=replace(made.system, frequency=made.system.frequency * (1 + 1e-3)))

    monkeypatch.setattr(evaluator, "modal_system", off)
    given = scene()
    taus = np.linspace(0, 12, 97)
    _, errors, bounds = wrong(lower(given), DOUBLE, wavesym.evaluator(given)(taus), taus)
    assert not np.all(errors <= bounds)


@pytest.mark.quick(1)
@pytest.mark.parametrize("ratio", ["1/20", "3/2"])
def test_a_damped_building_is_what_elements_ever_finer_come_to(ratio):
    """Of consistent mass, modally damped, stepped by exponentials of matrices; errors fall with the fourth power."""
    building = scene(
        until=9, **{name: [] for name in ("strain", "acceleration", "force", "relative")},
        drift=[1, 2], velocity=[1, 2], displacement=[1, 2],
    ).with_({"system.kappa": [1, "1/3", "1/3"]})  # fmt: skip
    model = replace(lower(building), damping=Damping((exact(ratio),)))
    made = modes(model, DOUBLE)
    order = [list(model.probes).index(probe) for name in ("drift", "velocity", "displacement") for probe in model.probes
             if probe.quantity == name]  # fmt: skip
    for tau in (2.5, 8.0):
        coarse, middle, fine = (
            by_exponentials(oscillators.storeys(2, n, float(Fraction(ratio)), 3.0), made.loads, tau) for n in (4, 8, 16)
        )
        once, twice = middle + (middle - coarse) / 3, fine + (fine - middle) / 3
        found = made.scheme.evaluate(tau)[order]
        assert np.all(np.abs(found - twice) <= np.abs(once - twice) + 1e-4 * np.abs(twice))
        assert np.all(np.abs(found - twice) <= 2e-3 * np.abs(twice).max())


@pytest.mark.parametrize(("period", "published", "between"), [(0.5, 2.674, 2.68706), (1, 5.966, 5.96722)])
def test_one_light_storey_has_the_published_peak(period, published, between):
    """A rod of 1e-4 of the mass on it, 2 % of critical damping, under El Centro: peaks in inches, at samples too."""
    record = oscillators.el_centro()
    spacing = Fraction(0.02 * 100 * 2 * math.pi / period).limit_denominator(10**9)
    second = float(spacing) / 0.02
    storey = wavesym.Scene(
        name="storey",
        system={
            "type": "chain",
            "parts": [{"motion": "acceleration", "name": "ground"}, {"rod": 1}, {"mass": 10_000, "name": "floor"}],
        },
        load=[{"at": "ground", "spacing": spacing, "samples": [Fraction(int(a.p), int(a.q)) for a in record]}],
        output={"until": spacing * (len(record) - 1), "tolerance": "1e-5", "relative": ["floor"]},
    )
    made = modes(replace(lower(storey), damping=Damping((fmpq(1, 50),))), DOUBLE)
    inches = oscillators.INCHES_OF_G / second**2
    taus = np.linspace(0, made.tau_max, 16 * (len(record) - 1) + 1)
    values = inches * np.abs(made.scheme.evaluate(taus))[0]
    assert values[::16].max() == pytest.approx(published, abs=6e-4)
    assert values.max() == pytest.approx(between, abs=2e-4)


LONG = scene(until=200, tolerance="1e-2", strain=[], acceleration=[], force=[]).with_(
    {"load[0].spacing": "5/397", "load[0].samples": [k % 7 for k in range(1500)]}
)


def test_what_auto_takes():
    """Pieces where they do; modes for a record that would be too many pieces, or with damping; a march for jumps."""
    model = lower(scene(until=5))
    assert choose(model).name in ("closed", "pieces")
    chosen = choose(lower(LONG))
    assert chosen.name == "modes"
    assert "pieces: " in chosen.reason
    assert chosen.reason.endswith(chosen.evaluator.summary)
    with pytest.raises(UnservedError, match=r"jumps by 1 at tau = 0"):
        choose(lower(scene(until=5).with_({"load[0].samples[0]": 1})), "modes")
    assert choose(replace(model, damping=Damping((fmpq(1, 20),)))).name == "modes"
    jump = lower(scene(until=5).with_({"load[0].samples[0]": 1}))
    assert "modes" not in choose(jump).reason
    damped = replace(jump, damping=Damping((fmpq(1, 20),)))
    for ask in (choose, lambda model: Response(model)([1.0])):
        with pytest.raises(UnservedError, match=r"^load: a jumps by 1 at tau = 0"):
            ask(damped)
    assert [one.kind for one in attempts(jump)][:2] == ["closed", "pieces"]


def test_a_tolerance_that_takes_too_many_modes_is_refused_with_all_that_was_tried(monkeypatch):
    def refuse(model):
        raise unmet_tolerance(model.tolerance, {"modes": "7 modes leave 0.06"}, 0.06)

    monkeypatch.setattr(evaluator, "modal_system", refuse)
    monkeypatch.delitem(choice.MAKERS, "march")
    with pytest.raises(
        ToleranceError,
        match=r"^output.tolerance: 0.01 cannot be met; write 1e-01 or more \(closed: .*; modes: 7 modes leave 0.06\)$",
    ):
        choose(lower(LONG))
    with pytest.raises(
        ToleranceError,
        match=r"^output.tolerance: 0.01 cannot be met; write 1e-01 or more \(modes: 7 modes leave 0.06\)$",
    ):
        choose(lower(LONG), "modes")
    with pytest.raises(ToleranceError, match="modes: 7 modes leave"):
        wavesym.evaluator(LONG)([1.0])


def streamed(program, made, samples):
    """The outputs after each sample, by the stream in C."""
    stream = library(made["shaken.c"], header=("shaken.h", made["shaken.h"]))
    state = (ctypes.c_double * (2 * int(program.constants["modes"]) + 3))()
    stream.shaken_init(state)
    stream.shaken_step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p]
    out = np.empty((len(samples), len(program.outputs)))
    for sample, row in zip(samples, out, strict=True):
        load = (ctypes.c_double * 1)(sample)
        assert stream.shaken_step(state, program.constants["spacing"], load, row.ctypes.data) == 0
    return out.T


@pytest.mark.slow
def test_c_takes_the_samples_of_the_scene_and_numpy_has_them(tmp_path):
    program = make(lower(scene()), Request(evaluator="modes"), tested=True)
    made = files(program, "all")
    assert "--evaluator modes" in made["shaken.h"]
    module = import_text(made["shaken.py"], "shaken")
    taus = np.linspace(-1, 13, 80)
    np.testing.assert_array_equal(module.evaluate(taus), program.evaluate(taus))
    right = module.evaluate(np.arange(17) * 5 / 7)
    values = streamed(program, made, SAMPLES[:17])
    np.testing.assert_allclose(values, right, rtol=0, atol=1e-11 * np.abs(right).max())


def test_c_without_a_load_takes_one_that_moves_nothing():
    parts = ["fixed", {"rod": 1}, {"mass": 1, "name": "n"}]
    of = wavesym.Scene(
        name="shaken",
        system={"type": "chain", "parts": parts, "damping": "1/20"},
        output={"until": 3, "tolerance": "1e-3", "displacement": ["n"]},
    )
    program = make(lower(of), Request(), tested=True)
    assert not streamed(program, files(program, "all"), SAMPLES).any()


PHYSICAL = {
    "building": (
        {
            "units": {"acceleration": "ft/s^2", "length": "inch"},
            "system": {
                "type": "building",
                "base": "ground",
                "damping": "1/20",
                "storey": [
                    {
                        "count": 2,
                        "height": "3.5 m",
                        "stiffness": "678 MN/m",
                        "column_mass": "10 t",
                        "floor_mass": "30 t",
                    }
                ],
            },
            "load": [{"spacing": "0.02 s", "unit": "g", "samples": SAMPLES}],
            "output": {"until": "0.5 s", "tolerance": "1e-3", "relative": [2], "acceleration": [1]},
        },
        "a [ft/s^2]",
        9.80665 / 0.3048,
    ),
    "drive, at the last body": (
        {
            "units": {"moment": "kN*m"},
            "system": {
                "type": "drive",
                "shaft": [{"length": "2 m", "J": "1e-4 m^4", "G": "80 GPa", "rho": "7850 kg/m^3"}] * 2,
                "disc": [{"inertia": "10 kg*m^2"}, {"inertia": "20 kg*m^2"}, {"inertia": "5 kg*m^2"}],
            },
            "load": [{"body": 3, "spacing": "0.01 s", "unit": "N*m", "samples": SAMPLES}],
            "output": {"until": "0.2 s", "tolerance": "1e-3", "displacement": [0, 2]},
        },
        "M3 [kN*m]",
        1e-3,
    ),
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", PHYSICAL)
def test_a_stream_takes_loads_in_units_of_results(name):
    """What a scene says in one unit, in another."""
    fields, told, size = PHYSICAL[name]
    program = make(lower(wavesym.Scene(name="shaken", **fields)), Request(evaluator="modes"))
    made = files(program, "all")
    assert program.sources == (told,)
    assert told in made["shaken.h"]
    values = streamed(program, made, [size * sample for sample in SAMPLES])
    taus = program.constants["spacing"] * np.arange(len(SAMPLES))
    inside = taus <= program.tau_max
    right = import_text(made["shaken.py"], "shaken").evaluate(taus[inside])
    np.testing.assert_allclose(values[:, inside], right, rtol=0, atol=1e-11 * np.abs(right).max())


RUN = """
name = "shaken"
system = { type = "building", m = 2, kappa = ["1/30", "1/30", "1/30"], base = "ground" }
load = [{ record = "RECORD", spacing = "4999/1000", start = "4999/1000" }]
output = { until = 7500, tolerance = "1e-4", strain = [0], displacement = [2] }
"""


@pytest.mark.slow
def test_run_says_that_values_are_of_modes_and_how_good(tmp_path, capsys):
    record = tmp_path / "record.csv"
    record.write_text("a\n" + "".join(f"{float(a)}\n" for a in oscillators.el_centro()[1:]))
    path = tmp_path / "shaken.toml"
    path.write_text(RUN.replace("RECORD", record.name))
    assert main(["run", str(path), "--samples", "11"]) == 0
    out, err = capsys.readouterr()
    given = wavesym.Scene.from_toml(path)
    response = wavesym.evaluator(given)
    assert f"values of modes, not right to the last bit: proved bound of the error {response.error_bound:g}" in err
    assert response.program.kernel == "modes"
    assert response.error_bound <= 1e-4
    rows = np.array([[float(x) for x in line.split(",")] for line in out.splitlines()[1:]])
    np.testing.assert_array_equal(rows[:, 1:].T, response(rows[:, 0]))
    assert response([]).shape == (2, 0)
    assert np.allclose(response(rows[5, 0]), rows[5, 1:], rtol=1e-9)  # one value alone
