"""The verdicts on the published formulas: complete, consistent, and able to come out otherwise."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace

import pytest

from wavesym.cli import main
from wavesym.papers import report
from wavesym.papers.pielorz1979 import claims as published_all
from wavesym.papers.pielorz1979 import table_2_collision, table_3_drive, table_4_building
from wavesym.papers.pielorz1979.building_alone import NotGivenError, compared, consequence, corrected
from wavesym.papers.pielorz1979.building_lines import CORRECTIONS, PRINTED
from wavesym.papers.pielorz1979.building_list import claims as line_claims
from wavesym.papers.record import Case, Claim, Slip, judge


@pytest.fixture(scope="session")
def records():
    return published_all.records()


@pytest.fixture(scope="session")
def by_id(records):
    return {record.id: record for record in records}


def test_everything_could_be_tested(records):
    assert not [(record.id, record.problems) for record in records if record.problems]
    assert all(record.cases > 0 for record in records)
    assert "untested" not in {record.verdict for record in records}


def test_ids_are_unique(records):
    assert max(Counter(record.id for record in records).values()) == 1


def test_nothing_is_left_out(by_id):
    equations = ("2.1", "2.2", "2.3", "2.5", "3.1", "3.2", "4.1", "4.2", "4.9", "4.10", "4.12")
    lines = {"2.4": 5, "4.3": 6, "4.4": 4, "4.5": 4, "4.6": 9, "4.7": 4, "4.8": 5, "4.11": 2}
    expected = {f"({number})" for number in equations}
    expected |= {f"({number}).{line}" for number, count in lines.items() for line in range(1, count + 1)}
    expected |= {f"III.{line}" for line in range(1, 23)}
    expected |= {
        f"T1.{example}.{cell}" for example in ("I", "II", "III") for cell in ("U", "c_f^2", "x_0", "tau_0", "v", "S")
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
    assert expected <= by_id.keys()
    rest = sorted(by_id.keys() - expected)
    constants = ["(4.11).r_0", "(4.11).r_1", "(4.3).kappa", "(4.4).A", "(4.4).kappa", "(4.5).kappa"]
    assert [id for id in rest if not id.startswith("text.")] == constants
    texts = [id for id in rest if id.startswith("text.")]
    assert set(texts) == {f"text.{number}" for number in range(1, len(texts) + 1)}


def test_every_fault_turns_what_it_is_put_into(records):
    """The readings that hold, as printed or as corrected: each fault makes a case fail."""
    assert all(record.mutations and all(record.mutations.values()) for record in records)


def test_what_is_wrong_shows_where_and_what_is_right(records):
    for record in records:
        wrong = record.verdict != "holds"
        assert (record.counterexample is not None) == wrong, record.id
        assert (record.corrected is not None) == wrong, record.id
        assert not wrong or not record.counterexample.agrees, record.id
        if record.difference is not None:
            assert record.difference == "0" or wrong, record.id


@pytest.mark.parametrize(
    ("id", "verdict"),
    [
        ("(4.8).5", "misprint"),
        ("(4.12)", "misprint"),
        ("(4.11).1", "misprint"),
        ("(4.5).1", "model"),
        ("(4.4).1", "unreadable"),
        ("(2.4).5", "convention"),
        ("T3.even.g.alpha1.K_1", "misprint"),
        ("T3.even.f.alpha1.s_1", "unreadable"),
        ("T4.m3.g_i.K_1", "convention"),
        ("III.14", "misprint"),
        ("III.21", "holds"),
        ("text.8", "unreadable"),
    ],
)
def test_known_verdicts(by_id, id, verdict):
    assert by_id[id].verdict == verdict


def test_the_difference_of_a_wrong_delay_equation(by_id):
    assert "f'_{i}" in by_id["(4.8).5"].difference
    assert by_id["(4.8).4"].difference == "0"


def test_the_lines_that_are_corrected(by_id):
    wrong = {
        int(id.split(".")[1]) for id, record in by_id.items() if id.startswith("III.") and record.verdict != "holds"
    }
    assert wrong == CORRECTIONS.keys()


@pytest.mark.parametrize("m", [3, 4, 5])
def test_the_corrected_list_from_nothing(m):
    values = [(name, value, true) for name, value, true in compared(corrected(), m, 6)]
    assert len(values) > 400
    assert not [name for name, value, true in values if value != true]


@pytest.mark.slow
@pytest.mark.parametrize("m", [3, 4, 5, 6, 7])
def test_the_corrected_list_further(m):
    assert all(value == true for _, value, true in compared(corrected(), m, 8))


def test_the_printed_list_from_nothing_does_not_run():
    with pytest.raises(NotGivenError, match="rests on itself"):
        list(compared(PRINTED, 3, 2))


def test_which_corrections_are_necessary():
    harmless = {number for number in CORRECTIONS if "without it too" in consequence(number)}
    assert harmless == {13}  # H lets in coefficients that are 0


def test_a_fault_in_a_line_is_seen():
    """Not only counted as seen: a line with a wrong sign loses its verdict."""
    claim = next(claim for claim in line_claims() if claim.id == "III.21")
    assert judge(claim).verdict == "holds"
    for wrong in claim.mutations.values():
        assert judge(replace(claim, reading=wrong)).verdict == "untested"


@pytest.mark.parametrize("table", [table_4_building, table_2_collision, table_3_drive], ids=["T4", "T2", "T3"])
def test_a_wrong_cell_is_seen(table):
    claims = [claim for claim in table.claims() if claim.slip is None]
    for claim in (claims[0], claims[-1]):
        assert judge(claim).verdict == "holds"
        assert judge(replace(claim, reading=next(iter(claim.mutations.values())))).verdict == "untested"


def _claim(cases, **changes):
    return replace(Claim("x", "here", "1 + 1", "", "", cases, 2, {"one more": 3}), **changes)


def _sum(value):
    yield Case({"n": 1}, value, 2)


def test_a_claim_that_nothing_could_turn_is_untested():
    assert judge(_claim(_sum)).verdict == "holds"
    assert judge(_claim(_sum, mutations={})).verdict == "untested"
    assert judge(_claim(_sum, mutations={"the same": 2})).verdict == "untested"
    assert judge(_claim(lambda value: iter(()))).verdict == "untested"
    assert judge(_claim(lambda value: iter([Case({}, value, value, telling=False)]))).verdict == "untested"


def test_a_wrong_claim_needs_a_correction_that_holds():
    right = Slip("misprint", "2", 2, "")
    assert judge(_claim(_sum, reading=5)).verdict == "untested"
    assert judge(_claim(_sum, reading=5, slip=right)).verdict == "misprint"
    assert judge(_claim(_sum, reading=5, slip=replace(right, reading=7))).verdict == "untested"
    assert judge(_claim(_sum, slip=right)).verdict == "untested"  # nothing was wrong


def test_formats_agree(records):
    text, tested = report.published("text")
    assert tested
    made = json.loads(report.published("json")[0])
    markdown = report.published("markdown")[0]
    assert [entry["id"] for entry in made] == [record.id for record in records]
    assert {"id", "where", "printed", "scan", "verdict", "corrected", "evidence", "cases"} <= made[0].keys()
    counts = Counter(record.verdict for record in records)
    for verdict, count in counts.items():
        assert f"{count:4} {verdict}:" in text
        assert f"| {verdict} | {count} |" in markdown
    for entry in made:
        if entry["verdict"] != "holds":
            assert f"### {entry['id']}: {entry['verdict']}" in markdown
    assert "fails" not in text.splitlines()[-1]


def test_what_the_scan_has_otherwise_stands_beside(records):
    """For these the transcription is not the scan's, but for words, spaces and line breaks."""
    scanned = {record.id: record.scan for record in records if record.scan is not None}
    assert scanned.keys() >= {"T1.I.x_0", "T1.I.tau_0", "T1.I.v", "(4.12)", "III.14", "text.5", "text.6", "text.12"}
    text, made, markdown = (report.published(name)[0] for name in ("text", "json", "markdown"))
    assert {entry["id"]: entry["scan"] for entry in json.loads(made) if entry["scan"] is not None} == scanned
    for record in records:
        assert record.scan != record.printed
        if record.scan is not None:
            assert f"scan       {record.scan}" in text
            assert f"scan: `{record.scan}`" in markdown
    assert text.count("    scan       ") == markdown.count("scan: `") == len(scanned)


def test_a_reading_of_the_scan_is_kept():
    assert judge(_claim(_sum)).scan is None
    assert judge(_claim(_sum, scan="l + 1")).scan == "l + 1"


def test_an_untested_formula_fails_the_run(monkeypatch, records, capsys):
    spoilt = (replace(records[0], problems=("no case tells anything",)), *records[1:])
    monkeypatch.setattr(report, "records", lambda *_: spoilt)
    assert main(["verify", "--published", "--format", "json"]) == 1
    capsys.readouterr()


@pytest.mark.parametrize(
    "arguments", [["--published", "drive_m1"], ["--format", "json"], ["--published", "--format", "xml"]]
)
def test_wrong_requests(arguments, capsys):
    assert main(["verify", *arguments]) == 2
    assert "verify" in capsys.readouterr().err
