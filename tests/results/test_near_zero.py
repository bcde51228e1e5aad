"""What cannot be told from 0 is 0, at the first instant at which it is: in whatever way extremes are found."""

from __future__ import annotations

import numpy as np
import pytest

import wavesym
from wavesym.errors import CostError
from wavesym.exact.extremes import TrueExtreme, extremes
from wavesym.programs.modes.evaluator import modal_model
from wavesym.programs.modes.loads import sampled_roughness
from wavesym.results import many_records, summary
from wavesym.results.many_records import ManyRecords, SharedModes
from wavesym.results.near_zero import zero_within
from wavesym.results.sampling import sampled_extremes
from wavesym.scene import Scene, lower

GUN = [{"joint": True, "name": "gun"}, {"rod": 4}, "absorbing"]
RINGING = [{"joint": True, "name": "gun"}, {"rod": 1}, {"mass": "1/2"}, {"rod": 1}, "fixed"]


def chain(parts, until, load=(), **watched):
    return Scene(
        name="drawn", system={"type": "chain", "parts": parts}, load=list(load), output={"until": until} | watched
    )


def test_the_rule():
    values = np.array([[-1e-11, 2.0], [-3.0, 2e-10], [-1e-9, 1e-9], [0.0, 0.0]])
    taus = np.array([[4.0, 1.0], [1.0, 5.0], [2.0, 3.0], [0.0, 0.0]])
    found, when = values.copy(), taus.copy()
    zero_within(found, when, 1e-10, np.array([[0.0], [0.5], [0.0], [0.0]]))
    assert found.tolist() == [[0.0, 2.0], [-3.0, 0.0], [-1e-9, 1e-9], [0.0, 0.0]]
    assert when.tolist() == [[0.0, 1.0], [1.0, 0.5], [2.0, 3.0], [0.0, 0.0]]
    for known in (0.0, 1.0, np.nan, np.inf):  # exact, or nothing is known
        found, when = values.copy(), taus.copy()
        zero_within(found, when, known, 0.0)
        assert (found.tolist(), when.tolist()) == (values.tolist(), taus.tolist())


def test_true_extremes():
    """Beside 1 nobody sees 1e-20: where an output begins with 0 that is at 0, else where it is."""

    def greatest(*steps):
        load = {"at": "gun", "times": list(range(len(steps))), "steps": list(steps)}
        ((_, found),) = extremes(lower(chain(GUN, 3, [load], strain=["0"])))
        return found

    assert greatest(0, 1, "-1.00000000000000000001") == TrueExtreme(0.0, 0.0)
    assert greatest(1, "-1.00000000000000000001") == TrueExtreme(0.0, 1.0)
    assert greatest(1, "-0.99999999999999999999") == TrueExtreme(0.0, 1.0)
    assert greatest(0, 1, "-1.000000000000001").value == pytest.approx(1e-15, rel=1e-12)


@pytest.mark.parametrize("at_samples", [True, False])
def test_an_opening_contact(at_samples, monkeypatch):
    """The force of a mass that strikes a bar goes to 0, where the contact opens; programs have some noise there."""

    def refused(_):
        raise CostError("refused")

    scene = chain([{"mass": 1, "velocity": 1}, "contact", {"rod": 1}, "fixed"], 4, force=["0+"])
    (event,) = wavesym.evaluator(scene).events
    right = summary.sample_program

    def noisy(model, program, step):
        taus, values = right(model, program, step)
        values[0, taus >= event.double] = 1e-11 * np.cos(1e3 * taus[taus >= event.double])
        return taus, values

    monkeypatch.setattr(summary, "extremes_and_averages", refused)
    monkeypatch.setattr(summary, "sample_program", noisy)
    found = wavesym.summary(scene, at_samples=at_samples).outputs[0]
    assert found.max.value == 0.0
    assert found.max.at.tau == pytest.approx(event.double, rel=1e-2)
    assert found.min.value < -2


def test_samples_between_which_an_output_comes_to_0():
    """Nearer to 0 than its bound between two samples alone: told where it is found."""
    taus = np.linspace(0, 4, 42)

    def each(tau):
        return -((tau - np.pi / 2) ** 2)

    values, when = sampled_extremes(taus, each(taus)[None], each, bound=1e-6)
    assert values[0, 1] == 0.0
    assert when[0, 1] == pytest.approx(np.pi / 2, abs=1e-2)
    values, _ = sampled_extremes(taus, each(taus)[None], each)
    assert -1e-5 < values[0, 1] < 0


@pytest.mark.slow
def test_models_at_run_time():
    """What begins with 0 is 0 there; the velocity that begins with 1 is 0 only where a wave comes back."""
    load = {"at": "gun", "times": [0, 1], "steps": [1, 0], "ramps": [0, 1]}
    scene = chain(RINGING, 5, [load], strain=["0", "2"], velocity=["0", "1"], displacement=["1"])
    model = wavesym.model(scene, runtime=["mass"])
    peaks = model.peaks(mass=[[0.5], [0.25], [0.125], [-1]])
    raw = model._engine.peaks(model._parameter_rows({"mass": [[0.5], [0.25], [0.125], [-1]]})).values
    noise = (raw[:3, :, ::2] != 0) & (np.abs(raw[:3, :, ::2]) < 1e-12)
    assert noise.any()
    for found, tau, side in ((peaks.min, peaks.tau_min, 0), (peaks.max, peaks.tau_max, 1)):
        assert not found[:3][noise[..., side]].any()
        assert set(tau[:3][noise[..., side]]) <= {0.0, 2.0}
        assert np.isnan(found[3]).all()
    assert peaks.min[:3, 2].tolist() == [0.0] * 3
    assert peaks.tau_min[:3, 2].tolist() == [2.0] * 3
    for k, mass in enumerate(("1/2", "1/4", "1/8")):
        alone = wavesym.summary(scene.with_({"system.parts[2].mass": mass}))
        for number, output in enumerate(alone.outputs):
            assert (peaks.min[k, number] == 0) == (output.min.value == 0)
            assert (peaks.max[k, number] == 0) == (output.max.value == 0)
            if output.min.value == 0:
                assert output.min.at.tau == peaks.tau_min[k, number]


def test_many_records(monkeypatch):
    """All begin with 0; a little noise beyond it, later, is 0 at the start, as for a record alone."""
    samples = [0, 1, 1, 1, "0.9", "0.5", 0]
    scene = chain(
        [{"motion": "acceleration", "name": "ground"}, {"rod": 1}, {"mass": 3}],
        "7/2",
        [{"at": "ground", "spacing": "1/2", "samples": samples}],
        displacement=["1"],
        tolerance="1e-4",
    )
    model = lower(scene)
    right = many_records._extremes

    def noisy(*given):
        values, taus = right(*given)
        values[0, 0, 0], taus[0, 0, 0] = -1e-6 * values[0, 0, 1], 2.5
        return values, taus

    monkeypatch.setattr(many_records, "_extremes", noisy)
    values = np.array([[float(each) for each in samples] + [0.0, 0.0]])
    rough = [[sampled_roughness(values[0, 1:])]]
    records = ManyRecords(values[:, :, None], 0.0, 0.5, rough, np.ones((1, 1)))
    found = SharedModes(modal_model(model), 0.5).extremes(records)
    assert (found.values[0, 0, 0], found.taus[0, 0, 0]) == (0.0, 0.0)
    assert found.values[0, 0, 1] == pytest.approx(wavesym.summary(scene).outputs[0].max.value, rel=1e-4)
    assert 1e-6 < found.bounds[0] <= 1e-4
