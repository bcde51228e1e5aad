"""The binding of what is printed to the source: a changed transcription no longer fits."""

from __future__ import annotations

import pytest

from wavesym.papers.entries import WHOLE, Aside, Paper, PaperEntry, Passage, digest, edited, plain, problems

TEXT = r"$$(1.1) \quad a_i + \\ + b = 0 \quad \text{dla} \quad i=1, 2, \dots, m$$"
ENTRY = PaperEntry(
    id="(1.1)",
    kind="test",
    scan=r"a_i + \\ + b = 0 \quad \text{dla} \quad i=1, 2, \dots, m",
    printed="a_i + b = 0",
    ranges=(r"i = 1, 2, \dots, m",),
    edits=(("+ +", "+", "the sign stands twice where the line breaks"),),
)
HASHES = {"3": digest(TEXT), "5": digest("and so on"), "(1.1):edits": digest(edited(ENTRY))}
LATER = Passage(lines=(5, 5), why="announces")


def _paper(entry=ENTRY, text=TEXT, hashes=HASHES, later=LATER, **passage):
    return Paper((Passage(lines=(3, 3), text=text, record=(entry,), **passage), later), hashes)


def _changed(**changes):
    return ENTRY.model_copy(update=changes)


def test_what_fits():
    assert not list(problems(_paper()))


@pytest.mark.parametrize(
    "entry",
    [
        _changed(printed="a_i - b = 0"),
        _changed(printed="a_j + b = 0"),
        _changed(ranges=(r"i = 1, 2, \dots, m-1",)),
        _changed(edits=()),
        _changed(edits=(*ENTRY.edits, ("c", "d", "nothing"))),
        _changed(edits=(("+ +", "-", "the sign stands twice"),), printed="a_i - b = 0"),
        _changed(scan="a_i - b = 0"),
    ],
)
def test_a_string_that_is_changed_does_not(entry):
    assert "(1.1)" in {id for id, _ in problems(_paper(entry))}


def test_a_changed_line_is_seen():
    wrong = TEXT.replace("b", "c")
    entry = _changed(scan=ENTRY.scan.replace("b", "c"), printed="a_i + c = 0")
    assert list(problems(_paper(entry, wrong))) == [("(1.1)", "lines 3-3: line 3 is not the source's")]


def test_a_changed_translation_is_seen():
    words = "a_i rośnie"
    said = PaperEntry(id="text.1", kind="sentence", scan=words, printed=words, english="a rises")
    hashes = {"3": digest("a_i rośnie"), "text.1": digest("a rises"), "5": HASHES["5"]}
    assert not list(problems(_paper(said, "a_i rośnie", hashes)))
    for change in ({"english": "a falls"}, {"printed": "a_i maleje"}, {"edits": (("a_i", "a_j", "an index"),)}):
        changed = said.model_copy(update=change)
        assert "text.1" in [id for id, _ in problems(_paper(changed, "a_i rośnie", hashes))]


def test_nothing_is_left_out():
    longer = TEXT + r" oraz $c = 1$"
    hashes = {**HASHES, "3": digest(longer)}
    assert "neither judged nor set aside" in dict(problems(_paper(text=longer, hashes=hashes)))["(1.1)"]
    aside = (Aside(scan="$c = 1$", why="a definition"),)
    assert not list(problems(_paper(text=longer, hashes=hashes, aside=aside)))
    assert dict(problems(_paper(hashes={**HASHES, "7": digest("more")})))[WHOLE] == "lines in no passage: [7]"
    assert dict(problems(_paper(later=Passage(lines=(3, 5), why="announces"))))[WHOLE] == "lines in two passages: [3]"
    assert dict(problems(_paper(later=Passage(lines=(5, 5)))))[WHOLE] == "lines 5-5: neither judged nor set aside"


def test_layout_is_no_difference():
    assert plain(r"\left( a & = \left\{ b \right. \right) c \quad \text{dla} d,") == plain(r"(a = \{ b ) c, d")
    assert plain("a + b") != plain("a - b")
    assert plain(r"a \times b") != plain("a b")
