"""Place x time: the values are those of outputs there, the lines are the chain's, and the picture is the same again."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb

import wavesym
from wavesym.exact.reference import Reference
from wavesym.mechanics.event import ContactEvent
from wavesym.pictures import xt
from wavesym.pictures.field import Field
from wavesym.pictures.stations import loose_times
from wavesym.scene import Scene, lower

CHAIN = {
    "type": "chain",
    "parts": [
        {"mass": 2, "velocity": 1},
        {"rod": "1/2"},
        {"rod": 2, "impedance": 3, "speed": 2},
        {"mass": 1, "name": "a"},
    ],
    "branch": [{"from": "a", "name": "b", "ratio": 2, "parts": [{"rod": 1}, "fixed"]}],
}
VISIBLE = 1e-6  # far below a shade of colour
PLACES = {"velocity": ["1/4", "3/2", "b:1/3"], "strain": ["1/4", "3/2", "b:1/3"]}


def test_a_field_has_what_outputs_have():
    scene = wavesym.Scene(name="field", system=CHAIN, load=[], output={"until": 6, **PLACES})
    model = lower(scene)
    field = Field(model)
    taus = np.linspace(0.01, 5.9, 50)
    values = np.array(Reference(model).values(taus.tolist()))
    for k, (bar, part, impedance) in enumerate([(0, 0.5, 1), (1, 0.5, 3 * 2), (2, 1 / 3, 1)]):
        velocity, force = field.values_at(bar, np.full_like(taus, part), taus)
        assert np.allclose(force, impedance * values[k], rtol=0, atol=VISIBLE)
        assert np.allclose(velocity, values[3 + k], rtol=0, atol=VISIBLE)


def test_lines_are_the_chain_and_its_branches():
    lines = wavesym.Scene(name="lines", system=CHAIN, load=[], output={"until": 1, "velocity": [0]}).system.lines
    assert {name: [station.right for station in stations] for name, stations in lines.items()} == {
        "": [0, 1, None],
        "b": [2, None],
    }
    assert [float(stations[-1].x) for stations in lines.values()] == [2.5, 1.0]
    drive = Scene.from_toml("drive_m1").system.lines
    assert [station.points for station in drive[""]] == [(0,), (1,)]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["building_m2"])
def test_the_same_picture_again(name, tmp_path):
    pytest.importorskip("matplotlib")
    from wavesym import api

    scene = Scene.from_toml(name)
    for file in ("one.png", "other.png"):
        api.plot(scene, tmp_path / file, "xt")
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "other.png").read_bytes()


def test_contacts_are_white_while_they_are_open_and_masses_black(tmp_path):
    """A mass meets a bar: between them it is white until they meet, and the bar's colour from then on."""
    pytest.importorskip("matplotlib")
    from matplotlib.image import imread

    parts = [{"mass": 1, "velocity": 1}, {"contact": 2}, {"rod": 10, "velocity": "1/2"}, "fixed"]
    model, lines = _made(parts, until=8, strain=["5"])
    assert loose_times(model, Field(model).events) == {model.network.links[0]: [(0.0, 4.0)]}
    figure = xt.draw(model, lines)
    figure.savefig(tmp_path / "open.png")
    picture = imread(tmp_path / "open.png")[:, :, :3]
    axes = figure.axes[0]

    def colour(points: float, tau: float) -> tuple[float, ...]:
        """What is to be seen at a time, so many points right of the bar's left end."""
        x, y = axes.transData.transform((0, tau))
        return tuple(picture[picture.shape[0] - 1 - int(y), int(x + points / 72 * figure.dpi)])

    assert [colour(2, tau) for tau in (0.5, 2, 3.8)] == [(1, 1, 1)] * 3
    assert all(colour(points, tau) != (1, 1, 1) for points, tau in ((2, 4.2), (2, 6), (8, 1)))
    assert colour(-2, 2) == colour(-2, 6) == (0, 0, 0)


def test_contacts_open_at_first_and_at_last():
    """A gap is open from the start; what has not closed again is open to the end."""
    model, _ = _made([{"rod": 1}, {"contact": 1}, {"rod": 1}, "contact", {"rod": 1}], until=9, strain=["1/2"])
    said = [(0, "closes", 2), (1, "opens", 3), (0, "opens", 5), (0, "closes", 6)]
    events = [ContactEvent("", kind, arb(tau), link) for link, kind, tau in said]
    first, second = model.network.links
    assert loose_times(model, events) == {first: [(0.0, 2.0), (5.0, 6.0)], second: [(3.0, 9.0)]}


def test_what_slides_or_yields_is_told_from_when_to_when():
    """What moves at first slides; a limit holds at first; friction that turns goes on sliding."""
    model, _ = _made(
        [{"mass": 1, "velocity": 1, "friction": 1}, {"rod": 1}, {"spring": 1, "yield": 1}, "fixed"],
        until=9,
        strain=["1/2"],
    )
    spring, friction = model.network.links
    assert friction.friction
    said = [(1, "slips", 1), (1, "sticks", 2), (0, "yields", 1), (0, "holds", 3)]
    events = [ContactEvent("", kind, arb(tau), link) for link, kind, tau in said]
    assert loose_times(model, events) == {friction: [(0.0, 2.0)], spring: [(1.0, 3.0)]}


def test_units_are_on_the_axes_and_in_the_colours():
    """A shaft that is written out in m, and drawn in ms, rpm and kN m: each cell is what an output there is."""
    shaft = {"rod": "2 m", "diameter": "50 mm", "G": "80 GPa", "rho": "7850 kg/m^3"}
    scene = wavesym.Scene(
        name="shaft",
        units={"kind": "torsional", "time": "ms", "velocity": "rpm", "moment": "kN*m"},
        system={"type": "chain", "parts": [{"mass": "1 kg*m^2", "velocity": "100 rpm"}, shaft, "fixed"]},
        output={"until": "2 ms", "velocity": ["1.5 m"], "force": ["1.5 m"]},
    )
    figure = xt.draw(lower(scene), scene.system.lines, scene.physical)
    until = float(lower(scene).until)
    for quantity, axes in zip((0, 1), figure.axes[::2], strict=False):
        ends = [(x, label.get_text()) for x, label in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)]
        assert (ends[0], ends[-1]) == ((0, "0"), (1, "2"))
        assert axes.get_ylim() == pytest.approx((0, 2))
        assert (axes.get_xlabel(), axes.get_ylabel()) == ("x in m", "t in ms")
        cells = axes.collections[0].get_array()
        rows, columns = cells.shape
        near = [int(part * rows) for part in (0.2, 0.5, 0.9)]
        there = wavesym.evaluator(scene)([(row + 0.4142) / rows * until for row in near])[quantity]
        assert np.max(np.abs(cells[near, int(0.75 * columns)] - there)) < 0.01 * np.max(np.abs(cells))
        assert np.max(np.abs(there)) > 0.1 * np.max(np.abs(cells))
    assert [text.get_text() for text in figure.texts[2:]] == ["Angular velocity in rpm", "Moment in kN\u00b7m"]


def test_rods_are_named_above_their_waves_and_titles_keep_their_capitals():
    scene = wavesym.Scene.from_toml("examples/chains/split_hopkinson_bar.toml")
    figure = xt.draw(lower(scene), scene.system.lines)
    assert figure.texts[0].get_text() == "Split Hopkinson bar: waves over place and time"
    axes = figure.axes[0]
    named = {text.get_text(): text for text in axes.texts}
    figure.canvas.draw()
    middles = {"striker": 1, "incident": 4.5, "specimen": 7.25, "transmitter": 10}
    assert named.keys() == middles.keys()
    for name, x in middles.items():
        box = named[name].get_window_extent()
        assert (box.x0 + box.x1) / 2 == pytest.approx(axes.transData.transform((x, 0))[0], abs=1), name
        assert box.y0 > axes.get_window_extent().y1, name
    many = [{"rod": "1/9", "name": f"layer_{k}"} for k in range(40)]
    model, lines = _made([*many, {"mass": 1, "name": "end"}], until=2, strain=["1"])
    texts = xt.draw(model, lines).axes[0].texts
    assert 8 < len(texts) < 20, "rods that find no room in two rows go without"
    assert texts[-1].get_text() == "end"
    assert len({text.xyann[1] for text in texts}) <= 3


def test_names_do_not_lie_over_one_another():
    """Nor over the numbers at the axis: the first name begins at its place, the last one ends there."""
    thin = {"rod": "1/50", "name": "thin"}
    named = [{"mass": 1, "name": "a_long_name"}, thin, {"mass": 1, "name": "another_name"}, {"rod": 3}]
    model, lines = _made([*named, {"motion": "velocity", "name": "ground"}], until=2, strain=["1"])
    figure = xt.draw(model, lines)
    axes = figure.axes[0]
    boxes = [text.get_window_extent(figure.canvas.get_renderer()) for text in axes.texts]
    assert len(boxes) == 4
    assert not any(one.overlaps(other) for k, one in enumerate(boxes) for other in boxes[:k])
    ticks = [label.get_window_extent() for label in axes.get_yticklabels()]
    assert not any(box.overlaps(tick) for box in boxes for tick in ticks)


@pytest.mark.quick(1)
@pytest.mark.parametrize("branch", ["1/2", "2", "20"])
def test_numbers_below_a_branch_do_not_lie_over_those_beside_them(branch):
    own = {**CHAIN, "branch": [{"from": "a", "name": "b", "parts": [{"rod": branch}, "fixed"]}]}
    scene = wavesym.Scene(name="beside", system=own, output={"until": 2, "velocity": [0]})
    figure = xt.draw(lower(scene), scene.system.lines)
    figure.canvas.draw()
    shown = [[text.get_window_extent() for text in axes.get_xticklabels() if text.get_text()] for axes in figure.axes]
    assert min(map(len, shown[:2])) >= 1
    boxes = [box for axes in shown[:2] for box in axes]
    assert not any(one.overlaps(other) for k, one in enumerate(boxes) for other in boxes[:k])


def test_fronts_are_where_outputs_jump():
    """A pulse of two jumps runs down a bar and back: lines leave its ends then, and no others."""
    parts = [{"joint": True, "name": "head"}, {"rod": 2}, "fixed"]
    load = [{"at": "head", "times": [0, "1/2"], "steps": [1, -1]}]
    scene = Scene(name="s", system={"type": "chain", "parts": parts}, load=load, output={"until": 3, "force": [1]})
    field = Field(lower(scene))
    left, right = field.fronts(0)
    assert left.tolist() == [0, 0.5]
    assert right.tolist() == [2, 2.5]
    assert field.delay(0) == 2


def test_a_wave_without_jumps_has_no_fronts():
    parts = [{"joint": True, "name": "head"}, {"rod": 2}, "fixed"]
    load = [{"at": "head", "times": [0], "ramps": [1]}]
    scene = Scene(name="s", system={"type": "chain", "parts": parts}, load=load, output={"until": 3, "force": [1]})
    assert [times.tolist() for times in Field(lower(scene)).fronts(0)] == [[], []]


def _made(parts, until, **output):
    scene = Scene(name="s", system={"type": "chain", "parts": parts}, output={"until": until, **output})
    return lower(scene), scene.system.lines
