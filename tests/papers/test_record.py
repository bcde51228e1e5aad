"""How a verdict comes about: nothing holds that no fault turns; nothing is wrong without a case and a correction."""

from __future__ import annotations

import pytest

from wavesym.papers.entries import PaperEntry, Slip
from wavesym.papers.evaluation import MeaninglessError, Scope, holds, sides, span
from wavesym.papers.reader import read_range
from wavesym.papers.record import Case, NoValue, Reading, Test, case, judge
from wavesym.papers.record import reading as read_reading
from wavesym.papers.sentences import SentencePattern, SentenceReader


def _cases(reading):
    """n + 1, said of n = 0, 1, 2."""
    (range_,) = reading.ranges
    said, _ = sides(reading.formula), None
    for n in range(-1, 4):
        scope = Scope({"n": n})
        where = n in span(range_, scope, most=2)
        yield Case({"n": n, "claim": "in the range"}, where, 0 <= n <= 2)
        if 0 <= n <= 2:
            yield case({"n": n}, lambda scope=scope: scope.value(said[1]), n + 1)


TEST = Test("what comes next", _cases)
ENTRY = PaperEntry(id="x", kind="test", printed="a = n + 1", ranges=(r"n = 0, 1, \dots, 2",))


def _judged(**changes):
    entry = ENTRY.model_copy(update={"equivalent": EQUIVALENT, **changes})
    return judge(entry, TEST)


EQUIVALENT = (("2 a for a in a", "the left side only names"),)


def test_what_holds_survives_no_fault():
    record = _judged()
    assert record.verdict == "holds"
    assert record.cases == 8
    assert record.mutations.count == record.mutations.turned_count + 1
    assert record.mutations.survivors == EQUIVALENT


def test_a_survivor_must_be_explained():
    assert _judged(equivalent=()).problems == ("not turned by a fault: 2 a for a in a",)
    more = (*EQUIVALENT, ("sign of 1 in n + 1", "wrongly excused"))
    assert "called equivalent, yet a case turns it" in _judged(equivalent=more).problems[0]
    assert "yet no such fault" in _judged(equivalent=(*EQUIVALENT, ("nothing", ""))).problems[0]


@pytest.mark.parametrize(
    "changes",
    [
        {"printed": "a = n + 2"},
        {"printed": "a = n + b"},
        {"printed": "a = n +"},
        {"printed": "n + 1"},
        {"ranges": (r"n = 1, 2, \dots, 2",)},
        {"ranges": (r"n = 0, 1, \dots, 3",)},
        {"ranges": ("n = ",)},
    ],
)
def test_what_fails_without_a_correction_is_untested(changes):
    record = _judged(**changes)
    assert record.verdict == "untested"
    assert record.problems


def test_what_is_wrong_needs_a_correction_that_holds():
    slip = Slip(correction="a = n + 1", note="")
    assert _judged(printed="a = n + 2", slip=slip).verdict == "misprint"
    assert _judged(printed="a = n +", slip=slip).verdict == "unreadable"
    assert _judged(printed="a = n + 2", slip=slip).counterexample == Case({"n": 0}, 2, 1)
    assert _judged(printed="a = n + 2", slip=slip.model_copy(update={"correction": "a = n + 3"})).verdict == "untested"
    assert "no case shows it" in _judged(slip=slip).problems[0]
    shorter = slip.model_copy(update={"ranges": ENTRY.ranges})
    assert _judged(ranges=(r"n = 0, 1, \dots, 3",), slip=shorter).verdict == "misprint"


def _kinds(reading, shift=0):
    """a is n + 1 for n = 0, 1, 2, and 0 beyond."""
    for n in range(4):
        scope = Scope({"n": n})
        if all(holds(range_, scope) for range_ in reading.ranges):
            with scope.bind({"n": n + shift}):
                yield case({"n": n}, lambda scope=scope: scope.value(sides(reading.formula)[1]), n + 1 if n < 3 else 0)


UP_TO_2 = (r"n = 0, 1, \dots, 2",)
SMALL = {"correction": "a = n + 1", "ranges": UP_TO_2}
FROM_1 = {"conventions": {"n counts from 1": lambda reading: _kinds(Reading(reading.formula, _UP_TO_2), shift=1)}}
_UP_TO_2 = tuple(map(read_range, UP_TO_2))
KINDS = {
    "misprint": ({"printed": "a = n + 2"}, {}),
    "unreadable": ({"printed": "a = n + b"}, {}),
    "incomplete": ({"printed": "a = n + 1"}, {}),
    "convention": ({"printed": "a = n"}, FROM_1),
    "model": ({"printed": "a = n"}, {"mathematics": FROM_1["conventions"]["n counts from 1"]}),
    "depends": ({"printed": "a = n + 1"}, {"variation": "loads"}),
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_kind_of_a_slip_is_that_which_the_cases_show(kind):
    changes, more = KINDS[kind]
    entry = PaperEntry(id="x", kind="test", slip=Slip(note="", **SMALL), **changes)
    wrong = ("b for 1", read_reading("a = n + b", ()))
    record = judge(entry, Test("what comes next", _kinds, faults=lambda right: [wrong], **more))
    assert record.verdict == kind


def test_a_slip_of_the_ranges_alone_leaves_the_formula_as_printed():
    entry = PaperEntry(id="x", kind="test", printed="a = n + 1", slip={"ranges": UP_TO_2, "note": ""})
    assert entry.right_strings == ("a = n + 1", UP_TO_2)


@pytest.mark.parametrize(
    ("printed", "corrected", "kind"),
    [
        ("It rises.", "It rises, in summer.", "incomplete"),
        ("It rises and falls.", "It rises in summer and falls.", "incomplete"),
        ("It rises.", "It falls.", "misprint"),
        ("It rises and falls.", "It now rises and then falls.", "misprint"),
    ],
)
def test_a_sentence_that_lacks_words_is_incomplete(printed, corrected, kind):
    test = Test(
        "what rises",
        lambda read: [Case({}, read.formula == corrected, True)],
        lambda said, ranges: Reading(said),
        lambda right: [("another", Reading("It stays."))],
    )
    entry = PaperEntry(id="x", kind="test", printed="", english=printed, slip=Slip(correction=corrected, note=""))
    assert judge(entry, test).verdict == kind


def test_a_transcription_that_does_not_fit_is_untested():
    entry = ENTRY.model_copy(update={"equivalent": EQUIVALENT})
    assert judge(entry, TEST, ["is not the scan"]).verdict == "untested"


def test_no_meaning_is_no_value():
    def printed():
        raise MeaninglessError("no rod 5")

    found = case({"i": 5}, printed, 0)
    assert str(found.printed_value) == "no value (no rod 5)"
    assert found.printed_value != NoValue("no rod 5")
    assert not found.agrees
    assert str(found) == "With i = 5, what is printed has no value (no rod 5); it should be 0"


RISES = SentencePattern(
    "rises",
    "the {quantity} {turn}{where}",
    {"quantity": ("strain", "velocity"), "turn": ("rises", "falls"), "where": ("", ", at x = 1")},
)


def test_sentences_are_read_by_their_words():
    reader = SentenceReader([RISES])
    read = reader.read("the strain rises, at x = 1", ())
    assert read.formula.words == {"quantity": "strain", "turn": "rises", "where": ", at x = 1"}
    assert [change for change, _ in reader.faults(read)] == [
        "velocity for strain",
        "falls for rises",
        "nothing for , at x = 1",
    ]
    test = Test("what rises", lambda read: [Case({}, read.formula.words["turn"], "rises")], reader.read, reader.faults)
    said = PaperEntry(id="text.1", kind="sentence", printed="the strain rises")
    excused = (("velocity for strain", "both rise"), (", at x = 1 for nothing", "everywhere"))
    assert judge(said.model_copy(update={"equivalent": excused}), test).verdict == "holds"
    assert judge(said, test).verdict == "untested"
    assert judge(said.model_copy(update={"printed": "the strain falls"}), test).verdict == "untested"
    assert judge(said.model_copy(update={"printed": "the strain goes"}), test).verdict == "untested"
