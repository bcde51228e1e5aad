"""Frames with numbers far apart, whose modes are found at run time: no error is above its estimate (60 digits)."""

import numpy as np
import pytest

import wavesym
from tests.support.modal_reference import values_and_derivatives

SAMPLES, SPACING = [0, 1, -0.5, 0.7, -1.2, 0.3, 0], 0.25
STIFFNESS, MASS, RATIO = (400, 300, 200), (1, 1.5, 0.7), 0.05
TAUS = [k / 2 for k in range(1, 11)]

FRAME = wavesym.Scene(
    name="hostile",
    system={
        "type": "chain",
        "damping": str(RATIO),
        "parts": [
            {"motion": "acceleration", "name": "g"},
            *(
                part
                for k, m in zip(STIFFNESS, MASS, strict=True)
                for part in ({"spring": k}, {"mass": str(m), "name": f"n{k}"})
            ),
        ],
    },
    load=[{"at": "g", "spacing": str(SPACING), "samples": [str(x) for x in SAMPLES]}],
    output={"until": 5, "tolerance": "1e-6", "relative": [f"n{k}" for k in STIFFNESS]},
)

HOSTILE = {
    "as it is": (*STIFFNESS, *MASS, RATIO),
    "a soft first spring": (4e-4, 300, 200, *MASS, RATIO),
    "a softer one": (0.4, 300, 200, *MASS, RATIO),
    "a soft last spring": (400, 300, 2e-4, *MASS, RATIO),
    "a stiff first spring": (4e8, 300, 200, *MASS, RATIO),
    "a stiff second one": (400, 3e8, 200, *MASS, RATIO),
    "a stiff last one that rings": (400, 300, 2e8, *MASS, 0),
    "a light first mass": (*STIFFNESS, 1e-6, 1.5, 1, 0.02),
    "a light last mass": (*STIFFNESS, 1, 1.5, 1e-6, RATIO),
    "light masses": (*STIFFNESS, 1e-6, 1e-6, 1e-6, 0.02),
    "no damping": (*STIFFNESS, *MASS, 0),
    "hardly any": (*STIFFNESS, *MASS, 1e-9),
    "much": (*STIFFNESS, *MASS, 0.999),
    "a tuned damper": (400, 300, 0.03, 1, 1.5, 1e-4, RATIO),
}


@pytest.fixture(scope="module")
def model():
    return wavesym.model(FRAME, ["stiffness", "mass", "damping"])


def shares_of_estimates(model, sets):
    """How much of their estimates errors are: of each set (1 + numbers,), relative to the largest value."""
    sets = np.array(sets, float)
    given = {"stiffness": sets[:, :3], "mass": sets[:, 3:6], "damping": sets[:, 6:]}
    found = model.gradients(TAUS, **given)
    assert np.all(found.checks.status == 0)
    made = np.concatenate([found.values[:, None], *(found.by[name] for name in given)], axis=1)
    estimates = [found.checks.estimate[:, None], *(found.estimates[name] for name in given)]
    exact = np.array([values_and_derivatives(numbers, SAMPLES, SPACING, TAUS) for numbers in sets.tolist()])
    errors = np.abs(made - exact).max(axis=3) / np.abs(exact).max(axis=3)
    return errors.max(axis=2), np.concatenate(estimates, axis=1)


QUICK = ("as it is", "a soft first spring", "a stiff last one that rings", "hardly any")


@pytest.mark.parametrize("names", [QUICK, pytest.param(tuple(HOSTILE), marks=pytest.mark.slow)], ids=["quick", "all"])
def test_no_error_is_above_its_estimate(model, names):
    """And estimates are of use: values are known to 1e-10, and where numbers are alike gradients to 1e-5."""
    errors, estimates = shares_of_estimates(model, [HOSTILE[name] for name in names])
    assert np.all(errors <= estimates)
    assert estimates[:, 0].max() < 2e-10
    assert errors[:, 0].max() < 1e-12
    assert estimates[0, 1:].max() < 1e-5


@pytest.mark.slow
def test_a_gradient_of_nothing_is_said_to_be_none(model):
    """A spring that holds 1e-6 of the others' mass: two outputs know nearly nothing of it."""
    errors, estimates = shares_of_estimates(model, [HOSTILE["a light last mass"]])
    assert errors[0, 3] > 0.1
    assert estimates[0, 3] >= 1


def drawn(generator):
    """Stiffnesses to 1e6 apart, masses down to 1e-6, ratios that are hard."""
    stiffness = np.array(STIFFNESS) * generator.uniform(0.5, 2, 3)
    mass = np.array(MASS) * generator.uniform(0.5, 2, 3)
    stiffness *= np.where(generator.random(3) < 0.5, 10 ** generator.uniform(-3, 3, 3), 1)
    mass *= np.where(generator.random(3) < 0.5, 10 ** generator.uniform(-6, 0, 3), 1)
    return [*stiffness, *mass, generator.choice([0, 1e-9, 1e-4, 0.02, 0.05, 0.3, 0.999])]


@pytest.mark.slow
def test_no_error_of_drawn_frames_is_above_its_estimate(model):
    generator = np.random.default_rng(28)
    errors, estimates = shares_of_estimates(model, [drawn(generator) for _ in range(60)])
    assert np.all(errors <= estimates)
