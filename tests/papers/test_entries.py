"""The binding of what is printed to the source: a changed transcription no longer fits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pytest

from tests.papers.small import ABOUT
from wavesym.papers.entries import WHOLE, Paper, Passage, digest, merge_records, problems
from wavesym.papers.selection import formula_text, read_marks

TEXT = r"$$(1.1) \quad ⟦(1.1): a_i + \\ + b = 0 \quad \text{dla} \quad ¦i=1, 2, \dots, m⟧$$"
RECORD: dict[str, Any] = {"edits": (("+ +", "+", "the sign stands twice where the line breaks"),)}
LATER = Passage(lines=(5, 5), why="announces")


def _passage(text: str = TEXT, record: Mapping[str, Any] = RECORD, id: str = "(1.1)", **more: Any) -> Passage:
    return Passage(lines=(3, 3), text=text, kind="test", record={id: record}, **more)


RIGHT = _passage()


def _problems(*passages: Passage, checked: Sequence[Passage] = (RIGHT, LATER)) -> list[tuple[str, str]]:
    return list(problems(Paper(ABOUT, passages, digest(checked))))


def test_what_fits() -> None:
    assert not _problems(RIGHT, LATER)
    (entry,) = RIGHT.entries
    assert entry.scan == r"a_i + \\ + b = 0 \quad \text{dla} \quad i=1, 2, \dots, m"
    assert (entry.printed, entry.ranges) == ("a_i + b = 0", (r"i = 1, 2, \dots, m",))
    assert entry.lines == (3, 3)


@pytest.mark.parametrize("text", [TEXT.replace("b", "c"), TEXT.replace("a_i", "a_j"), TEXT.replace("¦", "")])
def test_a_changed_line_and_a_changed_mark_are_seen(text: str) -> None:
    assert WHOLE in dict(_problems(_passage(text), LATER))


@pytest.mark.parametrize("edits", [(), (*RECORD["edits"], ("c", "d", "nothing")), (("+ +", "-", "stands twice"),)])
def test_a_changed_edit_is_seen(edits: Any) -> None:
    found = _problems(_passage(record={"edits": edits}), LATER)
    assert WHOLE in dict(found)
    assert (("(1.1)", "nothing to edit: c") in found) == (len(edits) == 2)


def test_a_changed_translation_is_seen() -> None:
    record = {"english": "a rises"}
    right = _passage("⟦text.1: a_i rośnie⟧", record, "text.1")
    assert not _problems(right, LATER, checked=(right, LATER))
    for change in ({"english": "a falls"}, {"edits": (("a_i", "a_j", "an index"),)}):
        changed = _passage("⟦text.1: a_i rośnie⟧", {**record, **change}, "text.1")
        assert WHOLE in dict(_problems(changed, LATER, checked=(right, LATER)))
    assert ("text.1", "is not in the English: a_j") in _problems(changed)


def test_what_is_printed_cannot_be_said_beside_the_passage() -> None:
    with pytest.raises(TypeError, match="printed"):
        _ = _passage(record={"printed": "a_i - b = 0"}).entries


def test_nothing_is_left_out() -> None:
    longer = _passage(TEXT + r" oraz $c = 1$")
    assert "neither judged nor set aside" in dict(_problems(longer, LATER))["(1.1)"]
    aside = _passage(TEXT + r" oraz ⟦[a definition] $c = 1$⟧")
    assert not _problems(aside, LATER, checked=(aside, LATER))
    assert WHOLE in dict(_problems(RIGHT))
    twice = Passage(lines=(3, 5), why="announces")
    assert (WHOLE, "lines in two passages: [(3, 5)]") in _problems(RIGHT, twice)
    assert dict(_problems(RIGHT, Passage(lines=(5, 5))))[WHOLE] == "lines 5-5: neither judged nor set aside"
    assert ("(1.1)", "lines 3-3: there is no cell (1.2)") in _problems(
        Passage(**{**RIGHT.model_dump(), "record": {"(1.1)": RECORD, "(1.2)": {}}})
    )


@pytest.mark.parametrize(
    ("source", "edits", "text"),
    [
        (r"\left( a & = \left\{ b \right. \right) c \quad \text{dla} d,", (), r"( a = \{ b ) c d"),
        (r"\left. \frac{u}{t} \right|_{t=0}", (), r"\left. \frac{u}{t} \right|_{t=0}"),
        ("a + b", (), "a + b"),
        (r"z przedziału $\langle 0, 1 \rangle$.", (("przedziału", r"\in", ""),), r"z \in \langle 0, 1 \rangle"),
        (r"a&=\begin{cases} 1 & i \\ 0 & j \end{cases} \\", (), r"a = \begin{cases} 1 & i \\ 0 & j \end{cases}"),
    ],
)  # fmt: skip
def test_layout_is_not_read(source: str, edits: tuple[tuple[str, str, str], ...], text: str) -> None:
    assert formula_text(source, edits) == text


def test_marks_have_parts_of_a_text() -> None:
    marked = read_marks("Dla ⟦a¦: i = 1⟧ jest ⟦s: f, gdzie ⟦a b: x = i ¦j = 2⟧ ⟧, ⟦[a name] y⟧ i z")
    parts = {
        id: [marked.text[slice(*span)] for span in (*each.formulas, *each.ranges)]
        for id, each in marked.records.items()
    }
    assert parts == {"a": ["x = i ", "i = 1", "j = 2"], "s": ["f, gdzie x = i j = 2 "], "b": ["x = i ", "j = 2"]}
    assert [marked.text[slice(*span)] for span, _ in marked.asides] == ["y"]
    assert marked.rest == ["Dla ", ", ", " i z"]
    assert marked.text[slice(*marked.records["a"].span)] == "i = 1 jest f, gdzie x = i j = 2"


@pytest.mark.parametrize("text", ["⟦a: x", "x⟧", "x ¦i = 1"])
def test_marks_are_in_pairs(text: str) -> None:
    with pytest.raises(ValueError, match=r"has no end|outside of a record"):
        read_marks(text)


def test_what_several_records_share_stands_once() -> None:
    """Lists of several keys are joined, and what a slip has; anything else stands in one of them."""
    tables = {
        "T1.{I,II}.{a,b}": {"ranges": ["i = 1"], "slip": {"note": "Both."}},
        "T1.I.a": {"ranges": ["j = 2"], "slip": {"correction": "n"}},
    }
    found = merge_records(tables)
    assert list(found) == ["T1.I.a", "T1.I.b", "T1.II.a", "T1.II.b"]
    assert found["T1.I.a"] == {"ranges": ["i = 1", "j = 2"], "slip": {"note": "Both.", "correction": "n"}}
    assert found["T1.II.b"] == tables["T1.{I,II}.{a,b}"]
    with pytest.raises(ValueError, match=r"T1\.I\.a\.slip: note stands there twice"):
        merge_records({**tables, "T1.I.{a}": {"slip": {"note": "One."}}})
