"""What is told of extremes, and how they are looked for where no polynomials are at hand."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from math import nextafter, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import fmpq

import wavesym
from wavesym.cli import main
from wavesym.cli.run import DEFAULT_SAMPLES
from wavesym.documents.summary import summary_text
from wavesym.errors import CostError
from wavesym.exact.extremes import extremes
from wavesym.exact.first_arrivals import first_arrivals, light_arrivals
from wavesym.mechanics.clock import Clock
from wavesym.mechanics.damping import Damping
from wavesym.mechanics.model import Model
from wavesym.pictures.page.document import page
from wavesym.programs import choice
from wavesym.programs.form import Form
from wavesym.programs.making import make
from wavesym.programs.modes.records import Panels
from wavesym.programs.request import Request
from wavesym.results import sampling, statistics, summary
from wavesym.results.peaks import case_names
from wavesym.results.presentation import number_text
from wavesym.results.rows import SAMPLES, own_samples
from wavesym.results.sampling import sampled_extremes
from wavesym.results.summary import summarise
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import sample_comb

BUILT_IN = ["building_m2", "collision_m4", "drive_m1", "geared_drive"]


def test_samples_are_those_of_run():
    assert SAMPLES == DEFAULT_SAMPLES


def told(capsys, *arguments):
    """Standard output of a command."""
    assert main(["summary", *arguments]) == 0
    return capsys.readouterr().out


def test_json_is_what_text_is(capsys):
    found = json.loads(told(capsys, "building_m2", "--format", "json"))
    assert set(found) == {"outputs", "bound"}
    scene = Scene.from_toml("building_m2")
    assert [output["name"] for output in found["outputs"]] == list(wavesym.evaluator(scene).outputs)
    text = told(capsys, "building_m2").splitlines()
    for output, row in zip(found["outputs"], text[1:], strict=False):
        assert set(output) == {"name", "unit", "min", "max", "arrival", "mean", "rms", "residual"}
        assert set(output["min"]) == set(output["max"]) == {"value", "tau", "time"}
        assert output["unit"] == ""
        assert output["min"]["time"] is None
        numbers = [output["min"]["value"], output["min"]["tau"], output["max"]["value"], output["max"]["tau"]]
        numbers += [output[name] for name in ("arrival", "mean", "rms", "residual")]
        assert row.split() == [output["name"], *(f"{number:.7g}" for number in numbers)]
    assert 0 < found["bound"] < 2e-16


def test_a_clock_tells_time():
    model = lower(Scene.from_toml("drive_m1"))
    plain, timed = summarise(model), summarise(replace(model, clock=Clock(fmpq(1, 250), fmpq(4), "ms")))
    assert timed.time_unit == "ms"
    for before, after in zip(plain.outputs, timed.outputs, strict=True):
        assert after.max.at == (before.max.at.tau, 4 * before.max.at.tau)
        assert after.arrival == (before.arrival.tau, 4 * before.arrival.tau)


def test_at_samples_those_of_run_are_looked_at(capsys, tmp_path):
    scene = Scene.from_toml("building_m2")
    assert main(["run", "building_m2", "-o", str(tmp_path / "run.csv")]) == 0
    rows = np.loadtxt(tmp_path / "run.csv", delimiter=",", skiprows=1)
    found = wavesym.summary(scene, at_samples=True)
    for column, output in zip(rows.T[1:], found.outputs, strict=True):
        assert (output.min.value, output.max.value) == (column.min(), column.max())
        assert output.max.at.tau == rows[column.argmax(), 0]


def test_at_samples_those_of_a_record_are_looked_at():
    samples = [0, 1, "-1/2", 3, 0, 0]
    scene = Scene.from_toml("building_m2").with_({"load": [{"spacing": "1/3", "samples": samples}], "output.until": 5})
    found = wavesym.summary(scene, at_samples=True)
    assert found.how == "the values at 16 samples"
    taus = np.arange(16) / 3
    values = wavesym.evaluator(scene)(taus)
    assert [output.max.value for output in found.outputs] == values.max(axis=1).tolist()
    true = wavesym.summary(scene)
    assert all(at.max.value <= each.max.value for at, each in zip(found.outputs, true.outputs, strict=True))


# first arrivals


@pytest.mark.parametrize("name", BUILT_IN)
def test_an_output_is_0_until_it_first_moves(name):
    scene = Scene.from_toml(name)
    response = wavesym.evaluator(scene)
    for k, first in enumerate(first_arrivals(lower(scene))):
        after = [float(first) + (response.tau_max - float(first)) * step for step in (1e-6, 1e-3, 1e-2)]
        assert response(after)[k].any()
        if first > 0:
            before = np.linspace(0, nextafter(float(first), 0), 200)
            assert not response(before)[k].any()


def test_arrivals_are_told_where_contacts_open_and_close():
    parts = [{"rod": 2, "velocity": 1}, "contact", {"rod": 3}, {"contact": 1}, {"rod": 1}, "absorbing"]
    system = {"type": "chain", "parts": parts}
    output = {"until": 12, "velocity": ["0", "5/2", "11/2"], "strain": ["1/2"]}
    model = lower(Scene(name="bars", system=system, output=output))
    strain, *others = first_arrivals(model)
    # the front needs 3 to the other end, which moves with the velocity 1 then and crosses the gap in 1
    assert (strain, others[:2]) == (fmpq(3, 2), [fmpq(0), fmpq(1, 2)])
    assert float(others[2]) == pytest.approx(3 + 1 + 0.5, rel=1e-12)


def test_what_nothing_reaches_never_arrives(capsys):
    found = wavesym.summary(Scene.from_toml("drive_m1").with_({"load": []}))
    assert all(output.arrival is None for output in found.outputs)
    assert (found.largest_drift, found.drifts_cost_too_much) == (None, False)
    late = Scene.from_toml("building_m2").with_({"output.until": "1/4"})
    assert [output.arrival for output in wavesym.summary(late).outputs] == [None] * 6


def test_the_largest_drift_is_that_of_all_rods():
    scene = Scene.from_toml("building_m2")
    found = wavesym.summary(scene).largest_drift
    moved = wavesym.evaluator(scene.with_({"output.displacement": [0, 1, 2]}))
    places = [moved.outputs.index(f"displacement@{x}") for x in range(3)]
    values = moved(np.linspace(0, moved.tau_max, 2001))[places]
    drifts = np.abs(np.diff(values, axis=0))
    rod = int(drifts.max(axis=1).argmax())
    assert found.name == f"drift@{rod + 1}"
    assert abs(found.largest.value) == pytest.approx(drifts.max(), rel=1e-4)
    assert abs(found.largest.value) >= drifts.max() * (1 - 1e-15)
    asked = wavesym.summary(scene.with_({"output.drift": [1, 2]}))
    assert asked.largest_drift == found


# looked for by samples


@pytest.fixture
def unproved(monkeypatch):
    """No polynomials."""

    def refused(_):
        raise CostError("refused")

    monkeypatch.setattr(summary, "extremes_and_averages", refused)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", BUILT_IN)
def test_samples_find_what_is_proved(name, unproved):
    scene = Scene.from_toml(name)
    found = wavesym.summary(scene)
    assert not found.proved
    for output, (least, greatest) in zip(found.outputs, extremes(lower(scene)), strict=True):
        size = max(abs(least.value), abs(greatest.value))
        for peak, proved in ((output.min, least), (output.max, greatest)):
            assert peak.value == pytest.approx(proved.value, rel=0, abs=(found.bound + 2e-9) * size)
            if proved.reached:
                assert peak.at.tau == pytest.approx(proved.tau, rel=1e-4)


def test_text_and_json_tell_what_is_not_proved(unproved, capsys):
    assert "an estimate" in told(capsys, "drive_m1")
    assert main(["summary", "drive_m1", "--format", "json"]) == 0
    assert "an estimate" in capsys.readouterr().err


def waves(tau):
    """Two tops, the higher of which is between 16 samples of a step."""
    return np.array([np.sin(tau) + 1e-3 * np.cos(40 * tau), np.minimum(tau, 1.0), np.zeros_like(tau)])


def each(tau):
    """Each of them at instants of its own."""
    return np.einsum("oon->on", waves(tau))


def test_tops_between_samples_are_found():
    coarse, fine = np.linspace(0, 6, 97), np.linspace(0, 6, 600_001)
    values, taus = sampled_extremes(coarse, waves(coarse), each)
    assert values[0, 1] == pytest.approx(waves(fine)[0].max(), abs=1e-9)
    assert values[0, 1] >= waves(coarse)[0].max() + 1e-6
    assert waves(taus[0])[0] == pytest.approx(values[0], abs=1e-15)
    assert (values[1].tolist(), taus[1].tolist()) == ([0, 1], [0, 1])
    assert (values[2].tolist(), taus[2].tolist()) == ([0, 0], [0, 0])


def test_samples_alone_miss_them(monkeypatch):
    monkeypatch.setattr(sampling, "_ROUNDS", 0)
    coarse = np.linspace(0, 6, 97)
    values, _ = sampled_extremes(coarse, waves(coarse), each)
    assert values[0, 1] < waves(np.linspace(0, 6, 600_001))[0].max() - 1e-6


def test_too_many_samples_are_refused_before_a_program_is_made(unproved, monkeypatch):
    monkeypatch.setattr(summary, "_MOST_SAMPLES", 100)
    monkeypatch.setattr(summary, "make", None)
    with pytest.raises(CostError, match="a shorter horizon or fewer outputs help"):
        wavesym.summary(Scene.from_toml("drive_m1"))


# records

ROOT = Path(wavesym.__file__).parents[1]


MORE = 1 + 1e-4 / 6
"""What rods of 1e-4 of the mass make of a period, and of what the ground does: consistent mass, 1/3 and 1/2."""


def storey(period):
    """Of one storey, 2 % damped, on the ground of El Centro: an oscillator of this period."""
    system = {
        "type": "building",
        "base": "ground",
        "storey": [
            {"height": "3 m", "stiffness": f"{1e6 * (2 * pi / period * MORE) ** 2:.9f} N/m", "column_mass": "0.1 t",
             "floor_mass": "1000 t"}
        ],
    }  # fmt: skip
    record = ROOT / "examples" / "records" / "elcentro_1940_ns_peknold.at2"
    load = {"record": str(record), "start": "0.02 s"}
    output = {"until": "31.18 s", "tolerance": 1e-5, "relative": [1]}
    units = {"length": "inch"}
    scene = Scene(name="storey", units=units, system=system, load=[load], output=output)
    return scene, replace(lower(scene), damping=Damping((fmpq(1, 50),)))


@pytest.mark.slow
@pytest.mark.parametrize(("period", "sampled", "true"), [(0.5, 2.67389, 2.68706), (2.0, 7.46497, 7.46629)])
def test_published_peaks_of_one_storey(period, sampled, true):
    """Chopra's 2.674 and 7.465 in are those at the samples of the record; higher ones lie between."""
    scene, model = storey(period)
    found = summarise(model)
    assert not found.proved
    assert found.outputs[0].unit == "inch"
    assert abs(found.outputs[0].largest.value) == pytest.approx(true * MORE, abs=1e-5)
    at = summarise(model, own_samples(model, sample_comb(scene)))
    assert abs(at.outputs[0].largest.value) == pytest.approx(sampled * MORE, abs=1e-5)
    assert at.how == "the values of modes at 1560 samples"


def test_extremes_at_samples_are_those_of_the_finest_record():
    """A long rod moves by force over impedance: both forces together are largest between the samples of the other."""
    fine, coarse = {"spacing": "1/4", "samples": [0, 0, 3, 0]}, {"spacing": 1, "samples": [0, 1, 0]}
    for loads in ([fine, coarse], [coarse, fine]):
        scene = Scene(
            name="rod",
            system={"type": "chain", "parts": [{"joint": True, "name": "end"}, {"rod": 1}, "absorbing"]},
            load=[{"at": "end", **load} for load in loads],
            output={"until": 3, "tolerance": 1e-9, "velocity": ["end"]},
        )
        assert sample_comb(scene) == (0, fmpq(1, 4))
        assert lower(scene).spacing == fmpq(1, 4)
        (end,) = summarise(lower(scene), own_samples(lower(scene), sample_comb(scene))).outputs
        assert (abs(end.largest.value), end.largest.at.tau) == (pytest.approx(3.5, rel=1e-9), 0.5)


def test_values_at_places_in_panels_are_those_of_the_program():
    times, ramps = ["1/3", 1, "5/2", 3, 7], [1, -1, 2, "-5/2", "1/2"]
    load = [{"times": times, "a": [0] * 5, "b": ramps}]
    scene = Scene.from_toml("building_m2").with_({"system.base": "ground", "load": load, "output.tolerance": "1e-3"})
    model = replace(lower(scene), damping=Damping((fmpq(1, 20),)))
    program = make(model, Request("modes"))
    taus, values = Panels.from_program(program).sample(0.3)
    assert np.diff(taus).min() > 0
    assert np.diff(taus).max() <= 0.3
    assert (taus[0], taus[-1]) == (0, program.tau_max)
    expected = program.evaluate(taus)
    assert np.abs(values - expected).max(axis=1) == pytest.approx(0, abs=1e-13 * np.abs(expected).max())


def test_arrivals_in_the_light_cone_are_those_of_transforms():
    load = [{"times": ["1/3", 1], "a": [0, 0], "b": [1, -1]}]
    watched = {"output.relative": [2], "output.acceleration": [1], "output.drift": [2], "output.force": [0]}
    scene = Scene.from_toml("building_m2").with_({"system.base": "ground", "load": load} | watched)
    assert light_arrivals(lower(scene)) == first_arrivals(lower(scene))


# as arrays


def test_peaks_of_one_scene_and_of_several():
    scene = Scene.from_toml("drive_m1")
    one = wavesym.peaks(scene, keep=list(statistics.ARRAYS))
    true = wavesym.summary(scene)
    assert one.outputs == tuple(output.name for output in true.outputs)
    assert one["max"].tolist() == [output.max.value for output in true.outputs]
    assert one["tau_min"].tolist() == [output.min.at.tau for output in true.outputs]
    assert one["rms"].tolist() == [output.rms for output in true.outputs]
    assert list(one) == list(statistics.ARRAYS)
    several = wavesym.peaks([scene, Scene.from_toml("building_m2"), scene.with_({"system.kappa[0]": "1/2"})])
    assert several.cases == ("drive_m1", "building_m2", "drive_m1")
    assert several["max"].shape == (3, len(several.outputs))
    assert several["max"][0, : len(true.outputs)].tolist() == one["max"].tolist()
    absent = [k for k, name in enumerate(several.outputs) if name not in one.outputs]
    assert np.isnan(several["min"][0, absent]).all()


def test_cases_are_named_by_what_varies():
    scene = Scene.from_toml("drive_m1")
    changes = [{"system.kappa[0]": kappa, "output.until": until} for kappa in ("1/2", 2) for until in (3, 4)]
    names = case_names([scene.with_(each) for each in changes])
    assert names[1] == "system.kappa[0] = 1/2, output.until = 4"
    assert len(set(names)) == 4
    assert case_names([scene, scene]) == ("drive_m1", "drive_m1")
    longer = scene.with_({"load[0].times": [0, 1, 2, 3, 4], "load[0].steps": [1, 2, 3, 4, 5]})
    assert case_names([scene, longer]) == ("drive_m1", "drive_m1")  # too many fields for a name


def test_peaks_as_labelled_tables():
    xarray, pandas = pytest.importorskip("xarray"), pytest.importorskip("pandas")
    scene = Scene.from_toml("drive_m1")
    found = wavesym.peaks([scene, scene.with_({"system.kappa[0]": 2})], keep=["max", "rms"])
    table = found.to_xarray()
    assert isinstance(table, xarray.Dataset)
    assert table["max"].sel(case="system.kappa[0] = 2", output="strain@0").item() == found["max"][1, 0]
    rows = found.to_pandas()
    assert isinstance(rows, pandas.DataFrame)
    assert rows.loc[("system.kappa[0] = 2", "strain@0"), "rms"] == found["rms"][1, 0]
    assert list(wavesym.peaks(scene).to_pandas().index) == list(found.outputs)


@pytest.mark.parametrize("arguments", [["--format", "xml"], ["--at-sample"], ["nothing.toml"]])
def test_a_wrong_request_is_one_line(arguments, capsys):
    assert main(["summary", *([] if "nothing.toml" in arguments else ["drive_m1"]), *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert len(captured.err.splitlines()) == 1


def test_every_fraction_of_a_delay_is_met():
    """A load at a third, seen at a seventh: the arrival is exact."""
    scene = Scene.from_toml("drive_m1").with_(
        {"load": [{"body": 1, "times": ["1/3"], "steps": [1]}], "output.strain": ["1/7"], "output.velocity": []}
    )
    first, *_ = first_arrivals(lower(scene))
    assert Fraction(int(first.p), int(first.q)) == Fraction(1, 3) + Fraction(1, 7)


def test_a_top_beside_both_sides_of_an_instant_is_found():
    """Where an output is sampled on both sides of a jump of another, equal neighbours hide no top."""
    taus = np.array([0, 0.2, 0.4, 0.6, nextafter(1, 0), 1, 1.4, 1.6, 1.8, 2])

    def top(tau):
        waves = np.where(np.abs(tau - 0.9) > 0.35, 0.05 * np.cos(5 * np.pi * tau), 0.0)
        return np.round(1 - (tau - 0.9) ** 2 + waves, 12)

    values, when = sampled_extremes(taus, top(taus)[None], top)
    assert values[0, 1] == pytest.approx(1, abs=1e-6)
    assert when[0, 1] == pytest.approx(0.9, abs=2e-3)


def test_no_program_is_made_for_drifts_that_nobody_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where they cost too much to be known exactly, a summary is as fast as that of the outputs alone."""
    exact = summary._exact

    def refuse_many(model: Model) -> object:
        if any(probe.quantity == "drift" for probe in model.probes):
            raise CostError("output: it would take minutes")
        return exact(model)

    def refuse(model: Model) -> None:
        pytest.fail("a program was made")

    monkeypatch.setattr(summary, "_exact", refuse_many)
    monkeypatch.setattr(summary, "make", refuse)
    found = wavesym.summary(Scene.from_toml("drive_m1"))
    assert found.proved
    assert found.largest_drift is None
    assert found.drifts_cost_too_much
    assert "the largest drift would cost too much" in summary_text(found, "text")


@pytest.fixture
def column() -> Scene:
    """Layers whose speeds are adjusted, on rock under a record: a march alone serves them, and drifts lose digits."""
    layers = ((12, 451), ("7.3", 333), (5, 210))
    rods = [{"rod": f"{h} m", "speed": f"{c} m/s", "rho": "2000 kg/m^3", "A": "1 m^2"} for h, c in layers]
    outcrop = {"motion": "acceleration", "name": "outcrop"}
    samples = [0, *(Fraction((7 * k * k + 3 * k) % 17 - 8, 8) for k in range(49)), 0]
    return Scene(
        name="column",
        units={"kind": "shear"},
        system={
            "type": "chain",
            "speed_adjustment": "0.5 %",
            "parts": [outcrop, {"dashpot": "2400 kN*s/m"}, *rods, "free"],
        },
        load=[{"at": "outcrop", "spacing": "0.02 s", "samples": list(map(str, samples)), "unit": "m/s^2"}],
        output={"until": "1 s", "tolerance": 1e-8, "acceleration": ["24.3 m"]},
    )


@pytest.fixture
def marched(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, ...]]:
    """The outputs of each march that is tried."""
    outputs: list[tuple[str, ...]] = []
    maker = choice.MAKERS["march"]

    def count(model: Model, *more: Any) -> Form:
        outputs.append(tuple(probe.name for probe in model.probes))
        return maker(model, *more)

    monkeypatch.setitem(choice.MAKERS, "march", count)
    return outputs


def test_drifts_that_miss_the_tolerance_cost_no_second_solution(column: Scene, marched: list[tuple[str, ...]]) -> None:
    """They were refused with it, and all was solved again without them."""
    found = wavesym.summary(column)
    assert marched == [("acceleration@24.3 m", "drift@1", "drift@2", "drift@3")]
    assert found.bound <= 1e-8 < found.drift_bound < 1e-4
    assert f"(right to {found.drift_bound:.2g} of it)" in summary_text(found, "text")
    # the same by displacements, to which the tolerance is applied; the outputs move, too, as the outcrop does
    ends = ["0 m+", "12 m", "19.3 m", "24.3 m"]
    output = {"until": "1 s", "tolerance": 1e-4, "displacement": ends}
    moved = wavesym.run(column.with_({"output": output}))
    drifts = np.abs(np.diff([moved[f"displacement@{x}"] for x in ends], axis=0)).max(axis=1)
    assert found.largest_drift is not None
    assert found.largest_drift.name == f"drift@{drifts.argmax() + 1}"
    assert abs(found.largest_drift.largest.value) == pytest.approx(drifts.max(), rel=1e-3)


def test_outputs_that_miss_the_tolerance_are_refused_beside_drifts(column: Scene) -> None:
    tried = choice.attempt(lower(column.with_({"output.drift": [3]})), "march")
    assert tried.refusal.endswith("for drift@3")


def test_a_drift_that_is_hardly_known_is_not_told(column: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(summary, "_MOST_ERROR", 1e-8)
    found = wavesym.summary(column)
    assert (found.largest_drift, found.drifts_cost_too_much) == (None, True)


@pytest.mark.slow
def test_a_page_marches_for_its_outputs_once_and_once_along_the_chain(
    column: Scene, marched: list[tuple[str, ...]]
) -> None:
    """Not for the curves, nor for what simpler models are compared with."""
    page(column)
    assert len(marched) == 2
    assert marched[0] == ("acceleration@24.3 m", "drift@1", "drift@2", "drift@3")
    assert marched[1][0] == "strain@0+"


def test_numbers_for_people_have_no_power_of_ten_below_ten_million() -> None:
    shown = [number_text(value, "N", 4) for value in (-11803.2, 999960.0, 9999999.0, 12345678.0, 0.00001234)]
    assert shown == ["-11800 N", "1000000 N", "10000000 N", "1.235e+07 N", "1.234e-05 N"]


def test_a_spring_that_bears_nothing_is_told_wherever_its_scene_is(tmp_path, capsys) -> None:
    """The toe of a pile, pulled down from the ground at its back, with the limits of one before "fixed"."""
    text = """
name = "toe"
[system]
type = "chain"
parts = [{ rod = 1, velocity = 1 }, { joint = true, velocity = 0, spring = 2, yield = [0, "1/2"] }]
[output]
until = "1/2"
displacement = ["1"]
"""
    path = tmp_path / "toe.toml"
    path.write_text(text)
    note = "the spring at 1 bore no force when it was loaded: it was pulled, and yield = [0, B] bears only what pushes"
    found = wavesym.summary(Scene.from_toml(str(path)))
    (told,) = found.notes
    assert told.startswith(note)
    assert told in str(found).splitlines()
    assert main(["summary", str(path)]) == 0
    assert capsys.readouterr().out == f"{found}\n"
    for arguments in (["run", "--samples", "2"], ["summary", "--format", "json"]):
        assert main([arguments[0], str(path), *arguments[1:]]) == 0
        assert note in capsys.readouterr().err
    for right in ('["1/2", 0]', '"1/2"'):
        path.write_text(text.replace('[0, "1/2"]', right))
        assert main(["run", str(path), "--samples", "2"]) == 0
        assert "bore no force" not in capsys.readouterr().err
