"""The errata on the site: what changes results first, everything of generated/errata.md, and formulas set."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

from tests.test_documents import ROOT

pytest.importorskip("latex2mathml")

from tools.errata import HOLDS, MISTAKES, Mistake, errata_page, mistakes, symbols
from tools.formulas import is_formula, mathml, typeset

ERRATA = (ROOT / "generated" / "errata.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def found() -> list[Mistake]:
    return mistakes(ERRATA.partition(MISTAKES)[2].partition(HOLDS)[0])


@pytest.fixture(scope="module")
def page() -> str:
    return errata_page(ERRATA)


def test_every_record_that_does_not_hold_is_on_the_page(found: list[Mistake], page: str) -> None:
    records = re.findall(r"^\*\*(.+)\*\*$", ERRATA, re.MULTILINE)
    assert [id for each in found for id, _ in each.records] == records
    counts = dict(re.findall(r"^\| (\w+) \| (\d+) \| [a-z]", ERRATA, re.MULTILINE))
    for verdict in {each.verdict for each in found}:
        assert sum(len(each.records) for each in found if each.verdict == verdict) == int(counts[verdict])
    assert page.count("<article") == page.count("</article>") == len(found)


def test_what_changes_results_comes_first(found: list[Mistake], page: str) -> None:
    first = {each.records[0][0] for each in found if each.changes_results}
    assert {"(2.1)", "(4.8).5", "(4.12)", "III.5", "III.22"} <= first
    assert not {"(2.3)", "summary.en.4", "text.29"} & first, "a range, sentences"
    before, _, after = page.partition("## What else")
    assert all((f'id="{each.records[0][0]}"' in before) is each.changes_results for each in found)
    assert 'data-verdict="unreadable"' in after


def test_titles_say_what_is_wrong(found: list[Mistake]) -> None:
    titles = {each.records[0][0]: each.title for each in found}
    assert titles["(2.1)"] == "The square is missing"
    assert titles["(4.11).1"] == "Index: kappa_1 for kappa_i"
    assert all(len(title) > 7 for title in titles.values())
    said = {"where": "section 4, (4.9), line 3", "note": "As text.5."}
    assert Mistake("convention", (("text.6", said),)).title == "section 4, (4.9)"


def test_formulas_are_mathml(page: str) -> None:
    for math in re.findall(r"<math.*?</math>", page):
        ElementTree.fromstring(math)
    wrong = page.partition("## How it was read")[0]
    assert "\\frac" not in re.sub(r"<details>.*?</details>", "", wrong, flags=re.DOTALL)
    assert "<mfrac>" in mathml(r"\frac{1}{2}")
    assert typeset("so $a < b$, at 5 $ or 6 $").count("<math") == 1
    assert typeset("```sh\necho $a$\n```\n") == "```sh\necho $a$\n```\n"
    assert 'display="block"' in typeset("$$\na = b\n$$")
    assert is_formula(r"(i-1)l < x < il")
    assert not is_formula("title and author")
    assert symbols("c_f^2 < kappa_1") == "<i>c</i><sub>f</sub><sup>2</sup> &lt; <i>\u03ba</i><sub>1</sub>"
