"""Pictures of modes and frequency responses: what is written in them."""

from __future__ import annotations

import numpy as np
import pytest

import wavesym
from wavesym.scene import Scene, lower

pytest.importorskip("matplotlib")

from tools import front_page
from wavesym.pictures.result_pictures import draw_frequency_response, draw_modes

SHAFT = {"rod": "2 m", "diameter": "50 mm", "G": "80 GPa", "rho": "7850 kg/m^3"}
PARTS = [{"mass": "2 kg*m^2", "name": "motor"}, SHAFT, {"mass": "1 kg*m^2", "name": "big_machine"}]
DRIVE = Scene(
    name="drive_of_Fl",
    units={"kind": "torsional"},
    system={"type": "chain", "parts": PARTS},
    load=[{"at": "big_machine", "name": "step", "times": ["0 s"], "steps": ["40 N*m"]}],
    output={"until": "1 s", "velocity": ["motor", "big_machine"], "force": ["1 m"]},
)


def test_a_frequency_response_has_names_for_people() -> None:
    figure = draw_frequency_response(wavesym.frf(DRIVE, [5.0, 10.0]), lower(DRIVE, in_time=False))
    assert figure.get_suptitle() == "Drive of Fl: amplitudes per N\u00b7m of step"
    first, second, phase = figure.axes
    names = [[text.get_text() for text in axes.get_legend().get_texts()] for axes in (first, second)]
    assert ["Angular velocity of motor", "Angular velocity of big machine"] in names
    assert ["Moment at 1 m"] in names or ["Moment at x = 1 m"] in names
    assert {first.get_ylabel(), second.get_ylabel()} == {"angular velocity\nin rad/s", "moment\nin N\u00b7m"}
    assert (phase.get_xlabel(), phase.get_ylabel()) == ("frequency in Hz", "phase\nin degrees")


def test_a_frequency_response_shows_its_greatest_amplitudes() -> None:
    """Eleven points miss what an enclosure finds between them; names stand beside lines, not on them."""
    parts = [{"mass": "2 kg*m^2", "name": "motor", "dashpot": "2 N*m*s"}, *PARTS[1:]]
    damped = DRIVE.with_({"system.parts": parts})
    found = wavesym.frf(damped, low=5, high=100, points=11)
    figure = draw_frequency_response(found, lower(damped, in_time=False))
    figure.canvas.draw()
    lines = [line for axes in figure.axes[:2] for line in axes.get_lines()]
    for name, line in zip(("velocity@motor", "velocity@big_machine", "force@1"), lines, strict=True):
        (peak,) = (each for each in found.peaks() if each.name.startswith(name))
        highest = np.nanmax(np.asarray(line.get_ydata(), float))
        assert highest == pytest.approx(peak.amplitude, rel=1e-9)
        assert highest > 1.5 * found.amplitude[found.outputs.index(peak.name)].max() or peak.frequency == 5
    for axes in figure.axes[:2]:
        assert axes.get_legend().get_window_extent().y0 >= axes.get_window_extent().y1


@pytest.mark.parametrize(
    ("scene", "title"),
    [(DRIVE, "position in m"), ("building_m2", "floor (0: foundation)"), ("drive_m1", "position in rods")],
)
def test_shapes_say_what_is_counted_along_the_chain(scene: Scene | str, title: str) -> None:
    scene = scene if isinstance(scene, Scene) else Scene.from_toml(scene)
    figure = draw_modes(wavesym.modes(scene, 2), lower(scene, in_time=False), scene.system.lines)
    assert [axes.get_xlabel() for axes in figure.axes] == [title]


def test_names_in_the_chart_of_speed_stay_inside() -> None:
    """One ran over the right edge."""
    figure = front_page.chart()
    figure.canvas.draw()
    (axes,) = figure.axes
    inside, boxes = axes.get_window_extent(), [text.get_window_extent() for text in axes.texts]
    assert len(boxes) == 5
    assert all(inside.x0 < box.x0 < box.x1 < inside.x1 - 5 for box in boxes)
    assert not any(box.overlaps(other) for k, box in enumerate(boxes) for other in boxes[:k])
