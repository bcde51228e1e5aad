"""The page of a sweep: it is whole, its numbers are those of the scenes, and it can be used by all."""

from __future__ import annotations

import html
import json
import re
from base64 import b64decode
from itertools import pairwise
from pathlib import Path
from typing import Any
from zlib import decompress

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `sweep` is not installed")

from tests.pictures import test_page
from tests.pictures.browser import axe, reported
from wavesym import api
from wavesym.cli import main
from wavesym.pictures.page import sweep as module
from wavesym.pictures.page import sweep_pictures
from wavesym.pictures.page.png import SHADES, colours
from wavesym.pictures.page.sweep import sweep_page
from wavesym.pictures.page.sweep_pictures import SweepOutput, output_picture
from wavesym.scene import Scene
from wavesym.sweeps import pace
from wavesym.sweeps.results import StoredAxis, StoredColumn, SweepResults, results

SWEEP: dict[str, Any] = {
    "scene": "drive_m1",
    "vary": {"system.kappa[0]": ["-1", "1/4", "1/2"], "output.until": [4, 5]},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep of six cases, the first two of which fail, computed here however slow the machine is."""
    made = tmp_path_factory.mktemp("sweeps") / "stiff"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pace, "processors", lambda: 1)
        assert api.run_sweep(SWEEP, made, None, None, False) == 2
    return made


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return sweep_page(folder)


def faults(text: str) -> list[str]:
    """As of the page of a scene, which has the one script."""
    return test_page.faults(text.replace("</main>", "</main><script></script>"))


def test_the_page_is_whole_and_needs_nothing_from_outside(page: str) -> None:
    assert faults(page) == []
    assert len(page.encode()) < 400_000
    assert "<script" not in page
    assert not re.search(r"https?://(?!www\.w3\.org)", page)
    assert faults(page.replace('id="case-', 'id="cases-'))


def shown(text: str) -> dict[int, dict[str, Any]]:
    """The scenes on a page, by their cases."""
    found = re.findall(r'aria-label="The scene of case (\d+)">(.*?)</pre>', text, re.DOTALL)
    return {int(case): json.loads(html.unescape(scene)) for case, scene in found}


ROW = re.compile(r'<tr><th scope="row">([^<]*)</th>(.*)</tr>')
WORST = re.compile(r'<td class="number">([-\d.e]+)</td><td class="number"><a href="#case-(\d+)">')


def test_worst_cases_are_those_of_their_scenes(page: str) -> None:
    """Each scene on the page, made again, has the extreme that the table says, and no other case has a worse one."""
    again = {case: api.summary(Scene(**fields)) for case, fields in shown(page).items()}
    one = Scene.from_toml("drive_m1")
    every = [
        api.summary(one.with_({"system.kappa[0]": kappa, "output.until": until}))
        for kappa in ("1/4", "1/2")
        for until in (4, 5)
    ]
    rows = [(name, WORST.findall(row)) for name, row in ROW.findall(page) if len(WORST.findall(row)) == 2]
    assert [name for name, _ in rows] == [output.name for output in one.outputs]
    for k, (_, ((least, low), (greatest, high))) in enumerate(rows):
        assert float(least) == pytest.approx(again[int(low)].outputs[k].min.value, rel=1e-5, abs=1e-12)
        assert float(least) == pytest.approx(min(each.outputs[k].min.value for each in every), rel=1e-5, abs=1e-12)
        assert float(greatest) == pytest.approx(again[int(high)].outputs[k].max.value, rel=1e-5, abs=1e-12)
        assert float(greatest) == pytest.approx(max(each.outputs[k].max.value for each in every), rel=1e-5, abs=1e-12)


def test_what_failed_says_why(page: str, folder: Path) -> None:
    reasons = [each["reason"] for each in api.sweep_status(folder).reasons]
    assert len(reasons) == 2
    assert all(reason in html.unescape(page) for reason in reasons)
    assert "6: 4 done, 2 failed, 0 left" in page


def test_no_name_of_a_file_is_an_escape_sequence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Names may come from others; a page is read in a terminal, too."""
    monkeypatch.setattr(pace, "processors", lambda: 1)
    for name in ("\x1b[31mred.csv", "red\x07.csv"):
        (tmp_path / name).write_text("no record")
    (tmp_path / "a.csv").write_text("accel\n0\n1\n")
    (tmp_path / "scene.toml").write_text(
        """name = "shaken"
        system = { type = "building", m = 1, kappa = ["1/4", "3/5"], base = "ground" }
        load = [{ record = "a.csv", spacing = 1 }]
        output = { until = 2, velocity = [1] }"""
    )
    (tmp_path / "sweep.toml").write_text('scene = "scene.toml"\nrecords = "*red*"\n')
    assert api.run_sweep(tmp_path / "sweep.toml", tmp_path / "made", None, None, False) == 2
    made = sweep_page(tmp_path / "made")
    assert re.findall("[\x00-\x08\x0b-\x1f]", made) == []
    assert made.count("\\x1b[31mred.csv") >= 3


def test_a_map_has_the_colours_of_its_values() -> None:
    """Right and upward, the least in the first shade, the greatest in the last, and grey where there is none."""
    axes = tuple(
        StoredAxis(name, (StoredColumn(name, ("1", "2"), (1.0, 2.0), ""),)) for name in ("system.a", "system.b")
    )
    values = np.array([[0.0, 1.0], [2.0, np.nan]])
    found = results_of(axes)
    made = output_picture("p", SweepOutput("strain@1", "", -values, values), found)
    assert made is not None
    (encoded,) = re.findall('base64,([^"]*)"', made.markup)
    assert pixels(b64decode(encoded)) == [[SHADES // 2, SHADES], [0, SHADES - 1]]
    assert "the largest where system.a = 2, system.b = 1" in made.markup
    assert "size of strain@1 (dimensionless); at the spot system.a = 2, system.b = 1<" in made.markup
    assert "halo" not in made.markup  # words over the colours of other cases


@pytest.mark.parametrize("numbers", [True, False])
def test_a_hundred_thousand_cases_are_a_small_picture_with_their_extremes(numbers: bool) -> None:
    """Against pictures of the highest and the lowest case with some others, which leave nothing out."""
    n = 100_000
    draw = np.random.default_rng(3)
    coordinate = tuple((np.arange(n) / n).tolist()) if numbers else tuple(f"r{k}" for k in range(n))
    values = draw.standard_normal(n)
    told = {}
    few = np.unique([0, int(values.argmin()), int(values.argmax()), n - 1])
    for kept in (np.arange(n), few):
        column = StoredColumn("system.a", tuple(map(str, kept)), tuple(coordinate[k] for k in kept), "")
        axes = (StoredAxis("system.a", (column,)),)
        made = output_picture("p", SweepOutput("strain@1", "", values[kept] - 1, values[kept] + 1), results_of(axes))
        assert made is not None
        paths = dict(re.findall(r'class="(least|greatest)" d="([^"]*)"', made.markup))
        heights = {class_: [float(y) for y in re.findall(r"[ V]([\d.]+)", path)] for class_, path in paths.items()}
        told[len(kept)] = max(heights["least"]), min(heights["greatest"])
        assert len(made.markup) < 40_000
    assert told[n] == told[len(few)]


def results_of(axes: tuple[StoredAxis, ...]) -> SweepResults:
    return SweepResults({}, {}, axes, {})


def pixels(image: bytes) -> list[list[int]]:
    """A PNG of two by two half bytes, decompressed by the library."""
    data = image[image.index(b"IDAT") + 4 : image.index(b"IEND") - 8]
    rows = decompress(data)
    return [[byte >> 4, byte & 15] for zero, byte in (rows[:2], rows[2:]) if zero == 0]


def test_many_outputs_and_cases_stay_small(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_ROWS", 2)
    monkeypatch.setattr(module, "_SCENE", 40)
    monkeypatch.setattr(module, "_REASONS", 1)
    less = sweep_page(folder)
    assert "2 of 6 cases, the worst first" in less
    assert "characters more, left out" in less
    assert "The first 1 of 2" in less
    assert faults(less) == []


def test_report_takes_a_folder(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "stiff.html"
    assert main(["report", str(folder), "-o", str(out)]) == 0
    assert out.read_text(encoding="utf-8") == sweep_page(folder)
    (tmp_path / "empty").mkdir()
    assert main(["report", str(tmp_path / "empty"), "-o", str(tmp_path / "x.html")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "x.html").exists()


def test_a_scene_of_any_case_is_that_of_the_plan(folder: Path) -> None:
    found = results(folder)
    assert found.scene(3)["system"]["kappa"] == ["1/4"]
    assert found.scene(3)["output"]["until"] == 5
    assert found.labels_at(5) == {"system.kappa[0]": "0.5", "output.until": "5"}


@pytest.mark.slow
def test_axe_finds_nothing(page: str, tmp_path: Path) -> None:
    assert reported(page, axe() + test_page.LOOK, tmp_path) == []


@pytest.mark.slow
def test_a_large_sweep_with_long_names_has_a_small_page_that_fits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """400 cases and 200 letters for each record: what the page shows is cut, and does not scroll sideways."""
    for k in range(20):
        (tmp_path / f"{k}{'x' * 200}.csv").write_text("a\n0\n1\n0\n-1\n0\n")
    scene = {
        "name": "n" * 60,
        "system": {"type": "building", "m": 2, "kappa": ["1/20"] * 3, "base": "ground", "damping": 0.05},
        "load": [{"spacing": 5, "record": {"samples": [0, 1]}}],
        "output": {"until": 30, "tolerance": 1e-4, "drift": [1, 2]},
    }
    ratios = {"from": 0.02, "to": 0.1, "count": 20}
    monkeypatch.setattr(pace, "processors", lambda: 1)
    sweep = {"scene": scene, "records": str(tmp_path / "*.csv"), "vary": {"system.damping": ratios}}
    assert api.run_sweep(sweep, tmp_path / "out", None, None, False) == 0
    large = sweep_page(tmp_path / "out")
    assert len(large.encode()) < 400_000
    assert faults(large) == []
    wide = "const all = document.documentElement; report([all.scrollWidth, all.clientWidth]);"
    needed, given = reported(large, wide, tmp_path)
    assert needed == given


@pytest.mark.parametrize(
    ("others", "dots"), [((3.0, 2.0, 2.0, 1.0), 0), ((1.0, 3.0, 2.0, 1.0), 8)], ids=["along", "scattered"]
)
def test_what_is_zipped_is_drawn_over_the_first_that_changes(others: tuple[float, ...], dots: int) -> None:
    """As a line where all else rises or falls with it, else as a dot for each case; large forces in kN."""
    written, same = ("4", "1", "2", "3"), (1.0,) * 4
    columns = (
        StoredColumn("system.m", ("1",) * 4, same, ""),
        StoredColumn("system.k", written, (4.0, 1.0, 2.0, 3.0), "N/m"),
        StoredColumn("system.c", written, (others[3], *others[:3]), ""),
    )
    axis = StoredAxis("case", columns)
    least, greatest = np.array([-4.0, -1.0, -2.0, -3.0]), np.array([1.0, 4.0, 3.0, 2.0])
    drawn = sweep_pictures._curve("output-0", SweepOutput("force@0", "N", least, greatest), axis)
    assert drawn.title == "force@0 over system.k"
    assert "system.k in N/m, with system.m, system.c" in str(drawn.markup)
    assert str(drawn.markup).count('class="dot') == dots
    assert ('class="greatest"' in str(drawn.markup)) == (not dots)
    large = sweep_pictures._readable(SweepOutput("force@0", "N", 1e6 * least, 1e6 * greatest))
    assert (large.unit, large.least.min(), large.greatest.max()) == ("kN", -4000.0, 4000.0)


def test_in_maps_what_is_darker_is_larger() -> None:
    """As the page says above them."""
    shades = [0.2126 * red + 0.7152 * green + 0.0722 * blue for red, green, blue in colours(signed=False)[:-1]]
    assert all(after < before for before, after in pairwise(shades))
