"""Numbers on pages and pictures in the units that people write, and scenes as others may read them."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from flint import fmpq

from wavesym.mechanics.probe import Probe
from wavesym.pictures.histories import History
from wavesym.pictures.naming import in_readable_units
from wavesym.results.presentation import group_thousands, readable_unit
from wavesym.results.statistics import OutputSummary, OutputTime, Peak
from wavesym.scene import Scene
from wavesym.scene.first_scene import first_text
from wavesym.scene.shown_text import shown_text

AT = OutputTime(1.0, 2.0)


def history(quantity: str, unit: str, *values: float) -> History:
    probe = Probe(f"{quantity}@0", quantity, 1, fmpq(0), factor=fmpq(2), unit=unit)
    return History(probe, (np.array([[0.0, values[0]], [1.0, values[1]]]), np.array([[1.0, values[2]]])))


@pytest.mark.parametrize(
    ("largest", "unit", "expected"),
    [
        (-5.4e6, "N", (1000, "kN")),
        (9_999.0, "N", (1, "N")),
        (1e4, "N*m", (1000, "kN*m")),
        (1e4, "N\u00b7m", (1000, "kN\u00b7m")),
        (2e6, "Pa", (1_000_000, "MPa")),
        (5e6, "mm", (1, "mm")),
        (5e6, "kN", (1, "kN")),  # as the scene says
        (5e6, "", (1, "")),
    ],
)
def test_large_forces_have_units_as_engineers_write_them(largest, unit, expected):
    assert readable_unit(largest, unit) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("15090 kN", "15\u202f090 kN"),
        ("-1509000", "-1\u202f509\u202f000"),
        ("1509", "1509"),
        ("0.0123456", "0.0123456"),
    ],
)
def test_thousands_are_grouped_from_five_figures_on(text, expected):
    assert group_thousands(text) == expected


def test_curves_of_a_quantity_share_the_unit_of_the_largest():
    large, small, motion = in_readable_units(
        [
            history("force", "N", 0.0, 2e4, -5e6),
            history("force", "N", 0.0, 3.0, 1.0),
            history("velocity", "m/s", 0, 2e5, 1),
        ]
    )
    assert [each.output.unit for each in (large, small, motion)] == ["kN", "kN", "m/s"]
    assert large.points.tolist() == [[0.0, 0.0], [1.0, 20.0], [1.0, -5000.0]]
    assert small.points.tolist() == [[0.0, 0.0], [1.0, 0.003], [1.0, 0.001]]
    assert large.output.factor == fmpq(1, 500)
    assert motion.points[1, 1] == 2e5


def test_a_summary_is_read_in_kilonewtons_and_kept_in_newtons():
    found = OutputSummary("force@0", "N", Peak(-5e6, AT), Peak(4e6, AT), AT, 1e3, 2e6, -3e5, "Base shear")
    shown = found.readable
    assert (shown.unit, shown.min.value, shown.max.value) == ("kN", -5000.0, 4000.0)
    assert (shown.mean, shown.rms, shown.residual, shown.title) == (1.0, 2000.0, -300.0, "Base shear")
    assert found.unit == "N"
    assert OutputSummary("force@0", "N", Peak(-5.0, AT), Peak(4.0, AT), AT).readable.unit == "N"


SCENE = """# made by me
name = "a"   # "quoted" # twice
[system]     # no record = "x" here

# a line
text = "# not a comment"
load = [{ at = '# base', record = "/home/me/secret/quake # 1.csv" }, { record="C:\\\\me\\\\b.at2" }]
other = "record = '/home'"
"""


def test_a_scene_is_shown_without_remarks_and_folders():
    shown = shown_text(SCENE)
    assert shown == (
        'name = "a"\n[system]\n\ntext = "# not a comment"\n'
        'load = [{ at = \'# base\', record = "quake # 1.csv" }, { record="b.at2" }]\nother = "record = \'/home\'"\n'
    )


@pytest.mark.parametrize("kind", ["frame", "wall", "soil", "drive", "impact", "pile", "building", "collision"])
def test_what_is_shown_of_a_scene_is_the_same_scene(kind):
    text = first_text(kind)
    shown = shown_text(text)
    assert "#" not in shown
    assert tomllib.loads(shown) == tomllib.loads(text)
    assert Scene.from_toml(shown) == Scene.from_toml(text)
