"""`wavesym verify --published`: what may be asked, and what is answered; on a paper of six sums."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.papers.small import ENTRIES, Paper, entry
from wavesym.cli import main
from wavesym.cli.verify import FORMATS
from wavesym.papers import verdict_page
from wavesym.papers.record import Record
from wavesym.scene import Scene


@pytest.fixture(autouse=True)
def judged(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """The records that are judged, in their order."""
    found: list[str] = []

    class Watched(Paper):
        @staticmethod
        def records(*given: object) -> tuple[Record, ...]:
            made = Paper.records(*given)
            found.extend(record.id for record in made)
            return made

    monkeypatch.setattr(verdict_page, "paper", Watched)
    monkeypatch.chdir(tmp_path)
    return found


def answer(capsys: pytest.CaptureFixture[str], *arguments: str, status: int = 0) -> str:
    """What is put out; of what is refused, the line that says why."""
    assert main(["verify", *arguments]) == status
    out, aside = capsys.readouterr()
    assert not (out and aside)
    return out or aside


def test_the_formats_are_those_that_there_are() -> None:
    assert tuple(verdict_page.FORMATS) == (*FORMATS, "fragment")  # which is one of LaTeX


@pytest.mark.parametrize("format", FORMATS)
def test_the_whole_paper_in_every_format(format: str, capsys: pytest.CaptureFixture[str], judged: list[str]) -> None:
    page = answer(capsys, "--published", "--format", format)
    assert "T1.a.x" in page
    assert page.endswith("\n")
    assert judged == [each.id for each in ENTRIES]


@pytest.mark.parametrize(
    ("arguments", "ids"),
    [
        (["--published", "1.2"], ["(1.2).1"]),
        (["T1.a", "--published", "(1.1)"], ["(1.1)", "T1.a.x", "T1.a.y"]),
        (["--published", "Table 1", "--format", "json"], ["T1.b", "T1.a.x", "T1.a.y", "T1.b.x", "T1.b.y"]),
    ],
)
def test_only_what_is_asked_for_is_judged(
    arguments: list[str], ids: list[str], capsys: pytest.CaptureFixture[str], judged: list[str]
) -> None:
    page = answer(capsys, *arguments)
    assert judged == ids
    assert all(id in page for id in ids)
    assert "text.1" not in page
    if "json" in arguments:
        assert [each["id"] for each in json.loads(page)] == ids


def test_what_is_not_in_the_paper(capsys: pytest.CaptureFixture[str], judged: list[str]) -> None:
    line = answer(capsys, "--published", "1.2", "1.3", status=2)
    assert line == "1.3: no such record, formula or group in the paper. Did you mean 1.2 or 1.1?\n"
    assert judged == []


def test_a_scene_is_no_formula_and_a_formula_no_scene(capsys: pytest.CaptureFixture[str]) -> None:
    assert "drive_m1: no such record" in answer(capsys, "--published", "drive_m1", status=2)
    assert "1.2: No such file" in answer(capsys, "1.2", status=2)


@pytest.mark.parametrize("option", [["--reproduce"], ["--format", "html"]])
def test_options_of_published_alone(option: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    line = answer(capsys, *option, status=2)
    assert f"{option[0]}: of the paper only; write --published too" in line


def test_a_counterexample_is_printed_as_a_scene_and_a_command(capsys: pytest.CaptureFixture[str]) -> None:
    page = answer(capsys, "--published", "1.2", "--reproduce")
    assert "Save this scene as 1.2.1.toml:" in page
    assert '    type = "drive"' in page
    assert "wavesym tables 1.2.1.toml" in page
    assert "the power is 1" in page
    assert "Save this scene" not in answer(capsys, "--published", "1.2")


def test_only_what_could_not_be_tested_fails(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "misprint" in answer(capsys, "--published", "1.2")

    class Spoilt(Paper):
        @staticmethod
        def records(*given: object) -> tuple[Record, ...]:
            return Paper.records([entry("(1.2).1", "n + n = 3n", "section 1")])

    monkeypatch.setattr(verdict_page, "paper", Spoilt)
    assert "untested" in answer(capsys, "--published", "1.2", status=1)


def test_scenes_are_verified_as_ever(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    asked: list[str] = []

    def verify(scenes: list[Scene], *_: object, **__: object) -> tuple[str, bool]:
        asked.extend(scene.name for scene in scenes)
        return "errors", True

    monkeypatch.setattr("wavesym.api.verify", verify)
    assert answer(capsys, "drive_m1", "building_m2") == "errors\n"
    assert asked == ["drive_m1", "building_m2"]


def test_only_one_verdict_is_shown_after_counts_of_all(capsys: pytest.CaptureFixture[str], judged: list[str]) -> None:
    every = json.loads(answer(capsys, "--published", "--format", "json"))
    wrong = [record["id"] for record in every if record["verdict"] == "misprint"]
    right = [record["id"] for record in every if record["verdict"] == "holds"]
    assert wrong
    text = answer(capsys, "--published", "--only", "misprint")
    assert text.startswith(f"{len(right):4} holds: right as printed\n{len(wrong):4} misprint: ")
    assert all(f"\n{id}: misprint" in text for id in wrong)
    assert not any(f"\n{id} " in text for id in right)
    listed = json.loads(answer(capsys, "--published", "--only", "misprint", "--format", "json"))
    assert [record["id"] for record in listed] == wrong
    assert answer(capsys, "--published", "--only", "wrong", status=2).startswith("--only: wrong is unknown")
    assert "--only: of the paper only; write --published too" in answer(capsys, "--only", "holds", status=2)


def test_several_verdicts_are_shown_together(capsys: pytest.CaptureFixture[str]) -> None:
    """The last one alone was, in silence."""
    every = json.loads(answer(capsys, "--published", "--format", "json"))
    wanted = [record["id"] for record in every if record["verdict"] in ("misprint", "unreadable")]
    assert {record["verdict"] for record in every} > {"misprint", "unreadable"}
    only = ("--only", "misprint", "--only", "unreadable")
    listed = json.loads(answer(capsys, "--published", *only, "--format", "json"))
    assert [record["id"] for record in listed] == wanted
    assert {record["verdict"] for record in listed} == {"misprint", "unreadable"}
    refusal = answer(capsys, "--published", "--only", "misprint", "--only", "wrong", status=2)
    assert refusal.startswith("--only: wrong is unknown")
