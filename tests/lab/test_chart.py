"""The chart: what is measured for it, how it is drawn, and its numbers."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from time import sleep

import numpy as np
import pytest

from wavesym.api import evaluator
from wavesym.cli import main
from wavesym.lab.chart import subjects as listed
from wavesym.lab.chart.measure import ChartRow, Measurements, _Judge, measure, to_csv
from wavesym.lab.chart.subjects import Subject, other_method, spacing, subjects, taus
from wavesym.lab.floor import floor
from wavesym.lab.timing import medians
from wavesym.methods.catalogue import METHODS
from wavesym.scene import Scene, lower

SCENE = Scene(
    name="small",
    system={"type": "collision", "m": 4, "kappa": ["1/10", "1/5"], "velocity": [1, "-1/2"]},
    output={"until": 3, "strain": [2], "velocity": [1]},
)


def subject(wrong=lambda tau: 0.0):
    """The reference as a subject, with an error added."""
    response = evaluator(SCENE)
    at = taus(3.0, 301, "double")

    def values(where):
        return response(where) + wrong(np.asarray(where))

    return Subject("x", "other", "C", "double", "", 0.1, None, at, lambda: values(at), values)


def test_the_reference_has_no_error():
    assert _Judge(SCENE).errors(subject()) == (0, 0)


def test_errors_are_told_apart_by_where_they_are():
    judge = _Judge(SCENE)
    near = subject(lambda tau: 1e-3 * (abs(tau - 2) <= 0.02))
    far = subject(lambda tau: 1e-3 * (abs(tau - 1.5) < 0.02))
    away, fronts = judge.errors(near)
    assert (away, fronts > 1e-4) == (0, True)
    away, fronts = judge.errors(far)
    assert (away > 1e-4, fronts) == (True, 0)


def test_the_value_at_a_jump_is_looked_at():
    assert _Judge(SCENE).errors(subject(lambda tau: 1.0 * (tau == 2)))[1] > 0.1


def test_what_is_no_number_is_infinitely_wrong():
    wrong = subject(lambda tau: np.where(abs(tau - 1.5) < 0.02, np.nan, 0))
    assert _Judge(SCENE).errors(wrong)[0] == np.inf


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("until", [0.7, 10.0, 1 / 3])
def test_samples_stay_on_the_horizon(precision, until):
    where = taus(until, 10001, precision)
    assert until * (1 - 1e-6) < float(where[-1]) <= until
    assert where.dtype == (np.float32 if precision == "single" else np.float64)
    assert spacing(until, 1, precision) > 0


@pytest.mark.slow
def test_our_evaluators_keep_their_bounds():
    judge, seen = _Judge(SCENE), set()
    for one in subjects(SCENE, 301):
        assert max(judge.errors(one)) <= one.bound + 2.0**-53
        seen.add(one.curve)
    assert {("closed", "C", "double"), ("closed", "NumPy", "double")} <= seen


def test_samples_are_those_that_are_judged_where_the_horizon_is_no_double():
    """A unit in the last place of tau is an error of several in what is steep."""
    scene = SCENE.with_({"output.until": "29/10"})
    assert lower(scene).horizon() != float(scene.output.until)
    one = next(subject for subject in subjects(scene, 301) if subject.language == "NumPy")
    judged = taus(_Judge(scene).known.until, 301, "double")
    np.testing.assert_array_equal(one.sample(), one.evaluate(judged))


SHAKEN = Scene(
    name="shaken",
    system={"type": "building", "m": 2, "kappa": ["1/10"] * 3, "base": "ground", "damping": "1/20"},
    load=[{"spacing": "1.3", "samples": [0, 1, "-1/2", "1/4", 2, 0]}],
    output={"until": 12, "tolerance": "1e-3", "drift": [1], "relative": [2]},
)


@pytest.fixture(scope="module")
def shaken():
    return _Judge(SHAKEN)


@pytest.fixture(scope="module")
def by_modes():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(listed, "TOLERANCES", listed.TOLERANCES[:1])
        return list(subjects(SHAKEN, 301))


def test_what_waves_do_not_serve_is_measured_from_modes(shaken, by_modes):
    """Everything keeps its bound, with what the modes that it is measured from may be wrong by."""
    assert 0 < shaken.known.bound < 1e-10
    for one in by_modes:
        away, fronts = shaken.errors(one)
        assert away <= one.bound + 2 * shaken.known.bound
        assert np.isnan(fronts)
    assert {("modes", "C", "double"), ("modes", "NumPy", "double")} <= {one.curve for one in by_modes}


def test_what_modes_are_measured_from_is_the_limit_of_finite_elements(shaken):
    """Their error falls as the square of an element."""
    method = next(method for method in METHODS if method.name == "finite elements, modal")
    at, problem = taus(12.0, 301, "double"), method.state(lower(SHAKEN))
    coarse, fine = (shaken.errors(other_method(method, n, problem, at))[0] for n in (5, 20))
    assert fine < coarse / 12 < 1e-2


def test_a_stream_is_judged_at_its_samples(shaken, by_modes):
    """After the record has ended, too."""
    one = next(one for one in by_modes if one.curve == ("modes", "C", "double"))
    np.testing.assert_allclose(one.instants, 1.3 * np.arange(1, 10), rtol=1e-15)
    assert shaken.errors(replace(one, instants=one.instants - 0.1))[0] > 1e-2


def test_an_undamped_record_is_measured_right_to_the_last_bit():
    assert _Judge(SHAKEN.with_({"system.damping": 0})).known.bound == 0


def test_medians_interleave():
    order = []
    calls = [lambda: order.append(0), lambda: (order.append(1), sleep(0.002))]
    fast, slow = medians(calls, rounds=3, shortest=0.0)
    assert 0 < fast < 0.002 <= slow
    assert order[4:] == [0, 1] * 3  # after one call to warm up, and one to see how long it takes


def test_medians_have_no_patience_with_slow_calls():
    count = []
    medians([lambda: (count.append(0), sleep(0.02))], rounds=50, shortest=0.0, patience=0.05)
    assert len(count) <= 5


@pytest.mark.parametrize("single", [False, True])
def test_the_floor_is_a_straight_line(single):
    values = floor(2, 1000, 4, single=single)()
    assert values.dtype == (np.float32 if single else np.float64)
    np.testing.assert_array_equal(values, np.tile(3 + 0.5 * np.arange(1000), (2, 1)))  # that of the last call


def row(name, k, kind="other", **changes):
    made = ChartRow(name, kind, "C", "double", f"{k}", 2.0 * k, 1e-3 * k, 0.1**k, 0.2, None)
    return replace(made, **changes)


MEASURED = Measurements(
    (
        *(row("closed", k, "wavesym", proved_bound=1e-3) for k in (1,)),
        *(row("pieces", k, "wavesym", ns_per_value=0.3 * k, proved_bound=1e-9) for k in (4, 8, 12)),
        *(row(f"method {n}", k, ns_per_value=10.0 * n * k) for n in range(8) for k in (1, 3, 5) if n),
        row("ball reference", 1, "wavesym", error_away=0.0, error_at_fronts=0.0),
        row("hopeless", 1, error_away=np.inf, error_at_fronts=7.0),
    ),
    floor=0.12,
    samples=1001,
)


def test_csv_holds_every_number():
    rows = list(csv.DictReader(io.StringIO(to_csv(MEASURED))))
    assert len(rows) == len(MEASURED.rows) + 1
    assert (rows[0]["kind"], rows[0]["ns_per_value"]) == ("floor", "0.12")
    assert float(rows[1]["proved_bound"]) == 1e-3
    assert rows[-1]["error_away"] == "inf"


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    pytest.importorskip("matplotlib")
    from wavesym.lab.chart.drawing import draw
    from wavesym.pictures.saving import save

    folder = tmp_path_factory.mktemp("drawn")
    figures = [draw(SCENE, MEASURED) for _ in range(2)]
    for k, figure in enumerate(figures):
        save(figure, folder / f"{k}.svg")
    return figures[0], [(folder / f"{k}.svg").read_bytes() for k in range(2)]


@pytest.mark.slow
def test_same_numbers_same_bytes(drawn):
    _, (first, second) = drawn
    assert first == second
    assert b"<dc:date>" not in first


def test_every_curve_is_named_once_in_each_panel(drawn):
    figure, _ = drawn
    names = {f"{row.name}, {row.language}" for row in MEASURED.rows} | {"floor: a straight line of doubles, C"}
    for axes in figure.axes[:2]:
        assert sorted(text.get_text() for text in axes.texts) == sorted(names)


def test_no_label_covers_another_or_leaves_its_panel(drawn):
    figure, _ = drawn
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    for axes in figure.axes[:2]:
        inside = axes.get_window_extent(renderer).padded(1)
        boxes = [text.get_window_extent(renderer) for text in axes.texts]
        for k, box in enumerate(boxes):
            assert inside.x0 <= box.x0 < box.x1 <= inside.x1
            assert inside.y0 <= box.y0 < box.y1 <= inside.y1
            assert not any(box.overlaps(other) for other in boxes[:k])


def test_where_nothing_jumps_there_is_one_panel():
    pytest.importorskip("matplotlib")
    from wavesym.lab.chart.drawing import draw

    smooth = [replace(row, error_at_fronts=np.nan) for row in MEASURED.rows]
    figure = draw(SCENE, replace(MEASURED, rows=tuple(smooth), reference_bound=3e-9))
    assert len(figure.axes) == 2
    assert "3e-09" in figure.texts[1].get_text()
    assert "nan" not in to_csv(replace(MEASURED, rows=tuple(smooth)))


@pytest.mark.slow
def test_a_curve_that_says_nothing_at_fronts_is_left_out_there():
    pytest.importorskip("matplotlib")
    from wavesym.lab.chart.drawing import draw

    stream = row("modes", 1, "wavesym", error_at_fronts=np.nan)
    away, fronts, _ = draw(SCENE, replace(MEASURED, rows=(*MEASURED.rows, stream))).axes
    assert ["modes, C" in [text.get_text() for text in axes.texts] for axes in (away, fronts)] == [True, False]


def test_curves_differ_without_their_colour():
    pytest.importorskip("matplotlib")
    from wavesym.lab.chart.drawing import _curves

    looks = [(style.marker, style.dashes, style.ours) for style, _ in _curves(MEASURED.rows)]
    assert len(set(looks)) == len(looks)


@pytest.mark.slow
def test_other_formats_and_what_is_none(drawn, tmp_path):
    from wavesym.errors import SceneError
    from wavesym.pictures.saving import save

    save(drawn[0], tmp_path / "a" / "chart.png")
    assert (tmp_path / "a" / "chart.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(SceneError, match="not a picture"):
        save(drawn[0], tmp_path / "chart.txt")


@pytest.mark.slow
def test_measured_through(monkeypatch):
    """All of it, with few methods: curves, times, errors, set-up."""
    monkeypatch.setattr(
        listed, "METHODS", [replace(method, resolutions=method.resolutions[:2]) for method in METHODS[:4]]
    )
    monkeypatch.setattr(listed, "TOLERANCES", listed.TOLERANCES[:1])
    told = []
    found = measure(SCENE, 301, told.append)
    assert {row.name for row in found.rows} >= {"closed", "ball reference", *(method.name for method in METHODS[:4])}
    assert found.floor > 0
    for each in found.rows:
        assert each.ns_per_value > 0
        assert each.setup_seconds > 0
        assert max(each.error_away, each.error_at_fronts) < 1
    assert told[-1] == "timing"


def test_a_file_that_is_no_picture_is_refused_before_the_work(capsys, tmp_path):
    pytest.importorskip("matplotlib")
    assert main(["chart", "drive_m1", "-o", str(tmp_path / "chart.txt")]) == 2
    assert "write a name that ends in .svg, .png, .pdf" in capsys.readouterr().err


def test_command(monkeypatch, tmp_path):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("wavesym.lab.chart.measure.measure", lambda scene, samples, progress: MEASURED)
    picture, table = tmp_path / "chart.svg", tmp_path / "chart.csv"
    assert main(["chart", "collision_m4", "-o", str(picture), "--csv", str(table)]) == 0
    assert picture.read_text().rstrip().endswith("</svg>")
    assert table.read_text() == to_csv(MEASURED)
