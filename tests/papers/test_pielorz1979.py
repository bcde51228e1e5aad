"""The paper as a whole: all of it judged, bound to its source, and nothing that a falsified string would not change."""

from __future__ import annotations

import random
import re
from collections import Counter
from itertools import islice
from pathlib import Path

import pytest

from tests.papers.falsified import changed_passage
from tests.support.tex import TexError, read_tex
from wavesym.papers.entries import WHOLE, Paper, problems
from wavesym.papers.pages.document import Findings
from wavesym.papers.pages.formats import FORMATS, markdown
from wavesym.papers.pielorz1979.paper import ADAPTERS, records
from wavesym.papers.pielorz1979.transcript import paper
from wavesym.papers.record import Reading, judge
from wavesym.papers.tree import latex

KEPT = Path(__file__).parents[2] / "generated"
SOURCE = Path(__file__).parents[3] / "shared/paper/000_9aa1e815c6a1b1ab.txt"
KNOWN = [
    ("(4.8).5", "misprint"),
    ("(4.12)", "misprint"),
    ("(4.10).H", "misprint"),
    ("(4.11).1", "misprint"),
    ("(4.5).1", "model"),
    ("(4.4).1", "unreadable"),
    ("(2.4).5", "convention"),
    ("(4.4).4", "holds"),
    ("(4.6).m", "incomplete"),
    ("T3.even.g.alpha1.K_1", "misprint"),
    ("T3.even.f.alpha1.s_1", "unreadable"),
    ("T4.m3.g_i.K_1", "convention"),
    ("III.14", "misprint"),
    ("III.21", "holds"),
    ("text.8", "misprint"),
    ("(4.12).F", "misprint"),
    ("T1.II.S", "convention"),
    ("text.22", "depends"),
    *((id, "misprint") for id in ("(2.1)", "(2.3)", "(4.7).2", "(4.9).z", "text.29")),
    *((id, "convention") for id in ("(2.4).2", "(4.5).2", "def.f", "text.5", "text.9.powers")),
    *((id, "incomplete") for id in ("(4.6).contacts", "def.v", "text.T2", "text.T4", "text.9")),
    *((id, "unreadable") for id in ("(4.3).kappa", "(4.4).A", "(4.5).kappa", "T1.I.v")),
    *((id, "holds") for id in ("(2.2)", "(4.3).5", "(4.4).kappa", "(4.6).3", "(4.8).2", "III.9", "text.16")),
    ("text.24", "depends"),
]
EACH_VERDICT = 18
"""So many of them, the first, have every verdict."""


@pytest.fixture(scope="session")
def judged(thorough):
    """All; without --run-slow one of each verdict, one of thirty others, and those of which the difference is known."""
    if thorough:
        return records()
    named = {"T2.g_1.j_2", "(4.5).2", "(4.7).2", "(4.8).2", "(4.8).5", *(id for id, _ in KNOWN[:EACH_VERDICT])}
    return records([e for k, e in enumerate(paper().entries.values()) if e.id in named or k % 30 == 0])


@pytest.fixture(scope="session")
def by_id(judged):
    return {record.id: record for record in judged}


def test_everything_could_be_tested(judged):
    assert not [(record.id, record.problems) for record in judged if record.problems]
    assert all(record.cases > 0 and record.mutations.count > 0 for record in judged)
    assert "untested" not in {record.verdict for record in judged}


@pytest.mark.slow
def test_the_errata_are_what_is_found_now(judged):
    findings = Findings(paper(), judged, True)
    assert (KEPT / "errata.md").read_bytes().decode() == markdown(findings), "make generated"


def test_a_fragment_of_the_errata_is_read_by_tex_as_it_is_meant(judged):
    fragment = FORMATS["fragment"](Findings(paper(), judged, True, reproduce=True))
    read_tex(fragment)
    with pytest.raises(TexError, match="_ in text"):  # it is read to its end
        read_tex(f"{fragment} a_1")
    with pytest.raises(TexError, match="no ASCII"):
        read_tex(fragment.replace("(4.8)", "(4\u20138)", 1))


def test_ids_are_unique():
    entries = (entry for passage in paper().passages for entry in passage.entries)
    assert max(Counter(entry.id for entry in entries).values()) == 1


def test_nothing_is_left_out():
    equations = ("2.1", "2.2", "2.3", "2.5", "3.1", "3.2", "4.1", "4.2", "4.9", "4.10", "4.12")
    lines = {"2.4": 5, "4.3": 6, "4.4": 4, "4.5": 4, "4.6": 9, "4.7": 4, "4.8": 5, "4.11": 2}
    expected = {f"({number})" for number in equations}
    expected |= {f"({number}).{line}" for number, count in lines.items() for line in range(1, count + 1)}
    expected |= {f"III.{line}" for line in range(1, 23)}
    expected |= {
        f"T1.{example}.{cell}" for example in ("I", "II", "III") for cell in ("c_f^2", "x_0", "tau_0", "v", "S")
    }
    columns = ("K_1", "j_0,1", "j_1", "K_j,1", "j_0,2", "j_2", "K_j,2", "K_m-1")
    expected |= {f"T2.{row}.{column}" for row in ("g_1", "g_i", "g_m-2", "f_i", "f_m") for column in columns}
    for half in ("even", "odd"):
        expected |= {f"T3.{half}.{head}" for head in "dw"}
        for alpha in (1, 2):
            rows = (f"s_{alpha}", f"R_{alpha}", "s", "L_1", "L_2", "L_3", "K_1", "K_2", "K_3")
            expected |= {f"T3.{half}.{letter}.alpha{alpha}.{row}" for letter in "fg" for row in rows}
    expected |= {f"T4.m3.{row}.{column}" for row in ("f_1", "f_i", "g_i", "g_m") for column in ("K_1", "K_m")}
    expected |= {f"T4.m2.{row}.{column}" for row in ("f_1", "f_2", "g_2") for column in ("K_1", "K_2")}
    assert expected <= paper().entries.keys()


def test_every_line_of_the_source_is_judged_or_set_aside_with_a_reason():
    assert not list(problems(paper()))
    for passage in paper().passages:
        assert passage.entries or passage.why
        assert all(aside.why for aside in passage.asides)


@pytest.mark.skipif(not SOURCE.exists(), reason="the paper's text is not here")
def test_every_line_of_the_source_is_in_a_passage():
    lines = SOURCE.read_text(encoding="utf-8").split("\n")
    known = {number for passage in paper().passages for number in range(passage.lines[0], passage.lines[1] + 1)}
    assert {number for number, line in enumerate(lines, 1) if line.strip()} <= known


@pytest.mark.skipif(not SOURCE.exists(), reason="the paper's text is not here")
def test_every_scan_stands_in_the_source():
    lines = SOURCE.read_text(encoding="utf-8").split("\n")
    for passage in paper().passages:
        source = "\n".join(lines[passage.lines[0] - 1 : passage.lines[1]])
        assert not passage.text or passage.text == source
        assert all(entry.scan in source for entry in passage.entries)
        assert all(aside.scan in source for aside in passage.asides)


def test_what_is_printed_is_the_scan_but_for_layout_and_edits():
    """Without both, and in other words than the code that selects it has: nothing but letters, digits and signs."""

    def bare(text):
        text = re.sub(
            r"\\(begin|end)\{(aligned|cases)\}|\\left\.?|\\right\.?|\\quad|\\text|\bdla\b|[\s$&{},.;]|\\\\", "", text
        )
        return text.replace("\\", "")

    for passage in paper().passages:
        for entry in passage.entries:
            printed = bare(entry.printed + "".join(() if entry.heads or entry.english else entry.ranges))
            if not entry.edits and not entry.id.startswith("text.13.K"):  # whose range stands before the formula
                assert bare(entry.scan) == printed, entry.id
            assert all(why for _, _, why in entry.edits)
            assert "\n" not in entry.printed


def test_what_is_wrong_shows_where_and_what_is_right(judged):
    for record in judged:
        wrong = record.verdict != "holds"
        assert (record.counterexample is not None) == wrong, record.id
        assert (record.correction is not None) == wrong, record.id
        assert not wrong or not record.counterexample.agrees, record.id
        assert wrong or record.difference is None, record.id


def test_what_is_printed_less_what_is_right(by_id):
    assert by_id["(4.8).2"].difference is None
    assert "2\\kappa_{i}f'_{i}(z)" in by_id["(4.8).5"].difference
    assert r"\sum_{k=0}^{m + 1}" in by_id["(4.7).2"].difference
    assert r"-\frac{1}{\kappa_{1}}" in by_id["(4.5).2"].difference
    assert r"+ \frac{1}{\kappa_{i}}" in by_id["(4.5).2"].difference


def test_survivors_are_explained(judged):
    survivors = [(record.id, change, why) for record in judged for change, why in record.mutations.survivors]
    assert all(why for _, _, why in survivors)
    tried = sum(record.mutations.count for record in judged)
    assert len(survivors) < tried / 40


@pytest.mark.quick(EACH_VERDICT)
@pytest.mark.parametrize(("id", "verdict"), KNOWN)
def test_known_verdicts(by_id, id, verdict):
    assert by_id[id].verdict == verdict


def _judged(entry, **changes):
    changed = entry.model_copy(update=changes)
    return judge(changed, ADAPTERS[changed.kind](changed))


FORMULAS = [entry for entry in paper().entries.values() if not entry.english]
DRAWN = random.Random(7).sample(FORMULAS, 24)


@pytest.mark.parametrize("entry", DRAWN, ids=lambda entry: entry.id)
def test_another_string_is_another_verdict(entry):
    """A fault written into the string that is right, whichever it is: what was said to hold no longer does."""
    test = ADAPTERS[entry.kind](entry)
    text, ranges = entry.right_strings
    right = test.read(text, ranges)
    excused = {change for change, _ in entry.equivalent}
    faults = [wrong for change, wrong in test.faults(right) if change not in excused]
    if entry.heads:  # the ranges of a cell are those of its row and its table
        faults = [wrong for wrong in faults if wrong.ranges == right.ranges]
    wrong: Reading = random.Random(entry.id).choice(faults)
    printed = tuple(map(latex, wrong.ranges))
    if entry.slip:
        count = len(printed) - len(entry.inferred_ranges)
        slip = entry.slip.model_copy(update={"correction": latex(wrong.formula), "ranges": printed[:count]})
        record = _judged(entry, slip=slip, inferred_ranges=printed[count:])
    elif entry.heads:
        record = _judged(entry, printed=latex(wrong.formula))
    else:
        record = _judged(entry, printed=latex(wrong.formula), ranges=printed, inferred_ranges=())
    assert record.verdict == "untested", (latex(wrong.formula), printed)


MARKED = [passage for passage in paper().passages if passage.entries]


@pytest.mark.parametrize("passage", random.Random(3).sample(MARKED, 12), ids=lambda passage: str(passage.lines))
def test_another_letter_or_another_mark_is_seen(passage):
    """In whichever place: no verdict counts."""
    signs = [place for place, sign in enumerate(passage.marked) if not sign.isspace() and sign not in "⟦⟧¦"]
    place = random.Random(passage.marked).choice(signs)
    letter = passage.marked[:place] + "~" + passage.marked[place + 1 :]
    mark = re.sub(r"(\S)⟧", r"⟧\1", passage.marked, count=1)
    for marked in (letter, mark):
        changed = changed_passage(passage, marked=marked)
        passages = tuple(changed if each is passage else each for each in paper().passages)
        assert WHOLE in {id for id, _ in problems(Paper(paper().description, passages, paper().digest))}


def test_faults_are_named_apart(judged):
    for record in islice(judged, 0, None, 9):
        test = ADAPTERS[record.entry.kind](record.entry)
        names = [change for change, _ in test.faults(test.read(*record.entry.right_strings))]
        assert len(names) == len(set(names)) == record.mutations.count
