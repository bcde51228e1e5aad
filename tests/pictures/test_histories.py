"""Histories: fronts as jumps, held against the exact arrivals; and how they are drawn."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import inf, nextafter
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq

from tests.pictures.clear import texts_keep_clear
from wavesym.api import evaluator
from wavesym.derivation.increments import start
from wavesym.exact.contacts.events import contact_ends
from wavesym.exact.extremes import extremes
from wavesym.exact.reference import Reference
from wavesym.mechanics.clock import Clock
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import nearest, not_below, rational
from wavesym.pictures import histories as made_of
from wavesym.pictures.histories import Histories, History, arrivals, histories
from wavesym.pictures.loads import load_histories
from wavesym.scene import Scene, lower

pytest.importorskip("matplotlib")

from matplotlib.figure import Figure

from wavesym.pictures import panels
from wavesym.pictures.panels import PlotPanel, draw, isolated_vertices, jumps, notes, stack_panels, thin_polyline
from wavesym.pictures.saving import save

THIRDS = Scene(
    name="thirds",
    system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
    load=[{"times": ["1/3", 2], "a": [1, -1], "b": [0, "1/2"]}],
    output={"until": 7, "strain": ["1/7", "3/2", "1+"], "velocity": [0, "0.7"], "displacement": [1]},
)
SCENES = ("thirds", "building_m2", "collision_m4", "drive_m1")
# both values at a jump may be wrong by the tolerance of a picture, in the largest value
ALLOWED = 2.01e-6


def scene(name: str) -> Scene:
    return THIRDS if name == "thirds" else Scene.from_toml(name)


def exact_jumps(of: Model) -> list[dict[float, float]]:
    """When each output jumps and by how much: the arrivals whose increment does not start at 0."""
    found = Reference(of).signals
    assert found is not None
    return [
        {
            not_below(one.time): float(start(one.increment))
            for one in signal.arrivals
            if one.time > 0 and start(one.increment)
        }
        for signal in found
    ]


def slopes(made: Histories) -> list[tuple[str, float]]:
    """Where a line would be drawn across a jump."""
    return [
        (history.name, tau)
        for history, sizes in zip(made.outputs, exact_jumps(made.model), strict=True)
        for tau in sizes
        for stretch in history.stretches
        if stretch[0, 0] < tau <= stretch[-1, 0]
    ]


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SCENES)
def test_histories_jump_where_waves_do_and_nowhere_else(name: str) -> None:
    made = histories(lower(scene(name)))
    assert slopes(made) == []
    for history, sizes in zip(made.outputs, exact_jumps(made.model), strict=True):
        size = np.max(np.abs(history.points[:, 1]))
        found = {after[0]: after[1] - before[1] for before, after in jumps(history)}
        assert sorted(found) == sorted(sizes)
        assert all(abs(found[tau] - sizes[tau]) <= ALLOWED * size for tau in sizes)


def test_some_of_these_scenes_jump() -> None:
    assert sum(len(sizes) for name in SCENES for sizes in exact_jumps(lower(scene(name)))) > 40


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SCENES)
def test_both_sides_of_a_jump_are_those_of_the_reference(name: str) -> None:
    made = histories(lower(scene(name)))
    response = evaluator(scene(name))
    for k, history in enumerate(made.outputs):
        size = np.max(np.abs(history.points[:, 1]))
        for before, after in jumps(history):
            assert before[0] == nextafter(after[0], 0)
            assert abs(before[1] - response(before[0])[k]) <= ALLOWED * size
            assert abs(after[1] - response(after[0])[k]) <= ALLOWED * size


def test_values_between_are_right_to_what_a_picture_shows() -> None:
    made = histories(lower(THIRDS))
    taus = made.outputs[0].points[::97, 0]
    exact = evaluator(THIRDS)(taus)
    for history, values in zip(made.outputs, exact, strict=True):
        assert np.max(np.abs(history.points[::97, 1] - values)) <= ALLOWED * np.max(np.abs(values))


def test_without_fronts_the_check_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(made_of, "arrivals", lambda scene, output: [])
    assert len(slopes(histories(lower(THIRDS)))) > 5


def test_a_front_left_out_makes_the_check_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(made_of, "arrivals", lambda scene, output: arrivals(scene, output)[:2])
    assert slopes(histories(lower(THIRDS)))


def test_fronts_are_known_from_loads_and_places() -> None:
    at = arrivals(lower(THIRDS), lower(THIRDS).probes[0])  # loads change at parts 0 and 1/3 of a unit, x = 1/7
    parts = {Fraction(1, 7), Fraction(6, 7), Fraction(1, 3) + Fraction(1, 7), Fraction(1, 3) - Fraction(1, 7)}
    assert at == sorted(not_below(rational(part + n)) for part in parts for n in range(7))


def test_what_comes_after_an_opening_is_formal(monkeypatch: pytest.MonkeyPatch) -> None:
    named: list[str] = []
    monkeypatch.setattr(panels, "label", lambda axes, curves, size: named.extend(curve.text for curve in curves))
    made = histories(lower(Scene.from_toml("collision_m4")))
    (end,) = contact_ends(made.model)
    for history in made.outputs:
        assert history.formal == end.double + abs(nearest(history.output.rod - 1 + history.output.place) - 2)
    figure = draw(made)
    lit = [line for line in figure.axes[0].lines if line.get_alpha() == panels._ALPHA[True]]
    assert any(len(line.get_xdata()) > 10 for line in lit)
    assert all(line.get_xdata()[0] >= end.double for line in lit if len(line.get_xdata()))
    drawn = [line for line in figure.axes[0].lines if line.get_color() == panels.CURVES[1][1]]  # strain@2
    solid = np.concatenate([line.get_xdata() for line in drawn if line.get_alpha() == 1.0])
    assert max(solid) == end.double
    assert "contact at x = 2 opens, tau = 8.902" in named


def test_loose_tolerances_stay_and_tight_ones_do_not_hinder() -> None:
    impossible = THIRDS.model_copy(
        update={"output": THIRDS.output.model_copy(update={"tolerance": Fraction(1, 10**30)})}
    )
    assert len(histories(lower(impossible)).outputs) == len(THIRDS.outputs)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["drive_m1", "building_m2"])
def test_labels_are_the_proved_extremes_to_their_digits(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    short = Scene.from_toml(name)
    long = short.model_copy(update={"output": short.output.model_copy(update={"until": Fraction(40)})})
    proved, marked = extremes(lower(long)), histories(lower(long))
    monkeypatch.setattr(made_of, "_with_peaks", lambda program, taus, _: (taus, program.evaluate(taus)))
    plain = [history.extremes for history in histories(lower(long)).outputs]
    missed = 0
    for pair, history, vertices in zip(proved, marked.outputs, plain, strict=True):
        true = np.array([(each.tau, each.value) for each in pair])
        largest = np.max(np.abs(true[:, 1]))
        assert np.max(np.abs(history.extremes - true)[:, 1]) <= ALLOWED * largest
        assert np.max(np.abs(history.extremes - true)[:, 0]) <= 0.002, "when, to the square root of that"
        missed += np.max(np.abs(vertices - true)[:, 1]) > ALLOWED * largest
    assert missed, "the vertices that are drawn alone do not have them"
    told = {f"{each.value:.4g}" for pair in proved for each in pair}
    assert {mark.text.partition(" at ")[0] for panel in panels.panels(marked) for mark in panel.marks} <= told


def test_fronts_too_dense_to_be_seen_are_not_drawn_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(made_of, "MOST_FRONTS", 3)
    made = histories(lower(THIRDS))
    assert all(len(history.stretches) == 1 for history in made.outputs)
    assert [line for line in notes(made) if "more fronts than the picture has columns" in line]


RAMP = np.array([(0.0, 0.0), (1.0, 1.0)])


def fabricated(count: int, still: int = 0) -> Histories:
    """Straight lines, and some that stay 0."""
    outputs = [
        History(Probe(f"strain@{k}", "strain", 1, fmpq(k)), (RAMP * (1, (k + 1) * (k >= still)),)) for k in range(count)
    ]
    return Histories(lower(THIRDS), tuple(outputs), (), dense=False)


@pytest.mark.parametrize(("count", "sizes"), [(1, [1]), (8, [8]), (9, [4, 5]), (40, [8] * 5), (60, [8] * 6)])
def test_many_outputs_have_several_panels(count: int, sizes: list[int]) -> None:
    made = fabricated(count)
    assert [len(panel.histories) for panel in panels.panels(made)] == sizes
    assert notes(made) == (["strain: the first 48 of 60 outputs that move are drawn"] if count == 60 else [])


def test_what_stays_zero_is_said_and_not_drawn() -> None:
    made = fabricated(3, still=2)
    assert [history.name for panel in panels.panels(made) for history in panel.histories] == ["strain@2"]
    assert notes(made) == ["0 throughout: strain@0, strain@1"]
    assert "0 throughout: strain@0, strain@1" in [text.get_text() for text in draw(made).texts]
    assert len(draw(fabricated(2, still=2)).axes) == 1


@pytest.fixture(scope="module")
def building() -> Histories:
    return histories(lower(Scene.from_toml("building_m2")))


@pytest.fixture(scope="module")
def figure(building: Histories) -> Figure:
    return draw(building, load_histories(building.model))


@pytest.mark.slow
def test_every_output_is_named_beside_its_curve_and_titled_with_its_unit(building: Histories, figure: Figure) -> None:
    names = [text.get_text() for axes in figure.axes for text in axes.texts if text.get_text()]
    assert sorted(name for name in names if " at " not in name) == sorted(
        [history.name for history in building.outputs] + ["acceleration of the base"]
    )
    assert figure.axes[-1].get_xlabel() == "tau = c t / l (dimensionless)"
    assert all(axes.get_ylabel().endswith("(dimensionless)") for axes in figure.axes[1:])


def test_no_name_covers_another_or_leaves_its_panel(figure: Figure) -> None:
    assert texts_keep_clear(figure)


def test_drawn_lines_do_not_slope_across_a_front(building: Histories, figure: Figure) -> None:
    """What reaches matplotlib: within a jump only upright lines."""
    (_, axes, *_), sizes = figure.axes, exact_jumps(building.model)[0]
    assert sizes
    for line in axes.lines:
        tau = np.asarray(line.get_xdata(), dtype=float)
        for low, high in pairwise(tau):
            at = [front for front in sizes if low < front <= high and line.get_color() == "black"]
            assert not at or low == nextafter(high, 0) or low == high


def test_a_notebook_shows_a_figure_before_pyplot_is_there(figure: Figure) -> None:
    assert figure._repr_png_()[:4] == b"\x89PNG"


@pytest.mark.slow
def test_same_histories_same_bytes(tmp_path: Path) -> None:
    for suffix in ("svg", "png"):
        for name in "ab":
            save(draw(fabricated(2)), tmp_path / f"{name}.{suffix}")
        assert (tmp_path / f"a.{suffix}").read_bytes() == (tmp_path / f"b.{suffix}").read_bytes()


@pytest.mark.parametrize("suffix", ["svg", "png"])
def test_a_picture_that_cannot_be_written_leaves_nothing(suffix: str, tmp_path: Path) -> None:
    folder = tmp_path / f"folder.{suffix}"
    folder.mkdir()
    with pytest.raises(IsADirectoryError, match="write the path of a file"):
        save(draw(fabricated(1)), folder)
    assert [path.name for path in tmp_path.rglob("*")] == [folder.name]


def test_curves_differ_in_grey() -> None:
    """By their dashes; the two that have none, by how dark they are."""

    def darkness(color: str) -> float:
        from matplotlib.colors import to_rgb

        return float(np.dot(to_rgb(color), (0.299, 0.587, 0.114)))

    looks = [(str(dashes), round(darkness(color) / 0.3)) for dashes, color in panels.CURVES]
    assert len(set(looks)) == len(looks)
    assert all(darkness(color) < 0.55 for _, color in panels.CURVES)


def test_a_thinned_polyline_keeps_its_corners() -> None:
    points = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 5.0), (2.0, 5.0), (3.0, 5.0), (4.0, 0.0)])
    assert thin_polyline(points, 5).tolist() == points[[0, 1, 2, 4, 5]].tolist()
    assert thin_polyline(points[:1], 5).tolist() == points[:1].tolist()


def test_names_hang_where_a_curve_is_alone() -> None:
    one, other = np.array([(k, max(0.0, k - 3.0)) for k in range(9)]), np.array([(k, 0.0) for k in range(9)])
    assert isolated_vertices(one, [other], 0.5)[:, 0].tolist() == [4, 5, 6, 7, 8]
    assert len(isolated_vertices(one, [one], 0.5)) == 9
    assert len(isolated_vertices(one, [], 0.5)) == 9


def test_history_of_a_load_needs_no_scene() -> None:
    figure = stack_panels([PlotPanel("load", (History(Probe("a", "load", 1, fmpq(0)), (RAMP,)),))], 1.0, ["title"])
    assert [text.get_text() for text in figure.axes[0].texts] == ["a"]
    assert History(Probe("a", "load", 1, fmpq(0)), (RAMP,)).formal == inf


def test_the_last_time_is_written_within_the_figure_and_values_beside_the_title() -> None:
    """With the user's settings, too: those of pictures are not theirs as a figure is saved."""
    long = History(Probe("a", "load", 1, fmpq(0)), (np.array([[0.0, 0.0], [20.0, 0.0169]]),))
    figure = stack_panels([PlotPanel("load\nin m", (long,))], 20.0, [])
    figure.canvas.draw()
    (axes,) = figure.axes
    last = axes.get_xticklabels()[-1]
    assert last.get_text() == "20.0"
    assert last.get_window_extent().x1 <= figure.bbox.x1
    title = axes.yaxis.label.get_window_extent()
    assert not any(title.overlaps(number.get_window_extent()) for number in axes.get_yticklabels())


def test_slips_and_yields_are_shaded_and_named() -> None:
    """Friction R stops v after m v / R; a spring yields once its push K v t is its limit, R/(K v)."""
    rubs = {"mass": 1, "velocity": 1, "friction": "1/2", "name": "a"}
    driven = [{"motion": "velocity", "name": "driver"}, {"spring": 2, "yield": 1}, {"mass": 1, "friction": 9}]
    moved = [{"at": "driver", "times": [0, 2], "steps": [1, -1]}]
    for parts, load, title, shaded in (
        ([rubs], [], "purple: while friction at 0 slides", [(0.0, 2.0)]),
        (driven, moved, "purple: while the spring at 0 yields", [(0.5, 2.0)]),
        ([rubs | {"friction": 0, "dashpot": 1}], [], None, []),
    ):
        output = {"until": 3, "displacement": ["a" if len(parts) == 1 else "driver"]}
        model = lower(Scene(name="slides", system={"type": "chain", "parts": parts}, load=load, output=output))
        figure = draw(histories(model))
        assert [text.get_text() for text in figure.texts][1:2] == ([title] if title else [])
        for axes in figure.axes:
            spans = [patch.get_extents().transformed(axes.transData.inverted()) for patch in axes.patches]
            assert [(span.x0, span.x1) for span in spans] == [pytest.approx(each) for each in shaded]


def test_a_name_over_another_is_seen(figure: Figure) -> None:
    first = next(text for text in figure.axes[0].texts if text.get_text())
    figure.axes[0].text(*first.get_position(), "over it", ha="center", va="center")
    assert not texts_keep_clear(figure)


def swinging(count: int, outputs: int) -> Histories:
    """Sines of so many periods, of which one is larger than the others."""
    tau = np.linspace(0.0, 7.0, 40 * count + 1)
    made = [
        History(
            Probe(f"drift@{k}", "drift", 1, fmpq(k), unit="mm"),
            (np.column_stack([tau, (1 + (k == 1)) * np.sin(2 * np.pi * count / 7 * tau)]),),
        )
        for k in range(outputs)
    ]
    return Histories(lower(THIRDS), tuple(made), (), dense=True)


@pytest.mark.slow
def test_many_curves_that_turn_often_have_strips_on_one_axis() -> None:
    made = swinging(50, 30)
    strips = panels.panels(made)
    assert [strip.histories[0].name for strip in strips] == [f"drift@{k}" for k in range(24)]
    assert "drift: the first 24 of 30 outputs that move are drawn" in notes(made)
    assert {strip.limits for strip in strips} == {(-2.0, 2.0)}
    assert strips[1].summary == "drift@1: 2 mm at 0.035, -2 mm at 0.105"
    figure = draw(made)
    assert len({axes.get_ylim() for axes in figure.axes}) == 1
    assert texts_keep_clear(figure)


def test_few_turns_and_ripples_need_no_strips() -> None:
    assert len(panels.panels(swinging(10, 8))) == 1
    slow = swinging(10, 8).outputs[0].points
    rippled = History(Probe("a", "drift", 1, fmpq(0)), (slow + (0, 1) * np.sin(300 * slow[:, :1]) / 60,))
    assert not panels.restless(rippled)
    assert panels.restless(swinging(50, 1).outputs[0])


def test_pictures_speak_the_units_of_a_scene(tmp_path: Path) -> None:
    clock = Clock(fmpq(1, 250), fmpq(4), "ms")
    model = replace(lower(THIRDS), clock=clock)
    outputs = [replace(history, output=replace(history.output, unit="mm")) for history in swinging(3, 2).outputs]
    figure = draw(Histories(model, tuple(outputs), (), dense=True))
    (axes,) = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("t in ms", "drift\nin mm")
    assert max(line.get_xdata()[-1] for line in axes.lines if len(line.get_xdata()) > 20) == 28
    assert any(text.get_text() == "2 mm at 2.333 ms" for text in axes.texts)


@pytest.mark.parametrize(("horizon", "kind"), [(7, "march"), pytest.param(3000, "march", marks=pytest.mark.slow)])
def test_a_picture_takes_what_is_made_quickly(horizon: int, kind: str) -> None:
    """Of what nothing serves to 1e-6 it shows what 1e-4 does: that much no eye sees."""
    made = made_of.drawable(lower(Scene.from_toml("drive_m1").with_({"output.until": horizon})))
    assert made.evaluator == kind
    assert made.error_bound < 1e-4


@pytest.mark.parametrize(
    ("largest", "beside", "power"),
    [
        (15_000.0, {"15\u202f000", "\u22125000"}, ""),
        (0.004, {"0.002", "\u22120.002"}, ""),
        (2e-5, {"20", "\u221210"}, "\u00d710\u207b\u2076"),
        (3e6, {"2", "\u22121"}, "\u00d710\u2076"),
    ],
)
def test_numbers_beside_axes_are_those_that_people_write(largest: float, beside: set[str], power: str) -> None:
    """1e4 stood above 0.25 to 1.00, which were thousands of kN."""
    probe = Probe("force@0", "force", 1, fmpq(0), unit="kN")
    curve = History(probe, (np.array([[0.0, 0.0], [1.0, largest], [2.0, -largest / 2]]),))
    stack = [PlotPanel("force\nin kN", (curve,)), PlotPanel("load", (), height=1.2)]
    drawn = stack_panels(stack, 2.0, ["a title"])
    drawn.canvas.draw()
    axes = drawn.axes[0]
    assert beside <= {each.get_text() for each in axes.get_yticklabels()}
    assert axes.yaxis.get_offset_text().get_text() == power
    title = axes.yaxis.label.get_window_extent()
    assert title.x0 >= 0
    assert not any(title.overlaps(each.get_window_extent()) for each in axes.get_yticklabels())
    assert len({each.get_position().x0 for each in drawn.axes}) == 1
