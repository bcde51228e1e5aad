"""Chains under parameters that come at run time: what the exact outputs of a chain with these numbers are."""

import shutil
import subprocess
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import wavesym
from tests.support.builds import LANGUAGES, STRICT
from tests.support.built_model import BuiltModel
from tests.support.slopes import beyond, slope_of
from tests.targets.test_runtime_c import SANITIZED
from wavesym.errors import WavesymError
from wavesym.running.toolchain import compiler


def shaft(p):
    """Three steps with delays of 1, 1/2 and 1/3, a brake between them, and an end that sends nothing back."""
    mass, brake, (one, two, three), (v, a, b, c), (s, t, r, q) = (
        p[name] for name in ("mass", "dashpot", "impedance", "velocity", "load")
    )
    return wavesym.Scene(
        name="shaft",
        system={
            "type": "chain",
            "parts": [
                {"mass": mass[0], "velocity": v},
                {"rod": 1, "impedance": one, "velocity": a},
                {"joint": True, "dashpot": brake[0], "name": "brake"},
                {"rod": 1, "speed": 2, "impedance": two, "velocity": b},
                {"rod": "1/3", "impedance": three, "velocity": c},
                "absorbing",
            ],
        },
        load=[{"at": 0, "times": [0, "7/5"], "steps": [s, t], "ramps": [r, q]}],
        output={
            "until": "47/10",
            "tolerance": "1e-11",
            "strain": ["1/3", "1-"],
            "velocity": ["brake"],
            "displacement": ["1/2", "7/3"],
            "acceleration": [0],
            "force": ["3/2"],
        },
    )


def frame(p):
    """Springs and dashpots to the ground and from mass to mass, a massless joint, and a ground that moves."""
    (m0, m1, m2), (d0, d1), (k0, k1), (one, two), (a, b) = (
        p[name] for name in ("mass", "dashpot", "spring", "impedance", "load")
    )
    return wavesym.Scene(
        name="frame",
        system={
            "type": "chain",
            "parts": [
                {"motion": "acceleration", "name": "ground"},
                {"rod": 1, "impedance": one},
                {"mass": m0, "name": "floor", "dashpot": d0},
                {"spring": k1, "dashpot": d1},
                {"mass": m1, "name": "box", "spring": k0},
                {"rod": "3/2", "impedance": two},
                {"mass": m2, "name": "roof"},
            ],
        },
        load=[{"at": "ground", "times": [0, "1/2"], "steps": [a, b]}],
        output={
            "until": 5,
            "tolerance": "1e-11",
            "velocity": ["floor", "box"],
            "acceleration": ["box"],
            "relative": ["roof"],
            "force": ["1/2"],
        },
    )


def tree(p):
    """A branch that turns the other way and twice as fast, and a soft coupling without mass."""
    (m0, m1), (d,), (k,), (one, two, three), (a,) = (
        p[name] for name in ("mass", "dashpot", "spring", "impedance", "load")
    )
    return wavesym.Scene(
        name="tree",
        system={
            "type": "chain",
            "parts": [
                {"mass": m0, "name": "motor"},
                {"rod": 1, "impedance": one},
                {"joint": True, "name": "gear"},
                {"spring": k, "dashpot": d},
                {"joint": True, "name": "shaft"},
                {"rod": 1, "impedance": two},
                "fixed",
            ],
            "branch": [
                {
                    "from": "gear",
                    "name": "side",
                    "ratio": -2,
                    "parts": [{"rod": "1/2", "impedance": three}, {"mass": m1, "name": "pump"}],
                }
            ],
        },
        load=[{"at": "motor", "times": [0], "steps": [a]}],
        output={
            "until": "9/2",
            "tolerance": "1e-11",
            "strain": ["side:1/4", "shaft+"],
            "velocity": ["pump", "gear"],
            "displacement": ["motor"],
        },
    )


NUMBERS = {
    shaft: {"mass": [1], "dashpot": [0.5], "impedance": [1, 4, 0.25], "velocity": [1, 0, 1, 0], "load": [1, -1, 0, 2]},
    frame: {"mass": [1, 0.5, 2], "dashpot": [0.25, 0.5], "spring": [2, 3], "impedance": [1, 2], "load": [1, -0.5]},
    tree: {"mass": [1, 0.5], "dashpot": [0.25], "spring": [4], "impedance": [1, 0.5, 2], "load": [1]},
}
HARD = {
    shaft: {
        "mass": [0.02],
        "dashpot": [1e-3],
        "impedance": [1, 1.0000001, 1e3],
        "velocity": [0] * 4,
        "load": [1, 0, 0, 0],
    },
    frame: {
        "mass": [0.05, 0.05, 30],
        "dashpot": [1e-3, 10],
        "spring": [1e-3, 40],
        "impedance": [0.1, 1],
        "load": [0, 1],
    },
    tree: {"mass": [0.03, 20], "dashpot": [1e-2], "spring": [1e-3], "impedance": [2, 2, 1e-2], "load": [3]},
}
EVERY = pytest.mark.parametrize("make", NUMBERS, ids=lambda make: make.__name__)
_MODELS = {}


def model_of(make):
    """Compiled once."""
    if make not in _MODELS:
        _MODELS[make] = wavesym.model(make(NUMBERS[make]), runtime=list(NUMBERS[make]))
    return _MODELS[make]


def exact(numbers):
    return {name: [Fraction(value) for value in values] for name, values in numbers.items()}


def missed(model, make, numbers, count=41):
    """The largest error of any output relative to its largest value."""
    tau = np.linspace(0, model.tau_max, count)
    true = wavesym.evaluator(make(exact(numbers)))(tau)
    largest = np.max(np.abs(true), axis=1)
    errors = np.max(np.abs(model.values(tau, **numbers)[0] - true), axis=1)
    assert np.all(errors[largest == 0] == 0)
    return float(np.max(errors[largest > 0] / largest[largest > 0], initial=0.0))


@pytest.mark.slow
@EVERY
def test_any_parameters_give_what_their_chain_gives(make):
    model = model_of(make)
    for numbers in (NUMBERS[make], HARD[make]):
        checks = model.check(**numbers)
        assert checks.status[0] == 0
        assert missed(model, make, numbers) <= max(checks.estimate[0], 1e-11) < 1e-8


POSITIVE = st.floats(1e-2, 1e2).map(lambda value: float(f"{value:.3g}"))
ANY = st.floats(-5, 5).map(lambda value: round(value, 2))


@pytest.mark.slow
@EVERY
@settings(max_examples=10, suppress_health_check=list(HealthCheck), phases=[Phase.generate])
@given(data=st.data())
def test_drawn_parameters(make, data):
    model = model_of(make)
    numbers = {
        name: data.draw(st.lists(ANY if name in ("velocity", "load") else POSITIVE, min_size=len(of), max_size=len(of)))
        for name, of in NUMBERS[make].items()
    }
    checks = model.check(**numbers)
    if checks.status[0] == 0:
        assert missed(model, make, numbers) <= 4 * max(checks.estimate[0], 1e-10)


@pytest.mark.slow
@EVERY
def test_derivatives_are_those_of_exact_values(make):
    model, tau = model_of(make), np.linspace(0, 4.5, 19)
    found = model.gradients(tau, **NUMBERS[make])
    for name, own in NUMBERS[make].items():
        for k, value in enumerate(own):
            h = 1e-5 * value if name not in ("velocity", "load") else 1
            both = [
                wavesym.evaluator(make(exact(NUMBERS[make] | {name: [*own[:k], value + side * h, *own[k + 1 :]]})))(tau)
                for side in (1, -1)
            ]
            true = (both[0] - both[1]) / (2 * h)
            errors = np.max(np.abs(found.by[name][0, k] - true), axis=1)
            # differences leave about 1e-10 of second order and 1e-16/1e-5 of rounding
            assert np.all(errors <= 1e-7 * np.max(np.abs(true), axis=1) + 1e-9)


def beyond_estimate(make, numbers, name, k):
    """The error of a derivative over its estimate, the truth from exact values."""
    tau = np.linspace(0, model_of(make).tau_max, 33)
    found, own = model_of(make).gradients(tau, **numbers), Fraction(numbers[name][k])

    def values(number):
        changed = [*numbers[name][:k], number, *numbers[name][k + 1 :]]
        return wavesym.evaluator(make(exact(numbers | {name: changed})))(tau)

    assert found.checks.status[0] == 0
    true, slack = slope_of(values, own, own / 128)
    return beyond(found.by[name][0, k], true, slack, found.estimates[name][0, k])


PART = st.floats(-1, 1).map(lambda power: float(f"{10**power:.3g}"))


@pytest.mark.slow
@EVERY
@settings(max_examples=6, suppress_health_check=list(HealthCheck), phases=[Phase.generate])
@given(data=st.data())
def test_estimates_of_derivatives_hold(make, data):
    name = data.draw(st.sampled_from([name for name in NUMBERS[make] if name not in ("velocity", "load")]))
    numbers = {
        name: data.draw(st.lists(ANY if name in ("velocity", "load") else PART, min_size=len(of), max_size=len(of)))
        for name, of in NUMBERS[make].items()
    }
    assert beyond_estimate(make, numbers, name, data.draw(st.integers(0, len(numbers[name]) - 1))) < 1


@pytest.mark.slow
def test_extremes_are_those_of_the_chain():
    found = model_of(shaft).peaks()
    for place, output in enumerate(wavesym.summary(shaft(NUMBERS[shaft])).outputs):
        assert abs(found.max[0, place] - output.max.value) < 1e-10
        assert abs(found.min[0, place] - output.min.value) < 1e-10


def selftest(folder, *changes):
    """Its exit status, with `changes` in the C."""
    folder.mkdir()
    scene = shaft(NUMBERS[shaft] | {"velocity": [0, 0, 0, 0]}).with_({"output.until": "5/2"})
    wavesym.generate(scene, folder, runtime=["mass", "impedance"])
    text = (folder / "shaft.c").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "shaft.c").write_text(text)
    compiler().run([*LANGUAGES["c99"], *STRICT, "-O1", "shaft.c", "shaft_selftest.c", "-o", "test", "-lm"], folder)
    return subprocess.run([folder / "test"], capture_output=True, check=False).returncode


@pytest.mark.slow
def test_its_selftest_passes(tmp_path):
    assert selftest(tmp_path / "right") == 0


@pytest.mark.slow
def test_its_selftest_sees_what_is_broken(tmp_path):
    assert selftest(tmp_path / "wrong", ("(at_last[j] - table[j]", "(0.999999 * at_last[j] - table[j]")) == 1


@pytest.mark.slow
@EVERY
def test_a_bad_number_is_refused(make, tmp_path):
    names = ["mass", "dashpot", "impedance", "load"]
    made = BuiltModel(make(NUMBERS[make]), names, tmp_path, flags=SANITIZED)
    own = [value for name in names for value in NUMBERS[make][name]]
    assert made.build(*own) == 0
    positive = len(own) - len(NUMBERS[make]["load"])
    for place in range(len(own)):
        for bad in (np.nan, np.inf, -np.inf, *([0.0, -1.0, -0.0] if place < positive else [])):
            assert made.build(*own[:place], bad, *own[place + 1 :]) == 1
            assert np.isnan(made.estimate)
            assert np.isnan(made.at(1.0)[1]).all()
        for huge in (1e308, 1e200, 1e-200, 1e-320):
            extreme = [*own[:place], huge, *own[place + 1 :]]
            status = made.build(*extreme)
            assert status in (0, 1, 2)
            assert np.isfinite(made.at(1.0)[1]).all() == (status == 0)
            assert made.tangents(extreme, 0.0, 1.0, 3)[0] in (status, 1)
    assert made.build(*own) == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        ("one - (real)(k == 0 ? 2 : 1) * now[i]", "one - (real)(k == 0 ? 1.999 : 1) * now[i]"),
        ("half * ((k == 1 ? (num)(2 * f[i][0])", "half * ((k == 1 ? (num)(1.999 * f[i][0])"),
        ("add_series(slope->rates", "if (0) add_series(slope->rates"),
        ("&slope->push[port], m->waves", "&tangent->error[1], m->waves"),
    ],
)
def test_a_mistake_is_seen(change, tmp_path):
    names = ["mass", "spring", "impedance"]
    right, wrong = (tmp_path / name for name in ("right", "wrong"))
    right.mkdir()
    wrong.mkdir()
    own = [value for name in names for value in NUMBERS[frame][name]]
    built = [BuiltModel(frame(NUMBERS[frame]), names, *of) for of in ((right,), (wrong, [change]))]
    values = [made.tangents(own, 0.0, 0.25, 21)[1] for made in built]
    assert np.max(np.abs(values[0] - values[1])) > 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
@EVERY
def test_it_compiles_without_a_warning(make, language, tmp_path):
    if language == "c++17" and shutil.which("g++") is None:
        pytest.skip("no C++ here")
    wavesym.generate(make(NUMBERS[make]), tmp_path, runtime=["impedance", "load"])
    for file in (f"{make.__name__}.c", f"{make.__name__}_selftest.c"):
        compiler().run([*LANGUAGES[language], *STRICT, "-c", file, "-o", f"{file}.o"], tmp_path)
        assert (tmp_path / f"{file}.o").stat().st_size > 0


@pytest.mark.parametrize(
    ("scene", "names", "message"),
    [
        (
            shaft(NUMBERS[shaft]),
            ["kappa"],
            r"write mass, dashpot, impedance, velocity or load \(kappa .* a chain of unlike rods has mass in its place",
        ),
        (shaft(NUMBERS[shaft]), ["spring"], "spring is unknown; write mass, dashpot, impedance, velocity or load"),
        (shaft(NUMBERS[shaft]), ["diameter"], "diameter is in the impedance of a rod: write that; or `wavesym sweep`"),
        (
            shaft(NUMBERS[shaft]),
            ["G"],
            r"load \(G changes travel times of a march, .* modes take stiffness",
        ),
        (wavesym.Scene.from_toml("drive_m1"), ["diameter"], r"load \(diameter changes the impedance .*`wavesym sweep`"),
        (wavesym.Scene.from_toml("examples/chains/mass_on_fixed_bar.toml"), ["mass"], "the contact at 0 opens"),
    ],
)
def test_what_is_not_served_is_refused(scene, names, message):
    with pytest.raises(WavesymError, match=message) as error:
        wavesym.model(scene, runtime=names)
    assert "\n" not in str(error.value)
