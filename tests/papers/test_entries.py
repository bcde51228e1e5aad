"""The binding of what is printed to the source: a changed transcription no longer fits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from tests.papers.small import ABOUT
from wavesym.papers.entries import WHOLE, Aside, Paper, Passage, merge_records, passage_hashes, problems
from wavesym.papers.selection import plain, position

TEXT = r"$$(1.1) \quad a_i + \\ + b = 0 \quad \text{dla} \quad i=1, 2, \dots, m$$"
RECORD: dict[str, Any] = {
    "printed": "a_i + b = 0",
    "ranges": (r"i = 1, 2, \dots, m",),
    "edits": (("+ +", "+", "the sign stands twice where the line breaks"),),
}
LATER = Passage(lines=(5, 5), why="announces")


def _passage(text: str = TEXT, record: Mapping[str, Any] = RECORD, id: str = "(1.1)", **more: Any) -> Passage:
    return Passage(lines=(3, 3), text=text, kind="test", record={id: record}, **more)


RIGHT = _passage()
HASHES = {RIGHT.lines: passage_hashes(TEXT, RIGHT.entries), LATER.lines: passage_hashes("and so on")}


def _problems(*passages: Passage, hashes: Mapping[tuple[int, int], Any] = HASHES) -> list[tuple[str, str]]:
    return list(problems(Paper(ABOUT, passages, hashes)))


def test_what_fits() -> None:
    assert not _problems(RIGHT, LATER)
    (entry,) = RIGHT.entries
    assert entry.scan == r"a_i + \\ + b = 0 \quad \text{dla} \quad i=1, 2, \dots, m"
    assert entry.lines == (3, 3)


@pytest.mark.parametrize(
    "change",
    [
        {"printed": "a_i - b = 0"},
        {"printed": "a_j + b = 0"},
        {"ranges": (r"i = 1, 2, \dots, m-1",)},
        {"edits": ()},
        {"edits": (*RECORD["edits"], ("c", "d", "nothing"))},
        {"edits": (("+ +", "-", "the sign stands twice"),), "printed": "a_i - b = 0"},
    ],
)
def test_a_string_that_is_changed_does_not(change: Mapping[str, Any]) -> None:
    assert "(1.1)" in {id for id, _ in _problems(_passage(record={**RECORD, **change}), LATER)}


def test_a_changed_line_is_seen() -> None:
    wrong = _passage(TEXT.replace("b", "c"), {**RECORD, "printed": "a_i + c = 0"})
    assert _problems(wrong, LATER) == [("(1.1)", "lines 3-3: they are not the source's")]


def test_a_changed_translation_is_seen() -> None:
    record = {"printed": "a_i rośnie", "english": "a rises"}
    right = _passage("a_i rośnie", record, "text.1")
    hashes = {**HASHES, (3, 3): passage_hashes(right.text, right.entries)}
    assert not _problems(right, LATER, hashes=hashes)
    for change in ({"english": "a falls"}, {"printed": "a_i maleje"}, {"edits": (("a_i", "a_j", "an index"),)}):
        changed = _passage("a_i rośnie", {**record, **change}, "text.1")
        assert "text.1" in [id for id, _ in _problems(changed, LATER, hashes=hashes)]


def test_nothing_is_left_out() -> None:
    longer = TEXT + r" oraz $c = 1$"
    hashes = {**HASHES, (3, 3): passage_hashes(longer, RIGHT.entries)}
    assert "neither judged nor set aside" in dict(_problems(_passage(longer), LATER, hashes=hashes))["(1.1)"]
    aside = (Aside(scan="$c = 1$", why="a definition"),)
    assert not _problems(_passage(longer, aside=aside), LATER, hashes=hashes)
    missing = {**HASHES, (7, 7): passage_hashes("more")}
    assert dict(_problems(RIGHT, LATER, hashes=missing))[WHOLE] == "lines in no passage: [(7, 7)]"
    twice = Passage(lines=(3, 5), why="announces")
    assert (WHOLE, "lines in two passages: [(3, 5)]") in _problems(RIGHT, twice)
    assert dict(_problems(RIGHT, Passage(lines=(5, 5))))[WHOLE] == "lines 5-5: neither judged nor set aside"


def test_layout_is_no_difference() -> None:
    assert plain(r"\left( a & = \left\{ b \right. \right) c \quad \text{dla} d,") == plain(r"(a = \{ b ) c, d")
    assert plain("a + b") != plain("a - b")
    assert plain(r"a \times b") != plain("a b")


@pytest.mark.parametrize(
    ("source", "strings", "edits", "part"),
    [
        (r"x, a &= b, \\ c &= d", ("c = d",), (), "c &= d"),
        ("dla $a = 1$, potem", ("a = 1",), (), "$a = 1$"),
        (r"z przedziału $\langle 0, 1 \rangle$.", (r"z \in \langle 0, 1 \rangle",), (("przedziału", r"\in", ""),),
         r"z przedziału $\langle 0, 1 \rangle$"),
        ("Suma maleje. Suma rośnie.", ("Suma rośnie.",), (), "Suma rośnie."),
        (r"r = \begin{cases} 1 & i = 2 \\ 0 & i = 3 \end{cases} \\", (r"r = 1, i = 2 0, i = 3",), (),
         r"r = \begin{cases} 1 & i = 2 \\ 0 & i = 3 \end{cases}"),
        ("oraz maleją K = 1", ("K = 1",), (("maleją", "", "in words"),), "maleją K = 1"),
        ("a = b", ("a = c",), (), ""),
    ],
)  # fmt: skip
def test_a_string_selects_its_part_of_a_passage(
    source: str, strings: tuple[str, ...], edits: tuple[tuple[str, str, str], ...], part: str
) -> None:
    start, end = position(source, strings, edits) or (0, 0)
    assert source[start:end] == part


def test_what_stands_twice_is_selected_twice() -> None:
    first = position("a a", ("a",))
    assert (first, position("a a", ("a",), used=[first or (0, 0)])) == ((0, 1), (2, 3))


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
