"""Figs. 6, 7 and 8 redrawn: every statement is there, with its number, where it was measured."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from tests.pictures.clear import texts_keep_clear
from wavesym.numbers.arrays import Array
from wavesym.papers.pielorz1979 import figures as section_5
from wavesym.papers.pielorz1979.figure_scenes import contact_end, figure, loads
from wavesym.papers.pielorz1979.measures import Finding
from wavesym.papers.record import Record, Sentence
from wavesym.scene import lower

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from wavesym.pictures import figures, panels
from wavesym.pictures.histories import histories
from wavesym.pictures.labels import Curve


@pytest.fixture(scope="module")
def records() -> Mapping[str, Record]:
    return {id: record for number in figures.FIGURES for id, record in figures.figure_verdicts(number).items()}


def _in_place(axes: Axes, curves: list[Curve], size: float) -> None:
    for curve in curves:
        if curve.text:
            axes.text(*curve.points[0], curve.text)


def redrawn() -> dict[int, Figure]:
    """The figures, with names written on what they name: where they are put is tested elsewhere, and takes long."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(panels, "label", _in_place)
        return {number: figures.redraw_figure(number) for number in figures.FIGURES}


@pytest.fixture(scope="module")
def drawn() -> dict[int, Figure]:
    return redrawn()


def listed(number: int) -> set[str]:
    """The numbers of the statements beside a figure."""
    return {statement.number for statement in figures.judged_figure(number).statements}


def mark_differences(figure: Figure) -> set[str]:
    """The numbers in the panels."""
    texts = {text.get_text().partition(":")[0] for axes in figure.axes for text in axes.texts}
    return {text for text in texts if text.isdigit()}


def measured(number: int, statement: Sentence) -> Finding:
    """What is measured under the load drawn."""
    return section_5.finding(figure(number), figures.best_load(number), statement)


def missing(found: Mapping[int, Figure], records: Mapping[str, Record]) -> set[str]:
    """The statements of section 5 that are not both listed and, where they have a place, marked in their figure."""
    absent = set()
    for id, record in records.items():
        number = record.entry.subject["figure"]
        said = section_5.statements(number).get(id)
        nowhere = said is not None and not measured(number, said).spots
        if id.removeprefix("text.") not in listed(number) & (
            mark_differences(found[number]) | ({id[5:]} if nowhere else set())
        ):
            absent.add(id)
    return absent


def test_every_statement_is_listed_and_marked(drawn: dict[int, Figure], records: Mapping[str, Record]) -> None:
    assert len(records) == 16
    assert missing(drawn, records) == set()


def test_a_statement_left_out_is_missed(monkeypatch: pytest.MonkeyPatch, records: Mapping[str, Record]) -> None:
    def all_but_one(number: int) -> dict[str, Sentence]:
        return {id: statement for id, statement in section_5.statements(number).items() if id != "text.27"}

    monkeypatch.setattr(figures, "statements", all_but_one)
    assert missing(redrawn(), records) == {"text.27"}


def listing(number: int) -> str:
    """What stands beside a figure, one after another."""
    statements = figures.judged_figure(number).statements
    return " ".join(" ".join((f"{each.text}: {each.verdict}", "; ".join(each.details))) for each in statements)


def test_each_statement_is_listed_with_its_verdict_and_its_numbers(records: Mapping[str, Record]) -> None:
    for number in figures.FIGURES:
        text = listing(number)
        for id, statement in section_5.statements(number).items():
            assert f"{records[id].entry.statement}: {records[id].verdict}" in text
            value = measured(number, statement).value
            assert f"{section_5.meaning(statement)}; measured: {value:.4g}" in text


def test_each_load_is_said_to_bear_a_statement_out_or_not(records: Mapping[str, Record]) -> None:
    """As the record says, which was judged apart."""
    for number in (7, 8):
        text = listing(number)
        for id, statement in section_5.statements(number).items():
            own = text.partition(records[id].entry.statement)[2].partition("false for ")
            false = own[2].partition("  ")[0]
            corrected = records[id].correction
            named = corrected.partition(section_5.ONLY)[2].split("; ") if corrected else None
            for load, found in section_5.findings(number, statement):
                said = f"{load.name} ({found.value:.4g})"
                assert said in (own[0] if named is None or load.name in named else false)


def test_the_loads_drawn_bear_most_out() -> None:
    for number in (7, 8):
        said = section_5.statements(number).values()
        true = {
            load.name: sum(section_5.is_true(figure(number), load, statement) for statement in said)
            for load in loads(number)
        }
        assert true[figures.best_load(number).name] == max(true.values())


@pytest.mark.parametrize("number", figures.FIGURES)
def test_marks_lie_on_the_curves_as_drawn(number: int) -> None:
    """The curves come from generated code, the marks from the exact motion: both sides of a jump are on the curve."""
    load = figures.best_load(number)
    made = histories(lower(figure(number).scene(load)))
    curves = {history.name: history for history in made.outputs}
    count = 0
    for statement in section_5.statements(number).values():
        found = measured(number, statement)
        for mark, spot in zip(figures.marks(number, found, "", load), found.spots, strict=True):
            for (tau, value), point in zip(mark.points, spot, strict=True):
                points = curves[point.output].points
                sides = np.interp([tau - 1e-9, tau, tau + 1e-9], *points.T)
                # a line between instants leaves the curve by less than a pixel, of which a panel has 250
                assert np.min(np.abs(sides - value)) < 1e-3 * np.max(np.abs(points[:, 1]))
                count += 1
    assert count >= 3


@pytest.mark.parametrize(
    ("id", "among"),
    [
        ("text.14", ("strain@2", "strain@1-")),
        ("text.16", ("displacement@0", "displacement@1")),
        ("text.22", ("strain@0", "strain@0.5", "strain@1")),
        ("text.23", ("displacement@0", "displacement@1")),
    ],
)
def test_a_distance_is_marked_where_it_is_largest(
    id: str, among: tuple[str, ...], records: Mapping[str, Record]
) -> None:
    """Again from the curves, by hand."""
    number = records[id].entry.subject["figure"]
    found = measured(number, section_5.statements(number)[id])
    ((low, high),) = found.spots
    curves = {name: _curve(number, name) for name in among}
    apart = abs(curves[high.output][high.instant] - curves[low.output][low.instant])
    largest = max(np.max(np.abs(curve)) for curve in curves.values())
    assert low.instant == high.instant
    assert apart / largest == found.value
    assert all(np.max(np.abs(curves[a] - curves[b])) <= apart for a in among for b in among)


def _curve(number: int, output: str) -> Array:
    return figure(number).curve(figures.best_load(number), *output.split("@"))


def test_swings_are_marked_between_turning_points() -> None:
    """The largest marked one over the smallest is what was measured."""
    found = measured(8, section_5.statements(8)["text.26"])
    ratios = []
    for (high, low), (other_high, other_low) in zip(found.spots[::2], found.spots[1::2], strict=True):
        curve = _curve(8, high.output)
        large, small = curve[high.instant] - curve[low.instant], curve[other_high.instant] - curve[other_low.instant]
        ratios.append(abs(large / small))
        for turn in (high, low, other_high, other_low):
            before, here, after = curve[turn.instant - 1 : turn.instant + 2]
            assert (here - before) * (after - here) < 0
    assert min(ratios) == found.value


def test_the_end_of_the_collision_is_marked_as_printed_and_as_computed(
    drawn: dict[int, Figure], records: Mapping[str, Record]
) -> None:
    upright = {float(line.get_xdata()[0]) for line in drawn[6].axes[0].lines if line.get_linestyle() in ("-", "--")}
    assert {8.85, float(contact_end(figure(6)))} <= upright
    assert records["text.29"].entry.printed == r"\tau \approx 8.85"


def test_the_load_is_drawn_above(drawn: dict[int, Figure]) -> None:
    """Fig. 8: a step, that is its value from the start on."""
    axes = drawn[8].axes[0]
    assert axes.get_ylabel().startswith("load (3.2)")
    lines = [np.column_stack(line.get_data()).tolist() for line in axes.lines]
    assert figures.best_load(8).name == "step"
    assert [[0, 1], [20, 1]] in lines
    assert [text.get_text() for text in drawn[7].axes[0].texts] == ["M1 = M2"]


@pytest.mark.slow
def test_published(tmp_path: Path) -> None:
    """All of them, written twice: the same bytes, and nothing covers a number or a name."""
    first, second = ([p for n in figures.FIGURES for p in figures.write_figure(tmp_path / name, n)] for name in "ab")
    assert [path.name for path in first] == [f"figure_{n}.{kind}" for n in (6, 7, 8) for kind in ("svg", "png")]
    for one, other in zip(first, second, strict=True):
        assert one.read_bytes() == other.read_bytes()
    page = figures.write_page(tmp_path / "a").read_text(encoding="utf-8")
    for number in figures.FIGURES:
        assert f'src="figure_{number}.svg"' in page
        assert all(f"<strong>{each}</strong>" in page for each in listed(number))


@pytest.mark.slow
@pytest.mark.parametrize("number", figures.FIGURES)
def test_names_and_numbers_keep_clear_of_each_other(number: int) -> None:
    figure = figures.redraw_figure(number)
    assert texts_keep_clear(figure)
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    page = figure.bbox
    assert all(text.get_window_extent(renderer).x1 <= page.x1 for text in figure.texts)
