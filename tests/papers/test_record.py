"""How a verdict comes about: nothing holds that no fault turns; nothing is wrong without a case and a correction."""

from __future__ import annotations

import pytest

from wavesym.papers.entries import Entry, Slip
from wavesym.papers.evaluation import MeaninglessError, Scope, sides, span
from wavesym.papers.record import Case, Nothing, Test, case, judge
from wavesym.papers.sentences import Pattern, sentence_reader


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
ENTRY = Entry(id="x", kind="test", printed="a = n + 1", ranges=(r"n = 0, 1, \dots, 2",))


def _judged(**changes):
    entry = ENTRY.model_copy(update={"equivalent": EQUIVALENT, **changes})
    return judge(entry, TEST)


EQUIVALENT = (("2 a for a in a", "the left side only names"),)


def test_what_holds_survives_no_fault():
    record = _judged()
    assert record.verdict == "holds"
    assert record.cases == 8
    assert record.mutations.tried == record.mutations.turned + 1
    assert record.mutations.survived == EQUIVALENT


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
    slip = Slip(verdict="misprint", corrected="a = n + 1", note="")
    assert _judged(printed="a = n + 2", slip=slip).verdict == "misprint"
    assert _judged(printed="a = n +", slip=slip).verdict == "misprint"
    assert _judged(printed="a = n + 2", slip=slip).counterexample == Case({"n": 0}, 2, 1)
    assert _judged(printed="a = n + 2", slip=slip.model_copy(update={"corrected": "a = n + 3"})).verdict == "untested"
    assert "no case shows it" in _judged(slip=slip).problems[0]
    shorter = slip.model_copy(update={"ranges": ENTRY.ranges})
    assert _judged(ranges=(r"n = 0, 1, \dots, 3",), slip=shorter).verdict == "misprint"


def test_a_transcription_that_does_not_fit_is_untested():
    entry = ENTRY.model_copy(update={"equivalent": EQUIVALENT})
    assert judge(entry, TEST, ["is not the scan"]).verdict == "untested"


def test_no_meaning_is_no_value():
    def printed():
        raise MeaninglessError("no rod 5")

    found = case({"i": 5}, printed, 0)
    assert found.printed == Nothing("no rod 5")
    assert not found.agrees
    assert str(found) == "With i = 5, what is printed has no value (no rod 5); it should be 0"


RISES = Pattern(
    "rises",
    "the {quantity} {turn}{where}",
    {"quantity": ("strain", "velocity"), "turn": ("rises", "falls"), "where": ("", ", at x = 1")},
)


def test_sentences_are_read_by_their_words():
    reader = sentence_reader([RISES])
    read = reader.read("the strain rises, at x = 1", ())
    assert read.formula.words == {"quantity": "strain", "turn": "rises", "where": ", at x = 1"}
    assert [change for change, _ in reader.faults(read)] == [
        "velocity for strain",
        "falls for rises",
        "nothing for , at x = 1",
    ]
    test = Test("what rises", lambda read: [Case({}, read.formula.words["turn"], "rises")], reader.read, reader.faults)
    said = Entry(id="text.1", kind="sentence", printed="the strain rises")
    excused = (("velocity for strain", "both rise"), (", at x = 1 for nothing", "everywhere"))
    assert judge(said.model_copy(update={"equivalent": excused}), test).verdict == "holds"
    assert judge(said, test).verdict == "untested"
    assert judge(said.model_copy(update={"printed": "the strain falls"}), test).verdict == "untested"
    assert judge(said.model_copy(update={"printed": "the strain goes"}), test).verdict == "untested"
