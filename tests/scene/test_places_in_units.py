"""Places of a chain whose scene has units are told in its unit of length, wherever they are told."""

from __future__ import annotations

import copy
import json
import pickle
import re
from fractions import Fraction
from pathlib import Path

import pytest

from tests.support.generated import files
from wavesym.cli import main
from wavesym.errors import WavesymError
from wavesym.exact.reference import Reference
from wavesym.mechanics.length import LengthUnit, axis_text, place_text
from wavesym.pictures.page.document import page
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower
from wavesym.systems.place import PlaceInUnits, position_of

STEEL = 'E = "210 GPa", A = "1 cm^2", rho = "7850 kg/m^3"'
PARTS = f"""
[system]
type = "chain"
parts = [{{ rod = "1.2 m", {STEEL}, velocity = "1 m/s" }}, {{ rod = "1.3 m", {STEEL}, velocity = "1 m/s" }}, "contact",
  {{ rod = "0.7 m", {STEEL} }}, {{ contact = "1 um" }}, {{ rod = "70 cm", {STEEL} }}, "fixed"]
"""
BAR = 'name = "bar"\nunits = { length = "mm", time = "ms" }\nload = []\n'
BAR += 'output = { until = "2 ms", tolerance = 1e-9, strain = ["1.9 m"], velocity = ["2.5 m-"] }\n' + PARTS
LOAD = '{ at = "1.2 m", times = ["0 s", "0.1 ms"], steps = ["1 kN", "-1 kN"] }'

# the same in the length of the first rod
RODS = ("25/12", "8/3")


@pytest.fixture
def bar(tmp_path: Path) -> Path:
    path = tmp_path / "bar.toml"
    path.write_text(BAR, encoding="utf-8")
    return path


def scene(text: str, path: Path) -> Scene:
    path.write_text(text, encoding="utf-8")
    return Scene.from_toml(path)


def test_the_text_of_a_place() -> None:
    metres, feet = LengthUnit(Fraction(6, 5), "m"), LengthUnit(Fraction(10000, 3048), "ft")
    assert place_text(Fraction(25, 12), "", "-", metres) == "2.5 m-"
    assert place_text(Fraction(25, 12), "a", "+", metres) == "a:2.5 m+"
    assert place_text(Fraction(25, 12), "a") == "a:25/12"
    assert place_text(Fraction(1), unit=feet) == "3.28083989501 ft"
    assert (axis_text(), axis_text("a", metres)) == ("x", "a:x in m")


def test_events_where_they_are_told(bar: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(bar), "-o", str(bar.parent / "bar.csv")]) == 0
    told = re.findall("contact at x = (.*?) (?:opens|closes)", capsys.readouterr().err)
    assert told == ["3200 mm", "2500 mm", "3200 mm"]
    made = files(lower(Scene.from_toml(bar)), "all")
    header, manifest, numpy = made["bar.h"], made["bar.json"], made["bar.py"]
    assert re.findall(r"/\* contact at x = (.*?) (?:opens|closes)", header) == told
    assert [event["x"] for event in json.loads(manifest)["events"]] == told
    assert all(f'"{place}"' in numpy for place in told)
    for text in (header, manifest, numpy):
        assert not any(place in text for place in RODS)


@pytest.mark.slow
def test_the_page_speaks_of_lengths(bar: Path) -> None:
    text = page(Scene.from_toml(bar))
    assert "<dt>Contact</dt><dd>at x = 2500 mm: opens" in text
    assert "<dt>Contact</dt><dd>at x = 3200 mm: closes" in text
    assert "x in mm" in text
    for place in ("1200 mm", "3900 mm"):  # under the structure
        assert f">{place}</text>" in text
    for place in (*RODS, "13/4"):
        assert f">{place}</text>" not in text
        assert f"x = {place}" not in text
    spots = [float(each) for each in re.findall(r"at x = ([0-9.e+-]+) mm", text)]
    assert max(spots) > 1000
    assert max(spots) <= 3900


@pytest.mark.parametrize(
    ("place", "right"),
    [
        ("2.5 m", '"2.5 m" has two sides; write "2.5 m-" or "2.5 m+"'),
        ("2100 mm", '"2100 mm" is not a node; write the name or place of one'),
        ("3.9 m", '"3.9 m" is a "fixed" end, which cannot move; write a node that can'),
        ("4 m", '"4 m" is not on the chain; write a place from 0 to 3.9 m'),
    ],
)
def test_a_refused_place_of_a_load_is_the_one_that_was_written(place: str, right: str, tmp_path: Path) -> None:
    with pytest.raises(WavesymError) as refused:
        scene(BAR.replace("load = []", f"load = [{LOAD.replace('1.2 m', place)}]"), tmp_path / "bar.toml")
    assert str(refused.value).endswith(f"load[0].at: {right} (line 3)")


def test_refusals_of_programs(tmp_path: Path) -> None:
    model = lower(scene(BAR, tmp_path / "bar.toml"))
    with pytest.raises(WavesymError, match="the contact at 2500 mm opens and closes"):
        make(model, Request("march"))
    rest = BAR.replace(', velocity = "1 m/s"', "").replace("load = []", f"load = [{LOAD}]")
    plain = rest.replace('"contact",', "").replace('{ contact = "1 um" },', "").replace("2.5 m-", "2.5 m")
    with pytest.raises(WavesymError, match="what acts at 1200 mm jumps by 1000 N at 0 ms"):
        make(lower(scene(plain, tmp_path / "bar.toml")), Request("modes"))
    damped = plain.replace('"fixed"', '"absorbing"').replace('type = "chain"', 'type = "chain"\ndamping = 0.01')
    with pytest.raises(WavesymError, match="damping: stands beside a dashpot or an absorbing end at 3900 mm"):
        scene(damped, tmp_path / "bar.toml")


CORNERED = f"""
name = "bar"
units = {{ length = "mm", time = "ms" }}
load = [{{ at = "1.3 m+", times = ["0 s", "0.3 ms"], steps = ["40 kN", "-40 kN"] }}]
output = {{ until = "1.25 ms", tolerance = 1e-9, velocity = ["3 m-"] }}
[system]
type = "chain"
parts = [{{ rod = "1.3 m", {STEEL}, velocity = "1 m/s" }}, "contact", {{ rod = "1.7 m", {STEEL} }},
  {{ joint = true, friction = "10 kN" }}, {{ rod = "90 cm", {STEEL} }}, {{ spring = "100 MN/m", yield = "10 kN" }},
  {{ rod = "1.1 m", {STEEL} }}, {{ spring = "100 MN/m", only = "push", gap = "1 um" }}, {{ rod = "0.4 m", {STEEL} }},
  "fixed"]
"""
# in the length of the first rod nodes are at 1, 30/13, 3, 50/13 and 54/13, and the load's side is 1+
CORNERS = {"contact": "1300 mm", "friction": "3000 mm", "spring": ("3900 mm", "5000 mm")}


def test_every_law_with_a_corner_is_where_the_scene_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bar.toml"
    path.write_text(CORNERED, encoding="utf-8")
    assert main(["run", str(path), "-o", str(tmp_path / "bar.csv")]) == 0
    told = capsys.readouterr().err
    found = re.findall(r"(\w+) at x = (.*?) (opens|slips|sticks|yields|holds|engages|releases) at", told)
    assert {kind for *_, kind in found} == {"opens", "slips", "sticks", "yields", "holds", "engages", "releases"}
    assert all(place in CORNERS[law] for law, place, _ in found)
    assert {place for _, place, _ in found} == {"1300 mm", "3000 mm", "3900 mm", "5000 mm"}
    assert main(["summary", str(path)]) == 0
    losses = re.findall(r"^(friction|spring) at (.*?): set", capsys.readouterr().out, flags=re.MULTILINE)
    assert sorted(losses) == [("friction", "3000 mm"), ("spring", "3900 mm")]


@pytest.mark.parametrize(
    ("outputs", "line"),
    [
        ('strain = ["3.9 m"]', '3.9 m has two sides; write "3.9 m-" or "3.9 m+"'),
        ('velocity = ["3900 mm"]', '3900 mm has two sides; write "3900 mm-" or "3900 mm+"'),
        ('force = ["1.3 m"]', '1.3 m has two sides; write "1.3 m-" or "1.3 m+"'),
        ('velocity = ["5.5 m"]', '"5.5 m" is not on the chain; write a place from 0 to 5.4 m'),
        ('acceleration = ["2 m"]', "acceleration@2 m has no mass, and contacts that close make velocities jump"),
        ('acceleration = ["3 m"]', "acceleration@3 m has no mass, and contacts that close make velocities jump"),
    ],
)
def test_a_refused_place_of_an_output_is_the_one_that_was_written(outputs: str, line: str, tmp_path: Path) -> None:
    with pytest.raises(WavesymError, match=re.escape(line)) as refused:
        Reference(lower(scene(CORNERED.replace('velocity = ["3 m-"]', outputs), tmp_path / "bar.toml"))).values([0.5])
    assert not re.search("/13", str(refused.value))


def test_a_front_that_no_output_takes_is_where_the_scene_says(tmp_path: Path) -> None:
    glued = CORNERED.replace('"contact", ', "").replace("1.3 m+", "1.3 m").replace(', friction = "10 kN"', "")
    glued = (
        glued.replace(', yield = "10 kN"', "")
        .replace(', only = "push", gap = "1 um"', "")
        .replace('"1 m/s"', '"0 m/s"')
    )
    text = glued.replace('velocity = ["3 m-"]', 'acceleration = ["2 m"]')
    front = r"acceleration@2 m: a front .* can pass there \(what acts at 1300 mm jumps by 40000 N at 0 ms\)"
    with pytest.raises(WavesymError, match=front):
        Reference(lower(scene(text, tmp_path / "bar.toml"))).values([0.5])


def test_what_is_computed_is_the_same(tmp_path: Path) -> None:
    """Places are words: without units the network is the same but for them, and contacts at one place have sides."""
    told = scene(BAR.replace('"1 um"', '"0 m"'), tmp_path / "bar.toml")
    model, plain = lower(told), lower(told.dimensionless())
    assert [link.place for link in model.network.links] == ["2500 mm", "3200 mm"]
    assert [link.place for link in plain.network.links] == list(RODS)
    assert [point.place for point in model.network.points][2:4] == ["2500 mm-", "2500 mm+"]
    assert [bar.length for bar in model.network.bars] == [bar.length for bar in plain.network.bars]
    two = '{ contact = "0 m" }, { joint = true, dashpot = "1 N*s/m" }, { contact = "0 m" }'
    model = lower(scene(BAR.replace('"contact"', two), tmp_path / "bar.toml"))
    assert [link.place for link in model.network.links] == ["2500 mm-", "2500 mm+", "3200 mm"]


def test_a_place_in_units_survives_copies() -> None:
    place = PlaceInUnits("25/12-", "2.5 m-")
    for each in (place, copy.deepcopy(place), pickle.loads(pickle.dumps(place))):
        assert each == "25/12-"
        assert position_of(each)[:3] == ("2.5 m-", Fraction(25, 12), -1)
