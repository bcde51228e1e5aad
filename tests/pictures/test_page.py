"""The page of a scene: it is whole, says what is so, can be used by all, and its cursor reads what curves are."""

from __future__ import annotations

import html
import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from io import BytesIO, TextIOWrapper
from itertools import pairwise
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest
from scipy.linalg import expm

import wavesym
from tests.pictures.browser import axe, reported
from wavesym.cli import main
from wavesym.documents.summary import summary_text
from wavesym.errors import SceneError, ToleranceError
from wavesym.numbers.doubles import rational
from wavesym.pictures.naming import with_titles
from wavesym.pictures.page import small
from wavesym.pictures.page.curves import HEIGHT, Grid
from wavesym.pictures.page.document import _bound, page
from wavesym.pictures.page.headline import _value
from wavesym.pictures.page.load_spectrum import _picture
from wavesym.pictures.page.page_tables import PageTable
from wavesym.pictures.page.plots import LETTER
from wavesym.pictures.page.small import LARGEST, first_rows, first_text, fitting
from wavesym.pictures.page.structure import structure
from wavesym.pictures.timescale import Timescale
from wavesym.programs.making import make
from wavesym.scene import Scene, builtin_text, lower

PAYLOAD = """\n[report]\nauthor = '</pre><script>alert("in")</script> & "quoted"'\n# a remark of its author\n"""
VOID = {"meta", "input", "br", "link", "img"}
SCRIPTS = 1


class Read(HTMLParser):
    """The tags of a page, with their attributes; `open` are those that are not closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.wrong: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)

    def all(self, tag: str) -> list[dict[str, str | None]]:
        """The attributes of each tag of a kind."""
        return [attributes for name, attributes in self.tags if name == tag]


def faults(text: str) -> list[str]:
    """What is wrong with a page, as far as its tags tell."""
    read = Read(text)
    ids = Counter(attributes["id"] for _, attributes in read.tags if "id" in attributes)
    found = [f"not closed: {tag}" for tag in [*read.wrong, *read.open]]
    found += [f"twice: {name}" for name, count in ids.items() if count > 1]
    for tag, attributes in read.tags:
        for key in ("aria-labelledby", "for"):
            found += [f"{key}: {name}" for name in (attributes.get(key) or "").split() if name not in ids]
        address = attributes.get("href") or attributes.get("src") or ""
        if address.startswith("#"):
            found += [f"leads nowhere: {address}"] * (address[1:] not in ids)
        elif address and not address.startswith(("data:image/png;base64,", "data:text/csv;charset=utf-8,")):
            found.append(f"from outside: {address}")
        if tag == "svg" and "aria-hidden" not in attributes and attributes.get("role") != "img":
            found.append("an svg without a role")
        if tag == "th" and "scope" not in attributes:
            found.append("th without scope")
    if len(read.all("script")) != SCRIPTS:
        found.append("scripts")
    return found


def payloaded(folder: Path, name: str) -> Scene:
    """A built-in scene in a file, with a payload in front."""
    (folder / "mine.toml").write_text(builtin_text(name) + PAYLOAD, encoding="utf-8")
    return Scene.from_toml(folder / "mine.toml")


@pytest.fixture(scope="module")
def building(tmp_path_factory: pytest.TempPathFactory) -> str:
    return page(payloaded(tmp_path_factory.mktemp("page"), "building_m2"))


def test_the_page_is_whole_and_needs_nothing_from_outside(building: str) -> None:
    assert faults(building) == []
    assert len(building.encode()) < 400_000
    assert not re.search(r"https?://(?!www\.w3\.org)", building)
    assert "@import" not in building


def test_a_page_is_thinned_until_it_is_small() -> None:
    drawn = []
    assert fitting(lambda columns: columns, lambda columns: drawn.append(columns) or "x" * (1000 * columns), 1200)
    assert drawn == [1200, 600, 300]
    assert len(fitting(lambda columns: columns, lambda columns: "\u2212" * LARGEST, 100).encode()) > LARGEST
    assert first_text("a" * 40_000 + "b" * 5).endswith("aa\n... and 5 characters more, left out to keep the page small")
    assert first_text("ab") == "ab"
    table = PageTable(("Output",), tuple((str(k),) for k in range(300)), ("How",))
    assert first_rows(table).rows == table.rows[:250]
    assert first_rows(table).notes[1].startswith("The first 250 of 300 outputs")


@pytest.mark.slow
def test_a_page_of_many_outputs_and_fronts_stays_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its curves get fewer columns, its tables fewer rows, its scene is cut; it says so, and is whole."""
    scene = Scene.from_toml("building_m2").with_(
        {
            "load": [{"times": list(range(40)), "a": [(-1) ** k * (k % 7) for k in range(40)]}],
            "output.until": 40,
            "output.strain": [f"{k}/20" for k in range(1, 20)],
        }
    )
    monkeypatch.setattr(small, "_ROWS", 7)
    monkeypatch.setattr(small, "_TEXT", 100)
    usual = page(scene)
    assert "Curves have" not in usual
    monkeypatch.setattr(small, "LARGEST", len(usual.encode()) * 3 // 4)
    less = page(scene)
    assert len(less.encode()) <= small.LARGEST < len(usual.encode()) < 400_000
    (columns,) = re.findall(r"Curves have ([0-9]+) columns of time", less)
    assert f'max="{columns}"' in less
    assert re.search("The first 7 of [0-9]+ outputs", less)
    assert "characters more, left out" in less
    assert faults(less) == []


def facts(text: str, word: str) -> list[str]:
    """What a page says under a word at its top."""
    return re.findall(f"<dt>{word}</dt><dd>(.*?)</dd>", text)


def test_page_and_summary_say_the_same(tmp_path: Path) -> None:
    """Of the frame of README.md: curves are of the program whose extremes are found, and meet the tolerance."""
    readme = (Path(wavesym.__file__).parents[1] / "README.md").read_text(encoding="utf-8")
    (written,) = re.findall(r"```toml frame.toml\n(.*?)```", readme, re.DOTALL)
    (tmp_path / "frame.toml").write_text(written, encoding="utf-8")
    scene = Scene.from_toml(tmp_path / "frame.toml")
    text, found = page(scene), wavesym.summary(scene)
    assert found.bound <= float(scene.output.tolerance) == 1e-6
    (bound,) = facts(text, "Bound")
    assert bound.startswith(f"{found.bound:g}, proved")
    (program,) = facts(text, "Computed by")
    assert program.endswith(f"bound {found.bound:g}")
    assert f"values are right to {found.bound:g} of" in text
    for each in facts(text, "Bound.*?"):
        assert float(each.split(",")[0]) <= 1e-6 or "more than the tolerance of the scene, 1e-06," in each
    table = summary_text(wavesym.summary(scene), "text").splitlines()
    cells = re.findall('<td class="number">(.*?)</td>', text[text.index('id="extremes"') :])[:8]
    assert cells == [f"{float(cell):.4g}" for cell in table[1].split()[-8:]]
    assert f"{found.largest_drift.largest.value:.4g} mm at t = {found.largest_drift.largest.at.time:.4g} s" in text


def test_what_does_not_meet_the_tolerance_says_so() -> None:
    model = lower(Scene.from_toml("drive_m1"))
    program = make(model)
    assert "tolerance" not in _bound("a curve", program, model)
    tighter = model.tolerating(rational(program.error_bound) * 9 / 10)
    assert re.search(
        r"proved: .*more than the tolerance of the scene, [0-9.e-]+, but", _bound("a curve", program, tighter)
    )
    estimated = _bound("a curve", replace(program, proved=False), tighter)
    assert "an estimate that is not proved" in estimated
    assert "more than the tolerance of the scene" in estimated


def test_what_is_missing_is_seen(building: str) -> None:
    assert faults(building.replace('id="history-1-told"', ""))
    assert faults(building.replace("</section>", "", 1))
    assert faults(building.replace("&lt;script&gt;", "<script>"))


def test_text_stays_text(building: str) -> None:
    assert "&lt;/pre&gt;&lt;script&gt;alert(&#34;in&#34;)&lt;/script&gt; &amp;" in building
    assert 'alert("in")' not in building
    assert "a remark" not in building


def test_same_scene_same_page(building: str, tmp_path: Path) -> None:
    assert page(payloaded(tmp_path, "building_m2")) == building


def test_what_was_made_in_python_is_shown_as_its_fields() -> None:
    given = Scene.from_toml("drive_m1")
    made = Scene(**given.model_dump())
    assert given.text == builtin_text("drive_m1")
    assert Scene(**json.loads(made.text)).system == given.system


def test_every_output_has_a_curve_extremes_and_a_verdict(building: str) -> None:
    for probe in with_titles(lower(Scene.from_toml("building_m2"))).probes:
        assert building.count(f'data-name="{probe.name}"') == 1
        assert building.count(f'<th scope="row">{probe.label}</th>') == 2


FRAME = {
    "name": "frame",
    "units": {"length": "mm", "force": "kN"},
    "load": [{"spacing": "0.5 s", "samples": [0, 0.3, -0.3, 0.1, 0], "unit": "g"}],
    "output": {"until": "4 s", "tolerance": 1e-6, "drift": [1]},
    "system": {
        "type": "building",
        "base": "ground",
        "damping": 0.05,
        "storey": [
            {"height": "4 m", "stiffness": "277 MN/m", "column_mass": "11 t", "floor_mass": "350 t"},
            {"height": "3 m", "stiffness": "200 MN/m", "column_mass": "9 t", "floor_mass": "300 t"},
        ],
    },
}


def test_the_headline_is_what_an_engineer_computes_from_histories() -> None:
    """Against histories of `run`, the weight and the heights of the scene; the ground moves as written."""
    block = {"project": "Town hall <1>", "author": "A. B.", "date": "2026-01-02"}
    scene = Scene(**FRAME, report=block)
    fields = {"output.force": [0], "output.acceleration": [2], "output.drift": [1, 2], "output.until": "4 s"}
    result = wavesym.run(scene.with_(fields), samples=20001)
    largest = {name: float(np.max(np.abs(row))) for name, row in zip(result.outputs, result.values, strict=True)}
    text = page(scene)
    shown = dict(re.findall(r'<span class="what">(.*?)</span><strong>(.*?)</strong>', text))
    parts = dict(re.findall(r'<span class="what">(.*?)</span>.*?<span class="soft">(.*?)</span>', text))
    weight = (11 + 350 + 9 + 300) * 9.80665  # kN
    assert float(shown["Base shear"].split()[0]) == pytest.approx(largest["force@0"], rel=1e-3)
    assert float(parts["Base shear"].split()[0]) == pytest.approx(100 * largest["force@0"] / weight, rel=5e-3)
    assert float(shown["Roof acceleration"].split()[0]) == pytest.approx(largest["acceleration@2"], rel=1e-3)
    assert shown["Peak ground acceleration"] == "2.942 m/s\u00b2"
    assert parts["Peak ground acceleration"] == "0.3 g"
    storeys = {1: (largest["drift@1"], 4000), 2: (largest["drift@2"], 3000)}  # mm
    worst = max(storeys, key=lambda storey: storeys[storey][0])
    drift, height = storeys[worst]
    assert float(shown["Largest drift"].split()[0]) == pytest.approx(drift, rel=1e-3)
    assert parts["Largest drift"].endswith(f"storey {worst}")
    assert float(parts["Largest drift"].split()[0]) == pytest.approx(100 * drift / height, rel=5e-3)
    for storey, (drift, height) in storeys.items():
        (row,) = re.findall(rf'<tr><th scope="row">{storey}</th>(.*?)</tr>', text)
        cells = [abs(float(cell)) for cell in re.findall(r'<td class="number">(.*?)</td>', row)]
        assert cells[:3] == pytest.approx([height / 1000, drift, 100 * drift / height], rel=5e-3)
    assert "<h1>Town hall &lt;1&gt;</h1>" in text
    assert "A. B., 2026-01-02" in text
    assert faults(text) == []


@pytest.mark.slow
def test_the_spectrum_of_the_load_is_what_an_oscillator_does() -> None:
    """At a few periods of its CSV, against the exponential of the oscillator's matrix, step by step along the load."""
    text = page(Scene(**FRAME))
    links = dict(re.findall(r'download="([^"]*)\.csv" href="data:text/csv;charset=utf-8,([^"]*)"', text))
    (csv,) = (link for name, link in links.items() if name.startswith("pseudo-acceleration"))
    rows = np.array([[float(cell) for cell in row.split(",")] for row in unquote(html.unescape(csv)).splitlines()[1:]])
    load, step = FRAME["load"][0], 0.001
    spacing, samples = float(load["spacing"].split()[0]), np.array(load["samples"], float) * 9.80665
    until = float(FRAME["output"]["until"].split()[0])
    a = np.interp(np.arange(0, until + step / 2, step), spacing * np.arange(len(samples)), samples)
    for period, value in rows[:: len(rows) // 5]:
        w = 2 * np.pi / period
        matrix = np.array([[0, 1, 0, 0], [-w * w, -2 * 0.05 * w, -1, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
        power, state, largest = expm(matrix * step), np.zeros(2), 0.0
        for before, after in pairwise(a):
            state = (power @ [*state, before, (after - before) / step])[:2]
            largest = max(largest, abs(state[0]))
        assert value == pytest.approx(w * w * largest, rel=5e-3)  # tops between steps: 16 steps a period, and parabolas
    periods = [mode.period for mode in wavesym.modes(Scene(**FRAME), 3)]
    assert [f"T{k} = {period:.3g} s" in text for k, period in enumerate(periods, 1)] == [True] * len(periods)


def test_no_line_of_a_period_crosses_the_name_of_another() -> None:
    """The line of T2 went through "T3 = 0.125 s"."""
    periods, own = np.geomspace(0.02, 4, 50), np.array([1.01, 0.14, 0.125, 0.12, 0.06])
    drawn = _picture("spectrum", "a title", periods, np.full(50, 3.0), own, "m/s^2", Timescale(1.0, "s")).markup
    lines = [[float(each) for each in found] for found in re.findall(r'"period" x1="(.*?)" y1="(.*?)" x2', drawn)]
    names = re.findall(r'<text x="([\d.]+)" y="([\d.]+)"[^>]*>(T\d = [^<]*)', drawn)
    assert len(names) == len(lines) == len(own)
    for x, y, words in names:
        crossed = [at for at, top in lines if float(x) < at < float(x) + LETTER * len(words) and top < float(y)]
        assert not crossed, words
    curve = re.search(r'class="spectrum" d="M[\d.]+ ([\d.]+)', drawn)
    assert curve
    assert max(float(y) for _, y, _ in names) < float(curve[1])
    assert "3 m/s\u00b2 at T1" in drawn
    assert "m/s^2" not in unquote(drawn)


@pytest.mark.slow
def test_the_page_has_the_spectrum_of_the_highest_acceleration() -> None:
    """Its values are those of `spectrum`, whose program is another one; without such an output there is none."""
    scene = Scene(**FRAME).with_({"output.acceleration": [1, 2], "output.tolerance": "1e-13"})
    text = page(scene)
    with pytest.raises(ToleranceError, match="1e-13 cannot be met"):  # which no page needs
        wavesym.summary(scene)
    assert "Not found" not in text
    assert "more fronts than" not in text, "nothing jumps under a record where modes are damped"
    assert faults(text) == []
    assert 'id="floor-shaking"' in text
    assert 'id="floor-shaking"' not in page(Scene(**FRAME))
    links = dict(re.findall(r'download="([^"]*)\.csv" href="data:text/csv;charset=utf-8,([^"]*)"', text))
    (csv,) = (link for name, link in links.items() if name.startswith("floor pseudo-acceleration"))
    rows = np.array([[float(cell) for cell in row.split(",")] for row in unquote(html.unescape(csv)).splitlines()[1:]])
    found = wavesym.spectrum(scene, damping=0.05)
    assert rows[:, 0] == pytest.approx(found.periods, rel=1e-4)
    assert rows[:, 1] == pytest.approx(found["acceleration@2"], rel=2e-3, abs=2e-3 * found["acceleration@2"].max())


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [(-3.298e6, "N", "3298 kN"), (1500, "N", "1500 N"), (2e7, "N", "20\u202f000 kN"), (12345, "mm", "12\u202f340 mm")],
)
def test_large_forces_are_shown_in_larger_units(value: float, unit: str, shown: str) -> None:
    assert _value(value, unit) == shown


def test_a_link_has_the_values_of_its_curve(building: str) -> None:
    """As CSV: rows are what exact values do at their instants, and the extremes are among them."""
    scene = Scene.from_toml("building_m2")
    response = wavesym.evaluator(scene)
    links = dict(re.findall(r'download="([^"]*)\.csv" href="data:text/csv;charset=utf-8,([^"]*)"', building))
    for k, probe in enumerate(with_titles(lower(scene)).probes):
        head, *rows = unquote(html.unescape(links[probe.label])).splitlines()
        assert head == f'tau,"{probe.label}"'
        taus, values = np.array([[float(cell) for cell in row.split(",")] for row in rows]).T
        around = response(np.clip(taus[:, None] + [-1e-4, 0, 1e-4], 0, response.tau_max))[k]
        size = np.max(np.abs(values))
        assert np.all(values >= around.min(axis=1) - 1e-3 * size)
        assert np.all(values <= around.max(axis=1) + 1e-3 * size)
        peak = max((summary := wavesym.summary(scene)[probe.name]).max.value, -summary.min.value)
        assert size == pytest.approx(peak, rel=2e-3)


@pytest.mark.slow
def test_the_animation_moves_with_the_cursor(tmp_path: Path) -> None:
    """In a browser: floors are where the frames of the page, read here, have them; those are exact values."""
    scene = Scene.from_toml("building_m2")
    text = page(scene)
    script = """
      const slider = document.getElementById("cursor");
      slider.value = 900; slider.dispatchEvent(new Event("input"));
      const parts = Array.from(document.querySelectorAll("#moving .part"));
      report([slider.max, parts.map((part) => part.getAttribute("transform"))]);
    """
    last, places = reported(text, script, tmp_path)  # type: ignore[misc]
    moved = [float(place[10:].split(" ")[0]) / 90 for place in places]
    response = wavesym.evaluator(scene.with_({"output.displacement": [0, 1, 2]}))
    taus = np.linspace(0, response.tau_max, 20001)
    rows = [response.outputs.index(f"displacement@{k}") for k in range(3)]
    values = response(taus)[rows]
    now = response([900 / float(last) * response.tau_max])[rows, 0] / np.max(np.abs(values))
    assert moved == pytest.approx(now, abs=0.02)


def test_a_title_block_changes_nothing_that_is_computed() -> None:
    plain, named = Scene(**FRAME), Scene(**FRAME, report={"project": "Town hall"})
    assert lower(plain).labels.sha256 == lower(named).labels.sha256
    assert named.with_({"output.until": "5 s"}).title_block == named.title_block
    assert "report" not in plain.model_dump()
    dimensionless = Scene.from_toml("drive_m1")
    assert "report" not in dimensionless.model_dump()
    assert Scene(**dimensionless.model_dump(), report={"author": "A"}).model_dump()["report"]["author"] == "A"
    with pytest.raises(SceneError, match=r"report\.project: .* is not a line of text; write"):
        Scene(**FRAME, report={"project": "two\nlines"})


def vertices(path: str) -> Iterator[tuple[int, int]]:
    """The corners of a path of M, l and v, in columns and steps."""
    x = y = 0
    for command, rest in re.findall(r"([Mlv])([^Mlv]*)", path):
        numbers = [int(number) for number in re.findall(r"-?\d+", rest)]
        if command == "v":
            moves = [(0, number) for number in numbers]
        else:
            moves = list(zip(numbers[::2], numbers[1::2], strict=True))
        for dx, dy in moves:
            x, y = (dx, dy) if command == "M" else (x + dx, y + dy)
            yield x, y


def curves(text: str) -> Iterator[tuple[str, Grid, list[tuple[int, int]]]]:
    """Each curve of an output, with its grid and the corners of all its lines."""
    for svg in re.findall(r"<svg[^>]*timed.*?</svg>", text, re.DOTALL):
        columns, low, high = (re.search(rf'data-{key}="([^"]*)"', svg)[1] for key in ("columns", "low", "high"))  # type: ignore[index]
        for name, inside in re.findall(r'<g class="curve[^"]*" data-name="([^"]*)">(.*?)</g>', svg, re.DOTALL):
            paths = re.findall(r'class="(?:real|formal)" d="([^"]*)"', inside)
            grid = Grid(int(columns), 1.0, float(low), float(high))
            yield name, grid, [corner for path in paths for corner in vertices(path)]


def strays(text: str, scene: Scene) -> list[str]:
    """The outputs whose curves are, at some of their corners, farther than a step from what exact values do there."""
    response = wavesym.evaluator(scene)
    found = []
    for name, grid, corners in curves(text):
        if name not in response.outputs:
            continue
        column, step = np.array(corners[::60]).T
        size = (grid.high - grid.low) / HEIGHT
        drawn = grid.high - step * size
        # what the output does in the column, before and at its start and up to its end
        taus = np.clip((column[:, None] + [-1e-9, 0, 0.5, 1]) / grid.columns, 0, 1) * response.tau_max
        values = response(taus)[response.outputs.index(name)]
        if np.any(drawn < values.min(axis=1) - size) or np.any(drawn > values.max(axis=1) + size):
            found.append(name)
    return found


def test_curves_are_the_outputs(building: str) -> None:
    scene = Scene.from_toml("building_m2")
    assert strays(building, scene) == []
    moved = re.sub(r'(class="real" d="M\d+ )(\d+)', lambda found: found[1] + str(int(found[2]) + 5), building)
    assert len(strays(moved, scene)) == len(scene.outputs)


def test_the_cursor_reads_values_off(building: str, tmp_path: Path) -> None:
    """The script, run in a browser: by the keyboard's slider, and by a mouse over a picture."""
    scene = Scene.from_toml("building_m2")
    response = wavesym.evaluator(scene)
    script = """
      const slider = document.getElementById("cursor");
      const read = () => [Number(slider.value), slider.getAttribute("aria-valuetext"),
        Object.fromEntries(Array.from(document.querySelectorAll("svg.timed"), (plot) => Array.from(
          plot.querySelectorAll(".curve"), (curve, k) =>
            [curve.dataset.name, plot.closest("figure").querySelectorAll(".value")[k].textContent])).flat())];
      const said = [];
      slider.value = 777; slider.dispatchEvent(new Event("input")); said.push(read());
      const plot = document.querySelectorAll("svg.timed")[1], box = plot.getBoundingClientRect();
      plot.dispatchEvent(new PointerEvent("pointermove", { clientX: box.left + box.width / 2, clientY: box.top + 5 }));
      said.push(read());
      report(said);
    """
    by_key, by_mouse = reported(building, script, tmp_path)  # type: ignore[misc]
    assert by_key[0] == 777
    assert 500 < by_mouse[0] < 660
    for column, told, said in (by_key, by_mouse):
        tau = column / 1200 * response.tau_max
        assert told == f"tau = {tau:.2f}"
        for name, value in zip(response.outputs, response([tau])[:, 0], strict=True):
            (size,) = (grid.high - grid.low for curve, grid, _ in curves(building) if curve == name)
            assert float(said[name]) == pytest.approx(value, abs=0.006 * size)


@pytest.mark.slow
def test_curves_are_zoomed_around_the_cursor(building: str, tmp_path: Path) -> None:
    script = """
      const slider = document.getElementById("cursor"), zoom = document.getElementById("zoom");
      const plot = document.querySelector("svg.timed"), figure = plot.closest("figure");
      slider.value = 800; slider.dispatchEvent(new Event("input"));
      const before = plot.getBoundingClientRect().width;
      zoom.value = "4"; zoom.dispatchEvent(new Event("change"));
      const cursor = plot.querySelector(".cursor").getBoundingClientRect(), box = figure.getBoundingClientRect();
      const seen = (cursor.left - box.left) / box.width, wide = plot.getBoundingClientRect().width;
      zoom.value = "1"; zoom.dispatchEvent(new Event("change"));
      report([wide / before, seen, plot.getBoundingClientRect().width / before]);
    """
    wider, seen, again = reported(building, script, tmp_path)  # type: ignore[misc]
    assert wider == pytest.approx(4, rel=0.01)
    assert seen == pytest.approx(0.5, abs=0.02)
    assert again == pytest.approx(1)


LOOK = "\n;axe.run(document).then((found) => report(found.violations.map((each) => each.id)));"


def test_axe_finds_nothing(building: str, tmp_path: Path) -> None:
    assert reported(building, axe() + LOOK, tmp_path) == []


@pytest.mark.slow
def test_axe_finds_what_is_wrong(building: str, tmp_path: Path) -> None:
    broken = building.replace("<label ", "<span ").replace("</label>", "</span>").replace('id="extremes"', "")
    assert {"label", "aria-valid-attr-value"} & set(reported(broken, axe() + LOOK, tmp_path))  # type: ignore[call-overload]


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["drive_m1", "collision_m4"])
def test_other_systems_have_pages(name: str) -> None:
    text = page(Scene.from_toml(name))
    assert faults(text) == []
    assert strays(text, Scene.from_toml(name)) == []


CHAIN = {
    "type": "chain",
    "parts": [
        {"motion": "velocity", "name": "shaker"},
        {"rod": 1, "name": "first"},
        {"mass": 2, "name": "hub", "spring": 1, "dashpot": "1/2"},
        {"spring": 3},
        {"mass": 1, "name": "ring"},
        {"rod": "1/2", "impedance": 4},
        "contact",
        {"rod": 1},
        "fixed",
    ],
    "branch": [{"from": "hub", "name": "arm", "parts": [{"rod": 1}, {"mass": 1, "name": "tip"}]}],
}


def test_all_that_a_chain_is_made_of_is_drawn() -> None:
    load = [{"at": "shaker", "times": [0], "steps": [1]}, {"at": "tip", "times": [0], "steps": [1]}]
    scene = Scene(name="chain", system=CHAIN, load=load, output={"until": 4, "velocity": ["hub", "arm:1/2"]})
    made = structure(lower(scene), scene.system.lines)
    assert faults(f"<script></script>{made.markup}") == []
    for name in ("shaker", "first", "hub", "ring", "arm", "tip"):
        assert made.markup.count(f">{name}<") == 1
    assert made.markup.count('class="mass"') == 3
    assert made.markup.count('class="rod"') == 4
    assert made.markup.count('class="place"') == 2
    assert "1 contact" in made.description


def test_report_is_a_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["report", "drive_m1", "-o", "drive.txt"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
    payloaded(tmp_path, "drive_m1")
    assert main(["report", "mine.toml", "-o", "drive.html"]) == 0
    text = Path("drive.html").read_text(encoding="utf-8")
    assert "&lt;script&gt;" in text
    assert str(tmp_path) not in text


def test_a_scene_from_standard_input_is_on_its_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given = (builtin_text("drive_m1") + PAYLOAD).encode()
    monkeypatch.setattr("sys.stdin", TextIOWrapper(BytesIO(given)))
    assert main(["report", "-", "-o", str(tmp_path / "drive.html")]) == 0
    assert "&lt;script&gt;" in (tmp_path / "drive.html").read_text(encoding="utf-8")


def rooms(module: str, seen: set[str]) -> set[str]:
    """A module of `wavesym.pictures` and all others that it imports there, with what else they import."""
    if module not in seen:
        seen.add(module)
        place = Path(wavesym.__file__).parent.joinpath(*module.split(".")[1:])
        path = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
        if module.startswith("wavesym.pictures."):
            for other in re.findall(r"^ *(?:from|import) ([\w.]+)", path.read_text(encoding="utf-8"), re.MULTILINE):
                rooms(other, seen)
    return seen


def test_pages_need_no_matplotlib() -> None:
    assert not any(module.startswith("matplotlib") for module in rooms("wavesym.pictures.page.document", set()))
    assert any(module.startswith("matplotlib") for module in rooms("wavesym.pictures.panels", set()))
